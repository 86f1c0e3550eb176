//! Which topics cross a link, and how.

use std::collections::BTreeMap;
use std::time::Duration;

use narukom::{Narukom, TopicDeclaration};

use crate::error::{Error, ErrorKind};
use crate::protocol::{AccessList, Budget, LinkTopic, NodeSettings, Reliability, Schema};

/// What a link sends and receives.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LinkSettings {
    /// The name under which others know this end; if it is empty, that of the hub's host.
    pub name: String,
    /// What is sent. Of several rules that fit a topic the first holds.
    pub send: Vec<SendRule>,
    /// What is received.
    pub receive: Vec<ReceiveRule>,
    /// Who may publish, and who may manage agents.
    pub access: AccessList,
    /// Whether programs without a link may send: any client of the transport that knows the messages.
    pub guests: bool,
    /// How much may be sent.
    pub budget: Option<Budget>,
    /// How often the link says how far it is. States are equal on all sides two beats and two ways there and back after the last
    /// packet was lost; with a budget a beat takes at least four packets' share of it.
    pub beat: Duration,
}

/// Topics that are sent.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SendRule {
    /// Which, as in [`Narukom::subscriber`]: `soccer/ball`, `soccer/*`, `soccer/**`.
    pub topics: String,
    /// Whether lost messages are sent again.
    pub reliability: Reliability,
    /// From 1, sent first, to 7, sent last.
    pub priority: u8,
}

/// Topics that are received.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ReceiveRule {
    /// Which, as in [`SendRule::topics`].
    pub topics: String,
    /// Whose messages they become.
    pub place: Place,
}

/// Whose messages those that are received become.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Place {
    /// Those of the other host, read through [`Blackboard::from`](narukom::Blackboard::from).
    #[default]
    Other,
    /// This host's own: the other end is a process of the same robot, and readers see no difference. Such a topic is not sent back.
    Own,
}

impl Default for LinkSettings {
    fn default() -> LinkSettings {
        LinkSettings {
            name: String::new(),
            send: Vec::new(),
            receive: Vec::new(),
            access: AccessList::open(),
            guests: false,
            budget: None,
            beat: Duration::from_millis(200),
        }
    }
}

impl LinkSettings {
    /// Sends these topics too, reliably, with a middle priority.
    pub fn sending(mut self, topics: &str) -> LinkSettings {
        self.send.push(SendRule { topics: topics.into(), reliability: Reliability::Reliable, priority: 4 });
        self
    }

    /// Receives these topics too, as the other host's.
    pub fn receiving(mut self, topics: &str) -> LinkSettings {
        self.receive.push(ReceiveRule { topics: topics.into(), place: Place::Other });
        self
    }
}

/// The settings, as they fit the topics of a hub.
pub(crate) struct Plan {
    pub(crate) node: NodeSettings,
    /// Whose messages those of each received topic become.
    pub(crate) places: Vec<Place>,
}

impl Plan {
    /// # Errors
    /// A pattern fits no topic, a priority is none, or a topic would come back to where it came from.
    pub(crate) fn new(settings: LinkSettings, hub: &Narukom, incarnation: u64) -> Result<Plan, Error> {
        let mut send = BTreeMap::new();
        for rule in &settings.send {
            if !(1..=7).contains(&rule.priority) {
                let text = format!("the priority of `{}` is {}, not 1 to 7", rule.topics, rule.priority);
                return Err(Error::new(ErrorKind::Settings, text));
            }
            for declaration in topics(hub, &rule.topics)? {
                send.entry(declaration.path())
                    .or_insert_with(|| link_topic(declaration, rule.reliability, rule.priority));
            }
        }
        let mut receive = BTreeMap::new();
        for rule in &settings.receive {
            for declaration in topics(hub, &rule.topics)? {
                let path = declaration.path();
                if rule.place == Place::Own && send.contains_key(path) {
                    let text = format!("`{path}` is received as this host's own, so it cannot be sent too");
                    return Err(Error::new(ErrorKind::Settings, text));
                }
                receive
                    .entry(path)
                    .or_insert_with(|| (link_topic(declaration, Reliability::Reliable, 4), rule.place));
            }
        }
        let (receive, places) = receive.into_values().unzip();
        let host = if settings.name.is_empty() { hub.host().to_owned() } else { settings.name };
        let LinkSettings { access, guests, budget, beat, .. } = settings;
        let send = send.into_values().collect();
        let node = NodeSettings { host, incarnation, send, receive, access, guests, budget, beat };
        Ok(Plan { node, places })
    }
}

fn topics<'a>(hub: &'a Narukom, pattern: &str) -> Result<impl Iterator<Item = &'a TopicDeclaration>, Error> {
    let slots = hub.matching(pattern).map_err(|error| Error::new(ErrorKind::Settings, error.to_string()))?;
    Ok(slots.into_iter().filter_map(|slot| hub.declaration(slot)))
}

fn link_topic(declaration: &TopicDeclaration, reliability: Reliability, priority: u8) -> LinkTopic {
    LinkTopic {
        path: declaration.path().into(),
        kind: declaration.kind(),
        depth: declaration.depth(),
        type_name: declaration.descriptor().full_name.into(),
        schema: Schema::of(declaration.descriptor()),
        reliability,
        priority,
    }
}
