//! The published schemas are those of the types.

use schemars::Schema;
use serde_json::Value;

#[track_caller]
fn check(name: &str, schema: Schema) {
    let path = format!("{}/../../schema/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let published: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    assert!(published == schema, "{path} is out of date: cargo run -- schema {name} > schema/{name}.json");
}

#[test]
fn recipe_is_current() {
    check("recipe", isochore_sculpt::schema::recipe());
}

#[test]
fn report_is_current() {
    check("report", isochore_sculpt::schema::report());
}

#[test]
fn stream_report_is_current() {
    check("stream-report", isochore_sculpt::schema::stream_report());
}

#[test]
fn every_kind_refuses_unknown_keys() {
    let schema = Value::from(isochore_sculpt::schema::recipe());
    let mut kinds = 0;
    for name in ["InnerRegion", "Stroke", "TargetShape", "ToolShape"] {
        for kind in schema["$defs"][name]["oneOf"].as_array().unwrap() {
            assert_eq!(kind["additionalProperties"], false, "{kind}");
            assert!(kind["required"].as_array().unwrap().contains(&"kind".into()), "{kind}");
            kinds += 1;
        }
    }
    assert!(kinds > 12);
}
