//! `monas deploy`: brings the program, the configuration and the models to a robot, and has it run them.
//!
//! What is brought is a *release*: a folder on the robot with a name that is the hash of all in it. Nothing of it is used before every file has been held against its hash there and
//! the program has started once. Then the release becomes the current one and its service starts; if it does not go on, the release before comes back.

mod build;
mod modules;
mod release;
mod remote;
mod robots;

use std::path::{Path, PathBuf};

use serde_json::json;

use crate::arguments::{DeployArguments, Format};
use crate::config::checked;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use release::Release;
use remote::{Refusal, Said, task};
use robots::RobotEntry;

pub(crate) use robots::grammar;

/// How the tasks of the script end: see there.
const DIFFERENT: i32 = 21;
const NO_START: i32 = 22;
const BACK: i32 = 23;
const NOTHING_BACK: i32 = 24;

pub(crate) fn execute(arguments: &DeployArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let robot = robots::find(&arguments.robots, &arguments.robot);
    let robot = robot.map_err(|diagnostics| Failure::Invalid(format, diagnostics))?;
    let deploying = Deploying { robot: &robot, format };
    match (arguments.list, arguments.rollback) {
        (true, _) => deploying.list(console),
        (false, true) => deploying.roll_back(console),
        (false, false) => deploying.deploy(arguments, console),
    }
}

/// Something is done with a robot.
struct Deploying<'d> {
    robot: &'d RobotEntry,
    format: Format,
}

impl Deploying<'_> {
    fn deploy(&self, arguments: &DeployArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
        let robot = self.robot;
        let left_behind = modules::left_behind(robot);
        if !left_behind.is_empty() {
            return Err(Failure::Invalid(self.format, left_behind));
        }
        checked(&robot.config, self.format)?;
        let program = self.program(arguments.program.as_deref())?;
        let release =
            Release::gather(robot, &program).map_err(|error| Failure::failed(self.format, error))?;
        if arguments.dry_run {
            return self.tell_contents(&release, console);
        }
        let there = self.ask(&["look"])?;
        let is_there = there.of("release").any(|name| name == release.name);
        if !is_there {
            self.bring(&release)?;
        }
        let service = self.run(&release.name)?;
        let before = there.of("current").next().filter(|before| *before != release.name);
        let (files, bytes) = release.size();
        match self.format {
            Format::Text => {
                let brought =
                    if is_there { "was there already" } else { "copied, each file held against its hash" };
                writeln!(
                    console.out,
                    "{}: release {}, {files} files, {bytes} bytes: {brought}",
                    robot.name, release.name
                )?;
                let before = before.map(|before| format!(" in the place of {before}")).unwrap_or_default();
                writeln!(console.out, "{}: it runs{before} ({service})", robot.name)?;
            }
            Format::Json => {
                let object = json!({ "robot": robot.name, "release": release.name, "files": files, "bytes": bytes, "copied": !is_there, "before": before, "service": service });
                writeln!(console.out, "{object}")?;
            }
        }
        Ok(Exit::Success)
    }

    /// The program that is brought: one that is named, or the one that is built now.
    fn program(&self, named: Option<&Path>) -> Result<PathBuf, Failure> {
        if let Some(named) = named {
            return Ok(named.to_owned());
        }
        let here = std::env::current_dir()?;
        build::build(&here, self.robot.target.as_deref()).map_err(|error| Failure::failed(self.format, error))
    }

    /// Copies a release to the robot and has it checked there.
    fn bring(&self, release: &Release) -> Result<(), Failure> {
        let robot = self.robot;
        let feed = |into: &mut dyn std::io::Write| release.write(into);
        task(robot, &["receive", &release.name], Some(&feed)).map_err(|refusal| self.failure(refusal))?;
        let checked = task(robot, &["check", &release.name, &release.program], None);
        checked.map(drop).map_err(|refusal| match refusal {
            Refusal::Task(DIFFERENT, said) => {
                self.failed(format!("what has arrived is not what was sent, and is not used: {said}"))
            }
            Refusal::Task(NO_START, said) => {
                let target = robot.target.as_deref().unwrap_or("this computer");
                self.failed(format!(
                    "the program does not start there, and is not used; it was compiled for {target}: {said}"
                ))
            }
            refusal => self.failure(refusal),
        })
    }

    /// Makes a release the current one; answers what keeps it running.
    fn run(&self, release: &str) -> Result<String, Failure> {
        let robot = self.robot;
        let (unit, settle) = (format!("monas-{}", robot.name), robot.settle.as_secs().max(1).to_string());
        let said = task(robot, &["run", release, &unit, &robot.service, &settle], None);
        let said = said.map_err(|refusal| match refusal {
            Refusal::Task(BACK, said) => {
                self.failed(format!("release {release} did not go on for {settle} s: the one before runs again. Its last words: {said}"))
            }
            Refusal::Task(NOTHING_BACK, said) => {
                self.failed(format!("release {release} did not go on for {settle} s, and there is no release before it that starts: nothing runs. Its last words: {said}"))
            }
            refusal => self.failure(refusal),
        })?;
        Ok(match said.of("service").next() {
            Some("systemd") => format!("systemd, unit {unit}.service of the user"),
            Some("script") => format!("{}/service, which the robot's own start-up may call", robot.folder),
            _ => "no service: start it with `current/start`".into(),
        })
    }

    /// The release before the current one becomes the current one.
    fn roll_back(&self, console: &mut Console<'_>) -> Result<Exit, Failure> {
        let there = self.ask(&["look"])?;
        let Some(previous) = there.of("previous").next() else {
            return Err(self.failed("there is no release before the current one".into()));
        };
        let service = self.run(previous)?;
        match self.format {
            Format::Text => {
                writeln!(console.out, "{}: release {previous} runs again ({service})", self.robot.name)?
            }
            Format::Json => {
                let object = json!({ "robot": self.robot.name, "release": previous, "service": service });
                writeln!(console.out, "{object}")?;
            }
        }
        Ok(Exit::Success)
    }

    /// Tells which releases are on the robot.
    fn list(&self, console: &mut Console<'_>) -> Result<Exit, Failure> {
        let there = self.ask(&["look"])?;
        let (current, previous) = (there.of("current").next(), there.of("previous").next());
        for release in there.of("release") {
            let role = match release {
                it if Some(it) == current => "current",
                it if Some(it) == previous => "previous",
                _ => "",
            };
            match self.format {
                Format::Text => writeln!(console.out, "{}", format!("{release}  {role}").trim_end())?,
                Format::Json => {
                    writeln!(
                        console.out,
                        "{}",
                        json!({ "robot": self.robot.name, "release": release, "role": role })
                    )?;
                }
            }
        }
        Ok(Exit::Success)
    }

    fn tell_contents(&self, release: &Release, console: &mut Console<'_>) -> Result<Exit, Failure> {
        match self.format {
            Format::Text => {
                writeln!(
                    console.out,
                    "release {} for {} at {}",
                    release.name, self.robot.name, self.robot.address
                )?;
                release.paths().try_for_each(|path| writeln!(console.out, "  {path}"))?;
            }
            Format::Json => {
                let paths: Vec<&str> = release.paths().collect();
                writeln!(
                    console.out,
                    "{}",
                    json!({ "robot": self.robot.name, "release": release.name, "files": paths })
                )?;
            }
        }
        Ok(Exit::Success)
    }

    fn ask(&self, arguments: &[&str]) -> Result<Said, Failure> {
        task(self.robot, arguments, None).map_err(|refusal| self.failure(refusal))
    }

    fn failure(&self, refusal: Refusal) -> Failure {
        match refusal {
            Refusal::Unreached(said) => {
                let RobotEntry { name, address, .. } = self.robot;
                Failure::Unreachable(self.format, format!("{name} is not reached at {address}: {said}"))
            }
            Refusal::Task(code, said) => self.failed(format!("it failed there (code {code}): {said}")),
        }
    }

    fn failed(&self, message: String) -> Failure {
        Failure::failed(self.format, format_args!("{}: {message}", self.robot.name))
    }
}

/// A word as a shell takes it for itself.
fn quoted(word: &str) -> String {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "_-./=:@%+,".contains(letter);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn words_reach_the_robot_as_they_are() {
        assert_eq!(quoted("config/agents.xml"), "config/agents.xml");
        assert_eq!(quoted("it's $HOME; `x`"), "'it'\\''s $HOME; `x`'");
        assert_eq!(quoted(""), "''");
    }
}
