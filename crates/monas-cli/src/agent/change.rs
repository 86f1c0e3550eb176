//! Changes of agents that run.

use std::fs;
use std::io::Read;
use std::path::Path;

use monas::records::{Action, Change, Changed, Finding, Inquiry, Setting};
use serde_json::json;

use super::arguments::{AgentCommand, AgentOrChart, OneAgent};
use super::{ask, odd};
use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::topic::arguments::RunChoice;

pub(super) fn execute(command: &AgentCommand, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let Some((change, run)) = asked(command)? else { return Ok(Exit::Success) };
    let chart = change.chart.clone();
    let changed = ask_for(change, run)?;
    tell(&changed, &sentence(&changed, &chart), run.format.value, console)
}

/// What became of a change.
pub(crate) fn ask_for(change: Change, run: &RunChoice) -> Result<Changed, Failure> {
    let number = std::process::id().into();
    let inquiry = Inquiry { change: Some(Change { number, ..change }), ..Inquiry::default() };
    ask(inquiry, run)?.changed.ok_or_else(|| odd(run))
}

/// The change that a command is about, and of which run.
fn asked(command: &AgentCommand) -> Result<Option<(Change, &RunChoice)>, Failure> {
    Ok(Some(match command {
        AgentCommand::List { .. } | AgentCommand::Save { .. } => return Ok(None),
        AgentCommand::Start(meant) => agent_or_chart(Action::StartAgent, meant),
        AgentCommand::Stop(meant) => agent_or_chart(Action::StopAgent, meant),
        AgentCommand::Pause(one) => one_agent(Action::PauseAgent, one),
        AgentCommand::Resume(one) => one_agent(Action::ResumeAgent, one),
        AgentCommand::Step(one) => one_agent(Action::StepAgent, one),
        AgentCommand::Remove(one) => one_agent(Action::RemoveAgent, one),
        AgentCommand::Add { file, run } => {
            let (text, file) = text_of(file, run)?;
            (Change { text, file, ..about(Action::AddAgents, "") }, run)
        }
        AgentCommand::AddActivity { agent, activity, parameters, at, run } => {
            let (activity, place) = (activity.clone(), at.unwrap_or_default());
            let settings = settings(parameters)?;
            (Change { activity, place, settings, ..about(Action::AddActivity, agent) }, run)
        }
        AgentCommand::RemoveActivity { agent, activity, run } => {
            (Change { activity: activity.clone(), ..about(Action::RemoveActivity, agent) }, run)
        }
        AgentCommand::MoveActivity { agent, activity, place, run } => {
            let (activity, place) = (activity.clone(), *place);
            (Change { activity, place, ..about(Action::MoveActivity, agent) }, run)
        }
        AgentCommand::ReplaceActivity { agent, activity, replacement, parameters, run } => {
            let (activity, replacement) = (activity.clone(), replacement.clone());
            let settings = settings(parameters)?;
            (Change { activity, replacement, settings, ..about(Action::ReplaceActivity, agent) }, run)
        }
        AgentCommand::Set { agent, settings: given, chart, run } => {
            let chart = chart.clone().unwrap_or_default();
            (Change { settings: settings(given)?, chart, ..about(Action::Set, agent) }, run)
        }
        AgentCommand::Swap { agent, model, chart, states, lossy, run } => {
            let (states, accept_losses) = (settings(states)?, *lossy);
            let chart = chart.clone().unwrap_or_default();
            // What is no file may be the name of a generated chart.
            let (text, file) = match Path::new(model).exists() {
                true => text_of(Path::new(model), run)?,
                false => (String::new(), model.clone()),
            };
            (Change { chart, file, text, states, accept_losses, ..about(Action::SwapModel, agent) }, run)
        }
    }))
}

fn about(action: Action, agent: &str) -> Change {
    Change { action: action.into(), agent: agent.to_owned(), ..Change::default() }
}

fn one_agent(action: Action, OneAgent { agent, run }: &OneAgent) -> (Change, &RunChoice) {
    (about(action, agent), run)
}

fn agent_or_chart(action: Action, AgentOrChart { one, chart }: &AgentOrChart) -> (Change, &RunChoice) {
    let (change, run) = one_agent(action, one);
    (Change { chart: chart.clone().unwrap_or_default(), ..change }, run)
}

/// `KEY=VALUE`s.
fn settings(given: &[String]) -> Result<Vec<Setting>, Failure> {
    let setting = |text: &String| match text.split_once('=') {
        Some((key, value)) if !key.is_empty() => Ok(Setting { key: key.into(), value: value.into() }),
        _ => Err(Failure::Usage(format!("`{text}` is no KEY=VALUE"))),
    };
    given.iter().map(setting).collect()
}

/// The text in a file, and its name.
fn text_of(file: &Path, run: &RunChoice) -> Result<(String, String), Failure> {
    let mut text = String::new();
    let read = match file == Path::new("-") {
        true => std::io::stdin().read_to_string(&mut text).map(|_| text),
        false => fs::read_to_string(file),
    };
    let failed = |error| Failure::failed(run.format.value, format!("{}: {error}", file.display()));
    Ok((read.map_err(failed)?, file.display().to_string()))
}

/// Tells what became of a change; the sentence is for one that was made.
pub(crate) fn tell(
    changed: &Changed,
    sentence: &str,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    match format {
        Format::Json => {
            let findings: Vec<_> = changed.findings.iter().map(object).collect();
            let action = changed.action().as_str_name().to_lowercase();
            let object = json!({"done": changed.done, "action": action, "agent": changed.agent, "cycle": changed.cycle,
                "findings": findings});
            writeln!(console.out, "{object}")?;
        }
        Format::Text => {
            for finding in &changed.findings {
                writeln!(console.err, "{}", line(finding))?;
            }
            if changed.done {
                writeln!(console.out, "{sentence}")?;
            }
        }
    }
    Ok(match changed.done {
        true => Exit::Success,
        // What a person wrote in a file is wrong, or what was asked for cannot be had.
        false if changed.findings.iter().any(|finding| finding.line > 0) => Exit::Invalid,
        false => Exit::Failure,
    })
}

fn sentence(changed: &Changed, chart: &str) -> String {
    let Changed { agent, cycle, .. } = changed;
    let its = if chart.is_empty() { String::new() } else { format!("statechart `{chart}` of ") };
    match changed.action() {
        Action::AddAgents => "the agents are added".into(),
        Action::RemoveAgent => format!("`{agent}` is removed"),
        Action::StartAgent => format!("{its}`{agent}` starts after its cycle {cycle}"),
        Action::StopAgent => format!("{its}`{agent}` has stopped after its cycle {cycle}"),
        Action::PauseAgent => format!("`{agent}` pauses after its cycle {cycle}"),
        Action::ResumeAgent => format!("`{agent}` goes on after its cycle {cycle}"),
        Action::StepAgent => format!("`{agent}` has done its cycle {cycle}"),
        _ => format!("{its}`{agent}` is changed after its cycle {cycle}"),
    }
}

fn line(finding: &Finding) -> String {
    let Finding { code, message, hint, file, line, column, .. } = finding;
    let place = match (file.is_empty(), line) {
        (true, _) => String::new(),
        (false, 0) => format!("{file}: "),
        (false, line) => format!("{file}:{line}:{column}: "),
    };
    let kind = match (finding.is_error, code.is_empty()) {
        (true, _) => format!("error[{code}]: "),
        (false, false) => format!("warning[{code}]: "),
        (false, true) => String::new(),
    };
    let hint = if hint.is_empty() { String::new() } else { format!("\n  help: {hint}") };
    format!("{place}{kind}{message}{hint}")
}

fn object(finding: &Finding) -> serde_json::Value {
    json!({"code": finding.code, "severity": if finding.is_error { "error" } else { "information" },
        "message": finding.message, "hint": finding.hint, "file": finding.file, "line": finding.line,
        "column": finding.column})
}
