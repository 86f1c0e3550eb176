//! Costs of single features of YASE.

use yase::Statechart;
use yase::statechart::{Node, NodeKind};

use crate::counts::{DEEP, FLAT};
use crate::flattened;
use crate::harness::{Contestant, Race, Racer};
use crate::ours::{self, Ours, connect};
use crate::table;

pub(crate) fn run(race: &Race) {
    guards(race);
    traces(race);
    depth(race);
}

/// A guard reads an array behind [`Host::field`](yase::Host::field), so that the measured time is
/// that of the machine.
fn guards(race: &Race) {
    let one = guarded(&["[M.n == 0]"]);
    let nine: Vec<String> = (100..109).map(|limit| format!("[M.n > {limit}]")).collect();
    let nine: Vec<&str> = nine.iter().map(String::as_str).chain(["[M.n == 0]"]).collect();
    let nine = guarded(&nine);
    let mut contestants: Vec<Box<dyn Contestant>> = vec![
        racer("no guard", &ours::flat()),
        racer("a field compared with a constant", &one),
        racer("two of them with `and`", &guarded(&["[M.n == 0 && M.m < 5]"])),
        racer("In(state)", &guarded(&["[!In(s9)]"])),
        racer("nine false ones, then a true one", &nine),
        Box::new(Racer::new("flattened, no guard", FLAT, flattened::Flat::new(&ours::flat()))),
        Box::new(Racer::new("flattened, a field", FLAT, flattened::Guarded::new(&one))),
        Box::new(Racer::new("flattened, nine and one", FLAT, flattened::Nine::new(&nine))),
    ];
    race.run("guards on flat, ns an event", &mut contestants);
}

/// The two states of `flat`, with transitions in both directions for each of these guards.
fn guarded(guards: &[&str]) -> Statechart {
    let mut chart = Statechart::new("guarded");
    let start = chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
    let first = ours::state(&mut chart, Statechart::ROOT, NodeKind::Basic, 0);
    let second = ours::state(&mut chart, Statechart::ROOT, NodeKind::Basic, FLAT);
    ours::state(&mut chart, Statechart::ROOT, NodeKind::Basic, 9);
    connect(&mut chart, start, first, "");
    for guard in guards {
        connect(&mut chart, first, second, &format!("toggle {guard}"));
        connect(&mut chart, second, first, &format!("toggle {guard}"));
    }
    chart
}

fn traces(race: &Race) {
    let mut traced = Ours::new(&ours::flat());
    traced.host.traces = true;
    let mut contestants: Vec<Box<dyn Contestant>> =
        vec![racer("off", &ours::flat()), Box::new(Racer::new("on", FLAT, traced))];
    race.run("trace on flat, ns an event", &mut contestants);
}

fn depth(race: &Race) {
    let deep = ours::branches("deep", DEEP);
    let mut contestants: Vec<Box<dyn Contestant>> = vec![
        Box::new(Racer::new("table interpreter", DEEP, table::Machine::new(&deep))),
        Box::new(Racer::new("yase", DEEP, Ours::new(&deep))),
    ];
    race.run("outermost of eight levels, ns an event", &mut contestants);
}

fn racer(name: &str, chart: &Statechart) -> Box<dyn Contestant> {
    Box::new(Racer::new(name, FLAT, Ours::new(chart)))
}
