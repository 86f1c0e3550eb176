//! One robot of a composition: the observable behaviour of its chart.
//!
//! A chart is explored alone, with its guards and triggers as free inputs. Each step keeps what is
//! observable: the message received, the conditions on received messages, the message sent, and the
//! wait that it ends. States with the same observable behaviour form one class.

use std::collections::BTreeMap;
use std::sync::Arc;

use yase::expression::{Expression, ExpressionKind, ScriptId, Trigger};
use yase::statechart::{Constant, ConstantValue};
use yase::{Diagnostic, NodeId, NodeKind, Source, Statechart, Status, TransitionId};
use yase_explore::{LabelledGraph, PendingEvent, StepCause, StepLabeler, StepObservation, explore_labelled};

use super::message_names::{
    self, MessageName, MessageReference, MessageUse, actions, message_reference, paths, triggers,
};
use crate::abstraction::Abstraction;
use crate::check_settings::CheckSettings;
use crate::checked_model::CheckedModel;
use crate::cone_of_influence;
use crate::conformance::graph::{Graph, LabelledEdge, Observable};
use crate::program_symbols::ProgramSymbols;

/// A field and the value assigned to it, if that is known.
pub(crate) type FieldSetting = (String, Option<String>);

/// The effects of a step on the other robots.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
pub(crate) struct StepInterface {
    /// The message it receives, as an index into the robot's received messages.
    pub(crate) receives: Option<usize>,
    /// Whether no state of the chart reads the received message, now or later.
    pub(crate) drops: bool,
    /// The conditions on messages of others that it evaluates, and their values.
    pub(crate) conditions: Vec<(ScriptId, bool)>,
    /// The messages it sends, as indices into the robot's sent messages, with the fields it sets.
    pub(crate) sends: Vec<(usize, Vec<FieldSetting>)>,
    /// The waits that it ends.
    pub(crate) exited_waits: Vec<usize>,
}

impl StepInterface {
    fn is_seen(&self) -> bool {
        *self != StepInterface::default()
    }
}

/// A message of a robot (another or itself) that a chart reads or waits for.
#[derive(Clone, Debug)]
pub(crate) struct ReceivedMessage {
    pub(crate) called: MessageReference,
    /// The name of its arrival in triggers, if a trigger waits for it.
    pub(crate) event: Option<String>,
    /// A transition that waits for it or reads it.
    pub(crate) transition: TransitionId,
}

/// A state in which a chart waits for messages of others.
#[derive(Clone, Debug)]
pub(crate) struct WaitingState {
    pub(crate) node: NodeId,
    /// The message it waits for, as an index into the robot's received messages.
    pub(crate) received_message: usize,
    /// The transition that would end the wait.
    pub(crate) transition: TransitionId,
}

/// A message that a chart sends.
#[derive(Clone, Debug)]
pub(crate) struct SentMessage {
    pub(crate) name: MessageName,
    /// The actions and activities that send it, at least one.
    pub(crate) uses: Vec<MessageUse>,
}

/// A robot prepared for composition.
pub(crate) struct ComposedRobot {
    pub(crate) name: String,
    /// The host on which its agent runs; empty if all robots are agents of one process.
    pub(crate) host: String,
    pub(crate) source: Arc<Source>,
    pub(crate) subject: CheckedModel,
    pub(crate) abstraction: Abstraction,
    pub(crate) received: Vec<ReceivedMessage>,
    pub(crate) sent: Vec<SentMessage>,
    pub(crate) waits: Vec<WaitingState>,
}

impl ComposedRobot {
    /// A robot among others.
    pub(crate) fn new(
        name: &str,
        source: &Arc<Source>,
        (subject, abstraction): (CheckedModel, Abstraction),
        deployment: RobotDeployment<'_>,
        world: Option<&ProgramSymbols>,
    ) -> ComposedRobot {
        let host = deployment.host.to_owned();
        let filter = MessageFilter::new(deployment, &subject.chart, world);
        let received = received_messages(&subject.chart, &filter);
        let waits = waits(&subject, &received, &filter);
        let sent = messages_to_send(&subject.chart, world);
        ComposedRobot {
            name: name.into(),
            host,
            source: source.clone(),
            subject,
            abstraction,
            received,
            sent,
            waits,
        }
    }

    /// An error if the chart refers to one message in two notations, which would be two events in
    /// the exploration and one in a run.
    pub(crate) fn ambiguous(&self) -> Option<Diagnostic> {
        let events = || self.received.iter().enumerate().filter(|(_, it)| it.event.is_some());
        let twice = events().find(|(index, it)| {
            events().any(|(other, that)| {
                other < *index
                    && that.called.host == it.called.host
                    && that.called.name.means(&it.called.name)
            })
        });
        twice.map(|(_, message)| {
            let text = format!("`{}` is awaited under two names", message.called.prefix.text());
            let found = Diagnostic::error("E0935", self.subject.spans.transition(message.transition), text);
            found.with_hint("use the same notation in each trigger").in_source(&self.source)
        })
    }

    /// Explores the chart. Only sent messages that other robots read are observable: `read` says of
    /// each whether they do.
    pub(crate) fn explored(&self, settings: &CheckSettings, read: &[bool]) -> Behaviour {
        let scripts = self.scripts_on_messages();
        let mut interfaces: Vec<StepInterface> = vec![StepInterface::default()];
        let mut numbers: BTreeMap<StepInterface, u64> = BTreeMap::from([(StepInterface::default(), 0)]);
        let letter = |seen: &StepObservation<'_>| {
            let interface = self.step_interface(seen, &scripts, (settings.world.as_ref(), read));
            *numbers.entry(interface).or_insert_with_key(|interface| {
                interfaces.push(interface.clone());
                interfaces.len() as u64 - 1
            })
        };
        let mut surroundings = self.abstraction.surroundings();
        surroundings.messages = true;
        let mut asked = StepLabeler {
            conditions: 0,
            idle: self.idle_regions(read),
            pace: None,
            letter: Box::new(letter),
        };
        let idle = yase_explore::idle_regions(&self.abstraction.chart, &asked.idle);
        let found =
            explore_labelled(&self.abstraction.chart, &mut surroundings, &mut asked, settings.limits());
        drop((asked, surroundings));
        Behaviour { idle, ..Behaviour::new(found, interfaces, &self.waits) }
    }

    /// The regions without effect on other robots, or on regions with such an effect.
    fn idle_regions(&self, read: &[bool]) -> Vec<NodeId> {
        let chart = self.abstraction.chart.statechart();
        let sent = self.sent.iter().zip(read).filter(|(_, is_read)| **is_read);
        let sending = sent.flat_map(|(message, _)| &message.uses).map(|location| match *location {
            MessageUse::Way(transition) => chart.transition(transition).source,
            MessageUse::Node(node) => node,
        });
        let receiving = self.received.iter().map(|message| chart.transition(message.transition).source);
        let nodes: Vec<NodeId> =
            sending.chain(receiving).chain(self.waits.iter().map(|wait| wait.node)).collect();
        cone_of_influence::idle_but(chart, &|region| {
            nodes.iter().any(|&node| cone_of_influence::is_within(chart, node, region))
        })
    }

    /// Whether each condition of the exploration reads a message of another robot.
    fn scripts_on_messages(&self) -> Vec<bool> {
        let reads = |condition: &Expression| {
            paths(condition)
                .into_iter()
                .any(|path| self.received.iter().any(|it| begins_with(path, &it.called.prefix)))
        };
        self.abstraction.conditions.iter().map(|condition| condition.as_ref().is_some_and(reads)).collect()
    }

    fn step_interface(
        &self,
        seen: &StepObservation<'_>,
        scripts: &[bool],
        known: (Option<&ProgramSymbols>, &[bool]),
    ) -> StepInterface {
        let receives = match seen.cause {
            StepCause::Event(name) => self.received.iter().position(|it| it.event.as_ref() == Some(name)),
            _ => None,
        };
        let event = receives
            .and_then(|message| self.abstraction.chart.events().find(self.received[message].event.as_ref()?));
        let mut conditions: Vec<(ScriptId, bool)> = seen
            .decisions
            .iter()
            .copied()
            .filter(|(script, _)| scripts.get(script.0 as usize) == Some(&true))
            .collect();
        conditions.sort_unstable();
        conditions.dedup();
        let exited = (0..self.waits.len()).filter(|&wait| seen.left.contains(&self.waits[wait].node));
        StepInterface {
            receives,
            drops: event.is_some_and(|event| seen.dropped.contains(&event)),
            conditions,
            sends: self.sent_messages(seen, known),
            exited_waits: exited.collect(),
        }
    }

    /// The messages published at the end of a step: those written by its actions and those of an
    /// activity that has returned.
    fn sent_messages(
        &self,
        seen: &StepObservation<'_>,
        (world, read): (Option<&ProgramSymbols>, &[bool]),
    ) -> Vec<(usize, Vec<FieldSetting>)> {
        let chart = &self.subject.chart;
        let of_exits = seen.left.iter().flat_map(|&node| &chart.node(node).exit);
        let of_ways =
            seen.taken.iter().flat_map(|&transition| &chart.transition(transition).expression.actions);
        let of_entries = seen.entered.iter().flat_map(|&node| &chart.node(node).entry);
        let mut sends: BTreeMap<usize, BTreeMap<String, Option<String>>> = BTreeMap::new();
        for (word, setting) in of_exits
            .chain(of_ways)
            .chain(of_entries)
            .filter_map(|it| message_names::message_written(it, world))
        {
            let Some(message) = self.sent_message_index(&word) else { continue };
            let fields = sends.entry(message).or_default();
            fields.extend(setting.map(|(field, value)| (field, literal(&value, &chart.constants))));
        }
        let returned = match seen.cause {
            StepCause::Return(node) => chart.node(*node).activity.as_deref(),
            _ => None,
        };
        let by_activity =
            returned.map(|activity| message_names::messages_written_by(activity, world)).unwrap_or_default();
        for message in by_activity.iter().filter_map(|word| self.sent_message_index(word)) {
            // the fields of a message written by an activity are unknown
            sends.entry(message).or_default().insert(String::new(), None);
        }
        sends.retain(|&message, _| read.get(message) == Some(&true));
        sends.into_iter().map(|(message, fields)| (message, fields.into_iter().collect())).collect()
    }

    fn sent_message_index(&self, word: &MessageName) -> Option<usize> {
        self.sent.iter().position(|it| it.name == *word)
    }
}

/// Whether a path starts with another.
pub(crate) fn begins_with(path: &yase::expression::Path, prefix: &yase::expression::Path) -> bool {
    path.segments.len() >= prefix.segments.len()
        && path.segments.iter().zip(&prefix.segments).all(|(one, other)| one.text == other.text)
}

/// The value of a constant expression, as text.
fn literal(value: &Expression, constants: &[Constant]) -> Option<String> {
    match &value.kind {
        ExpressionKind::Bool(_)
        | ExpressionKind::Integer(_)
        | ExpressionKind::Decimal(_)
        | ExpressionKind::Text(_) => Some(value.to_string()),
        ExpressionKind::Negative(inner) => literal(inner, constants).map(|inner| format!("-{inner}")),
        ExpressionKind::Variable(path) => {
            let name = path.bare()?;
            let constant = constants.iter().find(|constant| constant.name == name).map(|it| &it.value);
            Some(match constant {
                None => name.to_owned(),
                Some(ConstantValue::Bool(value)) => value.to_string(),
                Some(ConstantValue::Number(value)) => value.to_string(),
                Some(ConstantValue::Text(value)) => format!("{value:?}"),
            })
        }
        _ => None,
    }
}

/// The hosts of the robots, and the messages of other agents on the robot's own host.
pub(crate) struct RobotDeployment<'a> {
    pub(crate) host: &'a str,
    /// The hosts of all robots.
    pub(crate) hosts: &'a [&'a str],
    /// The messages that other agents on the same host send.
    pub(crate) sent_by_others: Vec<MessageName>,
}

/// The messages that concern a chart: those of robots, itself among them.
struct MessageFilter<'a> {
    deployment: RobotDeployment<'a>,
    /// The messages that its actions send.
    sent: Vec<MessageName>,
    world: Option<&'a ProgramSymbols>,
}

impl<'a> MessageFilter<'a> {
    fn new(
        deployment: RobotDeployment<'a>,
        chart: &Statechart,
        world: Option<&'a ProgramSymbols>,
    ) -> MessageFilter<'a> {
        let sent = actions(chart)
            .filter_map(|(_, action)| message_names::message_written(action, world).map(|(word, _)| word));
        MessageFilter { deployment, sent: sent.collect(), world }
    }

    /// The message that a condition reads: of a named host, or without a name of another agent on
    /// the own one. Its own are what has been read before, whatever it is.
    fn read(&self, path: &yase::expression::Path) -> Option<MessageReference> {
        let of_host = message_reference(path, self.deployment.hosts.iter().copied(), self.world);
        of_host.or_else(|| self.without_host(path, &self.deployment.sent_by_others))
    }

    /// The message that a trigger waits for. A message that the chart sends to itself may lack the
    /// robot's name.
    fn awaited_message(&self, path: &yase::expression::Path) -> Option<MessageReference> {
        self.read(path).or_else(|| self.without_host(path, &self.sent))
    }

    fn without_host(&self, path: &yase::expression::Path, sent: &[MessageName]) -> Option<MessageReference> {
        let called = message_names::own(path, self.deployment.host, self.world)?;
        sent.iter().any(|message| message.means(&called.name)).then_some(called)
    }
}

fn received_messages(chart: &Statechart, filter: &MessageFilter<'_>) -> Vec<ReceivedMessage> {
    let mut found: Vec<ReceivedMessage> = Vec::new();
    for (id, transition) in chart.transitions() {
        let waited =
            triggers(transition).iter().map(|path| (filter.awaited_message(path), Some(path.text())));
        let read = transition.expression.guard.iter().flat_map(paths).map(|path| (filter.read(path), None));
        for (called, event) in waited.chain(read) {
            let Some(called) = called else { continue };
            match found.iter_mut().find(|it| it.called.prefix == called.prefix) {
                Some(known) if known.event.is_none() => (known.event, known.transition) = (event, id),
                Some(_) => {}
                None => found.push(ReceivedMessage { called, event, transition: id }),
            }
        }
    }
    found
}

pub(crate) fn messages_to_send(chart: &Statechart, world: Option<&ProgramSymbols>) -> Vec<SentMessage> {
    let mut found: Vec<SentMessage> = Vec::new();
    let by_actions = actions(chart).filter_map(|(location, action)| {
        message_names::message_written(action, world).map(|(word, _)| (location, word))
    });
    let by_activities = chart.nodes().flat_map(|(id, node)| {
        let sent =
            node.activity.iter().flat_map(|activity| message_names::messages_written_by(activity, world));
        sent.map(move |word| (MessageUse::Node(id), word)).collect::<Vec<_>>()
    });
    for (location, word) in by_actions.chain(by_activities) {
        match found.iter_mut().find(|it| it.name == word) {
            Some(known) => known.uses.push(location),
            None => found.push(SentMessage { name: word, uses: vec![location] }),
        }
    }
    found
}

/// The states in which a chart waits for messages of others, including the completion of
/// composites.
fn waits(
    subject: &CheckedModel,
    received: &[ReceivedMessage],
    filter: &MessageFilter<'_>,
) -> Vec<WaitingState> {
    let mut found: Vec<WaitingState> = Vec::new();
    for (id, transition) in subject.chart.transitions() {
        let waited = triggers(transition).iter().filter_map(|path| filter.awaited_message(path));
        let read = transition.expression.guard.iter().flat_map(paths).filter_map(|path| filter.read(path));
        let named = waited.chain(read).next();
        let named = named.and_then(|called| received.iter().position(|it| it.called.prefix == called.prefix));
        let Some(received_message) = named else { continue };
        for node in stable_nodes(subject, transition.source) {
            if !found.iter().any(|wait| wait.node == node) {
                found.push(WaitingState { node, received_message, transition: id });
            }
        }
    }
    found
}

/// The stable states from which a node is about to be left: connectors are followed back.
fn stable_nodes(subject: &CheckedModel, node: NodeId) -> Vec<NodeId> {
    let (mut found, mut open, mut seen) = (Vec::new(), vec![node], Vec::new());
    while let Some(node) = open.pop() {
        if seen.contains(&node) {
            continue;
        }
        seen.push(node);
        match subject.kind(node) {
            NodeKind::Basic | NodeKind::Start => found.push(node),
            NodeKind::Or => {
                let inside = subject.chart.children(node).iter().copied();
                found.extend(inside.filter(|&inner| subject.kind(inner) == NodeKind::End));
            }
            NodeKind::And | NodeKind::End => {}
            _ => open.extend(
                subject.incoming(node).iter().map(|&transition| subject.transition(transition).source),
            ),
        }
    }
    found
}

/// A transition whose trigger matches every event, if there is one.
pub(crate) fn wildcard_trigger(chart: &Statechart) -> Option<TransitionId> {
    let takes = |trigger: &Trigger| matches!(trigger, Trigger::Any | Trigger::Not(_));
    chart.transitions().find(|(_, it)| it.expression.trigger.as_ref().is_some_and(takes)).map(|(id, _)| id)
}

/// The behaviour of a robot as classes of observably equivalent states. The last state of the graph
/// is the one before the start.
pub(crate) struct Behaviour {
    pub(crate) found: LabelledGraph,
    /// The blackboards of regions that were left out, by index.
    pub(crate) idle: Vec<bool>,
    pub(crate) step_interfaces: Vec<StepInterface>,
    /// The graph of all states.
    full: Graph,
    /// The class of each state.
    classes: Vec<usize>,
    /// The graph of the classes.
    pub(crate) graph: Graph,
    /// The unfinished waits in each class.
    pub(crate) waiting: Vec<Vec<usize>>,
    /// The waits of each class that can end if the other robots send suitable messages.
    pub(crate) may_end: Vec<Vec<bool>>,
}

impl Behaviour {
    fn new(found: LabelledGraph, step_interfaces: Vec<StepInterface>, waits: &[WaitingState]) -> Behaviour {
        let begin = found.states().len();
        let mut full = Graph { initial: vec![begin], ends: Vec::new(), edges: vec![Vec::new(); begin + 1] };
        full.ends = found.states().iter().map(|it| it.status != Status::Running).chain([false]).collect();
        for (edge, step) in found.steps().iter().enumerate() {
            let interface = &step_interfaces[step.letter as usize];
            let shows = if interface.is_seen() {
                Observable::Letter(step.letter as u32)
            } else {
                Observable::Nothing
            };
            let from = step.from.unwrap_or(begin);
            if from != step.to
                || interface.receives.is_some()
                || !interface.sends.is_empty()
                || !interface.exited_waits.is_empty()
            {
                full.edges[from].push(LabelledEdge { observable: shows, to: step.to, edge });
            }
        }
        let waiting_in = |state: &yase_explore::LabelledState| -> Vec<usize> {
            let rests = |wait: &usize| {
                let node = waits[*wait].node;
                state.configuration.contains(&node) && !state.pending.contains(&PendingEvent::Return(node))
            };
            (0..waits.len()).filter(rests).collect()
        };
        let waiting: Vec<Vec<usize>> = found.states().iter().map(waiting_in).chain([Vec::new()]).collect();
        let classes = first_classes(&full, &waiting, begin);
        let (classes, count) = full.classes(classes).unwrap_or_else(|| ((0..=begin).collect(), begin + 1));
        let graph = full.of_classes(&classes, count);
        let mut by_class = vec![Vec::new(); count];
        for (state, &class) in classes.iter().enumerate() {
            by_class[class].clone_from(&waiting[state]);
        }
        let may_end = (0..waits.len()).map(|wait| wait_end_classes(&graph, &step_interfaces, wait)).collect();
        let idle = Vec::new();
        Behaviour { found, idle, step_interfaces, full, classes, graph, waiting: by_class, may_end }
    }

    /// The class before the start.
    pub(crate) fn begin(&self) -> usize {
        self.graph.initial.first().copied().unwrap_or(0)
    }

    /// Whether the chart was not started.
    pub(crate) fn is_begin(&self, class: usize) -> bool {
        class == self.begin()
    }

    /// The effects of an edge on other robots.
    pub(crate) fn step_interface(&self, edge: &LabelledEdge) -> &StepInterface {
        match edge.observable {
            Observable::Letter(letter) => &self.step_interfaces[letter as usize],
            Observable::Nothing | Observable::Other => &self.step_interfaces[0],
        }
    }

    /// The steps by which a state realises an edge of its class, and the state they lead to.
    pub(crate) fn steps(&self, state: usize, shows: Observable, to: usize) -> (Vec<usize>, usize) {
        let class = self.classes[state];
        let mut came: BTreeMap<usize, Option<(usize, usize)>> = BTreeMap::from([(state, None)]);
        let mut open = std::collections::VecDeque::from([state]);
        while let Some(at) = open.pop_front() {
            let fits = |edge: &&LabelledEdge| edge.observable == shows && self.classes[edge.to] == to;
            if let Some(last) = self.full.edges[at].iter().find(fits) {
                let mut steps = vec![last.edge];
                let mut back = at;
                while let Some(Some((before, edge))) = came.get(&back) {
                    steps.push(*edge);
                    back = *before;
                }
                steps.reverse();
                return (steps, last.to);
            }
            for edge in self.full.edges[at].iter().filter(|edge| edge.observable == Observable::Nothing) {
                if self.classes[edge.to] == class && !came.contains_key(&edge.to) {
                    came.insert(edge.to, Some((at, edge.edge)));
                    open.push_back(edge.to);
                }
            }
        }
        (Vec::new(), state)
    }

    /// The state before the start.
    pub(crate) fn first_state(&self) -> usize {
        self.found.states().len()
    }
}

/// The initial partition of the states: by whether the chart has ended and by the messages it waits
/// for.
fn first_classes(full: &Graph, waiting: &[Vec<usize>], begin: usize) -> Vec<usize> {
    let mut numbers = BTreeMap::new();
    let key = |state: usize| (state == begin, full.ends[state], waiting[state].clone());
    (0..=begin)
        .map(|state| {
            let number = numbers.len();
            *numbers.entry(key(state)).or_insert(number)
        })
        .collect()
}

/// The classes from which a wait can end on some path.
fn wait_end_classes(graph: &Graph, step_interfaces: &[StepInterface], wait: usize) -> Vec<bool> {
    let ends = |edge: &LabelledEdge| match edge.observable {
        Observable::Letter(letter) => step_interfaces[letter as usize].exited_waits.contains(&wait),
        Observable::Nothing | Observable::Other => false,
    };
    let mut before = vec![Vec::new(); graph.edges.len()];
    let mut open = Vec::new();
    for (from, edges) in graph.edges.iter().enumerate() {
        edges.iter().for_each(|edge| before[edge.to].push(from));
        open.extend(edges.iter().any(ends).then_some(from));
    }
    let mut reaches = vec![false; graph.edges.len()];
    while let Some(class) = open.pop() {
        if !std::mem::replace(&mut reaches[class], true) {
            open.extend(before[class].iter().copied());
        }
    }
    reaches
}
