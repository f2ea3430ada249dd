//! Runs the programs of `bench`, and writes their comparisons into `bench/RESULTS.md` and the README.

use std::{fmt::Write as _, fs, path::Path, process::Command};

use serde_json::Value;

use crate::{
    marked_table::Markers,
    shell::{TaskResult, cargo, run, target, workspace},
};

/// The rows of the README: words of the job, and the start of the peer's name.
const HEADLINES: [([&str; 2], &str); 8] = [
    (["signed distance grid, 69k triangles", "128 cells"], "parry3d 0"),
    (["signed distance grid, 69k triangles", "128 cells"], "Open3D"),
    (["signed distance grid, 1124k triangles", "including preparation"], "Warp"),
    (["advect", "grid of 128³"], "Warp"),
    (["self-intersection check", "1,310,720 triangles"], "PyMeshLab"),
    (["split", "into 2,"], "manifold3d"),
    (["read OBJ", "327,680 triangles"], "MeshLib"),
    (["read GLB", "327,680 triangles"], "trimesh"),
];

/// Runs all programs, or those named on the command line, and writes the tables of all rows measured today.
///
/// Rows of earlier days are left out, because programs, peers or the machine may have changed since.
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
    let clay = folder.join("clay.md");
    if clay.exists() {
        let markers = Markers::new("clay", "cargo xtask bench clay");
        let text = format!("{}\n{}", fs::read_to_string(clay)?, measured_on(&today)?);
        markers.write_into(&workspace().join("bench/RESULTS.md"), text.trim_end())?;
    }
    let rows = rows_of(&folder)?;
    let measured_on = measured_on(&today)?;
    let markers = Markers::new("speed", "cargo xtask bench");
    let all = format!("{}\n{measured_on}", table(&rows)?);
    markers.write_into(&workspace().join("bench/RESULTS.md"), all.trim_end())?;
    match HEADLINES.iter().map(|(job, peer)| headline(&rows, job, peer)).collect::<TaskResult<Vec<Value>>>() {
        Ok(headlines) => {
            let few = format!("{}\n{measured_on}", table(&headlines)?);
            markers.write_into(&workspace().join("README.md"), few.trim_end())
        }
        Err(missing) => {
            eprintln!("the README keeps its rows: {missing}");
            Ok(())
        }
    }
}

/// The first row whose job holds both words and whose peer begins with `peer`.
fn headline(rows: &[Value], words: &[&str; 2], peer: &str) -> TaskResult<Value> {
    let job_holds = |row: &Value, word: &str| row["job"].as_str().is_some_and(|job| job.contains(word));
    let is_it = |row: &&Value| {
        words.iter().all(|word| job_holds(row, word)) && row["peer"].as_str().is_some_and(|name| name.starts_with(peer))
    };
    let row = rows.iter().find(is_it);
    row.cloned()
        .ok_or_else(|| format!("no row of today compares `{}` with {peer}; run all programs", words.join(" … ")).into())
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
    for name in names_in(folder)?.into_iter().filter(|name| name != "clay") {
        let lines = fs::read_to_string(folder.join(name).with_extension("jsonl"))?;
        for line in lines.lines() {
            rows.push(serde_json::from_str(line)?);
        }
    }
    Ok(rows)
}

/// The table in Markdown. Rows of one job follow each other, and only the first of them names it.
fn table(rows: &[Value]) -> TaskResult<String> {
    let first_of_job = |row: &&Value| rows.iter().position(|other| other["job"] == row["job"]);
    let mut rows: Vec<&Value> = rows.iter().collect();
    rows.sort_by_key(first_of_job);
    let mut table =
        String::from("| job | peer | unit | isochore | peer | ratio | accuracy |\n|---|---|---|---:|---:|---:|---|\n");
    let mut last = "";
    for row in rows {
        let word = |key: &str| row[key].as_str().ok_or_else(|| format!("{key} is missing in the row {row}"));
        let number = |key: &str| row[key].as_f64().ok_or_else(|| format!("{key} is missing in the row {row}"));
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

/// A positive number with three significant digits, or with all digits before the decimal point.
fn three_digits(value: f64) -> String {
    let before_point = if value > 0.0 { value.log10().floor() as i32 + 1 } else { 1 };
    format!("{value:.*}", (3 - before_point).clamp(0, 9) as usize)
}

/// The line below the table: date, machine and compiler.
fn measured_on(today: &str) -> TaskResult<String> {
    let processors = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = processors.lines().find_map(|line| line.strip_prefix("model name")?.split(": ").nth(1));
    let cores = std::thread::available_parallelism()?;
    let compiler = output(Command::new("rustc").arg("--version"))?;
    let compiler = compiler.split(" (").next().unwrap_or(&compiler);
    let model = model.unwrap_or(std::env::consts::ARCH);
    let vectors = widest_vectors(&processors);
    Ok(format!("{today}, {cores} cores of {model} with {vectors}, {compiler}.\n"))
}

/// Width of the vectors of the processor, which decides most ratios.
fn widest_vectors(processors: &str) -> &'static str {
    let flags = processors.lines().find(|line| line.starts_with("flags")).unwrap_or_default();
    let has = |flag: &str| flags.split_whitespace().any(|word| word == flag);
    match (has("avx512f"), has("avx2")) {
        (true, _) => "512-bit vectors",
        (false, true) => "256-bit vectors",
        _ => "128-bit vectors",
    }
}

fn output(command: &mut Command) -> TaskResult<String> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_the_widest_vectors() {
        assert_eq!(widest_vectors("model name: x\nflags\t\t: sse4_2 avx avx2\n"), "256-bit vectors");
        assert_eq!(widest_vectors("flags : avx2 avx512f"), "512-bit vectors");
        assert_eq!(widest_vectors(""), "128-bit vectors");
    }

    #[test]
    fn numbers_have_three_significant_digits() {
        let shown = [0.0123456, 0.5, 9.994, 12.34, 123.4, 98_765.4].map(three_digits);
        assert_eq!(shown, ["0.0123", "0.500", "9.99", "12.3", "123", "98765"]);
    }

    #[test]
    fn only_the_first_row_of_a_job_names_it() {
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

    #[test]
    fn a_headline_is_found_by_its_job_and_peer() {
        let row = |job: &str, peer: &str| serde_json::json!({ "job": job, "peer": peer });
        let rows =
            [row("a grid of 64 cells", "p 1"), row("a grid of 128 cells", "q 1"), row("a grid of 128 cells", "p 1")];
        assert_eq!(headline(&rows, &["grid", "128"], "p").unwrap(), rows[2]);
        assert!(headline(&rows, &["grid", "256"], "p").is_err());
    }
}
