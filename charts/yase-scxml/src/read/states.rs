//! States, histories and transitions.

use crate::lexical::is_id;
use roxmltree::Node as Element;

use super::{DocumentReader, PendingTransition, TargetReference};
use crate::content::{Block, ExecutableContent};
use crate::document::{DataBinding, DataDeclaration, DataModel};
use crate::guard::event_path;
use crate::language::is_variable;
use crate::write::block_text;
use crate::xml::{elements, is_scxml, tag};
use yase::diagnostic::{Diagnostic, Span};
use yase::expression::{Action, ActionKind, Trigger};
use yase::statechart::{Node, NodeId, NodeKind, Statechart};

const STATES: [&str; 3] = ["state", "parallel", "final"];

impl DocumentReader<'_> {
    /// The `<scxml>` element.
    pub(crate) fn root(&mut self, element: Element<'_, '_>) {
        self.check(element);
        self.language(element);
        self.binding(element);
        if let Some(version) = element.attribute("version").filter(|version| version.trim() != "1.0") {
            let message = format!("version `{version}` is unknown and is read as 1.0");
            let span = self.value_span(element, "version");
            self.report(Diagnostic::warning("E0609", span, message));
        }
        if !elements(element).any(is_state) {
            self.error("E0604", tag(element), "the document has no states");
        }
        self.start(element, Statechart::ROOT);
        self.inside(element, Statechart::ROOT);
    }

    fn language(&mut self, element: Element<'_, '_>) {
        let span = self.value_span(element, "datamodel");
        self.data_model = match element.attribute("datamodel") {
            None | Some("ecmascript") => DataModel::Ecmascript,
            Some("null") => DataModel::Null,
            Some(other) => {
                let message = format!("the data model `{other}` is not supported");
                self.error("E0612", span, message).hint =
                    Some("the data models are `null` and `ecmascript`".into());
                DataModel::Ecmascript
            }
        };
    }

    fn binding(&mut self, element: Element<'_, '_>) {
        let span = self.value_span(element, "binding");
        self.binding = match element.attribute("binding") {
            None | Some("early") => DataBinding::Early,
            Some("late") => DataBinding::Late,
            Some(other) => {
                let message = format!("`{other}` is not a binding: it is `early` or `late`");
                self.error("E0609", span, message);
                DataBinding::Early
            }
        };
    }

    fn state(&mut self, element: Element<'_, '_>, parent: NodeId) {
        self.check(element);
        let composite = elements(element).any(is_state);
        let kind = match element.tag_name().name() {
            "final" => NodeKind::End,
            "parallel" if composite => NodeKind::And,
            "state" if composite => NodeKind::Or,
            "parallel" => {
                let message = "a `parallel` without regions is read as a `state`";
                self.report(Diagnostic::warning("E0619", tag(element), message));
                NodeKind::Basic
            }
            _ => NodeKind::Basic,
        };
        let id = self.node(element, parent, kind);
        if kind == NodeKind::Or {
            self.start(element, id);
        } else if element.has_attribute("initial") || elements(element).any(is_initial) {
            self.error("E0615", tag(element), "a state without states in it has no initial one");
        }
        self.inside(element, id);
    }

    fn node(&mut self, element: Element<'_, '_>, parent: NodeId, kind: NodeKind) -> NodeId {
        let node = self.statechart.add(parent, Node::new(kind, ""));
        let Some(name) = element.attribute("id") else {
            self.unnamed.push(node);
            return node;
        };
        let span = self.value_span(element, "id");
        if !is_id(name) {
            self.error("E0617", span, format!("`{name}` is not an id")).hint = Some(
                "an id is letters, digits, `_`, `-`, `.` and `:`, and does not begin with a digit".into(),
            );
        }
        self.statechart.node_mut(node).name = name.to_owned();
        if self.ids.insert(name.to_owned(), node).is_some() {
            self.error("E0605", span, format!("two states have the id `{name}`"));
        }
        node
    }

    /// The children of a state: its own first, then nested states, in the order in which they are
    /// written back.
    fn inside(&mut self, element: Element<'_, '_>, id: NodeId) {
        let children = self.scxml_children(element);
        for &child in &children {
            self.part(child, id);
        }
        for child in children {
            match child.tag_name().name() {
                "state" | "parallel" | "final" => self.state(child, id),
                "history" => self.history(child, id),
                _ => {}
            }
        }
    }

    fn part(&mut self, element: Element<'_, '_>, id: NodeId) {
        match element.tag_name().name() {
            "transition" => self.transition(element, id, None),
            "onentry" => {
                let actions = self.actions(element);
                self.statechart.node_mut(id).entry.extend(actions);
            }
            "onexit" => {
                let actions = self.actions(element);
                self.statechart.node_mut(id).exit.extend(actions);
            }
            "datamodel" => self.declarations(element, id),
            "invoke" => {
                let invoke = self.invoke(element);
                self.invokes.push((id, invoke));
            }
            "donedata" => {
                self.check(element);
                let payload = self.payload(element);
                self.done_data.push((id, payload));
            }
            "script" if id == Statechart::ROOT => self.document_script(element),
            _ => {}
        }
    }

    fn document_script(&mut self, element: Element<'_, '_>) {
        if self.data_model == DataModel::Null {
            self.not_in_null(tag(element), "a `script`");
        }
        self.check(element);
        let script = self.script(element);
        if self.script.replace(script).is_some() {
            self.error("E0615", tag(element), "the document has two scripts");
        }
    }

    fn declarations(&mut self, element: Element<'_, '_>, state: NodeId) {
        self.check(element);
        for child in self.scxml_children(element) {
            self.check(child);
            if self.data_model == DataModel::Null {
                self.not_in_null(tag(child), "a variable");
            }
            let value = self.source(child);
            let Some(name) = child.attribute("id").map(str::to_owned) else { continue };
            let span = self.value_span(child, "id");
            if !is_variable(&name) {
                self.error("E0617", span, format!("`{name}` is not the name of a variable"));
            }
            if !self.variables.insert(name.clone()) {
                self.error("E0605", span, format!("two variables are called `{name}`"));
            }
            self.data.push(DataDeclaration { state, name, value });
        }
    }

    /// The START of a composite: `initial`, `<initial>`, or the first state.
    fn start(&mut self, element: Element<'_, '_>, composite: NodeId) {
        let start = self.statechart.add(composite, Node::new(NodeKind::Start, ""));
        let initials: Vec<_> = elements(element).filter(|&child| is_initial(child)).collect();
        let attribute = element.has_attribute("initial");
        self.exclude(
            element,
            &[("an attribute `initial`", attribute), ("an element `initial`", !initials.is_empty())],
        );
        if let Some(second) = initials.get(1) {
            self.error("E0615", tag(*second), "a state has one `initial`");
        }
        match (attribute, initials.first()) {
            (false, Some(initial)) => {
                self.check(*initial);
                self.only_transition(*initial, start, composite);
            }
            (true, _) => {
                let targets = self.targets(element, "initial");
                let span = self.value_span(element, "initial");
                self.pending.push(PendingTransition::unconditional(start, targets, span, composite));
            }
            (false, None) => {
                self.pending.push(PendingTransition::unconditional(
                    start,
                    Vec::new(),
                    tag(element),
                    composite,
                ));
            }
        }
    }

    /// The one transition of an `<initial>` or a `<history>`.
    fn only_transition(&mut self, element: Element<'_, '_>, source: NodeId, composite: NodeId) {
        let transitions: Vec<_> = elements(element)
            .filter(|child| is_scxml(*child) && child.tag_name().name() == "transition")
            .collect();
        let [only] = transitions.as_slice() else {
            let message = format!("`{}` has {} transitions", element.tag_name().name(), transitions.len());
            self.error("E0615", tag(element), message).hint = Some("it has exactly one".into());
            return;
        };
        for name in ["event", "cond"].into_iter().filter(|name| only.has_attribute(*name)) {
            let message = format!("the transition of `{}` has no `{name}`", element.tag_name().name());
            self.error("E0615", tag(*only), message);
        }
        if !only.has_attribute("target") {
            self.error("E0604", tag(*only), "`transition` lacks the attribute `target`");
        }
        self.transition(*only, source, Some(composite));
    }

    fn history(&mut self, element: Element<'_, '_>, parent: NodeId) {
        self.check(element);
        let kind = match element.attribute("type") {
            None | Some("shallow") => NodeKind::ShallowHistory,
            Some("deep") => NodeKind::DeepHistory,
            Some(other) => {
                let message = format!("`{other}` is not a history: it is `shallow` or `deep`");
                let span = self.value_span(element, "type");
                self.error("E0609", span, message);
                NodeKind::ShallowHistory
            }
        };
        let id = self.node(element, parent, kind);
        self.only_transition(element, id, parent);
    }

    fn transition(&mut self, element: Element<'_, '_>, source: NodeId, within: Option<NodeId>) {
        let block = self.block(element);
        let internal = match element.attribute("type") {
            None | Some("external") => false,
            Some("internal") => true,
            Some(other) => {
                let message = format!("`{other}` is not a type: it is `internal` or `external`");
                let span = self.value_span(element, "type");
                self.error("E0609", span, message);
                false
            }
        };
        let condition = if within.is_some() { None } else { self.expression(element, "cond") };
        let trigger = if within.is_some() { None } else { self.trigger(element) };
        if within.is_none() && !["event", "cond", "target"].iter().any(|name| element.has_attribute(*name)) {
            let message = "the transition has neither event nor condition nor target: it is taken for ever";
            self.report(Diagnostic::warning("E0604", tag(element), message));
        }
        let targets = self.targets(element, "target");
        let span = tag(element);
        let condition = condition.map(|code| (code, self.value_span(element, "cond")));
        self.pending.push(PendingTransition {
            source,
            targets,
            internal,
            trigger,
            condition,
            block,
            span,
            within,
        });
    }

    fn targets(&mut self, element: Element<'_, '_>, name: &str) -> Vec<TargetReference> {
        let Some(given) = element.attribute_node(name) else { return Vec::new() };
        let whole: Span = given.range_value().into();
        let written = self.text.get(whole.start..whole.end) == Some(given.value());
        let value = given.value();
        if value.trim().is_empty() {
            self.error("E0609", whole, format!("`{name}` names no state"));
        }
        let place = |part: &str| match written {
            true => {
                let start = whole.start + (part.as_ptr() as usize - value.as_ptr() as usize);
                Span::new(start, start + part.len())
            }
            false => whole,
        };
        value
            .split_whitespace()
            .map(|part| TargetReference { name: part.to_owned(), span: place(part) })
            .collect()
    }

    fn trigger(&mut self, element: Element<'_, '_>) -> Option<Trigger> {
        let events = element.attribute("event")?;
        let span = self.value_span(element, "event");
        let mut paths = Vec::new();
        let mut any = false;
        for descriptor in events.split_whitespace() {
            if matches!(descriptor, "*" | ".*") {
                any = true;
                continue;
            }
            let name = descriptor.strip_suffix(".*").or(descriptor.strip_suffix('.')).unwrap_or(descriptor);
            if self.event_name(name, span) {
                paths.push(event_path(name, span));
            }
        }
        if paths.is_empty() && !any {
            if events.trim().is_empty() {
                self.error("E0609", span, "`event` names no event");
            }
            return None;
        }
        Some(if any { Trigger::Any } else { Trigger::OneOf(paths) })
    }

    fn actions(&mut self, element: Element<'_, '_>) -> Vec<Action> {
        let block = self.block(element);
        actions(&block, tag(element))
    }

    /// Gives each state without an id a unique name.
    pub(crate) fn name_the_unnamed(&mut self) {
        let mut number = 0;
        for node in std::mem::take(&mut self.unnamed) {
            let name = loop {
                number += 1;
                let name = format!("state.{number}");
                if !self.ids.contains_key(&name) {
                    break name;
                }
            };
            self.statechart.node_mut(node).name.clone_from(&name);
            self.ids.insert(name, node);
        }
    }
}

/// The actions of a chart for a block: raised events directly, everything else as a script.
pub(crate) fn actions(block: &Block, span: Span) -> Vec<Action> {
    let position = yase::expression::TextPosition(span);
    let raised = block.iter().map(|content| match content {
        ExecutableContent::Raise(event) => {
            Some(Action { kind: ActionKind::Raise(event_path(event, span)), position })
        }
        _ => None,
    });
    match raised.collect::<Option<Vec<_>>>() {
        Some(actions) => actions,
        None => vec![Action { kind: ActionKind::Script(block_text(block)), position }],
    }
}

fn is_state(element: Element<'_, '_>) -> bool {
    is_scxml(element) && STATES.contains(&element.tag_name().name())
}

fn is_initial(element: Element<'_, '_>) -> bool {
    is_scxml(element) && element.tag_name().name() == "initial"
}
