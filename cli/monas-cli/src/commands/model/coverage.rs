//! `monas model coverage`: which parts of their charts recorded runs covered.
//!
//! Tapes contain the configuration and the models of their run, and a record of each micro-step. A
//! state is covered when it was entered, a transition when it fired. A guard was true when its
//! transition fired, and false when another transition of the same source fired that is tried after
//! it. A guard without such an alternative only has to be true once.

mod count;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use aseme_verify::RecordedCoverage;
use clap::{Args, ValueHint};
use monas::records::{CHART, Chart};
use monas_tape::Recording;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument, failed, report};
use narukom::prost::Message as _;
use serde_json::{Value, json};
use yase::{Element, NodeId, NodeKind, TransitionId};
use yase_export::{Highlights, Mark, to_svg_marked};

use crate::input::recorded_hosts;
use count::{ChartCounts, UncoveredElement};

/// Arguments of `monas model coverage`.
#[derive(Args, Debug)]
pub(crate) struct CoverageArguments {
    /// The recordings; the coverage of equal charts is added up.
    #[arg(required = true, value_name = "TAPE", value_hint = ValueHint::FilePath)]
    pub(crate) tapes: Vec<PathBuf>,
    /// Draw each chart into this folder: green for covered, red for not covered, orange for guards
    /// that were always true.
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub(crate) draw: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &CoverageArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let mut charts: Vec<ChartCounts> = Vec::new();
    let mut unknown = BTreeSet::new();
    for tape in &arguments.tapes {
        unknown.extend(gather(tape, format, &mut charts)?);
    }
    for agent in unknown {
        let message =
            format!("{agent} was added during the run and is not counted: its model is not on the tape");
        report::note(console, format, &message)?;
    }
    if charts.is_empty() {
        return Err(CommandFailure::Failed(format, "no statechart has run on these tapes".into()));
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

/// The recorded coverage of all charts on these tapes.
pub(crate) fn recorded(tapes: &[PathBuf]) -> Result<Vec<RecordedCoverage>, CommandFailure> {
    let mut charts: Vec<ChartCounts> = Vec::new();
    for tape in tapes {
        gather(tape, Format::Text, &mut charts)?;
    }
    let recorded = charts.into_iter().map(|it| {
        let met =
            |counts: Vec<u64>| (0..).zip(counts).filter(|(_, count)| *count > 0).map(|(number, _)| number);
        RecordedCoverage {
            chart: it.chart,
            entered: met(it.entered).map(NodeId).collect(),
            fired: met(it.fired).map(TransitionId).collect(),
        }
    });
    Ok(recorded.collect())
}

/// Adds the coverage of a tape. Returns the agents whose models are not on it.
fn gather(
    tape: &Path,
    format: Format,
    charts: &mut Vec<ChartCounts>,
) -> Result<BTreeSet<String>, CommandFailure> {
    let mut unknown = BTreeSet::new();
    let recording = Recording::open(tape).map_err(failed(format))?;
    let hosts = recorded_hosts(tape, &recording, format)?;
    // By host, agent and the number of the chart in the agent.
    let mut indices: Vec<(&str, &str, u32, usize)> = Vec::new();
    for host in &hosts {
        for agent in &host.agents {
            for (number, chart) in (0..).zip(agent.charts()) {
                let index = ChartCounts::chart_index(chart, charts);
                charts[index].play(&host.name, agent.name());
                indices.push((&host.name, agent.name(), number, index));
            }
        }
    }
    for message in recording.messages().map_err(failed(format))? {
        let message = message.map_err(failed(format))?;
        let channel = &message.channel;
        if channel.topic != CHART.path() || channel.received_by.is_some() {
            continue;
        }
        let record = Chart::decode(message.bytes).map_err(|error| CommandFailure::failed(format, error))?;
        let is_it = |(host, agent, number, _): &&(&str, &str, u32, usize)| {
            *host == channel.host && *agent == channel.publisher && *number == record.chart
        };
        let Some((.., position)) = indices.iter().find(is_it) else {
            unknown.insert(format!("`{}` on {}", channel.publisher, channel.host));
            continue;
        };
        if !charts[*position].count(&record) {
            let (host, agent) = (&channel.host, &channel.publisher);
            let message =
                format!("{}: `{agent}` on {host} runs another chart than the tape's models", tape.display());
            return Err(CommandFailure::Failed(format, message));
        }
    }
    Ok(unknown)
}

fn write_text(covered: &ChartCounts, console: &mut CommandOutput<'_>) -> Result<(), CommandFailure> {
    let (states, transitions) = (covered.states(), covered.transitions());
    let (held, refused) = (covered.guards_held(), covered.guards_refused());
    writeln!(
        console.out,
        "{} ({}): {states} states were active, {transitions} transitions fired, {held} guards were true, \
         {refused} with an alternative were false",
        covered.chart.name,
        covered.players.join(", ")
    )?;
    for UncoveredElement { kind: what, name, .. } in covered.missed() {
        writeln!(console.out, "  {what}: {name}")?;
    }
    Ok(())
}

/// A chart's coverage as JSON.
fn object(covered: &ChartCounts) -> Value {
    let names = |kind: &str| -> Vec<String> {
        covered.missed().into_iter().filter(|missed| missed.kind == kind).map(|missed| missed.path).collect()
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
        "guards_held": covered.guards_held().covered,
        "guards_with_alternative": covered.guards_refused().all,
        "guards_never_refused": names(count::ALWAYS_HELD),
    })
}

/// Draws each chart: green for covered, red for not covered, orange for guards that were always
/// true.
fn draw(charts: &[ChartCounts], folder: &Path, format: Format) -> Result<(), CommandFailure> {
    let failed = |verb: &str, path: &Path, error: std::io::Error| {
        CommandFailure::Failed(format, format!("cannot {verb} {}: {error}", path.display()))
    };
    fs::create_dir_all(folder).map_err(|error| failed("make", folder, error))?;
    for (index, covered) in charts.iter().enumerate() {
        let namesakes = charts[..index].iter().filter(|other| other.chart.name == covered.chart.name).count();
        let number = if namesakes == 0 { String::new() } else { format!("-{}", namesakes + 1) };
        let path = folder.join(format!("{}{number}.svg", covered.chart.name.replace(['/', '\\'], "_")));
        monas_files::write(&path, to_svg_marked(&covered.chart, &marks(covered)))
            .map_err(|error| failed("write", &path, error))?;
    }
    Ok(())
}

fn marks(covered: &ChartCounts) -> Highlights {
    let mut marks = Highlights::default();
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
    for missed in covered.missed().iter().filter(|missed| missed.kind == count::ALWAYS_HELD) {
        if covered.fired[missed.transition.0 as usize] > 0 {
            set(Element::Transition(missed.transition), Mark::Changed);
        }
    }
    marks
}
