//! Separate processes, linked by the sockets of one computer: they exchange ball and commands, are
//! killed, and come back.
#![cfg(all(unix, feature = "local"))]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::disallowed_methods,
    reason = "other processes need real time; what is awaited is awaited with a limit, and never slept for"
)]

use std::ffi::OsStr;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

const TIMEOUT: Duration = Duration::from_secs(30);

/// The example `player`, in the folder next to this test.
fn player() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    test.parent().unwrap().parent().unwrap().join("examples/player")
}

struct Player {
    process: Child,
    lines: Receiver<String>,
}

impl Player {
    fn new(role: &str, transport: &str, address: impl AsRef<OsStr>) -> Player {
        let mut command = Command::new(player());
        command.args([role, transport]).arg(address).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut process = command.spawn().unwrap();
        let output = BufReader::new(process.stdout.take().unwrap());
        let (sender, lines) = channel();
        thread::spawn(move || output.lines().map_while(Result::ok).try_for_each(|line| sender.send(line)));
        Player { process, lines }
    }

    /// The next line with this beginning.
    fn line(&self, begin: &str) -> String {
        let end = Instant::now() + TIMEOUT;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let line =
                self.lines.recv_timeout(left).unwrap_or_else(|error| panic!("no line `{begin}`: {error}"));
            if line.starts_with(begin) {
                return line;
            }
        }
    }

    /// Stops it normally, and returns its counters.
    fn stop(mut self) -> String {
        drop(self.process.stdin.take());
        let line = self.line("received");
        assert!(self.process.wait().unwrap().success());
        line
    }

    /// Kills it, like `kill -9`.
    fn kill(mut self) {
        self.process.kill().unwrap();
        self.process.wait().unwrap();
    }
}

/// One of the counters.
fn figure(line: &str, name: &str) -> u64 {
    let rest = line.split(&format!("{name}: ")).nth(1).unwrap();
    rest.chars().take_while(char::is_ascii_digit).collect::<String>().parse().unwrap()
}

fn check(line: &str) {
    let of = |name| figure(line, name);
    assert_eq!(
        of("arrived"),
        of("delivered") + of("duplicates") + of("late") + of("refused") + of("held"),
        "{line}"
    );
    assert_eq!(of("last") - of("start"), of("delivered") + of("gaps") + of("held") + of("missing"), "{line}");
}

/// The robot is killed twice, and restarted.
fn ball_and_commands_pass_and_a_killed_process_reconnects(transports: [&str; 2], address: impl AsRef<OsStr>) {
    let coach = Player::new("coach", transports[0], &address);
    for _ in 0..2 {
        let robot = Player::new("robot", transports[1], &address);
        coach.line("ball");
        robot.line("command of coach: kick");
        robot.kill();
    }
    let robot = Player::new("robot", transports[1], &address);
    robot.line("command of coach: kick");
    check(&robot.stop());
    let line = coach.stop();
    check(&line);
    assert!(figure(&line, "delivered") > 0, "{line}");
    assert_eq!(figure(&line, "gaps"), 0, "{line}");
}

#[test]
fn over_local_sockets_a_killed_process_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    ball_and_commands_pass_and_a_killed_process_reconnects(["local", "local"], folder.path().join("links"));
}

#[cfg(feature = "zenoh")]
#[test]
fn over_zenoh_a_killed_process_comes_back() {
    let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    ball_and_commands_pass_and_a_killed_process_reconnects(
        ["listen", "connect"],
        format!("tcp/127.0.0.1:{port}"),
    );
}

#[test]
fn two_processes_of_one_name_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let links = folder.path().join("links");
    let robot = Player::new("robot", "local", &links);
    let coach = Player::new("coach", "local", &links);
    robot.line("command");
    let mut second = Command::new(player());
    let output = second.arg("robot").arg("local").arg(&links).stdin(Stdio::null()).output().unwrap();
    assert!(!output.status.success());
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("another process has a link of this name"), "{said}");
    robot.kill();
    coach.kill();
}
