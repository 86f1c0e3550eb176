//! Starts the built command as a user would, in the folder of the workspace.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use crate::copying::copy;

/// The workspace.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the workspace is there")
}

/// The command with arguments, ready to be started.
pub(crate) fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_monas"));
    command.args(arguments).current_dir(root()).env_remove("MONAS_LOG").env_remove("NO_COLOR");
    command
}

/// The output and exit code of a command.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl From<Output> for Answer {
    fn from(output: Output) -> Answer {
        let text = |bytes| String::from_utf8(bytes).expect("the command prints UTF-8");
        Answer { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }
}

/// Runs the command to its end.
pub(crate) fn monas(arguments: &[&str]) -> Answer {
    command(arguments).output().expect("the command starts").into()
}

/// Runs the command with a text on standard input.
pub(crate) fn given(arguments: &[&str], input: &str) -> Answer {
    let mut command = command(arguments);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the command starts");
    let mut stdin = child.stdin.take().expect("it is piped");
    stdin.write_all(input.as_bytes()).expect("the command reads");
    drop(stdin);
    child.wait_with_output().expect("the command ends").into()
}

/// Starts a command in a terminal by Python's module `pty`. When its output contains a text, Ctrl-C
/// is pressed or SIGTERM sent. Prints its status, whether that was done, and its output.
const IN_TERMINAL: &str = r#"
import os, pty, signal, sys
text, action, command = sys.argv[1].encode(), sys.argv[2], sys.argv[3:]
pid, terminal = pty.fork()
if pid == 0:
    os.execv(command[0], command)
output, done = b"", False
while True:
    try:
        part = os.read(terminal, 65536)
    except OSError:
        break
    if not part:
        break
    output += part
    if not done and text in output:
        if action == "press Ctrl-C":
            os.write(terminal, b"\x03")
        else:
            os.kill(pid, signal.SIGTERM)
        done = True
_, status = os.waitpid(pid, 0)
print(os.waitstatus_to_exitcode(status), done)
print(output.decode())
"#;

/// Python with [`IN_TERMINAL`] and the command, ready for arguments of the command.
pub(crate) fn in_terminal(text: &str, action: &str) -> Command {
    let mut python = Command::new("python3");
    python.args(["-c", IN_TERMINAL, text, action, env!("CARGO_BIN_EXE_monas")]);
    python
}

/// A copy of the project's configuration and models with one text replaced, and the line of it.
pub(crate) fn changed(file: &str, text: &str, replacement: &str) -> (tempfile::TempDir, usize) {
    let folder = tempfile::tempdir().expect("a folder");
    for part in ["config", "models"] {
        copy(&root().join(part), &folder.path().join(part));
    }
    let path = folder.path().join(file);
    let original = fs::read_to_string(&path).expect("the file is there");
    let line = original.lines().position(|line| line.contains(text)).expect("the file holds the text");
    fs::write(&path, original.replacen(text, replacement, 1)).expect("the folder takes files");
    (folder, line + 1)
}
