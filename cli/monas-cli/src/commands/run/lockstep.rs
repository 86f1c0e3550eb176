//! Runs the agents of one host in the time of their body: simulated time, each cycle of which waits
//! for a simulation elsewhere.

use std::io::Write;
use std::time::Duration;

use monas::config::Layers;
use monas::{RunHash, Simulation, Statistics, Talws};
use monas_robot::Announcement;
use monas_robot::topics::ANNOUNCEMENT;
use monas_studio::Pace;
use monas_tape::Tape;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, Interrupt, WallClock};
use narukom::Timestamp;
use serde_json::json;

use super::outputs::RecordingAlarm;
use super::pacer::{Pacer, factor};
use super::{RunArguments, control, outputs, real_time};

/// Simulated time between two checks of the interrupt and the pace.
const CHECK_INTERVAL: Duration = Duration::from_millis(20);
/// Maximum time for an activity to return after an interrupt.
const STOP_LIMIT: Duration = Duration::from_secs(3);

pub(super) fn execute(
    mut talws: Talws,
    arguments: &RunArguments,
    layers: &Layers,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let failed = |error: monas::Error| CommandFailure::failed(format, error);
    let socket = control::bind(arguments, console)?;
    let tape = outputs::open(arguments, Tape::to_file, console)?;
    let (seed, hash) = (arguments.seed.unwrap_or_default(), RunHash::new());
    talws.observe(Box::new(hash.clone()));
    if let Some(tape) = &tape {
        let files = outputs::files(arguments);
        let settings = layers.settings().collect::<Vec<_>>().join("\n");
        monas_recording::label_simulated(tape, &files, &settings, seed, &[Talws::LOCAL.to_owned()])
            .map_err(|error| CommandFailure::failed(format, error))?;
        if let Some(robot) = &arguments.layers.robot {
            monas_recording::label_robot(tape, robot)
                .map_err(|error| CommandFailure::failed(format, error))?;
        }
        talws.observe(Box::new(tape.clone()));
    }
    let interrupt = Interrupt::for_console(console).map_err(|error| CommandFailure::failed(format, error))?;
    let mut simulation = talws.simulate(seed).map_err(|error| CommandFailure::not_started(format, error))?;
    let handle = simulation.run_handle();
    let control = control::serve(socket, handle.clone(), tape.clone(), arguments)?;
    let (clock, pace) = (WallClock::start(), Pace::new(factor(arguments)));
    let _studio = control::view(control.as_ref(), Some(pace.clone()), arguments, console)?;
    let (mut pacer, mut alarm) = (Pacer::new(clock, pace), RecordingAlarm::new(tape.clone(), handle));
    writeln!(console.remarks(), "running in the time of the body, Ctrl-C stops")?;
    let length = arguments.length.unwrap_or(Duration::MAX);
    let now = |simulation: &Simulation| simulation.now().since(Timestamp::ZERO);
    let mut is_due = true;
    while now(&simulation) < length && !interrupt.is_requested() {
        // While simulated time is held, the run still handles requests.
        let step = if is_due { CHECK_INTERVAL } else { Duration::ZERO };
        let next = Timestamp::ZERO + now(&simulation).saturating_add(step).min(length);
        let advanced = simulation.run_until_cancelled(next, || interrupt.is_requested(), STOP_LIMIT);
        simulation = match advanced {
            Ok(simulation) => simulation,
            Err(error) => {
                outputs::finish(tape, format)?;
                return Err(failed(error));
            }
        };
        alarm.check(simulation.now());
        is_due = pacer.wait(now(&simulation), &interrupt);
    }
    drop((control, alarm));
    if let Some(tape) = &tape {
        monas_recording::ended(tape, simulation.now())
            .map_err(|error| CommandFailure::failed(format, error))?;
    }
    simulation = match simulation.stop_within(STOP_LIMIT) {
        Ok(simulation) => simulation,
        Err(error) => {
            outputs::finish(tape, format)?;
            return Err(failed(error));
        }
    };
    let (simulated, wall) = (now(&simulation), clock.elapsed());
    let score = announced(&simulation).map(|said| (said.own_score, said.opponent_score));
    let Statistics { agents, .. } = simulation.statistics();
    real_time::write(console.out, format, &agents)?;
    let (simulated, wall) = (simulated.as_secs_f64(), wall.as_secs_f64());
    let (hash, _) = hash.finish();
    match format {
        Format::Text => {
            if let Some((own, opponents)) = score {
                writeln!(console.out, "score: {own} : {opponents}")?;
            }
            writeln!(console.out, "{simulated:.2} s of simulated time in {wall:.1} s, hash {hash}")?;
        }
        Format::Json => {
            let run = json!({
                "kind": "run",
                "own_score": score.map(|(own, _)| own),
                "opponent_score": score.map(|(_, opponents)| opponents),
                "simulated_seconds": simulated,
                "hash": hash,
            });
            writeln!(console.out, "{run}")?;
        }
    }
    outputs::finish(tape, format)?;
    Ok(match interrupt.exit() {
        Some(exit) => exit,
        None if agents.iter().any(|agent| agent.stopped.is_some()) => Exit::Failure,
        None => Exit::Success,
    })
}

/// The last announcement of the body's referee.
fn announced(simulation: &Simulation) -> Option<Announcement> {
    let mut blackboard = simulation.hub(Talws::LOCAL)?.blackboard("score");
    blackboard.process_messages(simulation.now());
    blackboard.read(ANNOUNCEMENT).copied()
}
