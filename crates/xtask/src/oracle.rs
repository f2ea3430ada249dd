//! Independent checks of the meshes that the command writes: PyMeshLab for volume, area and closedness, libigl for exact
//! self-intersection. Both are installed from the Python package registry into the target folder, and are never linked.

use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::Value;

use crate::{
    debian,
    environment::interpreter,
    marked_table::Markers,
    shell::{TaskResult, cargo, run, target, workspace},
};

/// Packages that the checks need, at the versions that were tried.
const PACKAGES: [&str; 3] = ["pymeshlab==2025.7.post1", "libigl==2.6.3", "numpy<3"];

/// The system library that PyMeshLab loads.
const SYSTEM_LIBRARY: &str = "libGL.so.1";

/// The argument that writes the table instead of comparing it.
const WRITE: &str = "--write";

/// The document with the row of every recipe.
const RESULTS: &str = "bench/RESULTS.md";

/// Changes of volume below this are rounding; the checks require it of every locked mesh.
const PRECISION: f64 = 1e-12;

/// First words of the rows that the README shows.
const HEADLINES: [&str; 6] = [
    "A chess knight is pressed",
    "A coin is stamped",
    "A horn is pulled",
    "A hand of four fingers and a thumb",
    "A figure turns",
    "A ball is pressed into the bunny",
];

/// Runs every recipe of the project and four on a scan, checks the meshes, and compares the table of the figures with the one
/// in `bench/RESULTS.md`. With the argument `--write` it writes that table, and its rows in the README.
pub(crate) fn run_judges() -> TaskResult {
    let rows = measure()?;
    let all = table(&rows)?;
    if std::env::args().any(|argument| argument == WRITE) {
        markers().write_into(&workspace().join(RESULTS), &all)?;
        return markers().write_into(&workspace().join("README.md"), &table(&headlines(&rows)?)?);
    }
    let document = fs::read_to_string(workspace().join(RESULTS))?;
    if markers().content(&document)? == all {
        Ok(())
    } else {
        Err(format!("the table of {RESULTS} is out of date; run: cargo xtask oracle {WRITE}").into())
    }
}

fn markers() -> Markers {
    Markers::new("volume", "cargo xtask oracle --write")
}

/// Builds the command, runs the checks, and returns their rows.
fn measure() -> TaskResult<Vec<Value>> {
    run(&mut cargo(&["build", "--release", "--locked", "--quiet"]))?;
    let python = environment()?;
    let script = workspace().join("crates/xtask/src/oracle.py");
    let output = target().join("oracle/output");
    if output.exists() {
        fs::remove_dir_all(&output)?;
    }
    fs::create_dir_all(&output)?;
    let mut checks = Command::new(python);
    checks.arg(script).arg(target().join("release/isochore")).arg(workspace().join("data/recipes")).arg(&output);
    run(&mut checks)?;
    Ok(serde_json::from_slice(&fs::read(output.join("rows.json"))?)?)
}

/// The table in Markdown.
fn table(rows: &[Value]) -> TaskResult<String> {
    let mut table = String::from(
        "| recipe | triangles | refined | volume change before lock | after lock | crossing |\n\
         |---|---:|---:|---:|---:|---:|\n",
    );
    for row in rows {
        let change = |key: &str| row[key].as_f64().ok_or_else(|| format!("{key} is missing in the row {row}"));
        writeln!(
            table,
            "| {} | {} | {} | {} | {} | {} |",
            row["recipe"].as_str().unwrap_or_default(),
            row["triangles"],
            row["refined"],
            shown(change("bare")?),
            shown(change("locked")?),
            row["crossing"],
        )?;
    }
    Ok(table.trim_end().to_owned())
}

/// The rows of the README.
fn headlines(rows: &[Value]) -> TaskResult<Vec<Value>> {
    let begins = |row: &Value, words: &str| row["recipe"].as_str().is_some_and(|recipe| recipe.starts_with(words));
    let find = |words: &&str| {
        let row = rows.iter().find(|row| begins(row, words));
        row.cloned().ok_or_else(|| format!("no recipe begins with `{words}`").into())
    };
    HEADLINES.iter().map(find).collect()
}

/// A relative change of volume. Below the precision of the measurement, it is rounding, which differs between machines.
fn shown(change: f64) -> String {
    if change.abs() < PRECISION { "below 1e-12".to_owned() } else { format!("{change:+.1e}") }
}

/// The interpreter of the environment of the checks.
fn environment() -> TaskResult<PathBuf> {
    let python = interpreter("oracle", &PACKAGES)?;
    if !can_load(&python, SYSTEM_LIBRARY) {
        debian::install(&["libgl1"])?;
    }
    Ok(python)
}

fn can_load(python: &Path, library: &str) -> bool {
    let load = format!("import ctypes; ctypes.CDLL('{library}')");
    Command::new(python).args(["-c", &load]).output().is_ok_and(|output| output.status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<Value> {
        let row = |recipe: &str| serde_json::json!({ "recipe": recipe, "triangles": 4, "refined": 8, "bare": 5.43e-5, "locked": -4e-16, "crossing": 0 });
        HEADLINES.map(row).to_vec()
    }

    #[test]
    fn a_row_shows_signed_changes_and_hides_rounding() {
        let table = table(&rows()[..1]).unwrap();
        assert!(table.ends_with("| A chess knight is pressed | 4 | 8 | +5.4e-5 | below 1e-12 | 0 |"), "{table}");
    }

    #[test]
    fn headlines_are_found_by_their_first_words() {
        assert_eq!(headlines(&rows()).unwrap().len(), HEADLINES.len());
        assert!(headlines(&rows()[1..]).is_err());
    }
}
