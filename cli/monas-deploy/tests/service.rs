//! The script that starts and stops a release on a robot without a service manager, executed here.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)] // a test may fail

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

const TASKS: &str = include_str!("../src/robot.sh");

/// A robot's folder with one release, whose program sleeps.
struct RobotFolder(tempfile::TempDir);

impl RobotFolder {
    fn new() -> RobotFolder {
        let folder = tempfile::tempdir().unwrap();
        let release = folder.path().join("releases/one");
        fs::create_dir_all(&release).unwrap();
        let start = release.join("start");
        fs::write(&start, "#!/bin/sh\necho started\nexec sleep 600\n").unwrap();
        fs::set_permissions(&start, fs::Permissions::from_mode(0o755)).unwrap();
        RobotFolder(folder)
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn file(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    /// Makes the release the current one, as `monas deploy` does.
    fn deploy(&self) -> Output {
        let mut task = Command::new("sh");
        task.args(["-c", TASKS, "monas-deploy", "run"]).arg(self.path()).args(["one", "unit", "script", "1"]);
        task.output().unwrap()
    }

    /// Whether the service does what is requested.
    fn service(&self, request: &str) -> bool {
        Command::new(self.file("service")).arg(request).stdin(Stdio::null()).status().unwrap().success()
    }

    fn process(&self) -> String {
        let text = fs::read_to_string(self.file("service.pid")).unwrap();
        text.split(' ').next().unwrap().trim().to_owned()
    }
}

impl Drop for RobotFolder {
    fn drop(&mut self) {
        let _ = Command::new(self.file("service")).arg("stop").output();
    }
}

/// A process that the robot's service has not started.
struct Unrelated(Child);

impl Unrelated {
    fn start() -> Unrelated {
        Unrelated(Command::new("sleep").arg("600").spawn().unwrap())
    }

    fn lives(&mut self) -> bool {
        self.0.try_wait().unwrap().is_none()
    }
}

impl Drop for Unrelated {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn lives(process: &str) -> bool {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    !status.is_empty() && !status.contains("State:\tZ")
}

#[test]
fn a_number_that_another_process_has_now_is_neither_taken_for_the_service_nor_stopped() {
    let robot = RobotFolder::new();
    let deployed = robot.deploy();
    assert!(deployed.status.success(), "{deployed:?}");
    assert!(robot.service("status"));
    let first = robot.process();
    assert!(lives(&first) && robot.service("stop") && !lives(&first) && !robot.service("status"));

    // After a crash or a boot the file names a number that another process has.
    let mut unrelated = Unrelated::start();
    let start_and_boot = "123456 00000000-0000-0000-0000-000000000000";
    for stale in [format!("{}\n", unrelated.0.id()), format!("{} {start_and_boot}\n", unrelated.0.id())] {
        fs::write(robot.file("service.pid"), &stale).unwrap();
        assert!(!robot.service("status"), "{stale}");
        assert!(robot.service("stop") && unrelated.lives(), "{stale}");
        fs::write(robot.file("service.pid"), &stale).unwrap();
        assert!(robot.service("start") && robot.service("status") && unrelated.lives(), "{stale}");
        assert_ne!(robot.process(), unrelated.0.id().to_string());
        assert!(robot.service("stop") && unrelated.lives());
    }
    for odd in ["", "\n", "-1\n", "1; echo\n", "x\n"] {
        fs::write(robot.file("service.pid"), odd).unwrap();
        assert!(!robot.service("status") && robot.service("stop"), "{odd:?}");
    }
}

#[test]
fn starting_a_running_service_starts_no_second_one() {
    let robot = RobotFolder::new();
    assert!(robot.deploy().status.success());
    let first = robot.process();
    assert!(robot.service("start"));
    assert_eq!(robot.process(), first);
}

#[test]
fn the_output_of_runs_before_stays() {
    let robot = RobotFolder::new();
    assert!(robot.deploy().status.success() && robot.service("stop"));
    for run in 1..=7 {
        fs::write(robot.file("service.log"), format!("run {run}")).unwrap();
        assert!(robot.service("start") && robot.service("stop"));
    }
    for (name, run) in [("service.log.1", "run 7"), ("service.log.5", "run 3")] {
        assert_eq!(fs::read_to_string(robot.file(name)).unwrap(), run, "{name}");
    }
    assert!(!robot.file("service.log.6").exists());
}

#[test]
fn a_unit_of_systemd_names_a_folder_with_blanks_and_specifiers() {
    let site = tempfile::tempdir().unwrap();
    let folder = site.path().join("mo nas %h 50% $HOME");
    fs::create_dir_all(folder.join("releases/one")).unwrap();
    let tools = site.path().join("tools");
    fs::create_dir(&tools).unwrap();
    // The services of this computer are not touched.
    for program in [tools.join("systemctl"), folder.join("releases/one/start")] {
        fs::write(&program, "#!/bin/sh\n").unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    }
    let mut task = Command::new("sh");
    task.args(["-c", TASKS, "monas-deploy", "run"]).arg(&folder).args(["one", "unit", "systemd", "1"]);
    let path = format!("{}:{}", tools.display(), std::env::var("PATH").unwrap());
    let deployed = task.env("PATH", path).env("XDG_CONFIG_HOME", site.path()).output().unwrap();
    assert!(deployed.status.success(), "{deployed:?}");
    let unit = site.path().join("systemd/user/unit.service");
    let text = fs::read_to_string(&unit).unwrap();
    assert!(text.contains("/mo nas %%h 50%% $HOME/current/start\"\n"), "{text}");
    // Not every computer has systemd.
    let mut verify = Command::new("systemd-analyze");
    verify.args(["--user", "verify"]).arg(&unit).env("XDG_RUNTIME_DIR", site.path());
    if let Ok(verified) = verify.output() {
        let said = String::from_utf8_lossy(&verified.stderr).into_owned();
        assert_eq!((verified.status.code(), said.as_str()), (Some(0), ""), "{text}");
    }
}
