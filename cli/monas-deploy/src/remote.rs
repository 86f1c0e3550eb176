//! Executes tasks on a robot over ssh.

use std::io::{self, Write};
use std::process::{Command, Output, Stdio};
use std::thread;

use crate::robot::Robot;
use crate::shell::quoted;

/// The script with all tasks.
const SCRIPT: &str = include_str!("robot.sh");

/// The exit code of `ssh` if it cannot connect.
const SSH_FAILED: i32 = 255;

/// Why a task failed.
#[derive(Debug)]
pub(crate) enum RemoteError {
    /// The robot cannot be reached; the output of ssh.
    Unreachable(String),
    /// The task ended with this exit code and this output.
    Task(i32, String),
}

/// The output of a task.
#[derive(Debug)]
pub(crate) struct RemoteReply(String);

impl RemoteReply {
    /// The values of a key: the rest of each line that begins with `@` and the key.
    pub(crate) fn of<'s>(&'s self, thing: &'s str) -> impl Iterator<Item = &'s str> {
        self.0.lines().filter_map(move |line| {
            let rest = line.strip_prefix('@')?.strip_prefix(thing)?;
            rest.strip_prefix(' ').map(str::trim).filter(|rest| !rest.is_empty())
        })
    }
}

/// Writes the standard input of a task.
pub(crate) type InputWriter<'f> = dyn Fn(&mut dyn Write) -> io::Result<()> + Sync + 'f;

/// Executes a task of the script with its arguments. `input` writes the task's standard input.
///
/// # Errors
/// The robot cannot be reached, or the task fails.
pub(crate) fn task(
    robot: &Robot,
    arguments: &[&str],
    feed: Option<&InputWriter<'_>>,
) -> Result<RemoteReply, RemoteError> {
    // Standard input belongs to the task, so the script is passed as an argument.
    let words = ["sh", "-c", SCRIPT, "monas-deploy"].into_iter();
    let words = words.chain([arguments[0], &*robot.folder]).chain(arguments[1..].iter().copied());
    let line = words.map(quoted).collect::<Vec<_>>().join(" ");
    let output = run_ssh(robot, &line, feed).map_err(|error| {
        RemoteError::Unreachable(format!("`{}` does not start: {error}", robot.ssh.join(" ")))
    })?;
    let error = String::from_utf8_lossy(&output.stderr).trim_end().to_owned();
    match output.status.code() {
        Some(0) => Ok(RemoteReply(String::from_utf8_lossy(&output.stdout).into_owned())),
        Some(SSH_FAILED) => Err(RemoteError::Unreachable(error)),
        code => Err(RemoteError::Task(code.unwrap_or(-1), error)),
    }
}

fn run_ssh(robot: &Robot, line: &str, feed: Option<&InputWriter<'_>>) -> io::Result<Output> {
    let (program, first) = robot.ssh.split_first().ok_or_else(|| io::Error::other("no command is named"))?;
    let mut process = Command::new(program)
        .args(first)
        .args(["-o", "BatchMode=yes", "-o", "ConnectTimeout=10", "--", &robot.address, line])
        .stdin(if feed.is_some() { Stdio::piped() } else { Stdio::null() })
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let input = process.stdin.take();
    thread::scope(|threads| {
        if let (Some(feed), Some(mut input)) = (feed, input) {
            // If the robot stops reading, the exit status of the task gives the reason.
            threads.spawn(move || feed(&mut input).and_then(|()| input.flush()).is_ok());
        }
        process.wait_with_output()
    })
}

#[cfg(test)]
mod tests {
    use super::RemoteReply;

    #[test]
    fn values_follow_their_key() {
        let reply = RemoteReply("@release a\nnoise\n@release b \n@current b\n@previous\n".into());
        assert_eq!(reply.of("release").collect::<Vec<_>>(), ["a", "b"]);
        assert_eq!(reply.of("current").next(), Some("b"));
        assert_eq!(reply.of("previous").next(), None, "a key without a value");
    }
}
