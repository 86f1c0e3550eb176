//! What the command sets up for the whole process: its console, its log, and what happens when code panics.

use std::io::{self, IsTerminal, Write};
use std::panic;

use clap::CommandFactory;
use clap_complete::CompleteEnv;
use indicatif::MultiProgress;
use monas::logger::{self, Logger, Settings, Severity};
use tracing_subscriber::prelude::*;
use tracing_subscriber::{EnvFilter, Registry, reload};

use crate::arguments::Arguments;
use crate::console::Console;
use crate::exit::Exit;
use crate::handover;

/// Runs the command as this process.
pub(crate) fn main() -> Exit {
    // A shell that asks what fits is answered, and that is all.
    CompleteEnv::with_factory(Arguments::command).complete();
    let bars = MultiProgress::new();
    let log = Log::begin(&bars);
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
        log: log.clone(),
        out: &mut out,
        err: &mut err,
    };
    let exit = crate::dispatch(std::env::args_os(), &mut console);
    log.iter().for_each(|log| log.logger.end());
    exit
}

/// What is logged if MONAS_LOG does not say. What zenoh warns of is no fault of a run, and what fails is told as an error of the link.
const USUAL: &str = "warn,zenoh=error";

/// The log of this process: on standard error what is usual or what MONAS_LOG asks for, and what `--log` asks for.
#[derive(Clone)]
pub(crate) struct Log {
    logger: Logger,
    usual: reload::Handle<EnvFilter, Registry>,
    bars: MultiProgress,
}

impl Log {
    /// Warnings and errors, or what MONAS_LOG asks for, above whatever bars there are.
    fn begin(bars: &MultiProgress) -> Option<Log> {
        let asked = std::env::var("MONAS_LOG").unwrap_or_else(|_| USUAL.into());
        let (filter, mistake) = match EnvFilter::try_new(asked) {
            Ok(filter) => (filter, None),
            Err(mistake) => (EnvFilter::new("warn"), Some(mistake)),
        };
        let (filter, usual) = reload::Layer::new(filter);
        let above = bars.clone();
        let writer = move || AboveBars(above.clone());
        let lines = tracing_subscriber::fmt::layer().with_writer(writer).with_ansi(false).without_time();
        let (layer, logger) = logger::layer();
        // It fails only where a program that calls this library has chosen a log of its own: that one stays.
        let is_ours =
            tracing_subscriber::registry().with(lines.with_filter(filter)).with(layer).try_init().is_ok();
        if let Some(mistake) = mistake {
            tracing::warn!("MONAS_LOG is not understood, warnings and errors are logged: {mistake}");
        }
        is_ours.then(|| Log { logger, usual, bars: bars.clone() })
    }

    /// From now on, lines that are so grave or graver are published on the hosts of the run.
    pub(crate) fn publish(&self, least_grave: Severity) {
        self.logger.publish(least_grave);
    }

    /// Has a log written besides. It says what is on the console, unless MONAS_LOG does.
    pub(crate) fn write(&self, settings: Settings) -> io::Result<()> {
        let bars = self.bars.clone();
        self.logger.begin_with(settings, move |lines| {
            // If nobody sees the console there is nobody to tell.
            let _ = AboveBars(bars.clone()).write_all(lines);
        })?;
        if std::env::var_os("MONAS_LOG").is_none() {
            // The filter is gone only with the whole log.
            let _ = self.usual.reload(EnvFilter::new("off"));
        }
        Ok(())
    }
}

/// Standard error, with bars taken away while something is written and put back after it.
struct AboveBars(MultiProgress);

impl Write for AboveBars {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.suspend(|| io::stderr().write_all(bytes).map(|()| bytes.len()))
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stderr().flush()
    }
}
