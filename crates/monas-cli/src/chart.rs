//! `monas chart`: what the statecharts of a run are doing, and events that are raised in them.

mod show;

use std::path::PathBuf;

use clap::{Subcommand, ValueHint};
use clap_complete::engine::ArgValueCandidates;
use monas::records::{Action, Change};

use crate::agent::agents;
use crate::agent::change;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::topic::arguments::RunChoice;

#[derive(Subcommand, Debug)]
pub(crate) enum ChartCommand {
    /// Show what a statechart is doing: active states and their activities, timers, histories, events that wait or are put off.
    #[command(after_help = "Example: monas chart show Goalie --host blue-1 -o goalie.svg")]
    Show {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// Which of its statecharts, by its model or its place, counted from 1; not needed if there is one.
        #[arg(long)]
        chart: Option<String>,
        /// Draw it too, as SVG, with what is active set apart.
        #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
        output: Option<PathBuf>,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Raise an event in the statecharts of an agent that name it. Tapes have it. Messages come with `monas topic pub`.
    #[command(after_help = "Example: monas chart raise Goalie whistle --host blue-1")]
    Raise {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// The event.
        event: String,
        /// In one of its statecharts only, by its model or its place, counted from 1.
        #[arg(long)]
        chart: Option<String>,
        #[command(flatten)]
        run: RunChoice,
    },
}

pub(crate) fn execute(command: &ChartCommand, console: &mut Console<'_>) -> Result<Exit, Failure> {
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
            change::tell(&change::ask_for(change, run)?, &sentence, run.format.value, console)
        }
    }
}
