//! Transfer of refinements from an older model file of a chart to a newer one.

use yase::statechart::Frame;
use yase::{Diagnostic, NodeId, Span, Statechart};
use yase_export::notation::duration_text;

use crate::diff::pairs::NodePairs;
use crate::iac::{Iac, IacNode};
use aseme::layout::{bends_text, frame_settings};

/// Copies to a chart what only an older one has: functionality, variables, metadata and refinements
/// of states; expression, refinements and metadata of transitions. States are matched as in
/// [`diff`](crate::diff), including those whose name changed with the formula around them.
///
/// Attributes without a counterpart in the newer chart, and those that differ there, are returned
/// with their old text (E0852).
pub fn transfer_refinements(older: &Iac, newer: &mut Iac) -> Vec<Diagnostic> {
    let (before, after) = (older.to_statechart().0, newer.to_statechart().0);
    let pairs = NodePairs::between(&before, &after);
    let mut keeping = ChartTransfer { older, newer, pairs, lost: Vec::new() };
    keeping.header();
    keeping.states(&before);
    keeping.transitions(&before);
    keeping.lost
}

struct ChartTransfer<'a> {
    older: &'a Iac,
    newer: &'a mut Iac,
    pairs: NodePairs,
    lost: Vec<Diagnostic>,
}

impl ChartTransfer<'_> {
    fn report_lost(&mut self, span: Span, what: String) {
        let found = Diagnostic::warning("E0852", span, what);
        self.lost.push(found.with_hint("add it to the newer model if it is still valid"));
    }

    fn header(&mut self) {
        for (own, old) in [
            (&mut self.newer.description, &self.older.description),
            (&mut self.newer.metadata, &self.older.metadata),
        ] {
            if own.is_empty() {
                own.clone_from(old);
            }
        }
        for constant in &self.older.constants {
            if !self.newer.constants.iter().any(|own| own.name == constant.name) {
                self.newer.constants.push(constant.clone());
            }
        }
    }

    fn states(&mut self, before: &Statechart) {
        for (index, old) in self.older.nodes.iter().enumerate() {
            let plain = IacNode {
                name: old.name.clone(),
                label: old.label.clone(),
                kind: old.kind.clone(),
                parent: old.parent,
                position: old.position,
                ..IacNode::default()
            };
            if *old == plain {
                continue;
            }
            let id = NodeId(index as u32);
            match self.pairs.later(id).filter(|new| (new.0 as usize) < self.newer.nodes.len()) {
                Some(new) => self.state(old, new.0 as usize, &before.path(id)),
                None => self.report_lost(
                    old.position.0,
                    format!("`{}` was removed, with: {}", before.path(id), state_content(old, self.older)),
                ),
            }
        }
    }

    fn state(&mut self, old: &IacNode, new: usize, path: &str) {
        let variables: Vec<usize> = old
            .variables
            .iter()
            .filter_map(|&index| self.older.variables.get(index))
            .map(|variable| self.newer.variable(variable))
            .collect();
        let node = &mut self.newer.nodes[new];
        for variable in variables {
            if !node.variables.contains(&variable) {
                node.variables.push(variable);
            }
        }
        let mut differing = Vec::new();
        for (what, own, old) in [
            ("functionality", &mut node.functionality, &old.functionality),
            ("actions", &mut node.actions, &old.actions),
            ("metadata", &mut node.metadata, &old.metadata),
        ] {
            if own.is_empty() {
                own.clone_from(old);
            } else if own != old && !old.is_empty() {
                differing.push(format!("{what} = {old}"));
            }
        }
        let own = &mut node.frame;
        if own.is_empty() {
            *own = old.frame;
        } else if *own != old.frame && !old.frame.is_empty() {
            differing.push(frame_text(&old.frame));
        }
        if node.refinement == Default::default() {
            node.refinement = old.refinement.clone();
        } else if node.refinement != old.refinement && old.refinement != Default::default() {
            differing.push(state_content(
                &IacNode { refinement: old.refinement.clone(), ..IacNode::default() },
                self.older,
            ));
        }
        for text in differing {
            self.report_lost(old.position.0, format!("the newer chart differs for `{path}` from `{text}`"));
        }
    }

    /// Matches transitions with the same ends; several between the same two are matched in order.
    fn transitions(&mut self, before: &Statechart) {
        let mut used = vec![false; self.newer.transitions.len()];
        for old in &self.older.transitions {
            let later = |node: usize| Some(self.pairs.later(NodeId(node as u32))?.0 as usize);
            let ends = later(old.source).zip(later(old.target));
            let position = ends.and_then(|(source, target)| {
                let mut all = self.newer.transitions.iter().enumerate();
                all.position(|(index, it)| !used[index] && (it.source, it.target) == (source, target))
            });
            let plain = old.te.is_empty()
                && old.metadata.is_empty()
                && old.bends.is_empty()
                && old.refinement == Default::default();
            if let Some(index) = position {
                used[index] = true;
            }
            if plain {
                continue;
            }
            let arrow = || {
                let path = |node: usize| before.path(NodeId(node as u32));
                let via = if old.bends.is_empty() { "" } else { " via " };
                format!(
                    "{} -> {} : {}{via}{}",
                    path(old.source),
                    path(old.target),
                    old.te,
                    bends_text(&old.bends)
                )
            };
            let Some(index) = position else {
                self.report_lost(old.position.0, format!("the transition was removed: `{}`", arrow()));
                continue;
            };
            let new = &mut self.newer.transitions[index];
            if new.metadata.is_empty() {
                new.metadata.clone_from(&old.metadata);
            }
            let is_drawn_elsewhere = !new.bends.is_empty() && !old.bends.is_empty() && new.bends != old.bends;
            if new.bends.is_empty() {
                new.bends.clone_from(&old.bends);
            }
            let says_something = !old.te.is_empty() || old.refinement != Default::default();
            let mut differs = is_drawn_elsewhere;
            if new.te.is_empty() && new.refinement == Default::default() {
                (new.te, new.refinement) = (old.te.clone(), old.refinement.clone());
            } else if says_something && (&new.te, &new.refinement) != (&old.te, &old.refinement) {
                differs = true;
            }
            if differs {
                let text = format!("the newer chart differs from `{}`", arrow());
                self.report_lost(old.position.0, text);
            }
        }
    }
}

fn frame_text(frame: &Frame) -> String {
    let settings = frame_settings(frame).into_iter().map(|(key, value)| format!("{key} = {value}"));
    settings.collect::<Vec<_>>().join(", ")
}

/// The content of a state in a file.
fn state_content(node: &IacNode, iac: &Iac) -> String {
    let refinement = &node.refinement;
    let variables: Vec<&str> = node
        .variables
        .iter()
        .filter_map(|&index| iac.variables.get(index))
        .map(|it| it.name.as_str())
        .collect();
    let number = |value: i32| if value == 0 { String::new() } else { value.to_string() };
    let duration = refinement.duration.map_or(String::new(), duration_text);
    let said = [
        ("functionality", node.functionality.clone()),
        ("variables", variables.join(", ")),
        ("actions", node.actions.clone()),
        ("metadata", node.metadata.clone()),
        ("activity", refinement.activity.clone().unwrap_or_default()),
        ("priority", number(refinement.priority)),
        ("entry", refinement.entry.clone()),
        ("exit", refinement.exit.clone()),
        ("defer", refinement.defer.clone()),
        ("duration", duration),
        ("layout", frame_text(&node.frame)),
    ];
    let said =
        said.iter().filter(|(_, text)| !text.is_empty()).map(|(what, text)| format!("{what} = {text}"));
    said.collect::<Vec<_>>().join(", ")
}
