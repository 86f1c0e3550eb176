//! Drawings are legible: nothing overlaps a label or leaves the page.

use roxmltree::{Document, Node};
use yase::Source;

/// Left, top, right and bottom.
type Area = (f64, f64, f64, f64);

fn area(node: Node<'_, '_>) -> Option<Area> {
    let number = |name| node.attribute(name)?.parse::<f64>().ok();
    let (x, y) = (number("x")?, number("y")?);
    Some((x, y, x + number("width")?, y + number("height")?))
}

fn areas(document: &Document<'_>, class: &str) -> Vec<Area> {
    let nodes = document.descendants().filter(|node| node.attribute("class") == Some(class));
    nodes.filter_map(area).collect()
}

/// Whether two areas share more than a border.
fn overlap(a: &Area, b: &Area) -> bool {
    let slack = 0.2;
    a.0 + slack < b.2 && b.0 + slack < a.2 && a.1 + slack < b.3 && b.1 + slack < a.3
}

fn check(name: &str, text: &str) {
    let (chart, findings) = aseme::statechart_of_role(&Source::new(name, text));
    assert_eq!(findings, []);
    let svg = yase_export::to_svg(&chart);
    let document = Document::parse(&svg).expect("well-formed");
    let labels = areas(&document, "ground");
    let written = chart
        .transitions()
        .filter(|(_, transition)| !transition.expression.is_empty() || transition.priority != 0)
        .count();
    assert_eq!(labels.len(), written, "{name}: every expression is written");
    let boxes: Vec<Area> =
        ["basic", "head", "and-head"].iter().flat_map(|class| areas(&document, class)).collect();
    for (index, label) in labels.iter().enumerate() {
        let others = labels[index + 1..].iter().chain(&boxes);
        assert_eq!(
            others.filter(|other| overlap(label, other)).count(),
            0,
            "{name}: something lies on the label at {label:?}"
        );
    }
    let number = |name| document.root_element().attribute(name).and_then(|value| value.parse::<f64>().ok());
    let page = (0.0, 0.0, number("width").expect("a width"), number("height").expect("a height"));
    let inside = |area: &Area| area.0 >= page.0 && area.1 >= page.1 && area.2 <= page.2 && area.3 <= page.3;
    assert!(labels.iter().chain(&boxes).all(inside), "{name}: everything is on the page");
    assert!(page.2 <= 2700.0, "{name}: {} pixels wide", page.2);
}

fn model(name: &str) -> String {
    let models = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    std::fs::read_to_string(models.join(name)).expect("a model")
}

#[test]
fn the_models_can_be_read() {
    for name in ["goalie.srm", "attacker.srm"] {
        check(name, &model(name));
    }
}

#[test]
fn every_operator_can_be_read() {
    let text = "\
Liveness:
r = a* . (b . c)+ . [d] . |(e.f)~|2 . g~ . (h | i | (j || k))
Transitions:
a*: CONDITION -> END : [Ball.distance > 0.3 && Ball.found && GameState.player_state == PLAYING]
a*: CONDITION -> a : [Ball.distance > 0.3 && Ball.found && GameState.player_state == PLAYING]
a -> a !2 : [x_timeout && Ball.distance > 0.3 && Ball.found] / StartTimeout(x_timeout, 100ms), publish_all
a -> END : [a_quite_long_name_of_a_flag_that_cannot_be_broken_into_lines]
b -> c : kicked [Ball.found] / raise(go)
CONDITION -> h : [one]
CONDITION -> i : [two_is_longer_than_its_state_is_wide]
h -> END : [three_is_longer_than_its_state_is_wide]
i -> END : [four_is_longer_than_its_state_is_wide]
*~ -> END : [false]
States:
a : priority = 3, entry = StartTimeout(t, 100ms)
b : activity = Other
";
    let text = text.replace("*~ -> END", "g~ -> (h|i|(j||k))");
    check("operators", &text);
}

#[test]
fn names_are_written_as_in_the_formula() {
    let (chart, _) = aseme::statechart_of_role(&Source::new("r", "r = a~ || (b . [c])"));
    let svg = yase_export::to_svg(&chart);
    for name in [">aω || (b . [c])<", ">aω<", ">(b . [c])<", ">[c]<", ">C<"] {
        assert!(svg.contains(name), "{name}");
    }
    assert!(!svg.contains("_forever_"));
}
