//! The contents of compact drawings, and the rules that make drawings small and plain.

use yase::{NodeKind, Statechart};
use yase_export::notation::kind_word;
use yase_export::{compact, to_picture, to_svg};

use super::drawing::{lines, readable};
use super::text::chart;

const WRAPPED: &str = "
START
A~||b AND
  OR
    START
    A~ OR
      START
      A BASIC
    END
  OR
    START
    b OR
      START
      B BASIC
      (C.D) OR | entry=raise(begun)
        START
        C BASIC
        D BASIC
        END
      END
    END
END
START -> A~||b
A~||b -> c/END : [false]
A~||b/1/START -> A~
A~ -> A~||b/1/END : [false]
A~/START -> A
A -> A : tick
A~||b/2/START -> b
b -> A~||b/2/END
b/START -> B
B -> (C.D)
B -> b/END : stop
(C.D) -> b/END
(C.D)/START -> C
C -> D
D -> (C.D)/END
";

/// Nodes with their kinds, and transitions.
fn outline(chart: &Statechart) -> (Vec<String>, Vec<String>) {
    let nodes = chart.nodes().map(|(id, node)| format!("{} {}", chart.path(id), kind_word(node.kind)));
    let transitions = chart
        .transitions()
        .map(|(_, it)| format!("{} -> {} {}", chart.path(it.source), chart.path(it.target), it.expression));
    (nodes.collect(), transitions.map(|line| line.trim().to_owned()).collect())
}

#[test]
fn boxes_around_boxes_and_ways_never_taken_are_left_out() {
    let compact = compact(&chart("c", WRAPPED));
    let (nodes, transitions) = outline(&compact);
    let expected = [
        "c AND",
        "c/A~ OR",
        "c/A~/START START",
        "c/A~/A BASIC",
        "c/b OR",
        "c/b/START START",
        "c/b/B BASIC",
        "c/b/(C.D) OR",
        "c/b/(C.D)/START START",
        "c/b/(C.D)/C BASIC",
        "c/b/(C.D)/D BASIC",
        "c/b/(C.D)/END END",
        "c/b/END END",
    ];
    assert_eq!(nodes, expected);
    let expected = [
        "c/A~/START -> c/A~/A",
        "c/A~/A -> c/A~/A tick",
        "c/b/START -> c/b/B",
        "c/b/B -> c/b/(C.D)",
        "c/b/B -> c/b/END stop",
        "c/b/(C.D) -> c/b/END",
        "c/b/(C.D)/START -> c/b/(C.D)/C",
        "c/b/(C.D)/C -> c/b/(C.D)/D",
        "c/b/(C.D)/D -> c/b/(C.D)/END",
    ];
    assert_eq!(transitions, expected);
    readable("compact", &compact);
    let size =
        |svg: &str| svg.split('"').filter_map(|part| part.parse::<f64>().ok()).take(2).product::<f64>();
    assert!(size(&to_svg(&compact)) < 0.6 * size(&to_svg(&chart("c", WRAPPED))));
}

/// A wrapper with expressions of its own is kept.
#[test]
fn boxes_with_something_of_their_own_stay() {
    for (from, to) in [
        ("START -> A~||b\n", "START -> A~||b : [ready]\n"),
        ("A~||b -> c/END : [false]", "A~||b -> c/END : [done]"),
        ("A~||b -> c/END : [false]", "A~||b -> A~||b : again"),
    ] {
        let compact = compact(&chart("c", &WRAPPED.replace(from, to)));
        assert_eq!(compact.node(Statechart::ROOT).kind, NodeKind::Or, "{to}");
        assert!(compact.nodes().any(|(_, node)| node.name == "A~||b"), "{to}");
    }
}

#[test]
fn transitions_between_the_same_states_are_lines_of_their_own() {
    let text = "START\nA BASIC\nEND\nSTART -> A\nA -> c/END : [x]\nA -> c/END : [y]\nA -> c/END : [z]\n";
    let chart = chart("c", text);
    readable("parallel", &chart);
    let lines = lines(&roxmltree::Document::parse(&to_svg(&chart)).unwrap());
    for (index, line) in lines.iter().enumerate() {
        assert!(!lines[index + 1..].contains(line), "{line:?} is drawn twice");
    }
}

/// Small regions stand beside a large one instead of below.
#[test]
fn regions_are_placed_where_the_drawing_is_smallest() {
    let mut text = String::from("START\nall AND\n");
    for name in ["a", "b", "c"] {
        text += &format!("  {name} OR\n    START\n    {name}1 BASIC\n");
    }
    text += "  large OR\n    START\n";
    (0..12).for_each(|number| text += &format!("    L{number} BASIC\n"));
    text += "START -> all\n";
    for name in ["a", "b", "c"] {
        text += &format!("{name}/START -> {name}1\n");
    }
    text += "large/START -> L0\n";
    (0..11).for_each(|number| text += &format!("L{number} -> L{}\n", number + 1));
    let chart = chart("r", &text);
    readable("regions", &chart);
    let svg = to_svg(&chart);
    let numbers: Vec<f64> = svg.split('"').filter_map(|part| part.parse().ok()).take(2).collect();
    // the small regions add nothing to the height of the large one
    let alone = {
        let (from, to) = (text.find("  a OR").unwrap(), text.find("  large OR").unwrap());
        let text = format!("{}{}", &text[..from], &text[to..]);
        let lines = text.lines().filter(|line| !["a/", "b/", "c/"].iter().any(|name| line.starts_with(name)));
        to_svg(&super::text::chart("r", &lines.map(|line| format!("{line}\n")).collect::<String>()))
    };
    let height = alone.split('"').filter_map(|part| part.parse::<f64>().ok()).nth(1).unwrap();
    assert_eq!(numbers[1], height);
    assert!(numbers[0] < height, "{numbers:?}");
}

#[test]
fn pictures_have_the_numbers_of_the_whole_chart() {
    let whole = chart("c", WRAPPED);
    let active = whole.find("A~||b/1/A~/A").unwrap();
    let picture: serde_json::Value = serde_json::from_str(&to_picture(&whole, &[active])).unwrap();
    assert_eq!(picture["active"], serde_json::json!([active.0]));
    let nodes = picture["nodes"].as_array().unwrap();
    assert_eq!(nodes.len(), whole.nodes().len());
    for (id, node) in whole.nodes() {
        let drawn = &nodes[id.0 as usize];
        assert_eq!(drawn["kind"], kind_word(node.kind));
        assert_eq!(drawn["parent"].as_u64(), node.parent.map(|parent| parent.0.into()));
    }
    let shape = |path: &str| &nodes[whole.find(path).unwrap().0 as usize]["shape"];
    assert_eq!(shape("A~||b/1/A~/A")["lines"], serde_json::json!(["A"]));
    // composites are folded into what is around them, or shown without a term as their title
    assert!(shape("A~||b").is_null());
    assert_eq!(shape("A~||b/2/b/(C.D)")["lines"], serde_json::json!([]));
    // arrows have the numbers and ends of the chart's transitions; those never taken are not drawn
    let (repeat, _) = whole.transitions().find(|(_, it)| it.expression.to_string() == "tick").unwrap();
    let arrow = picture["arrows"].as_array().unwrap().iter().find(|arrow| arrow["id"] == repeat.0).unwrap();
    assert_eq!(
        (&arrow["source"], &arrow["lines"]),
        (&serde_json::json!(active.0), &serde_json::json!(["tick"]))
    );
    let never = whole.transitions().filter(|(_, it)| it.expression.is_never());
    for (id, _) in never {
        assert!(!picture["arrows"].as_array().unwrap().iter().any(|arrow| arrow["id"] == id.0));
    }
    assert_eq!(picture["transitions"].as_array().unwrap().len(), whole.transitions().len());
}
