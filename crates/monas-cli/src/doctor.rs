//! `monas doctor`: what this computer and this folder have for running agents, and what to do about what is missing.

mod clock;
mod permissions;
mod ports;
mod toolchain;

use monas::config::Layers;
use serde_json::json;
use yase::Diagnostic;

use crate::arguments::{DoctorArguments, Format};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;
use crate::run::{Kind, kind_of};

/// How a thing is.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum State {
    /// As it should be.
    Well,
    /// It runs, and not as well as it could.
    Odd,
    /// Something will not run.
    Wrong,
}

impl State {
    const fn name(self) -> &'static str {
        match self {
            State::Well => "ok",
            State::Odd => "warning",
            State::Wrong => "error",
        }
    }
}

/// What was found about one thing.
#[derive(Clone, PartialEq, Eq, Debug)]
struct Finding {
    area: &'static str,
    state: State,
    what: String,
    hint: Option<String>,
}

impl Finding {
    fn well(area: &'static str, what: impl Into<String>) -> Finding {
        Finding { area, state: State::Well, what: what.into(), hint: None }
    }

    fn odd(area: &'static str, what: impl Into<String>, hint: impl Into<String>) -> Finding {
        Finding { area, state: State::Odd, what: what.into(), hint: Some(hint.into()) }
    }

    fn wrong(area: &'static str, what: impl Into<String>, hint: impl Into<String>) -> Finding {
        Finding { area, state: State::Wrong, what: what.into(), hint: Some(hint.into()) }
    }
}

pub(crate) fn execute(arguments: &DoctorArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let (configuration, diagnostics) = configuration(arguments);
    let findings: Vec<Finding> = [toolchain::findings(), permissions::findings(), clock::findings()]
        .into_iter()
        .flatten()
        .chain(ports::findings(arguments))
        .chain([configuration])
        .collect();
    for finding in &findings {
        write(finding, format, console)?;
    }
    report::write(console, format, &diagnostics)?;
    let is_wrong = |area: &str| findings.iter().any(|one| one.state == State::Wrong && one.area == area);
    Ok(match findings.iter().map(|finding| finding.state).max() {
        Some(State::Wrong) if is_wrong(CONFIGURATION) => Exit::Invalid,
        Some(State::Wrong) => Exit::Failure,
        _ => Exit::Success,
    })
}

const CONFIGURATION: &str = "configuration";

/// What `config check` says.
fn configuration(arguments: &DoctorArguments) -> (Finding, Vec<Diagnostic>) {
    let path = &arguments.config;
    let name = path.display();
    if !path.exists() {
        let hint = "name one: `monas doctor FILE`, or begin a project: `monas new my-team`";
        return (Finding::odd(CONFIGURATION, format!("there is no {name}"), hint), Vec::new());
    }
    let registry = monas::Registry::linked();
    let diagnostics = match kind_of(path) {
        Ok(Kind::Match) => match monas_match::Match::load(path, &registry) {
            Ok(plan) => plan.warnings().to_vec(),
            Err(diagnostics) => diagnostics,
        },
        Ok(Kind::Agents) => monas::config::load_with(path, &registry, &Layers::new()).1,
        Err(unread) => vec![*unread],
    };
    let errors = diagnostics.iter().filter(|diagnostic| diagnostic.is_error()).count();
    let finding = match errors {
        0 => Finding::well(CONFIGURATION, format!("{name} is in order")),
        _ => Finding::wrong(CONFIGURATION, format!("{name}: {errors} errors"), "they stand below"),
    };
    (finding, diagnostics)
}

fn write(finding: &Finding, format: Format, console: &mut Console<'_>) -> Result<(), Failure> {
    let Finding { area, state, what, hint } = finding;
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
