//! The studio of a run: what is printed, and that it is no part of the run.

use crate::kit::{Answer, command};

#[test]
fn a_studio_prints_its_address_and_changes_no_result() {
    let folder = tempfile::tempdir().expect("a folder");
    let play = |more: &[&str]| -> Answer {
        let arguments = [&["run", "config/match.xml", "--for", "2s", "--seed", "7"], more].concat();
        let answer = command(&arguments).env("XDG_RUNTIME_DIR", folder.path()).output();
        answer.expect("the command starts").into()
    };
    let (viewed, alone) = (play(&["--studio", "--pace", "50"]), play(&[]));
    assert_eq!((viewed.code, alone.code), (Some(0), Some(0)), "{}", viewed.err);
    let hash = |answer: &Answer| answer.out.lines().last().map(str::to_owned);
    assert_eq!(hash(&viewed), hash(&alone));
    assert!(viewed.err.contains("studio: http://127.0.0.1:"), "{}", viewed.err);
    assert!(!alone.err.contains("studio"), "{}", alone.err);
}
