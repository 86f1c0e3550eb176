//! A run in the background, with a separate folder for sockets.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, ChildStderr, ChildStdout, Command, Stdio};

use serde_json::Value;

use crate::kit::{Answer, command};

/// A run that is stopped when dropped.
pub(crate) struct Running {
    child: Child,
    out: Option<ChildStdout>,
    err: Option<BufReader<ChildStderr>>,
}

impl Running {
    /// Starts a run with its sockets in a folder, and waits for a line on standard error with this
    /// prefix.
    pub(crate) fn start(folder: &Path, arguments: &[&str], begin: &str) -> Running {
        Running::of(&mut in_folder(folder, arguments), begin)
    }

    /// Starts a prepared command likewise.
    pub(crate) fn of(command: &mut Command, begin: &str) -> Running {
        let mut child =
            command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the command starts");
        let out = child.stdout.take();
        let mut err = BufReader::new(child.stderr.take().expect("it is piped"));
        let (mut line, mut said) = (String::new(), String::new());
        while !line.starts_with(begin) {
            line.clear();
            assert!(err.read_line(&mut line).expect("it says something") > 0, "it ended with:\n{said}");
            said += &line;
        }
        Running { child, out, err: Some(err) }
    }

    /// Reads standard error up to a line with this text.
    pub(crate) fn await_line(&mut self, part: &str) {
        let err = self.err.as_mut().expect("it is not read to its end");
        let mut said = String::new();
        while !said.lines().last().is_some_and(|line| line.contains(part)) {
            assert!(err.read_line(&mut said).expect("it says something") > 0, "it ended with:\n{said}");
        }
    }

    /// Interrupts the run like Ctrl-C.
    pub(crate) fn interrupt(mut self) -> Answer {
        signal("-INT", self.child.id());
        self.wait()
    }

    /// Interrupts the run again and again until it ends.
    pub(crate) fn interrupt_until_the_end(mut self) -> Answer {
        while self.child.try_wait().expect("it is a child").is_none() {
            signal("-INT", self.child.id());
        }
        self.wait()
    }

    /// Asks the run to end, as a service manager does.
    pub(crate) fn terminate(mut self) -> Answer {
        signal("-TERM", self.child.id());
        self.wait()
    }

    /// Interrupts the run, and asks it to end at the same time, as a program does that passes its
    /// signals on.
    pub(crate) fn interrupt_and_terminate(mut self) -> Answer {
        let process = self.child.id();
        let signals = format!("kill -INT {process}; kill -TERM {process}");
        assert!(Command::new("sh").args(["-c", &signals]).status().expect("there is a shell").success());
        self.wait()
    }

    /// Waits for its end.
    pub(crate) fn wait(&mut self) -> Answer {
        let (mut out, mut err) = (String::new(), String::new());
        // Both outputs are short enough not to fill a pipe while the other is read.
        self.out.take().expect("it is read once").read_to_string(&mut out).expect("it prints UTF-8");
        self.err.take().expect("it is read once").read_to_string(&mut err).expect("it prints UTF-8");
        Answer { code: self.child.wait().expect("it ends").code(), out, err }
    }

    /// As `kill -9` does.
    pub(crate) fn kill(mut self) {
        self.child.kill().expect("it is killed");
        self.child.wait().expect("it ends");
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn signal(name: &str, process: u32) {
    let sent = Command::new("kill").args([name, &process.to_string()]).status();
    assert!(sent.expect("there is a kill").success());
}

/// The command, with the sockets of runs in a folder.
pub(crate) fn in_folder(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = command(arguments);
    command.env("XDG_RUNTIME_DIR", folder);
    command
}

/// The output of the command, with the sockets of runs in a folder.
pub(crate) fn ask(folder: &Path, arguments: &[&str]) -> Answer {
    in_folder(folder, arguments).output().expect("the command starts").into()
}

/// The JSON objects in an output, one per line.
pub(crate) fn objects(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).expect("each line is JSON")).collect()
}
