//! The command line: what may be written after `monas`. Help and completions come from the same definitions.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum, ValueHint};
use clap_complete::Shell;

#[cfg(unix)]
use crate::agent::AgentCommand;
#[cfg(unix)]
use crate::chart::ChartCommand;
use crate::duration;
use crate::log::LogArguments;
#[cfg(unix)]
use crate::module::ModuleCommand;
use crate::tape::arguments::TapeCommand;
#[cfg(unix)]
use crate::top::TopArguments;
#[cfg(unix)]
use crate::topic::TopicArguments;

/// The configuration that is read when none is named.
const DEFAULT_CONFIGURATION: &str = "config/agents.xml";

/// From a formula to a running robot team.
#[derive(Parser, Debug)]
#[command(name = "monas", version, arg_required_else_help = true, after_help = EXIT_CODES)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

const EXIT_CODES: &str = "\
Exit codes: 0 done, 1 ran and failed, 2 usage, 3 invalid configuration or model, 4 nothing to connect to,
5 a replay differs from its recording or a check of a model finds an error, 130 interrupted.
Environment: NO_COLOR switches colours off; MONAS_LOG chooses what is logged, for example `info` or `monas=debug`.";

#[derive(Subcommand, Debug)]
pub(crate) enum Command {
    /// Run a match or a set of agents.
    #[command(after_help = "Example: monas run config/match.xml --seed 7 --for 60s")]
    Run(RunArguments),
    /// Read, check and draw models.
    #[command(subcommand)]
    Model(ModelCommand),
    /// Write the statechart of a model as a Rust crate that is linked into the team's program.
    ///
    /// Activities that nobody has written get skeletons, which are left alone ever after.
    #[command(after_help = "Example: monas generate models/goalie.srm")]
    Generate(GenerateArguments),
    /// Look at configurations without running them.
    #[command(subcommand)]
    Config(ConfigCommand),
    /// Look at the topics of a run while it runs, and publish on them.
    #[cfg(unix)]
    Topic(TopicArguments),
    /// Look at the agents of a run while it runs, and change them.
    #[cfg(unix)]
    #[command(subcommand)]
    Agent(AgentCommand),
    /// Look into the statecharts of a run while it runs, and raise events in them.
    #[cfg(unix)]
    #[command(subcommand)]
    Chart(ChartCommand),
    /// Load activities into a run and exchange them, from shared objects.
    #[cfg(unix)]
    #[command(subcommand)]
    Module(ModuleCommand),
    /// Watch what the agents of a run are doing, and which of their activities takes the time.
    ///
    /// On a terminal it looks again and again, until `q` is pressed; otherwise it tells one interval and ends. Shares are of one core. An
    /// activity that takes nearly a whole one, that blocks, that fails or that does not return is marked.
    #[cfg(unix)]
    #[command(after_help = "Example: monas top --host blue-2")]
    Top(TopArguments),
    /// Follow what the agents of a run have to say, or read it off a tape.
    ///
    /// Lines are those on `monas/log` of each robot: they are there whatever the logger's settings keep out of files and consoles.
    #[command(after_help = "Example: monas log --robot blue-2 --agent Attacker --level warning")]
    Log(LogArguments),
    /// Look at recordings, mend, cut and merge them, write them as text, replay them.
    #[command(subcommand)]
    Tape(TapeCommand),
    /// Begin a project, or an activity in one.
    ///
    /// `monas new my-team` makes a folder that builds, runs and passes its tests at once. `monas new activity Vision`, in a project, makes
    /// a file that is found when the project is built.
    #[command(after_help = "Example: monas new my-team && cd my-team && cargo test")]
    New(NewArguments),
    /// Bring the program, a configuration and its models to a robot, and have it run them.
    ///
    /// The program is built for the robot, copied over ssh with all that the configuration names, held against its hashes there, and started as a service. If it does not go on,
    /// what ran before runs again. Robots stand in a file with their addresses: `<robot name="nao-2" address="nao@10.0.2.2" config="config/agents.xml"/>`.
    #[command(after_help = "Example: monas deploy nao-2")]
    Deploy(DeployArguments),
    /// Look at toolchain, permissions, clock, ports and configuration, and say what to do about what is missing.
    #[command(after_help = "Example: monas doctor config/agents.xml")]
    Doctor(DoctorArguments),
    /// Print a completion script for a shell.
    #[command(after_help = "Example: source <(monas completions bash)")]
    Completions {
        /// The shell to print it for.
        shell: Shell,
    },
}

/// What `run` may be told.
#[derive(Args, Debug)]
pub(crate) struct RunArguments {
    /// A match or a file of agents, in XML or TOML.
    #[arg(default_value = DEFAULT_CONFIGURATION, value_hint = ValueHint::FilePath)]
    pub(crate) config: PathBuf,
    #[command(flatten)]
    pub(crate) layers: LayerArguments,
    /// The seed of everything random in a match; the same seed gives the same match. 0 if not given.
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// Stop after this much time, for example 600s, 10min or 500ms.
    #[arg(long = "for", value_name = "DURATION", value_parser = duration::parse)]
    pub(crate) length: Option<Duration>,
    /// Record every message into this MCAP file.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) record: Option<PathBuf>,
    /// Write a log as this file says, which is as Listing 4.5 of the thesis, in XML or TOML: `config/logger.xml` is an example.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) log: Option<PathBuf>,
    /// Let simulated time pass no faster than real time. Agents without a match run in real time anyway.
    #[arg(long)]
    pub(crate) realtime: bool,
    /// The name of the control socket, which `monas topic` finds the run by; that of the configuration if it is not said.
    #[arg(long, value_name = "NAME")]
    pub(crate) control: Option<String>,
    /// Serve no control socket.
    #[arg(long, conflicts_with = "control")]
    pub(crate) no_control: bool,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

#[derive(Subcommand, Debug)]
pub(crate) enum ModelCommand {
    /// Transform a model into the next one of the method; without --to, into the statechart it describes.
    #[command(after_help = "Example: monas model transform models/goalie.srm")]
    Transform(TransformArguments),
    /// Write a model in another format of its kind.
    ///
    /// What the format cannot say is listed, and nothing is written unless --lossy is given.
    #[command(after_help = "Example: monas model convert models/goalie.srm goalie.scxml")]
    Convert(ConvertArguments),
    /// Draw the statechart of a model as SVG.
    #[command(after_help = "Example: monas model draw models/goalie.srm -o goalie.svg")]
    Draw {
        /// The model file.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// Where to write the drawing; standard output if not given.
        #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
        output: Option<PathBuf>,
        /// Leave out of account what the model says of where its states and transitions are drawn.
        #[arg(long)]
        no_layout: bool,
        #[command(flatten)]
        format: FormatArgument,
    },
    /// Write the messages that a chart is about as a `.proto` file: what its variables name, and the fields that its expressions use.
    ///
    /// What a field is follows from how it is used; the file is a beginning, to be completed by hand.
    #[command(
        after_help = "Example: monas model ontology models/extended_attacker.iac --package team -o messages/team.proto"
    )]
    Ontology {
        /// The model file.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// The package of the messages.
        #[arg(long, value_name = "NAME", default_value = "messages")]
        package: String,
        /// Where to write them; standard output if not given.
        #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
        output: Option<PathBuf>,
        #[command(flatten)]
        format: FormatArgument,
    },
    /// Say what is wrong with models, and nothing else.
    ///
    /// Ends with 0 if nothing is wrong or there are warnings only, with 3 if a model cannot be read, and with 5 if a check finds an error.
    #[command(after_help = "Example: monas model check models/goalie.srm --linked")]
    Check(CheckArguments),
    /// Say whether charts hold to a protocol: that of the protocol itself, and those of its players.
    ///
    /// What a file is, is told by its kind: the protocols (AIP), their charts (EAC; made from the protocols if none is given), the charts or roles of players.
    /// Ends with 0 if they conform, and with 5 if one does not.
    #[command(
        after_help = "Example: monas model conform models/extended_attacker.iac models/attack.eac models/attack.aip"
    )]
    Conform {
        /// The model files.
        #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
        files: Vec<PathBuf>,
        #[command(flatten)]
        format: FormatArgument,
    },
    /// Say whether robots, each with a role of its own, may wait for each other for ever.
    ///
    /// A message passes from one robot to another if the one's chart publishes or writes it, and the other's reads it by the one's name, as in
    /// `receiver.ready.Signal.Ready`. Messages are some time on their way. Given a protocol (AIP, EAC) too, who takes part in it is held against it, and each part must be taken.
    /// Ends with 0 if nothing is wrong or there are warnings only, with 3 if a model cannot be read, and with 5 if some wait for ever or that is not decided.
    #[command(
        after_help = "Example: monas model compose passer.srm receiver.srm --traces . ; monas model run passer.srm receiver.srm composed-E0930-1.trace"
    )]
    Compose(ComposeArguments),
    /// Say what of their charts the runs on tapes have been through: states, transitions, guards.
    ///
    /// A guard is seen to hold when its transition fires, and not to hold when a way out of the same state fires that is tried after it.
    #[command(
        after_help = "Example: monas run config/match.xml --record match.mcap ; monas model coverage match.mcap --draw coverage"
    )]
    Coverage(CoverageArguments),
    /// Say what differs between the statecharts of two models: states, transitions, what is written on them.
    ///
    /// Ends with 0 if nothing differs, and with 5 if something does.
    #[command(after_help = "Example: monas model diff before.srm after.srm -o difference.svg")]
    Diff(DiffArguments),
    /// Keep what was said of a role's states and transitions after its formulas were edited.
    ///
    /// What fits stays as it is. What no longer fits is listed, and stays in the text as a comment.
    #[command(after_help = "Example: monas model regenerate role.srm -o role.srm
What another role, or a chart from an editor, says is taken in by --from: monas model regenerate role.srm --from edited.stct")]
    Regenerate(RegenerateArguments),
    /// Change a chart in one place at a time, and say which of the changes no scenario notices.
    ///
    /// Guards, numbers, timers, actions, targets and priorities are changed. A change that cannot run at all is refused, and counts neither way. What no scenario notices is
    /// listed, with what a scenario would have to tell apart. Ends with 3 if a scenario fails on the model itself, and with 5 if less than --least is noticed.
    #[command(
        after_help = "Example: monas model mutate models/goalie.srm --scenarios tests/scenarios --least 80"
    )]
    Mutate(MutateArguments),
    /// Play a scenario, or a trace that `model check` or `model compose` has found, and print each step.
    ///
    /// In a scenario messages come and time goes by as it says, and what it expects is looked at. In a trace conditions on messages have the values that it says, and
    /// timers expire when it says. A trace of several robots is played on the charts of all of them. Ends with 5 if something else happens than is expected, or the chart stops by itself.
    #[command(
        after_help = "Example: monas model run models/goalie.srm tests/scenarios/goalie/dive_right.scenario
A trace: monas model check role.srm --traces . ; monas model run role.srm role-M14-1.trace"
    )]
    Run {
        /// The model file; of a trace of several robots one for each, `NAME=CHART` if it is not called like its robot.
        #[arg(required = true, value_name = "CHART", value_hint = ValueHint::FilePath)]
        files: Vec<PathBuf>,
        /// The scenario or the trace.
        #[arg(value_name = "SCENARIO", value_hint = ValueHint::FilePath)]
        trace: PathBuf,
        #[command(flatten)]
        format: FormatArgument,
    },
}

/// What `new` may be told.
#[derive(Args, Debug)]
pub(crate) struct NewArguments {
    /// The folder of a new project, or `activity` and a name.
    #[arg(required = true, num_args = 1..=2, value_name = "NAME")]
    pub(crate) names: Vec<String>,
    /// Make the activity a module: a crate of its own in `modules`, which can be loaded while the program runs.
    #[arg(long)]
    pub(crate) module: bool,
    /// Where a project finds Monas: a checkout, the address of a git repository, or a version; the checkout that this command was built from,
    /// if not given.
    #[arg(long, value_name = "PATH|GIT|VERSION")]
    pub(crate) monas: Option<String>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

/// What `deploy` may be told.
#[derive(Args, Debug)]
pub(crate) struct DeployArguments {
    /// The robot, by its name in the file.
    pub(crate) robot: String,
    /// The file of robots, in XML or TOML.
    #[arg(long, value_name = "FILE", default_value = "robots.xml", value_hint = ValueHint::FilePath)]
    pub(crate) robots: PathBuf,
    /// Bring this program, and build none.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) program: Option<PathBuf>,
    /// Only say what would be brought.
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Have what ran before run again.
    #[arg(long, conflicts_with_all = ["program", "dry_run", "list"])]
    pub(crate) rollback: bool,
    /// Say what was brought so far.
    #[arg(long, conflicts_with_all = ["program", "dry_run"])]
    pub(crate) list: bool,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

/// What `doctor` may be told.
#[derive(Args, Debug)]
pub(crate) struct DoctorArguments {
    /// The configuration to look at: a match or a file of agents, in XML or TOML.
    #[arg(default_value = DEFAULT_CONFIGURATION, value_hint = ValueHint::FilePath)]
    pub(crate) config: PathBuf,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

/// What `model check` may be told.
#[derive(Args, Debug)]
pub(crate) struct CheckArguments {
    /// The model files.
    #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) files: Vec<PathBuf>,
    /// An event that comes from outside: an activity, another agent or a person raises it.
    #[arg(long = "event", value_name = "NAME")]
    pub(crate) events: Vec<String>,
    /// How many states of a chart are explored at most; 0 for none.
    #[arg(long, value_name = "NUMBER", default_value_t = 100_000)]
    pub(crate) states: usize,
    /// How many activities the agent's pool runs at once; 12 if not given.
    #[arg(long, value_name = "NUMBER")]
    pub(crate) pool: Option<usize>,
    /// Check names too: against the messages, functions and activities that this program has.
    #[arg(long)]
    pub(crate) linked: bool,
    /// Say too what of the charts this recording has been through (with --all).
    #[arg(long = "tape", value_name = "TAPE", value_hint = ValueHint::FilePath, requires = "all")]
    pub(crate) tapes: Vec<PathBuf>,
    /// Check the properties in this file, and nothing else: whether each holds of all that the charts can do.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) properties: Vec<PathBuf>,
    /// Write each way to a finding as a file into this folder, for `model run`.
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub(crate) traces: Option<PathBuf>,
    /// Say what is only good to know, too.
    #[arg(long)]
    pub(crate) all: bool,
    /// For people, or for programs: one JSON object a line, or one document of SARIF 2.1.0 on standard output.
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub(crate) format: CheckFormat,
}

/// What `model compose` may be told.
#[derive(Args, Debug)]
pub(crate) struct ComposeArguments {
    /// The model of each robot, `NAME=FILE` if the robot is not called like its file; and the models of a protocol.
    #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) files: Vec<PathBuf>,
    /// How many messages are on their way at once from one robot to another; one more, and the oldest is lost.
    #[arg(long, value_name = "NUMBER", default_value_t = 2, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..=64))]
    pub(crate) channel: usize,
    /// Let any message be lost on its way.
    #[arg(long)]
    pub(crate) lose: bool,
    /// An event that comes from outside: an activity or a person raises it.
    #[arg(long = "event", value_name = "NAME")]
    pub(crate) events: Vec<String>,
    /// How many states of each robot, and of all together, are explored at most.
    #[arg(long, value_name = "NUMBER", default_value_t = 100_000)]
    pub(crate) states: usize,
    /// Ask this program which messages its activities publish: when they return, it is taken to be.
    #[arg(long)]
    pub(crate) linked: bool,
    /// Write each way to a finding as a file into this folder, for `model run`.
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub(crate) traces: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

/// What `model coverage` may be told.
#[derive(Args, Debug)]
pub(crate) struct CoverageArguments {
    /// The recordings; what they cover of equal charts is added up.
    #[arg(required = true, value_name = "TAPE", value_hint = ValueHint::FilePath)]
    pub(crate) tapes: Vec<PathBuf>,
    /// Draw each chart into this folder: green what was covered, red what was not, orange a guard that has held each time.
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub(crate) draw: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

/// What `model mutate` may be told.
#[derive(Args, Debug)]
pub(crate) struct MutateArguments {
    /// The model file.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) model: PathBuf,
    /// The folder of scenarios, with the folders in it; those of other models are left out.
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub(crate) scenarios: PathBuf,
    /// How many of a hundred changes are to be noticed at least.
    #[arg(long, value_name = "PERCENT", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=100))]
    pub(crate) least: u8,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

/// What `model diff` may be told.
#[derive(Args, Debug)]
pub(crate) struct DiffArguments {
    /// The model file as it was.
    #[arg(value_name = "A", value_hint = ValueHint::FilePath)]
    pub(crate) before: PathBuf,
    /// The model file as it is.
    #[arg(value_name = "B", value_hint = ValueHint::FilePath)]
    pub(crate) after: PathBuf,
    /// Draw both in one, what was added in green, what was removed in red, what is another in orange: a file that ends in .svg or .dot.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

/// What `model regenerate` may be told.
#[derive(Args, Debug)]
pub(crate) struct RegenerateArguments {
    /// The role, with its formulas as they are now.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) role: PathBuf,
    /// A role or a chart whose refinements are taken in; what the role itself says holds.
    #[arg(long, value_name = "MODEL", value_hint = ValueHint::FilePath)]
    pub(crate) from: Vec<PathBuf>,
    /// Where to write it; standard output if not given.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

/// How findings about models are written.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum CheckFormat {
    /// For people.
    Text,
    /// For programs: one object a line.
    Json,
    /// For programs that show findings in the text: SARIF 2.1.0.
    Sarif,
}

/// What `generate` may be told.
#[derive(Args, Debug)]
pub(crate) struct GenerateArguments {
    /// The model file.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) model: PathBuf,
    /// The folder of the crate, in `statecharts`; if not given, it is called like the model.
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub(crate) to: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

/// What `model transform` may be told.
#[derive(Args, Debug)]
pub(crate) struct TransformArguments {
    /// The model file.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) file: PathBuf,
    /// What to make of it.
    #[arg(long, value_name = "KIND")]
    pub(crate) to: Option<Kind>,
    /// Another model to take in: the protocols (AIP) for an SRM, a protocol's chart (EAC) for an IAC.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) with: Vec<PathBuf>,
    /// An older statechart of the role (IAC): what it says and the role does not is kept, and what cannot be kept is listed.
    #[arg(long, value_name = "MODEL", value_hint = ValueHint::FilePath)]
    pub(crate) keep: Option<PathBuf>,
    /// Which one, where there are several: the name of a protocol or a role.
    #[arg(long)]
    pub(crate) name: Option<String>,
    /// Where to write it; standard output if not given.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    /// How to write it: a format of `model convert`, or for a functionality table `table`, `html` or `csv`.
    #[arg(long = "as", value_name = "FORMAT")]
    pub(crate) written: Option<String>,
    /// Write it even if the format cannot say all of it.
    #[arg(long)]
    pub(crate) lossy: bool,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

/// The kinds of models that models are transformed into.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Kind {
    /// Use cases, from actors and goals.
    Suc,
    /// Protocols, from use cases.
    Aip,
    /// Roles, from use cases.
    Srm,
    /// The functionality table, from roles.
    Ft,
    /// The statechart of a protocol, from protocols.
    Eac,
    /// The statechart of a role, from roles.
    Iac,
}

/// What `model convert` may be told.
#[derive(Args, Debug)]
pub(crate) struct ConvertArguments {
    /// The model file.
    #[arg(value_name = "IN", value_hint = ValueHint::FilePath)]
    pub(crate) input: PathBuf,
    /// Where to write it; `-` is standard output.
    #[arg(value_name = "OUT", value_hint = ValueHint::FilePath)]
    pub(crate) output: PathBuf,
    /// The format: text, role, xmi, xmi-2010, xmi-flat, xmi-2012, xmi-2018, scxml or rust. If not given, the ending of OUT says it
    /// (.model, .stct, .xmi, .scxml, .rs, .txt); any other ending means XMI for what is text, and text for what is XMI.
    #[arg(long = "as", value_name = "FORMAT")]
    pub(crate) written: Option<String>,
    /// Write it even if the format cannot say all of it.
    #[arg(long)]
    pub(crate) lossy: bool,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

#[derive(Subcommand, Debug)]
pub(crate) enum ConfigCommand {
    /// Read a configuration and everything it names, bind its charts, and say what is wrong.
    #[command(after_help = "Example: monas config check config/match.xml")]
    Check(ConfigArguments),
    /// Print every value of a configuration with where it comes from: a default, a file, a robot or the command line.
    ///
    /// Names of activities and models are not looked up: `config check` does that. A line begins with what `--set` takes.
    #[command(after_help = "Example: monas config show config/agents.xml --set agent.Motion.frequency=50")]
    Show(ConfigArguments),
    /// Print what a configuration may hold, for editors: an XML schema for XML, a JSON schema for TOML.
    #[command(after_help = "Example: monas config schema --xsd > monas.xsd")]
    #[command(group(clap::ArgGroup::new("language").required(true)))]
    Schema {
        /// XML Schema 1.0.
        #[arg(long, group = "language")]
        xsd: bool,
        /// JSON Schema 2020-12.
        #[arg(long, group = "language")]
        json: bool,
        /// Of the file of robots that `deploy` reads, and not of runs.
        #[arg(long)]
        robots: bool,
    },
}

/// Which configuration is meant.
#[derive(Args, Debug)]
pub(crate) struct ConfigArguments {
    /// A match or a file of agents, in XML or TOML.
    #[arg(default_value = DEFAULT_CONFIGURATION, value_hint = ValueHint::FilePath)]
    pub(crate) config: PathBuf,
    #[command(flatten)]
    pub(crate) layers: LayerArguments,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

/// What goes over a configuration.
#[derive(Args, Debug, Default)]
pub(crate) struct LayerArguments {
    /// Set a value, for example agent.Motion.frequency=50; in a match every role that has such an agent. May be given several times.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) settings: Vec<String>,
    /// Put what is said of one robot over the configuration: robots/NAME.xml or .toml, beside it or in a folder above.
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
}

#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct FormatArgument {
    /// For people, or for programs: one JSON object a line.
    #[arg(long = "format", value_name = "FORMAT", default_value = "text")]
    pub(crate) value: Format,
}

/// How results and diagnostics are written.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn definitions_hold_together() {
        Arguments::command().debug_assert();
    }

    /// The commands that do something, each with the words that lead to it.
    fn leaves(command: &clap::Command, words: &str, found: &mut Vec<(String, clap::Command)>) {
        let below: Vec<&clap::Command> =
            command.get_subcommands().filter(|below| below.get_name() != "help").collect();
        if below.is_empty() {
            found.push((words.to_owned(), command.clone()));
        }
        for command in below {
            leaves(command, &format!("{words} {}", command.get_name()), found);
        }
    }

    /// The words of a line; single quotes hold one together.
    fn shell_words(line: &str) -> Vec<String> {
        let parts = line.split('\'').enumerate();
        let words = |(index, part): (usize, &str)| match index % 2 {
            0 => part.split_whitespace().map(str::to_owned).collect(),
            _ => vec![part.to_owned()],
        };
        parts.flat_map(words).collect()
    }

    #[test]
    fn every_help_shows_an_example_that_is_understood() {
        let mut found = Vec::new();
        leaves(&Arguments::command(), "monas", &mut found);
        assert!(found.len() > 20, "{}", found.len());
        for (words, command) in found {
            let help = command.clone().render_long_help().to_string();
            let example = help.lines().find_map(|line| line.trim().strip_prefix("Example: "));
            let example = example.unwrap_or_else(|| panic!("no example for `{words}`:\n{help}"));
            if words == "monas completions" {
                continue; // its example is for the shell
            }
            let mut lines = example.split([';', '>', '&']).map(str::trim);
            let line = lines.find(|line| line.starts_with(&words));
            let line =
                line.unwrap_or_else(|| panic!("`{words}` has an example of something else: {example}"));
            let parsed = Arguments::try_parse_from(shell_words(line));
            assert!(
                parsed.is_ok(),
                "{line}: {}",
                parsed.err().map(|error| error.to_string()).unwrap_or_default()
            );
        }
    }

    #[test]
    fn run_has_defaults() {
        let Command::Run(run) = Arguments::parse_from(["monas", "run"]).command else { panic!("not a run") };
        assert_eq!(run.config, PathBuf::from(DEFAULT_CONFIGURATION));
        assert_eq!((run.seed, run.length, run.record, run.realtime), (None, None, None, false));
        assert_eq!(run.format.value, Format::Text);
    }

    #[test]
    fn run_takes_everything() {
        let line = "monas run m.xml --seed 7 --for 1.5s --record t.mcap --realtime --format json";
        let Command::Run(run) = Arguments::parse_from(line.split(' ')).command else { panic!("not a run") };
        assert_eq!(run.config, PathBuf::from("m.xml"));
        assert_eq!((run.seed, run.length), (Some(7), Some(Duration::from_millis(1500))));
        assert_eq!(run.record, Some(PathBuf::from("t.mcap")));
        assert!(run.realtime);
        assert_eq!(run.format.value, Format::Json);
    }
}
