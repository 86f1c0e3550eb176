//! Formulas and their charts according to other tools of the method.

use std::path::{Path, PathBuf};

use serde_json::Value;

fn cases() -> Option<PathBuf> {
    let shared = std::env::var_os("MONAS_SHARED").map(PathBuf::from);
    let shared = shared.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"));
    Some(shared.join("models/liveness")).filter(|folder| folder.is_dir())
}

/// The expected chart in the format of `to_json`.
fn expected(case: &Value) -> Value {
    let mut expected = case["expected"].clone();
    for transition in expected["transitions"].as_array_mut().expect("a list") {
        let fields = transition.as_object_mut().expect("an object");
        let te = fields.remove("TE").expect("an expression or null");
        fields.insert("te".into(), te);
    }
    let fields = ["model", "nodes", "transitions"].map(|key| (key.to_string(), expected[key].clone()));
    Value::Object(fields.into_iter().collect())
}

#[test]
fn every_case_agrees_exactly() {
    let Some(folder) = cases() else {
        println!("skipped: the folder of cases is not there");
        return;
    };
    let mut files: Vec<PathBuf> =
        folder.read_dir().expect("readable").map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "srm"));
    files.sort();
    for file in &files {
        let text = std::fs::read_to_string(file).expect("readable");
        let case = std::fs::read_to_string(file.with_extension("json")).expect("readable");
        let case: Value = serde_json::from_str(&case).expect("JSON");
        let (role, findings) = aseme::SrmFile::parse(text);
        let warned = case["expected"].get("warning").is_some_and(|warning| !warning.is_null());
        assert_eq!(findings.len(), usize::from(warned), "{}: {findings:?}", file.display());
        let (chart, findings) = aseme::role_to_statechart(role.srm());
        assert!(findings.is_empty(), "{}: {findings:?}", file.display());
        let json = serde_json::to_value(aseme::to_json(&chart)).expect("JSON");
        assert_eq!(json, expected(&case), "{}", file.display());
    }
    println!("{} cases agree", files.len());
    assert!(!files.is_empty());
}
