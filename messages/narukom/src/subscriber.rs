//! Reading from outside of agents.

use std::collections::VecDeque;
use std::fmt;

use crate::cursors::Cursors;
use crate::error::{Error, ErrorKind};
use crate::hub::Hub;
use crate::ring::RingEntry;
use crate::sample::{AnySample, HostId, TopicSlot};
use crate::topic::is_topic_path;
use crate::topic_table::TopicTable;

/// Reads messages of one or several topics in order of publication: for links, the studio, the
/// command line.
///
/// It begins with the latest message of each `state` topic. Then
/// [`next_sample`](Subscriber::next_sample) returns what was published since; messages that left
/// the hub's ring before they were fetched are counted as [lost](Subscriber::lost).
pub struct Subscriber {
    hub: Hub,
    cursors: Cursors,
    fetched: VecDeque<(u64, AnySample)>,
}

/// Constructors.
impl Hub {
    /// The topics that match a pattern, with the syntax of [`subscriber`](Hub::subscriber).
    pub fn matching(&self, pattern: &str) -> Result<Vec<TopicSlot>, Error> {
        matching(self.topic_table(), pattern)
    }

    /// Subscribes to one topic published on this host (`soccer/ball`), to those directly under a
    /// path (`soccer/*`), or to all under it (`soccer/**`, `**`), for code outside of agents. A
    /// pattern that matches no topic is an error.
    pub fn subscriber(&self, pattern: &str) -> Result<Subscriber, Error> {
        self.subscriber_of(HostId::LOCAL, pattern)
    }

    /// Like [`subscriber`](Hub::subscriber), for the messages of another host.
    pub fn subscriber_of(&self, host: HostId, pattern: &str) -> Result<Subscriber, Error> {
        Ok(Subscriber::new(self.clone(), host, self.matching(pattern)?))
    }
}

impl Subscriber {
    pub(crate) fn new(hub: Hub, host: HostId, slots: Vec<TopicSlot>) -> Subscriber {
        let mut fetched = VecDeque::new();
        let exchange = hub.state();
        let take = |entry: &RingEntry| fetched.push_back((entry.order, entry.sample.clone()));
        let cursors = Cursors::new(&hub, &exchange, host, slots, take);
        drop(exchange);
        sort(&mut fetched);
        Subscriber { hub, cursors, fetched }
    }

    /// The next message, if there is one.
    pub fn next_sample(&mut self) -> Option<AnySample> {
        if self.fetched.is_empty() && !self.cursors.is_up_to_date(&self.hub) {
            let exchange = self.hub.state();
            let fetched = &mut self.fetched;
            self.cursors.fetch(&exchange, |entry| fetched.push_back((entry.order, entry.sample.clone())));
            drop(exchange);
            sort(&mut self.fetched);
        }
        self.fetched.pop_front().map(|(_, sample)| sample)
    }

    /// The number of messages that left the hub before they were fetched.
    pub fn lost(&self) -> u64 {
        self.cursors.lost()
    }

    /// The number of publications on the hub, over all topics, when it last checked for messages.
    pub fn position(&self) -> u64 {
        self.cursors.seen()
    }

    /// The subscribed topics.
    pub fn topics(&self) -> impl Iterator<Item = TopicSlot> {
        self.cursors.topics()
    }
}

fn sort(fetched: &mut VecDeque<(u64, AnySample)>) {
    fetched.make_contiguous().sort_unstable_by_key(|(order, _)| *order);
}

impl fmt::Debug for Subscriber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Subscriber({} topics, {} lost)", self.cursors.topics().count(), self.lost())
    }
}

/// The topics that match `pattern`.
pub(crate) fn matching(catalogue: &TopicTable, pattern: &str) -> Result<Vec<TopicSlot>, Error> {
    if !is_topic_pattern(pattern) {
        let text = format!(
            "`{pattern}` is not a pattern: a topic's path, of which `*` stands for a segment, a last `**` for any"
        );
        return Err(Error::new(ErrorKind::BadPath, text));
    }
    let numbered = (0..).map(TopicSlot::new).zip(catalogue.topics());
    let slots: Vec<_> =
        numbered.filter(|(_, topic)| fits(pattern, topic.path())).map(|(slot, _)| slot).collect();
    if slots.is_empty() { Err(catalogue.undeclared(pattern)) } else { Ok(slots) }
}

/// Whether `pattern` is well formed, with the syntax of
/// [`Hub::subscriber`](crate::Hub::subscriber).
pub fn is_topic_pattern(pattern: &str) -> bool {
    let segments = pattern.strip_suffix("/**").unwrap_or(pattern);
    pattern == "**" || segments.split('/').all(|segment| segment == "*" || is_topic_path(segment))
}

/// Whether a pattern, with the syntax of [`Hub::subscriber`](crate::Hub::subscriber), matches a
/// topic's `path`. One that is not well formed matches none.
pub fn pattern_fits(pattern: &str, path: &str) -> bool {
    is_topic_pattern(pattern) && fits(pattern, path)
}

/// Whether a well-formed `pattern` matches a topic's `path`.
fn fits(pattern: &str, path: &str) -> bool {
    let mut segments = path.split('/');
    for part in pattern.split('/') {
        match (part, segments.next()) {
            ("**", Some(_)) => return true,
            ("*", Some(_)) => {}
            (part, Some(segment)) if part == segment => {}
            _ => return false,
        }
    }
    segments.next().is_none()
}

#[cfg(test)]
mod tests {
    use super::{fits, is_topic_pattern};

    #[test]
    fn patterns_fit_by_segment() {
        assert!(fits("soccer/ball", "soccer/ball"));
        assert!(fits("soccer/*", "soccer/ball"));
        assert!(fits("*/ball", "soccer/ball"));
        assert!(fits("**", "soccer/ball"));
        assert!(fits("soccer/**", "soccer/ball/seen"));
        assert!(!fits("soccer/*", "soccer/ball/seen"));
        assert!(!fits("soccer/**", "soccer"));
        assert!(!fits("soccer/ball", "soccer"));
        assert!(!fits("soccer", "soccer/ball"));
        assert!(!fits("soccer/*", "socceroos/ball"));
    }

    #[test]
    fn patterns_are_paths_with_stars() {
        for pattern in ["a", "a/b", "*", "**", "a/*/b", "a/**", "*/**"] {
            assert!(is_topic_pattern(pattern), "{pattern}");
        }
        for pattern in ["", "/", "a/", "a**", "**/a", "a*", "A", "***", "a//**", "/**"] {
            assert!(!is_topic_pattern(pattern), "{pattern}");
        }
    }
}
