//! Ctrl-C in a terminal, by Python's module `pty`.

use std::fmt::Write;
use std::fs;
use std::process::Command;

/// Starts a command in a terminal, presses Ctrl-C when its progress offers it, and prints its
/// status and its output.
const IN_TERMINAL: &str = r#"
import os, pty, sys
pid, terminal = pty.fork()
if pid == 0:
    os.execv(sys.argv[1], sys.argv[1:])
output, pressed = b"", False
while True:
    try:
        part = os.read(terminal, 65536)
    except OSError:
        break
    if not part:
        break
    output += part
    if not pressed and b"Ctrl-C gives what is known" in output:
        os.write(terminal, b"\x03")
        pressed = True
_, status = os.waitpid(pid, 0)
print(os.waitstatus_to_exitcode(status), pressed)
print(output.decode())
"#;

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
    let mut python = Command::new("python3");
    python.args(["-c", IN_TERMINAL, env!("CARGO_BIN_EXE_monas"), "model", "check", "--unlinked"]).arg(&model);
    let Ok(output) = python.output() else {
        println!("SKIPPED: Python is not there, so that no terminal is interrupted");
        return;
    };
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.starts_with("130 True\n"), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let last = text.lines().rfind(|line| line.contains("60004 nodes")).unwrap_or_default();
    assert!(last.contains("not finished") && last.contains("stopped"), "{text}");
    assert!(text.contains("[M02]"), "what is known is printed: {text}");
}
