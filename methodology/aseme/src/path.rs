//! Paths: references to states and transitions of a chart generated from formulas.
//!
//! A path is a sequence of state names as written in the formula, separated by `/`; the last one is
//! the state referred to: `takeAction/TrackBall`. Blanks are ignored and `ω` is `~`, as in
//! formulas. The rules:
//!
//! 1. A path may begin at any level: it matches every state whose path from the root ends with it.
//!    The shortest unique path is the usual one.
//! 2. Each name is a child of the one before it; AND states and their regions may be omitted. A
//!    region has no name and may be given by its number among the regions, from 1.
//! 3. `START`, `END` and `CONDITION` are the connectors of the state before them.
//! 4. `name[2]` is the second state of that name in its parent.
//! 5. `*` is any state, `*~` any state that repeats forever (one without END), `*||*` any AND
//!    state.

mod index;

use std::fmt;

use yase::{Diagnostic, NodeId, NodeKind, Span, Statechart, Transition, TransitionId};

use crate::text::{canonical_name, is_name_character, trimmed};

pub use index::PathIndex;

/// A way down to a state, to be found in a chart.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Path {
    segments: Vec<PatternSegment>,
}

#[derive(Clone, PartialEq, Eq, Debug)]
struct PatternSegment {
    pattern: SegmentPattern,
    occurrence: Option<usize>,
}

#[derive(Clone, PartialEq, Eq, Debug)]
enum SegmentPattern {
    Name(String),
    Connector(NodeKind),
    AnyState,
    AnyForever,
    AnyParallel,
}

/// The deepest nesting of states in a chart.
const MAX_SEGMENTS: usize = crate::liveness::MAX_LEVELS;

impl Path {
    /// Parses a path; errors are E0241.
    pub fn parse(text: &str) -> Result<Path, Diagnostic> {
        let segments =
            text.split('/').map(PatternSegment::parse).collect::<Result<Vec<PatternSegment>, String>>();
        let reason = match segments {
            Ok(segments) if segments.len() <= MAX_SEGMENTS => return Ok(Path { segments }),
            Ok(_) => format!("a path has at most {MAX_SEGMENTS} names"),
            Err(reason) => reason,
        };
        let span = trimmed(text, Span::new(0, text.len()));
        let hint =
            "a path is names of states from the formula separated by `/`, such as `takeAction/TrackBall`";
        Err(Diagnostic::error("E0241", span, reason).with_hint(hint))
    }

    /// The path relative to the state that `scope` names.
    pub fn within(&self, scope: &Path) -> Path {
        Path { segments: scope.segments.iter().chain(&self.segments).cloned().collect() }
    }

    /// Whether it may match several states on purpose.
    pub fn has_wildcard(&self) -> bool {
        let is_wildcard = |pattern: &SegmentPattern| {
            matches!(
                pattern,
                SegmentPattern::AnyState | SegmentPattern::AnyForever | SegmentPattern::AnyParallel
            )
        };
        self.segments.iter().any(|segment| is_wildcard(&segment.pattern))
    }

    /// Whether it matches a node.
    pub fn matches(&self, chart: &Statechart, node: NodeId) -> bool {
        ends_with(chart, node, &self.segments)
    }

    /// The name of the node itself, unless it is known by its kind or number.
    fn last_name(&self) -> Option<&str> {
        self.segments.last()?.pattern.name()
    }

    /// The name of the node in which a node known by its kind or number is looked for.
    fn name_around(&self) -> Option<&str> {
        let (_, before) = self.segments.split_last()?;
        before.last()?.pattern.name()
    }

    /// The number of the region in which a connector is looked for.
    fn region_around(&self) -> Option<usize> {
        let (_, before) = self.segments.split_last()?;
        match &before.last()?.pattern {
            SegmentPattern::Name(name) => name.parse().ok(),
            _ => None,
        }
    }

    /// The names in the path that no node of the chart has.
    pub fn unknown_names<'a>(&'a self, chart: &'a Statechart) -> impl Iterator<Item = &'a str> {
        let names = self.segments.iter().filter_map(|segment| match &segment.pattern {
            SegmentPattern::Name(name) => Some((segment, name.as_str())),
            _ => None,
        });
        names
            .filter(|(segment, _)| !chart.nodes().any(|(id, _)| segment.pattern.matches(chart, id)))
            .map(|(_, name)| name)
    }

    /// The last `length` names on the path to a node; `thorough` includes ANDs and regions.
    fn to(chart: &Statechart, node: NodeId, length: usize, thorough: bool) -> Path {
        let ancestors = std::iter::once(node).chain(chart.ancestors(node));
        let named = ancestors.filter(|&id| id == node || thorough || !may_be_left_out(chart, id));
        let mut segments: Vec<PatternSegment> =
            named.take(length).map(|id| PatternSegment::of(chart, id)).collect();
        segments.reverse();
        Path { segments }
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, segment) in self.segments.iter().enumerate() {
            let separator = if index > 0 { "/" } else { "" };
            write!(f, "{separator}{}", segment.pattern.text())?;
            if let Some(occurrence) = segment.occurrence {
                write!(f, "[{occurrence}]")?;
            }
        }
        Ok(())
    }
}

impl PatternSegment {
    /// Parses a segment; the error is a sentence.
    fn parse(text: &str) -> Result<PatternSegment, String> {
        let name = canonical_name(text);
        if name.is_empty() {
            return Err("a name is missing in the path".into());
        }
        let foreign = |c: &char| !is_name_character(*c) && !".|*+~()[]".contains(*c);
        if let Some(foreign) = name.chars().find(foreign) {
            return Err(format!("`{foreign}` cannot occur in a path"));
        }
        let (name, occurrence) = split_occurrence(&name);
        Ok(PatternSegment { pattern: SegmentPattern::of(name), occurrence })
    }

    /// The segment that matches a node and none of its siblings.
    fn of(chart: &Statechart, node: NodeId) -> PatternSegment {
        let pattern = match (chart.node(node).name.as_str(), chart.node(node).kind) {
            ("", NodeKind::Or) => SegmentPattern::Name(sibling_number(chart, node).to_string()),
            ("", kind) => SegmentPattern::Connector(kind),
            (name, _) => SegmentPattern::Name(name.into()),
        };
        let several = alike(chart, node, &pattern).nth(1).is_some();
        let occurrence = alike(chart, node, &pattern).position(|id| id == node).map(|index| index + 1);
        PatternSegment { pattern, occurrence: occurrence.filter(|_| several) }
    }

    fn matches(&self, chart: &Statechart, node: NodeId) -> bool {
        let fits = || match self.occurrence {
            None => true,
            Some(0) => false,
            Some(number) => alike(chart, node, &self.pattern).nth(number - 1) == Some(node),
        };
        self.pattern.matches(chart, node) && fits()
    }
}

/// Splits `name[2]` into the name and 2; `[2]` alone, or after an operator, is an optional term.
fn split_occurrence(name: &str) -> (&str, Option<usize>) {
    let split = || {
        let (before, number) = name.strip_suffix(']')?.rsplit_once('[')?;
        let number = number.parse().ok()?;
        let ends_a_term = before.ends_with(|c| is_name_character(c) || "*+~)]".contains(c));
        ends_a_term.then_some((before, Some(number)))
    };
    split().unwrap_or((name, None))
}

impl SegmentPattern {
    fn of(name: &str) -> SegmentPattern {
        match name {
            "START" => SegmentPattern::Connector(NodeKind::Start),
            "END" => SegmentPattern::Connector(NodeKind::End),
            "CONDITION" => SegmentPattern::Connector(NodeKind::Condition),
            "*" => SegmentPattern::AnyState,
            "*~" => SegmentPattern::AnyForever,
            "*||*" => SegmentPattern::AnyParallel,
            _ => SegmentPattern::Name(name.into()),
        }
    }

    /// The name that a node of this pattern has, unless it is its number.
    fn name(&self) -> Option<&str> {
        match self {
            SegmentPattern::Name(name) if !name.bytes().all(|byte| byte.is_ascii_digit()) => Some(name),
            _ => None,
        }
    }

    fn text(&self) -> &str {
        match self {
            SegmentPattern::Name(name) => name,
            SegmentPattern::Connector(NodeKind::Start) => "START",
            SegmentPattern::Connector(NodeKind::End) => "END",
            SegmentPattern::Connector(_) => "CONDITION",
            SegmentPattern::AnyState => "*",
            SegmentPattern::AnyForever => "*~",
            SegmentPattern::AnyParallel => "*||*",
        }
    }

    fn matches(&self, chart: &Statechart, id: NodeId) -> bool {
        let node = chart.node(id);
        match self {
            SegmentPattern::Name(name) if is_region(chart, id) => {
                name.parse().is_ok_and(|number: usize| number == sibling_number(chart, id))
            }
            SegmentPattern::Name(name) => node.name == *name,
            SegmentPattern::Connector(kind) => node.kind == *kind,
            SegmentPattern::AnyState => !node.name.is_empty(),
            SegmentPattern::AnyForever => !node.name.is_empty() && goes_on_forever(chart, id),
            SegmentPattern::AnyParallel => node.kind == NodeKind::And,
        }
    }
}

/// Whether the path to a node ends with these segments.
fn ends_with(chart: &Statechart, node: NodeId, segments: &[PatternSegment]) -> bool {
    let Some((last, before)) = segments.split_last() else { return true };
    if !last.matches(chart, node) {
        return false;
    }
    if before.is_empty() {
        return true;
    }
    for ancestor in chart.ancestors(node) {
        if ends_with(chart, ancestor, before) {
            return true;
        }
        if !may_be_left_out(chart, ancestor) {
            return false;
        }
    }
    false
}

fn may_be_left_out(chart: &Statechart, node: NodeId) -> bool {
    chart.node(node).kind == NodeKind::And || is_region(chart, node)
}

fn is_region(chart: &Statechart, node: NodeId) -> bool {
    chart.node(node).name.is_empty() && chart.node(node).kind == NodeKind::Or
}

fn goes_on_forever(chart: &Statechart, node: NodeId) -> bool {
    let children = chart.children(node);
    let has = |kind| children.iter().any(|&child| chart.node(child).kind == kind);
    chart.node(node).kind == NodeKind::Or && has(NodeKind::Start) && !has(NodeKind::End)
}

/// The number of a node among its siblings, from 1.
fn sibling_number(chart: &Statechart, node: NodeId) -> usize {
    siblings(chart, node).binary_search(&node).map_or(1, |index| index + 1)
}

fn siblings(chart: &Statechart, node: NodeId) -> &[NodeId] {
    chart.node(node).parent.map_or(&[], |parent| chart.children(parent))
}

/// The siblings of a node that match a pattern, including itself.
fn alike<'a>(
    chart: &'a Statechart,
    node: NodeId,
    pattern: &'a SegmentPattern,
) -> impl Iterator<Item = NodeId> + 'a {
    siblings(chart, node).iter().copied().filter(|&sibling| pattern.matches(chart, sibling))
}

/// The transitions whose source and target match two paths.
pub fn transitions<'a>(
    chart: &'a Statechart,
    source: &'a Path,
    target: &'a Path,
) -> impl Iterator<Item = TransitionId> + 'a {
    let fits = |transition: &Transition| {
        target.matches(chart, transition.target) && source.matches(chart, transition.source)
    };
    chart.transitions().filter(move |(_, transition)| fits(transition)).map(|(id, _)| id)
}

/// The shortest `path -> path` that matches one transition and no others, except those with the
/// same ends.
pub fn shortest_transition(chart: &Statechart, transition: TransitionId) -> String {
    let Transition { source, target, .. } = *chart.transition(transition);
    let longest = 1 + chart.ancestors(source).count().max(chart.ancestors(target).count());
    let paths = lengths(longest).flat_map(|(length, thorough)| {
        let path = |node, length| Path::to(chart, node, length, thorough);
        let pairs = [(length, 1), (1, length), (length, length)];
        pairs.map(|(of_source, of_target)| (path(source, of_source), path(target, of_target)))
    });
    let is_other = |id: TransitionId| {
        let other = chart.transition(id);
        (other.source, other.target) != (source, target)
    };
    let is_unique = |(from, to): &(Path, Path)| !transitions(chart, from, to).any(is_other);
    first_or_last(paths, is_unique).map_or(String::new(), |(source, target)| format!("{source} -> {target}"))
}

/// The shortest path that matches one node and no other.
pub fn shortest_path(chart: &Statechart, node: NodeId) -> String {
    let paths = lengths(1 + chart.ancestors(node).count())
        .map(|(length, thorough)| Path::to(chart, node, length, thorough));
    let is_unique = |path: &Path| chart.nodes().filter(|(id, _)| path.matches(chart, *id)).nth(1).is_none();
    first_or_last(paths, is_unique).map_or(String::new(), |path| path.to_string())
}

/// Increasing lengths of paths, first without ANDs and regions, then with them.
fn lengths(longest: usize) -> impl Iterator<Item = (usize, bool)> {
    [false, true].into_iter().flat_map(move |thorough| (1..=longest).map(move |length| (length, thorough)))
}

/// The first accepted element, or the last.
fn first_or_last<T>(things: impl Iterator<Item = T>, accepts: impl Fn(&T) -> bool) -> Option<T> {
    let mut last = None;
    for thing in things {
        if accepts(&thing) {
            return Some(thing);
        }
        last = Some(thing);
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(text: &str) -> Path {
        Path::parse(text).unwrap()
    }

    /// The chart of formulas.
    fn chart(formulas: &str) -> Statechart {
        crate::liveness_to_statechart(&crate::liveness::parse(formulas).0).0
    }

    /// The number of nodes that a path matches.
    fn count(chart: &Statechart, text: &str) -> usize {
        chart.nodes().filter(|(id, _)| path(text).matches(chart, *id)).count()
    }

    #[test]
    fn paths_print_without_blanks() {
        assert_eq!(path(" a ω / ( b | c )[2] /START").to_string(), "a~/(b|c)[2]/START");
        assert_eq!(path("[b]").to_string(), "[b]");
        assert_eq!(path("b").within(&path("a/x")).to_string(), "a/x/b");
    }

    #[test]
    fn an_option_is_no_occurrence() {
        assert_eq!(split_occurrence("a[2]"), ("a", Some(2)));
        assert_eq!(split_occurrence("[a][2]"), ("[a]", Some(2)));
        assert_eq!(split_occurrence("[2]"), ("[2]", None));
        assert_eq!(split_occurrence("a.[2]"), ("a.[2]", None));
    }

    #[test]
    fn a_path_fits_the_end_of_the_way_to_a_state() {
        let chart = chart("r = a~ || b\nb = a . c . a");
        assert_eq!(count(&chart, "a"), 3);
        assert_eq!(count(&chart, "b/a"), 2);
        assert_eq!(count(&chart, "b/a[2]"), 1);
        assert_eq!(count(&chart, "b/a[3]"), 0);
        assert_eq!(count(&chart, "r/a~/a"), 1, "the AND and its region are left out");
        assert_eq!(count(&chart, "r/a~||b/1/a~/a"), 1, "or not");
        assert_eq!(count(&chart, "r/a"), 0, "a state is never left out");
        assert_eq!(count(&chart, "r/START"), 3, "the regions' too");
        assert_eq!(count(&chart, "r/2/START"), 1);
    }

    #[test]
    fn wildcards_name_kinds_of_states() {
        let chart = chart("r = a~ || b\nb = (c.d)+ . e\ne = x~");
        assert_eq!(count(&chart, "*~"), 2, "`e` goes on forever, whatever its name");
        assert_eq!(count(&chart, "*||*"), 1);
        assert_eq!(count(&chart, "b/*"), 2);
        assert!(path("b/*").has_wildcard());
        assert!(!path("b*").has_wildcard());
    }
}
