//! Runs the agents of one host in real time, until an interrupt or the requested time has passed.

use std::io::Write;
use std::time::Duration;

use monas::config::Layers;
use monas::{AgentStatistics, Registry, Statistics, Talws};
use monas_tape::Tape;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, Interrupt, WallClock, report, table};
use serde_json::{Value, json};
use yase::Diagnostic;

use super::outputs::RecordingAlarm;
use super::{RunArguments, bodies, control, links, lockstep, outputs};
use crate::input::load_agents;

pub(crate) fn execute(
    arguments: &RunArguments,
    layers: &Layers,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let talws = talws(arguments, layers, console)?;
    if talws.has_own_time() {
        return lockstep::execute(talws, arguments, layers, console);
    }
    for (option, is_given) in [("--seed", arguments.seed.is_some()), ("--pace", arguments.pace.is_some())] {
        if is_given {
            let message = format!("{option} is for simulated time; these agents run in real time");
            return Err(CommandFailure::Usage(message));
        }
    }
    run(talws, Talws::LOCAL, arguments, layers, console)
}

/// Runs the agents of a host.
pub(super) fn run(
    mut talws: Talws,
    host: &str,
    arguments: &RunArguments,
    layers: &Layers,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let socket = control::bind(arguments, console)?;
    let tape = outputs::open(arguments, Tape::to_file_real_time, console)?;
    if let Some(tape) = &tape {
        let files = outputs::files(arguments);
        let settings = layers.settings().collect::<Vec<_>>().join("\n");
        monas_recording::label_real_time(tape, &files, &settings, &[host.to_owned()])
            .map_err(|error| CommandFailure::failed(format, error))?;
        if let Some(robot) = &arguments.layers.robot {
            monas_recording::label_robot(tape, robot)
                .map_err(|error| CommandFailure::failed(format, error))?;
        }
        talws.observe(Box::new(tape.clone()));
    }
    let interrupt = Interrupt::for_console(console).map_err(|error| CommandFailure::failed(format, error))?;
    let running = talws.start().map_err(|error| CommandFailure::not_started(format, error))?;
    let overview = running.run_handle();
    let control = control::serve(socket, overview.clone(), tape.clone(), arguments)?;
    let _studio = control::view(control.as_ref(), None, arguments, console)?;
    let mut alarm = RecordingAlarm::new(tape.clone(), overview.clone());
    writeln!(console.remarks(), "running, Ctrl-C stops")?;
    let length = arguments.length.unwrap_or(Duration::MAX);
    WallClock::start().wait_until_or(length, || {
        alarm.check(overview.now());
        interrupt.is_requested() || running.has_ended()
    });
    alarm.check(overview.now());
    drop((control, alarm));
    let Statistics { agents, bodies, links, .. } = running.stop();
    if let Some(tape) = &tape {
        monas_recording::ended(tape, overview.now())
            .map_err(|error| CommandFailure::failed(format, error))?;
    }
    write(console.out, format, &agents)?;
    bodies::write(console.out, format, &bodies)?;
    match format {
        Format::Text => links::write(console.out, &links)?,
        Format::Json => {
            links::objects(&links).iter().try_for_each(|object| writeln!(console.out, "{object}"))?;
        }
    }
    let dropped = tape.as_ref().map(Tape::dropped).unwrap_or_default();
    if let (Some(messages), Format::Text) = (outputs::finish(tape, format)?, format) {
        writeln!(
            console.out,
            "messages recorded: {messages}, dropped because the disk was too slow: {dropped}"
        )?;
    }
    Ok(match interrupt.exit() {
        Some(exit) => exit,
        None if agents.iter().any(|agent| agent.stopped.is_some()) => Exit::Failure,
        None => Exit::Success,
    })
}

/// The agents and links of the configuration, ready to run.
fn talws(
    arguments: &RunArguments,
    layers: &Layers,
    console: &mut CommandOutput<'_>,
) -> Result<Talws, CommandFailure> {
    let format = arguments.format.value;
    let (setup, diagnostics) = load_agents(&arguments.config, &Registry::linked(), layers);
    if diagnostics.iter().any(Diagnostic::is_error) {
        return Err(CommandFailure::Invalid(format, diagnostics));
    }
    report::write(console, format, &diagnostics)?;
    Ok(Talws::new().setup(setup))
}

pub(super) fn write(
    out: &mut dyn Write,
    format: Format,
    agents: &[AgentStatistics],
) -> Result<(), CommandFailure> {
    if format == Format::Json {
        agents.iter().try_for_each(|agent| writeln!(out, "{}", object(agent)))?;
        return Ok(());
    }
    let header =
        ["agent", "cycles", "overruns", "micro-steps", "activity calls", "mean cycle", "longest cycle"];
    writeln!(out, "{}", table::of_numbers(header, 1, agents.iter().map(row)))?;
    for agent in agents {
        if let Some(reason) = &agent.stopped {
            writeln!(out, "{} has stopped: {reason}", agent.agent)?;
        }
    }
    Ok(())
}

fn row(agent: &AgentStatistics) -> [String; 7] {
    let time = |time: Option<Duration>| {
        time.map_or_else(|| "-".into(), |time| format!("{:.3} ms", time.as_secs_f64() * 1e3))
    };
    [
        agent.agent.clone(),
        agent.cycles.to_string(),
        agent.overruns.to_string(),
        agent.micro_steps.to_string(),
        calls(agent).to_string(),
        time(agent.cycle_time.map(|average| average.mean())),
        time(agent.cycle_time.map(|average| average.longest())),
    ]
}

fn calls(agent: &AgentStatistics) -> u64 {
    agent.activities.iter().map(|activity| activity.calls).sum()
}

fn object(agent: &AgentStatistics) -> Value {
    json!({
        "kind": "agent",
        "host": agent.host,
        "agent": agent.agent,
        "cycles": agent.cycles,
        "overruns": agent.overruns,
        "micro_steps": agent.micro_steps,
        "activity_calls": calls(agent),
        "mean_cycle_seconds": agent.cycle_time.map(|average| average.mean().as_secs_f64()),
        "longest_cycle_seconds": agent.cycle_time.map(|average| average.longest().as_secs_f64()),
        "stopped": agent.stopped,
    })
}
