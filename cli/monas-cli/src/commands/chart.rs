//! `monas chart`: inspects the statecharts of a run, and raises events in them.

mod show;

use std::path::PathBuf;

use clap::{Subcommand, ValueHint};
use clap_complete::engine::ArgValueCandidates;
use monas::records::{Action, Change};
use monas_terminal::{CommandFailure, CommandOutput, Exit};

use crate::input::file_parser;
use crate::remote::{RunSelector, agents, print_outcome, request_change};

#[derive(Subcommand, Debug)]
pub(crate) enum ChartCommand {
    /// Show the state of a statechart: active states and their activities, timers, histories,
    /// pending and deferred events.
    #[command(after_help = "Example: monas chart show Goalie --host blue-1 -o goalie.svg")]
    Show {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// The statechart, by its model or its position, counted from 1; not needed if the agent
        /// has only one.
        #[arg(long)]
        chart: Option<String>,
        /// Also draw it as SVG, with active states highlighted.
        #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath, value_parser = file_parser())]
        output: Option<PathBuf>,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Raise an event in the statecharts of an agent that name it. The event is recorded. For
    /// messages use `monas topic pub`.
    #[command(after_help = "Example: monas chart raise Goalie whistle --host blue-1")]
    Raise {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// The event.
        event: String,
        /// Only in this statechart, given by its model or its position, counted from 1.
        #[arg(long)]
        chart: Option<String>,
        #[command(flatten)]
        run: RunSelector,
    },
}

pub(crate) fn execute(
    command: &ChartCommand,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    match command {
        ChartCommand::Show { agent, chart, output, run } => {
            show::execute(agent, chart.as_deref(), output.as_deref(), run, console)
        }
        ChartCommand::Raise { agent, event, chart, run } => {
            let (agent, event) = (agent.clone(), event.clone());
            let chart = chart.clone().unwrap_or_default();
            let sentence = format!("`{event}` is raised in `{agent}`");
            let change =
                Change { action: Action::RaiseEvent.into(), agent, event, chart, ..Change::default() };
            print_outcome(&request_change(change, run)?, &sentence, run.format.value, console)
        }
    }
}
