//! `monas deploy`: installs the program, a configuration and its models on a robot.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use monas_deploy::{Deployment, ErrorKind, Release, Robot, build_program, find_robot, missing_modules};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument, counted, failed};
use serde_json::json;

use crate::input::{checked, grammar};

/// Arguments of `monas deploy`.
#[derive(Args, Debug)]
pub(crate) struct DeployArguments {
    /// The robot, by its name in the file.
    pub(crate) robot: String,
    /// The file of robots, in XML or TOML.
    #[arg(long, value_name = "FILE", default_value = "robots.xml", value_hint = ValueHint::FilePath)]
    pub(crate) robots: PathBuf,
    /// Deploy this program instead of building one.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) program: Option<PathBuf>,
    /// Only list what would be deployed.
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Go back to the previous release.
    #[arg(long, conflicts_with_all = ["program", "dry_run", "list"])]
    pub(crate) rollback: bool,
    /// List the deployed releases.
    #[arg(long, conflicts_with_all = ["program", "dry_run"])]
    pub(crate) list: bool,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &DeployArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let robot = find_robot(&arguments.robots, &arguments.robot)
        .map_err(|diagnostics| CommandFailure::Invalid(format, diagnostics))?;
    match (arguments.list, arguments.rollback) {
        (true, _) => list(&robot, format, console),
        (false, true) => roll_back(&robot, format, console),
        (false, false) => deploy(&robot, arguments, console),
    }
}

fn failure(format: Format) -> impl Fn(monas_deploy::Error) -> CommandFailure {
    move |error| match error.kind() {
        ErrorKind::Unreachable => CommandFailure::Unreachable(format, error.to_string()),
        _ => CommandFailure::failed(format, error),
    }
}

fn deploy(
    robot: &Robot,
    arguments: &DeployArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let missing = missing_modules(robot, &grammar());
    if !missing.is_empty() {
        return Err(CommandFailure::Invalid(format, missing));
    }
    checked(&robot.config, format)?;
    let program = match &arguments.program {
        Some(program) => program.clone(),
        None => build_program(&std::env::current_dir()?, robot.target.as_deref()).map_err(failure(format))?,
    };
    let release = Release::gather(robot, &program).map_err(failed(format))?;
    if arguments.dry_run {
        return write_contents(robot, &release, format, console);
    }
    let installed = Deployment::new(robot).install(&release).map_err(failure(format))?;
    let (name, (files, bytes)) = (&release.name, release.size());
    let service = &installed.service;
    match format {
        Format::Text => {
            let copied = match installed.is_copied {
                true => "copied, hashes verified",
                false => "already there",
            };
            writeln!(
                console.out,
                "{}: release {name}, {}, {bytes} bytes: {copied}",
                robot.name,
                counted(files as u64, "file")
            )?;
            let before = installed.previous.map(|before| format!(" instead of {before}"));
            writeln!(console.out, "{}: it runs{} ({service})", robot.name, before.unwrap_or_default())?;
        }
        Format::Json => {
            let object = json!({"robot": robot.name, "release": name, "files": files, "bytes": bytes,
                "copied": installed.is_copied, "before": installed.previous, "service": service});
            writeln!(console.out, "{object}")?;
        }
    }
    Ok(Exit::Success)
}

fn roll_back(robot: &Robot, format: Format, console: &mut CommandOutput<'_>) -> Result<Exit, CommandFailure> {
    let rollback = Deployment::new(robot).roll_back().map_err(failure(format))?;
    let (release, service) = (rollback.release, rollback.service);
    match format {
        Format::Text => writeln!(console.out, "{}: release {release} runs again ({service})", robot.name)?,
        Format::Json => {
            let object = json!({ "robot": robot.name, "release": release, "service": service });
            writeln!(console.out, "{object}")?;
        }
    }
    Ok(Exit::Success)
}

fn list(robot: &Robot, format: Format, console: &mut CommandOutput<'_>) -> Result<Exit, CommandFailure> {
    let releases = Deployment::new(robot).releases().map_err(failure(format))?;
    for release in &releases.names {
        let role = match Some(release) {
            it if it == releases.current.as_ref() => "current",
            it if it == releases.previous.as_ref() => "previous",
            _ => "",
        };
        match format {
            Format::Text => writeln!(console.out, "{}", format!("{release}  {role}").trim_end())?,
            Format::Json => {
                let object = json!({ "robot": robot.name, "release": release, "role": role });
                writeln!(console.out, "{object}")?;
            }
        }
    }
    Ok(Exit::Success)
}

/// Lists the files of a release.
fn write_contents(
    robot: &Robot,
    release: &Release,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let name = &release.name;
    match format {
        Format::Text => {
            writeln!(console.out, "release {name} for {} at {}", robot.name, robot.address)?;
            release.paths().try_for_each(|path| writeln!(console.out, "  {path}"))?;
        }
        Format::Json => {
            let paths: Vec<&str> = release.paths().collect();
            let object = json!({ "robot": robot.name, "release": name, "files": paths });
            writeln!(console.out, "{object}")?;
        }
    }
    Ok(Exit::Success)
}
