//! Readability of drawings: nothing covers a name or leaves the page, no arrow crosses a box.

use roxmltree::{Document, Node};
use yase::{NodeKind, Statechart};
use yase_export::to_svg;

use super::golden::input;

/// Left, top, right and bottom.
pub(crate) type Area = (f64, f64, f64, f64);

fn number(node: Node<'_, '_>, name: &str) -> Option<f64> {
    node.attribute(name)?.parse().ok()
}

fn area(node: Node<'_, '_>) -> Option<Area> {
    let (x, y) = (number(node, "x")?, number(node, "y")?);
    Some((x, y, x + number(node, "width")?, y + number(node, "height")?))
}

fn of_class<'a>(document: &'a Document<'a>, class: &'a str) -> impl Iterator<Item = Node<'a, 'a>> {
    document.descendants().filter(move |node| node.attribute("class") == Some(class))
}

fn areas(document: &Document<'_>, class: &str) -> Vec<Area> {
    of_class(document, class).filter_map(area).collect()
}

/// The straight parts of all arrows, as areas without width or height.
pub(crate) fn lines(document: &Document<'_>) -> Vec<Area> {
    let mut lines = Vec::new();
    for arrow in of_class(document, "arrow").chain(of_class(document, "unused")) {
        let points = arrow.attribute("points").unwrap().split(' ');
        let points: Vec<(f64, f64)> = points
            .map(|point| point.split_once(',').unwrap())
            .map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap()))
            .collect();
        let part = |ends: &[(f64, f64)]| {
            let (a, b) = (ends[0], ends[1]);
            assert!(a.0 == b.0 || a.1 == b.1, "{a:?} to {b:?} is askew");
            (a.0.min(b.0), a.1.min(b.1), a.0.max(b.0), a.1.max(b.1))
        };
        lines.extend(points.windows(2).map(part));
    }
    lines
}

/// Whether two areas share more than a border.
fn overlap(a: &Area, b: &Area) -> bool {
    let slack = 0.2;
    a.0 + slack < b.2 && b.0 + slack < a.2 && a.1 + slack < b.3 && b.1 + slack < a.3
}

/// Whether a line runs inside an area.
fn runs_through(line: &Area, area: &Area) -> bool {
    let widened = (line.0 - 0.5, line.1 - 0.5, line.2 + 0.5, line.3 + 0.5);
    overlap(&widened, &(area.0 + 1.0, area.1 + 1.0, area.2 - 1.0, area.3 - 1.0))
}

#[track_caller]
fn check(name: &str) {
    readable(name, &input(name));
}

#[track_caller]
pub(crate) fn readable(name: &str, chart: &Statechart) {
    let svg = to_svg(chart);
    let document = Document::parse(&svg).unwrap();
    let labels = areas(&document, "ground");
    let boxes: Vec<Area> =
        ["basic", "head", "and-head"].iter().flat_map(|class| areas(&document, class)).collect();
    for (index, label) in labels.iter().enumerate() {
        let on_it = labels[index + 1..].iter().chain(&boxes).find(|other| overlap(label, other));
        assert_eq!(on_it, None, "{name}: on the label at {label:?}");
    }
    for line in lines(&document) {
        let through = boxes.iter().find(|area| runs_through(&line, area));
        assert_eq!(through, None, "{name}: the line {line:?} runs through it");
    }
    let root = document.root_element();
    let page = (0.0, 0.0, number(root, "width").unwrap(), number(root, "height").unwrap());
    let inside = |it: &Area| it.0 >= page.0 && it.1 >= page.1 && it.2 <= page.2 && it.3 <= page.3;
    assert!(labels.iter().chain(&boxes).all(inside), "{name}: everything is on the page");
    let written = chart.transitions().filter(|(_, it)| !it.expression.is_empty() || it.weight.is_some());
    assert_eq!(labels.len(), written.count(), "{name}: every expression is written");
}

#[test]
fn charts_can_be_read() {
    ["toggle", "regions", "activities", "kinds", "names"].into_iter().for_each(check);
}

#[test]
fn every_kind_has_its_sign() {
    let chart = input("kinds");
    let svg = to_svg(&chart);
    let document = Document::parse(&svg).unwrap();
    let count = |kinds: &[NodeKind]| chart.nodes().filter(|(_, node)| kinds.contains(&node.kind)).count();
    let circles =
        |radius: &str| document.descendants().filter(|node| node.attribute("r") == Some(radius)).count();
    assert_eq!(circles("7"), count(&[NodeKind::Start]));
    assert_eq!(circles("9"), count(&[NodeKind::End]));
    assert_eq!(circles("6"), count(&[NodeKind::Junction]));
    assert_eq!(circles("8"), count(&[NodeKind::EntryPoint, NodeKind::ExitPoint]));
    let lettered = [NodeKind::Condition, NodeKind::ShallowHistory, NodeKind::DeepHistory];
    assert_eq!(circles("10"), count(&lettered));
    let crosses = of_class(&document, "cross").count();
    assert_eq!(crosses, count(&[NodeKind::Terminate, NodeKind::ExitPoint]));
    let diamonds = of_class(&document, "connector").filter(|node| node.has_tag_name("path")).count();
    assert_eq!(diamonds, count(&[NodeKind::Choice]));
    let bars = of_class(&document, "dot").filter(|node| node.has_tag_name("rect")).count();
    assert_eq!(bars, count(&[NodeKind::Fork, NodeKind::Join]));
    let letters: Vec<&str> = document.descendants().filter_map(|node| node.text()).collect();
    for (_, node) in chart.nodes().filter(|(_, node)| !node.name.is_empty()) {
        assert!(letters.contains(&node.name.as_str()), "{}", node.name);
    }
}

#[test]
fn a_transition_between_nodes_that_do_not_exist_is_not_drawn() {
    let mut chart = Statechart::new("c");
    let nowhere = yase::NodeId(7);
    chart.connect(yase::Transition::new(Statechart::ROOT, nowhere));
    assert!(!to_svg(&chart).contains("polyline"));
}
