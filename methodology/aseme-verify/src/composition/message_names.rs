//! Names of the messages that pass between robots.
//!
//! A chart writes and publishes messages of its own host, and reads those of another host by that
//! host's name: `receiver.news.Signal.Ready`, `receiver.Judge.Ready.is_near`. A message passes
//! between two robots if one publishes what the other reads by its name.

use yase::expression::{Action, ActionKind, Expression, ExpressionKind, Name, Path, Trigger};
use yase::{NodeId, Statechart, Transition, TransitionId, TypeEnvironment};

use crate::program_symbols::ProgramSymbols;

/// The name of a message without its host: by topic, by type, or by both.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct MessageName {
    topic: Option<String>,
    message: Option<String>,
}

impl MessageName {
    /// The message name at the start of a path, and how many segments it takes.
    fn of(names: &[Name]) -> Option<(MessageName, usize)> {
        let text = |name: &Name| Some(name.text.clone());
        let last = |name: &Name| name.text.rsplit('/').next().map(str::to_owned);
        match names {
            [topic, kind, message, ..] if is_kind(kind) => {
                Some((MessageName { topic: last(topic), message: text(message) }, 3))
            }
            [message, ..] if is_type(message) => {
                Some((MessageName { topic: None, message: text(message) }, 1))
            }
            [topic, ..] => Some((MessageName { topic: last(topic), message: None }, 1)),
            [] => None,
        }
    }

    /// The message of a topic that an activity declares to publish.
    fn of_topic(path: &str, world: &ProgramSymbols) -> MessageName {
        let topic = path.rsplit('/').next().map(str::to_owned);
        let entry = world.vocabulary.topics.iter().find(|entry| entry.path == path);
        MessageName { topic, message: entry.map(|entry| entry.message.clone()) }
    }

    /// Completes topic or type from the symbols of the program.
    fn completed(self, vocabulary: Option<&TypeEnvironment>) -> MessageName {
        let Some(vocabulary) = vocabulary else { return self };
        let named = |path: &str| path.rsplit('/').next().map(str::to_owned);
        let fits = |entry: &&yase::vocabulary::TopicEntry| {
            let (topic, message) = (named(&entry.path), Some(entry.message.clone()));
            (self.topic.is_none() || self.topic == topic)
                && (self.message.is_none() || self.message == message)
        };
        let mut fitting = vocabulary.topics.iter().filter(fits);
        match (fitting.next(), fitting.next()) {
            (Some(entry), None) => {
                MessageName { topic: named(&entry.path), message: Some(entry.message.clone()) }
            }
            _ => self,
        }
    }

    /// Whether two names may denote one message: they share a component and do not contradict each
    /// other.
    pub(crate) fn means(&self, other: &MessageName) -> bool {
        let same = |one: &Option<String>, other: &Option<String>| {
            one.as_ref().zip(other.as_ref()).map(|(a, b)| a == b)
        };
        let (topics, messages) = (same(&self.topic, &other.topic), same(&self.message, &other.message));
        topics.or(messages).is_some() && topics != Some(false) && messages != Some(false)
    }

    /// Its name in diagnostics.
    pub(crate) fn name(&self) -> &str {
        self.message.as_ref().or(self.topic.as_ref()).map_or("", String::as_str)
    }
}

fn is_kind(name: &Name) -> bool {
    matches!(name.text.as_str(), "State" | "Signal" | "Data")
}

fn is_type(name: &Name) -> bool {
    name.text.starts_with(char::is_uppercase)
}

/// The message that an action sends, and the field that it sets with its value.
pub(crate) fn message_written(
    action: &Action,
    world: Option<&ProgramSymbols>,
) -> Option<(MessageName, Option<(String, Expression)>)> {
    let vocabulary = world.map(|world| &world.vocabulary);
    match &action.kind {
        ActionKind::Publish(path) => {
            MessageName::of(&path.segments).map(|(word, _)| (word.completed(vocabulary), None))
        }
        ActionKind::Assign { target, value } => {
            let (word, count) = MessageName::of(&target.segments)?;
            Some((word.completed(vocabulary), Some((text(target.segments.get(count..)?), value.clone()))))
        }
        _ => None,
    }
}

/// The messages that an activity declares to publish when it returns.
pub(crate) fn messages_written_by(activity: &str, world: Option<&ProgramSymbols>) -> Vec<MessageName> {
    let declared = world.and_then(|world| Some((world, world.activities.get(activity)?.as_ref()?)));
    declared
        .into_iter()
        .flat_map(|(world, topics)| topics.iter().map(|topic| MessageName::of_topic(topic, world)))
        .collect()
}

fn text(names: &[Name]) -> String {
    names.iter().map(|name| name.text.as_str()).collect::<Vec<_>>().join(".")
}

/// A reference to a message of a robot in a path.
#[derive(Clone, Debug)]
pub(crate) struct MessageReference {
    /// The robot that sends it.
    pub(crate) host: String,
    pub(crate) name: MessageName,
    /// The path up to and including the message.
    pub(crate) prefix: Path,
}

/// Resolves a path to a message of one of the robots.
pub(crate) fn message_reference<'h>(
    path: &Path,
    hosts: impl Iterator<Item = &'h str>,
    world: Option<&ProgramSymbols>,
) -> Option<MessageReference> {
    let [host, names @ ..] = path.segments.as_slice() else { return None };
    let host = hosts.into_iter().find(|it| *it == host.text)?;
    let (word, count) = match names {
        [_, kind, _, ..] if is_kind(kind) => MessageName::of(names)?,
        [_, message, ..] if is_type(message) => {
            (MessageName { topic: None, message: Some(message.text.clone()) }, 2)
        }
        _ => return None,
    };
    let segments = path.segments.get(..=count)?.to_vec();
    let prefix = Path { segments, position: path.position };
    Some(MessageReference {
        host: host.to_owned(),
        name: word.completed(world.map(|world| &world.vocabulary)),
        prefix,
    })
}

/// Resolves a path without a robot's name to a message of the chart's own robot.
pub(crate) fn own(path: &Path, robot: &str, world: Option<&ProgramSymbols>) -> Option<MessageReference> {
    let (word, count) = MessageName::of(&path.segments)?;
    let prefix = Path { segments: path.segments.get(..count)?.to_vec(), position: path.position };
    Some(MessageReference {
        host: robot.to_owned(),
        name: word.completed(world.map(|world| &world.vocabulary)),
        prefix,
    })
}

/// The paths that a condition reads.
pub(crate) fn paths(condition: &Expression) -> Vec<&Path> {
    let (mut found, mut open) = (Vec::new(), vec![condition]);
    while let Some(expression) = open.pop() {
        match &expression.kind {
            ExpressionKind::Variable(path) | ExpressionKind::Absent(path) | ExpressionKind::Present(path) => {
                found.push(path)
            }
            _ => open.extend(expression.parts()),
        }
    }
    found
}

/// The events that a transition waits for.
pub(crate) fn triggers(transition: &Transition) -> &[Path] {
    match &transition.expression.trigger {
        Some(Trigger::OneOf(events)) => events,
        _ => &[],
    }
}

/// The element that contains an action.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum MessageUse {
    Way(TransitionId),
    Node(NodeId),
}

/// All actions of a chart with the elements that contain them.
pub(crate) fn actions(chart: &Statechart) -> impl Iterator<Item = (MessageUse, &Action)> {
    let of_ways = chart
        .transitions()
        .flat_map(|(id, it)| it.expression.actions.iter().map(move |action| (MessageUse::Way(id), action)));
    let of_nodes = chart.nodes().flat_map(|(id, node)| {
        node.entry.iter().chain(&node.exit).map(move |action| (MessageUse::Node(id), action))
    });
    of_ways.chain(of_nodes)
}
