//! Written documents read back unchanged.

use std::path::Path;

use proptest::prelude::*;
use yase::expression::{Action, ActionKind, parse_transition};
use yase::{Node, NodeId, NodeKind, Severity, Source, Statechart, Transition};
use yase_scxml::{Document, read, write};

use crate::suites;

fn read_back(text: &str) -> Document {
    let (document, found) = read(&Source::new("written", text));
    assert!(found.iter().all(|found| found.severity != Severity::Error), "{found:?}\n{text}");
    document.unwrap()
}

fn documents(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
    let mut entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            documents(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "scxml") {
            found.push(path);
        }
    }
}

#[test]
fn every_document_of_the_suites_reads_back() {
    let mut paths = Vec::new();
    for folder in ["irp", "scion"].into_iter().filter_map(suites::folder) {
        documents(&folder, &mut paths);
    }
    let (mut written, mut refused) = (0, 0);
    for path in &paths {
        let text = std::fs::read_to_string(path).unwrap();
        let (document, found) = read(&Source::new(path.display().to_string(), text));
        if found.iter().any(yase::Diagnostic::is_error) {
            refused += 1;
            continue;
        }
        let document = document.unwrap();
        let text = document.write().unwrap();
        assert_eq!(read_back(&text), document, "{}\n{text}", path.display());
        written += 1;
    }
    println!("{written} documents read back as they were; {refused} are outside the subset");
    assert!(paths.is_empty() || written > 250, "{written} of {}", paths.len());
}

/// Decisions for a chart, consumed in sequence.
struct Dice<'a>(std::slice::Iter<'a, u8>);

impl Dice<'_> {
    fn below(&mut self, bound: usize) -> usize {
        usize::from(*self.0.next().unwrap_or(&0)) % bound
    }
}

/// A chart without data, in document order.
fn chart(decisions: &[u8]) -> Statechart {
    let mut dice = Dice(decisions.iter());
    let mut chart = Statechart::new("random");
    grow(&mut chart, Statechart::ROOT, 0, &mut dice);
    let states: Vec<NodeId> = chart.nodes().map(|(id, _)| id).collect();
    let sources: Vec<NodeId> =
        states.into_iter().filter(|&id| chart.node(id).kind != NodeKind::Start).collect();
    for source in sources {
        // A document contains the start of a composite before its exits.
        if let Some(&start) =
            chart.children(source).first().filter(|_| chart.node(source).kind == NodeKind::Or)
        {
            connect(&mut chart, start, &mut dice);
        }
        connect(&mut chart, source, &mut dice);
    }
    chart
}

fn grow(chart: &mut Statechart, parent: NodeId, depth: usize, dice: &mut Dice<'_>) {
    use NodeKind::{And, Basic, DeepHistory, End, Or, ShallowHistory, Start};
    if chart.node(parent).kind == Or {
        chart.add(parent, Node::new(Start, ""));
    }
    let count = 1 + dice.below(3);
    for index in 0..count {
        let choices: &[NodeKind] = match (chart.node(parent).kind, depth) {
            (_, 3..) => &[Basic],
            (And, _) => &[Basic, Or],
            (_, 0) if index > 0 => &[Basic, Or, And, End],
            _ if index > 0 => &[Basic, Or, And, End, DeepHistory, ShallowHistory],
            _ => &[Basic, Or, And],
        };
        let kind = choices[dice.below(choices.len())];
        let name = format!("s{}", chart.nodes().len());
        let mut node = Node::new(kind, name);
        if !matches!(kind, DeepHistory | ShallowHistory) {
            node.entry = actions(dice);
            node.exit = actions(dice);
        }
        let id = chart.add(parent, node);
        if matches!(kind, Or | And) {
            grow(chart, id, depth + 1, dice);
        }
    }
}

fn actions(dice: &mut Dice<'_>) -> Vec<Action> {
    let texts = ["raise(a)", "raise(b.c)", "raise(x.State.y)", "raise(`raise`)"];
    let count = dice.below(3);
    let text: Vec<&str> = (0..count).map(|_| texts[dice.below(2)]).collect();
    yase::expression::parse_actions(&text.join("; ")).0
}

fn states_in(chart: &Statechart, composite: NodeId) -> Vec<NodeId> {
    use NodeKind::{And, Basic, End, Or};
    let children = chart.children(composite).iter().copied();
    children.filter(|&child| matches!(chart.node(child).kind, And | Basic | End | Or)).collect()
}

fn connect(chart: &mut Statechart, source: NodeId, dice: &mut Dice<'_>) {
    let node = chart.node(source);
    match (node.kind, node.parent) {
        (NodeKind::Start | NodeKind::DeepHistory | NodeKind::ShallowHistory, Some(parent)) => {
            let states = states_in(chart, parent);
            let target = states[dice.below(states.len())];
            chart.connect(Transition::new(source, target));
        }
        (NodeKind::Basic | NodeKind::Or | NodeKind::And, Some(_)) => {
            for _ in 0..dice.below(3) {
                some_transition(chart, source, dice);
            }
        }
        _ => {}
    }
}

fn some_transition(chart: &mut Statechart, source: NodeId, dice: &mut Dice<'_>) {
    let named: Vec<NodeId> =
        chart.nodes().filter(|(_, node)| node.name.starts_with('s')).map(|(id, _)| id).collect();
    let texts =
        ["", "a", "a | b.c", "*", "[In(s2)]", "a [!(In(s2) && true) || In(s2)] / raise(z)", "[false]"];
    let (expression, wrong) = parse_transition(texts[dice.below(texts.len())]);
    assert!(wrong.is_empty());
    let inside = states_in(chart, source);
    let (target, internal) = match dice.below(4) {
        0 => (source, true),
        1 if chart.node(source).kind == NodeKind::Or => (inside[dice.below(inside.len())], true),
        _ => (named[dice.below(named.len())], false),
    };
    chart.connect(Transition { expression, internal, ..Transition::new(source, target) });
}

proptest! {
    #[test]
    fn random_charts_read_back(decisions in prop::collection::vec(any::<u8>(), 0..300)) {
        let chart = chart(&decisions);
        let text = write(&chart).unwrap();
        let document = read_back(&text);
        prop_assert_eq!(document.statechart(), &chart, "{}", text);
    }

    #[test]
    fn nothing_that_is_read_panics(text in "(<(scxml|state|final|parallel|transition|if|send)( (id|event|cond|target)='[a-z.*( )]{0,6}')?/?>|</[a-z]{1,5}>|&|[ -~]){0,40}") {
        let _ = read(&Source::new("random", text));
    }
}

#[test]
fn features_without_scxml_are_rejected_by_name() {
    let mut chart = Statechart::new("c");
    let start = chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
    let a = chart
        .add(Statechart::ROOT, Node { activity: Some("work".into()), ..Node::new(NodeKind::Basic, "a") });
    let choice = chart.add(Statechart::ROOT, Node::new(NodeKind::Choice, ""));
    let odd = chart.add(Statechart::ROOT, Node::new(NodeKind::Basic, "b~"));
    for (source, target, text) in [
        (start, a, ""),
        (a, choice, "e / StartTimeout(t, 10ms)"),
        (a, odd, "[Ball.found]"),
        (odd, a, "not e"),
    ] {
        let expression = parse_transition(text).0;
        chart.connect(Transition {
            expression,
            priority: i32::from(source == odd),
            ..Transition::new(source, target)
        });
    }
    let refused: Vec<String> = write(&chart).unwrap_err().into_iter().map(|found| found.message).collect();
    let expected = [
        "`c/b~` has a name that cannot be an id in SCXML",
        "a transition out of `c/b~` has a priority, which SCXML cannot represent",
        "`c/a` has an activity, which SCXML cannot represent",
        "`c/3` cannot be the target of a transition in SCXML",
        "the action `StartTimeout(t, 10ms)` cannot be said in SCXML",
        "the guard `Ball.found` cannot be said in SCXML",
        "`c/3` is a Choice, which SCXML cannot represent",
        "`not e` out of `c/b~` cannot be said in SCXML",
    ];
    assert_eq!(refused, expected);
}

#[test]
fn a_guard_on_a_region_without_a_name_is_rejected() {
    let mut chart = Statechart::new("c");
    let start = chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
    let both = chart.add(Statechart::ROOT, Node::new(NodeKind::And, "both"));
    let last = chart.add(Statechart::ROOT, Node::new(NodeKind::Basic, "last"));
    for name in ["", "named"] {
        let region = chart.add(both, Node::new(NodeKind::Or, name));
        let begin = chart.add(region, Node::new(NodeKind::Start, ""));
        let state = chart.add(region, Node::new(NodeKind::Basic, format!("in_{name}")));
        chart.connect(Transition::new(begin, state));
    }
    chart.connect(Transition::new(start, both));
    for guard in ["[In(both/1)]", "[In(both/named)]"] {
        let expression = parse_transition(guard).0;
        chart.connect(Transition { expression, ..Transition::new(both, last) });
    }
    let refused: Vec<String> = write(&chart).unwrap_err().into_iter().map(|found| found.message).collect();
    assert_eq!(refused, ["the guard `In(both/1)` cannot be said in SCXML"]);
}

#[test]
fn texts_keep_their_odd_characters() {
    let mut chart = Statechart::new("a \"<&>\" name\twith\nblanks");
    let start = chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
    let a = chart.add(Statechart::ROOT, Node::new(NodeKind::Basic, "ä.b-c:d"));
    chart.connect(Transition::new(start, a));
    let script = "<log expr=\"'&lt; &amp; &quot; &#10;'\"/>";
    chart
        .node_mut(a)
        .entry
        .push(Action { kind: ActionKind::Script(script.into()), position: Default::default() });
    let text = write(&chart).unwrap();
    assert_eq!(read_back(&text).statechart(), &chart, "{text}");
}

#[test]
fn a_document_without_namespaces_is_written_stably() {
    let text = "<scxml version='1.0'><state id='a'><invoke type='scxml'><content><scxml version='1.0'><final/></scxml></content></invoke></state></scxml>";
    let written = read_back(text).write().unwrap();
    assert!(written.contains("<scxml xmlns=\"\" version=\"1.0\"><final/></scxml>"), "{written}");
    assert_eq!(read_back(&written).write().unwrap(), written);
}
