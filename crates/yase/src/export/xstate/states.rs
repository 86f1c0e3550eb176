//! One state of the machine's configuration.

use super::super::json::Json;
use super::super::notation::{kind_word, modifiers};
use super::ways::Way;
use super::{Machine, Occasion};
use crate::expression::Action;
use crate::statechart::{ConstantValue, NodeId, NodeKind, Statechart};

type Entries = Vec<(String, Json)>;

/// Transitions by what makes them happen.
#[derive(Default)]
struct Table {
    on: Entries,
    after: Entries,
    done: Vec<Json>,
    always: Vec<Json>,
}

impl Machine<'_> {
    /// Writes a state up to where its children begin.
    pub(super) fn open(&mut self, id: NodeId) {
        self.compare(id);
        let key = self.ids.of_node(id).to_owned();
        self.writer.open((id != Statechart::ROOT).then_some(key.as_str()));
        self.writer.value("id", &Json::from(key.as_str()));
        self.head(id);
        let Table { on, after, done, always } = self.table(id);
        self.entries("on", on);
        self.entries("after", after);
        self.list("always", always);
        if self.waits_when_done(id) {
            self.working(id, &key, done);
        } else {
            self.content(id, &key, done);
        }
    }

    /// Closes what [`open`](Machine::open) opened.
    pub(super) fn close(&mut self, id: NodeId) {
        if !self.chart.children(id).is_empty() || id == Statechart::ROOT {
            self.writer.close();
        }
        if self.waits_when_done(id) {
            self.writer.close();
            self.writer.close();
        }
        self.writer.close();
    }

    /// What is said of a state itself.
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
        let mut meta: Entries = vec![("kind".into(), kind_word(node.kind).into())];
        if !node.name.is_empty() {
            meta.push(("name".into(), node.name.as_str().into()));
        }
        if node.priority != 0 {
            meta.push(("priority".into(), Json::Number(node.priority.into())));
            self.lost.of_node(id, "the priority");
        }
        if !node.defer.is_empty() {
            let events = node.defer.iter().map(|event| event.as_str().into()).collect();
            meta.push(("defer".into(), Json::List(events)));
            self.lost.of_node(id, "the deferred events");
        }
        if let Some(duration) = node.duration {
            meta.push(("milliseconds".into(), Json::Number(duration.as_secs_f64() * 1000.0)));
            self.lost.of_node(id, "the duration");
        }
        self.writer.value("meta", &Json::Object(meta));
    }

    fn constants(&mut self) {
        let value = |value: &ConstantValue| match value {
            ConstantValue::Bool(value) => Json::Bool(*value),
            ConstantValue::Number(value) => Json::Number(*value),
            ConstantValue::Text(value) => value.as_str().into(),
        };
        let constants = self.chart.constants.iter().map(|it| (it.name.clone(), value(&it.value)));
        self.writer.value("context", &Json::Object(constants.collect()));
    }

    /// A history's default is the plain way out of it.
    fn history(&mut self, id: NodeId) {
        let deep = self.chart.node(id).kind == NodeKind::DeepHistory;
        self.writer.value("type", &"history".into());
        self.writer.value("history", &if deep { "deep" } else { "shallow" }.into());
        let ways = &self.ways[id.0 as usize];
        if let Some(way) = ways.first() {
            self.writer.value("target", &self.targets(way));
        }
        for (index, way) in ways.iter().enumerate() {
            let Some(first) = way.segments.first() else { continue };
            for connector in way.via(self.chart) {
                self.lost.kind(connector, "nothing, as it lies on the way from a history to its default");
            }
            let says_more = way.segments.iter().any(|segment| !segment.expression.is_empty());
            if index > 0 {
                self.lost.left_out(format!("{} is a second default", self.lost.arrow(first)));
            } else if says_more || !way.via(self.chart).is_empty() {
                self.lost.of_transition(first, "more than the target");
            }
        }
    }

    /// A state of two: in one it works, in the other it has completed and waits for a guard.
    fn working(&mut self, id: NodeId, key: &str, done: Vec<Json>) {
        let completed = format!("{key}:completed");
        self.writer.value("initial", &"working".into());
        self.writer.open(Some("states"));
        self.writer.open(Some("completed"));
        self.writer.value("id", &completed.as_str().into());
        self.list("always", done);
        self.writer.close();
        self.writer.open(Some("working"));
        let target = Json::Object(vec![("target".into(), format!("#{completed}").into())]);
        self.content(id, key, vec![target]);
    }

    /// Activity and children, and what follows when these are done.
    fn content(&mut self, id: NodeId, key: &str, done: Vec<Json>) {
        let node = self.chart.node(id);
        let inner = !self.chart.children(id).is_empty();
        if let Some(activity) = &node.activity {
            let mut invoke: Entries = vec![
                ("src".into(), activity.as_str().into()),
                ("id".into(), format!("{key}:activity").into()),
            ];
            if !done.is_empty() {
                invoke.push(("onDone".into(), Json::List(done)));
            }
            self.writer.value("invoke", &Json::Object(invoke));
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
        let way = merged.and_then(|start| self.ways[start.0 as usize].first());
        if let Some(way) = way {
            let target: Json = way.targets.first().map_or("", |&it| self.ids.of_node(it)).into();
            let actions: Vec<Json> =
                way.segments.iter().flat_map(|it| actions(&it.expression.actions)).collect();
            let initial = match actions.is_empty() {
                true => target,
                false => {
                    Json::Object(vec![("target".into(), target), ("actions".into(), Json::List(actions))])
                }
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
    pub(super) fn terminate(&mut self, id: NodeId) {
        self.lost.kind(id, "a final state of the root: all states are left with their exit actions");
        let key = self.ids.of_node(id).to_owned();
        self.writer.open(Some(&key));
        self.writer.value("id", &key.as_str().into());
        self.writer.value("type", &"final".into());
        self.meta(id);
        self.writer.close();
    }

    fn table(&self, id: NodeId) -> Table {
        let mut table = Table::default();
        let is_history = matches!(self.chart.node(id).kind, NodeKind::ShallowHistory | NodeKind::DeepHistory);
        if is_history && self.chart.children(id).is_empty() {
            return table;
        }
        for way in &self.ways[id.0 as usize] {
            match self.occasion(id, way) {
                Occasion::On(events) => {
                    for event in events {
                        add(&mut table.on, event, self.transition(id, way, way.guard(self.chart)));
                    }
                }
                Occasion::After(delay) => add(&mut table.after, delay, self.transition(id, way, None)),
                Occasion::Done => table.done.push(self.transition(id, way, way.guard(self.chart))),
                Occasion::Always => table.always.push(self.transition(id, way, way.guard(self.chart))),
            }
        }
        table
    }

    fn transition(&self, id: NodeId, way: &Way<'_>, guard: Option<String>) -> Json {
        let mut entries: Entries = Vec::new();
        let internal = way.segments.first().is_some_and(|first| first.internal);
        if !(internal && way.targets == [id]) {
            entries.push(("target".into(), self.targets(way)));
        }
        entries.extend(guard.map(|guard| ("guard".into(), guard.into())));
        let actions: Vec<Json> = way.segments.iter().flat_map(|it| actions(&it.expression.actions)).collect();
        if !actions.is_empty() {
            entries.push(("actions".into(), Json::List(actions)));
        }
        let stays = |&target: &NodeId| target == id || self.chart.ancestors(target).any(|it| it == id);
        if !internal && way.joined.is_empty() && way.targets.iter().any(stays) {
            entries.push(("reenter".into(), Json::Bool(true)));
        }
        let meta = self.meta_of_way(way);
        if !meta.is_empty() {
            entries.push(("meta".into(), Json::Object(meta)));
        }
        Json::Object(entries)
    }

    /// The connectors of a way, and what is said of its segments besides their expressions.
    fn meta_of_way(&self, way: &Way<'_>) -> Entries {
        let mut meta = Entries::new();
        let via: Vec<Json> = way.via(self.chart).into_iter().map(|id| self.connector(id)).collect();
        if !via.is_empty() {
            meta.push(("via".into(), Json::List(via)));
        }
        let said: Vec<Json> = way
            .segments
            .iter()
            .map(|segment| modifiers(segment).trim().to_owned())
            .filter(|said| !said.is_empty())
            .map(Json::from)
            .collect();
        if !said.is_empty() {
            meta.push(("modifiers".into(), Json::List(said)));
        }
        meta
    }

    fn connector(&self, id: NodeId) -> Json {
        let node = self.chart.node(id);
        format!("{} {}", kind_word(node.kind), node.name).trim_end().into()
    }

    fn targets(&self, way: &Way<'_>) -> Json {
        let target = |id: &NodeId| Json::from(format!("#{}", self.ids.of_node(*id)));
        match way.targets.as_slice() {
            [only] => target(only),
            several => Json::List(several.iter().map(target).collect()),
        }
    }

    fn entries(&mut self, key: &str, entries: Entries) {
        if !entries.is_empty() {
            self.writer.value(key, &Json::Object(entries));
        }
    }

    fn list(&mut self, key: &str, items: Vec<Json>) {
        if !items.is_empty() {
            self.writer.value(key, &Json::List(items));
        }
    }
}

/// Adds a transition after those for the same event.
fn add(entries: &mut Entries, key: String, transition: Json) {
    match entries.iter_mut().find(|(other, _)| *other == key) {
        Some((_, Json::List(transitions))) => transitions.push(transition),
        _ => entries.push((key, Json::List(vec![transition]))),
    }
}

/// Actions by their canonical texts.
fn actions(actions: &[Action]) -> Vec<Json> {
    actions.iter().map(|action| action.to_string().into()).collect()
}
