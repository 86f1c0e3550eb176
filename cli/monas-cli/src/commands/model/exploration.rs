//! The limits of an exploration, its progress, and its end by Ctrl-C.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::time::Duration;

use aseme_verify::{CheckProgress, CheckSettings, ExplorationExtent, ProgressObserver};
use clap::Args;
use indicatif::ProgressBar;
use monas_terminal::{CommandFailure, CommandOutput, Format, Interrupt, WallClock, counted};
use yase_explore::{ExplorationProgress, ExplorationStop};

/// The time after which progress is shown first, if standard error is a terminal.
const PROGRESS_DELAY: Duration = Duration::from_secs(1);

/// The time between two updates of it.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(200);

/// Limits of an exploration.
#[derive(Args, Debug)]
pub(crate) struct ExplorationArguments {
    /// The largest number of states to explore, of each chart and of a composition; 0 for none.
    #[arg(long, value_name = "NUMBER", default_value_t = 100_000)]
    pub(crate) states: usize,
    /// The longest time to explore, in seconds.
    #[arg(long, value_name = "NUMBER", default_value_t = 300)]
    pub(crate) seconds: u64,
    /// The most memory for explored states, in mebibytes, as far as it can be estimated.
    #[arg(long, value_name = "MIB", default_value_t = 1024)]
    pub(crate) memory: usize,
}

impl ExplorationArguments {
    /// Sets the limits, and an observer that shows progress and stops at the time limit or after an
    /// interrupt.
    ///
    /// # Errors
    /// The process handles signals already.
    pub(crate) fn apply(
        &self,
        settings: &mut CheckSettings,
        console: &CommandOutput<'_>,
    ) -> Result<Interrupt, CommandFailure> {
        let interrupt =
            Interrupt::for_console(console).map_err(|error| CommandFailure::failed(Format::Text, error))?;
        (settings.states, settings.bytes) = (self.states, self.memory.saturating_mul(1 << 20));
        let display = ProgressDisplay {
            bar: console
                .bars
                .as_ref()
                .filter(|_| !console.quiet)
                .map(|bars| bars.add(ProgressBar::new_spinner())),
            next: Mutex::new(PROGRESS_DELAY),
        };
        let (clock, limit) = (WallClock::start(), Duration::from_secs(self.seconds));
        let requested = interrupt.clone();
        settings.observer = ProgressObserver::new(move |progress| {
            let elapsed = clock.elapsed();
            display.show(elapsed, progress);
            match requested.is_requested() || elapsed > limit {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        Ok(interrupt)
    }
}

struct ProgressDisplay {
    bar: Option<ProgressBar>,
    /// The time of the next line.
    next: Mutex<Duration>,
}

impl ProgressDisplay {
    fn show(&self, elapsed: Duration, progress: CheckProgress) {
        let Ok(mut next) = self.next.lock() else { return };
        if self.bar.is_none() || elapsed < *next {
            return;
        }
        let done = match progress {
            CheckProgress::Checking { done, of } => format!("{done} of {of} parts checked"),
            CheckProgress::Exploring(ExplorationProgress { states, open, bytes }) => {
                format!("{states} states, {open} of them to be expanded, {} MiB", bytes >> 20)
            }
            _ => String::new(),
        };
        let line = format!("{} s: {done}; Ctrl-C gives what is known", elapsed.as_secs());
        self.bar.iter().for_each(|bar| {
            bar.set_message(line.clone());
            bar.tick();
        });
        *next = elapsed + PROGRESS_INTERVAL;
    }
}

impl Drop for ProgressDisplay {
    fn drop(&mut self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }
}

/// The extent of an exploration in words.
pub(crate) fn extent(explored: Option<&ExplorationExtent>) -> String {
    let Some(explored) = explored else { return String::new() };
    let why = match explored.stop {
        None => return format!(", {} explored", counted(explored.states as u64, "state")),
        Some(ExplorationStop::States) => "the limit of states; see `--states`".to_owned(),
        Some(ExplorationStop::Bytes) => "the limit of memory; see `--memory`".to_owned(),
        Some(ExplorationStop::Observer) => "stopped, or the limit of time; see `--seconds`".to_owned(),
        Some(ExplorationStop::Alternatives) => "a step has too many alternatives".to_owned(),
        Some(ExplorationStop::Queues) => {
            format!(
                "more than {} waiting `{}` are taken for as many",
                yase_explore::QUEUED,
                explored.overflowing.join("`, `")
            )
        }
    };
    format!(", exploration not finished: {} ({why})", counted(explored.states as u64, "state"))
}
