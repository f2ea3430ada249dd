//! Compares the dependencies between crates, and between the wings of `field`, with the arrows that ARCHITECTURE.md draws.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
};

use crate::shell::{cargo, workspace};

type Arrows = BTreeMap<String, BTreeSet<String>>;

/// The arrows in the code block that follows the heading: lines of the form `name → other, other`.
fn drawn_below(heading: &str) -> Arrows {
    let document = fs::read_to_string(workspace().join("ARCHITECTURE.md")).unwrap();
    let section = document.split(&format!("## {heading}\n")).nth(1).expect("the document has this section");
    let block = section.split("```").nth(1).expect("the section has a code block");
    let arrow = |line: &str| {
        let (from, to) = line.split_once('→')?;
        let to = to.split(',').map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect();
        Some((from.trim().to_owned(), to))
    };
    block.lines().filter_map(arrow).collect()
}

#[test]
fn crates_depend_along_the_drawn_arrows() {
    let output = cargo(&["metadata", "--no-deps", "--format-version", "1"]).current_dir(workspace()).output().unwrap();
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let folder_name = |package: &serde_json::Value| {
        let manifest = package["manifest_path"].as_str().unwrap();
        manifest.rsplit('/').nth(1).unwrap().to_owned()
    };
    let packages = metadata["packages"].as_array().unwrap();
    let folders: BTreeMap<&str, String> =
        packages.iter().map(|package| (package["name"].as_str().unwrap(), folder_name(package))).collect();
    let dependencies = |package: &serde_json::Value| -> BTreeSet<String> {
        let normal =
            package["dependencies"].as_array().unwrap().iter().filter(|dependency| dependency["kind"].is_null());
        normal.filter_map(|dependency| folders.get(dependency["name"].as_str()?).cloned()).collect()
    };
    let drawn = drawn_below("Crates");
    for package in packages {
        let name = folder_name(package);
        match drawn.get(&name) {
            Some(arrows) => assert_eq!(&dependencies(package), arrows, "dependencies of {name}"),
            None => assert!(["xtask", "bench", "examples"].contains(&name.as_str()), "{name} is not in the drawing"),
        }
    }
}

#[test]
fn the_wings_of_field_import_along_the_drawn_arrows() {
    let source = workspace().join("crates/field/src");
    let drawn = drawn_below("The wings of `field`");
    assert_eq!(drawn.len(), 3, "{drawn:?}");
    let exported = exported_names(&fs::read_to_string(source.join("lib.rs")).unwrap());
    for (wing, allowed) in &drawn {
        let forbidden: Vec<&String> =
            drawn.keys().filter(|other| *other != wing && !allowed.contains(*other)).collect();
        for path in rust_files(&source.join(wing)) {
            let imported = imported_names(&fs::read_to_string(&path).unwrap());
            for other in &forbidden {
                let of_other = |name: &&String| *name == *other || exported.get(*name) == Some(*other);
                let wrong: Vec<&String> = imported.iter().filter(of_other).collect();
                assert!(wrong.is_empty(), "{} imports {wrong:?} from {other}", path.display());
            }
        }
    }
}

/// The wing that each public name of the crate comes from, by the lines `pub use wing::{…};`.
fn exported_names(library: &str) -> BTreeMap<String, String> {
    let exports = library.split("pub use ").skip(1).filter_map(|rest| rest.split(';').next());
    let names = |export: &str| {
        let (wing, names) = export.split_once("::").expect("names are exported from modules");
        let wing = wing.to_owned();
        identifiers(names).into_iter().map(move |name| (name, wing.clone())).collect::<Vec<_>>()
    };
    exports.flat_map(names).collect()
}

/// Every name that follows `crate::` in the code of a file, those inside braces included.
fn imported_names(text: &str) -> BTreeSet<String> {
    let code: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    let text = code.join("\n");
    let after = text.split("crate::").skip(1);
    let names = after.flat_map(|rest| match rest.strip_prefix('{') {
        Some(list) => identifiers(list.split(';').next().unwrap_or_default()),
        None => identifiers(rest).into_iter().take(1).collect(),
    });
    names.collect()
}

fn identifiers(text: &str) -> Vec<String> {
    let words = text.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
    words.filter(|word| !word.is_empty()).map(str::to_owned).collect()
}

fn rust_files(folder: &std::path::Path) -> Vec<std::path::PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.push(folder.with_extension("rs"));
    files
}

#[test]
fn imports_are_found_with_and_without_braces() {
    let text =
        "//! See [`crate::Stamp`].\nuse crate::{\n    Move, flow::{rk4, Stroke},\n};\nlet x = crate::deform::lock();";
    let names: Vec<String> = imported_names(text).into_iter().collect();
    assert_eq!(names, ["Move", "Stroke", "deform", "flow", "rk4"]);
    let exported = exported_names("pub use flow::{Move, Stroke};\npub use fields::Tool;");
    assert_eq!(exported["Move"], "flow");
    assert_eq!(exported["Tool"], "fields");
}
