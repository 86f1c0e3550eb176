//! Small charts, explored completely.

mod plain;

use std::sync::Arc;

use super::{Environment, Exploration, Trace, explore, replay};
use yase::expression::{ScriptId, parse_transition};
use yase::{
    CompiledChart, MachineErrorKind, Node, NodeId, NodeKind, Statechart, Transition, TypeEnvironment,
};

/// States of a chart by name, those of an AND's regions as `a/b`; each composite begins with its
/// first state.
struct ChartSketch {
    chart: Statechart,
    names: Vec<(&'static str, NodeId)>,
}

impl ChartSketch {
    fn new() -> ChartSketch {
        ChartSketch { chart: Statechart::new("r"), names: Vec::new() }
    }

    fn add(&mut self, parent: NodeId, kind: NodeKind, name: &'static str) -> NodeId {
        let id = self.chart.add(parent, Node::new(kind, name));
        self.names.push((name, id));
        id
    }

    /// Adds states to a composite; those with a capital letter have an activity.
    fn states(&mut self, parent: NodeId, names: &[&'static str]) {
        let start = self.chart.add(parent, Node::new(NodeKind::Start, ""));
        for (index, name) in names.iter().enumerate() {
            let id = self.add(parent, NodeKind::Basic, name);
            if name.starts_with(char::is_uppercase) {
                self.chart.node_mut(id).activity = Some((*name).into());
            }
            if index == 0 {
                self.chart.connect(Transition::new(start, id));
            }
        }
    }

    fn node(&self, name: &str) -> NodeId {
        self.names.iter().find(|(it, _)| *it == name).unwrap().1
    }

    fn connect(&mut self, source: &str, target: &str, text: &str) {
        let (expression, wrong) = parse_transition(text);
        assert!(wrong.is_empty(), "{wrong:?}");
        let transition = Transition::new(self.node(source), self.node(target));
        self.chart.connect(Transition { expression, ..transition });
    }

    fn compile(&self) -> Arc<CompiledChart> {
        let vocabulary = TypeEnvironment { scripts: true, ..TypeEnvironment::default() };
        Arc::new(self.chart.compile(&vocabulary).unwrap())
    }
}

fn events(names: &[&str]) -> Environment<'static> {
    Environment { events: names.iter().map(|&name| name.into()).collect(), ..Environment::default() }
}

fn two_switches() -> ChartSketch {
    let mut sketch = ChartSketch::new();
    let start = sketch.chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
    let and = sketch.add(Statechart::ROOT, NodeKind::And, "both");
    sketch.chart.connect(Transition::new(start, and));
    for names in [["a", "b"], ["c", "d"]] {
        let region = sketch.chart.add(and, Node::new(NodeKind::Or, ""));
        sketch.states(region, &names);
    }
    for (source, target, event) in
        [("a", "b", "left"), ("b", "a", "left"), ("c", "d", "right"), ("d", "c", "right")]
    {
        sketch.connect(source, target, event);
    }
    sketch
}

#[test]
fn every_combination_is_found_and_nothing_else() {
    let sketch = two_switches();
    let found = explore(&sketch.compile(), &mut events(&["left", "right"]), 100);
    assert!(found.is_finished());
    assert_eq!((found.states().len(), found.configurations(), found.edges().len()), (4, 4, 8));
    let found = explore(&sketch.compile(), &mut events(&["left"]), 100);
    assert_eq!(found.states().len(), 2);
    assert!(
        found.was_left(sketch.node("a"))
            && !found.was_left(sketch.node("c"))
            && !found.was_entered(sketch.node("d"))
    );
}

#[test]
fn a_stopped_search_is_incomplete() {
    let found = explore(&two_switches().compile(), &mut events(&["left", "right"]), 3);
    assert!(!found.is_finished());
    assert_eq!(found.states().len(), 3);
}

/// State `a` waits; the path out of it reads the same condition twice.
fn asked_twice() -> ChartSketch {
    let mut sketch = ChartSketch::new();
    sketch.states(Statechart::ROOT, &["a", "b", "c", "d"]);
    sketch.connect("a", "b", "go [script(\"x\")]");
    sketch.connect("b", "c", "[!script(\"x\")]");
    sketch.connect("b", "d", "back [script(\"x\")]");
    sketch
}

#[test]
fn a_condition_has_one_value_in_a_step_and_any_in_the_next() {
    let sketch = asked_twice();
    let found = explore(&sketch.compile(), &mut events(&["go", "back"]), 100);
    assert!(
        found.is_finished() && found.was_entered(sketch.node("c")) && found.was_entered(sketch.node("d"))
    );
    let trace = found.trace_to(found.first(|state| state.is_active(sketch.node("c"))).unwrap());
    assert_eq!(trace.to_string(), "start\nevent go\n  true   x\nevent go\n  false  x\n");
}

#[test]
fn surroundings_say_what_conditions_may_be() {
    let sketch = asked_twice();
    let mut surroundings = events(&["go", "back"]);
    surroundings.allows = Box::new(|_: ScriptId, value, _: &[_]| value);
    let found = explore(&sketch.compile(), &mut surroundings, 100);
    assert!(found.was_entered(sketch.node("d")) && !found.was_entered(sketch.node("c")));
}

#[test]
fn activities_return_and_timers_expire_in_any_order() {
    let mut sketch = ChartSketch::new();
    sketch.states(Statechart::ROOT, &["Work", "rest", "short", "long"]);
    sketch.connect("Work", "rest", "/ StartTimeout(one, 1s); StartTimeout(two, 2s)");
    sketch.connect("rest", "short", "one");
    sketch.connect("rest", "long", "two");
    let found = explore(&sketch.compile(), &mut Environment::default(), 100);
    assert!(
        found.is_finished()
            && found.was_entered(sketch.node("short"))
            && found.was_entered(sketch.node("long"))
    );
    assert_eq!(found.states()[0].running, [sketch.node("Work")]);
    let trace = found.trace_to(found.first(|state| state.is_active(sketch.node("long"))).unwrap());
    assert_eq!(trace.to_string(), "start\nreturn Work\ntimer r two\n");
}

#[test]
fn open_choices_are_explored_each_way() {
    let mut sketch = ChartSketch::new();
    sketch.states(Statechart::ROOT, &["a", "b", "c"]);
    for (target, weight) in [("b", 0.9), ("c", 0.1)] {
        let transition = Transition::new(sketch.node("a"), sketch.node(target));
        let expression = parse_transition("toss").0;
        sketch.chart.connect(Transition { expression, weight: Some(weight), ..transition });
    }
    let found = explore(&sketch.compile(), &mut events(&["toss"]), 100);
    let trace = found.trace_to(found.first(|state| state.is_active(sketch.node("c"))).unwrap());
    assert_eq!(trace.to_string(), "start\nevent toss\n  choose 1\n");
}

#[test]
fn a_step_that_never_ends_is_a_failure_and_no_state() {
    let mut sketch = ChartSketch::new();
    sketch.states(Statechart::ROOT, &["a", "b"]);
    sketch.connect("a", "b", "[script(\"x\")]");
    sketch.connect("b", "a", "");
    let mut surroundings = Environment { messages: true, ..Environment::default() };
    let found = explore(&sketch.compile(), &mut surroundings, 100);
    assert_eq!(found.states().len(), 1);
    let [failure] = found.failures() else { panic!("{:?}", found.failures()) };
    assert_eq!((failure.kind, failure.from, failure.cycle.len()), (MachineErrorKind::NeverRests, None, 2));
    assert!(replay(&found.trace_of(failure), |_, _, _| {}).is_err());
}

#[test]
fn every_way_leads_to_its_state_again() {
    let sketch = two_switches();
    let chart = sketch.compile();
    let found: Exploration = explore(&chart, &mut events(&["left", "right"]), 100);
    for (number, state) in found.states().iter().enumerate() {
        let text = found.trace_to(number).to_string();
        let again = Trace::parse(&chart, &text).unwrap();
        assert_eq!(again.to_string(), text);
        assert_eq!(replay(&again, |_, _, _| {}).unwrap().configuration(), state.configuration);
    }
    for (number, edge) in found.edges().iter().enumerate() {
        let machine = replay(&found.trace_along(edge.from, &[number]), |_, _, _| {}).unwrap();
        assert_eq!(machine.configuration(), found.states()[edge.to].configuration);
    }
}
