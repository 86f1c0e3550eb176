//! Robots of a match whose agents run in processes of their own.

use std::io::{self, Read, Write};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use monas_link::control::ControlSocket;
use monas_link::default_folder;
use monas_match::MatchPlan;
use monas_terminal::{Format, WallClock};
use rustix::process::{Pid, Signal, kill_process};
use tempfile::{NamedTempFile, TempDir};

use super::RunArguments;

/// The variable that names the process of the match to that of a robot.
const PROCESS_VARIABLE: &str = "MONAS_MATCH_PROCESS";
/// Minimum time between two starts of a process that ends by itself.
const RESTART_INTERVAL: Duration = Duration::from_secs(1);
/// Time limit for the end of a process, whose robot sits down first.
const END_LIMIT: Duration = Duration::from_secs(8);

/// The processes of the robots that have one of their own.
pub(super) struct RobotProcesses {
    robots: Vec<RobotProcess>,
    /// The folder of the sockets of their bodies, which is removed with this value.
    _folder: Option<TempDir>,
}

/// A robot and its process.
struct RobotProcess {
    host: String,
    arguments: Vec<String>,
    process: Option<Running>,
    starts: u32,
}

/// A process that has been started.
struct Running {
    child: Child,
    /// The file for its results.
    results: NamedTempFile,
    clock: WallClock,
}

/// The results that the process of a robot has written.
pub(super) struct RobotResults {
    host: String,
    starts: u32,
    text: String,
}

impl RobotProcesses {
    /// Lets a match serve the bodies of the robots that have processes.
    pub(super) fn prepare(
        plan: MatchPlan,
        arguments: &RunArguments,
        socket: Option<&ControlSocket>,
    ) -> io::Result<(MatchPlan, RobotProcesses)> {
        let hosts = plan.processes();
        if hosts.is_empty() {
            return Ok((plan, RobotProcesses { robots: Vec::new(), _folder: None }));
        }
        let parent = default_folder().map_err(io::Error::other)?;
        monas_files::private_folder(&parent)?;
        let folder = tempfile::Builder::new().prefix("bodies-").tempdir_in(parent)?;
        let robots = hosts.into_iter().map(|host| RobotProcess {
            arguments: robot_arguments(&host, arguments, folder.path(), socket),
            host,
            process: None,
            starts: 0,
        });
        let robots = robots.collect();
        let at = folder.path().to_owned();
        let plan = plan.serve_bodies(move |host| address(&at, host).display().to_string());
        Ok((plan, RobotProcesses { robots, _folder: Some(folder) }))
    }

    /// Starts the processes that have not been started, and those that have ended by themselves.
    pub(super) fn watch(&mut self) {
        for robot in &mut self.robots {
            if let Err(error) = robot.watch() {
                tracing::error!(robot = %robot.host, "its process cannot be started: {error}");
            }
        }
    }

    /// Ends all processes and returns what they have written.
    pub(super) fn end(mut self) -> Vec<RobotResults> {
        for robot in &mut self.robots {
            robot.process.iter().for_each(Running::terminate);
        }
        self.robots.drain(..).map(RobotProcess::end).collect()
    }
}

impl Drop for RobotProcesses {
    fn drop(&mut self) {
        for robot in &mut self.robots {
            if let Some(running) = &mut robot.process {
                // It may have ended.
                let _ = running.child.kill();
                let _ = running.child.wait();
            }
        }
    }
}

fn address(folder: &Path, host: &str) -> PathBuf {
    folder.join(host)
}

/// The arguments of the process of a robot.
fn robot_arguments(
    host: &str,
    arguments: &RunArguments,
    folder: &Path,
    socket: Option<&ControlSocket>,
) -> Vec<String> {
    let text = |path: &Path| path.display().to_string();
    let format = match arguments.format.value {
        Format::Text => "text",
        Format::Json => "json",
    };
    let mut all = vec!["--quiet".to_owned(), "run".to_owned(), text(&arguments.config)];
    let fixed = ["--only", host, "--body", &text(&address(folder, host)), "--format", format];
    all.extend(fixed.map(str::to_owned));
    match socket.and_then(|socket| socket.path().file_stem()) {
        Some(name) => all.extend(["--control".to_owned(), format!("{}-{host}", name.to_string_lossy())]),
        None => all.push("--no-control".to_owned()),
    }
    for setting in &arguments.layers.settings {
        all.extend(["--set".to_owned(), setting.clone()]);
    }
    all
}

impl RobotProcess {
    fn watch(&mut self) -> io::Result<()> {
        let RobotProcess { host, process, .. } = self;
        if let Some(running) = process {
            let Some(status) = running.child.try_wait()? else { return Ok(()) };
            if running.clock.elapsed() < RESTART_INTERVAL {
                return Ok(());
            }
            tracing::warn!(robot = %host, "its process has ended, {status}, and is started again");
        }
        // If the start fails, the next attempt follows after the same time.
        self.process = None;
        self.start()
    }

    fn start(&mut self) -> io::Result<()> {
        let results = NamedTempFile::new()?;
        let child = Command::new(std::env::current_exe()?)
            .args(&self.arguments)
            .env(PROCESS_VARIABLE, std::process::id().to_string())
            .stdin(Stdio::null())
            .stdout(results.reopen()?)
            // Ctrl-C reaches the match only, which ends its robots in order.
            .process_group(0)
            .spawn()?;
        self.process = Some(Running { child, results, clock: WallClock::start() });
        self.starts += 1;
        Ok(())
    }

    fn end(mut self) -> RobotResults {
        let text = self.process.take().map(Running::end).unwrap_or_default();
        RobotResults { host: self.host, starts: self.starts, text }
    }
}

impl Running {
    fn terminate(&self) {
        if let Some(process) = i32::try_from(self.child.id()).ok().and_then(Pid::from_raw) {
            // It may have ended.
            let _ = kill_process(process, Signal::TERM);
        }
    }

    /// Waits for the end of a process that was asked to end, and returns what it has written.
    fn end(mut self) -> String {
        let clock = WallClock::start();
        clock.wait_until_or(END_LIMIT, || !matches!(self.child.try_wait(), Ok(None)));
        let _ = self.child.kill();
        let _ = self.child.wait();
        let mut text = String::new();
        match self.results.read_to_string(&mut text) {
            Ok(_) => text,
            Err(error) => {
                tracing::error!("the results of a robot's process cannot be read: {error}");
                String::new()
            }
        }
    }
}

impl RobotResults {
    /// Writes the results: as objects as they are, otherwise below a heading.
    pub(super) fn write(&self, out: &mut dyn Write, format: Format) -> io::Result<()> {
        if format == Format::Text {
            let RobotResults { host, starts, .. } = self;
            let starts = if *starts == 1 { String::new() } else { format!(", started {starts} times") };
            writeln!(out, "\n{host}, in a process of its own{starts}")?;
        }
        out.write_all(self.text.as_bytes())
    }
}

/// Lets this process end with that of the match that has started it, however that ends.
pub(super) fn end_with_parent() {
    let Some(parent) = std::env::var(PROCESS_VARIABLE).ok().and_then(|id| id.parse().ok()) else { return };
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::process::set_parent_process_death_signal(Some(Signal::TERM)) {
        tracing::warn!("this process will not end with that of the match: {error}");
    }
    if rustix::process::getppid().map(Pid::as_raw_pid) != Some(parent) {
        // It has ended meanwhile.
        let _ = kill_process(rustix::process::getpid(), Signal::TERM);
    }
}
