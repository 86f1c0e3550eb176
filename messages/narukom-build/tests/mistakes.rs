//! Errors in a schema are reported with the name at fault.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

use std::fs;

use narukom_build::{Compiler, Error, ErrorKind};

/// Compiles the files, given as name and text, with the package mappings of the compiler.
fn compile(files: &[(&str, &str)], compiler: Compiler) -> (Result<(), Error>, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let first = folder.path().join(files[0].0);
    let result = compiler.out_dir(folder.path()).compile(&[first], &[folder.path()]);
    (result, folder)
}

fn check(text: &str, kind: ErrorKind, says: &str) {
    let error = compile(&[("a.proto", text)], Compiler::new()).0.unwrap_err();
    assert_eq!(error.kind(), kind, "{error}");
    assert!(error.to_string().contains(says), "{error}");
}

#[test]
fn a_file_that_is_no_schema_is_named_with_line_and_column() {
    check("syntax = \"proto3\";\npackage p;\nmessage {}", ErrorKind::Schema, "a.proto:3:9");
    check("syntax = \"proto3\";\npackage p;\nmessage A { Nothing n = 1; }", ErrorKind::Schema, "Nothing");
    check("syntax = \"proto3\";\npackage p;\nimport \"b.proto\";", ErrorKind::Schema, "b.proto");
}

#[test]
fn other_editions_are_refused() {
    check("syntax = \"proto2\"; package p;", ErrorKind::Syntax, "a.proto");
}

#[test]
fn a_package_is_needed() {
    check("syntax = \"proto3\";", ErrorKind::Package, "a.proto");
    check("syntax = \"proto3\"; package Monas.Soccer;", ErrorKind::Package, "Monas.Soccer");
}

#[test]
fn names_are_in_the_style_of_their_kind() {
    let file = |body: &str| format!("syntax = \"proto3\"; package p; {body}");
    check(&file("message A { int32 headYaw = 1; }"), ErrorKind::Name, "headYaw");
    check(&file("message RobotID {}"), ErrorKind::Name, "RobotID");
    check(&file("enum role { NONE = 0; }"), ErrorKind::Name, "role");
}

#[test]
fn names_are_reported_with_file_line_and_column() {
    let file = |body: &str| format!("syntax = \"proto3\";\npackage p;\n{body}");
    check(
        &file("message A { int32 n = 1;\n  int32 headYaw = 2; }"),
        ErrorKind::Name,
        "a.proto:4:9: the field `headYaw`",
    );
    check(&file("message RobotID {}"), ErrorKind::Name, "a.proto:3:9: the type `RobotID`");
    check(&file("enum role { NONE = 0; }"), ErrorKind::Name, "a.proto:3:6: the type `role`");
    let nested = "message A { map<string, int32> m = 1; message B { enum c { NONE = 0; } } }";
    check(&file(nested), ErrorKind::Name, "a.proto:3:56: the type `c`");
}

#[test]
fn types_do_not_hide_those_that_generated_code_uses() {
    let file = |body: &str| format!("syntax = \"proto3\"; package p; {body}");
    check(&file("message Option {}"), ErrorKind::Name, "a.proto:1:39: the type `Option`");
    compile(&[("a.proto", &file("message Walk { message Result {} }"))], Compiler::new()).0.unwrap();
}

/// Cargo prints what `main` of a build script returns.
#[test]
fn build_scripts_print_the_text_of_an_error() {
    let error = compile(&[("a.proto", "syntax = \"proto3\";")], Compiler::new()).0.unwrap_err();
    assert_eq!(format!("{error:?}"), error.to_string());
    assert!(error.to_string().contains("declares no package"), "{error}");
}

#[test]
fn no_file_is_written_for_a_schema_with_a_mistake() {
    let (_, folder) = compile(&[("a.proto", "syntax = \"proto2\"; package p;")], Compiler::new());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

const USER: &str =
    "syntax = \"proto3\"; package user; import \"body.proto\"; message A { body.Joint joint = 1; }";
const BODY: &str = "syntax = \"proto3\"; package body; message Joint { double angle = 1; }";

#[test]
fn messages_of_other_packages_need_a_place() {
    let error = compile(&[("a.proto", USER), ("body.proto", BODY)], Compiler::new()).0.unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Unmapped);
    assert!(error.to_string().contains("body.Joint"), "{error}");
}

#[test]
fn messages_of_other_packages_are_used_where_they_are() {
    let compiler = Compiler::new().extern_package("body", "::robot::messages");
    let (result, folder) = compile(&[("a.proto", USER), ("body.proto", BODY)], compiler);
    result.unwrap();
    let code = fs::read_to_string(folder.path().join("user.rs")).unwrap();
    assert!(code.contains("pub joint: ::core::option::Option<::robot::messages::Joint>"), "{code}");
    assert!(code.contains("<::robot::messages::Joint as ::narukom::Message>::DESCRIPTOR"), "{code}");
    assert!(!folder.path().join("body.rs").exists());
}

#[test]
fn an_output_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.proto"), BODY).unwrap();
    let nowhere = folder.path().join("nowhere");
    let compiler = Compiler::new().out_dir(&nowhere);
    let error = compiler.compile(&[folder.path().join("a.proto")], &[folder.path()]).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Output);
    assert!(error.to_string().contains("nowhere"), "{error}");
}

#[test]
fn a_package_that_continues_the_name_of_its_user_needs_a_place() {
    let inner = "syntax = \"proto3\"; package team.vision; message Ball { double x = 1; }";
    let outer =
        "syntax = \"proto3\"; package team; import \"b.proto\"; message A { team.vision.Ball ball = 1; }";
    let error = compile(&[("a.proto", outer), ("b.proto", inner)], Compiler::new()).0.unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Unmapped);
    assert!(error.to_string().contains("team.vision.Ball"), "{error}");
}
