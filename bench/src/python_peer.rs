//! Python libraries, each in its own process. A process works on request, so its rounds can
//! alternate with those of isochore.

use std::fs;
use std::io::{BufRead as _, BufReader, Lines, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use serde_json::Value;

/// Environment variables that set the number of threads of libraries.
const THREAD_VARIABLES: [&str; 6] = [
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMBA_NUM_THREADS",
    "NUMEXPR_NUM_THREADS",
    "TBB_NUM_THREADS",
];

/// Folder of the Eigen headers on Debian, for packages that are built from source.
const HEADERS: &str = "/usr/include/eigen3";

/// A running program of `bench/peers`.
///
/// A request is one line of JSON, `{"job": NAME, ...}`. The reply is one line of JSON; measurements
/// have the key `seconds` with the CPU time of all threads. Large data pass through files in the
/// [scratch folder](scratch).
#[derive(Debug)]
pub struct PythonPeer {
    process: Child,
    requests: ChildStdin,
    replies: Lines<BufReader<ChildStdout>>,
}

impl PythonPeer {
    /// Starts `bench/peers/NAME.py` with the given arguments and as many threads as the caller has
    /// cores. First installs the packages of `bench/peers/requirements.txt` into a virtual
    /// environment in the target folder, if necessary.
    ///
    /// # Errors
    /// A message of one line if the peer cannot be started.
    pub fn start(name: &str, arguments: &[&str]) -> Result<Self, String> {
        let python = environment()?;
        let threads = std::thread::available_parallelism().map_or(1, usize::from).to_string();
        let mut process = Command::new(python)
            .arg("-u")
            .arg(peers().join(name).with_extension("py"))
            .args(arguments)
            .current_dir(scratch())
            .envs(THREAD_VARIABLES.map(|variable| (variable, &threads)))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| format!("{name}: {error}"))?;
        let (Some(requests), Some(replies)) = (process.stdin.take(), process.stdout.take()) else {
            return Err(format!("{name}: the process has no pipes"));
        };
        let mut peer = Self { process, requests, replies: BufReader::new(replies).lines() };
        peer.ask(&serde_json::json!({ "job": "start" })).map_err(|error| format!("{name}: {error}"))?;
        Ok(peer)
    }

    /// Sends a request and waits for the reply.
    ///
    /// # Errors
    /// The error message of the program, or a message that the process has ended.
    pub fn ask(&mut self, request: &Value) -> Result<Value, String> {
        writeln!(self.requests, "{request}").map_err(|error| error.to_string())?;
        // Libraries can print too. A reply is a line that is a JSON object.
        let reply = loop {
            let line = self.replies.next().ok_or("the process has ended")?.map_err(|error| error.to_string())?;
            match serde_json::from_str::<Value>(&line) {
                Ok(reply) if reply.is_object() => break reply,
                _ => {}
            }
        };
        match reply["error"].as_str() {
            Some(error) => Err(error.to_owned()),
            None => Ok(reply),
        }
    }

    /// Sends a request and returns the CPU time of the reply, in seconds.
    ///
    /// # Errors
    /// As [`ask`](Self::ask), and if the reply has no key `seconds`.
    pub fn seconds(&mut self, request: &Value) -> Result<f64, String> {
        let reply = self.ask(request)?;
        reply["seconds"].as_f64().ok_or_else(|| format!("the reply {reply} has no key `seconds`"))
    }
}

impl Drop for PythonPeer {
    fn drop(&mut self) {
        // Ignore errors: the process may have ended already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Creates and returns the folder for files that are passed between programs.
///
/// # Panics
/// If it cannot be created.
pub fn scratch() -> PathBuf {
    let folder = target().join("peers/scratch");
    fs::create_dir_all(&folder).expect("the target folder can be written");
    folder
}

fn peers() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("peers")
}

fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../target"), PathBuf::from)
}

/// Python interpreter of the virtual environment of the peers. Installs those packages of
/// `requirements.txt` that can be installed, if necessary.
fn environment() -> Result<PathBuf, String> {
    let folder = target().join("peers/environment");
    let python = folder.join("bin/python");
    let requirements = fs::read_to_string(peers().join("requirements.txt")).map_err(|error| error.to_string())?;
    let stamp = folder.join("installed.txt");
    if fs::read_to_string(&stamp).is_ok_and(|installed| installed == requirements) {
        return Ok(python);
    }
    let run = |command: &mut Command| match command.stdout(Stdio::null()).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{command:?}: {status}")),
        Err(error) => Err(format!("{command:?}: {error}")),
    };
    run(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
    for package in requirements.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        // Ignore failures: a peer reports a missing package when it imports it.
        let mut install = Command::new(&python);
        install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", package]);
        let _ = run(install.env("CPLUS_INCLUDE_PATH", HEADERS));
    }
    fs::write(stamp, requirements).map_err(|error| error.to_string())?;
    Ok(python)
}
