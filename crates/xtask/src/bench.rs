//! Runs the programs of `bench`, and writes what they compare into the README.

use std::{fmt::Write as _, fs, path::Path, process::Command};

use serde_json::Value;

use crate::shell::{TaskResult, cargo, run, target, workspace};

/// Between these lines of the README stands the table.
const MARKERS: [&str; 2] = ["<!-- speed: written by cargo xtask bench -->\n", "<!-- end of speed -->\n"];

/// Runs all programs, or those named on the command line, and writes the table of all that were run today.
///
/// Rows of earlier days are left out: programs, peers and machine may have changed since.
pub(crate) fn measure_all() -> TaskResult {
    run(&mut cargo(&["build", "--release", "--locked", "--package", "isochore-bench", "--package", "isochore-cli"]))?;
    let today = output(Command::new("date").args(["-u", "+%F"]))?;
    let folder = target().join("bench-rows").join(&today);
    fs::create_dir_all(&folder)?;
    let named: Vec<String> = std::env::args().skip(2).collect();
    for program in if named.is_empty() { programs()? } else { named } {
        let rows = folder.join(&program).with_extension("jsonl");
        if rows.exists() {
            fs::remove_file(&rows)?;
        }
        run(Command::new(target().join("release").join(&program)).env("ISOCHORE_BENCH_ROWS", rows))?;
    }
    let table = format!("{}\n{}", table(&rows_of(&folder)?)?, measured_on(&today)?);
    let readme = workspace().join("README.md");
    let text = fs::read_to_string(&readme)?;
    fs::write(readme, between_markers(&text, &table)?)?;
    Ok(())
}

/// Names of the programs: each is a file or a folder.
fn programs() -> TaskResult<Vec<String>> {
    names_in(&workspace().join("bench/src/bin"))
}

/// Names of the files in a folder without their extensions, in order.
fn names_in(folder: &Path) -> TaskResult<Vec<String>> {
    let entries = fs::read_dir(folder)?;
    let mut names: Vec<String> =
        entries.filter_map(|entry| Some(entry.ok()?.path().file_stem()?.to_str()?.to_owned())).collect();
    names.sort();
    Ok(names)
}

/// All rows in a folder, a program after the other.
fn rows_of(folder: &Path) -> TaskResult<Vec<Value>> {
    let mut rows = Vec::new();
    for name in names_in(folder)? {
        let lines = fs::read_to_string(folder.join(name).with_extension("jsonl"))?;
        for line in lines.lines() {
            rows.push(serde_json::from_str(line)?);
        }
    }
    Ok(rows)
}

/// The table in Markdown; a job that several peers do is named once, with all of them below it.
fn table(rows: &[Value]) -> TaskResult<String> {
    let first_of_job = |row: &&Value| rows.iter().position(|other| other["job"] == row["job"]);
    let mut rows: Vec<&Value> = rows.iter().collect();
    rows.sort_by_key(first_of_job);
    let mut table = String::from(
        "| job | peer | unit | isochore | peer's | ratio | accuracy |\n|---|---|---|---:|---:|---:|---|\n",
    );
    let mut last = "";
    for row in rows {
        let word = |key: &str| row[key].as_str().ok_or_else(|| format!("a row without {key}: {row}"));
        let number = |key: &str| row[key].as_f64().ok_or_else(|| format!("a row without {key}: {row}"));
        let (ours, theirs) = (number("ours")?, number("theirs")?);
        let job = word("job")?;
        writeln!(
            table,
            "| {} | {} | {} | {} | {} | {} | {} |",
            if job == last { "" } else { job },
            word("peer")?,
            word("unit")?,
            three_digits(ours),
            three_digits(theirs),
            three_digits(theirs / ours),
            word("accuracy")?.replace('|', "\\|"),
        )?;
        last = job;
    }
    Ok(table)
}

/// A positive number with three digits that count, or all digits before the point.
fn three_digits(value: f64) -> String {
    let before_point = if value > 0.0 { value.log10().floor() as i32 + 1 } else { 1 };
    format!("{value:.*}", (3 - before_point).clamp(0, 9) as usize)
}

/// The line below the table: when, on what, built by what.
fn measured_on(today: &str) -> TaskResult<String> {
    let processors = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = processors.lines().find_map(|line| line.strip_prefix("model name")?.split(": ").nth(1));
    let cores = std::thread::available_parallelism()?;
    let compiler = output(Command::new("rustc").arg("--version"))?;
    let compiler = compiler.split(" (").next().unwrap_or(&compiler);
    let model = model.unwrap_or(std::env::consts::ARCH);
    Ok(format!("{today}, {cores} cores of {model}, {compiler}.\n"))
}

fn output(command: &mut Command) -> TaskResult<String> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}

fn between_markers(text: &str, table: &str) -> TaskResult<String> {
    let [begin, end] = MARKERS;
    let (before, rest) = text.split_once(begin).ok_or_else(|| format!("the README has no line {begin}"))?;
    let (_, after) = rest.split_once(end).ok_or_else(|| format!("the README has no line {end}"))?;
    Ok(format!("{before}{begin}\n{table}\n{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_stands_between_the_markers_however_often_it_is_written() {
        let readme = fs::read_to_string(workspace().join("README.md")).unwrap();
        let once = between_markers(&readme, "one\n").unwrap();
        assert!(once.contains("\none\n"));
        assert_eq!(between_markers(&once, "two\n").unwrap(), between_markers(&readme, "two\n").unwrap());
        assert!(between_markers("no markers", "one").is_err());
    }

    #[test]
    fn numbers_have_three_digits() {
        let shown = [0.0123456, 0.5, 9.994, 12.34, 123.4, 98_765.4].map(three_digits);
        assert_eq!(shown, ["0.0123", "0.500", "9.99", "12.3", "123", "98765"]);
    }

    #[test]
    fn a_job_is_named_once() {
        let row = |job: &str, peer: &str| serde_json::json!({ "job": job, "peer": peer, "unit": "ms", "ours": 2.0, "theirs": 3.0, "accuracy": "1 | 2" });
        let table = table(&[row("a", "p"), row("b", "p"), row("a", "q")]).unwrap();
        let lines: Vec<&str> = table.lines().skip(2).collect();
        assert_eq!(
            lines,
            [
                "| a | p | ms | 2.00 | 3.00 | 1.50 | 1 \\| 2 |",
                "|  | q | ms | 2.00 | 3.00 | 1.50 | 1 \\| 2 |",
                "| b | p | ms | 2.00 | 3.00 | 1.50 | 1 \\| 2 |"
            ]
        );
        assert!(super::table(&[serde_json::json!({})]).is_err());
    }
}
