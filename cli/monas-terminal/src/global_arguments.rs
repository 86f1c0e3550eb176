//! The options that each command has.

use clap::{ArgAction, Args, ColorChoice};
use tracing_subscriber::filter::LevelFilter;

use crate::CommandOutput;

/// Options for output, which stand before or behind the command.
#[derive(Args, Debug)]
#[command(next_help_heading = "Global options")]
pub struct GlobalArguments {
    /// Print results and errors only: no warnings, no progress, no remarks.
    #[arg(short, long, global = true, conflicts_with = "verbose", display_order = 1000)]
    quiet: bool,
    /// Log more on standard error: -v what happens, -vv details; MONAS_LOG has precedence.
    #[arg(short, long, global = true, action = ArgAction::Count, display_order = 1001)]
    verbose: u8,
    /// Use colours: always, never, or on a terminal unless NO_COLOR is set.
    #[arg(
        long,
        global = true,
        value_name = "WHEN",
        default_value = "auto",
        hide_possible_values = true,
        hide_default_value = true,
        display_order = 1002
    )]
    color: ColorChoice,
}

impl GlobalArguments {
    /// Applies the options to the output of the command.
    pub fn apply(&self, console: &mut CommandOutput<'_>) {
        console.quiet = self.quiet;
        console.paint(self.color);
        let level = match (self.quiet, self.verbose) {
            (true, _) => LevelFilter::ERROR,
            (false, 0) => return,
            (false, 1) => LevelFilter::INFO,
            (false, _) => LevelFilter::DEBUG,
        };
        if let Some(log) = &mut console.log {
            log.limit(level);
        }
    }
}

/// The colours that a command line asks for, although it may be invalid: errors of the command line
/// are coloured, too.
pub fn wanted_colours(arguments: &[String]) -> ColorChoice {
    let mut values = arguments.iter().enumerate().filter_map(|(index, argument)| match argument.as_str() {
        "--color" => arguments.get(index + 1).map(String::as_str),
        other => other.strip_prefix("--color="),
    });
    values.next_back().and_then(|value| value.parse().ok()).unwrap_or(ColorChoice::Auto)
}
