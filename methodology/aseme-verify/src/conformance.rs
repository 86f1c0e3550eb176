//! M24: trace inclusion between a chart and its formulas.
//!
//! Both are sets of traces, the orders in which activities return. Every trace of the chart must be
//! one of the formulas, and vice versa. A chart that is left early by a guard or an event cuts
//! traces short, as intended. Infinite traces are compared by the activities that can still follow
//! ([`infinite_traces`]).

pub(crate) mod derivatives;
mod formula_points;
pub(crate) mod graph;
mod infinite_traces;

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use yase::{NodeId, Statechart};
use yase_explore::{Edge, Exploration, Trace};

use crate::conformance::derivatives::{Language, Residual, Symbol};
use aseme::liveness::Liveness;
use formula_points::FormulaPoints;
use graph::{Graph, Observable};
use infinite_traces::{InfiniteTraceResult, endlessly};

/// Limit of explored pairs of states and residuals.
const MAX_PAIRS: usize = 400_000;

/// A difference between a chart and its formulas.
#[derive(Clone, Debug)]
pub(crate) struct ConformanceDifference {
    /// The activities that have returned before, in order.
    pub(crate) before: Vec<String>,
    /// The kind of the difference.
    pub(crate) kind: DifferenceKind,
    /// A trace that leads there, for what the chart does.
    pub(crate) trace: Option<Trace>,
}

/// Kinds of differences.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum DifferenceKind {
    /// The chart does an activity that the formulas do not allow.
    NotAllowed(NodeId),
    /// The chart ends where the formulas continue.
    EndsEarly,
    /// The formulas allow an activity that the chart cannot do.
    NeverDone(String),
    /// The formulas may end, but the chart cannot.
    NeverEnds,
    /// The chart can no longer repeat what the formulas repeat forever: these `x~`, or an activity
    /// that occurs once.
    Starves(Vec<String>),
}

impl DifferenceKind {
    /// Whether the chart does something the formulas do not allow, as opposed to the reverse.
    pub(crate) fn is_of_what_is_done(&self) -> bool {
        matches!(self, DifferenceKind::NotAllowed(_) | DifferenceKind::EndsEarly)
    }
}

/// The first difference in each direction, chart against formulas first, and whether the comparison
/// is complete.
pub(crate) fn differences(
    chart: &Statechart,
    found: &Exploration,
    liveness: &Liveness,
    is_stopped: &dyn Fn() -> bool,
) -> (Vec<ConformanceDifference>, bool) {
    compared(chart, found, Language::new(liveness), false, is_stopped)
}

/// The first activity of the chart that the formulas do not allow, even if the named composites may
/// be left before they are done.
pub(crate) fn difference_beyond(
    chart: &Statechart,
    found: &Exploration,
    liveness: &Liveness,
    cut: BTreeSet<String>,
) -> Option<ConformanceDifference> {
    let (language, all) = Language::with_cut(liveness, cut)?;
    let full = Graph::of(found, |edge| shows(&language, chart, &found.edges()[edge]));
    let mut comparison =
        ConformanceComparison { chart, found, language, may_end_early: false, is_stopped: &|| false };
    comparison.follow_chart(&full, all).0.difference()
}

/// The differences of a chart that may be left early: it may end where the formulas continue.
pub(crate) fn differences_of_what_is_left_early(
    chart: &Statechart,
    found: &Exploration,
    liveness: &Liveness,
) -> (Vec<ConformanceDifference>, bool) {
    compared(chart, found, Language::new(liveness), true, &|| false)
}

fn compared(
    chart: &Statechart,
    found: &Exploration,
    language: Option<(Language, Residual)>,
    may_end_early: bool,
    is_stopped: &dyn Fn() -> bool,
) -> (Vec<ConformanceDifference>, bool) {
    let Some((language, all)) = language else { return (Vec::new(), false) };
    let full = Graph::of(found, |edge| shows(&language, chart, &found.edges()[edge]));
    let mut comparison = ConformanceComparison { chart, found, language, may_end_early, is_stopped };
    let small = full.collapsed();
    let (does, cannot) = comparison.check_both_directions(small.as_ref().unwrap_or(&full), all);
    // classes decide whether there is a difference, but only states yield a trace to it
    let does = match (does, small) {
        (InclusionResult::Differs(brief), Some(_)) => match comparison.chart_included(&full, all) {
            InclusionResult::Differs(whole) => InclusionResult::Differs(whole),
            _ => InclusionResult::Differs(ConformanceDifference { trace: None, ..brief }),
        },
        (does, _) => does,
    };
    let is_whole = !matches!(does, InclusionResult::Unknown) && !matches!(cannot, InclusionResult::Unknown);
    (does.difference().into_iter().chain(cannot.difference()).collect(), is_whole)
}

fn shows(language: &Language, chart: &Statechart, edge: &Edge) -> Observable {
    let letter = |node: NodeId| language.find(&chart.node(node).name);
    edge.returned
        .map_or(Observable::Nothing, |node| letter(node).map_or(Observable::Other, Observable::Letter))
}

struct ConformanceComparison<'a> {
    chart: &'a Statechart,
    found: &'a Exploration,
    language: Language,
    /// Whether the chart may end where the formulas continue.
    may_end_early: bool,
    /// Whether the caller wants it to end.
    is_stopped: &'a dyn Fn() -> bool,
}

/// The result in one direction.
enum InclusionResult {
    Same,
    Differs(ConformanceDifference),
    /// The comparison exceeded its limit.
    Unknown,
}

impl InclusionResult {
    fn difference(self) -> Option<ConformanceDifference> {
        match self {
            InclusionResult::Differs(difference) => Some(difference),
            InclusionResult::Same | InclusionResult::Unknown => None,
        }
    }
}

type ResidualSet = BTreeSet<Residual>;

/// A state of the chart with the residuals of the formulas there.
type ProductState = (usize, ResidualSet);

/// The reached product states.
#[derive(Default)]
struct Reached {
    /// In the order of discovery.
    order: Vec<ProductState>,
    /// The predecessor of each, and the edge from it.
    from: BTreeMap<ProductState, Option<(ProductState, usize)>>,
}

impl Reached {
    /// Adds a state. Returns whether it is new.
    fn visit(&mut self, at: ProductState, from: Option<(ProductState, usize)>) -> bool {
        let is_new = !self.from.contains_key(&at);
        if is_new {
            self.order.push(at.clone());
            self.from.insert(at, from);
        }
        is_new
    }
}

impl ConformanceComparison<'_> {
    fn check_both_directions(&mut self, graph: &Graph, all: Residual) -> (InclusionResult, InclusionResult) {
        let does = self.chart_included(graph, all);
        let cannot =
            if self.found.is_finished() { self.formulas_included(graph, all) } else { InclusionResult::Same };
        (does, cannot)
    }

    /// Chart against formulas: first each step, then infinite continuations.
    fn chart_included(&mut self, graph: &Graph, all: Residual) -> InclusionResult {
        match self.follow_chart(graph, all) {
            (InclusionResult::Same, came) if self.found.is_finished() => {
                self.check_completable(graph, all, &came)
            }
            (does, _) => does,
        }
    }

    /// Checks that the formulas can still be satisfied from every reached state.
    fn check_completable(&mut self, graph: &Graph, all: Residual, came: &Reached) -> InclusionResult {
        match endlessly(graph, &mut self.language, all, &came.order, self.may_end_early) {
            InfiniteTraceResult::Met => InclusionResult::Same,
            InfiniteTraceResult::Missed(index, names) => {
                let kind = DifferenceKind::Starves(names);
                InclusionResult::Differs(self.difference(kind, came, &came.order[index], None))
            }
            InfiniteTraceResult::Unknown => InclusionResult::Unknown,
        }
    }

    /// Checks each step of the chart against the formulas. Also returns the reached states.
    fn follow_chart(&mut self, graph: &Graph, all: Residual) -> (InclusionResult, Reached) {
        let mut came = Reached::default();
        for &state in &graph.initial {
            came.visit((state, ResidualSet::from([all])), None);
        }
        let mut open = 0;
        while let Some(at) = came.order.get(open).cloned() {
            open += 1;
            if came.order.len() > MAX_PAIRS || self.language.is_too_large() || (self.is_stopped)() {
                return (InclusionResult::Unknown, came);
            }
            let may_end = self.may_end_early || at.1.iter().any(|&rest| self.language.may_end(rest));
            if graph.ends[at.0] && !may_end {
                let difference = self.difference(DifferenceKind::EndsEarly, &came, &at, None);
                return (InclusionResult::Differs(difference), came);
            }
            for edge in &graph.edges[at.0] {
                let rests = match edge.observable {
                    Observable::Nothing => at.1.clone(),
                    Observable::Letter(letter) => self.language.derivative_of_any(&at.1, letter),
                    Observable::Other => ResidualSet::new(),
                };
                if let (true, Some(node)) = (rests.is_empty(), self.found.edges()[edge.edge].returned) {
                    let kind = DifferenceKind::NotAllowed(node);
                    let difference = self.difference(kind, &came, &at, Some(edge.edge));
                    return (InclusionResult::Differs(difference), came);
                }
                came.visit((edge.to, rests), Some((at.clone(), edge.edge)));
            }
        }
        (InclusionResult::Same, came)
    }

    fn difference(
        &self,
        kind: DifferenceKind,
        came: &Reached,
        at: &ProductState,
        last: Option<usize>,
    ) -> ConformanceDifference {
        let (mut edges, mut at) = (Vec::new(), at.clone());
        while let Some(Some((before, edge))) = came.from.get(&at) {
            edges.push(*edge);
            at = before.clone();
        }
        edges.reverse();
        let before = self.names(&edges);
        edges.extend(last);
        ConformanceDifference { before, kind, trace: Some(self.found.trace_along(at.0, &edges)) }
    }

    fn names(&self, edges: &[usize]) -> Vec<String> {
        let returned = edges.iter().filter_map(|&edge| self.found.edges()[edge].returned);
        returned.map(|node| self.chart.node(node).name.clone()).collect()
    }

    /// Follows the formulas, with all the states in which the chart may be after the same trace.
    ///
    /// A guard decides which of the alternatives is taken, and may do so by what has been: a timer,
    /// an assignment. What the formulas allow at some point the chart must therefore do there after
    /// one of the traces that lead to that point, not after each.
    fn formulas_included(&mut self, graph: &Graph, all: Residual) -> InclusionResult {
        let start =
            (internal_closure(graph, graph.initial.iter().copied().collect()), ResidualSet::from([all]));
        let mut seen = BTreeSet::from([start.clone()]);
        let mut open = VecDeque::from([(start, None)]);
        let mut points = FormulaPoints::default();
        let mut work = 0;
        while let Some(((states, rests), trace)) = open.pop_front() {
            work += states.len() * (1 + rests.len());
            if work > MAX_PAIRS || self.language.is_too_large() || (self.is_stopped)() {
                return InclusionResult::Unknown;
            }
            let may_end = rests.iter().any(|&rest| self.language.may_end(rest));
            let ends = states.iter().any(|&state| graph.ends[state]);
            if may_end {
                points.visit(&rests, trace).follow(None, ends);
            }
            for letter in self.language.first_letters(&rests) {
                let after = self.language.derivative_of_any(&rests, letter);
                let reached = reached(graph, &states, letter);
                points.visit(&rests, trace).follow(Some(letter), !reached.is_empty());
                let next = (internal_closure(graph, reached), after);
                if !next.0.is_empty() && seen.insert(next.clone()) {
                    open.push_back((next, Some(points.extend(trace, letter))));
                }
            }
        }
        match points.never_followed() {
            Some((Some(letter), before)) => {
                let name = self.language.letters()[letter as usize].clone();
                InclusionResult::Differs(self.missing(DifferenceKind::NeverDone(name), &before))
            }
            Some((None, before)) => {
                InclusionResult::Differs(self.missing(DifferenceKind::NeverEnds, &before))
            }
            None => InclusionResult::Same,
        }
    }

    fn missing(&self, kind: DifferenceKind, before: &[Symbol]) -> ConformanceDifference {
        let before = before.iter().map(|&letter| self.language.letters()[letter as usize].clone());
        ConformanceDifference { before: before.collect(), kind, trace: None }
    }
}

fn reached(graph: &Graph, states: &BTreeSet<usize>, letter: Symbol) -> BTreeSet<usize> {
    let edges = states.iter().flat_map(|&state| &graph.edges[state]);
    edges.filter(|edge| edge.observable == Observable::Letter(letter)).map(|edge| edge.to).collect()
}

/// All states that are reached without the return of an activity.
fn internal_closure(graph: &Graph, mut states: BTreeSet<usize>) -> BTreeSet<usize> {
    let mut open: Vec<usize> = states.iter().copied().collect();
    while let Some(state) = open.pop() {
        for edge in graph.edges[state].iter().filter(|edge| edge.observable == Observable::Nothing) {
            if states.insert(edge.to) {
                open.push(edge.to);
            }
        }
    }
    states
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use proptest::prelude::*;
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    use yase::expression::parse_transition;
    use yase::{NodeKind, TransitionId, TypeEnvironment};
    use yase_explore::{Environment, explore};

    use super::*;

    /// A formula in which every name occurs once.
    #[derive(Clone, Debug)]
    enum SampleFormula {
        Name,
        Several(&'static str, Vec<SampleFormula>),
        Optional(Box<SampleFormula>),
        Repeated(&'static str, Box<SampleFormula>),
    }

    impl SampleFormula {
        fn text(&self, count: &mut usize) -> String {
            match self {
                SampleFormula::Name => {
                    *count += 1;
                    format!("a{count}")
                }
                SampleFormula::Several(operator, parts) => {
                    let parts: Vec<String> = parts.iter().map(|part| part.text(count)).collect();
                    format!("({})", parts.join(operator))
                }
                SampleFormula::Optional(inner) => format!("[{}]", inner.text(count)),
                SampleFormula::Repeated(operator, inner) => format!("({}){operator}", inner.text(count)),
            }
        }
    }

    fn formula() -> impl Strategy<Value = SampleFormula> {
        Just(SampleFormula::Name).prop_recursive(3, 7, 3, |inner| {
            let several = (
                prop::sample::select(vec![" . ", " | ", " || "]),
                prop::collection::vec(inner.clone(), 2..4),
            );
            let repeated = (prop::sample::select(vec!["*", "+", "~"]), inner.clone());
            prop_oneof![
                3 => several.prop_map(|(operator, parts)| SampleFormula::Several(operator, parts)),
                1 => inner.prop_map(|inner| SampleFormula::Optional(Box::new(inner))),
                1 => repeated.prop_map(|(operator, inner)| SampleFormula::Repeated(operator, Box::new(inner))),
            ]
        })
    }

    /// The chart of formulas in which every choice is free: all exits of a node but the last have a
    /// guard that may hold or not.
    fn free(text: &str) -> (Statechart, Liveness, Vec<TransitionId>) {
        let (liveness, _) = aseme::liveness::parse(text);
        let (mut chart, _) = aseme::liveness_to_statechart(&liveness);
        let mut guarded = Vec::new();
        let nodes: Vec<NodeId> = chart.nodes().map(|(id, _)| id).collect();
        for node in nodes {
            let transitions: Vec<TransitionId> =
                chart.transitions().filter(|(_, it)| it.source == node).map(|(id, _)| id).collect();
            for &transition in &transitions[..transitions.len().saturating_sub(1)] {
                set_guard(&mut chart, transition, &format!("script(\"{}\")", transition.0));
                guarded.push(transition);
            }
        }
        (chart, liveness, guarded)
    }

    fn set_guard(chart: &mut Statechart, transition: TransitionId, guard: &str) {
        chart.transition_mut(transition).expression = parse_transition(&format!("[{guard}]")).0;
    }

    /// The differences, if the chart is small enough for exploration.
    fn found_in(chart: &Statechart, liveness: &Liveness) -> Option<Vec<DifferenceKind>> {
        let vocabulary = TypeEnvironment { scripts: true, ..TypeEnvironment::default() };
        let compiled = Arc::new(chart.compile(&vocabulary).unwrap());
        let mut surroundings = Environment { messages: true, ..Environment::default() };
        let found = explore(&compiled, &mut surroundings, 1_500);
        let kinds = || {
            differences(chart, &found, liveness, &|| false)
                .0
                .into_iter()
                .map(|difference| difference.kind)
                .collect()
        };
        found.is_finished().then(kinds)
    }

    /// The templates of formulas are compared with an independent definition of their traces.
    #[test]
    fn charts_do_what_their_formulas_say_and_nothing_else() {
        let mut runner = TestRunner::deterministic();
        let mut judged = 0;
        for _ in 0..80 {
            let formula = formula().new_tree(&mut runner).unwrap().current();
            let text = format!("r = {}", formula.text(&mut 0));
            let (chart, liveness, _) = free(&text);
            let Some(found) = found_in(&chart, &liveness) else { continue };
            assert_eq!(found, [], "{text}");
            judged += 1;
        }
        assert!(judged >= 60, "only {judged} were small enough");
    }

    /// For charts with one guard closed, classes and states yield the same differences.
    #[test]
    fn classes_of_states_have_the_traces_of_the_states() {
        let mut runner = TestRunner::deterministic();
        let (mut smaller, mut different) = (0, 0);
        for round in 0..120 {
            let formula = formula().new_tree(&mut runner).unwrap().current();
            let text = format!("r = {}", formula.text(&mut 0));
            let (mut chart, liveness, guarded) = free(&text);
            // returned activities wait, so that there are unobservable steps
            let done: Vec<TransitionId> = (chart.transitions())
                .filter(|(id, it)| chart.node(it.source).kind == NodeKind::Basic && !guarded.contains(id))
                .map(|(id, _)| id)
                .collect();
            done.into_iter().for_each(|transition| {
                set_guard(&mut chart, transition, &format!("script(\"{}\")", transition.0))
            });
            if let Some(&transition) = guarded.get(round % (guarded.len() + 1)) {
                set_guard(&mut chart, transition, "false");
            }
            let vocabulary = TypeEnvironment { scripts: true, ..TypeEnvironment::default() };
            let compiled = Arc::new(chart.compile(&vocabulary).unwrap());
            let mut surroundings = Environment { messages: true, ..Environment::default() };
            let found = explore(&compiled, &mut surroundings, 500);
            if !found.is_finished() {
                continue;
            }
            let (language, all) = Language::new(&liveness).unwrap();
            let full = Graph::of(&found, |edge| shows(&language, &chart, &found.edges()[edge]));
            let small = full.collapsed().unwrap();
            let mut comparison = ConformanceComparison {
                chart: &chart,
                found: &found,
                language,
                may_end_early: false,
                is_stopped: &|| false,
            };
            let mut kinds = |graph: &Graph| {
                let (does, cannot) = comparison.check_both_directions(graph, all);
                [does, cannot].map(|verdict| verdict.difference().map(|it| (it.before.len(), it.kind)))
            };
            let (by_states, by_classes) = (kinds(&full), kinds(&small));
            assert_eq!(by_states[1], by_classes[1], "{text}");
            // of several equally short traces to a difference the two searches may find different
            // ones
            let is_some = |it: &Option<(usize, DifferenceKind)>| it.is_some();
            assert_eq!(is_some(&by_states[0]), is_some(&by_classes[0]), "{text}");
            smaller += usize::from(small.edges.len() < full.edges.len());
            different += usize::from(by_states.iter().any(is_some));
        }
        assert!(smaller >= 20 && different >= 20, "{smaller} were smaller, {different} differ");
    }

    fn kinds(text: &str, change: impl Fn(&mut Statechart)) -> Vec<DifferenceKind> {
        let (mut chart, liveness, _) = free(text);
        change(&mut chart);
        found_in(&chart, &liveness).unwrap()
    }

    fn named(chart: &Statechart, name: &str) -> NodeId {
        chart.nodes().find(|(_, node)| node.name == name).unwrap().0
    }

    fn between(chart: &Statechart, source: &str, target: NodeKind) -> TransitionId {
        let source = named(chart, source);
        let is_meant = |it: &yase::Transition| it.source == source && chart.node(it.target).kind == target;
        chart.transitions().find(|(_, it)| is_meant(it)).unwrap().0
    }

    #[test]
    fn each_difference_is_found() {
        assert_eq!(kinds("r = a . b", |_| {}), []);
        let closed = |chart: &mut Statechart| {
            let transition = between(chart, "b", NodeKind::End);
            set_guard(chart, transition, "false");
        };
        assert_eq!(kinds("r = a . b", closed), [DifferenceKind::NeverEnds]);
        let skipped = |chart: &mut Statechart| {
            let (first, end) = (between(chart, "a", NodeKind::Basic), between(chart, "b", NodeKind::End));
            chart.transition_mut(first).target = chart.transition(end).target;
        };
        assert_eq!(
            kinds("r = a . b", skipped),
            [DifferenceKind::EndsEarly, DifferenceKind::NeverDone("b".into())]
        );
        let other = |chart: &mut Statechart| {
            let first = between(chart, "a", NodeKind::Basic);
            let target = named(chart, "c");
            chart.transition_mut(first).target = target;
        };
        assert!(matches!(
            kinds("r = a . b . c", other)[..],
            [DifferenceKind::NotAllowed(_), DifferenceKind::NeverDone(_)]
        ));
        let once = |chart: &mut Statechart| {
            let first = between(chart, "a", NodeKind::Basic);
            set_guard(chart, first, "false");
        };
        assert_eq!(kinds("r = a+ . b", once), [DifferenceKind::NeverDone("a".into())]);
        let until = |chart: &mut Statechart| {
            let first = between(chart, "a", NodeKind::Basic);
            set_guard(chart, first, "In(b)");
        };
        let ceases = kinds("r = a~ || b", until);
        let [DifferenceKind::Starves(names)] = &ceases[..] else { panic!("{ceases:?}") };
        assert_eq!(names, &["a~"]);
    }
}
