//! Arguments of `monas agent`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueHint};
use clap_complete::engine::ArgValueCandidates;

use crate::remote::{RunSelector, agents};

#[derive(Subcommand, Debug)]
pub(crate) enum AgentCommand {
    /// List the agents of a run with their statistics; of one agent, all details.
    #[command(after_help = "Example: monas agent list Motion")]
    List {
        /// The agent; all agents if not given.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: Option<String>,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Start a stopped agent, or one of its statecharts, from its initial state.
    #[command(after_help = "Example: monas agent start Motion")]
    Start(AgentOrChart),
    /// Stop an agent, or one of its statecharts while the rest of the agent continues. It can be
    /// started again.
    #[command(after_help = "Example: monas agent stop Player --chart models/goalie.srm")]
    Stop(AgentOrChart),
    /// Pause an agent.
    #[command(after_help = "Example: monas agent pause Motion")]
    Pause(OneAgent),
    /// Resume a paused agent.
    #[command(after_help = "Example: monas agent resume Motion")]
    Resume(OneAgent),
    /// Run one cycle of a paused agent.
    #[command(after_help = "Example: monas agent step Motion")]
    Step(OneAgent),
    /// Add the agents of a file to a run.
    #[command(after_help = "Example: monas agent add extra.xml --host blue-2")]
    Add {
        /// Agents in XML or TOML, as in a configuration; `-` for standard input.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Remove an agent from a run.
    #[command(after_help = "Example: monas agent remove Motion")]
    Remove(OneAgent),
    /// Add an activity to the list of an agent.
    #[command(
        after_help = "Example: monas agent add-activity Motion LedHandler colour=red --at 1",
        override_usage = "monas agent add-activity [OPTIONS] <AGENT> <ACTIVITY>\n           [PARAMETER=VALUE]..."
    )]
    AddActivity {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// The activity, by its registered name.
        activity: String,
        /// Its parameters.
        #[arg(value_name = "PARAMETER=VALUE")]
        parameters: Vec<String>,
        /// Its position in the list, counted from 1; the end if not given.
        #[arg(long, value_name = "PLACE", value_parser = clap::value_parser!(u32).range(1..))]
        at: Option<u32>,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Remove an activity from the list of an agent.
    #[command(after_help = "Example: monas agent remove-activity Motion LedHandler")]
    RemoveActivity {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// The activity, by its name or its position in the list, counted from 1.
        activity: String,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Move an activity to another position in its agent's list.
    #[command(after_help = "Example: monas agent move-activity Motion LedHandler 1")]
    MoveActivity {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// The activity, by its name or its position in the list, counted from 1.
        activity: String,
        /// The new position, counted from 1.
        #[arg(value_parser = clap::value_parser!(u32).range(1..))]
        place: u32,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Replace an activity by another one.
    #[command(
        after_help = "Example: monas agent replace-activity Motion LedHandler QuietLedHandler",
        override_usage = "monas agent replace-activity [OPTIONS] <AGENT> <ACTIVITY> <REPLACEMENT>\n           [PARAMETER=VALUE]..."
    )]
    ReplaceActivity {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// The activity, by its name or its position in the list, counted from 1.
        activity: String,
        /// The replacement, by its registered name.
        replacement: String,
        /// Its parameters.
        #[arg(value_name = "PARAMETER=VALUE")]
        parameters: Vec<String>,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Set attributes of an agent or a statechart, and parameters of its activities: all at one
    /// boundary between cycles, or none.
    #[command(
        after_help = "Example: monas agent set Motion frequency=50 priority=2 MotionController.gait=quick"
    )]
    Set {
        /// The agent.
        #[arg(add = ArgValueCandidates::new(agents))]
        agent: String,
        /// `frequency`, `priority`, `is_real_time`, `stats_cycle` or `on_failure`, or
        /// ACTIVITY.PARAMETER.
        #[arg(required = true, value_name = "KEY=VALUE")]
        settings: Vec<String>,
        /// Set them for one of the agent's statecharts, given by its model or its position, counted
        /// from 1.
        #[arg(long)]
        chart: Option<String>,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Replace the model of a statechart while it runs, keeping its state.
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
        /// The chart, by its model or its position, counted from 1; not needed if the agent has
        /// only one.
        #[arg(long)]
        chart: Option<String>,
        /// Map a removed state to a state of the new chart, both given by their paths.
        #[arg(long = "state", value_name = "OLD=NEW")]
        states: Vec<String>,
        /// Accept the loss of history, timers and events that the new chart does not have.
        #[arg(long)]
        lossy: bool,
        /// Print what would become of the states, activities, timers and events, and change
        /// nothing.
        #[arg(long)]
        dry_run: bool,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Save the current configuration of a host: the text from which its agents were read, with the
    /// changes made since.
    #[command(after_help = "Example: monas agent save config/agents.xml")]
    Save {
        /// The file to write; standard output if not given.
        #[arg(value_hint = ValueHint::FilePath)]
        file: Option<PathBuf>,
        #[command(flatten)]
        run: RunSelector,
    },
}

/// An agent of a run.
#[derive(Args, Debug)]
pub(crate) struct OneAgent {
    /// The agent.
    #[arg(add = ArgValueCandidates::new(agents))]
    pub(crate) agent: String,
    #[command(flatten)]
    pub(crate) run: RunSelector,
}

/// An agent of a run, or one of its statecharts.
#[derive(Args, Debug)]
pub(crate) struct AgentOrChart {
    #[command(flatten)]
    pub(crate) one: OneAgent,
    /// One of its statecharts, by its model or its position, counted from 1.
    #[arg(long)]
    pub(crate) chart: Option<String>,
}
