//! What the command sets up for the whole process: its console, its log, and what happens when code panics.

use std::io::{self, IsTerminal, Write};
use std::panic;

use clap::CommandFactory;
use clap_complete::CompleteEnv;
use indicatif::MultiProgress;
use tracing_subscriber::EnvFilter;

use crate::arguments::Arguments;
use crate::console::Console;
use crate::exit::Exit;
use crate::handover;

/// Runs the command as this process.
pub(crate) fn main() -> Exit {
    // A shell that asks what fits is answered, and that is all.
    CompleteEnv::with_factory(Arguments::command).complete();
    let bars = MultiProgress::new();
    log_to_standard_error(&bars);
    handover::hand_over();
    // Whoever catches a panic decides what becomes of it; the log says where it was.
    panic::set_hook(Box::new(|panic| tracing::error!("{panic}")));
    let (mut out, mut err) = (io::stdout(), io::stderr());
    let colours_are_welcome = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
    let mut console = Console {
        colour_out: colours_are_welcome && out.is_terminal(),
        colour_err: colours_are_welcome && err.is_terminal(),
        bars: err.is_terminal().then_some(bars),
        catches_signals: true,
        out: &mut out,
        err: &mut err,
    };
    crate::dispatch(std::env::args_os(), &mut console)
}

/// What is logged if MONAS_LOG does not say. What zenoh warns of is no fault of a run, and what fails is told as an error of the link.
const USUAL: &str = "warn,zenoh=error";

/// Warnings and errors, or what MONAS_LOG asks for, above whatever bars there are.
fn log_to_standard_error(bars: &MultiProgress) {
    let asked = std::env::var("MONAS_LOG").unwrap_or_else(|_| USUAL.into());
    let (filter, mistake) = match EnvFilter::try_new(asked) {
        Ok(filter) => (filter, None),
        Err(mistake) => (EnvFilter::new("warn"), Some(mistake)),
    };
    let bars = bars.clone();
    let writer = move || AboveBars(bars.clone());
    let log =
        tracing_subscriber::fmt().with_env_filter(filter).with_writer(writer).with_ansi(false).without_time();
    // It fails only where a program that calls this library has chosen a log of its own: that one stays.
    let _ = log.try_init();
    if let Some(mistake) = mistake {
        tracing::warn!("MONAS_LOG is not understood, warnings and errors are logged: {mistake}");
    }
}

/// Standard error, with bars taken away while something is written and put back after it.
struct AboveBars(MultiProgress);

impl Write for AboveBars {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.suspend(|| io::stderr().write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stderr().flush()
    }
}
