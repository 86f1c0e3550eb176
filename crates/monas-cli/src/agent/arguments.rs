//! What may be written after `monas agent`.

use std::path::PathBuf;

use clap::{Subcommand, ValueHint};
use clap_complete::engine::{ArgValueCandidates, CompletionCandidate};
use monas::records::Inquiry;

use super::ask;
use crate::arguments::{Format, FormatArgument};
use crate::topic::arguments::RunChoice;

#[derive(Subcommand, Debug)]
pub(crate) enum AgentCommand {
    /// List the agents of a run with what they do and have done; of one agent, all that is known.
    #[command(after_help = "Example: monas agent list Motion")]
    List {
        /// The agent; all, if it is not said.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: Option<String>,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Start an agent that has stopped, or one of its statecharts: what it consists of begins anew.
    #[command(after_help = "Example: monas agent start Motion")]
    Start(AgentOrChart),
    /// Stop an agent, or one of its statecharts: the others and its list go on. It can be started again.
    #[command(after_help = "Example: monas agent stop Player --chart models/goalie.srm")]
    Stop(AgentOrChart),
    /// Hold an agent where it is.
    #[command(after_help = "Example: monas agent pause Motion")]
    Pause(OneAgent),
    /// Let an agent go on that pauses.
    #[command(after_help = "Example: monas agent resume Motion")]
    Resume(OneAgent),
    /// Let an agent that pauses do one cycle.
    #[command(after_help = "Example: monas agent step Motion")]
    Step(OneAgent),
    /// Add the agents of a file to a run.
    #[command(after_help = "Example: monas agent add extra.xml --host blue-2")]
    Add {
        /// Agents in XML or TOML, as in a configuration; `-` for standard input.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Remove an agent from a run.
    #[command(after_help = "Example: monas agent remove Motion")]
    Remove(OneAgent),
    /// Put an activity into the list of an agent.
    #[command(after_help = "Example: monas agent add-activity Motion LedHandler colour=red --at 1")]
    AddActivity {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// The activity, by the name it is registered under.
        activity: String,
        /// Its parameters.
        #[arg(value_name = "PARAMETER=VALUE")]
        parameters: Vec<String>,
        /// Its place in the list, counted from 1; the end, if it is not said.
        #[arg(long, value_name = "PLACE", value_parser = clap::value_parser!(u32).range(1..))]
        at: Option<u32>,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Take an activity out of the list of an agent.
    #[command(after_help = "Example: monas agent remove-activity Motion LedHandler")]
    RemoveActivity {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// The activity, by its name or its place in the list, counted from 1.
        activity: String,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Put an activity in another place of its agent's list.
    #[command(after_help = "Example: monas agent move-activity Motion LedHandler 1")]
    MoveActivity {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// The activity, by its name or its place in the list, counted from 1.
        activity: String,
        /// Where it is to stand, counted from 1.
        #[arg(value_parser = clap::value_parser!(u32).range(1..))]
        place: u32,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Put another activity in the place of one.
    #[command(after_help = "Example: monas agent replace-activity Motion LedHandler QuietLedHandler")]
    ReplaceActivity {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// The activity, by its name or its place in the list, counted from 1.
        activity: String,
        /// The other one, by the name it is registered under.
        replacement: String,
        /// Its parameters.
        #[arg(value_name = "PARAMETER=VALUE")]
        parameters: Vec<String>,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Set attributes of an agent or a statechart, and parameters of its activities: all of them at one edge of its cycles, or none.
    #[command(
        after_help = "Example: monas agent set Motion frequency=50 priority=2 MotionController.gait=quick"
    )]
    Set {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// `frequency`, `priority`, `is_real_time`, `stats_cycle` or `on_failure`, or ACTIVITY.PARAMETER.
        #[arg(required = true, value_name = "KEY=VALUE")]
        settings: Vec<String>,
        /// Set them of one of the agent's statecharts, named by its model or its place, counted from 1.
        #[arg(long)]
        chart: Option<String>,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Let a statechart go on with another model, where it stands.
    #[command(
        after_help = "Example: monas agent swap Goalie models/goalie.srm --state 'active/Stand=active/Wait'"
    )]
    Swap {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// The model: a file, or the name of a generated statechart.
        #[arg(value_hint = ValueHint::FilePath)]
        model: String,
        /// Which of the agent's charts, by its model or its place, counted from 1; not needed if there is one.
        #[arg(long)]
        chart: Option<String>,
        /// The state in which one that is gone goes on, both by their paths.
        #[arg(long = "state", value_name = "OLD=NEW")]
        states: Vec<String>,
        /// Let history, timers and events be lost that have no place in the new chart.
        #[arg(long)]
        lossy: bool,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Write the present set-up of a host: the text that its agents were read from, brought up to date, with all else in it left as it is.
    #[command(after_help = "Example: monas agent save config/agents.xml")]
    Save {
        /// Where to write it; standard output if not given.
        #[arg(value_hint = ValueHint::FilePath)]
        file: Option<PathBuf>,
        #[command(flatten)]
        run: RunChoice,
    },
}

/// An agent of a run.
#[derive(clap::Args, Debug)]
pub(crate) struct OneAgent {
    /// The agent.
    #[arg(add = ArgValueCandidates::new(agents))]
    pub(crate) agent: String,
    #[command(flatten)]
    pub(crate) run: RunChoice,
}

/// An agent of a run, or one of its statecharts.
#[derive(clap::Args, Debug)]
pub(crate) struct AgentOrChart {
    #[command(flatten)]
    pub(crate) one: OneAgent,
    /// One of its statecharts, by its model or its place, counted from 1.
    #[arg(long)]
    pub(crate) chart: Option<String>,
}

/// The names of the agents of the only run, if there is one.
pub(crate) fn agents() -> Vec<CompletionCandidate> {
    let run = RunChoice::of(None, None, FormatArgument { value: Format::Text });
    let reply = ask(Inquiry { agents: true, ..Inquiry::default() }, &run);
    let known = reply.ok().and_then(|reply| reply.agents).unwrap_or_default();
    let mut names: Vec<String> = known.agents.into_iter().map(|agent| agent.name).collect();
    names.sort_unstable();
    names.dedup();
    names.into_iter().map(CompletionCandidate::new).collect()
}
