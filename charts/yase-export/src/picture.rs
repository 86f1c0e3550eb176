//! The shapes of a compact drawing as JSON, for viewers that show a running chart.

use std::collections::BTreeSet;

use yase::expression::{Path, Trigger};
use yase::statechart::{NodeId, NodeKind, Point, StateNames, Statechart};

use crate::compact::CompactChart;
use crate::highlights::Highlights;
use crate::json::JsonValue;
use crate::notation::{depth_first, kind_word};
use crate::outline::is_region;
use crate::svg::layout;

/// The compact drawing of a chart as a JSON object, with the numbers that records of runs use.
///
/// - `name`, `width`, `height`: the chart and the size of the drawing in pixels.
/// - `nodes`: every node of the chart by its number: `kind`, `name` (see
///   [`StateNames`]), `parent`, `activity` (null if none), and `shape`, null if it is not drawn:
///   `x`, `y`, `w`, `h`, the height `head` of the title, `lines` of the title and `notes` below it,
///   and whether it is a `region`.
/// - `arrows`: each drawn transition: its number `id`, `source` and `target`, `points` of its line,
///   `lines` of its label and the middle `at` of the label.
/// - `active`: the numbers of the given active nodes.
/// - `transitions`: the full text of every transition by its number, with `source` and `target`.
/// - `events`: the names in triggers, sorted: events, and messages whose arrivals are events.
///
/// Composites that are named by a term of a formula have no title: their content says it.
pub fn to_picture(chart: &Statechart, active: &[NodeId]) -> String {
    let mut compact = CompactChart::of(chart);
    let composites: Vec<NodeId> = depth_first(&compact.chart)
        .filter(|&id| matches!(compact.chart.node(id).kind, NodeKind::Or | NodeKind::And))
        .filter(|&id| !is_word(&compact.chart.node(id).name))
        .collect();
    for id in composites {
        compact.chart.node_mut(id).name.clear();
    }
    let compact = compact;
    let marks = Highlights::default();
    let layout = layout(&compact.chart, &marks);
    let names = StateNames::of(chart);
    let nodes = chart.nodes().map(|(id, node)| {
        let shape = compact.nodes.get(&id).map(|&drawn| {
            let shape = layout.shape(drawn);
            object([
                ("x", number(shape.at.0)),
                ("y", number(shape.at.1)),
                ("w", number(shape.size.0)),
                ("h", number(shape.size.1)),
                ("head", number(shape.head())),
                ("region", JsonValue::Bool(is_region(&compact.chart, drawn) || shape.title.is_empty())),
                ("lines", lines(&shape.title)),
                ("notes", lines(&shape.notes)),
            ])
        });
        object([
            ("kind", kind_word(node.kind).into()),
            ("name", names.name(id).into()),
            ("parent", node.parent.map_or(JsonValue::Null, |parent| index(parent.0))),
            ("activity", node.activity.as_deref().map_or(JsonValue::Null, JsonValue::from)),
            ("shape", shape.unwrap_or(JsonValue::Null)),
        ])
    });
    let arrows = layout.arrows.iter().filter_map(|arrow| {
        let id = *compact.transitions.get(arrow.label.transition.0 as usize)?;
        let transition = chart.transition(id);
        Some(object([
            ("id", index(id.0)),
            ("source", index(transition.source.0)),
            ("target", index(transition.target.0)),
            ("points", JsonValue::List(arrow.points.iter().copied().map(point).collect())),
            ("lines", lines(&arrow.label.lines)),
            ("at", point(arrow.label_at)),
        ]))
    });
    let transitions = chart.transitions().map(|(_, transition)| {
        object([
            ("source", index(transition.source.0)),
            ("target", index(transition.target.0)),
            ("text", transition.expression.to_string().into()),
        ])
    });
    let triggers = chart.transitions().filter_map(|(_, transition)| transition.expression.trigger.as_ref());
    let events: BTreeSet<String> = triggers.flat_map(event_names).collect();
    let (width, height) = layout.page_size(&compact.chart);
    let picture = object([
        ("name", chart.name.as_str().into()),
        ("width", number(width)),
        ("height", number(height)),
        ("active", JsonValue::List(active.iter().map(|node| index(node.0)).collect())),
        ("nodes", JsonValue::List(nodes.collect())),
        ("arrows", JsonValue::List(arrows.collect())),
        ("transitions", JsonValue::List(transitions.collect())),
        ("events", JsonValue::List(events.into_iter().map(JsonValue::from).collect())),
    ]);
    picture.to_line()
}

fn event_names(trigger: &Trigger) -> Vec<String> {
    match trigger {
        Trigger::Any => Vec::new(),
        Trigger::OneOf(paths) => paths.iter().map(Path::text).collect(),
        Trigger::Not(path) => vec![path.text()],
    }
}

/// Whether a name is a word of the role, not a term.
fn is_word(name: &str) -> bool {
    !name.is_empty() && name.chars().all(|letter| letter.is_alphanumeric() || letter == '_' || letter == '-')
}

fn object<const COUNT: usize>(entries: [(&str, JsonValue); COUNT]) -> JsonValue {
    JsonValue::Object(entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
}

fn lines(lines: &[String]) -> JsonValue {
    JsonValue::List(lines.iter().map(|line| line.as_str().into()).collect())
}

fn index(index: u32) -> JsonValue {
    JsonValue::Number(index.into())
}

/// A length, to a tenth of a pixel.
fn number(length: f64) -> JsonValue {
    JsonValue::Number((length * 10.0).round() / 10.0)
}

fn point((x, y): Point) -> JsonValue {
    JsonValue::List(vec![number(x), number(y)])
}
