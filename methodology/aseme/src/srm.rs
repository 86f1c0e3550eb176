//! Roles as text: the System Roles Model of one role, with the refinements of its chart.
//!
//! The form is that of the thesis's Figures 5.2 to 5.4, with four sections more. `#` begins a
//! comment.
//!
//! ```text
//! Role: goalie
//! Protocols: N/A
//! Liveness:
//! goalie = Visionω || decisionω
//! decision = SearchBall | TrackBall
//! Constants:
//! near = 0.25                # a number, true, false or "text"; a unit may follow: m cm mm, s ms, rad deg
//! Transitions:
//! Vision -> Vision : [vision_timeout] / StartTimeout(vision_timeout, 100ms)
//! decision: CONDITION -> SearchBall !1 : [!Ball.found]
//! *~ -> END : [false]
//! States:
//! SearchBall : priority = 5, duration = 2s
//! Layout:
//! decision/SearchBall : at = 20 90, size = 120 40
//! decision: CONDITION -> SearchBall : via = 80 60
//! ```
//!
//! - **Transitions**:
//!   `[scope:] source -> target [also] [!priority] [%weight] [interrupts] [internal]
//!   [: expression]`.
//!   Paths are described in [`path`](crate::path); `scope: a -> b` is short for
//!   `scope/a -> scope/b`. A line without `->` continues the entry above it. `also` adds a
//!   transition parallel to the one referred to, such as an exit that the formulas do not have.
//! - **States**: `path : key = value, ...` with the keys `activity` (`""` for none), `priority`,
//!   `entry`, `exit`, `defer`, `duration` and, for composites, `history`: with `shallow` or `deep`
//!   a composite that is entered again resumes where it was left. A line without `:` continues the
//!   entry above it.
//! - **Layout**: positions in drawings, for elements that are not laid out automatically.
//!   `path : at = right down, size = width height` for states and connectors,
//!   `[scope:] source -> target [also [number]] : via = right down, ...` for the corners of a
//!   transition, in pixels from the content area of the enclosing composite
//!   ([`yase::statechart::Layout`]). A layout affects drawings only.
//!
//! The content determines the form: text that begins with `<` is XMI, in which the method's Eclipse
//! tools store a System Roles Model (its role name and formulas are read); text with a section
//! header has the form above; any other text is bare formulas.

mod constants;
mod entries;
mod layout;
mod parts;
mod sections;
mod states;
mod xmi;

use yase::expression::{Action, TransitionExpression};
use yase::statechart::{Constant, Frame, Point};
use yase::{Diagnostic, Node, NodeId, NodeKind, Span, Statechart, TransitionId};

use crate::liveness::{self, Liveness};
use crate::path::Path;
use crate::text;

pub use constants::constant_value;
pub use parts::TransitionParts;
pub use sections::Section;
pub use states::{duration, events};

/// A role: its formulas and the refinements of their chart.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Srm {
    /// Its name, which may have blanks; for bare formulas the left-hand side of the first.
    pub role: String,
    /// The protocols it takes part in.
    pub protocols: Vec<ProtocolRole>,
    /// Its formulas.
    pub liveness: Liveness,
    /// The constants of its expressions.
    pub constants: Vec<Constant>,
    /// Refinements of transitions.
    pub transitions: Vec<TransitionEntry>,
    /// Refinements of states.
    pub states: Vec<StateEntry>,
    /// The layout of states and transitions.
    pub layout: Vec<LayoutEntry>,
}

/// A part in a protocol between agents.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ProtocolRole {
    /// The protocol.
    pub name: String,
    /// The role's part in it.
    pub participant: String,
}

/// A refinement of one transition, or with wildcards of several.
#[derive(Clone, PartialEq, Debug)]
pub struct TransitionEntry {
    /// The source.
    pub source: Path,
    /// The target.
    pub target: Path,
    /// Whether it adds a transition parallel to the one it names.
    pub also: bool,
    /// Higher priorities are tried first; the default is 0.
    pub priority: i32,
    /// The weight of a probabilistic branch.
    pub weight: Option<f64>,
    /// Whether it may exit a state whose activity is running.
    pub interrupts: bool,
    /// Whether it is internal: it does not exit its source.
    pub internal: bool,
    /// Trigger, guard and actions; spans are relative to the whole file.
    pub expression: TransitionExpression,
    /// The entry as it is written, on one line, without comments.
    pub text: String,
    /// Its position in the source.
    pub span: Span,
}

impl TransitionEntry {
    /// Whether its paths contain wildcards.
    pub fn has_wildcard(&self) -> bool {
        self.source.has_wildcard() || self.target.has_wildcard()
    }

    pub(crate) fn apply(&self, chart: &mut Statechart, id: TransitionId) {
        let transition = chart.transition_mut(id);
        transition.expression = self.expression.clone();
        (transition.priority, transition.weight) = (self.priority, self.weight);
        (transition.interrupts, transition.internal) = (self.interrupts, self.internal);
    }
}

/// A refinement of one state, or with wildcards of several; absent settings leave the state
/// unchanged.
#[derive(Clone, PartialEq, Debug)]
pub struct StateEntry {
    /// The state.
    pub path: Path,
    /// The activity it runs; empty for none at all.
    pub activity: Option<String>,
    /// The priority of its activity.
    pub priority: Option<i32>,
    /// Its entry actions.
    pub entry: Option<Vec<Action>>,
    /// Its exit actions.
    pub exit: Option<Vec<Action>>,
    /// Events that are deferred while it is active.
    pub defer: Option<Vec<String>>,
    /// The duration of its activity in simulated time.
    pub duration: Option<std::time::Duration>,
    /// For composites: the kind of HISTORY by which it is entered.
    pub history: Option<NodeKind>,
    /// The entry as it is written, on one line, without comments.
    pub text: String,
    /// Its position in the source.
    pub span: Span,
}

impl StateEntry {
    /// Whether it has settings that only apply to states without children.
    pub(crate) fn is_about_activity(&self) -> bool {
        self.activity.is_some() || self.priority.is_some() || self.duration.is_some()
    }

    pub(crate) fn apply(&self, chart: &mut Statechart, id: NodeId) {
        let node = chart.node_mut(id);
        node.activity = self.activity.clone().or(node.activity.take()).filter(|name| !name.is_empty());
        node.priority = self.priority.unwrap_or(node.priority);
        node.duration = self.duration.or(node.duration);
        for (said, target) in [(&self.entry, &mut node.entry), (&self.exit, &mut node.exit)] {
            if let Some(actions) = said {
                target.clone_from(actions);
            }
        }
        if let Some(defer) = &self.defer {
            node.defer.clone_from(defer);
        }
        if let Some(kind) = self.history {
            remember(chart, id, kind);
        }
    }
}

/// The layout of a state or transition, or of several by wildcards.
#[derive(Clone, PartialEq, Debug)]
pub struct LayoutEntry {
    /// The element.
    pub of: LayoutTarget,
    /// For a state: its position and size.
    pub frame: Frame,
    /// For a transition: its corners.
    pub bends: Vec<Point>,
    /// The entry as it is written, on one line, without comments.
    pub text: String,
    /// Its position in the source.
    pub span: Span,
}

/// An element with a layout.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum LayoutTarget {
    /// A state or a connector.
    State(Path),
    /// A transition.
    Transition {
        /// The node it leaves.
        source: Path,
        /// The node it leads to.
        target: Path,
        /// 0 for the transition of the formulas; from 1 on for those added in parallel, in order.
        parallel: usize,
    },
}

/// Redirects transitions from outside a composite to a new HISTORY in it. The HISTORY follows the
/// other children, so that their labels stay the same.
fn remember(chart: &mut Statechart, id: NodeId, kind: NodeKind) {
    let is_inside = |node: NodeId| node == id || chart.ancestors(node).any(|ancestor| ancestor == id);
    let into = chart.transitions().filter(|(_, it)| it.target == id && !is_inside(it.source));
    let into: Vec<TransitionId> = into.map(|(id, _)| id).collect();
    let history = chart.add(id, Node::new(kind, ""));
    into.into_iter().for_each(|id| chart.transition_mut(id).target = history);
}

/// An entry of a file with its span, without its comment.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SrmEntry {
    /// Its section.
    pub section: Section,
    /// Its span.
    pub span: Span,
}

/// A role's file: the text, the role, and the spans of its entries.
#[derive(Clone, PartialEq, Debug)]
pub struct SrmFile {
    text: String,
    srm: Srm,
    entries: Vec<SrmEntry>,
}

impl SrmFile {
    /// Parses a role. Invalid parts are skipped and reported; codes are E0201 to E0219 for
    /// formulas, E0230 to E0249 for the rest, and those of expressions.
    pub fn parse(text: impl Into<String>) -> (SrmFile, Vec<Diagnostic>) {
        let text = text.into();
        let mut reader = Reader::default();
        if text.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
            reader.xmi(&text);
        } else {
            reader.read(&text::without_comments(&text));
        }
        (SrmFile { text, srm: reader.srm, entries: reader.entries }, reader.diagnostics)
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The role.
    pub fn srm(&self) -> &Srm {
        &self.srm
    }

    /// The entries, in the order of the text: the role, each formula, constant, transition and
    /// state. XMI has none.
    pub fn entries(&self) -> &[SrmEntry] {
        &self.entries
    }
}

/// The state of the parser.
#[derive(Default)]
struct Reader {
    srm: Srm,
    entries: Vec<SrmEntry>,
    diagnostics: Vec<Diagnostic>,
}

impl Reader {
    fn read(&mut self, blanked: &str) {
        match sections::sections(blanked, &mut self.diagnostics) {
            Some(sections) => self.sections(blanked, &sections),
            None => self.bare_formulas(blanked),
        }
    }

    fn bare_formulas(&mut self, blanked: &str) {
        self.liveness(blanked, Span::new(0, blanked.len()));
        let first = self.srm.liveness.formulas().first();
        self.srm.role = first.map_or(String::new(), |formula| formula.name.clone());
    }

    fn sections(&mut self, blanked: &str, sections: &[(Section, Span)]) {
        for (section, body) in sections {
            self.section(*section, blanked, *body);
        }
        if !sections.iter().any(|(section, _)| *section == Section::Liveness) {
            let span = Span::new(0, blanked.find('\n').unwrap_or(blanked.len()));
            let hint = "add `Liveness:` and below it `role = activity`";
            self.report(Diagnostic::error("E0233", span, "the role has no formulas").with_hint(hint));
        }
    }

    fn section(&mut self, section: Section, blanked: &str, body: Span) {
        match section {
            Section::Role => self.role(blanked, body),
            Section::Protocols => self.protocols(blanked, body),
            Section::Liveness => self.liveness(blanked, body),
            Section::Constants => self.constants(blanked, body),
            Section::Transitions => self.transitions(blanked, body),
            Section::States => self.states(blanked, body),
            Section::Layout => self.layout(blanked, body),
        }
    }

    fn role(&mut self, blanked: &str, body: Span) {
        let span = text::trimmed(blanked, body);
        let words: Vec<&str> = blanked[span.start..span.end].split_whitespace().collect();
        if words.is_empty() {
            let span = Span::new(body.start.saturating_sub(1), body.start);
            return self.report(
                Diagnostic::error("E0234", span, "the role has no name").with_hint("write it after `Role:`"),
            );
        }
        self.srm.role = words.join(" ");
        self.entries.push(SrmEntry { section: Section::Role, span });
    }

    /// `N/A`, or `Attack: center, Attack: center_for`.
    fn protocols(&mut self, blanked: &str, body: Span) {
        let span = text::trimmed(blanked, body);
        let all = &blanked[span.start..span.end];
        if matches!(all, "" | "N/A" | "-") {
            return;
        }
        self.entries.push(SrmEntry { section: Section::Protocols, span });
        for part in all.split([',', '\n']).map(str::trim).filter(|part| !part.is_empty()) {
            match part.split_once(':').map(|(name, participant)| (name.trim(), participant.trim())) {
                Some((name, participant)) if !name.is_empty() && !participant.is_empty() => {
                    self.srm
                        .protocols
                        .push(ProtocolRole { name: name.into(), participant: participant.into() });
                }
                _ => {
                    let message = format!("`{part}` is not a part in a protocol");
                    let hint = "write `protocol: participant`, several separated by commas, or `N/A`";
                    self.report(Diagnostic::error("E0235", span, message).with_hint(hint));
                }
            }
        }
    }

    fn liveness(&mut self, blanked: &str, body: Span) {
        let (liveness, diagnostics) = liveness::parse_section(blanked, body);
        let formulas = liveness.formulas().iter();
        self.entries
            .extend(formulas.map(|formula| SrmEntry { section: Section::Liveness, span: formula.span }));
        self.srm.liveness = liveness;
        self.diagnostics.extend(diagnostics);
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }
}
