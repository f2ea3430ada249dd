//! The module for browsers: compiled, bound and tried in a browser without a window.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
};

use wasm_bindgen_cli_support::Bindgen;

use crate::{
    debian,
    shell::{TaskResult, cargo, run, target, workspace},
};

const TARGET: &str = "wasm32-unknown-unknown";

/// Debian's compiler for the target, where rustup has none to give, and what else is needed here.
const DEBIAN_PACKAGES: [&str; 6] = ["rustc-web", "cargo-web", "rust-web-src", "rust-web-llvm", "lld-22", "chromium"];

/// Bytes that the module may have. Larger, and a dependency that doubles it goes unnoticed; smaller leaves no room to grow.
const MOST_BYTES: u64 = 6_000_000;

/// The recipe that has to give the same bytes in the browser as natively, and the mesh that it names.
const RECIPE: &str = "data/recipes/sphere.toml";
const MESH: &str = "data/planet.obj";

/// Builds the package for browsers in `target/wasm/site/pkg` and runs the pages of its tests and examples.
pub(crate) fn test_in_browser() -> TaskResult {
    let site = target().join("wasm/site");
    let package = site.join("pkg");
    fs::create_dir_all(&package)?;
    let module = compile()?;
    Bindgen::new()
        .input_path(module)
        .out_name("isochore")
        .web(true)?
        .typescript(true)
        .omit_default_module_path(false)
        .generate(&package)?;
    let size = fs::metadata(package.join("isochore_bg.wasm"))?.len();
    eprintln!("the module has {size} bytes");
    if size > MOST_BYTES {
        return Err(format!("that is more than {MOST_BYTES}").into());
    }

    run(cargo(&["run", "--release", "--locked", "--quiet", "--", "run", RECIPE, "--quiet", "--output"])
        .arg(site.join("expected.obj"))
        .current_dir(workspace()))?;
    fs::copy(workspace().join(RECIPE), site.join("recipe.toml"))?;
    fs::copy(workspace().join(MESH), site.join("planet.obj"))?;
    let server = Server::start(&site)?;
    for page in ["tests/browser.html", "examples/sculpt.html"] {
        let source = workspace().join("crates/wasm").join(page);
        let name = source.file_name().ok_or("a page without a name")?;
        fs::copy(&source, site.join(name))?;
        server.open(&name.to_string_lossy())?;
    }
    Ok(())
}

/// Compiles the module with vectors of 128 bits, by rustup's target where it is there or can be fetched, else by Debian's compiler.
fn compile() -> TaskResult<PathBuf> {
    let folder = target().join("wasm/build");
    let package = ["build", "--release", "--package", "isochore-wasm", "--target", TARGET, "--target-dir"];
    let flags = ("RUSTFLAGS", "-Ctarget-feature=+simd128");
    if has_rustup_target() {
        run(cargo(&package).arg(&folder).env(flags.0, flags.1))?;
    } else {
        install_from_debian()?;
        let mut debian = Command::new("/usr/bin/cargo");
        debian.args(package).arg(&folder).arg("-Zbuild-std=std,panic_abort").current_dir(workspace());
        // The standard library is compiled along, which takes flags that a stable compiler has locked.
        debian.env("RUSTC", "/usr/bin/rustc").env("RUSTC_BOOTSTRAP", "1").env("CARGO_PROFILE_RELEASE_PANIC", "abort");
        run(debian.env(flags.0, flags.1).env_remove("RUSTUP_TOOLCHAIN"))?;
    }
    Ok(folder.join(TARGET).join("release/isochore_wasm.wasm"))
}

fn has_rustup_target() -> bool {
    let has = || {
        let output = Command::new("rustc").args(["--print", "target-libdir", "--target", TARGET]).output();
        output.is_ok_and(|output| Path::new(String::from_utf8_lossy(&output.stdout).trim()).exists())
    };
    has() || (Command::new("rustup").args(["target", "add", TARGET]).output().is_ok() && has())
}

fn install_from_debian() -> TaskResult {
    if ["lld-22", "cargo", "chromium"].iter().all(|name| Path::new("/usr/bin").join(name).exists()) {
        return Ok(());
    }
    debian::install(&DEBIAN_PACKAGES)
}

/// Serves a folder to browsers of this machine.
struct Server {
    process: Child,
    port: u16,
}

impl Server {
    fn start(folder: &Path) -> TaskResult<Self> {
        // Whatever port is free now.
        let port = std::net::TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
        let process = Command::new("python3")
            .args(["-m", "http.server", "--bind", "127.0.0.1", "--directory"])
            .arg(folder)
            .arg(port.to_string())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()?;
        let server = Self { process, port };
        for _ in 0..100 {
            if std::net::TcpStream::connect(("127.0.0.1", port)).is_ok() {
                return Ok(server);
            }
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
        Err("the server of the test pages does not answer".into())
    }

    /// Opens a page and waits for what it says; the last line must be `done`.
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
