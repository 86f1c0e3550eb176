//! The refinements of a model as entries of a role.

use yase::statechart::ConstantValue;
use yase::{NodeId, NodeKind, Statechart, Transition, TransitionId};
use yase_export::notation::{modifiers, refinements};

use aseme::layout::{BENDS_KEY, bends_text, frame_settings};
use aseme::path;
use aseme::refine::index_among_twins;
use aseme::srm::{Section, SrmFile};
use aseme::text;

/// The sections that are transferred from one model to another, in this order.
pub(crate) const TRANSFERRED_SECTIONS: [Section; 4] =
    [Section::Constants, Section::Transitions, Section::States, Section::Layout];

/// The entries of a role, each on one line, without comments.
pub fn entries_of_role(file: &SrmFile) -> Vec<(Section, String)> {
    let blanked = text::without_comments(file.text());
    let of_section = |section: Section| file.entries().iter().filter(move |entry| entry.section == section);
    let entries = TRANSFERRED_SECTIONS.into_iter().flat_map(of_section);
    entries.map(|entry| (entry.section, text::one_line(&blanked[entry.span.start..entry.span.end]))).collect()
}

/// The refinements of a chart: everything that its formulas do not define, each with its shortest
/// path.
pub fn entries_of_chart(chart: &Statechart) -> Vec<(Section, String)> {
    let constants = chart.constants.iter().map(|constant| {
        let value = match &constant.value {
            ConstantValue::Bool(value) => value.to_string(),
            ConstantValue::Number(value) => value.to_string(),
            ConstantValue::Text(text) => crate::document::quoted(text),
        };
        (Section::Constants, format!("{} = {value}", constant.name))
    });
    let transitions = chart.transitions().filter(|(_, it)| has_content(it));
    let transitions = transitions.map(|(id, it)| (Section::Transitions, transition(chart, id, it)));
    let states = chart.nodes().filter_map(|(id, _)| state(chart, id));
    let states = states.map(|line| (Section::States, line));
    let layout = layout(chart).map(|line| (Section::Layout, line));
    constants.chain(transitions).chain(states).chain(layout).collect()
}

fn has_content(transition: &Transition) -> bool {
    !transition.expression.is_empty() || !modifiers(transition).is_empty()
}

fn transition(chart: &Statechart, id: TransitionId, transition: &Transition) -> String {
    let path = ends(chart, id);
    let colon = if transition.expression.is_empty() {
        String::new()
    } else {
        format!(" : {}", transition.expression)
    };
    let also = if index_among_twins(chart, id) > 0 { " also" } else { "" };
    text::one_line(&format!("{path}{also}{}{colon}", modifiers(transition)))
}

/// `source -> target`. A transition to a HISTORY is written in a role as one to its composite.
fn ends(chart: &Statechart, id: TransitionId) -> String {
    let transition = chart.transition(id);
    match history_of(chart, transition.target) {
        Some(owner) => {
            let (source, target) =
                (path::shortest_path(chart, transition.source), path::shortest_path(chart, owner));
            format!("{source} -> {target}")
        }
        None => path::shortest_transition(chart, id),
    }
}

/// The layout entries of a chart.
fn layout(chart: &Statechart) -> impl Iterator<Item = String> {
    let states = chart.layout.frames.iter().filter(|(_, frame)| !frame.is_empty()).map(|(&id, frame)| {
        let settings = frame_settings(frame).into_iter().map(|(key, value)| format!("{key} = {value}"));
        format!("{} : {}", path::shortest_path(chart, id), settings.collect::<Vec<_>>().join(", "))
    });
    let transitions = chart.layout.bends.iter().filter(|(_, bends)| !bends.is_empty()).map(|(&id, bends)| {
        let also = match index_among_twins(chart, id) {
            0 => String::new(),
            1 => " also".into(),
            number => format!(" also {number}"),
        };
        format!("{}{also} : {BENDS_KEY} = {}", ends(chart, id), bends_text(bends))
    });
    states.chain(transitions)
}

fn history_of(chart: &Statechart, id: NodeId) -> Option<NodeId> {
    let is_history = matches!(chart.node(id).kind, NodeKind::ShallowHistory | NodeKind::DeepHistory);
    chart.node(id).parent.filter(|_| is_history)
}

fn state(chart: &Statechart, id: NodeId) -> Option<String> {
    let node = chart.node(id);
    let is_idle = node.kind == NodeKind::Basic && node.activity.is_none();
    let mut said: Vec<String> = is_idle.then(|| "activity = \"\"".to_owned()).into_iter().collect();
    said.extend(refinements(node));
    let histories = chart.children(id).iter().filter_map(|&child| match chart.node(child).kind {
        NodeKind::ShallowHistory => Some("history = shallow".to_owned()),
        NodeKind::DeepHistory => Some("history = deep".to_owned()),
        _ => None,
    });
    said.extend(histories);
    (!said.is_empty())
        .then(|| text::one_line(&format!("{} : {}", path::shortest_path(chart, id), said.join(", "))))
}

/// The text of a role with lines added at the end of a section, which is created if it is missing.
pub(crate) fn inserted(text: &str, section: Section, lines: &[&str]) -> String {
    if lines.is_empty() {
        return text.to_owned();
    }
    let (file, _) = SrmFile::parse(text);
    let block = lines.join("\n");
    let last = file.entries().iter().rfind(|entry| entry.section == section);
    if let Some(last) = last {
        // after the comment on the same line
        let end = text[last.span.end..].find('\n').map_or(text.len(), |at| last.span.end + at);
        return format!("{}\n{block}{}", &text[..end], &text[end..]);
    }
    let blanked = text::without_comments(text);
    let header = format!("{}:", section.word());
    let mut start = 0;
    for line in blanked.split_inclusive('\n') {
        let end = start + line.len();
        if line.trim() == header {
            let gap = if line.ends_with('\n') { "" } else { "\n" };
            return format!("{}{gap}{block}\n{}", &text[..end], &text[end..]);
        }
        start = end;
    }
    let is_bare =
        !file.entries().iter().any(|entry| entry.section == Section::Role) && !blanked.contains("Liveness:");
    let text =
        if is_bare { format!("Role: {}\nLiveness:\n{text}", file.srm().role) } else { text.to_owned() };
    let gap = if text.ends_with('\n') { "" } else { "\n" };
    format!("{text}{gap}\n{header}\n{block}\n")
}
