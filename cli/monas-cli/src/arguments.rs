//! The top level of the command line. Help and completions come from the same definitions.

use clap::{Parser, Subcommand};
use clap_complete::Shell;
use monas_terminal::GlobalArguments;

#[cfg(unix)]
use crate::commands::agent::AgentCommand;
#[cfg(unix)]
use crate::commands::chart::ChartCommand;
use crate::commands::config::ConfigCommand;
use crate::commands::deploy::DeployArguments;
use crate::commands::doctor::DoctorArguments;
#[cfg(feature = "soccer")]
use crate::commands::eval::EvalArguments;
use crate::commands::explain::ExplainArguments;
use crate::commands::generate::GenerateArguments;
use crate::commands::log::LogArguments;
use crate::commands::model::ModelCommand;
#[cfg(unix)]
use crate::commands::module::ModuleCommand;
use crate::commands::new::NewArguments;
#[cfg(feature = "soccer")]
use crate::commands::referee::RefereeArguments;
use crate::commands::run::RunArguments;
#[cfg(unix)]
use crate::commands::studio::StudioArguments;
use crate::commands::tape::TapeCommand;
#[cfg(unix)]
use crate::commands::top::TopArguments;
#[cfg(unix)]
use crate::commands::topic::TopicArguments;
#[cfg(feature = "soccer")]
use crate::commands::vision::VisionArguments;
use crate::commands::why::WhyArguments;

/// From a formula to a running robot team.
#[derive(Parser, Debug)]
#[command(name = "monas", version, arg_required_else_help = true, after_help = EXIT_CODES)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) globals: GlobalArguments,
    #[command(subcommand)]
    pub(crate) command: Command,
}

const EXIT_CODES: &str = "\
A configuration, model, scenario or file of properties named `-` is read from standard input.

Exit codes:
  0    done
  1    ran and failed
  2    usage
  3    invalid configuration or model
  4    nothing to connect to
  5    a replay differs from its recording, or a check of a model finds an error
  130  interrupted
  143  terminated

Environment:
  NO_COLOR   switches colours off
  COLUMNS    the width of tables and help texts
  MONAS_LOG  chooses what is logged, for example `info` or `monas=debug`";

#[derive(Subcommand, Debug)]
pub(crate) enum Command {
    /// Run a match or a set of agents.
    #[command(after_help = "Example: monas run config/match.xml --seed 7 --for 60s")]
    Run(Box<RunArguments>),
    /// Read, check and draw models.
    #[command(subcommand)]
    Model(ModelCommand),
    /// Generate a Rust crate from the statechart of a model, and link it into the team's program.
    ///
    /// Missing activities get skeletons, which are never overwritten.
    #[command(after_help = "Example: monas generate models/goalie.srm")]
    Generate(GenerateArguments),
    /// Inspect configurations without running them.
    #[command(subcommand)]
    Config(ConfigCommand),
    /// Inspect the topics of a run, and publish on them.
    #[cfg(unix)]
    Topic(TopicArguments),
    /// Inspect and change the agents of a run.
    #[cfg(unix)]
    #[command(subcommand)]
    Agent(AgentCommand),
    /// Inspect the statecharts of a run, and raise events in them.
    #[cfg(unix)]
    #[command(subcommand)]
    Chart(ChartCommand),
    /// Load, replace and unload activities of a run from shared objects.
    #[cfg(unix)]
    #[command(subcommand)]
    Module(ModuleCommand),
    /// Monitor the agents of a run and the load of their activities.
    ///
    /// On a terminal the view is refreshed until `q` is pressed; otherwise one interval is printed.
    /// Shares refer to one core. Activities that use nearly a whole core, block, fail, leak memory
    /// or do not return are marked.
    #[cfg(unix)]
    #[command(after_help = "Example: monas top --host blue-2")]
    Top(TopArguments),
    /// View a run or a tape in the browser: charts, agents, topics, log, and the field.
    ///
    /// Serves a page on this computer, which needs no other program and no network, and prints its
    /// address. The page is read-only, and the run does not wait for it. `monas run --studio` does
    /// the same from within a run. A tape can be played back, and opened at any moment.
    #[cfg(unix)]
    #[command(after_help = "Example: monas studio match.mcap")]
    Studio(StudioArguments),
    /// Explain why a state was active at a moment of a tape, or why a transition did not fire.
    ///
    /// Of a state: the transitions that led to it, and the fields that their conditions read, with
    /// the messages as they had been delivered to the agent. Of a transition: what fired instead or
    /// held it, each part of its guard with its value, and the messages behind these values, back
    /// to the readings of sensors, also over the radio. A click on a state or a transition in the
    /// studio of a tape shows the same.
    #[command(after_help = "Example: monas why match.mcap blue-2 --state RightKick --at 22.5\n\
                            Example: monas why match.mcap blue-2 --transition 'CONDITION -> kickBall' --at 22.5")]
    Why(WhyArguments),
    /// Follow the log of a run, or read it from a tape.
    ///
    /// The lines are the messages on `monas/log` of each robot, whatever the logger's settings keep
    /// out of files and consoles.
    #[command(after_help = "Example: monas log --robot blue-2 --agent Attacker --level warning")]
    Log(LogArguments),
    /// Inspect, recover, cut, merge, draw, export and replay recordings.
    #[command(subcommand)]
    Tape(TapeCommand),
    /// Create a project, or an activity in one.
    ///
    /// `monas new my-team` creates a folder that builds, runs and passes its tests at once. `monas
    /// new activity Vision`, in a project, creates a file that the project's build finds.
    #[command(after_help = "Example: monas new my-team && cd my-team && cargo test")]
    New(NewArguments),
    /// Deploy the program, a configuration and its models to a robot, and run them there.
    ///
    /// The program is built for the robot, copied over ssh with all files that the configuration
    /// names, verified by hashes, and started as a service. If it does not keep running, the
    /// previous release is started again. A file lists the robots with their addresses: `<robot
    /// name="nao-2" address="nao@10.0.2.2" config="config/agents.xml"/>`.
    #[command(after_help = "Example: monas deploy nao-2")]
    Deploy(DeployArguments),
    /// Check toolchain, permissions, clock, ports and configuration, and suggest repairs.
    #[command(after_help = "Example: monas doctor config/agents.xml")]
    Doctor(DoctorArguments),
    /// Referee robots elsewhere by the league's protocol, as a GameController does.
    ///
    /// Reads decisions from standard input, one per line, and sends the state of the game twice a
    /// second. It shows which players report. The referee of a match decides by itself: see `monas
    /// run --referee`.
    #[cfg(feature = "soccer")]
    Referee(RefereeArguments),
    /// Compare goalie and attacker built in three ways: play, cost, lines and state.
    ///
    /// Directly on the robot interface, as Monas agents with one activity for all decisions, and by
    /// ASEME from liveness formulas; all three with the same skills. Plays matches against the team
    /// of config/match.xml, which takes about a minute.
    #[cfg(feature = "soccer")]
    #[command(after_help = "Example: monas eval --seeds 4")]
    Eval(EvalArguments),
    /// Find ball, goals, lines, field border and robots in images, and draw them over each.
    ///
    /// Prints what was seen, with distance and bearing from the pose of the camera, and writes each
    /// image with what was found as `NAME.seen.png`. The colours are calibrated from each image
    /// itself, or begin with a colour table, which `--calibrate` makes from images.
    #[cfg(feature = "soccer")]
    #[command(after_help = "Example: monas vision --pitch 8 --view 60.9 frame.jpg")]
    Vision(VisionArguments),
    /// Explain the code of a diagnostic: what it means, an example, and the remedy.
    #[command(after_help = "Example: monas explain E0205")]
    Explain(ExplainArguments),
    /// Write the manual pages of all commands into a folder.
    #[command(after_help = "Example: monas man ~/.local/share/man/man1")]
    Man {
        /// The folder; it is created if it is not there.
        #[arg(value_hint = clap::ValueHint::DirPath)]
        folder: std::path::PathBuf,
    },
    /// Print a completion script for a shell.
    #[command(after_help = "Example: source <(monas completions bash)")]
    Completions {
        /// The shell.
        shell: Shell,
    },
}

impl Command {
    /// Whether the command writes results until it is stopped, and ends when nothing reads them.
    pub(crate) const fn is_stream(&self) -> bool {
        match self {
            #[cfg(unix)]
            Command::Topic(_) | Command::Top(_) => true,
            Command::Log(_) | Command::Tape(_) => true,
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::time::Duration;

    use clap::CommandFactory;

    use super::*;
    use crate::input::DEFAULT_CONFIGURATION;
    use monas_terminal::Format;

    #[test]
    fn definitions_hold_together() {
        Arguments::command().debug_assert();
    }

    /// The commands without subcommands, each with the words that lead to it.
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
            let help = command.clone().term_width(usize::MAX).render_long_help().to_string();
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
    fn every_help_fits_80_columns() {
        let mut found = Vec::new();
        leaves(&Arguments::command(), "monas", &mut found);
        for (words, command) in found {
            let help = command.term_width(80).render_long_help().to_string();
            let wide = help.lines().find(|line| line.chars().count() > 80);
            assert_eq!(wide, None, "{words}");
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
