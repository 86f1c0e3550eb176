//! `monas agent` subcommands that change an agent.

use std::io::Read;
use std::path::Path;

use monas::config;
use monas::records::{Action, Change, Changed, Setting};
use monas_terminal::{CommandFailure, CommandOutput, Exit};

use super::arguments::{AgentCommand, AgentOrChart, OneAgent};
use crate::remote::{RunSelector, print_outcome, request_change};

pub(crate) fn execute(
    command: &AgentCommand,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let Some((change, run)) = requested_change(command)? else { return Ok(Exit::Success) };
    let (chart, is_dry_run) = (change.chart.clone(), change.dry_run);
    let mut changed = request_change(change, run)?;
    // The runtime names the states; how they are mapped is a matter of the command line.
    let unmapped = changed.findings.iter_mut().rfind(|finding| finding.code == "E0356");
    if let Some(finding) = unmapped.filter(|_| matches!(command, AgentCommand::Swap { .. })) {
        finding.hint = "--state OLD=NEW names the state of the new chart that continues an old one; --lossy accepts the \
                        loss of history, timers and events"
            .into();
    }
    print_outcome(&changed, &sentence(&changed, &chart, is_dry_run), run.format.value, console)
}

/// The change that a command requests, and the run; none for commands that only inspect.
fn requested_change(command: &AgentCommand) -> Result<Option<(Change, &RunSelector)>, CommandFailure> {
    Ok(Some(match command {
        AgentCommand::List { .. } | AgentCommand::Save { .. } => return Ok(None),
        AgentCommand::Start(target) => agent_or_chart(Action::StartAgent, target),
        AgentCommand::Stop(target) => agent_or_chart(Action::StopAgent, target),
        AgentCommand::Pause(one) => one_agent(Action::PauseAgent, one),
        AgentCommand::Resume(one) => one_agent(Action::ResumeAgent, one),
        AgentCommand::Step(one) => one_agent(Action::StepAgent, one),
        AgentCommand::Remove(one) => one_agent(Action::RemoveAgent, one),
        AgentCommand::Add { file, run } => {
            let (text, file) = text_of(file, run)?;
            (Change { text, file, ..change_of(Action::AddAgents, "") }, run)
        }
        AgentCommand::AddActivity { agent, activity, parameters, at, run } => {
            let (activity, place) = (activity.clone(), at.unwrap_or_default());
            let settings = settings(parameters, "KEY=VALUE")?;
            (Change { activity, place, settings, ..change_of(Action::AddActivity, agent) }, run)
        }
        AgentCommand::RemoveActivity { agent, activity, run } => {
            (Change { activity: activity.clone(), ..change_of(Action::RemoveActivity, agent) }, run)
        }
        AgentCommand::MoveActivity { agent, activity, place, run } => {
            let (activity, place) = (activity.clone(), *place);
            (Change { activity, place, ..change_of(Action::MoveActivity, agent) }, run)
        }
        AgentCommand::ReplaceActivity { agent, activity, replacement, parameters, run } => {
            let (activity, replacement) = (activity.clone(), replacement.clone());
            let settings = settings(parameters, "KEY=VALUE")?;
            (Change { activity, replacement, settings, ..change_of(Action::ReplaceActivity, agent) }, run)
        }
        AgentCommand::Set { agent, settings: given, chart, run } => {
            let chart = chart.clone().unwrap_or_default();
            (Change { settings: settings(given, "KEY=VALUE")?, chart, ..change_of(Action::Set, agent) }, run)
        }
        AgentCommand::Swap { agent, model, chart, states, lossy, dry_run, run } => {
            let (states, accept_losses, dry_run) = (settings(states, "OLD=NEW")?, *lossy, *dry_run);
            let chart = chart.clone().unwrap_or_default();
            // A name without an extension that is not a file may be that of a generated chart.
            let path = Path::new(model);
            let (text, file) = match path.exists() || path.extension().is_some() {
                true => text_of(path, run)?,
                false => (String::new(), model.clone()),
            };
            let swap = change_of(Action::SwapModel, agent);
            (Change { chart, file, text, states, accept_losses, dry_run, ..swap }, run)
        }
    }))
}

fn change_of(action: Action, agent: &str) -> Change {
    Change { action: action.into(), agent: agent.to_owned(), ..Change::default() }
}

fn one_agent(action: Action, OneAgent { agent, run }: &OneAgent) -> (Change, &RunSelector) {
    (change_of(action, agent), run)
}

fn agent_or_chart(action: Action, AgentOrChart { one, chart }: &AgentOrChart) -> (Change, &RunSelector) {
    let (change, run) = one_agent(action, one);
    (Change { chart: chart.clone().unwrap_or_default(), ..change }, run)
}

/// Parses arguments of a form such as `KEY=VALUE`.
fn settings(given: &[String], form: &str) -> Result<Vec<Setting>, CommandFailure> {
    let mut settings: Vec<Setting> = Vec::new();
    for text in given {
        let (key, value) = text
            .split_once('=')
            .filter(|(key, _)| !key.is_empty())
            .ok_or_else(|| CommandFailure::Usage(format!("`{text}` is not {form}")))?;
        if settings.iter().any(|setting| setting.key == key) {
            return Err(CommandFailure::Usage(format!("`{key}` is given twice: remove one of them")));
        }
        settings.push(Setting { key: key.into(), value: value.into() });
    }
    Ok(settings)
}

/// The text of a file, or of standard input for `-`, and the file's name.
fn text_of(file: &Path, run: &RunSelector) -> Result<(String, String), CommandFailure> {
    let format = run.format.value;
    if file == Path::new("-") {
        let mut text = String::new();
        let read = std::io::stdin().read_to_string(&mut text);
        read.map_err(|error| CommandFailure::failed(format, format!("standard input: {error}")))?;
        return Ok((text, "<stdin>".into()));
    }
    let source = config::read_file(file).map_err(|unread| CommandFailure::Invalid(format, vec![*unread]))?;
    Ok((source.text.clone(), source.name.clone()))
}

fn sentence(changed: &Changed, chart: &str, is_dry_run: bool) -> String {
    let Changed { agent, cycle, .. } = changed;
    let its = if chart.is_empty() { String::new() } else { format!("statechart `{chart}` of ") };
    match changed.action() {
        Action::AddAgents => "the agents are added".into(),
        Action::RemoveAgent => format!("`{agent}` is removed"),
        Action::StartAgent => format!("{its}`{agent}` starts after its cycle {cycle}"),
        Action::StopAgent => format!("{its}`{agent}` has stopped after its cycle {cycle}"),
        Action::PauseAgent => format!("`{agent}` pauses after its cycle {cycle}"),
        Action::ResumeAgent => format!("`{agent}` resumes after its cycle {cycle}"),
        Action::StepAgent => format!("`{agent}` has completed its cycle {cycle}"),
        _ if is_dry_run => format!("{its}`{agent}` could be changed after its cycle {cycle}; it is not"),
        _ => format!("{its}`{agent}` is changed after its cycle {cycle}"),
    }
}
