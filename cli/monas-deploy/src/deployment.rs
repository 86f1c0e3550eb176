//! Installs releases on a robot, and goes back to earlier ones.

use std::io::Write;

use crate::error::{Error, ErrorKind};
use crate::release::Release;
use crate::remote::{RemoteError, RemoteReply, task};
use crate::robot::Robot;

/// Exit codes of the tasks in `robot.sh`.
const EXIT_DIFFERENT: i32 = 21;
const NO_START: i32 = 22;
const EXIT_ROLLED_BACK: i32 = 23;
const NOTHING_BACK: i32 = 24;

/// The releases of one robot.
#[derive(Clone, Copy, Debug)]
pub struct Deployment<'r> {
    robot: &'r Robot,
}

/// The result of [`Deployment::install`].
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Installation {
    /// Whether the release was copied; otherwise the robot had it already.
    pub is_copied: bool,
    /// The release that ran before.
    pub previous: Option<String>,
    /// The service that keeps the program running, as text.
    pub service: String,
}

/// The result of [`Deployment::roll_back`].
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Rollback {
    /// The release that runs again.
    pub release: String,
    /// The service that keeps the program running, as text.
    pub service: String,
}

/// The releases on a robot, by name.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct InstalledReleases {
    /// All of them.
    pub names: Vec<String>,
    /// The one that runs.
    pub current: Option<String>,
    /// The one that ran before it.
    pub previous: Option<String>,
}

impl<'r> Deployment<'r> {
    /// The releases of this robot.
    pub fn new(robot: &'r Robot) -> Deployment<'r> {
        Deployment { robot }
    }

    /// Copies a release to the robot unless it is there already, checks it there, and makes it the
    /// current one. If it does not keep running, the release before it becomes the current one
    /// again.
    ///
    /// # Errors
    /// The robot cannot be reached, the copy differs, the program does not start there, or it does
    /// not keep running.
    pub fn install(&self, release: &Release) -> Result<Installation, Error> {
        let there = self.releases()?;
        let is_copied = !there.names.contains(&release.name);
        if is_copied {
            self.copy(release)?;
        }
        let service = self.run(&release.name)?;
        let previous = there.current.filter(|before| *before != release.name);
        Ok(Installation { is_copied, previous, service })
    }

    /// Makes the release before the current one the current one.
    ///
    /// # Errors
    /// There is none, the robot cannot be reached, or the release does not keep running.
    pub fn roll_back(&self) -> Result<Rollback, Error> {
        let Some(release) = self.releases()?.previous else {
            return Err(self.failed("there is no release before the current one"));
        };
        let service = self.run(&release)?;
        Ok(Rollback { release, service })
    }

    /// The releases on the robot.
    ///
    /// # Errors
    /// The robot cannot be reached.
    pub fn releases(&self) -> Result<InstalledReleases, Error> {
        let reply: RemoteReply = task(self.robot, &["look"], None).map_err(|error| self.failure(error))?;
        let one = |thing| reply.of(thing).next().map(str::to_owned);
        Ok(InstalledReleases {
            names: reply.of("release").map(str::to_owned).collect(),
            current: one("current"),
            previous: one("previous"),
        })
    }

    /// Copies a release to the robot and has it checked there.
    fn copy(&self, release: &Release) -> Result<(), Error> {
        let robot = self.robot;
        let input = |into: &mut dyn Write| release.write(into);
        task(robot, &["receive", &release.name], Some(&input)).map_err(|error| self.failure(error))?;
        let checked = task(robot, &["check", &release.name, &release.program], None);
        checked.map(drop).map_err(|error| match error {
            RemoteError::Task(EXIT_DIFFERENT, output) => self.failed(&format!(
                "the copy differs from the release and is not used: {output}"
            )),
            RemoteError::Task(NO_START, output) => {
                let target = robot.target.as_deref().unwrap_or("this computer");
                self.failed(&format!(
                    "the program does not start on the robot, and is not used; it was compiled for {target}: {output}"
                ))
            }
            error => self.failure(error),
        })
    }

    /// Makes a release the current one, and returns what keeps it running.
    fn run(&self, release: &str) -> Result<String, Error> {
        let robot = self.robot;
        let (unit, settle) = (format!("monas-{}", robot.name), robot.settle.as_secs().max(1).to_string());
        let reply = task(robot, &["run", release, &unit, &robot.service, &settle], None);
        let reply = reply.map_err(|error| match error {
            RemoteError::Task(EXIT_ROLLED_BACK, output) => {
                self.failed(&format!("release {release} did not keep running for {settle} s: the previous one runs again. Its last output: {output}"))
            }
            RemoteError::Task(NOTHING_BACK, output) => {
                self.failed(&format!("release {release} did not keep running for {settle} s, and no previous release starts: nothing runs. Its last output: {output}"))
            }
            error => self.failure(error),
        })?;
        Ok(match reply.of("service").next() {
            Some("systemd") => format!("systemd, unit {unit}.service of the user"),
            Some("script") => format!("{}/service, to be called by the robot's start-up", robot.folder),
            _ => "no service: start it with `current/start`".into(),
        })
    }

    fn failure(&self, error: RemoteError) -> Error {
        match error {
            RemoteError::Unreachable(output) => {
                let Robot { name, address, .. } = self.robot;
                Error::new(ErrorKind::Unreachable, format!("{name} cannot be reached at {address}: {output}"))
            }
            RemoteError::Task(code, output) => {
                self.failed(&format!("a step failed on the robot (exit code {code}): {output}"))
            }
        }
    }

    fn failed(&self, message: &str) -> Error {
        Error::new(ErrorKind::Remote, format!("{}: {message}", self.robot.name))
    }
}
