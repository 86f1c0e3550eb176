//! Packages whose names begin alike are compiled together.
//!
//! `tests/generated` holds the code for `tests/proto/team`, which is compiled here as
//! `compile_folder` has it compiled: the packages `team` and `team.vision` in one crate.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

use std::fs;
use std::path::Path;

use narukom::{FieldKind, Message};
use narukom_build::Compiler;

#[deny(warnings)]
mod package_0 {
    include!("generated/team.rs");
}
#[deny(warnings)]
mod package_1 {
    include!("generated/team.vision.rs");
}
pub use package_0::*;
pub use package_1::*;

/// The generated files are equal to those in `tests/generated`; if NARUKOM_BUILD_BLESS is set, the
/// latter are replaced.
#[test]
fn the_generated_code_is_the_one_under_review() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let (target, proto) = (tempfile::tempdir().unwrap(), here.join("proto/team"));
    let compiler = Compiler::new().out_dir(target.path());
    let compiler = compiler.extern_package("team", "crate").extern_package("team.vision", "crate");
    let files = ["team.proto", "marker.proto", "vision.proto"].map(|name| proto.join(name));
    compiler.compile(&files, &[proto]).unwrap();
    for name in ["team.rs", "team.descriptors", "team.vision.rs", "team.vision.descriptors"] {
        let (made, kept) = (target.path().join(name), here.join("generated").join(name));
        if std::env::var_os("NARUKOM_BUILD_BLESS").is_some() {
            fs::copy(&made, &kept).unwrap();
        }
        assert!(fs::read(made).unwrap() == fs::read(kept).unwrap(), "{name} differs: look, then bless");
    }
}

#[test]
fn each_package_has_its_own_types_and_uses_those_of_the_other() {
    let marker = Marker { colour: Colour::Red.into() };
    let entry = LogEntry { text: "seen".into() };
    let seen = Seen {
        marker: Some(marker),
        shape: marker::Shape::Round.into(),
        entry: Some(entry),
        ..Seen::default()
    };
    let report = Report {
        role: report::Role::Goalie.into(),
        position: Some(report::Position { x: 1.0 }),
        seen: Some(seen),
        ..Report::default()
    };
    assert_eq!(Seen::DESCRIPTOR.full_name, "team.vision.Seen");
    let field = Report::DESCRIPTOR.field_index("seen").unwrap();
    let FieldKind::Message(found) = Report::DESCRIPTOR.fields[field].kind else { panic!("a message") };
    assert_eq!(found(), Seen::DESCRIPTOR);
    assert_eq!(report.seen.unwrap().shape(), marker::Shape::Round);
}
