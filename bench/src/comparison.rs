use std::io::Write as _;

use serde::{Deserialize, Serialize};

use crate::print_row;

/// Environment variable with the path of the file to which comparisons are appended.
pub const ROWS_VARIABLE: &str = "ISOCHORE_BENCH_ROWS";

/// Costs of a job in isochore and in a peer, measured in one run: a row of the table in the README.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Operation and input.
    pub job: String,
    /// Name and version of the peer.
    pub peer: String,
    /// Unit of `ours` and `theirs`. Smaller is better: ns/node, ms, bytes/vertex.
    pub unit: String,
    /// Cost in isochore.
    pub ours: f64,
    /// Cost in the peer.
    pub theirs: f64,
    /// Errors of both results, or their difference. Empty if this does not apply.
    pub accuracy: String,
}

impl Comparison {
    /// Cost of the peer divided by that of isochore.
    pub fn ratio(&self) -> f64 {
        self.theirs / self.ours
    }

    /// Prints the column headings of [`report`](Self::report).
    pub fn print_heading() {
        print_row(["peer", "unit", "ours", "theirs", "ratio", "accuracy"]);
    }

    /// Prints a row of the table. If [`ROWS_VARIABLE`] is set, appends the row as a line of JSON to
    /// that file.
    ///
    /// # Panics
    /// If the file cannot be written.
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
fn a_row_survives_serialization() {
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
