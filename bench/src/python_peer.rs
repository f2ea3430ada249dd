//! Libraries for Python, each in a process of its own that works on demand: so its rounds can alternate with ours.

use std::fs;
use std::io::{BufRead as _, BufReader, Lines, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use serde_json::Value;

/// Variables by which libraries are told how many threads to use.
const THREAD_VARIABLES: [&str; 6] = [
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMBA_NUM_THREADS",
    "NUMEXPR_NUM_THREADS",
    "TBB_NUM_THREADS",
];

/// Where Debian has the headers of Eigen, which a package that has no wheel may look for.
const HEADERS: &str = "/usr/include/eigen3";

/// A running program of `bench/peers`.
///
/// It gets one line of JSON a question, `{"job": NAME, ...}`, and answers each with one line, which has the `seconds` that all its
/// threads worked for it. Anything large goes through files of the [scratch folder](scratch).
#[derive(Debug)]
pub struct PythonPeer {
    process: Child,
    questions: ChildStdin,
    answers: Lines<BufReader<ChildStdout>>,
}

impl PythonPeer {
    /// Starts `bench/peers/NAME.py` with these arguments and as many threads as the caller has cores, once the packages of
    /// `bench/peers/requirements.txt` are installed in a virtual environment in the target folder.
    ///
    /// # Errors
    /// One line that says why there is no such peer on this machine.
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
        let (Some(questions), Some(answers)) = (process.stdin.take(), process.stdout.take()) else {
            return Err(format!("{name}: no pipes"));
        };
        let mut peer = Self { process, questions, answers: BufReader::new(answers).lines() };
        peer.ask(&serde_json::json!({ "job": "start" })).map_err(|error| format!("{name}: {error}"))?;
        Ok(peer)
    }

    /// Has it do the job that the question names, and waits for the answer.
    ///
    /// # Errors
    /// What the program says went wrong, or that it has ended.
    pub fn ask(&mut self, question: &Value) -> Result<Value, String> {
        writeln!(self.questions, "{question}").map_err(|error| error.to_string())?;
        // Libraries may print too; an answer is a line that is a JSON object.
        let answer = loop {
            let line = self.answers.next().ok_or("it has ended")?.map_err(|error| error.to_string())?;
            match serde_json::from_str::<Value>(&line) {
                Ok(answer) if answer.is_object() => break answer,
                _ => {}
            }
        };
        match answer["error"].as_str() {
            Some(error) => Err(error.to_owned()),
            None => Ok(answer),
        }
    }

    /// [`ask`](Self::ask), for the seconds of work alone.
    ///
    /// # Errors
    /// The same.
    pub fn seconds(&mut self, question: &Value) -> Result<f64, String> {
        let answer = self.ask(question)?;
        answer["seconds"].as_f64().ok_or_else(|| format!("no seconds in {answer}"))
    }
}

impl Drop for PythonPeer {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A folder for files that go between programs.
///
/// # Panics
/// If it cannot be made.
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

/// The interpreter of the peers' virtual environment, in which each package of `requirements.txt` is installed that can be.
fn environment() -> Result<PathBuf, String> {
    let folder = target().join("peers/environment");
    let python = folder.join("bin/python");
    let wanted = fs::read_to_string(peers().join("requirements.txt")).map_err(|error| error.to_string())?;
    let stamp = folder.join("installed.txt");
    if fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted) {
        return Ok(python);
    }
    let run = |command: &mut Command| match command.stdout(Stdio::null()).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{command:?}: {status}")),
        Err(error) => Err(format!("{command:?}: {error}")),
    };
    run(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
    for package in wanted.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        // Whoever needs a package that cannot be installed says so when it is imported.
        let mut install = Command::new(&python);
        install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", package]);
        let _ = run(install.env("CPLUS_INCLUDE_PATH", HEADERS));
    }
    fs::write(stamp, wanted).map_err(|error| error.to_string())?;
    Ok(python)
}
