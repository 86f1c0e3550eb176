//! A match in simulated time, shown while it lasts.

use std::time::Duration;

use monas::config::Layers;
use monas_match::{Match, MatchPlan, Options, RunningMatch};

use super::interrupt::Interrupt;
use super::pace::WallClock;
use super::{control, scoreboard, table};
use crate::arguments::RunArguments;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;

/// How much simulated time passes between two looks at the match.
const LOOK: Duration = Duration::from_millis(100);
/// The same where it is held back to real time, so that others see it flow.
const PACED_LOOK: Duration = Duration::from_millis(10);

pub(super) fn execute(
    arguments: &RunArguments,
    layers: &Layers,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let plan = Match::load_with(&arguments.config, &monas::Registry::linked(), layers)
        .map_err(|diagnostics| Failure::Invalid(format, diagnostics))?;
    report::write(console, format, plan.warnings())?;
    let plan = match plan.has_links() {
        true if !arguments.realtime => {
            let message = "robots of this match have links to other processes, which do not wait for simulated time: add \
                           --realtime";
            return Err(Failure::Usage(message.into()));
        }
        true => plan.linked(),
        false => plan,
    };
    let interrupt = Interrupt::for_console(console).map_err(|error| Failure::failed(format, error))?;
    let clock = WallClock::start();
    let running = play(plan, arguments, &interrupt, clock, console)?;
    let wall = clock.elapsed();
    let summary = running.finish().map_err(|error| Failure::failed(format, error))?;
    table::write(console.out, format, &summary, wall)?;
    Ok(if interrupt.is_requested() { Exit::Interrupted } else { Exit::Success })
}

/// Plays until the match is over, the time asked for has passed, or somebody interrupts.
fn play(
    plan: MatchPlan,
    arguments: &RunArguments,
    interrupt: &Interrupt,
    clock: WallClock,
    console: &mut Console<'_>,
) -> Result<RunningMatch, Failure> {
    let failed = |error: monas_match::Error| Failure::failed(arguments.format.value, error);
    let length = arguments.length.unwrap_or_else(|| plan.length());
    let options = Options { seed: arguments.seed.unwrap_or_default(), record: arguments.record.clone() };
    let mut running = plan.start(options).map_err(|error| match error.diagnostics() {
        [] => failed(error),
        wrong => Failure::Invalid(arguments.format.value, wrong.to_vec()),
    })?;
    // It ends when this function does, since then nobody advances the match any more.
    let _control = control::serve(arguments, running.simulation().overview(), console)?;
    let look = if arguments.realtime { PACED_LOOK } else { LOOK };
    let mut scoreboard = scoreboard::for_console(console, length);
    scoreboard.show(&running)?;
    while running.now() < length && !running.is_over() && !interrupt.is_requested() {
        running.advance((running.now() + look).min(length)).map_err(failed)?;
        scoreboard.show(&running)?;
        if arguments.realtime {
            clock.wait_until(running.now(), interrupt);
        }
    }
    Ok(running)
}
