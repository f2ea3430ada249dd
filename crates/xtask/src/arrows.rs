//! The arrows between crates that ARCHITECTURE.md draws.

use std::collections::BTreeSet;

use crate::shell::{cargo, workspace};

/// Crates of the workspace that each library or command may depend on.
const ALLOWED: [(&str, &[&str]); 9] = [
    ("isochore-mesh", &[]),
    ("isochore-curve", &[]),
    ("isochore-field", &["isochore-mesh", "isochore-curve"]),
    ("isochore-sculpt", &["isochore-mesh", "isochore-field"]),
    ("isochore-picture", &["isochore-mesh"]),
    ("isochore-wasm", &["isochore-mesh", "isochore-field", "isochore-sculpt"]),
    ("isochore-capi", &["isochore-mesh", "isochore-field", "isochore-sculpt"]),
    ("isochore-python", &["isochore-mesh", "isochore-field", "isochore-sculpt"]),
    ("isochore-cli", &["isochore-mesh", "isochore-curve", "isochore-field", "isochore-sculpt", "isochore-picture"]),
];

#[test]
fn crates_depend_only_along_the_arrows() {
    let output = cargo(&["metadata", "--no-deps", "--format-version", "1"]).current_dir(workspace()).output().unwrap();
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for (name, allowed) in ALLOWED {
        let package = metadata["packages"].as_array().unwrap().iter().find(|package| package["name"] == name);
        let dependencies = package.unwrap_or_else(|| panic!("no crate {name}"))["dependencies"].as_array().unwrap();
        let ours: BTreeSet<&str> = dependencies
            .iter()
            .filter(|dependency| dependency["kind"].is_null())
            .filter_map(|dependency| dependency["name"].as_str())
            .filter(|name| name.starts_with("isochore"))
            .collect();
        let allowed = allowed.iter().copied().collect();
        assert!(ours.is_subset(&allowed), "{name} depends on {:?}", ours.difference(&allowed));
    }
}
