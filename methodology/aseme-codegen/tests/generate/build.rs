//! Generation in build scripts: a model becomes a module in a folder.

use std::fs;
use std::path::{Path, PathBuf};

use aseme_codegen::build::generate;

use crate::words::soccer;

/// A separate folder for each test below cargo's temporary folder.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("build").join(name);
    fs::create_dir_all(&folder).expect("writable");
    folder
}

fn model(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, text).expect("writable");
    path
}

#[test]
fn the_module_of_a_model_is_written_where_it_is_included_from() {
    let folder = folder("goalie");
    let text =
        "Role: goalie\nLiveness:\ngoalie = look . dive\nTransitions:\nlook -> dive : [Ball.approaching]\n";
    let path = model(&folder, "goalie.srm", text);
    let file = generate(&path).bindings(soccer()).into(&folder).write().expect("it can be written");
    assert_eq!(file, folder.join("goalie.rs"));
    let library = folder.join("goalie/src/lib.rs");
    let module = fs::read_to_string(file).expect("it is there");
    assert!(module.ends_with(&format!("#[path = {library:?}]\npub mod goalie;\n")), "{module}");
    let guards = fs::read_to_string(folder.join("goalie/src/guards.rs")).expect("it is there");
    assert!(guards.contains("holds(input.latest(messages::BALL)?.approaching)"), "{guards}");
}

#[test]
fn model_errors_have_positions() {
    let folder = folder("wrong");
    let text = "Role: r\nLiveness:\nr = look . dive\nTransitions:\nlook -> drive : [Ball.approaching]\n";
    let error = generate(model(&folder, "wrong.srm", text)).into(&folder).write().expect_err("it is wrong");
    assert!(error.to_string().contains("wrong.srm:5:1: error[E0250]"), "{error}");
    assert_eq!(error.diagnostics().len(), 1);
    let field = text.replace("drive : [Ball.approaching]", "dive : [Ball.fast]");
    let error = generate(model(&folder, "field.srm", &field)).bindings(soccer()).into(&folder).write();
    let error = error.expect_err("there is no such field").to_string();
    assert!(error.contains("field.srm:5") && error.contains("has no field `fast`"), "{error}");
}

#[test]
fn a_missing_activity_gets_no_skeleton_in_a_build_folder() {
    let folder = folder("missing");
    let words = aseme_codegen::generate::RustBindings {
        registers: true,
        runtime: "monas::generated".into(),
        ..soccer()
    };
    let made = generate(model(&folder, "walker.srm", "walker = look . walkOn"))
        .bindings(words)
        .into(&folder)
        .write();
    let error = made.expect_err("nobody has written them");
    let codes: Vec<&str> = error.diagnostics().iter().map(|found| found.code).collect();
    assert_eq!(codes, ["E0923", "E0923"]);
    assert!(error.to_string().contains("`walk_on`"), "{error}");
    assert!(!folder.join("walker.rs").exists());
}

#[test]
fn files_that_are_not_there_or_cannot_be_modules_are_named() {
    let folder = folder("names");
    let said = |name: &str| {
        generate(folder.join(name)).into(&folder).write().expect_err("it is refused").to_string()
    };
    assert!(said("none.srm").contains("cannot read"), "{}", said("none.srm"));
    assert!(said("my-role.srm").contains("lower-case letters"), "{}", said("my-role.srm"));
    assert!(said("match.srm").contains("lower-case letters"), "a keyword");
}
