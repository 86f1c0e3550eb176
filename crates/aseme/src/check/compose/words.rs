//! What robots call the messages that pass between them.
//!
//! A chart writes and publishes its own host's messages, and reads those of another by that one's name: `receiver.news.Signal.Ready`,
//! `receiver.Judge.Ready.is_near`. So a message passes from one robot to another if the one says what the other calls by its name.

use yase::expression::{Action, ActionKind, Expression, ExpressionKind, Name, Path, Trigger};
use yase::{NodeId, Statechart, Transition, TransitionId, Vocabulary};

use crate::check::World;

/// What a message is called, without the host: by its topic, by its type, or by both.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct Word {
    topic: Option<String>,
    message: Option<String>,
}

impl Word {
    /// The word that a path begins with, and of how many names.
    fn of(names: &[Name]) -> Option<(Word, usize)> {
        let text = |name: &Name| Some(name.text.clone());
        let last = |name: &Name| name.text.rsplit('/').next().map(str::to_owned);
        match names {
            [topic, kind, message, ..] if is_kind(kind) => {
                Some((Word { topic: last(topic), message: text(message) }, 3))
            }
            [message, ..] if is_type(message) => Some((Word { topic: None, message: text(message) }, 1)),
            [topic, ..] => Some((Word { topic: last(topic), message: None }, 1)),
            [] => None,
        }
    }

    /// The message of a topic that an activity says it publishes.
    fn of_topic(path: &str, world: &World) -> Word {
        let topic = path.rsplit('/').next().map(str::to_owned);
        let entry = world.vocabulary.topics.iter().find(|entry| entry.path == path);
        Word { topic, message: entry.map(|entry| entry.message.clone()) }
    }

    /// The same with topic and type, where a program knows the one by the other.
    fn completed(self, vocabulary: Option<&Vocabulary>) -> Word {
        let Some(vocabulary) = vocabulary else { return self };
        let named = |path: &str| path.rsplit('/').next().map(str::to_owned);
        let fits = |entry: &&yase::vocabulary::TopicEntry| {
            let (topic, message) = (named(&entry.path), Some(entry.message.clone()));
            (self.topic.is_none() || self.topic == topic)
                && (self.message.is_none() || self.message == message)
        };
        let mut fitting = vocabulary.topics.iter().filter(fits);
        match (fitting.next(), fitting.next()) {
            (Some(entry), None) => Word { topic: named(&entry.path), message: Some(entry.message.clone()) },
            _ => self,
        }
    }

    /// Whether two words may mean one message: what both say is equal, and both say something of the same.
    pub(super) fn means(&self, other: &Word) -> bool {
        let same = |one: &Option<String>, other: &Option<String>| {
            one.as_ref().zip(other.as_ref()).map(|(a, b)| a == b)
        };
        let (topics, messages) = (same(&self.topic, &other.topic), same(&self.message, &other.message));
        topics.or(messages).is_some() && topics != Some(false) && messages != Some(false)
    }

    /// What people call it.
    pub(super) fn name(&self) -> &str {
        self.message.as_ref().or(self.topic.as_ref()).map_or("", String::as_str)
    }
}

fn is_kind(name: &Name) -> bool {
    matches!(name.text.as_str(), "State" | "Signal" | "Data")
}

fn is_type(name: &Name) -> bool {
    name.text.starts_with(char::is_uppercase)
}

/// What an action says: a message, and the field that it sets with its value.
pub(super) fn said(action: &Action, world: Option<&World>) -> Option<(Word, Option<(String, Expression)>)> {
    let vocabulary = world.map(|world| &world.vocabulary);
    match &action.kind {
        ActionKind::Publish(path) => {
            Word::of(&path.segments).map(|(word, _)| (word.completed(vocabulary), None))
        }
        ActionKind::Assign { target, value } => {
            let (word, count) = Word::of(&target.segments)?;
            Some((word.completed(vocabulary), Some((text(target.segments.get(count..)?), value.clone()))))
        }
        _ => None,
    }
}

/// What an activity says when it returns, if it declares that.
pub(super) fn said_by(activity: &str, world: Option<&World>) -> Vec<Word> {
    let declared = world.and_then(|world| Some((world, world.activities.get(activity)?.as_ref()?)));
    declared
        .into_iter()
        .flat_map(|(world, topics)| topics.iter().map(|topic| Word::of_topic(topic, world)))
        .collect()
}

fn text(names: &[Name]) -> String {
    names.iter().map(|name| name.text.as_str()).collect::<Vec<_>>().join(".")
}

/// A message of a robot, as a path calls it.
#[derive(Clone, Debug)]
pub(super) struct Called {
    /// The robot that says it.
    pub(super) host: String,
    pub(super) word: Word,
    /// The path without what stands behind the message.
    pub(super) prefix: Path,
}

/// The message of one of some robots that a path is about.
pub(super) fn called<'h>(
    path: &Path,
    hosts: impl Iterator<Item = &'h str>,
    world: Option<&World>,
) -> Option<Called> {
    let [host, names @ ..] = path.segments.as_slice() else { return None };
    let host = hosts.into_iter().find(|it| *it == host.text)?;
    let (word, count) = match names {
        [_, kind, _, ..] if is_kind(kind) => Word::of(names)?,
        [_, message, ..] if is_type(message) => {
            (Word { topic: None, message: Some(message.text.clone()) }, 2)
        }
        _ => return None,
    };
    let segments = path.segments.get(..=count)?.to_vec();
    let prefix = Path { segments, place: path.place };
    Some(Called { host: host.to_owned(), word: word.completed(world.map(|world| &world.vocabulary)), prefix })
}

/// A message of a chart's own robot, as a path calls it without that one's name.
pub(super) fn own(path: &Path, robot: &str, world: Option<&World>) -> Option<Called> {
    let (word, count) = Word::of(&path.segments)?;
    let prefix = Path { segments: path.segments.get(..count)?.to_vec(), place: path.place };
    Some(Called {
        host: robot.to_owned(),
        word: word.completed(world.map(|world| &world.vocabulary)),
        prefix,
    })
}

/// The paths that a condition reads.
pub(super) fn paths(condition: &Expression) -> Vec<&Path> {
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
pub(super) fn triggers(transition: &Transition) -> &[Path] {
    match &transition.expression.trigger {
        Some(Trigger::OneOf(events)) => events,
        _ => &[],
    }
}

/// Where actions stand.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Place {
    Way(TransitionId),
    Node(NodeId),
}

/// All actions of a chart, with their places.
pub(super) fn actions(chart: &Statechart) -> impl Iterator<Item = (Place, &Action)> {
    let of_ways = chart
        .transitions()
        .flat_map(|(id, it)| it.expression.actions.iter().map(move |action| (Place::Way(id), action)));
    let of_nodes = chart.nodes().flat_map(|(id, node)| {
        node.entry.iter().chain(&node.exit).map(move |action| (Place::Node(id), action))
    });
    of_ways.chain(of_nodes)
}
