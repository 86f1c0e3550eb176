//! Conditions and actions in the language of the host, and events with a token of the host.

use std::sync::Arc;

use yase::expression::{CallError, EventId, ScriptId, parse_actions, parse_transition};
use yase::{
    ActionLocation, Activation, ActiveStates, CompiledChart, Host, Machine, MicroStep, NodeId, ScopeId,
    ScriptContext, ScriptLocation, Semantics, Statechart, Timestamp, TransitionId, TypeEnvironment,
};

use yase_reference::chart;
use yase_reference::chart::find;

/// Understands `in PATH` as a condition, `fail` as both, and `raise NAME TOKEN`, `look PATH` and
/// `see:LABEL` as actions.
struct Reader {
    chart: Arc<CompiledChart>,
    lines: Vec<String>,
}

impl Reader {
    fn node(&self, path: &str) -> NodeId {
        find(self.chart.statechart(), path)
    }
}

impl Host for Reader {
    fn condition(&self, script: ScriptId, _: ScopeId, states: &ActiveStates<'_>) -> Result<bool, CallError> {
        match self.chart.script(script).split_once(' ') {
            Some(("in", path)) => Ok(states.is_active(self.node(path))),
            _ => Err(CallError::new("it always fails")),
        }
    }

    fn perform(
        &mut self,
        script: ScriptId,
        region: ScopeId,
        performance: &mut ScriptContext<'_>,
    ) -> Result<(), CallError> {
        let words: Vec<&str> = self.chart.script(script).split(' ').collect();
        match words.as_slice() {
            ["raise", name, token] => {
                let known = performance.raise(name, token.parse().unwrap());
                self.lines.push(format!(
                    "raised {name} at {} on {}, known: {known}",
                    performance.now(),
                    region.0
                ));
                Ok(())
            }
            ["look", path] => {
                let node = self.node(path);
                let (active, complete) = (performance.is_active(node), performance.is_complete(node));
                self.lines.push(format!("{path} active: {active}, complete: {complete}"));
                Ok(())
            }
            [word] if word.starts_with("see:") => {
                let chart = self.chart.statechart();
                let active = chart.nodes().filter(|&(node, _)| performance.is_active(node));
                let paths: Vec<String> = active.map(|(node, _)| chart.path(node)).collect();
                self.lines.push(format!("{word} {}", paths.join(", ")));
                Ok(())
            }
            _ => Err(CallError::new("it always fails")),
        }
    }

    fn event_taken_from_queue(&mut self, event: EventId, is_known: bool, token: u64) {
        self.lines.push(format!("offered {} known: {is_known} {token}", self.chart.events().name(event)));
    }

    fn start(&mut self, _: Activation) {}
    fn cancel(&mut self, _: Activation) {}
    fn stop(&mut self, _: Activation) {}
}

fn machine(chart: &Statechart, semantics: Semantics) -> (Machine, Reader) {
    let vocabulary = TypeEnvironment { scripts: true, ..TypeEnvironment::default() };
    let chart = Arc::new(chart.compile_with(&vocabulary, semantics).unwrap());
    (Machine::new(chart.clone()), Reader { chart, lines: vec![] })
}

#[test]
fn scripts_are_written_and_read_back() {
    let (expression, found) = parse_transition("e [script( \"a < \\\"b\\\"\" ) && In(x)]/script(\"go\")");
    assert!(found.is_empty(), "{found:?}");
    let text = r#"e [script("a < \"b\"") && In(x)] / script("go")"#;
    assert_eq!(expression.to_string(), text);
    assert_eq!(parse_transition(text).0, expression);
    for (text, code) in [("script(go)", "E0123"), ("script(\"go\"", "E0109"), ("script()", "E0123")] {
        assert_eq!(parse_actions(text).1[0].code, code, "{text}");
    }
    assert_eq!(
        parse_actions("`script` = 1").0[0].to_string(),
        "`script` = 1",
        "a name in backquotes is a name"
    );
}

#[test]
fn scripts_are_refused_where_there_are_none() {
    let text = "
        START
        A
        START -> A : [script(\"x\")] / script(\"y\")
    ";
    let found = chart(text).compile(&TypeEnvironment::default()).unwrap_err();
    assert_eq!(found.iter().map(|found| found.code).collect::<Vec<_>>(), ["E0147", "E0147"]);
}

#[test]
fn scripts_know_where_they_stand_and_what_is_active() {
    let text = "
        START
        A | entry=script(\"look A\"); script(\"raise f 7\")
        B
        START -> A
        A -> B : f [script(\"in A\")] / script(\"look A\"); script(\"raise g.h 8\")
    ";
    let (mut machine, mut reader) = machine(&chart(text), Semantics::yase());
    let scripts: Vec<_> =
        machine.chart().scripts().map(|script| (script.text, script.locations.to_vec())).collect();
    let a = reader.node("A");
    let action = |location, index| ScriptLocation::Action(location, index);
    let (entry, transition) = (ActionLocation::Entry(a), ActionLocation::Transition(TransitionId(1)));
    assert_eq!(
        scripts,
        [
            ("look A", vec![action(transition, 0), action(entry, 0)]),
            ("raise f 7", vec![action(entry, 1)]),
            ("in A", vec![ScriptLocation::Guard(TransitionId(1))]),
            ("raise g.h 8", vec![action(transition, 1)]),
        ]
    );
    machine.start(Timestamp::ZERO, &mut reader);
    machine.run_to_completion(Timestamp::from_millis(3), &mut reader).unwrap();
    assert_eq!(
        reader.lines,
        [
            "A active: true, complete: true",
            "raised f at 0.003 s on 0, known: true",
            "offered f known: true 7",
            "A active: false, complete: false",
            "raised g.h at 0.003 s on 0, known: false",
            "offered ? known: false 8",
        ]
    );
}

#[test]
fn names_match_by_tokens_where_that_is_meant_and_tokens_come_along() {
    let text = "
        START
        A
        START -> A
        A -> A {internal} : a.b / raise(seen.b)
        A -> A {internal,!-1} : a / raise(seen.a)
        A -> A {internal} : `c.*` | d
        A -> A {internal} : not `seen` [false]
    ";
    let offered = |semantics, names: &[&str]| -> Vec<String> {
        let (mut machine, mut reader) = machine(&chart(text), semantics);
        machine.start(Timestamp::ZERO, &mut reader);
        for (name, token) in names.iter().zip(1..) {
            machine.dispatch_with(name, token);
        }
        machine.run_to_completion(Timestamp::ZERO, &mut reader).unwrap();
        reader.lines
    };
    let mut tokens = Semantics::yase();
    tokens.matching = yase::EventMatching::TokenPrefix;
    assert_eq!(
        offered(tokens, &["a.b.c", "a.bc", "x", "ab"]),
        [
            "offered a.b known: false 1",
            "offered seen.b known: true 0",
            "offered a known: false 2",
            "offered seen.a known: true 0",
            "offered ? known: false 3",
            "offered ? known: false 4",
        ]
    );
    assert_eq!(
        offered(Semantics::yase(), &["a.b.c", "a"]),
        ["offered ? known: false 1", "offered a known: true 2", "offered seen.a known: true 0",]
    );
}

#[test]
fn events_are_deferred_by_tokens_where_that_is_meant() {
    let text = "
        START
        A | defer=w
        B
        START -> A
        A -> B : go
        B -> B {internal} : w / raise(seen)
        A -> A {internal} : w.x [false]
    ";
    let transitions = |matching| -> Vec<u32> {
        let mut semantics = Semantics::yase();
        semantics.matching = matching;
        let (mut machine, mut reader) = machine(&chart(text), semantics);
        machine.start(Timestamp::ZERO, &mut reader);
        machine.run_to_completion(Timestamp::ZERO, &mut reader).unwrap();
        let mut play = |name: &str| {
            machine.dispatch_name(name);
            machine.run_to_completion(Timestamp::ZERO, &mut reader).unwrap().transitions
        };
        vec![play("w.x"), play("go"), play("w.x")]
    };
    assert_eq!(transitions(yase::EventMatching::TokenPrefix), [0, 2, 1], "`w.x` waits until `B` is active");
    assert_eq!(transitions(yase::EventMatching::Exact), [0, 1, 0]);
}

#[test]
fn failures_are_events_by_their_cause_or_every_time() {
    let text = "
        START
        A
        START -> A
        A -> A {internal,!1} : e / script(\"fail\")
        A -> A {internal} : * [script(\"fail\")]
    ";
    let offered = |semantics| -> Vec<String> {
        let (mut machine, mut reader) = machine(&chart(text), semantics);
        machine.start(Timestamp::ZERO, &mut reader);
        for event in ["x", "x", "e"] {
            machine.dispatch_name(event);
            machine.run_to_completion(Timestamp::ZERO, &mut reader).ok();
        }
        reader.lines.iter().map(|line| line.split(' ').nth(1).unwrap().to_owned()).collect()
    };
    assert_eq!(offered(Semantics::yase()), ["?", "error.guard", "?", "e", "error.action"]);
    let mut every = Semantics::yase();
    every.failures = yase::FailureEvents::EveryTime;
    every.limit = std::num::NonZeroU32::new(4).unwrap();
    assert_eq!(offered(every), ["?", "error.execution", "error.execution"], "until the limit");
}

/// Composites, side by side and nested, whose actions write down what is active: one action,
/// several, and none.
const SEEING: &str = "
    START
    P | entry=script(\"see:+P\") | exit=script(\"see:-P\"),script(\"see:-P2\")
      START
      A | entry=script(\"see:+A\") | exit=script(\"see:-A\")
      Q | entry=script(\"see:+Q\"),script(\"see:+Q2\")
        START
        B | exit=script(\"see:-B\")
    & both
      one
        START
        C | exit=script(\"see:-C\")
        D | entry=script(\"see:+D\")
      two
        START
        E
        F | entry=script(\"see:+F\") | exit=script(\"see:-F\")
    c/START -> P
    P/START -> A
    Q/START -> B
    one/START -> C
    two/START -> E
    A -> B : in / script(\"see:in\")
    P -> both : out / script(\"see:out\"),script(\"see:out2\")
    C -> D : e
    E -> F : e / script(\"see:ef\")
    F -> E : e
    D -> C : f [script(\"in P\")]
    both -> B : back / script(\"see:back\")
    B -> D : across
";

#[test]
fn r10_an_action_sees_what_has_been_left_and_entered_so_far() {
    let lines = |long: bool| -> Vec<String> {
        let (mut machine, mut reader) = machine(&chart(SEEING), Semantics::yase());
        machine.start(Timestamp::ZERO, &mut reader);
        machine.run_to_completion(Timestamp::ZERO, &mut reader).unwrap();
        for event in ["in", "out", "e", "e", "f", "back", "across", "x"] {
            machine.dispatch_name(event);
            if long {
                while machine.micro_step(Timestamp::ZERO, &mut reader).unwrap() == MicroStep::Progressed {}
            } else {
                machine.run_to_completion(Timestamp::ZERO, &mut reader).unwrap();
            }
        }
        reader.lines.retain(|line| line.starts_with("see:"));
        reader.lines
    };
    let expected = "
        see:+P c, c/P
        see:+A c, c/P, c/P/A
        see:-A c, c/P, c/P/A
        see:in c, c/P
        see:+Q c, c/P, c/P/Q
        see:+Q2 c, c/P, c/P/Q
        see:-B c, c/P, c/P/Q, c/P/Q/B
        see:-P c, c/P
        see:-P2 c, c/P
        see:out c
        see:out2 c
        see:-C c, c/both, c/both/one, c/both/one/C, c/both/two, c/both/two/E
        see:+D c, c/both, c/both/one, c/both/one/D, c/both/two, c/both/two/E
        see:ef c, c/both, c/both/one, c/both/one/D, c/both/two
        see:+F c, c/both, c/both/one, c/both/one/D, c/both/two, c/both/two/F
        see:-F c, c/both, c/both/one, c/both/one/D, c/both/two, c/both/two/F
        see:back c
        see:+P c, c/P
        see:+Q c, c/P, c/P/Q
        see:+Q2 c, c/P, c/P/Q
        see:-B c, c/P, c/P/Q, c/P/Q/B
        see:-P c, c/P
        see:-P2 c, c/P
        see:+D c, c/both, c/both/one, c/both/one/D
    ";
    let expected: Vec<&str> = expected.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    assert_eq!(lines(false), expected);
    assert_eq!(lines(true), expected);
}
