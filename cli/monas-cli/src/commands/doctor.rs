//! `monas doctor`: checks whether this computer and this folder can run agents, and suggests
//! repairs.

mod bodies;
mod clock;
mod permissions;
mod ports;
mod toolchain;

use std::path::{Path, PathBuf};

use clap::{Args, ValueHint};
use monas::config::Layers;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument, counted, report};
use serde_json::json;
use yase::Diagnostic;

use crate::input::{ConfigurationKind, DEFAULT_CONFIGURATION, kind_of, load_agents};

/// Arguments of `monas doctor`.
#[derive(Args, Debug)]
pub(crate) struct DoctorArguments {
    /// The configuration to check: a match or a file of agents, in XML or TOML.
    #[arg(default_value = DEFAULT_CONFIGURATION, value_hint = ValueHint::FilePath)]
    pub(crate) config: PathBuf,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

impl DoctorArguments {
    /// Whether there is a configuration: a file, or standard input.
    fn has_configuration(&self) -> bool {
        self.config == Path::new("-") || self.config.exists()
    }
}

/// The result of a check, best first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum CheckStatus {
    /// The check has passed.
    Ok,
    /// Agents run, with limitations.
    Warning,
    /// Something cannot run.
    Error,
}

impl CheckStatus {
    const fn name(self) -> &'static str {
        match self {
            CheckStatus::Ok => "ok",
            CheckStatus::Warning => "warning",
            CheckStatus::Error => "error",
        }
    }
}

/// One check with its result.
#[derive(Clone, PartialEq, Eq, Debug)]
struct CheckResult {
    area: &'static str,
    state: CheckStatus,
    message: String,
    hint: Option<String>,
}

impl CheckResult {
    fn ok(area: &'static str, what: impl Into<String>) -> CheckResult {
        CheckResult { area, state: CheckStatus::Ok, message: what.into(), hint: None }
    }

    fn warning(area: &'static str, what: impl Into<String>, hint: impl Into<String>) -> CheckResult {
        CheckResult { area, state: CheckStatus::Warning, message: what.into(), hint: Some(hint.into()) }
    }

    fn error(area: &'static str, what: impl Into<String>, hint: impl Into<String>) -> CheckResult {
        CheckResult { area, state: CheckStatus::Error, message: what.into(), hint: Some(hint.into()) }
    }
}

pub(crate) fn execute(
    arguments: &DoctorArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let (configuration, diagnostics) = configuration(arguments);
    let findings: Vec<CheckResult> = [toolchain::findings(), permissions::findings(), clock::findings()]
        .into_iter()
        .flatten()
        .chain(ports::findings(arguments))
        .chain(bodies::findings(arguments))
        .chain([configuration])
        .collect();
    for finding in &findings {
        write(finding, format, console)?;
    }
    report::write(console, format, &diagnostics)?;
    let is_wrong =
        |area: &str| findings.iter().any(|one| one.state == CheckStatus::Error && one.area == area);
    Ok(match findings.iter().map(|finding| finding.state).max() {
        Some(CheckStatus::Error) if is_wrong(CONFIGURATION) => Exit::Invalid,
        Some(CheckStatus::Error) => Exit::Failure,
        _ => Exit::Success,
    })
}

const CONFIGURATION: &str = "configuration";

/// Checks the configuration as `config check` does.
fn configuration(arguments: &DoctorArguments) -> (CheckResult, Vec<Diagnostic>) {
    let path = &arguments.config;
    let name = monas::config::shown_name(path);
    if !arguments.has_configuration() && path == Path::new(DEFAULT_CONFIGURATION) {
        let hint = "give one: `monas doctor FILE`, or create a project: `monas new my-team`";
        return (CheckResult::warning(CONFIGURATION, format!("there is no {name}"), hint), Vec::new());
    }
    let registry = monas::Registry::linked();
    let diagnostics = match kind_of(path) {
        #[cfg(feature = "soccer")]
        Ok(ConfigurationKind::Match) => match monas_match::MatchSource::load(path, &registry) {
            Ok(plan) => plan.warnings().to_vec(),
            Err(diagnostics) => diagnostics,
        },
        Ok(ConfigurationKind::Agents) => load_agents(path, &registry, &Layers::new()).1,
        Err(unread) => vec![*unread],
    };
    let errors = diagnostics.iter().filter(|diagnostic| diagnostic.is_error()).count();
    let finding = match errors {
        0 => CheckResult::ok(CONFIGURATION, format!("{name} is valid")),
        _ => CheckResult::error(
            CONFIGURATION,
            format!("{name}: {}", counted(errors as u64, "error")),
            "listed below",
        ),
    };
    (finding, diagnostics)
}

fn write(
    finding: &CheckResult,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<(), CommandFailure> {
    let CheckResult { area, state, message: what, hint } = finding;
    match format {
        Format::Text => {
            writeln!(console.out, "{:7}  {area:13}  {what}", state.name())?;
            if let Some(hint) = hint {
                writeln!(console.out, "{:7}  {:13}  {hint}", "", "")?;
            }
        }
        Format::Json => {
            let object = json!({ "area": area, "state": state.name(), "message": what, "hint": hint });
            writeln!(console.out, "{object}")?;
        }
    }
    Ok(())
}
