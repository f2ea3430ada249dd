use std::io::Write as _;

use serde::{Deserialize, Serialize};

use crate::print_row;

/// The environment variable that names the file to which comparisons are appended.
pub const ROWS_VARIABLE: &str = "ISOCHORE_BENCH_ROWS";

/// What a job costs here and in a peer, measured in one run: a row of the table in the README.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// What is done, to what.
    pub job: String,
    /// Who else does it: name and version.
    pub peer: String,
    /// Of `ours` and `theirs`; a cost, so that less is better: nanoseconds a node, milliseconds, bytes a vertex.
    pub unit: String,
    /// What it costs here.
    pub ours: f64,
    /// What it costs the peer.
    pub theirs: f64,
    /// How far both results are from the truth, or from each other; empty where there is nothing to tell.
    pub accuracy: String,
}

impl Comparison {
    /// How many times cheaper it is here.
    pub fn ratio(&self) -> f64 {
        self.theirs / self.ours
    }

    /// Prints the heading of the rows that [`report`](Self::report) prints.
    pub fn print_heading() {
        print_row(["peer", "unit", "ours", "theirs", "ratio", "accuracy"]);
    }

    /// Prints a row of the table, and appends it as a line of JSON to the file that [`ROWS_VARIABLE`] names, if it names one.
    ///
    /// # Panics
    /// If that file cannot be written.
    pub fn report(&self) {
        let number = |value: f64| format!("{value:.3}");
        let ratio = format!("{:.2}", self.ratio());
        print_row([&self.peer, &self.unit, &number(self.ours), &number(self.theirs), &ratio, &self.accuracy]);
        let Some(path) = std::env::var_os(ROWS_VARIABLE) else { return };
        let mut line = serde_json::to_string(self).expect("strings and numbers can be written");
        line.push('\n');
        let file = std::fs::OpenOptions::new().create(true).append(true).open(path);
        file.and_then(|mut file| file.write_all(line.as_bytes())).expect("the rows can be written");
    }
}

#[test]
fn a_row_survives_its_file() {
    let row = Comparison {
        job: "sum of \"a\"".into(),
        peer: "abacus 1.0".into(),
        unit: "ms".into(),
        ours: 0.25,
        theirs: 1.5,
        accuracy: "error 1e-7 | 2e-3".into(),
    };
    assert_eq!(row.ratio(), 6.0);
    let line = serde_json::to_string(&row).unwrap();
    assert_eq!(serde_json::from_str::<Comparison>(&line).unwrap(), row);
}
