//! The simulation server as a process that the body starts.

use std::ffi::OsString;
use std::fs::File;
use std::io::ErrorKind;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::connection::Connection;
use crate::error::Error;
use crate::monitor::Monitor;

/// The program, as its package installs it.
pub(crate) const PROGRAM: &str = "rcssservermj";
/// The command that installs a missing program.
const INSTALL_COMMAND: &str =
    "install it with `pip install rcsssmj==0.2.1`, or name the program in the attribute `server`";
/// The time limit for the server's first answer: Python and the physics are loaded first.
const START_TIMEOUT: Duration = Duration::from_secs(90);
/// The pause between two attempts to connect.
const RETRY_INTERVAL: Duration = Duration::from_millis(5);

/// The most names that are tried for a folder.
const MOST_FOLDERS: u32 = 1000;

/// Code that the server's Python runs first, from the server's folder: version 0.2.1 ends with an
/// error when a shape without a name touches the ball, as the K1 has.
const PYTHON_PATCH: &str = include_str!("sitecustomize.py");

/// Waits until its input ends, which it does when the run has ended in any way; then ends the
/// server and removes its folder.
const WATCH_SCRIPT: &str = r#"read _; kill -9 "$0"; rm -rf "$1""#;

/// A running server; it ends when this value is dropped, or with the process of the run, even if
/// that is killed.
#[derive(Debug)]
pub struct Server {
    process: Child,
    /// Ends the server if the run cannot; absent on systems without a Unix shell.
    watcher: Option<Child>,
    /// The folder of its log.
    folder: PathBuf,
    agents: String,
    monitors: String,
}

impl Server {
    /// Starts the server at two free ports of this computer. In lockstep it computes as fast as it
    /// can and waits for the agents in each cycle, otherwise it keeps real time.
    ///
    /// # Errors
    /// There is no such program, or it cannot be started.
    pub fn start(program: Option<&str>, lockstep: bool) -> Result<Server, Error> {
        let program = program.unwrap_or(PROGRAM);
        let [agents, monitors] = free_ports()?;
        let failed =
            |what: std::io::Error| Error::configuration(format!("the server cannot be started: {what}"));
        let name = format!("monas-rcsssmj-{}-{agents}", std::process::id());
        let folder = private_folder(&std::env::temp_dir(), &name).map_err(failed)?;
        std::fs::write(folder.join("sitecustomize.py"), PYTHON_PATCH).map_err(failed)?;
        let log = File::create(folder.join("output.log")).map_err(failed)?;
        let mut command = Command::new(program);
        command.args(["--no-render", "--host", "127.0.0.1"]);
        command.args(["--aport", &agents.to_string(), "--mport", &monitors.to_string()]);
        if lockstep {
            command.args(["--sync", "--no-realtime"]);
        }
        let errors = log.try_clone().map_err(failed)?;
        command.env("PYTHONPATH", with_python_path(&folder)?);
        command.current_dir(&folder).stdin(Stdio::null()).stdout(log).stderr(errors);
        // An interrupt from the keyboard ends the run first, and the run its server.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut process = command.spawn().map_err(|error| {
            let _ = std::fs::remove_dir_all(&folder);
            match error.kind() {
                ErrorKind::NotFound => {
                    Error::configuration(format!("there is no program `{program}`: {INSTALL_COMMAND}"))
                }
                _ => Error::configuration(format!("`{program}` cannot be started: {error}")),
            }
        })?;
        let watcher = watch(&process, &folder).map_err(|error| {
            // The server ends with the failure.
            let _ = process.kill().and_then(|()| process.wait());
            let _ = std::fs::remove_dir_all(&folder);
            failed(error)
        })?;
        let address = |port| format!("127.0.0.1:{port}");
        Ok(Server { process, watcher, folder, agents: address(agents), monitors: address(monitors) })
    }

    /// The address for agents.
    pub fn agents(&self) -> &str {
        &self.agents
    }

    /// The address for monitors.
    pub fn monitors(&self) -> &str {
        &self.monitors
    }

    /// Connects a monitor once the server runs its cycles. Version 0.2.1 fails when an agent joins
    /// in the first cycle.
    ///
    /// # Errors
    /// The server has ended, or does not answer.
    pub fn monitor(&mut self) -> Result<Monitor, Error> {
        self.answer(|server| Monitor::connect(&server.monitors).and_then(Monitor::begun))
    }

    /// A connection for an agent, once the server listens.
    pub(crate) fn agent(&mut self) -> Result<Connection, Error> {
        self.answer(|server| Connection::open(&server.agents))
    }

    /// Connects as soon as the server answers.
    #[expect(clippy::disallowed_methods, reason = "waits for another process, before the run begins")]
    fn answer<T>(&mut self, connect: impl Fn(&Server) -> Result<T, Error>) -> Result<T, Error> {
        let begun = Instant::now();
        loop {
            match connect(self) {
                Ok(connection) => return Ok(connection),
                Err(error) if begun.elapsed() > START_TIMEOUT => return Err(error),
                Err(_) => {}
            }
            if let Ok(Some(status)) = self.process.try_wait() {
                let log = std::fs::read_to_string(self.folder.join("output.log")).unwrap_or_default();
                let last = log.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("no output");
                return Err(Error::configuration(format!("the server has ended, {status}: {last}")));
            }
            crate::connection::pause(RETRY_INTERVAL);
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // A process that has ended already is not an error. The watcher ends first: it has only the
        // number of the server, which another process may have later.
        if let Some(watcher) = &mut self.watcher {
            let _ = watcher.kill();
            let _ = watcher.wait();
        }
        let _ = self.process.kill();
        let _ = self.process.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// Creates a folder that only this user can access. If one of that name exists, it gets a
/// number: Python executes what is in it, and in the folder for temporary files another user may
/// have prepared it.
fn private_folder(parent: &Path, name: &str) -> std::io::Result<PathBuf> {
    #[cfg_attr(not(unix), expect(unused_mut, reason = "there are no modes"))]
    let mut builder = std::fs::DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    let mut folder = parent.join(name);
    let mut number = 1;
    loop {
        match builder.create(&folder) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists && number < MOST_FOLDERS => {
                number += 1;
                folder = parent.join(format!("{name}-{number}"));
            }
            created => return created.map(|()| folder),
        }
    }
}

/// Starts the watcher of a server. Its input is a pipe from this process, which the system closes
/// with it.
fn watch(server: &Child, folder: &Path) -> std::io::Result<Option<Child>> {
    if !cfg!(unix) {
        return Ok(None);
    }
    let mut watcher = Command::new("sh");
    watcher.args(["-c", WATCH_SCRIPT, &server.id().to_string()]).arg(folder).current_dir("/");
    watcher.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut watcher, 0);
    watcher.spawn().map(Some)
}

/// The folders in which Python looks for modules, a further one first.
fn with_python_path(first: &Path) -> Result<OsString, Error> {
    let others = std::env::var_os("PYTHONPATH").unwrap_or_default();
    let others = std::env::split_paths(&others).filter(|folder| !folder.as_os_str().is_empty());
    let folders = std::iter::once(first.to_owned()).chain(others);
    std::env::join_paths(folders)
        .map_err(|error| Error::configuration(format!("the folder of the server: {error}")))
}

/// Two ports that are free at present.
fn free_ports() -> Result<[u16; 2], Error> {
    let failed = |error: std::io::Error| Error::configuration(format!("no free port: {error}"));
    let listen = || TcpListener::bind("127.0.0.1:0").map_err(failed);
    let (one, other) = (listen()?, listen()?);
    let port = |listener: &TcpListener| listener.local_addr().map(|at| at.port()).map_err(failed);
    Ok([port(&one)?, port(&other)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_program_is_reported_with_the_command_that_installs_it() {
        let error = Server::start(Some("no-such-rcssservermj"), true).unwrap_err();
        assert_eq!(error.kind(), crate::ErrorKind::Configuration);
        let expected =
            "there is no program `no-such-rcssservermj`: install it with `pip install rcsssmj==0.2.1`";
        assert!(error.to_string().starts_with(expected), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_program_that_ends_is_reported_with_its_status() {
        let mut server = Server::start(Some("false"), true).unwrap();
        let error = server.monitor().unwrap_err().to_string();
        assert!(error.starts_with("the server has ended, exit status: 1"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_that_another_user_has_prepared_is_not_taken() {
        use std::os::unix::fs::PermissionsExt;

        let parent = tempfile::tempdir().unwrap();
        std::fs::create_dir(parent.path().join("server")).unwrap();
        std::os::unix::fs::symlink(parent.path().join("elsewhere"), parent.path().join("server-2")).unwrap();
        let folder = private_folder(parent.path(), "server").unwrap();
        assert_eq!(folder, parent.path().join("server-3"));
        assert_eq!(folder.metadata().unwrap().permissions().mode() & 0o777, 0o700);
    }

    #[cfg(unix)]
    #[test]
    fn a_server_ends_when_the_process_of_its_run_is_gone() {
        use std::os::unix::process::ExitStatusExt;

        let folder = tempfile::tempdir().unwrap();
        let of_server = folder.path().join("server");
        std::fs::create_dir(&of_server).unwrap();
        let mut server = Command::new("sleep").arg("600").spawn().unwrap();
        let mut watcher = watch(&server, &of_server).unwrap().unwrap();
        assert!(server.try_wait().unwrap().is_none() && watcher.try_wait().unwrap().is_none());
        // The system closes the pipe of a process that is killed.
        drop(watcher.stdin.take());
        assert_eq!(server.wait().unwrap().signal(), Some(9));
        watcher.wait().unwrap();
        assert!(!of_server.exists());
    }
}
