//! Any chart, even an invalid one, has a text for every tool that contains every name.

use std::collections::BTreeSet;

use proptest::prelude::*;
use serde_json::Value;
use yase::expression::{parse_actions, parse_transition};
use yase::statechart::{Frame, Point};
use yase::{Node, NodeId, NodeKind, Statechart, Transition, TransitionId};
use yase_export::{Exported, to_dot, to_mermaid, to_plantuml, to_svg, to_xstate};

/// Kind, parent, name, and whether it has an activity and an entry action.
type Seed = (usize, prop::sample::Index, String, bool, bool);

fn names() -> impl Strategy<Value = String> {
    prop_oneof![
        Just(String::new()),
        "[a-c]{1,2}",
        prop::sample::select(vec!["state", "end", "a~", "(a|b)*", "\"", "a\"} -->", "%%{x}%%", "[*]", "ω"])
            .prop_map(String::from),
        "\\PC{1,5}",
    ]
}

fn points() -> impl Strategy<Value = Point> {
    prop_oneof![Just((0.0, 0.0)), (0.0..400.0, 0.0..400.0), (0.0..100_000.0, 0.0..100_000.0)]
}

fn expressions() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec![
        "",
        "go",
        "go | stop [x]",
        "* / raise(e)",
        "not go",
        "[TimeoutCheck(t)]",
        "[false]",
        "[a == \"}{\"] / StartTimeout(t, 5ms)",
        "t",
    ])
}

prop_compose! {
    fn charts()(
        seeds in prop::collection::vec((0..15_usize, any::<prop::sample::Index>(), names(), any::<bool>(), any::<bool>()), 0..14),
        wires in prop::collection::vec((0..15_u32, 0..15_u32, expressions(), -1..2_i32, any::<[bool; 3]>()), 0..20),
        nested in 0..3_u32,
    ) -> Statechart {
        let mut chart = Statechart::new("any \"chart\"");
        seeds.iter().for_each(|seed| grow(&mut chart, seed, nested));
        for (source, target, text, priority, [interrupts, internal, weight]) in wires {
            let expression = parse_transition(text).0;
            let weight = weight.then_some(0.5);
            let wire = Transition::new(NodeId(source), NodeId(target));
            chart.connect(Transition { expression, priority, interrupts, internal, weight, ..wire });
        }
        chart
    }
}

/// Adds a node to a composite or, in some charts, to any node.
fn grow(chart: &mut Statechart, (kind, parent, name, runs, acts): &Seed, nested: u32) {
    let composite = |kind| nested == 0 || matches!(kind, NodeKind::Or | NodeKind::And);
    let fitting = chart.nodes().filter(|(_, node)| composite(node.kind)).map(|(id, _)| id);
    let parents: Vec<NodeId> = fitting.collect();
    let parent = parents[parent.index(parents.len())];
    let is_region = nested > 0 && chart.node(parent).kind == NodeKind::And;
    let mut node = Node::new(if is_region { NodeKind::Or } else { super::KINDS[*kind] }, name.as_str());
    node.activity = runs.then(|| "act".to_owned());
    node.entry = if *acts { parse_actions("raise(in)").0 } else { Vec::new() };
    chart.add(parent, node);
}

/// The states of a machine configuration, with all targets and names.
#[derive(Default)]
struct Machine {
    ids: BTreeSet<String>,
    targets: BTreeSet<String>,
    names: BTreeSet<String>,
}

impl Machine {
    fn read(&mut self, value: &Value) {
        match value {
            Value::Object(entries) => {
                for (key, value) in entries {
                    match (key.as_str(), value) {
                        ("id", Value::String(id)) => assert!(self.ids.insert(id.clone()), "{id} twice"),
                        ("name", Value::String(name)) => drop(self.names.insert(name.clone())),
                        ("target", Value::String(target)) => drop(self.targets.insert(target.clone())),
                        ("via", Value::Array(names)) => {
                            let names = names.iter().filter_map(Value::as_str);
                            self.names.extend(names.filter_map(|it| Some(it.split_once(' ')?.1.to_owned())));
                        }
                        _ => self.read(value),
                    }
                }
            }
            Value::Array(items) => items.iter().for_each(|item| self.read(item)),
            _ => {}
        }
    }
}

/// Whether a text or its losses mention a node.
fn speaks_of(exported: &Exported, chart: &Statechart, id: NodeId) -> bool {
    let path = format!("`{}`", chart.path(id));
    exported.lost.iter().any(|finding| finding.message.contains(&path))
}

/// The number of opened minus closed braces outside of quotes and, for Mermaid, of escapes is zero.
fn is_balanced(text: &str) -> bool {
    let (mut depth, mut quoted, mut escaped) = (0_i32, false, false);
    for character in text.chars() {
        match character {
            _ if escaped => escaped = false,
            '\\' if quoted => escaped = true,
            '"' => quoted = !quoted,
            '{' if !quoted => depth += 1,
            '}' if !quoted => depth -= 1,
            _ => {}
        }
        if depth < 0 {
            return false;
        }
    }
    depth == 0 && !quoted
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_chart_is_a_machine(chart in charts()) {
        let exported = to_xstate(&chart);
        let value: Value = serde_json::from_str(&exported.text).expect("JSON");
        let mut machine = Machine::default();
        machine.read(&value);
        for (id, node) in chart.nodes() {
            let known = node.name.is_empty() || machine.names.contains(node.name.trim_end());
            prop_assert!(known || machine.names.contains(&node.name) || speaks_of(&exported, &chart, id), "{}", chart.path(id));
        }
        for target in machine.targets.iter().filter_map(|target| target.strip_prefix('#')) {
            prop_assert!(machine.ids.contains(target), "{target}\n{}", exported.text);
        }
        prop_assert_eq!(to_xstate(&chart.clone()), exported);
    }

    #[test]
    fn every_chart_is_a_diagram(chart in charts()) {
        for (export, arrow) in [
            (to_mermaid as fn(&Statechart) -> Exported, " --> "),
            (to_plantuml, "-> "),
            (to_dot, " -> "),
        ] {
            let exported = export(&chart);
            prop_assert!(is_balanced(&exported.text), "{}", exported.text);
            let count = chart.nodes().len() as u32;
            let sound = chart.transitions().filter(|(_, it)| it.source.0 < count && it.target.0 < count).count();
            let arrows = exported.text.lines().filter(|line| line.contains(arrow)).count();
            prop_assert!(arrows >= sound, "{} of {}\n{}", arrows, sound, exported.text);
            let wrong = exported.lost.iter().filter(|finding| finding.code == "E0706").count();
            prop_assert_eq!(wrong, chart.transitions().len() - sound);
            for (_, node) in chart.nodes() {
                let plain = !node.name.is_empty() && node.name.chars().all(|it| it.is_ascii_alphabetic());
                prop_assert!(!plain || exported.text.contains(&node.name), "{}", exported.text);
            }
        }
    }

    #[test]
    fn every_chart_is_drawn(chart in charts()) {
        roxmltree::Document::parse(&to_svg(&chart)).expect("well-formed");
    }

    #[test]
    fn every_chart_is_drawn_wherever_its_parts_are_put(
        chart in charts(),
        frames in prop::collection::btree_map(0..15_u32, (prop::option::of(points()), prop::option::of(points())), 0..8),
        bends in prop::collection::btree_map(0..20_u32, prop::collection::vec(points(), 0..4), 0..6),
    ) {
        let mut placed = chart.clone();
        let frames = frames.into_iter().map(|(id, (at, size))| (NodeId(id), Frame { at, size }));
        placed.layout.frames = frames.collect();
        placed.layout.bends = bends.into_iter().map(|(id, bends)| (TransitionId(id), bends)).collect();
        let (plain, svg) = (to_svg(&chart), to_svg(&placed));
        let document = roxmltree::Document::parse(&svg).expect("well-formed");
        let drawn = |svg: &str| ["<rect", "<circle", "<polyline", "<text"].map(|it| svg.matches(it).count());
        let ([rects, circles, lines, _], [plain_rects, plain_circles, plain_lines, _]) = (drawn(&svg), drawn(&plain));
        prop_assert_eq!((rects, circles, lines), (plain_rects, plain_circles, plain_lines), "{}", svg);
        let page = ["width", "height"].map(|it| document.root_element().attribute(it).and_then(|it| it.parse::<f64>().ok()));
        prop_assert!(page.iter().all(|side| side.is_some_and(|side| side.is_finite() && side > 0.0)), "{}", svg);
        prop_assert!(!svg.contains("NaN") && !svg.contains("inf"), "{}", svg);
    }
}

#[test]
fn a_broken_tree_is_reported() {
    let mut chart = Statechart::new("c");
    let a = chart.add(Statechart::ROOT, Node::new(NodeKind::Or, "a"));
    chart.node_mut(a).parent = Some(a);
    for export in [to_xstate, to_mermaid, to_plantuml, to_dot] {
        let exported = export(&chart);
        assert_eq!(exported.text, "");
        assert_eq!(exported.lost.iter().map(|finding| finding.code).collect::<Vec<_>>(), ["E0708"]);
    }
    to_svg(&chart);
}

#[test]
fn a_chart_may_be_deeper_than_the_stack() {
    let mut chart = Statechart::new("c");
    let mut parent = Statechart::ROOT;
    for _ in 0..3_000 {
        parent = chart.add(parent, Node::new(NodeKind::Or, ""));
    }
    for export in [to_xstate, to_mermaid, to_plantuml, to_dot] {
        assert!(is_balanced(&export(&chart).text));
    }
}
