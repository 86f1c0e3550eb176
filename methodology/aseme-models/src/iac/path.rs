//! Paths of nodes in the text form.

use std::collections::BTreeMap;

use super::Iac;
use crate::document::{quoted, unquoted};
use aseme::names::encode;
use aseme::text::{self, QuoteScanner};

/// Index of the paths of all nodes of a chart.
pub(crate) struct NodePaths {
    segments: Vec<String>,
    parents: Vec<Option<usize>>,
    /// The nodes by the last segment of their path.
    by_last: BTreeMap<String, Vec<usize>>,
    /// The nodes by the last two segments of their path: many composites have a START.
    by_last_two: BTreeMap<(String, String), Vec<usize>>,
}

impl NodePaths {
    pub(crate) fn new(chart: &Iac) -> NodePaths {
        let (labels, children) = (chart.labels(), chart.children());
        let mut segments: Vec<String> =
            chart.nodes.iter().zip(&labels).map(|(node, label)| segment(node, label)).collect();
        let roots: Vec<usize> =
            (0..segments.len()).filter(|&index| chart.nodes[index].parent.is_none()).collect();
        for siblings in children.iter().chain([&roots]) {
            number(&mut segments, siblings);
        }
        let mut by_last: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (index, segment) in segments.iter().enumerate() {
            by_last.entry(segment.clone()).or_default().push(index);
        }
        let mut by_last_two: BTreeMap<(String, String), Vec<usize>> = BTreeMap::new();
        for (index, node) in chart.nodes.iter().enumerate() {
            if let Some(around) = node.parent.and_then(|parent| segments.get(parent)) {
                by_last_two.entry((around.clone(), segments[index].clone())).or_default().push(index);
            }
        }
        let parents = chart.nodes.iter().map(|node| node.parent).collect();
        NodePaths { segments, parents, by_last, by_last_two }
    }

    /// The shortest unique end of a node's path.
    pub(crate) fn shortest(&self, node: usize) -> String {
        let indices: Vec<usize> = std::iter::successors(Some(node), |&node| self.parents[node]).collect();
        let mut rivals: Vec<usize> = self.by_last.get(&self.segments[node]).cloned().unwrap_or_default();
        rivals.retain(|&rival| rival != node);
        let mut length = 1;
        while !rivals.is_empty() && length < indices.len() {
            // Each rival represents a node that many levels below it.
            rivals = rivals.into_iter().filter_map(|rival| self.parents[rival]).collect();
            let segment = &self.segments[indices[length]];
            rivals.retain(|&rival| self.segments[rival] == *segment);
            length += 1;
        }
        let mut parts: Vec<&str> =
            indices[..length].iter().map(|&node| self.segments[node].as_str()).collect();
        parts.reverse();
        let root = if rivals.is_empty() { "" } else { "/" };
        format!("{root}{}", parts.join("/"))
    }

    /// The nodes that a path refers to.
    pub(crate) fn find(&self, path: &str) -> Vec<usize> {
        let (from_root, path) = path.strip_prefix('/').map_or((false, path), |path| (true, path));
        let steps = steps(path);
        let candidates = match steps.as_slice() {
            [] => return Vec::new(),
            [last] => self.by_last.get(last),
            [.., around, last] => self.by_last_two.get(&(around.clone(), last.clone())),
        };
        let candidates = candidates.map(Vec::as_slice).unwrap_or_default();
        candidates.iter().copied().filter(|&node| self.fits(node, &steps, from_root)).collect()
    }

    /// The names of nodes, for suggestions.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.by_last.keys().map(String::as_str)
    }

    fn fits(&self, node: usize, steps: &[String], from_root: bool) -> bool {
        let mut at = Some(node);
        for step in steps.iter().rev() {
            match at {
                Some(node) if self.segments[node] == *step => at = self.parents[node],
                _ => return false,
            }
        }
        !from_root || at.is_none()
    }
}

/// The name of a node among its siblings.
fn segment(node: &super::IacNode, label: &str) -> String {
    if node.name != *label || node.parent.is_none() {
        return name_text(node);
    }
    match node.kind.as_str() {
        "START" | "END" | "CONDITION" => node.kind.clone(),
        _ => label.rsplit('.').next().unwrap_or_default().to_owned(),
    }
}

/// Numbers siblings of the same name.
fn number(segments: &mut [String], siblings: &[usize]) {
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    for &sibling in siblings {
        let count = seen.entry(segments[sibling].clone()).or_default();
        *count += 1;
        if *count > 1 {
            segments[sibling] = format!("{}[{count}]", segments[sibling]);
        }
    }
}

/// The name of a node as text: in the notation of formulas if that decodes to the same name.
pub(crate) fn name_text(node: &super::IacNode) -> String {
    let composite = matches!(node.kind.as_str(), "OR" | "AND");
    let name = node.written();
    let encoded = if composite { encode(&name) } else { name.clone() };
    if encoded == node.name && is_bare(&name) { name } else { quoted(&node.name) }
}

/// The name that a text denotes for a node of some type; `None` if its quotes are invalid.
pub(crate) fn name_of(text: &str, kind: &str) -> Option<String> {
    match (text.starts_with('"'), kind) {
        (false, "OR" | "AND") => Some(encode(&text::canonical_name(text))),
        _ => unquoted(text),
    }
}

/// Whether a name needs no quotes.
fn is_bare(name: &str) -> bool {
    let is_number = name.bytes().all(|byte| byte.is_ascii_digit());
    let is_word = ["START", "END", "CONDITION"].contains(&name);
    let is_occurrence =
        name.strip_suffix(']').and_then(|name| name.rsplit_once('[')).is_some_and(|(before, number)| {
            !before.is_empty() && !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())
        });
    let is_taken = name.is_empty() || is_number || is_word || is_occurrence;
    !is_taken
        && text::is_plain(name)
        && !name.contains(|letter: char| letter.is_whitespace() || "/:\"=!%,^ωΩ\u{2126}".contains(letter))
        && !name.contains("->")
}

/// The segments of a path, separated by slashes outside quotes.
fn steps(path: &str) -> Vec<String> {
    let (mut steps, mut step) = (Vec::new(), String::new());
    let mut quotes = QuoteScanner::default();
    for letter in path.chars() {
        match letter {
            letter if quotes.hold(letter) => step.push(letter),
            '/' => steps.push(std::mem::take(&mut step)),
            letter if letter.is_whitespace() || letter == '^' => {}
            letter if text::is_forever(letter) => step.push('~'),
            other => step.push(other),
        }
    }
    steps.push(step);
    steps
}
