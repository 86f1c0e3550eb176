//! Reading from outside agents.

use std::collections::VecDeque;
use std::fmt;

use crate::error::{Error, ErrorKind};
use crate::hub::{Exchange, Narukom};
use crate::sample::{AnySample, TopicSlot};
use crate::topic::{Kind, is_topic_path};

/// Reads messages of one or several topics in the order of publication: for links, the studio, the command line.
///
/// It begins with the latest message of each `state` topic. Then [`next_sample`](Subscriber::next_sample) gives what was published
/// since; what left the hub's ring before it was fetched is [lost](Subscriber::lost) and counted.
pub struct Subscriber {
    hub: Narukom,
    cursors: Vec<(TopicSlot, u64)>,
    fetched: VecDeque<(u64, AnySample)>,
    seen: u64,
    lost: u64,
}

impl Subscriber {
    pub(crate) fn new(hub: Narukom, pattern: &str) -> Result<Subscriber, Error> {
        let slots = matching(&hub, pattern)?;
        let (cursors, fetched, seen) = {
            let exchange = hub.exchange();
            let cursors =
                slots.iter().map(|slot| (*slot, exchange.ring(*slot).map_or(0, |ring| ring.next())));
            (cursors.collect(), latest_states(&hub, &exchange, &slots), exchange.order())
        };
        Ok(Subscriber { hub, cursors, fetched, seen, lost: 0 })
    }

    /// The next message, if one was published.
    pub fn next_sample(&mut self) -> Option<AnySample> {
        if self.fetched.is_empty() && self.hub.head() != self.seen {
            self.fetch();
        }
        self.fetched.pop_front().map(|(_, sample)| sample)
    }

    /// How many messages were gone before they were fetched.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// The topics that it reads.
    pub fn topics(&self) -> impl Iterator<Item = TopicSlot> {
        self.cursors.iter().map(|(slot, _)| *slot)
    }

    fn fetch(&mut self) {
        let exchange = self.hub.exchange();
        for (slot, cursor) in &mut self.cursors {
            let Some(ring) = exchange.ring(*slot) else { continue };
            self.lost += ring.missed(*cursor);
            self.fetched.extend(ring.from(*cursor).map(|entry| (entry.order, entry.sample.clone())));
            *cursor = ring.next();
        }
        self.seen = exchange.order();
        drop(exchange);
        self.fetched.make_contiguous().sort_unstable_by_key(|(order, _)| *order);
    }
}

impl fmt::Debug for Subscriber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Subscriber({} topics, {} lost)", self.cursors.len(), self.lost)
    }
}

fn latest_states(hub: &Narukom, exchange: &Exchange, slots: &[TopicSlot]) -> VecDeque<(u64, AnySample)> {
    let is_state =
        |slot: &&TopicSlot| hub.declaration(**slot).is_some_and(|topic| topic.kind() == Kind::State);
    let latest = |slot: &TopicSlot| exchange.ring(*slot)?.from(0).next_back();
    let states = slots.iter().filter(is_state).filter_map(latest);
    let mut states: Vec<_> = states.map(|entry| (entry.order, entry.sample.clone())).collect();
    states.sort_unstable_by_key(|(order, _)| *order);
    states.into()
}

/// The topics that `pattern` fits.
fn matching(hub: &Narukom, pattern: &str) -> Result<Vec<TopicSlot>, Error> {
    if !is_pattern(pattern) {
        let text = format!(
            "`{pattern}` is no pattern: a topic's path, of which `*` stands for a segment, a last `**` for any"
        );
        return Err(Error::new(ErrorKind::BadPath, text));
    }
    let numbered = (0..).map(TopicSlot::new).zip(hub.topics());
    let slots: Vec<_> =
        numbered.filter(|(_, topic)| fits(pattern, topic.path())).map(|(slot, _)| slot).collect();
    if slots.is_empty() { Err(hub.catalogue().undeclared(pattern)) } else { Ok(slots) }
}

fn is_pattern(pattern: &str) -> bool {
    let segments = pattern.strip_suffix("/**").unwrap_or(pattern);
    pattern == "**" || segments.split('/').all(|segment| segment == "*" || is_topic_path(segment))
}

/// Whether a well formed `pattern` fits a topic's `path`.
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
    use super::{fits, is_pattern};

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
            assert!(is_pattern(pattern), "{pattern}");
        }
        for pattern in ["", "/", "a/", "a**", "**/a", "a*", "A", "***", "a//**", "/**"] {
            assert!(!is_pattern(pattern), "{pattern}");
        }
    }
}
