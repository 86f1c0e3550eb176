//! Short names of states, for people.

use std::collections::{BTreeMap, BTreeSet};

use super::{NodeId, Statechart};

/// The short names of the nodes of a chart: unique in the chart, and the same as long as the names
/// around a node stay the same.
///
/// A chart that is made from formulas names its composites by whole terms, so that their
/// [paths](Statechart::path) can be very long. A short name consists of the words of the role:
///
/// - A state whose name is a word is named by the word of the innermost named composite around it
///   and its own, as `decision/SearchBall`; by its own alone if there is none.
/// - Every other node is named by the node around it and a label of its own: the kind of a
///   connector (`decision/START`), a term of one word (`active/Sensors~`), or a number among its
///   siblings (`decision/2`).
/// - States that would share a name get the words of composites further out, and at last a number:
///   `walk/Step`, `walk/Step#2`.
///
/// ```
/// use yase::statechart::StateNames;
///
/// let names = StateNames::from_paths([
///     "player",
///     "player/active",
///     "player/active/decision~",
///     "player/active/decision~/decision",
///     "player/active/decision~/decision/(SearchBall|takeAction)",
///     "player/active/decision~/decision/(SearchBall|takeAction)/SearchBall",
///     "player/active/decision~/decision/(SearchBall|takeAction)/START",
/// ]);
/// assert_eq!(names.short("player/active/decision~/decision/(SearchBall|takeAction)/SearchBall"), "decision/SearchBall");
/// assert_eq!(names.iter().last(), Some("active/decision/1/START"));
/// ```
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct StateNames {
    /// By the position of a node in the chart.
    names: Vec<String>,
    /// The positions, ordered by name.
    by_name: Vec<usize>,
    tree: PathTree,
}

/// A text that names no node, or several.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{}", self.text())]
pub struct UnknownState {
    name: String,
    candidates: Vec<String>,
}

impl UnknownState {
    /// The short names that the text fits, if it fits several.
    pub fn candidates(&self) -> &[String] {
        &self.candidates
    }

    fn text(&self) -> String {
        match self.candidates.as_slice() {
            [] => format!("there is no state `{}`", self.name),
            several => format!("`{}` is ambiguous: `{}`", self.name, several.join("`, `")),
        }
    }
}

impl StateNames {
    /// The names of a chart's nodes.
    pub fn of(chart: &Statechart) -> StateNames {
        let parents = chart.nodes().map(|(_, node)| node.parent.map(|parent| parent.0 as usize)).collect();
        StateNames::from_tree(PathTree::new(parents, chart.segments()))
    }

    /// The names for the [paths](Statechart::path) of all nodes of a chart, the root first.
    pub fn from_paths(paths: impl IntoIterator<Item = impl Into<String>>) -> StateNames {
        let paths: Vec<String> = paths.into_iter().map(Into::into).collect();
        StateNames::from_tree(PathTree::from_paths(&paths))
    }

    fn from_tree(tree: PathTree) -> StateNames {
        let names = tree.names();
        let mut by_name: Vec<usize> = (0..names.len()).collect();
        by_name.sort_by(|&one, &other| names[one].cmp(&names[other]));
        StateNames { names, by_name, tree }
    }

    /// The names for some paths of a chart and the nodes around them: unique among these.
    pub fn from_some<'p>(paths: impl IntoIterator<Item = &'p str>) -> StateNames {
        let mut all: Vec<String> = Vec::new();
        let mut seen = BTreeSet::new();
        for path in paths {
            let ends = path.match_indices('/').map(|(slash, _)| slash).chain([path.len()]);
            all.extend(ends.filter(|&end| seen.insert(&path[..end])).map(|end| path[..end].to_owned()));
        }
        StateNames::from_paths(all)
    }

    /// The name that a path has in a chart in which no other state shares it. A path without the
    /// root begins with a slash.
    pub fn brief(path: &str) -> String {
        let names = StateNames::from_some([path]);
        names.short(path).to_owned()
    }

    /// The names, in the order of the nodes.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &str> + DoubleEndedIterator {
        self.names.iter().map(String::as_str)
    }

    /// The name of a node; empty for one that is not of this chart.
    pub fn name(&self, node: NodeId) -> &str {
        self.names.get(node.0 as usize).map_or("", String::as_str)
    }

    /// The [path](Statechart::path) of a node; empty for one that is not of this chart.
    pub fn path(&self, node: NodeId) -> String {
        self.tree.path(node.0 as usize)
    }

    /// The name of the node with a path, which may lack the root; an unknown path is returned.
    pub fn short<'a>(&'a self, path: &'a str) -> &'a str {
        self.index(path).map_or(path, |index| self.names[index].as_str())
    }

    /// The same for both ends of a transition, `source -> target`, and for a sequence of these.
    pub fn short_transition(&self, name: &str) -> String {
        name.split(ARROW).map(|end| self.short(end)).collect::<Vec<_>>().join(ARROW)
    }

    fn index(&self, path: &str) -> Option<usize> {
        let tree = &self.tree;
        tree.below(&tree.roots, path).or_else(|| tree.below(tree.children.first()?, path))
    }

    /// The node of exactly this name.
    pub fn named(&self, name: &str) -> Option<NodeId> {
        let found = self.by_name.binary_search_by(|&index| self.names[index].as_str().cmp(name)).ok()?;
        Some(NodeId(self.by_name[found] as u32))
    }

    /// The node that a text names: by its name, by its path, or by as much of the end of either as
    /// only one node has.
    ///
    /// # Errors
    /// No node, or several, with their names.
    pub fn find(&self, text: &str) -> Result<NodeId, UnknownState> {
        let exact = || Some(NodeId(self.index(text)? as u32));
        if let Some(node) = self.named(text).or_else(exact) {
            return Ok(node);
        }
        let ends = |whole: &str| whole.strip_suffix(text).is_some_and(|before| before.ends_with('/'));
        let fits = |index: &usize| ends(&self.names[*index]) || self.tree.ends_with(*index, text);
        let found: Vec<usize> = (0..self.names.len()).filter(fits).collect();
        match found[..] {
            [index] => Ok(NodeId(index as u32)),
            _ => Err(UnknownState {
                name: text.to_owned(),
                candidates: found.into_iter().map(|index| self.names[index].clone()).collect(),
            }),
        }
    }
}

/// The separator between the ends of a transition.
const ARROW: &str = " -> ";

/// The nodes of a chart, known by their paths.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
struct PathTree {
    parents: Vec<Option<usize>>,
    /// The last segment of each path.
    segments: Vec<String>,
    /// The nodes without a parent, by segment.
    roots: BTreeMap<String, usize>,
    /// The nodes inside each node, by segment.
    children: Vec<BTreeMap<String, usize>>,
}

impl PathTree {
    fn new(parents: Vec<Option<usize>>, segments: Vec<String>) -> PathTree {
        let (mut roots, mut children) = (BTreeMap::new(), vec![BTreeMap::new(); segments.len()]);
        for (index, (parent, segment)) in parents.iter().zip(&segments).enumerate() {
            let siblings = parent.map_or(&mut roots, |parent| &mut children[parent]);
            siblings.entry(segment.clone()).or_insert(index);
        }
        PathTree { parents, segments, roots, children }
    }

    fn from_paths(paths: &[String]) -> PathTree {
        let mut by_path = BTreeMap::new();
        for (index, path) in paths.iter().enumerate() {
            by_path.entry(path.as_str()).or_insert(index);
        }
        let mut parents = Vec::with_capacity(paths.len());
        let mut segments = Vec::with_capacity(paths.len());
        for path in paths {
            // a name may itself contain slashes: the parent is the longest path that is one
            let mut slashes = path.rmatch_indices('/').map(|(index, _)| index);
            let found = slashes.find_map(|slash| Some((*by_path.get(&path[..slash])?, &path[slash + 1..])));
            parents.push(found.map(|(parent, _)| parent));
            segments.push(found.map_or(path.as_str(), |(_, segment)| segment).to_owned());
        }
        PathTree::new(parents, segments)
    }

    fn path(&self, index: usize) -> String {
        let around = |index: &usize| self.parents.get(*index).copied().flatten();
        let ancestors = std::iter::successors(Some(index), around);
        let mut segments: Vec<&str> =
            ancestors.filter_map(|index| self.segments.get(index)).map(String::as_str).collect();
        segments.reverse();
        segments.join("/")
    }

    /// The node with a path that begins with one of some siblings.
    fn below(&self, siblings: &BTreeMap<String, usize>, path: &str) -> Option<usize> {
        let inside = |slash: usize| {
            let node = *siblings.get(&path[..slash])?;
            self.below(&self.children[node], &path[slash + 1..])
        };
        let alone = siblings.get(path).copied();
        alone.or_else(|| path.match_indices('/').find_map(|(slash, _)| inside(slash)))
    }

    /// Whether a text is the end of a node's path, from some segment after the first.
    fn ends_with(&self, index: usize, text: &str) -> bool {
        let (mut at, mut rest) = (index, text);
        loop {
            let (segment, parent) = (&self.segments[at], self.parents[at]);
            if rest == segment {
                return parent.is_some();
            }
            let before = rest.strip_suffix(segment.as_str()).and_then(|before| before.strip_suffix('/'));
            match (before, parent) {
                (Some(before), Some(parent)) => (rest, at) = (before, parent),
                _ => return false,
            }
        }
    }

    fn names(&self) -> Vec<String> {
        let words = self.words();
        let labels = self.labels();
        let mut names: Vec<String> = Vec::with_capacity(self.segments.len());
        let mut taken = BTreeSet::new();
        let mut numbers: BTreeMap<String, usize> = BTreeMap::new();
        for (index, label) in labels.iter().enumerate() {
            let around = self.parents[index].filter(|&parent| self.parents[parent].is_some());
            let name = match (&words[index], around) {
                (Some(word), _) => word.clone(),
                (None, Some(parent)) => format!("{}/{label}", names[parent]),
                (None, None) => label.clone(),
            };
            let mut found = name.clone();
            while !taken.insert(found.clone()) {
                let number = numbers.entry(name.clone()).or_insert(1);
                *number += 1;
                found = format!("{name}#{number}");
            }
            names.push(found);
        }
        names
    }

    /// The names of the nodes that have a word of their own, with as many words around them as make
    /// them the only ones.
    fn words(&self) -> Vec<Option<String>> {
        let chains: Vec<Option<Vec<&str>>> =
            (0..self.segments.len()).map(|index| self.chain(index)).collect();
        let mut lengths: Vec<usize> = vec![2; chains.len()];
        let name = |index: usize, length: usize| {
            let chain = chains[index].as_ref()?;
            let mut words: Vec<&str> = chain.iter().take(length).copied().collect();
            words.reverse();
            Some(words.join("/"))
        };
        loop {
            let mut alike: BTreeMap<String, Vec<usize>> = BTreeMap::new();
            for (index, &length) in lengths.iter().enumerate() {
                if let Some(name) = name(index, length) {
                    alike.entry(name).or_default().push(index);
                }
            }
            let longer =
                |index: &usize| chains[*index].as_ref().is_some_and(|chain| chain.len() > lengths[*index]);
            let again: Vec<usize> =
                alike.into_values().filter(|group| group.len() > 1).flatten().filter(longer).collect();
            if again.is_empty() {
                return lengths.iter().enumerate().map(|(index, &length)| name(index, length)).collect();
            }
            again.into_iter().for_each(|index| lengths[index] += 1);
        }
    }

    /// The word of a node, and those around it up to the root, innermost first; the root is named
    /// by itself.
    fn chain(&self, index: usize) -> Option<Vec<&str>> {
        let Some(parent) = self.parents[index] else { return Some(vec![&self.segments[index]]) };
        if !is_word(&self.segments[index]) {
            return None;
        }
        let mut chain = vec![self.segments[index].as_str()];
        let mut next = Some(parent);
        while let Some(around) = next {
            next = self.parents[around];
            if next.is_some() && is_word(&self.segments[around]) {
                chain.push(&self.segments[around]);
            }
        }
        Some(chain)
    }

    /// The part that each node adds to the name of the one around it.
    fn labels(&self) -> Vec<String> {
        let mut counts = vec![0; self.segments.len()];
        let label = |(index, segment): (usize, &String)| {
            let number = self.parents[index].map(|parent| {
                counts[parent] += usize::from(!is_connector(segment));
                counts[parent]
            });
            let is_brief = is_connector(segment) || is_word(stem(segment)) || segment.parse::<u32>().is_ok();
            match number.filter(|_| !is_brief) {
                Some(number) => number.to_string(),
                None => segment.clone(),
            }
        };
        self.segments.iter().enumerate().map(label).collect()
    }
}

fn is_connector(segment: &str) -> bool {
    ["START", "END", "CONDITION"].contains(&segment)
}

/// A term without the operators around it: `Sensors` of `Sensors~`, `passBall` of `[passBall]`.
fn stem(segment: &str) -> &str {
    let stem = segment.trim_end_matches(['~', '*', '+']);
    stem.strip_prefix('[').and_then(|inner| inner.strip_suffix(']')).unwrap_or(stem)
}

/// Whether a name is a word, and not a term of a formula or a number.
fn is_word(segment: &str) -> bool {
    let is_letter = |letter: char| letter.is_alphanumeric() || "_-. :".contains(letter);
    !is_connector(segment)
        && segment.starts_with(|first: char| first.is_alphabetic() || first == '_')
        && segment.chars().all(is_letter)
        && !segment.contains(" . ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATHS: [&str; 16] = [
        "player",
        "player/(Led~||active)",
        "player/(Led~||active)/1",
        "player/(Led~||active)/1/Led~",
        "player/(Led~||active)/1/Led~/START",
        "player/(Led~||active)/1/Led~/Led",
        "player/(Led~||active)/2",
        "player/(Led~||active)/2/active",
        "player/(Led~||active)/2/active/START",
        "player/(Led~||active)/2/active/(Search|kick)",
        "player/(Led~||active)/2/active/(Search|kick)/CONDITION",
        "player/(Led~||active)/2/active/(Search|kick)/Search",
        "player/(Led~||active)/2/active/(Search|kick)/kick",
        "player/(Led~||active)/2/active/(Search|kick)/kick/Step",
        "player/(Led~||active)/2/active/[walk]",
        "player/(Led~||active)/2/active/[walk]/walk",
    ];

    fn names(paths: &[&str]) -> Vec<String> {
        StateNames::from_paths(paths.iter().copied()).iter().map(str::to_owned).collect()
    }

    #[test]
    fn a_name_is_made_of_the_words_of_the_role() {
        assert_eq!(
            names(&PATHS),
            [
                "player",
                "1",
                "1/1",
                "1/1/Led~",
                "1/1/Led~/START",
                "Led",
                "1/2",
                "active",
                "active/START",
                "active/1",
                "active/1/CONDITION",
                "active/Search",
                "active/kick",
                "kick/Step",
                "active/[walk]",
                "active/walk",
            ]
        );
    }

    #[test]
    fn a_name_does_not_depend_on_states_elsewhere() {
        let mut more = PATHS.to_vec();
        more.extend([
            "player/(Led~||active)/2/active/(Search|kick)/Dribble",
            "player/later",
            "player/later/Rest",
        ]);
        assert_eq!(names(&more)[..PATHS.len()], names(&PATHS));
    }

    #[test]
    fn states_that_would_share_a_name_get_more_words_and_at_last_a_number() {
        let paths = ["r", "r/a", "r/a/walk", "r/a/walk/Step", "r/b", "r/b/walk", "r/b/walk/Step"];
        assert_eq!(names(&paths), ["r", "a", "a/walk", "a/walk/Step", "b", "b/walk", "b/walk/Step"]);
        let twice = ["r", "r/a", "r/a/Step", "r/a/(y.z)", "r/a/(y.z)/Step"];
        assert_eq!(names(&twice), ["r", "a", "a/Step", "a/2", "a/Step#2"]);
    }

    #[test]
    fn a_state_is_found_by_its_name_its_path_or_the_end_of_either() {
        let names = StateNames::from_paths(PATHS);
        let found =
            |text: &str| names.find(text).map(|node| names.name(node)).map_err(|error| error.to_string());
        assert_eq!(found("kick/Step"), Ok("kick/Step"));
        assert_eq!(found("Search"), Ok("active/Search"));
        assert_eq!(found("player/(Led~||active)/2/active"), Ok("active"));
        assert_eq!(found("(Led~||active)/2/active/[walk]"), Ok("active/[walk]"));
        assert_eq!(found("Serch"), Err("there is no state `Serch`".to_owned()));
        assert_eq!(found("START"), Err("`START` is ambiguous: `1/1/Led~/START`, `active/START`".to_owned()));
    }

    /// Twins, and regions of one AND whose name contains all of them: each path would be as long as
    /// the chart.
    #[test]
    fn the_names_of_a_large_chart_are_found_without_its_paths() {
        use crate::statechart::{Node, NodeKind};

        let mut chart = Statechart::new("r");
        let and = chart.add(Statechart::ROOT, Node::new(NodeKind::And, "(A||A)".repeat(20_000)));
        for _ in 0..20_000 {
            let region = chart.add(and, Node::new(NodeKind::Or, ""));
            chart.add(region, Node::new(NodeKind::Basic, "A"));
        }
        let names = StateNames::of(&chart);
        assert_eq!(names.iter().next_back(), Some("A#20000"));
        assert_eq!(names.iter().nth(4), Some("1/2"));
        assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), 40_002);
        assert_eq!(names.path(NodeId(5)), chart.path(NodeId(5)));
    }

    #[test]
    fn the_ends_of_a_transition_are_shortened_with_or_without_the_root() {
        let names = StateNames::from_paths(PATHS);
        let long = "(Led~||active)/2/active/START -> player/(Led~||active)/2/active/(Search|kick)";
        assert_eq!(names.short_transition(long), "active/START -> active/1");
        assert_eq!(names.short_transition("elsewhere -> player"), "elsewhere -> player");
    }
}
