//! Ctrl-C in a terminal.

use std::fmt::Write;
use std::fs;

use crate::kit::in_terminal;

/// A chart whose checks take several seconds.
fn large() -> String {
    let mut text = String::from("IAC: r\n\nStates:\n  r OR\n    START\n    B BASIC\n    END\n");
    let count = 60_000;
    (0..count).for_each(|number| writeln!(text, "    A{number} BASIC").expect("a text"));
    text += "\nTransitions:\n  START -> A0\n";
    for number in 1..count {
        let from = number - 1;
        writeln!(text, "  A{from} -> A{number} : [Ball.x > 3 && Ball.y < 3]\n  A{from} -> B : [Ball.z == 2]")
            .expect("a text");
    }
    text
}

#[test]
fn ctrl_c_during_checks_gives_what_is_known() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("large.iac");
    fs::write(&model, large()).expect("a file");
    let mut python = in_terminal("Ctrl-C gives what is known", "press Ctrl-C");
    let Ok(output) = python.args(["model", "check", "--unlinked"]).arg(&model).output() else {
        println!("SKIPPED: Python is not there, so that no terminal is interrupted");
        return;
    };
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.starts_with("130 True\n"), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let last = text.lines().rfind(|line| line.contains("60004 nodes")).unwrap_or_default();
    assert!(last.contains("not finished") && last.contains("stopped"), "{text}");
    assert!(text.contains("[M02]"), "what is known is printed: {text}");
}
