//! Tests of help, manual pages and completion scripts.

use crate::folder::Folder;

const SUBCOMMANDS: [&str; 9] =
    ["run", "inspect", "distance", "frames", "sweep", "demo", "schema", "completions", "man"];

#[test]
fn prints_help_and_version_on_stdout() {
    let folder = Folder::with(&[]);
    for arguments in [&["--help"][..], &["--version"]] {
        let run = folder.run(arguments).expect(0);
        assert!(!run.stdout.is_empty() && run.stderr.is_empty());
    }
    for subcommand in SUBCOMMANDS {
        let run = folder.run(&[subcommand, "--help"]).expect(0);
        assert!(run.stdout.contains(&format!("isochore {subcommand}")) && run.stderr.is_empty());
    }
}

#[test]
fn help_of_run_explains_settings_and_paths() {
    let help = Folder::with(&[]).run(&["run", "--help"]).expect(0).stdout;
    let words = help.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in [
        "may be repeated, as in --set tools.ball.support=0.2 --set stroke.0.tool=ball",
        "relative to the current folder [default: output.mesh of the recipe]",
        "such as output.report and output.preview, are relative to its folder",
    ] {
        assert!(words.contains(part), "`{part}` is missing in {help}");
    }
}

#[test]
fn help_lists_all_subcommands() {
    let help = Folder::with(&[]).run(&["--help"]).expect(0).stdout;
    for subcommand in SUBCOMMANDS {
        assert!(help.contains(&format!("\n  {subcommand} ")), "{subcommand} is missing in {help}");
    }
}

#[test]
fn prints_completions_for_every_shell() {
    let folder = Folder::with(&[]);
    // The scripts for PowerShell and Elvish do not complete the values of options.
    let common = ["isochore", "inspect", "samples-per-segment"];
    let with_values = ["isochore", "inspect", "samples-per-segment", "tangents-only"];
    for (shell, parts) in [
        ("bash", &with_values[..]),
        ("zsh", &with_values),
        ("fish", &with_values),
        ("powershell", &common),
        ("elvish", &common),
    ] {
        let run = folder.run(&["completions", shell]).expect(0);
        assert_eq!(run.stderr, "");
        for part in parts {
            assert!(run.stdout.contains(part), "{shell}: {part} is missing");
        }
    }
    folder.run(&["completions", "cmd"]).expect_error(2, &["cmd", "bash", "zsh"]);
}

#[test]
#[cfg(unix)]
fn bash_accepts_its_completion_script() {
    let folder = Folder::with(&[]);
    let script = folder.run(&["completions", "bash"]).expect(0).stdout;
    std::fs::write(folder.path("isochore.bash"), script).unwrap();
    let complete = "source isochore.bash; COMP_WORDS=(isochore insp); COMP_CWORD=1; _isochore isochore insp isochore; \
                    echo \"${COMPREPLY[@]}\"";
    let output =
        std::process::Command::new("bash").args(["-c", complete]).current_dir(folder.path("")).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stdout), "inspect\n", "{output:?}");
}

#[test]
fn prints_the_manual_page() {
    let run = Folder::with(&[]).run(&["man"]).expect(0);
    assert_eq!(run.stderr, "");
    assert!(run.stdout.contains(".TH isochore 1"), "{}", run.stdout);
    for part in [".SH NAME", ".SH SYNOPSIS", ".SH SUBCOMMANDS", "isochore\\-run(1)", "Exit codes"] {
        assert!(run.stdout.contains(part), "{part} is missing in {}", run.stdout);
    }
}

#[test]
fn writes_a_manual_page_per_subcommand() {
    let folder = Folder::with(&[]);
    let run = folder.run(&["man", "--output", "pages"]).expect(0);
    assert_eq!(run.stdout, "");
    let mut expected: Vec<String> =
        SUBCOMMANDS.iter().map(|subcommand| format!("pages/isochore-{subcommand}.1")).collect();
    expected.extend(["pages/".to_owned(), "pages/isochore.1".to_owned()]);
    expected.sort();
    let contents = folder.contents();
    assert_eq!(contents.keys().cloned().collect::<Vec<_>>(), expected);
    let page = String::from_utf8(folder.read("pages/isochore-sweep.1")).unwrap();
    for part in [".TH isochore-sweep 1", "\\fBisochore sweep\\fR", "\\-\\-samples\\-per\\-segment", "tangents\\-only"] {
        assert!(page.contains(part), "{part} is missing in {page}");
    }
    assert_eq!(folder.read("pages/isochore.1"), folder.run(&["man"]).expect(0).stdout.into_bytes());
    folder.run(&["man", "--output", "none/pages"]).expect_error(2, &["none", "does not exist"]);
}
