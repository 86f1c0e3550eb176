//! Has a robot do things, over ssh.

use std::io::{self, Write};
use std::process::{Command, Output, Stdio};
use std::thread;

use super::quoted;
use super::robots::RobotEntry;

/// What the robot does; see there.
const SCRIPT: &str = include_str!("robot.sh");

/// With this code `ssh` ends if it has not reached the robot.
const UNREACHED: i32 = 255;

/// Why a robot has not done what it was asked for.
#[derive(Debug)]
pub(super) enum Refusal {
    /// It was not reached.
    Unreached(String),
    /// A task ended with this code, and said this.
    Task(i32, String),
}

/// What the robot said: the words for the command.
#[derive(Debug)]
pub(super) struct Said(String);

impl Said {
    /// What is said of a thing: the rest of each line that begins with `@` and its name.
    pub(super) fn of<'s>(&'s self, thing: &'s str) -> impl Iterator<Item = &'s str> {
        self.0.lines().filter_map(move |line| {
            let rest = line.strip_prefix('@')?.strip_prefix(thing)?;
            rest.strip_prefix(' ').map(str::trim).filter(|rest| !rest.is_empty())
        })
    }
}

/// Writes what a task reads.
pub(super) type Feed<'f> = dyn Fn(&mut dyn Write) -> io::Result<()> + Sync + 'f;

/// Has the robot do a task of the script, with its arguments. `feed` writes what the task reads.
///
/// # Errors
/// The robot is not reached, or the task fails.
pub(super) fn task(robot: &RobotEntry, arguments: &[&str], feed: Option<&Feed<'_>>) -> Result<Said, Refusal> {
    // Standard input is for what the task reads, so the script is an argument.
    let words = ["sh", "-c", SCRIPT, "monas-deploy"].into_iter();
    let words = words.chain([arguments[0], &*robot.folder]).chain(arguments[1..].iter().copied());
    let line = words.map(quoted).collect::<Vec<_>>().join(" ");
    let output = spoken(robot, &line, feed)
        .map_err(|error| Refusal::Unreached(format!("`{}` does not start: {error}", robot.ssh.join(" "))))?;
    let error = String::from_utf8_lossy(&output.stderr).trim_end().to_owned();
    match output.status.code() {
        Some(0) => Ok(Said(String::from_utf8_lossy(&output.stdout).into_owned())),
        Some(UNREACHED) => Err(Refusal::Unreached(error)),
        code => Err(Refusal::Task(code.unwrap_or(-1), error)),
    }
}

fn spoken(robot: &RobotEntry, line: &str, feed: Option<&Feed<'_>>) -> io::Result<Output> {
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
            // A robot that stops reading says why when it ends.
            threads.spawn(move || feed(&mut input).and_then(|()| input.flush()).is_ok());
        }
        process.wait_with_output()
    })
}
