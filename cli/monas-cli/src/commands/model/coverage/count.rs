//! Coverage counters of one chart.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::fmt;

use aseme_verify::DiagnosticNames;
use monas::records;
use yase::{NodeId, NodeKind, Statechart, Transition, TransitionId};

pub(crate) const NEVER_ACTIVE: &str = "never active";
pub(crate) const NEVER_FIRED: &str = "never fired";
pub(crate) const ALWAYS_HELD: &str = "never false";

/// A chart, and how often each of its parts was covered by all agents that run it.
pub(crate) struct ChartCounts {
    pub(crate) chart: Statechart,
    /// The agents that run it: `blue-1 Goalie`.
    pub(crate) players: Vec<String>,
    /// The number of entries of each node.
    pub(crate) entered: Vec<u64>,
    /// The number of times that each transition fired.
    pub(crate) fired: Vec<u64>,
    /// The transitions of each source that are tried one after another, in that order.
    tried: Vec<Vec<TransitionId>>,
}

/// A share of a total.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Fraction {
    pub(crate) covered: usize,
    pub(crate) all: usize,
}

impl fmt::Display for Fraction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {}", self.covered, self.all)
    }
}

/// An element that was not covered.
pub(crate) struct UncoveredElement {
    pub(crate) kind: &'static str,
    pub(crate) name: String,
    /// The same with paths.
    pub(crate) path: String,
    /// The transition; has no meaning for a state.
    pub(crate) transition: TransitionId,
}

impl ChartCounts {
    fn new(chart: &Statechart) -> ChartCounts {
        let (nodes, transitions) = (chart.nodes().len(), chart.transitions().len());
        ChartCounts {
            chart: chart.clone(),
            players: Vec::new(),
            entered: vec![0; nodes],
            fired: vec![0; transitions],
            tried: tried(chart),
        }
    }

    /// The index of a chart among the known ones; equal charts share one entry.
    pub(crate) fn chart_index(chart: &Statechart, known: &mut Vec<ChartCounts>) -> usize {
        known.iter().position(|covered| covered.chart == *chart).unwrap_or_else(|| {
            known.push(ChartCounts::new(chart));
            known.len() - 1
        })
    }

    pub(crate) fn play(&mut self, host: &str, agent: &str) {
        let player = format!("{host} {agent}");
        if !self.players.contains(&player) {
            self.players.push(player);
        }
    }

    /// Counts a micro-step. Returns false if it is not one of this chart.
    pub(crate) fn count(&mut self, record: &records::Chart) -> bool {
        let mut is_known = true;
        for &node in &record.entries {
            match self.entered.get_mut(node as usize) {
                Some(entered) => *entered += 1,
                None => is_known = false,
            }
        }
        for &transition in record.selected.iter().chain(&record.taken) {
            match self.fired.get_mut(transition as usize) {
                Some(fired) => *fired += 1,
                None => is_known = false,
            }
        }
        is_known
    }

    fn basics(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.chart.nodes().filter(|(_, node)| node.kind == NodeKind::Basic).map(|(id, _)| id)
    }

    /// The transitions that are not marked as never firing.
    fn meant(&self) -> impl Iterator<Item = (TransitionId, &Transition)> + '_ {
        self.chart.transitions().filter(|(_, transition)| !transition.expression.is_never())
    }

    fn guarded(&self) -> impl Iterator<Item = TransitionId> + '_ {
        self.meant().filter(|(_, transition)| transition.expression.guard.is_some()).map(|(id, _)| id)
    }

    /// The guards with an alternative that is tried after them, and how often each was false: as
    /// often as one of these fired.
    fn refused(&self) -> BTreeMap<TransitionId, u64> {
        let mut refused = BTreeMap::new();
        for tried in &self.tried {
            let mut later = 0;
            for (index, &id) in tried.iter().rev().enumerate() {
                let expression = &self.chart.transition(id).expression;
                if index > 0 && expression.guard.is_some() && !expression.is_never() {
                    refused.insert(id, later);
                }
                later += self.fired[id.0 as usize];
            }
        }
        refused
    }

    pub(crate) fn states(&self) -> Fraction {
        share(self.basics().map(|id| self.entered[id.0 as usize]))
    }

    pub(crate) fn transitions(&self) -> Fraction {
        share(self.meant().map(|(id, _)| self.fired[id.0 as usize]))
    }

    pub(crate) fn guards_held(&self) -> Fraction {
        share(self.guarded().map(|id| self.fired[id.0 as usize]))
    }

    pub(crate) fn guards_refused(&self) -> Fraction {
        share(self.refused().into_values())
    }

    /// All elements that were not covered: states, transitions, guards.
    pub(crate) fn missed(&self) -> Vec<UncoveredElement> {
        let names = DiagnosticNames::new(&self.chart);
        let states = self.basics().filter(|id| self.entered[id.0 as usize] == 0).map(|id| UncoveredElement {
            kind: NEVER_ACTIVE,
            name: names.name(id),
            path: names.path(id),
            transition: TransitionId(u32::MAX),
        });
        let missed = |what, transition| {
            let expression = &self.chart.transition(transition).expression;
            let colon = if expression.is_empty() { String::new() } else { format!(" : {expression}") };
            let (name, path) = (names.transition(transition), names.transition_path(transition));
            UncoveredElement { kind: what, name: name + &colon, path: path + &colon, transition }
        };
        let unfired = self.meant().map(|(id, _)| id).filter(|id| self.fired[id.0 as usize] == 0);
        let refused = self.refused();
        let unrefused = refused.into_iter().filter(|(_, count)| *count == 0).map(|(id, _)| id);
        let transitions = unfired.map(|id| missed(NEVER_FIRED, id));
        states.chain(transitions).chain(unrefused.map(|id| missed(ALWAYS_HELD, id))).collect()
    }
}

fn share(counts: impl Iterator<Item = u64>) -> Fraction {
    counts.fold(Fraction { covered: 0, all: 0 }, |share, count| Fraction {
        covered: share.covered + usize::from(count > 0),
        all: share.all + 1,
    })
}

/// The transitions of each source that are tried one after another under the same conditions: no
/// trigger, no weights.
fn tried(chart: &Statechart) -> Vec<Vec<TransitionId>> {
    let mut tried = vec![Vec::new(); chart.nodes().len()];
    for (id, transition) in chart.transitions() {
        if transition.weight.is_none() && transition.expression.trigger.is_none() {
            tried[transition.source.0 as usize].push(id);
        }
    }
    for of_source in &mut tried {
        of_source.sort_by_key(|&id| {
            let transition = chart.transition(id);
            (Reverse(transition.priority), transition.expression.guard.is_none(), id)
        });
    }
    tried
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Statechart {
        let text = "Role: r\nLiveness:\nr = a . (b | c | d)\nTransitions:\nCONDITION -> b : [B.x]\nCONDITION -> c !1 : [B.y]\n";
        let (chart, found) = aseme_models::statechart_of(&yase::Source::new("r.srm", text));
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
        let index = ChartCounts::chart_index(&chart, &mut known);
        assert_eq!(ChartCounts::chart_index(&chart, &mut known), index, "equal charts are one");
        let covered = &mut known[index];
        assert!(covered.count(&fired(&chart, "c")));
        assert_eq!(covered.guards_held(), Fraction { covered: 1, all: 2 });
        assert_eq!(
            covered.guards_refused(),
            Fraction { covered: 0, all: 2 },
            "nothing is tried before the first"
        );
        assert!(covered.count(&fired(&chart, "b")));
        assert_eq!(
            covered.guards_refused(),
            Fraction { covered: 1, all: 2 },
            "the guard of higher priority has failed"
        );
        assert_eq!(covered.states(), Fraction { covered: 2, all: 4 });
        let missed: Vec<String> =
            covered.missed().iter().map(|missed| format!("{}: {}", missed.kind, missed.name)).collect();
        let expected = [
            "never active: a",
            "never active: d",
            "never fired: r/START -> a",
            "never fired: a -> (b|c|d)",
            "never fired: (b|c|d) -> r/END",
            "never fired: (b|c|d)/START -> CONDITION",
            "never fired: CONDITION -> d",
            "never fired: d -> (b|c|d)/END",
            "never fired: c -> (b|c|d)/END",
            "never fired: b -> (b|c|d)/END",
            "never false: CONDITION -> b : [B.x]",
        ];
        assert_eq!(missed, expected);
        assert!(covered.count(&fired(&chart, "d")));
        assert_eq!(covered.guards_refused(), Fraction { covered: 2, all: 2 });
    }

    #[test]
    fn a_step_of_another_chart_is_reported() {
        let mut known = Vec::new();
        let index = ChartCounts::chart_index(&chart(), &mut known);
        assert!(!known[index].count(&records::Chart { entries: vec![99], ..records::Chart::default() }));
        assert!(!known[index].count(&records::Chart { selected: vec![99], ..records::Chart::default() }));
    }
}
