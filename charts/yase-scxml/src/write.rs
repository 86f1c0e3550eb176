//! Writes a chart or a [`Document`] as text.

mod content;
mod element;
mod invoke;

use std::collections::BTreeMap;

use super::content::ScriptSource;
use super::document::{DataBinding, DataModel, Document};
use super::guard::condition_text;
use super::lexical::is_id;
use super::xml::{NAMESPACE, is_xml};
use yase::diagnostic::{Diagnostic, Span};
use yase::expression::{Action, ActionKind, Path, Trigger};
use yase::statechart::{BriefNames, Node, NodeId, NodeKind, Statechart, Transition, TransitionId};

pub(crate) use content::block_text;
use content::{payload_elements, source_into};
use element::ElementWriter;

/// Writes a chart as an SCXML document. Scripts are interpreted as [`read`](super::read) creates
/// them.
///
/// # Errors
/// Everything that SCXML cannot express, with names: activities, timers, guards on messages,
/// CHOICE, JOIN, and so on. Nothing is omitted silently.
pub fn write(chart: &Statechart) -> Result<String, Vec<Diagnostic>> {
    Document::from(chart.clone()).write()
}

impl Document {
    /// The document as text, which reads back as the same document.
    ///
    /// # Errors
    /// Everything in its chart that SCXML cannot express, with names.
    pub fn write(&self) -> Result<String, Vec<Diagnostic>> {
        let mut job = DocumentWriter::new(self);
        job.constants();
        job.names();
        job.segments();
        job.document();
        match job.refused.is_empty() {
            true => Ok(job.writer.into_text()),
            false => Err(job.refused),
        }
    }
}

/// Writes one document.
struct DocumentWriter<'a> {
    document: &'a Document,
    chart: &'a Statechart,
    outgoing: BTreeMap<NodeId, Vec<TransitionId>>,
    incoming: BTreeMap<NodeId, usize>,
    names: BriefNames<'a>,
    writer: ElementWriter,
    refused: Vec<Diagnostic>,
}

impl<'a> DocumentWriter<'a> {
    fn new(document: &'a Document) -> DocumentWriter<'a> {
        let chart = &document.statechart;
        let (mut outgoing, mut incoming) = (BTreeMap::<_, Vec<_>>::new(), BTreeMap::new());
        for (id, transition) in chart.transitions() {
            outgoing.entry(transition.source).or_default().push(id);
            *incoming.entry(transition.target).or_default() += 1;
        }
        DocumentWriter {
            document,
            chart,
            names: BriefNames::new(chart),
            outgoing,
            incoming,
            writer: ElementWriter::new(),
            refused: Vec::new(),
        }
    }

    fn refuse(&mut self, message: impl Into<String>) {
        self.refused.push(Diagnostic::error("E0620", Span::default(), message));
    }

    fn node(&self, id: NodeId) -> &'a Node {
        self.chart.node(id)
    }

    fn out_of(&self, id: NodeId) -> Vec<&'a Transition> {
        let ids = self.outgoing.get(&id).map(Vec::as_slice).unwrap_or_default();
        ids.iter().map(|&id| self.chart.transition(id)).collect()
    }

    fn constants(&mut self) {
        for constant in &self.chart.constants {
            self.refuse(format!("SCXML has no constants such as `{}`", constant.name));
        }
    }

    /// Checks that ids are valid and unique.
    fn names(&mut self) {
        let mut seen = BTreeMap::new();
        for (id, node) in self.chart.nodes().skip(1).filter(|(_, node)| is_named(node.kind)) {
            if node.name.is_empty() {
                continue;
            }
            if !is_id(&node.name) {
                self.refuse(format!("`{}` has a name that cannot be an id in SCXML", self.names.name(id)));
            }
            if let Some(other) = seen.insert(node.name.as_str(), id) {
                let (first, second) = (self.names.name(other), self.names.name(id));
                self.refuse(format!("`{first}` and `{second}` have one name, and ids in SCXML are unique"));
            }
        }
    }

    /// Checks all segments.
    fn segments(&mut self) {
        for (_, transition) in self.chart.transitions() {
            let source = self.names.name(transition.source);
            let wrong = [
                ("a weight", transition.weight.is_some()),
                ("a priority", transition.priority != 0),
                ("the mark that it interrupts", transition.interrupts),
            ];
            for (what, _) in wrong.into_iter().filter(|(_, present)| *present) {
                self.refuse(format!(
                    "a transition out of `{source}` has {what}, which SCXML cannot represent"
                ));
            }
        }
    }

    fn document(&mut self) {
        let document = self.document;
        self.writer.open("scxml");
        self.writer.attribute("xmlns", NAMESPACE);
        self.writer.attribute("version", "1.0");
        self.writer.attribute(
            "datamodel",
            match document.data_model {
                DataModel::Null => "null",
                DataModel::Ecmascript => "ecmascript",
            },
        );
        if document.binding == DataBinding::Late {
            self.writer.attribute("binding", "late");
        }
        if let Some(name) = &document.name {
            self.text_fits(name);
            self.writer.attribute("name", name);
        }
        let root = self.node(Statechart::ROOT);
        if !root.entry.is_empty() || !root.exit.is_empty() {
            self.refuse("the root has actions, which SCXML cannot represent");
        }
        self.state_features(Statechart::ROOT);
        let start = self.initial(Statechart::ROOT);
        self.initial_element(start);
        self.declarations(Statechart::ROOT);
        if let Some(script) = &document.script {
            self.script(script);
        }
        for &child in self.chart.children(Statechart::ROOT) {
            self.child(child);
        }
        self.writer.close();
    }

    fn script(&mut self, script: &ScriptSource) {
        self.writer.open("script");
        match script {
            ScriptSource::Inline(code) => self.writer.text(&code.text),
            ScriptSource::Uri(uri) => self.writer.attribute("src", uri),
        }
        self.writer.close();
    }

    fn text_fits(&mut self, text: &str) {
        if !is_xml(text) {
            self.refuse(format!("`{}` holds characters that XML cannot hold", text.escape_debug()));
        }
    }

    fn child(&mut self, id: NodeId) {
        let node = self.node(id);
        match node.kind {
            NodeKind::Or | NodeKind::Basic => self.state("state", id),
            NodeKind::And => self.state("parallel", id),
            NodeKind::End => self.state("final", id),
            NodeKind::ShallowHistory => self.history("shallow", id),
            NodeKind::DeepHistory => self.history("deep", id),
            NodeKind::Start | NodeKind::Fork => {}
            kind => {
                let path = self.names.name(id);
                self.refuse(format!("`{path}` is a {kind:?}, which SCXML cannot represent"));
                // The losses of its transitions are listed too; the document is refused already.
                for transition in self.out_of(id) {
                    self.transition(transition);
                }
            }
        }
    }

    fn state(&mut self, tag: &'static str, id: NodeId) {
        let node = self.node(id);
        self.writer.open(tag);
        if !node.name.is_empty() {
            self.writer.attribute("id", &node.name);
        }
        self.state_features(id);
        if node.kind == NodeKind::Or {
            let start = self.initial(id);
            self.initial_element(start);
        }
        self.declarations(id);
        self.block("onentry", &node.entry, id);
        self.block("onexit", &node.exit, id);
        for transition in self.out_of(id) {
            self.transition(transition);
        }
        for (_, invoke) in self.document.invokes.iter().filter(|(state, _)| *state == id) {
            self.invoke(invoke);
        }
        for (_, payload) in self.document.done_data.iter().filter(|(state, _)| *state == id) {
            self.writer.open("donedata");
            payload_elements(&mut self.writer, payload);
            self.writer.close();
        }
        for &child in self.chart.children(id) {
            self.child(child);
        }
        self.writer.close();
    }

    /// Checks properties of a state that SCXML cannot express.
    fn state_features(&mut self, id: NodeId) {
        let node = self.node(id);
        let features = [
            ("an activity", node.activity.is_some()),
            ("a priority", node.priority != 0),
            ("a duration", node.duration.is_some()),
            ("deferred events", !node.defer.is_empty()),
        ];
        for (what, _) in features.into_iter().filter(|(_, present)| *present) {
            let path = self.names.name(id);
            self.refuse(format!("`{path}` has {what}, which SCXML cannot represent"));
        }
    }

    /// The START of a composite: written as an attribute if it has no actions.
    fn initial(&mut self, composite: NodeId) -> Option<&'a Transition> {
        let starts = self.chart.children(composite).iter();
        let starts: Vec<_> = starts.filter(|&&child| self.node(child).kind == NodeKind::Start).collect();
        let path = self.names.name(composite);
        let &[&start] = starts.as_slice() else {
            self.refuse(format!("`{path}` has {} STARTs; in SCXML it has one", starts.len()));
            return None;
        };
        let transitions = self.out_of(start);
        let &[transition] = transitions.as_slice() else {
            self.refuse(format!(
                "the START of `{path}` has {} outgoing transitions; in SCXML it has one",
                transitions.len()
            ));
            return None;
        };
        self.node_features_of_connector(start);
        if transition.expression.guard.is_some() || transition.expression.trigger.is_some() {
            self.refuse(format!(
                "the START of `{path}` has a guard or trigger, which SCXML cannot represent"
            ));
        }
        if !transition.expression.actions.is_empty() {
            return Some(transition);
        }
        let targets = self.targets(transition);
        self.writer.attribute("initial", &targets);
        None
    }

    fn node_features_of_connector(&mut self, id: NodeId) {
        let node = self.node(id);
        if !node.name.is_empty() && !is_named(node.kind) {
            let path = self.names.name(id);
            self.refuse(format!("`{path}` has a name, which SCXML cannot represent"));
        }
        if !node.entry.is_empty() || !node.exit.is_empty() {
            let path = self.names.name(id);
            self.refuse(format!("`{path}` has actions, which SCXML cannot represent"));
        }
        self.state_features(id);
    }

    fn initial_element(&mut self, transition: Option<&Transition>) {
        if let Some(own) = transition {
            self.writer.open("initial");
            self.transition(own);
            self.writer.close();
        }
    }

    fn history(&mut self, kind: &str, id: NodeId) {
        if self.node(id).parent == Some(Statechart::ROOT) {
            let path = self.names.name(id);
            self.refuse(format!("`{path}` is a history of the whole document, which SCXML cannot represent"));
        }
        self.node_features_of_connector(id);
        self.writer.open("history");
        let node = self.node(id);
        if !node.name.is_empty() {
            self.writer.attribute("id", &node.name);
        }
        self.writer.attribute("type", kind);
        let transitions = self.out_of(id);
        if let &[transition] = transitions.as_slice() {
            if transition.expression.guard.is_some() || transition.expression.trigger.is_some() {
                let path = self.names.name(id);
                self.refuse(format!(
                    "the outgoing transition of `{path}` has a guard or trigger, which SCXML cannot represent"
                ));
            }
            self.transition(transition);
        } else {
            let path = self.names.name(id);
            self.refuse(format!(
                "`{path}` has {} outgoing transitions; in SCXML it has one",
                transitions.len()
            ));
        }
        self.writer.close();
    }

    fn transition(&mut self, transition: &Transition) {
        let expression = &transition.expression;
        self.writer.open("transition");
        if let Some(trigger) = &expression.trigger {
            self.trigger(trigger, transition);
        }
        if let Some(guard) = &expression.guard {
            match condition_text(self.chart, guard) {
                Some(text) => {
                    self.text_fits(&text);
                    self.writer.attribute("cond", &text);
                }
                None => self.refuse(format!("the guard `{guard}` cannot be said in SCXML")),
            }
        }
        self.kind_and_target(transition);
        self.actions(&expression.actions, &self.names.name(transition.source));
        self.writer.close();
    }

    fn kind_and_target(&mut self, transition: &Transition) {
        let (source, target) = (transition.source, transition.target);
        if transition.internal && source == target {
            return;
        }
        if transition.internal {
            if self.node(source).kind != NodeKind::Or {
                let path = self.names.name(source);
                self.refuse(format!(
                    "a transition of `{path}` stays inside; in SCXML only a `state` with states in it can have it"
                ));
            }
            self.writer.attribute("type", "internal");
        }
        let targets = self.targets(transition);
        self.writer.attribute("target", &targets);
    }

    fn trigger(&mut self, trigger: &Trigger, transition: &Transition) {
        let events: Vec<String> = match trigger {
            Trigger::Any => vec!["*".into()],
            Trigger::OneOf(events) => events.iter().map(Path::text).collect(),
            Trigger::Not(event) => {
                let source = self.names.name(transition.source);
                self.refuse(format!("`not {event}` out of `{source}` cannot be said in SCXML"));
                return;
            }
        };
        for event in events.iter().filter(|event| !is_event(event) && *event != "*") {
            self.refuse(format!("`{event}` cannot be the name of an event in SCXML"));
        }
        self.writer.attribute("event", &events.join(" "));
    }

    /// The names of the target states of a segment.
    fn targets(&mut self, transition: &Transition) -> String {
        let target = transition.target;
        let targets = match self.node(target).kind {
            NodeKind::Fork => self.branches(target),
            _ => vec![target],
        };
        let mut names = Vec::new();
        for target in targets {
            let node = self.node(target);
            let path = || self.names.name(target);
            if !is_named(node.kind) {
                self.refuse(format!("`{}` cannot be the target of a transition in SCXML", path()));
            } else if node.name.is_empty() {
                self.refuse(format!("`{}` has no name, by which SCXML refers to a target", path()));
            }
            names.push(node.name.as_str());
        }
        names.join(" ")
    }

    fn branches(&mut self, fork: NodeId) -> Vec<NodeId> {
        self.node_features_of_connector(fork);
        let path = self.names.name(fork);
        if self.incoming.get(&fork).copied().unwrap_or(0) > 1 {
            self.refuse(format!("several transitions lead to `{path}`, which SCXML cannot represent"));
        }
        let transitions = self.out_of(fork);
        if transitions.iter().any(|transition| !transition.expression.is_empty() || transition.internal) {
            self.refuse(format!(
                "transitions out of `{path}` have triggers, guards or actions, which SCXML cannot represent"
            ));
        }
        transitions.iter().map(|transition| transition.target).collect()
    }

    fn block(&mut self, tag: &'static str, actions: &[Action], id: NodeId) {
        // A failure in one block does not affect the next, so each script is a separate block.
        let is_script = |action: &Action| matches!(action.kind, ActionKind::Script(_));
        let path = self.names.name(id);
        for block in actions.chunk_by(|a, b| !is_script(a) && !is_script(b)) {
            self.writer.open(tag);
            self.actions(block, &path);
            self.writer.close();
        }
    }

    fn actions(&mut self, actions: &[Action], owner: &str) {
        let scripts = actions.iter().filter(|action| matches!(action.kind, ActionKind::Script(_))).count();
        if scripts > 0 && actions.len() > 1 {
            self.refuse(format!(
                "a script of `{owner}` stands among other actions, which SCXML cannot represent"
            ));
        }
        for action in actions {
            match &action.kind {
                ActionKind::Raise(event) => {
                    if !is_event(&event.text()) {
                        self.refuse(format!("`{event}` cannot be the name of an event in SCXML"));
                    }
                    self.writer.open("raise");
                    self.writer.attribute("event", &event.text());
                    self.writer.close();
                }
                ActionKind::Script(text) => self.script_block(text),
                _ => self.refuse(format!("the action `{action}` cannot be said in SCXML")),
            }
        }
    }

    fn script_block(&mut self, text: &str) {
        match super::read::read_block(text, self.document.data_model) {
            Ok(block) => self.writer.raw(&block_text(&block)),
            Err(found) => {
                for diagnostic in found.iter().filter(|diagnostic| diagnostic.is_error()) {
                    self.refuse(format!("a script is not SCXML content: {}", diagnostic.message));
                }
            }
        }
    }

    fn declarations(&mut self, state: NodeId) {
        let mut declared = self.document.data.iter().filter(|data| data.state == state).peekable();
        if declared.peek().is_none() {
            return;
        }
        self.writer.open("datamodel");
        for data in declared {
            self.writer.open("data");
            self.writer.attribute("id", &data.name);
            source_into(&mut self.writer, &data.value);
            self.writer.close();
        }
        self.writer.close();
    }
}

/// Whether nodes of that kind have ids in SCXML.
fn is_named(kind: NodeKind) -> bool {
    use NodeKind::{And, Basic, DeepHistory, End, Or, ShallowHistory};
    matches!(kind, And | Basic | DeepHistory | End | Or | ShallowHistory)
}

fn is_event(name: &str) -> bool {
    let tokens = name.split('.').all(|token| !token.is_empty());
    tokens && is_xml(name) && !name.contains(|letter: char| letter.is_whitespace() || "`*".contains(letter))
}
