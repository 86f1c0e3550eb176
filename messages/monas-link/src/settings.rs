//! Settings of a link: which topics it transfers, and how.

use std::collections::BTreeMap;
use std::time::Duration;

use narukom::{Hub, TopicDeclaration};

use crate::error::{Error, ErrorKind};
use crate::protocol::{AccessList, LinkTopic, NodeSettings, Reliability, Schema, SendBudget};

/// The topics that a link sends and receives, and how.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LinkSettings {
    /// The name of this end; if it is empty, that of the hub's host.
    pub name: String,
    /// The topics to send. The first rule that matches a topic applies.
    pub send: Vec<SendRule>,
    /// The topics to receive.
    pub receive: Vec<ReceiveRule>,
    /// The access list.
    pub access: AccessList,
    /// Whether programs without a link may send: any client of the transport that knows the
    /// messages.
    pub accepts_unlinked: bool,
    /// The send budget.
    pub budget: Option<SendBudget>,
    /// Interval between heartbeats. States are equal on all sides two beats and two round trips
    /// after the last packet loss; with a budget a beat takes at least as long as four packets of
    /// the budget.
    pub beat: Duration,
}

/// Topics to send.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SendRule {
    /// A pattern with the syntax of [`narukom::Hub::subscriber`]: `soccer/ball`, `soccer/*`,
    /// `soccer/**`.
    pub topics: String,
    /// Whether lost messages are retransmitted.
    pub reliability: Reliability,
    /// From 1, sent first, to 7, sent last.
    pub priority: u8,
}

/// Topics to receive.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ReceiveRule {
    /// A pattern, as for [`SendRule::topics`].
    pub topics: String,
    /// The host under which the messages are published.
    pub publish_as: PublishAs,
}

/// The host under which received messages are published.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum PublishAs {
    /// The other host, read through [`Blackboard::from`](narukom::Blackboard::from).
    #[default]
    Other,
    /// This host: the other end is a process of the same robot, and readers see no difference. Such
    /// a topic cannot be sent as well.
    Own,
}

impl Default for LinkSettings {
    fn default() -> LinkSettings {
        LinkSettings {
            name: String::new(),
            send: Vec::new(),
            receive: Vec::new(),
            access: AccessList::open(),
            accepts_unlinked: false,
            budget: None,
            beat: Duration::from_millis(200),
        }
    }
}

impl LinkSettings {
    /// Adds topics to send, reliably, with medium priority.
    pub fn sending(mut self, topics: &str) -> LinkSettings {
        self.send.push(SendRule { topics: topics.into(), reliability: Reliability::Reliable, priority: 4 });
        self
    }

    /// Adds topics to receive, published under the other host.
    pub fn receiving(mut self, topics: &str) -> LinkSettings {
        self.receive.push(ReceiveRule { topics: topics.into(), publish_as: PublishAs::Other });
        self
    }
}

/// The settings resolved against the topics of a hub.
pub(crate) struct ResolvedSettings {
    pub(crate) node: NodeSettings,
    /// The host under which each received topic is published.
    pub(crate) publish_as: Vec<PublishAs>,
}

impl ResolvedSettings {
    /// # Errors
    /// A pattern matches no topic, a priority is invalid, or a topic would be sent back to its
    /// origin.
    pub(crate) fn new(
        settings: LinkSettings,
        hub: &Hub,
        incarnation: u64,
    ) -> Result<ResolvedSettings, Error> {
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
                if rule.publish_as == PublishAs::Own && send.contains_key(path) {
                    let text = format!("`{path}` is received as this host's own, so it cannot be sent too");
                    return Err(Error::new(ErrorKind::Settings, text));
                }
                receive
                    .entry(path)
                    .or_insert_with(|| (link_topic(declaration, Reliability::Reliable, 4), rule.publish_as));
            }
        }
        let (receive, publish_as) = receive.into_values().unzip();
        let host = if settings.name.is_empty() { hub.host().to_owned() } else { settings.name };
        let LinkSettings { access, accepts_unlinked: guests, budget, beat, .. } = settings;
        let send = send.into_values().collect();
        let node =
            NodeSettings { host, incarnation, send, receive, access, accepts_unlinked: guests, budget, beat };
        Ok(ResolvedSettings { node, publish_as })
    }
}

fn topics<'a>(hub: &'a Hub, pattern: &str) -> Result<impl Iterator<Item = &'a TopicDeclaration>, Error> {
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
