//! `monas model coverage`: what of the charts the runs on tapes have been through.
//!
//! Tapes hold the configuration and the models of their run, and a record of each micro-step. A state is covered when it was entered, a transition
//! when it fired. A guard is seen to hold when its transition fired. It is seen not to hold when another way out of the same state or connector fired that
//! is tried after it; a guard that has no such alternative is only asked to hold.

mod count;

use std::fs;
use std::path::{Path, PathBuf};

use aseme::check::Recorded;
use monas::records::{CHART, Chart};
use monas_tape::Recording;
use narukom::prost::Message as _;
use serde_json::{Value, json};
use yase::export::{Mark, Marks, to_svg_marked};
use yase::{Element, NodeId, NodeKind, TransitionId};

use crate::arguments::{CoverageArguments, Format};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::tape::{failed, recorded_hosts};

use count::{Covered, Missed};

pub(crate) fn execute(arguments: &CoverageArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let mut charts: Vec<Covered> = Vec::new();
    for tape in &arguments.tapes {
        gather(tape, format, &mut charts)?;
    }
    if charts.is_empty() {
        return Err(Failure::Failed(format, "no statechart has run on these tapes".into()));
    }
    for covered in &charts {
        match format {
            Format::Text => write_text(covered, console)?,
            Format::Json => writeln!(console.out, "{}", object(covered))?,
        }
    }
    if let Some(folder) = &arguments.draw {
        draw(&charts, folder, format)?;
    }
    Ok(Exit::Success)
}

/// What the charts on tapes have been through.
pub(super) fn recorded(tapes: &[PathBuf]) -> Result<Vec<Recorded>, Failure> {
    let mut charts: Vec<Covered> = Vec::new();
    for tape in tapes {
        gather(tape, Format::Text, &mut charts)?;
    }
    let recorded = charts.into_iter().map(|it| {
        let met =
            |counts: Vec<u64>| (0..).zip(counts).filter(|(_, count)| *count > 0).map(|(number, _)| number);
        Recorded {
            chart: it.chart,
            entered: met(it.entered).map(NodeId).collect(),
            fired: met(it.fired).map(TransitionId).collect(),
        }
    });
    Ok(recorded.collect())
}

/// Adds what is on a tape.
fn gather(tape: &Path, format: Format, charts: &mut Vec<Covered>) -> Result<(), Failure> {
    let recording = Recording::open(tape).map_err(failed(format))?;
    let hosts = recorded_hosts(&recording, format)?;
    // by host, agent and the number of the chart in it
    let mut places: Vec<(&str, &str, u32, usize)> = Vec::new();
    for host in &hosts {
        for agent in &host.agents {
            for (number, chart) in (0..).zip(agent.charts()) {
                let place = Covered::place_of(chart, charts);
                charts[place].play(&host.name, agent.name());
                places.push((&host.name, agent.name(), number, place));
            }
        }
    }
    for message in recording.messages().map_err(failed(format))? {
        let message = message.map_err(failed(format))?;
        let channel = &message.channel;
        if channel.topic != CHART.path() || channel.received_by.is_some() {
            continue;
        }
        let record = Chart::decode(message.bytes).map_err(|error| Failure::failed(format, error))?;
        let is_it = |(host, agent, number, _): &&(&str, &str, u32, usize)| {
            *host == channel.host && *agent == channel.publisher && *number == record.chart
        };
        let known = places.iter().find(is_it).map(|(.., place)| &mut charts[*place]);
        if !known.is_some_and(|covered| covered.count(&record)) {
            let (host, agent) = (&channel.host, &channel.publisher);
            let message =
                format!("{}: `{agent}` on {host} runs another chart than the tape's models", tape.display());
            return Err(Failure::Failed(format, message));
        }
    }
    Ok(())
}

fn write_text(covered: &Covered, console: &mut Console<'_>) -> Result<(), Failure> {
    let (states, transitions) = (covered.states(), covered.transitions());
    let (held, refused) = (covered.guards_held(), covered.guards_refused());
    writeln!(
        console.out,
        "{} ({}): {states} states were active, {transitions} transitions fired, {held} guards were seen to hold, \
         {refused} with an alternative not to hold",
        covered.chart.name,
        covered.players.join(", ")
    )?;
    for Missed { what, name, .. } in covered.missed() {
        writeln!(console.out, "  {what}: {name}")?;
    }
    Ok(())
}

/// A chart's coverage for programs.
fn object(covered: &Covered) -> Value {
    let names = |kind: &str| -> Vec<String> {
        covered.missed().into_iter().filter(|missed| missed.what == kind).map(|missed| missed.name).collect()
    };
    json!({
        "kind": "coverage",
        "model": covered.chart.name,
        "players": covered.players,
        "states": covered.states().all,
        "states_missed": names(count::NEVER_ACTIVE),
        "transitions": covered.transitions().all,
        "transitions_missed": names(count::NEVER_FIRED),
        "guards": covered.guards_held().all,
        "guards_held": covered.guards_held().met,
        "guards_with_alternative": covered.guards_refused().all,
        "guards_never_refused": names(count::ALWAYS_HELD),
    })
}

/// A drawing of each chart: green is what was covered, red what was not, orange a guard that has always held.
fn draw(charts: &[Covered], folder: &Path, format: Format) -> Result<(), Failure> {
    let failed = |verb: &str, path: &Path, error: std::io::Error| {
        Failure::Failed(format, format!("cannot {verb} {}: {error}", path.display()))
    };
    fs::create_dir_all(folder).map_err(|error| failed("make", folder, error))?;
    for (place, covered) in charts.iter().enumerate() {
        let namesakes = charts[..place].iter().filter(|other| other.chart.name == covered.chart.name).count();
        let number = if namesakes == 0 { String::new() } else { format!("-{}", namesakes + 1) };
        let path = folder.join(format!("{}{number}.svg", covered.chart.name.replace(['/', '\\'], "_")));
        fs::write(&path, to_svg_marked(&covered.chart, &marks(covered)))
            .map_err(|error| failed("write", &path, error))?;
    }
    Ok(())
}

fn marks(covered: &Covered) -> Marks {
    let mut marks = Marks::default();
    let mut set = |element, mark| marks.set(&covered.chart, element, mark);
    for (id, _) in covered.chart.nodes().filter(|(_, node)| node.kind == NodeKind::Basic) {
        let is_met = covered.entered[id.0 as usize] > 0;
        set(Element::Node(id), if is_met { Mark::Added } else { Mark::Missed });
    }
    for (id, transition) in covered.chart.transitions() {
        if !transition.expression.is_never() {
            let is_met = covered.fired[id.0 as usize] > 0;
            set(Element::Transition(id), if is_met { Mark::Added } else { Mark::Missed });
        }
    }
    for missed in covered.missed().iter().filter(|missed| missed.what == count::ALWAYS_HELD) {
        if covered.fired[missed.transition.0 as usize] > 0 {
            set(Element::Transition(missed.transition), Mark::Changed);
        }
    }
    marks
}
