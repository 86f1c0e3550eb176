//! Transformation of formulas into a statechart: the templates of the thesis's Table 2.1.
//!
//! The chart has one root, named by the left-hand side of the first formula. A node is expanded by
//! the template of the operator of its term; each operand is a node of its own and is expanded in
//! turn. A name with a formula is expanded with that formula. An operator that is the whole of a
//! formula, or of a group, is expanded in the node itself.
//!
//! | term | children in order | transitions in order |
//! |---|---|---|
//! | `a . b` | START, a, b, END | START→a, a→b, b→END |
//! | `a \| b` | START, CONDITION, a, b, END | START→CONDITION, CONDITION→a, CONDITION→b, b→END, a→END |
//! | `a \|\| b` | START, AND of a region for each operand, END | START→AND, AND→END; in a region START→a, a→END |
//! | `[a]` | START, CONDITION, a, END | START→CONDITION, CONDITION→a, CONDITION→END, a→END |
//! | `a*` | START, CONDITION, a, END | START→CONDITION, CONDITION→a, a→a, CONDITION→END, a→END |
//! | `a+` | START, a, END | START→a, a→a, a→END |
//! | `a~` | START, a | START→a, a→a |
//! | `\|a~\|n` | as `a~ \|\| ... \|\| a~`, n times | |
//! | `a` alone | as a sequence of one | |
//!
//! Transitions of `.`, `|` and `||` come before those inside their operands, those of the repeating
//! operators and of `[a]` after.

use std::collections::BTreeMap;

use yase::{Diagnostic, Node, NodeId, NodeKind, Span, Statechart, Transition};

use crate::liveness::{Liveness, MAX_LEVELS, Term, TermId};
use crate::srm::Srm;

/// The memory limit of a chart's nodes and names: nested copies grow exponentially.
const MAX_BYTES: usize = 16 << 20;

/// The memory of a node besides its name.
const NODE_BYTES: usize = 256;

/// The statechart of a role: its formulas expanded, its transitions and states refined, with its
/// constants.
///
/// Findings are entries that no longer match (E0250 to E0254) and charts that are too large (E0220,
/// E0221); for these the returned chart is incomplete. Errors of the text are reported by its
/// parser.
pub fn role_to_statechart(srm: &Srm) -> (Statechart, Vec<Diagnostic>) {
    let (mut chart, mut diagnostics) = liveness_to_statechart(&srm.liveness);
    if diagnostics.iter().any(Diagnostic::is_error) {
        return (chart, diagnostics);
    }
    chart.constants.clone_from(&srm.constants);
    let mut unmatched = crate::refine::refine(&mut chart, &srm.transitions);
    unmatched.extend(crate::refine::refine_layout(&mut chart, &srm.layout));
    unmatched.extend(crate::refine::refine_states(&mut chart, &srm.states));
    diagnostics.extend(unmatched.into_iter().map(|unmatched| unmatched.diagnostic));
    (chart, diagnostics)
}

/// The statechart of formulas alone.
pub fn liveness_to_statechart(liveness: &Liveness) -> (Statechart, Vec<Diagnostic>) {
    let (chart, _, diagnostics) = expanded(liveness);
    (chart, diagnostics)
}

/// Expands formulas. Also returns the span in the formulas of each node, by [`NodeId`].
pub fn expanded(liveness: &Liveness) -> (Statechart, Vec<Span>, Vec<Diagnostic>) {
    let name = liveness.formulas().first().map_or("", |formula| formula.name.as_str());
    let mut expansion = Expansion {
        liveness,
        formulas: liveness.by_name(),
        chart: Statechart::new(name),
        spans: vec![liveness.formulas().first().map_or(Span::default(), |formula| formula.name_span)],
        here: Span::default(),
        open: Vec::new(),
        bytes: 0,
        refused: None,
    };
    if !liveness.formulas().is_empty() {
        expansion.formula(Statechart::ROOT, 0, 1);
    }
    (expansion.chart, expansion.spans, expansion.refused.into_iter().collect())
}

/// A chart under construction.
struct Expansion<'a> {
    liveness: &'a Liveness,
    formulas: BTreeMap<&'a str, usize>,
    chart: Statechart,
    /// The span of each node.
    spans: Vec<Span>,
    /// The span of the current term.
    here: Span,
    /// The formulas that contain the current node; a recursive formula is not expanded again.
    open: Vec<usize>,
    bytes: usize,
    refused: Option<Diagnostic>,
}

impl<'a> Expansion<'a> {
    /// Expands a node, whose children are at `level`, with a formula.
    fn formula(&mut self, node: NodeId, index: usize, level: usize) {
        if let Some(expression) = self.liveness.formulas()[index].expression {
            self.open.push(index);
            self.expand(node, expression, level);
            self.open.pop();
        }
    }

    fn expand(&mut self, node: NodeId, term: TermId, level: usize) {
        let liveness = self.liveness;
        let term = self.without_groups(term);
        if self.refuses(term, level) {
            return;
        }
        self.here = liveness.span(term);
        match liveness.term(term) {
            Term::Sequence(items) => self.sequence(node, items, level),
            Term::Choice(items) => self.choice(node, items, level),
            Term::Parallel(items) => self.parallel(node, term, items.iter().copied(), level),
            Term::Copies { term: copied, count } => {
                self.parallel(node, term, std::iter::repeat_n(*copied, *count as usize), level);
            }
            Term::Optional(inner) => self.optional(node, *inner, level),
            Term::ZeroOrMore(inner) => self.zero_or_more(node, *inner, level),
            Term::OneOrMore(inner) => self.one_or_more(node, *inner, level),
            Term::Forever(inner) => self.forever(node, *inner, level),
            Term::Name(_) | Term::Group(_) => self.sequence(node, &[term], level),
        }
    }

    fn without_groups(&self, mut term: TermId) -> TermId {
        while let Term::Group(inner) = self.liveness.term(term) {
            term = *inner;
        }
        term
    }

    /// Whether a limit is reached; reported once.
    fn refuses(&mut self, term: TermId, level: usize) -> bool {
        if self.refused.is_none() {
            self.refused = refusal(self.liveness.span(term), level, self.bytes);
        }
        self.refused.is_some()
    }
}

fn refusal(span: Span, level: usize, bytes: usize) -> Option<Diagnostic> {
    if level >= MAX_LEVELS {
        let message = format!("states would nest more than {MAX_LEVELS} levels deep");
        return Some(Diagnostic::error("E0220", span, message).with_hint("flatten the formula"));
    }
    let hint = "every occurrence of a name with a formula is expanded; share less, or copy fewer times";
    (bytes > MAX_BYTES)
        .then(|| Diagnostic::error("E0221", span, "the chart becomes too large here").with_hint(hint))
}

/// The templates.
impl Expansion<'_> {
    fn sequence(&mut self, node: NodeId, items: &[TermId], level: usize) {
        let start = self.connector(node, NodeKind::Start);
        let states = self.states(node, items);
        let end = self.connector(node, NodeKind::End);
        let stops: Vec<NodeId> = std::iter::once(start).chain(states.iter().copied()).chain([end]).collect();
        for pair in stops.windows(2) {
            self.connect(pair[0], pair[1]);
        }
        self.refine_all(&states, items, level);
    }

    fn choice(&mut self, node: NodeId, items: &[TermId], level: usize) {
        let start = self.connector(node, NodeKind::Start);
        let condition = self.connector(node, NodeKind::Condition);
        let states = self.states(node, items);
        let end = self.connector(node, NodeKind::End);
        self.connect(start, condition);
        states.iter().for_each(|&state| self.connect(condition, state));
        states.iter().rev().for_each(|&state| self.connect(state, end));
        self.refine_all(&states, items, level);
    }

    fn parallel(&mut self, node: NodeId, term: TermId, items: impl Iterator<Item = TermId>, level: usize) {
        let start = self.connector(node, NodeKind::Start);
        let and = self.add(node, NodeKind::And, self.liveness.compact(term));
        let end = self.connector(node, NodeKind::End);
        self.connect(start, and);
        self.connect(and, end);
        let mut regions = Vec::new();
        for item in items {
            if self.refuses(item, level + 2) {
                return;
            }
            regions.push((self.region(and, item), item));
        }
        for (state, item) in regions {
            self.refine(state, item, level + 3);
        }
    }

    fn region(&mut self, and: NodeId, item: TermId) -> NodeId {
        let region = self.connector(and, NodeKind::Or);
        let start = self.connector(region, NodeKind::Start);
        let state = self.state(region, item);
        let end = self.connector(region, NodeKind::End);
        self.connect(start, state);
        self.connect(state, end);
        state
    }

    fn optional(&mut self, node: NodeId, inner: TermId, level: usize) {
        let start = self.connector(node, NodeKind::Start);
        let condition = self.connector(node, NodeKind::Condition);
        let state = self.refined_state(node, inner, level);
        let end = self.connector(node, NodeKind::End);
        self.connect(start, condition);
        self.connect(condition, state);
        self.connect(condition, end);
        self.connect(state, end);
    }

    fn zero_or_more(&mut self, node: NodeId, inner: TermId, level: usize) {
        let start = self.connector(node, NodeKind::Start);
        let condition = self.connector(node, NodeKind::Condition);
        let state = self.refined_state(node, inner, level);
        let end = self.connector(node, NodeKind::End);
        self.connect(start, condition);
        self.connect(condition, state);
        self.connect(state, state);
        self.connect(condition, end);
        self.connect(state, end);
    }

    fn one_or_more(&mut self, node: NodeId, inner: TermId, level: usize) {
        let start = self.connector(node, NodeKind::Start);
        let state = self.refined_state(node, inner, level);
        let end = self.connector(node, NodeKind::End);
        self.connect(start, state);
        self.connect(state, state);
        self.connect(state, end);
    }

    fn forever(&mut self, node: NodeId, inner: TermId, level: usize) {
        let start = self.connector(node, NodeKind::Start);
        let state = self.refined_state(node, inner, level);
        self.connect(start, state);
        self.connect(state, state);
    }
}

/// Nodes and transitions.
impl Expansion<'_> {
    fn add(&mut self, parent: NodeId, kind: NodeKind, name: String) -> NodeId {
        self.bytes += NODE_BYTES + name.len();
        self.spans.push(self.here);
        self.chart.add(parent, Node::new(kind, name))
    }

    /// Adds a connector without a name.
    fn connector(&mut self, parent: NodeId, kind: NodeKind) -> NodeId {
        self.add(parent, kind, String::new())
    }

    /// Adds the node of an operand, not yet expanded.
    fn state(&mut self, parent: NodeId, term: TermId) -> NodeId {
        let name = self.liveness.compact(term);
        let kind = if self.is_activity(term) { NodeKind::Basic } else { NodeKind::Or };
        let activity = (kind == NodeKind::Basic).then(|| name.clone());
        let state = self.add(parent, kind, name);
        self.spans[state.0 as usize] = self.liveness.span(term);
        self.chart.node_mut(state).activity = activity;
        state
    }

    fn is_activity(&self, term: TermId) -> bool {
        matches!(self.liveness.term(term), Term::Name(name) if !self.formulas.contains_key(name.as_str()))
    }

    fn states(&mut self, parent: NodeId, terms: &[TermId]) -> Vec<NodeId> {
        terms.iter().map(|&term| self.state(parent, term)).collect()
    }

    fn refine_all(&mut self, states: &[NodeId], terms: &[TermId], level: usize) {
        for (&state, &term) in states.iter().zip(terms) {
            self.refine(state, term, level + 1);
        }
    }

    /// Expands the node of an operand, whose children are at `level`.
    fn refine(&mut self, state: NodeId, term: TermId, level: usize) {
        match self.liveness.term(term) {
            Term::Name(name) => match self.formulas.get(name.as_str()) {
                Some(&formula) if !self.open.contains(&formula) => self.formula(state, formula, level),
                _ => {}
            },
            _ => self.expand(state, term, level),
        }
    }

    fn refined_state(&mut self, parent: NodeId, term: TermId, level: usize) -> NodeId {
        let (state, here) = (self.state(parent, term), self.here);
        self.refine(state, term, level + 1);
        self.here = here;
        state
    }

    fn connect(&mut self, source: NodeId, target: NodeId) {
        self.chart.connect(Transition::new(source, target));
    }
}
