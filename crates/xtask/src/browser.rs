//! The JavaScript package: built, and tested in a headless browser.

#[cfg(feature = "browser")]
mod package;

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
};

use crate::{
    debian,
    shell::{TaskResult, cargo, run, target, workspace},
};

/// The recipe that must give the same bytes in the browser as natively, and its mesh.
const RECIPE: &str = "data/recipes/sphere.toml";
const MESH: &str = "data/planet.obj";

/// Builds the package in the folder that the command line names, by default in `target/wasm/site/pkg`.
pub(crate) fn build() -> TaskResult {
    build_in(&std::env::args().nth(2).map_or_else(|| site().join("pkg"), PathBuf::from))
}

#[cfg(feature = "browser")]
pub(crate) use package::build_in;

/// Delegates to a task runner that is compiled with the bindings generator, which no other task needs.
#[cfg(not(feature = "browser"))]
pub(crate) fn build_in(folder: &Path) -> TaskResult {
    let runner = ["run", "--release", "--locked", "--quiet", "--package", "xtask", "--features", "browser"];
    run(cargo(&runner).args(["--", "browser"]).arg(std::path::absolute(folder)?))
}

/// Builds the package and runs the pages of its tests and examples.
pub(crate) fn test_pages() -> TaskResult {
    let site = site();
    build_in(&site.join("pkg"))?;
    run(cargo(&["run", "--release", "--locked", "--quiet", "--", "run", RECIPE, "--quiet", "--output"])
        .arg(site.join("expected.obj")))?;
    fs::copy(workspace().join(RECIPE), site.join("recipe.toml"))?;
    fs::copy(workspace().join(MESH), site.join("planet.obj"))?;
    debian::require("chromium", &["chromium"])?;
    let server = Server::start(&site)?;
    for page in ["tests/browser.html", "examples/sculpt.html"] {
        let source = workspace().join("crates/wasm").join(page);
        let name = source.file_name().ok_or("a page without a name")?;
        fs::copy(&source, site.join(name))?;
        server.open(&name.to_string_lossy())?;
    }
    Ok(())
}

/// The folder that the pages are served from.
fn site() -> PathBuf {
    target().join("wasm/site")
}

/// A server of one folder on the loopback interface.
struct Server {
    process: Child,
    port: u16,
}

impl Server {
    fn start(folder: &Path) -> TaskResult<Self> {
        // Any free port.
        let port = std::net::TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
        let process = Command::new("python3")
            .args(["-m", "http.server", "--bind", "127.0.0.1", "--directory"])
            .arg(folder)
            .arg(port.to_string())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()?;
        let server = Self { process, port };
        for _ in 0..1200 {
            if std::net::TcpStream::connect(("127.0.0.1", port)).is_ok() {
                return Ok(server);
            }
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
        Err("the server of the test pages does not respond".into())
    }

    /// Opens a page and waits for its log, whose last line must be `done`.
    fn open(&self, page: &str) -> TaskResult {
        let profile = target().join("wasm/profile");
        let quiet =
            ["--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"];
        let output = Command::new("chromium")
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--virtual-time-budget=600000"])
            .args(quiet)
            .arg(format!("--user-data-dir={}", profile.display()))
            .arg("--dump-dom")
            .arg(format!("http://127.0.0.1:{}/{page}", self.port))
            .output()?;
        let document = String::from_utf8_lossy(&output.stdout);
        let said = document.split("<pre id=\"log\">").nth(1).and_then(|rest| rest.split("</pre>").next()).unwrap_or("");
        eprintln!("{page}:\n{said}");
        if said.trim_end().ends_with("done") { Ok(()) } else { Err(format!("{page} has failed").into()) }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
