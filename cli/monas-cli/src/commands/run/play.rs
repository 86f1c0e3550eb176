//! Runs a match in simulated or real time and shows its progress.

use std::time::Duration;

use monas::config::Layers;
use monas_match::{MatchOptions, MatchPlan, MatchSource, RunningMatch};
use monas_studio::Pace;
use monas_tape::Tape;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Interrupt, WallClock, report};

use super::outputs::RecordingAlarm;
use super::pacer::{Pacer, factor};
#[cfg(unix)]
use super::processes::{self, RobotProcesses};
#[cfg(unix)]
use super::real_time;
use super::{RunArguments, control, outputs, scoreboard, summary};

/// Simulated time between two updates of the scoreboard.
const UPDATE_INTERVAL: Duration = Duration::from_millis(100);
/// The same with a pace, so that watchers see continuous progress.
const PACED_UPDATE_INTERVAL: Duration = Duration::from_millis(10);

pub(crate) fn execute(
    arguments: &RunArguments,
    layers: &Layers,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let plan = MatchSource::load_with(&arguments.config, &monas::Registry::linked(), layers)
        .map_err(|diagnostics| CommandFailure::Invalid(format, diagnostics))?;
    report::write(console, format, plan.warnings())?;
    #[cfg(unix)]
    if let (Some(robot), Some(address)) = (&arguments.only, &arguments.body) {
        processes::end_with_parent();
        let talws = plan.robot(robot, address).map_err(|error| CommandFailure::failed(format, error))?;
        return real_time::run(talws, robot, arguments, layers, console);
    }
    if plan.has_links() && !arguments.realtime {
        let message = "robots of this match have links to other processes, which do not wait for simulated time: add \
                       --realtime";
        return Err(CommandFailure::Usage(message.into()));
    }
    let plan = arguments.league.join(plan).map_err(|error| CommandFailure::failed(format, error))?;
    let interrupt = Interrupt::for_console(console).map_err(|error| CommandFailure::failed(format, error))?;
    let socket = control::bind(arguments, console)?;
    #[cfg(unix)]
    let (plan, mut processes) = match arguments.realtime {
        true => {
            let (plan, processes) = RobotProcesses::prepare(plan, arguments, socket.as_ref())
                .map_err(|error| CommandFailure::failed(format, error))?;
            (plan, Some(processes))
        }
        false => (plan, None),
    };
    let to_tape = if arguments.realtime { Tape::to_file_real_time } else { Tape::to_file };
    let tape = outputs::open(arguments, to_tape, console)?;
    let clock = WallClock::start();
    let mut each_look = || {
        #[cfg(unix)]
        if let Some(processes) = &mut processes {
            processes.watch();
        }
    };
    let running = play(plan, arguments, socket, tape.clone(), &interrupt, &mut each_look, console);
    let running = running.or_else(|failure| {
        // A thread that does not return keeps the match, and with it the tape.
        outputs::finish(tape.clone(), format)?;
        Err(failure)
    })?;
    // A robot sits down while the field is still there.
    #[cfg(unix)]
    let robots = processes.map(RobotProcesses::end).unwrap_or_default();
    let wall = clock.elapsed();
    let results = running.finish().map_err(|error| CommandFailure::failed(format, error))?;
    summary::write(console.out, format, &results, wall)?;
    #[cfg(unix)]
    robots.iter().try_for_each(|robot| robot.write(console.out, format))?;
    outputs::finish(tape, format)?;
    if let Some(failure) = results.failure.or(results.unstopped) {
        return Err(CommandFailure::failed(format, failure));
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
    each_look: &mut dyn FnMut(),
    console: &mut CommandOutput<'_>,
) -> Result<RunningMatch, CommandFailure> {
    let failed = |error: monas_match::Error| CommandFailure::failed(arguments.format.value, error);
    let length = arguments.length.unwrap_or_else(|| plan.length());
    let options = MatchOptions { seed: arguments.seed.unwrap_or_default(), record: tape.clone() };
    let started = match arguments.realtime {
        true => plan.start_in_real_time(options),
        false => plan.start(options),
    };
    let mut running = started.map_err(|error| match error.diagnostics() {
        [] => failed(error),
        wrong => CommandFailure::Invalid(arguments.format.value, wrong.to_vec()),
    })?;
    // The socket closes with this function, since nothing advances the match afterwards.
    let handle = running.run_handle();
    let control = control::serve(socket, handle.clone(), tape.clone(), arguments)?;
    let pace = Pace::new(factor(arguments));
    // Real time has no other pace.
    let shown_pace = (!arguments.realtime).then(|| pace.clone());
    let _studio = control::view(control.as_ref(), shown_pace, arguments, console)?;
    let mut pacer = (!arguments.realtime).then(|| Pacer::new(WallClock::start(), pace.clone()));
    let mut alarm = RecordingAlarm::new(tape, handle.clone());
    if pace.factor().is_finite() {
        running.measure();
    }
    let mut scoreboard = scoreboard::for_console(console, length, arguments.field);
    scoreboard.show(&running)?;
    while running.now() < length && !running.is_over() && !interrupt.is_requested() {
        let look = if pace.factor().is_finite() { PACED_UPDATE_INTERVAL } else { UPDATE_INTERVAL };
        let next = (running.now() + look).min(length);
        running = running.advance_until_cancelled(next, || interrupt.is_requested()).map_err(failed)?;
        alarm.check(handle.now());
        each_look();
        scoreboard.show(&running)?;
        while pacer.as_mut().is_some_and(|pacer| !pacer.wait(running.now(), interrupt)) {
            // Requests are handled between two steps: while time is held, between no two.
            let now = running.now();
            running = running.advance_until_cancelled(now, || interrupt.is_requested()).map_err(failed)?;
        }
    }
    alarm.check(handle.now());
    Ok(running)
}
