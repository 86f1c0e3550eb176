//! Differences between two charts: states, transitions, expressions and constants, not lines of
//! text.
//!
//! States are matched by position and name, so a label that changed because a state was inserted
//! before it is not a difference. A composite whose formula was edited has another name but is
//! matched with the old one; a state that disappeared in one place and appeared in another has
//! moved. Transitions are the same if they connect the same states.
//!
//! ```
//! let chart = |text: &str| aseme_models::statechart_of(&yase::Source::new("r.srm", text)).0;
//! let before = chart("r = look . (turn | walk)");
//! let after = chart("Role: r\nLiveness:\nr = boot . look . (turn | walk)\nTransitions:\nCONDITION -> walk : [Ball.found]");
//! let said: Vec<String> = aseme_models::diff::diff(&before, &after).changes.iter().map(ToString::to_string).collect();
//! assert_eq!(said, [
//!     "+ state `boot` (BASIC)",
//!     "> transition `START -> boot`, was `START -> look`",
//!     "+ transition `boot -> look`",
//!     "~ transition `CONDITION -> walk`: nothing, now `[Ball.found]`",
//! ]);
//! ```

mod drawing;
pub(crate) mod pairs;

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::fmt;

use yase::statechart::ConstantValue;
use yase::{Element, NodeId, NodeKind, Statechart, Transition, TransitionId};
use yase_export::notation::{kind_word, modifiers, refinements};

use aseme::path;
use pairs::NodePairs;

pub use drawing::{DiffDrawing, picture};

/// The kind of a change.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum ChangeKind {
    /// It is new.
    Added,
    /// Removed.
    Removed,
    /// It has another parent or name, or connects other states.
    Moved,
    /// Changed in content.
    Changed,
}

impl ChangeKind {
    /// Its name in reports.
    pub const fn word(self) -> &'static str {
        match self {
            ChangeKind::Added => "added",
            ChangeKind::Removed => "removed",
            ChangeKind::Moved => "moved",
            ChangeKind::Changed => "changed",
        }
    }

    const fn sign(self) -> char {
        match self {
            ChangeKind::Added => '+',
            ChangeKind::Removed => '-',
            ChangeKind::Moved => '>',
            ChangeKind::Changed => '~',
        }
    }
}

/// The kind of a changed part.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
#[non_exhaustive]
pub enum ChangedPart {
    /// A state or a connector.
    State,
    /// A transition.
    Transition,
    /// The selection order of the transitions out of a state, or the order of regions.
    Order,
    /// A constant.
    Constant,
}

impl ChangedPart {
    /// Its name in reports.
    pub const fn word(self) -> &'static str {
        match self {
            ChangedPart::State => "state",
            ChangedPart::Transition => "transition",
            ChangedPart::Order => "order",
            ChangedPart::Constant => "constant",
        }
    }
}

/// One difference.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct ChartChange {
    /// The kind of the change.
    pub kind: ChangeKind,
    /// The changed part.
    pub part: ChangedPart,
    /// Its shortest path: in the later chart, or in the earlier one if it was removed.
    pub name: String,
    /// Its earlier content, or its earlier name if it has moved.
    pub before: String,
    /// Its later content.
    pub after: String,
    /// The element of the later chart, or of the earlier one if it was removed.
    element: Option<Element>,
}

impl fmt::Display for ChartChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} `{}`", self.kind.sign(), self.part.word(), self.name)?;
        let said = |text: &str| if text.is_empty() { "nothing".into() } else { format!("`{text}`") };
        match (self.kind, self.part) {
            (ChangeKind::Moved, _) => write!(f, ", was `{}`", self.before),
            (ChangeKind::Changed, _) => write!(f, ": {}, now {}", said(&self.before), said(&self.after)),
            (_, ChangedPart::State) => write!(f, " ({}{})", self.before, self.after),
            _ if self.before.is_empty() && self.after.is_empty() => Ok(()),
            _ => write!(f, ": `{}{}`", self.before, self.after),
        }
    }
}

/// The difference of two charts.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct ChartDifference {
    /// The differences: states in the order of the later chart, removed states, transitions,
    /// orders, constants.
    pub changes: Vec<ChartChange>,
    pairs: NodePairs,
}

impl ChartDifference {
    /// Whether the charts are equal in meaning.
    pub fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }
}

/// Compares two charts.
pub fn diff(before: &Statechart, after: &Statechart) -> ChartDifference {
    let pairs = NodePairs::between(before, after);
    let mut comparison = ChartComparison { before, after, pairs: &pairs, changes: Vec::new() };
    comparison.states();
    let transitions = comparison.transitions();
    comparison.orders(&transitions);
    comparison.constants();
    let changes = comparison.changes;
    ChartDifference { changes, pairs }
}

struct ChartComparison<'a> {
    before: &'a Statechart,
    after: &'a Statechart,
    pairs: &'a NodePairs,
    changes: Vec<ChartChange>,
}

impl ChartComparison<'_> {
    fn push_change(
        &mut self,
        kind: ChangeKind,
        (part, element): (ChangedPart, Option<Element>),
        name: String,
        before: String,
        after: String,
    ) {
        self.changes.push(ChartChange { kind, part, name, before, after, element });
    }

    fn states(&mut self) {
        for (id, node) in self.after.nodes() {
            let (part, word) =
                ((ChangedPart::State, Some(Element::Node(id))), kind_word(node.kind).to_owned());
            match self.pairs.earlier(id) {
                None => {
                    let name = path::shortest_path(self.after, id);
                    self.push_change(ChangeKind::Added, part, name, String::new(), word);
                    self.compare_state(id, None);
                }
                Some(old) => {
                    self.moved(old, id);
                    self.compare_state(id, Some(old));
                }
            }
        }
        let gone: Vec<NodeId> =
            self.before.nodes().map(|(id, _)| id).filter(|&id| self.pairs.later(id).is_none()).collect();
        for id in gone {
            let word = kind_word(self.before.node(id).kind).to_owned();
            let name = path::shortest_path(self.before, id);
            let part = (ChangedPart::State, Some(Element::Node(id)));
            self.push_change(ChangeKind::Removed, part, name, word, String::new());
        }
    }

    fn moved(&mut self, old: NodeId, new: NodeId) {
        let (earlier, later) = (self.before.node(old), self.after.node(new));
        let parent = earlier.parent.map(|parent| self.pairs.later(parent));
        if earlier.name != later.name || parent != later.parent.map(Some) {
            let names = (path::shortest_path(self.after, new), path::shortest_path(self.before, old));
            // a moved state may have the same shortest path in both charts
            let names = match names.0 == names.1 {
                true => (self.after.path(new), self.before.path(old)),
                false => names,
            };
            let part = (ChangedPart::State, Some(Element::Node(new)));
            self.push_change(ChangeKind::Moved, part, names.0, names.1, String::new());
        }
    }

    /// Compares the attributes of a state except its name.
    fn compare_state(&mut self, new: NodeId, old: Option<NodeId>) {
        let said = |chart: &Statechart, id: NodeId| {
            let mut said = refinements(chart.node(id));
            // the default activity follows the name, so that its change is not a separate
            // difference
            said.retain(|line| !line.starts_with("activity = "));
            said.extend(own_activity(chart, id));
            said
        };
        let before = old.map_or(Vec::new(), |old| said(self.before, old));
        let after = said(self.after, new);
        let mut pairs: Vec<(String, String)> = Vec::new();
        let kinds = old.map(|old| (self.before.node(old).kind, self.after.node(new).kind));
        if let Some((earlier, later)) = kinds.filter(|(earlier, later)| earlier != later) {
            pairs.push((kind_word(earlier).into(), kind_word(later).into()));
        }
        let key = |line: &str| line.split(" = ").next().unwrap_or_default().to_owned();
        let of = |lines: &[String], wanted: &str| {
            lines.iter().find(|line| key(line) == wanted).cloned().unwrap_or_default()
        };
        let mut keys: Vec<String> = before.iter().chain(&after).map(|line| key(line)).collect();
        keys.sort_unstable();
        keys.dedup();
        pairs.extend(keys.iter().map(|key| (of(&before, key), of(&after, key))));
        for (before, after) in pairs.into_iter().filter(|(before, after)| before != after) {
            let name = path::shortest_path(self.after, new);
            self.push_change(
                ChangeKind::Changed,
                (ChangedPart::State, Some(Element::Node(new))),
                name,
                before,
                after,
            );
        }
    }

    /// Records differences of transitions and returns the earlier transition of each later one.
    fn transitions(&mut self) -> BTreeMap<TransitionId, TransitionId> {
        let mut by_ends: BTreeMap<(NodeId, NodeId), Vec<TransitionId>> = BTreeMap::new();
        for (id, transition) in self.before.transitions() {
            if let Some(ends) = self.ends_later(transition) {
                by_ends.entry(ends).or_default().push(id);
            }
        }
        by_ends.values_mut().for_each(|ids| ids.reverse());
        let mut same = BTreeMap::new();
        let mut new = Vec::new();
        for (id, transition) in self.after.transitions() {
            match by_ends.get_mut(&(transition.source, transition.target)).and_then(Vec::pop) {
                Some(old) => drop(same.insert(id, old)),
                None => new.push(id),
            }
        }
        let kept: std::collections::BTreeSet<TransitionId> = same.values().copied().collect();
        let mut gone: Vec<TransitionId> =
            self.before.transitions().map(|(id, _)| id).filter(|id| !kept.contains(id)).collect();
        for (id, _) in self.after.transitions() {
            match same.get(&id) {
                Some(&old) => self.changed(old, id),
                None if new.contains(&id) => self.new_transition(id, &mut gone),
                None => {}
            }
        }
        for id in gone {
            let name = path::shortest_transition(self.before, id);
            let part = (ChangedPart::Transition, Some(Element::Transition(id)));
            self.push_change(
                ChangeKind::Removed,
                part,
                name,
                transition_text(self.before.transition(id)),
                String::new(),
            );
        }
        same
    }

    fn ends_later(&self, transition: &Transition) -> Option<(NodeId, NodeId)> {
        Some((self.pairs.later(transition.source)?, self.pairs.later(transition.target)?))
    }

    fn changed(&mut self, old: TransitionId, new: TransitionId) {
        let (before, after) =
            (transition_text(self.before.transition(old)), transition_text(self.after.transition(new)));
        if before != after {
            let name = path::shortest_transition(self.after, new);
            let part = (ChangedPart::Transition, Some(Element::Transition(new)));
            self.push_change(ChangeKind::Changed, part, name, before, after);
        }
    }

    /// Records a transition as moved if it shares source or target and content with a removed one,
    /// otherwise as added.
    fn new_transition(&mut self, id: TransitionId, gone: &mut Vec<TransitionId>) {
        let transition = self.after.transition(id);
        let (name, text) = (path::shortest_transition(self.after, id), transition_text(transition));
        let goes_on = |&old: &TransitionId| {
            let earlier = self.before.transition(old);
            let source = self.pairs.later(earlier.source) == Some(transition.source);
            let target = self.pairs.later(earlier.target) == Some(transition.target);
            transition_text(earlier) == text && (source || (target && !text.is_empty()))
        };
        let part = (ChangedPart::Transition, Some(Element::Transition(id)));
        match gone.iter().position(goes_on) {
            Some(index) => {
                let was = path::shortest_transition(self.before, gone.remove(index));
                self.push_change(ChangeKind::Moved, part, name, was, String::new());
            }
            None => self.push_change(ChangeKind::Added, part, name, String::new(), text),
        }
    }

    /// Compares the orders of transitions and regions that both charts have.
    fn orders(&mut self, same: &BTreeMap<TransitionId, TransitionId>) {
        let mut by_source: BTreeMap<NodeId, Vec<TransitionId>> = BTreeMap::new();
        for (&id, &old) in same {
            let (earlier, later) = (self.before.transition(old), self.after.transition(id));
            if transition_text(earlier) == transition_text(later) {
                by_source.entry(later.source).or_default().push(id);
            }
        }
        for (node, ids) in by_source {
            let tried = |chart: &Statechart, of: &dyn Fn(TransitionId) -> TransitionId| {
                let mut order = ids.clone();
                order.sort_by_key(|&id| rank(chart, of(id)));
                order
            };
            let (was, is) = (tried(self.before, &|id| same[&id]), tried(self.after, &|id| id));
            let name = |ids: Vec<TransitionId>| {
                let targets =
                    ids.iter().map(|&id| path::shortest_path(self.after, self.after.transition(id).target));
                targets.collect::<Vec<_>>().join(", ")
            };
            if was != is {
                self.order(node, name(was), name(is));
            }
        }
        let ands: Vec<NodeId> =
            self.after.nodes().filter(|(_, node)| node.kind == NodeKind::And).map(|(id, _)| id).collect();
        for and in ands {
            let is: Vec<NodeId> = self
                .after
                .children(and)
                .iter()
                .copied()
                .filter(|&id| self.pairs.earlier(id).is_some())
                .collect();
            let mut was = is.clone();
            was.sort_by_key(|&id| self.pairs.earlier(id));
            let name = |ids: Vec<NodeId>| {
                let names = ids.iter().map(|&id| pairs::key(self.after, id));
                names.collect::<Vec<_>>().join(", ")
            };
            if was != is {
                self.order(and, name(was), name(is));
            }
        }
    }

    fn order(&mut self, node: NodeId, was: String, is: String) {
        let name = path::shortest_path(self.after, node);
        self.push_change(ChangeKind::Changed, (ChangedPart::Order, Some(Element::Node(node))), name, was, is);
    }

    fn constants(&mut self) {
        let table = |chart: &Statechart| -> BTreeMap<String, String> {
            let entry = |it: &yase::statechart::Constant| (it.name.clone(), value(&it.value));
            chart.constants.iter().map(entry).collect()
        };
        let (before, after) = (table(self.before), table(self.after));
        let mut names: Vec<&String> = before.keys().chain(after.keys()).collect();
        names.sort_unstable();
        names.dedup();
        for name in names {
            let (was, is) = (before.get(name), after.get(name));
            let kind = match (was, is) {
                (None, _) => ChangeKind::Added,
                (_, None) => ChangeKind::Removed,
                (Some(was), Some(is)) if was == is => continue,
                _ => ChangeKind::Changed,
            };
            let text = |value: Option<&String>| value.cloned().unwrap_or_default();
            self.push_change(kind, (ChangedPart::Constant, None), name.clone(), text(was), text(is));
        }
    }
}

/// The activity of a state if it differs from its name.
fn own_activity(chart: &Statechart, id: NodeId) -> Option<String> {
    let node = chart.node(id);
    match (&node.activity, node.kind) {
        (None, NodeKind::Basic) => Some("activity = none".into()),
        (Some(activity), _) if *activity != node.name => Some(format!("activity = {activity}")),
        _ => None,
    }
}

/// The text of a transition.
fn transition_text(transition: &Transition) -> String {
    let text = format!("{} {}", modifiers(transition), transition.expression);
    text.trim().to_owned()
}

/// The sort key of the selection order of a state's transitions.
fn rank(chart: &Statechart, id: TransitionId) -> (Reverse<i32>, bool, TransitionId) {
    let transition = chart.transition(id);
    (Reverse(transition.priority), transition.expression.guard.is_none(), id)
}

fn value(value: &ConstantValue) -> String {
    match value {
        ConstantValue::Bool(value) => value.to_string(),
        ConstantValue::Number(value) => value.to_string(),
        ConstantValue::Text(text) => format!("{text:?}"),
    }
}
