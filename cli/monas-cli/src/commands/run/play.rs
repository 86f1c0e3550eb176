//! Runs a match in simulated time and shows its progress.

use std::time::Duration;

use monas::config::Layers;
use monas_match::{MatchOptions, MatchPlan, MatchSource, RunningMatch};
use monas_studio::Pace;
use monas_tape::Tape;

use super::outputs::RecordingAlarm;
use super::pacer::{Pacer, factor};
use super::{RunArguments, control, outputs, scoreboard, summary};
use crate::terminal::{CommandFailure, CommandOutput, Exit, Interrupt, WallClock, report};

/// Simulated time between two updates of the scoreboard.
const LOOK: Duration = Duration::from_millis(100);
/// The same with a pace, so that watchers see continuous progress.
const PACED_LOOK: Duration = Duration::from_millis(10);

pub(crate) fn execute(
    arguments: &RunArguments,
    layers: &Layers,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let plan = MatchSource::load_with(&arguments.config, &monas::Registry::linked(), layers)
        .map_err(|diagnostics| CommandFailure::Invalid(format, diagnostics))?;
    report::write(console, format, plan.warnings())?;
    let plan = match plan.has_links() {
        true if !arguments.realtime => {
            let message = "robots of this match have links to other processes, which do not wait for simulated time: add \
                           --realtime";
            return Err(CommandFailure::Usage(message.into()));
        }
        true => plan.linked(),
        false => plan,
    };
    let plan = arguments.league.join(plan).map_err(|error| CommandFailure::failed(format, error))?;
    let interrupt = Interrupt::for_console(console).map_err(|error| CommandFailure::failed(format, error))?;
    let socket = control::bind(arguments, console)?;
    let tape = outputs::open(arguments, Tape::to_file, console)?;
    let clock = WallClock::start();
    let running = play(plan, arguments, socket, tape.clone(), &interrupt, clock, console);
    let wall = clock.elapsed();
    let running = running.or_else(|failure| {
        // A thread that does not return keeps the match, and with it the tape.
        outputs::finish(tape.clone(), format)?;
        Err(failure)
    })?;
    let results = running.finish().map_err(|error| CommandFailure::failed(format, error))?;
    summary::write(console.out, format, &results, wall)?;
    outputs::finish(tape, format)?;
    if let Some(unstopped) = results.unstopped {
        return Err(CommandFailure::failed(format, unstopped));
    }
    Ok(match interrupt.exit() {
        Some(exit) => exit,
        None if results.agents.iter().any(|agent| agent.stopped.is_some()) => Exit::Failure,
        None => Exit::Success,
    })
}

/// Plays until the match is over, the requested time has passed, or an interrupt.
fn play(
    plan: MatchPlan,
    arguments: &RunArguments,
    socket: Option<control::ControlSocket>,
    tape: Option<Tape>,
    interrupt: &Interrupt,
    clock: WallClock,
    console: &mut CommandOutput<'_>,
) -> Result<RunningMatch, CommandFailure> {
    let failed = |error: monas_match::Error| CommandFailure::failed(arguments.format.value, error);
    let length = arguments.length.unwrap_or_else(|| plan.length());
    let options = MatchOptions { seed: arguments.seed.unwrap_or_default(), record: tape.clone() };
    let mut running = plan.start(options).map_err(|error| match error.diagnostics() {
        [] => failed(error),
        wrong => CommandFailure::Invalid(arguments.format.value, wrong.to_vec()),
    })?;
    // The socket closes with this function, since nothing advances the match afterwards.
    let handle = running.simulation().run_handle();
    let control = control::serve(socket, handle.clone(), tape.clone(), arguments)?;
    let pace = Pace::new(factor(arguments));
    let _studio = control::view(control.as_ref(), Some(pace.clone()), arguments, console)?;
    let mut pacer = Pacer::new(clock, pace.clone());
    let mut alarm = RecordingAlarm::new(tape, handle);
    if pace.factor().is_finite() {
        running.measure();
    }
    let mut scoreboard = scoreboard::for_console(console, length, arguments.field);
    scoreboard.show(&running)?;
    while running.now() < length && !running.is_over() && !interrupt.is_requested() {
        let look = if pace.factor().is_finite() { PACED_LOOK } else { LOOK };
        let next = (running.now() + look).min(length);
        running = running.advance_until_cancelled(next, || interrupt.is_requested()).map_err(failed)?;
        alarm.check(running.simulation().now());
        scoreboard.show(&running)?;
        pacer.wait(running.now(), interrupt);
    }
    alarm.check(running.simulation().now());
    Ok(running)
}
