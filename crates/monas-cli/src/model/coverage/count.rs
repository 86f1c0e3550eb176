//! What is counted of one chart.

use std::cmp::Reverse;
use std::fmt;

use aseme::path::{shortest_path, shortest_transition};
use monas::records;
use yase::{NodeId, NodeKind, Statechart, Transition, TransitionId};

pub(super) const NEVER_ACTIVE: &str = "never active";
pub(super) const NEVER_FIRED: &str = "never fired";
pub(super) const ALWAYS_HELD: &str = "never seen not to hold";

/// A chart, and how often each part of it was met by all who play it.
pub(super) struct Covered {
    pub(super) chart: Statechart,
    /// Who plays it: `blue-1 Goalie`.
    pub(super) players: Vec<String>,
    /// How often each node was entered.
    pub(super) entered: Vec<u64>,
    /// How often each transition fired.
    pub(super) fired: Vec<u64>,
    /// How often each guard was seen not to hold.
    refused: Vec<u64>,
    /// The guards that are tried before each transition, and fail if it fires.
    earlier: Vec<Vec<TransitionId>>,
}

/// So many of so many.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Share {
    pub(super) met: usize,
    pub(super) all: usize,
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {}", self.met, self.all)
    }
}

/// Something that was not met.
pub(super) struct Missed {
    pub(super) what: &'static str,
    pub(super) name: String,
    /// Which transition; of a state it says nothing.
    pub(super) transition: TransitionId,
}

impl Covered {
    fn new(chart: &Statechart) -> Covered {
        let (nodes, transitions) = (chart.nodes().len(), chart.transitions().len());
        Covered {
            chart: chart.clone(),
            players: Vec::new(),
            entered: vec![0; nodes],
            fired: vec![0; transitions],
            refused: vec![0; transitions],
            earlier: earlier(chart),
        }
    }

    /// The place of a chart among those that are known; equal ones are one, whoever plays them.
    pub(super) fn place_of(chart: &Statechart, known: &mut Vec<Covered>) -> usize {
        known.iter().position(|covered| covered.chart == *chart).unwrap_or_else(|| {
            known.push(Covered::new(chart));
            known.len() - 1
        })
    }

    pub(super) fn play(&mut self, host: &str, agent: &str) {
        let player = format!("{host} {agent}");
        if !self.players.contains(&player) {
            self.players.push(player);
        }
    }

    /// Counts a micro-step. Says whether all in it is of this chart.
    pub(super) fn count(&mut self, record: &records::Chart) -> bool {
        let mut is_known = true;
        for &node in &record.entries {
            match self.entered.get_mut(node as usize) {
                Some(entered) => *entered += 1,
                None => is_known = false,
            }
        }
        for &transition in record.selected.iter().chain(&record.taken) {
            match self.fired.get_mut(transition as usize) {
                Some(fired) => {
                    *fired += 1;
                    let earlier = &self.earlier[transition as usize];
                    earlier.iter().for_each(|guard| self.refused[guard.0 as usize] += 1);
                }
                None => is_known = false,
            }
        }
        is_known
    }

    fn basics(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.chart.nodes().filter(|(_, node)| node.kind == NodeKind::Basic).map(|(id, _)| id)
    }

    /// The transitions that are not meant never to fire.
    fn meant(&self) -> impl Iterator<Item = (TransitionId, &Transition)> + '_ {
        self.chart.transitions().filter(|(_, transition)| !transition.expression.is_never())
    }

    fn guarded(&self) -> impl Iterator<Item = TransitionId> + '_ {
        self.meant().filter(|(_, transition)| transition.expression.guard.is_some()).map(|(id, _)| id)
    }

    /// The guards that something is tried after.
    fn refusable(&self) -> impl Iterator<Item = TransitionId> + '_ {
        self.guarded().filter(|guard| self.earlier.iter().any(|earlier| earlier.contains(guard)))
    }

    pub(super) fn states(&self) -> Share {
        share(self.basics().map(|id| self.entered[id.0 as usize]))
    }

    pub(super) fn transitions(&self) -> Share {
        share(self.meant().map(|(id, _)| self.fired[id.0 as usize]))
    }

    pub(super) fn guards_held(&self) -> Share {
        share(self.guarded().map(|id| self.fired[id.0 as usize]))
    }

    pub(super) fn guards_refused(&self) -> Share {
        share(self.refusable().map(|id| self.refused[id.0 as usize]))
    }

    /// All that was not met: states, transitions, guards.
    pub(super) fn missed(&self) -> Vec<Missed> {
        let states = self.basics().filter(|id| self.entered[id.0 as usize] == 0).map(|id| Missed {
            what: NEVER_ACTIVE,
            name: shortest_path(&self.chart, id),
            transition: TransitionId(u32::MAX),
        });
        let missed = |what, transition| {
            let expression = &self.chart.transition(transition).expression;
            let colon = if expression.is_empty() { String::new() } else { format!(" : {expression}") };
            Missed { what, name: shortest_transition(&self.chart, transition) + &colon, transition }
        };
        let unfired = self.meant().map(|(id, _)| id).filter(|id| self.fired[id.0 as usize] == 0);
        let unrefused = self.refusable().filter(|id| self.refused[id.0 as usize] == 0);
        let transitions = unfired.map(|id| missed(NEVER_FIRED, id));
        states.chain(transitions).chain(unrefused.map(|id| missed(ALWAYS_HELD, id))).collect()
    }
}

fn share(counts: impl Iterator<Item = u64>) -> Share {
    counts.fold(Share { met: 0, all: 0 }, |share, count| Share {
        met: share.met + usize::from(count > 0),
        all: share.all + 1,
    })
}

/// For each transition the guards that are tried before it, and for the same reason: of its source, with its trigger, without weights.
fn earlier(chart: &Statechart) -> Vec<Vec<TransitionId>> {
    let rank = |id: TransitionId| {
        let transition = chart.transition(id);
        (Reverse(transition.priority), transition.expression.guard.is_none(), id)
    };
    let before = |(id, later): (TransitionId, &Transition)| {
        let is_tried = |(other, transition): &(TransitionId, &Transition)| {
            transition.source == later.source
                && transition.expression.guard.is_some()
                && transition.weight.is_none()
                && later.weight.is_none()
                && transition.expression.trigger.is_none()
                && later.expression.trigger.is_none()
                && rank(*other) < rank(id)
        };
        chart.transitions().filter(is_tried).map(|(other, _)| other).collect()
    };
    chart.transitions().map(before).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Statechart {
        let text = "Role: r\nLiveness:\nr = a . (b | c | d)\nTransitions:\nCONDITION -> b : [B.x]\nCONDITION -> c !1 : [B.y]\n";
        let (chart, found) = aseme::statechart_of(&yase::Source::new("r.srm", text));
        assert_eq!(found, []);
        chart
    }

    fn fired(chart: &Statechart, target: &str) -> records::Chart {
        let node = chart.find(target).unwrap();
        let transition = chart.transitions().find(|(_, transition)| transition.target == node).unwrap().0;
        records::Chart { taken: vec![transition.0], entries: vec![node.0], ..records::Chart::default() }
    }

    #[test]
    fn a_guard_is_refused_by_whatever_is_tried_after_it() {
        let chart = chart();
        let mut known = Vec::new();
        let place = Covered::place_of(&chart, &mut known);
        assert_eq!(Covered::place_of(&chart, &mut known), place, "equal charts are one");
        let covered = &mut known[place];
        assert!(covered.count(&fired(&chart, "c")));
        assert_eq!(covered.guards_held(), Share { met: 1, all: 2 });
        assert_eq!(covered.guards_refused(), Share { met: 0, all: 2 }, "nothing is tried before the first");
        assert!(covered.count(&fired(&chart, "b")));
        assert_eq!(
            covered.guards_refused(),
            Share { met: 1, all: 2 },
            "the guard of higher priority has failed"
        );
        assert_eq!(covered.states(), Share { met: 2, all: 4 });
        let missed: Vec<String> =
            covered.missed().iter().map(|missed| format!("{}: {}", missed.what, missed.name)).collect();
        let expected = [
            "never active: a",
            "never active: d",
            "never fired: START -> a",
            "never fired: a -> (b|c|d)",
            "never fired: (b|c|d) -> END",
            "never fired: START -> CONDITION",
            "never fired: CONDITION -> d",
            "never fired: d -> END",
            "never fired: c -> END",
            "never fired: b -> END",
            "never seen not to hold: CONDITION -> b : [B.x]",
        ];
        assert_eq!(missed, expected);
        assert!(covered.count(&fired(&chart, "d")));
        assert_eq!(covered.guards_refused(), Share { met: 2, all: 2 });
    }

    #[test]
    fn a_step_of_another_chart_is_told() {
        let mut known = Vec::new();
        let place = Covered::place_of(&chart(), &mut known);
        assert!(!known[place].count(&records::Chart { entries: vec![99], ..records::Chart::default() }));
        assert!(!known[place].count(&records::Chart { selected: vec![99], ..records::Chart::default() }));
    }
}
