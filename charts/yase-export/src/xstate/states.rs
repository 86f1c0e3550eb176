//! One state of the machine's configuration.

use super::super::json::JsonValue;
use super::super::notation::{kind_word, modifiers};
use super::transitions::ResolvedTransition;
use super::{XStateTrigger, XStateWriter};
use yase::expression::Action;
use yase::statechart::{ConstantValue, NodeId, NodeKind, Statechart};

type JsonMembers = Vec<(String, JsonValue)>;

/// Transitions by trigger.
#[derive(Default)]
struct TransitionsByTrigger {
    on: JsonMembers,
    after: JsonMembers,
    done: Vec<JsonValue>,
    always: Vec<JsonValue>,
}

impl XStateWriter<'_> {
    /// Writes a state up to its children.
    pub(crate) fn open(&mut self, id: NodeId) {
        self.compare(id);
        let key = self.ids.of_node(id).to_owned();
        self.writer.open((id != Statechart::ROOT).then_some(key.as_str()));
        self.writer.value("id", &JsonValue::from(key.as_str()));
        self.head(id);
        let TransitionsByTrigger { on, after, done, always } = self.table(id);
        self.entries("on", on);
        self.entries("after", after);
        self.list("always", always);
        if self.waits_when_done(id) {
            self.working(id, &key, done);
        } else {
            self.content(id, &key, done);
        }
    }

    /// Closes the state that [`open`](XStateWriter::open) opened.
    pub(crate) fn close(&mut self, id: NodeId) {
        if !self.chart.children(id).is_empty() || id == Statechart::ROOT {
            self.writer.close();
        }
        if self.waits_when_done(id) {
            self.writer.close();
            self.writer.close();
        }
        self.writer.close();
    }

    /// Writes the properties of a state.
    fn head(&mut self, id: NodeId) {
        let node = self.chart.node(id);
        let inner = !self.chart.children(id).is_empty();
        match node.kind {
            NodeKind::End if !inner => self.writer.value("type", &"final".into()),
            NodeKind::ShallowHistory | NodeKind::DeepHistory if !inner => self.history(id),
            _ => {}
        }
        if id == Statechart::ROOT && !self.chart.constants.is_empty() {
            self.constants();
        }
        self.meta(id);
        self.list("entry", actions(&node.entry));
        self.list("exit", actions(&node.exit));
    }

    fn meta(&mut self, id: NodeId) {
        let node = self.chart.node(id);
        let mut meta: JsonMembers = vec![("kind".into(), kind_word(node.kind).into())];
        if !node.name.is_empty() {
            meta.push(("name".into(), node.name.as_str().into()));
        }
        if node.priority != 0 {
            meta.push(("priority".into(), JsonValue::Number(node.priority.into())));
            self.lost.of_node(id, "the priority");
        }
        if !node.defer.is_empty() {
            let events = node.defer.iter().map(|event| event.as_str().into()).collect();
            meta.push(("defer".into(), JsonValue::List(events)));
            self.lost.of_node(id, "the deferred events");
        }
        if let Some(duration) = node.duration {
            meta.push(("milliseconds".into(), JsonValue::Number(duration.as_nanos() as f64 / 1e6)));
            self.lost.of_node(id, "the duration");
        }
        self.writer.value("meta", &JsonValue::Object(meta));
    }

    fn constants(&mut self) {
        let value = |value: &ConstantValue| match value {
            ConstantValue::Bool(value) => JsonValue::Bool(*value),
            ConstantValue::Number(value) => JsonValue::Number(*value),
            ConstantValue::Text(value) => value.as_str().into(),
        };
        let constants = self.chart.constants.iter().map(|it| (it.name.clone(), value(&it.value)));
        self.writer.value("context", &JsonValue::Object(constants.collect()));
    }

    /// The default of a history is its path without trigger and guard.
    fn history(&mut self, id: NodeId) {
        let deep = self.chart.node(id).kind == NodeKind::DeepHistory;
        self.writer.value("type", &"history".into());
        self.writer.value("history", &if deep { "deep" } else { "shallow" }.into());
        let transitions = &self.transitions[id.0 as usize];
        if let Some(transition) = transitions.first() {
            self.writer.value("target", &self.targets(transition));
        }
        for (index, path) in transitions.iter().enumerate() {
            let Some(first) = path.segments.first() else { continue };
            for connector in path.via(self.chart) {
                self.lost.kind(connector, "nothing, because it is on the path from a history to its default");
            }
            let says_more = path.segments.iter().any(|segment| !segment.expression.is_empty());
            if index > 0 {
                self.lost.report_omitted(format!("{} is a second default", self.lost.arrow(first)));
            } else if says_more || !path.via(self.chart).is_empty() {
                self.lost.of_transition(first, "more than the target");
            }
        }
    }

    /// Splits a state in two: in one it is working, in the other it has completed and waits for a
    /// guard.
    fn working(&mut self, id: NodeId, key: &str, done: Vec<JsonValue>) {
        let completed = format!("{key}:completed");
        self.writer.value("initial", &"working".into());
        self.writer.open(Some("states"));
        self.writer.open(Some("completed"));
        self.writer.value("id", &completed.as_str().into());
        self.list("always", done);
        self.writer.close();
        self.writer.open(Some("working"));
        let target = JsonValue::Object(vec![("target".into(), format!("#{completed}").into())]);
        self.content(id, key, vec![target]);
    }

    /// Writes activity and children, and the transitions on their completion.
    fn content(&mut self, id: NodeId, key: &str, done: Vec<JsonValue>) {
        let node = self.chart.node(id);
        let inner = !self.chart.children(id).is_empty();
        if let Some(activity) = &node.activity {
            let mut invoke: JsonMembers = vec![
                ("src".into(), activity.as_str().into()),
                ("id".into(), format!("{key}:activity").into()),
            ];
            if !done.is_empty() {
                invoke.push(("onDone".into(), JsonValue::List(done)));
            }
            self.writer.value("invoke", &JsonValue::Object(invoke));
        } else {
            self.list("onDone", done);
        }
        if node.kind == NodeKind::And && inner {
            self.writer.value("type", &"parallel".into());
        } else if inner {
            self.initial(id);
        }
        if inner || id == Statechart::ROOT {
            self.writer.open(Some("states"));
        }
    }

    fn initial(&mut self, id: NodeId) {
        let children = self.chart.children(id);
        let merged = children.iter().copied().find(|child| self.merged[child.0 as usize]);
        let transition = merged.and_then(|start| self.transitions[start.0 as usize].first());
        if let Some(path) = transition {
            let target: JsonValue = path.targets.first().map_or("", |&it| self.ids.of_node(it)).into();
            let actions: Vec<JsonValue> =
                path.segments.iter().flat_map(|it| actions(&it.expression.actions)).collect();
            let initial = match actions.is_empty() {
                true => target,
                false => JsonValue::Object(vec![
                    ("target".into(), target),
                    ("actions".into(), JsonValue::List(actions)),
                ]),
            };
            self.writer.value("initial", &initial);
            return;
        }
        let states = || children.iter().copied().filter(|&child| self.is_state(child));
        let start = states().find(|&child| self.chart.node(child).kind == NodeKind::Start);
        if let Some(first) = start.or_else(|| states().next()) {
            self.writer.value("initial", &self.ids.of_node(first).into());
        }
        if start.is_none() {
            self.lost.of_node(id, "that there is no START");
        }
    }

    /// A final state of the root.
    pub(crate) fn terminate(&mut self, id: NodeId) {
        self.lost.kind(id, "a final state of the root: all states are left with their exit actions");
        let key = self.ids.of_node(id).to_owned();
        self.writer.open(Some(&key));
        self.writer.value("id", &key.as_str().into());
        self.writer.value("type", &"final".into());
        self.meta(id);
        self.writer.close();
    }

    fn table(&self, id: NodeId) -> TransitionsByTrigger {
        let mut table = TransitionsByTrigger::default();
        let is_history = matches!(self.chart.node(id).kind, NodeKind::ShallowHistory | NodeKind::DeepHistory);
        if is_history && self.chart.children(id).is_empty() {
            return table;
        }
        for transition in &self.transitions[id.0 as usize] {
            match self.occasion(id, transition) {
                XStateTrigger::On(events) => {
                    for event in events {
                        add(
                            &mut table.on,
                            event,
                            self.transition(id, transition, transition.guard(self.chart)),
                        );
                    }
                }
                XStateTrigger::After(delay) => {
                    add(&mut table.after, delay, self.transition(id, transition, None))
                }
                XStateTrigger::Done => {
                    table.done.push(self.transition(id, transition, transition.guard(self.chart)))
                }
                XStateTrigger::Always => {
                    table.always.push(self.transition(id, transition, transition.guard(self.chart)))
                }
            }
        }
        table
    }

    fn transition(
        &self,
        id: NodeId,
        transition: &ResolvedTransition<'_>,
        guard: Option<String>,
    ) -> JsonValue {
        let mut entries: JsonMembers = Vec::new();
        let internal = transition.segments.first().is_some_and(|first| first.internal);
        if !(internal && transition.targets == [id]) {
            entries.push(("target".into(), self.targets(transition)));
        }
        entries.extend(guard.map(|guard| ("guard".into(), guard.into())));
        let actions: Vec<JsonValue> =
            transition.segments.iter().flat_map(|it| actions(&it.expression.actions)).collect();
        if !actions.is_empty() {
            entries.push(("actions".into(), JsonValue::List(actions)));
        }
        let stays = |&target: &NodeId| target == id || self.chart.ancestors(target).any(|it| it == id);
        if !internal && transition.joined.is_empty() && transition.targets.iter().any(stays) {
            entries.push(("reenter".into(), JsonValue::Bool(true)));
        }
        let meta = self.path_meta(transition);
        if !meta.is_empty() {
            entries.push(("meta".into(), JsonValue::Object(meta)));
        }
        JsonValue::Object(entries)
    }

    /// The connectors of a path, and the properties of its segments besides their expressions.
    fn path_meta(&self, transition: &ResolvedTransition<'_>) -> JsonMembers {
        let mut meta = JsonMembers::new();
        let via: Vec<JsonValue> =
            transition.via(self.chart).into_iter().map(|id| self.connector(id)).collect();
        if !via.is_empty() {
            meta.push(("via".into(), JsonValue::List(via)));
        }
        let said: Vec<JsonValue> = transition
            .segments
            .iter()
            .map(|segment| modifiers(segment).trim().to_owned())
            .filter(|said| !said.is_empty())
            .map(JsonValue::from)
            .collect();
        if !said.is_empty() {
            meta.push(("modifiers".into(), JsonValue::List(said)));
        }
        meta
    }

    fn connector(&self, id: NodeId) -> JsonValue {
        let node = self.chart.node(id);
        format!("{} {}", kind_word(node.kind), node.name).trim_end().into()
    }

    fn targets(&self, transition: &ResolvedTransition<'_>) -> JsonValue {
        let target = |id: &NodeId| JsonValue::from(format!("#{}", self.ids.of_node(*id)));
        match transition.targets.as_slice() {
            [only] => target(only),
            several => JsonValue::List(several.iter().map(target).collect()),
        }
    }

    fn entries(&mut self, key: &str, entries: JsonMembers) {
        if !entries.is_empty() {
            self.writer.value(key, &JsonValue::Object(entries));
        }
    }

    fn list(&mut self, key: &str, items: Vec<JsonValue>) {
        if !items.is_empty() {
            self.writer.value(key, &JsonValue::List(items));
        }
    }
}

/// Adds a transition after those for the same event.
fn add(entries: &mut JsonMembers, key: String, transition: JsonValue) {
    match entries.iter_mut().find(|(other, _)| *other == key) {
        Some((_, JsonValue::List(transitions))) => transitions.push(transition),
        _ => entries.push((key, JsonValue::List(vec![transition]))),
    }
}

/// Actions by their canonical texts.
fn actions(actions: &[Action]) -> Vec<JsonValue> {
    actions.iter().map(|action| action.to_string().into()).collect()
}
