//! Messages for one tool, as they are published.

use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use narukom::{AnySample, HostId, Narukom, Subscriber, TopicSlot};

use super::messages::{Answer, Seen, Watch};
use super::server::name;
use super::{Observed, PAYLOAD_LIMIT, frame};

/// How often hubs are looked at; what a message waits at most before a tool is told.
const LOOK: Duration = Duration::from_millis(2);

/// After so many looks it is asked whether messages of further hosts have come.
const LOOKS_TO_NEWCOMERS: u32 = 50;

/// So many messages of a hub are told at most before others have their turn.
const TURN: usize = 1024;

/// So many bytes are collected at most before they are written.
const CHUNK: usize = 64 << 10;

/// What a tool watches.
pub(super) struct Watcher {
    feeds: Vec<Feed>,
    slots: Vec<TopicSlot>,
    pattern: String,
    payload: bool,
}

/// What is watched of one host on one hub.
struct Feed {
    hub: Narukom,
    host: HostId,
    subscriber: Subscriber,
}

impl Watcher {
    /// # Errors
    /// Why the pattern fits no topic.
    pub(super) fn new(hubs: Vec<Narukom>, watch: &Watch) -> Result<Watcher, String> {
        let pattern = if watch.pattern.is_empty() { "**" } else { &watch.pattern };
        let mut watcher = Watcher {
            feeds: Vec::new(),
            slots: Vec::new(),
            pattern: pattern.to_owned(),
            payload: watch.payload,
        };
        for hub in hubs {
            watcher.slots = hub.matching(pattern).map_err(|error| error.to_string())?;
            watcher.follow(hub, HostId::LOCAL)?;
        }
        watcher.welcome()?;
        Ok(watcher)
    }

    fn follow(&mut self, hub: Narukom, host: HostId) -> Result<(), String> {
        let subscriber = hub.subscriber_of(host, &self.pattern).map_err(|error| error.to_string())?;
        self.feeds.push(Feed { hub, host, subscriber });
        Ok(())
    }

    /// Watches further hosts, of which messages have come to a hub.
    fn welcome(&mut self) -> Result<(), String> {
        let hubs: Vec<Narukom> = self
            .feeds
            .iter()
            .filter(|feed| feed.host == HostId::LOCAL)
            .map(|feed| feed.hub.clone())
            .collect();
        for hub in hubs {
            let mut hosts: Vec<HostId> = self.slots.iter().flat_map(|slot| hub.hosts_of(*slot)).collect();
            hosts.sort_unstable();
            hosts.dedup();
            for host in hosts {
                let is_known = |feed: &Feed| feed.host == host && feed.hub.host() == hub.host();
                if !self.feeds.iter().any(is_known) {
                    self.follow(hub.clone(), host)?;
                }
            }
        }
        Ok(())
    }

    /// Tells what is published until the tool leaves or says anything, or the run ends.
    pub(super) fn run(
        mut self,
        mut stream: &UnixStream,
        run: &dyn Observed,
        stops: &AtomicBool,
    ) -> io::Result<()> {
        stream.set_read_timeout(Some(LOOK))?;
        let mut bytes = Vec::new();
        for look in 1_u32.. {
            self.tell(stream, run, &mut bytes)?;
            if stops.load(Ordering::SeqCst) {
                break;
            }
            if look % LOOKS_TO_NEWCOMERS == 0 {
                self.welcome().map_err(io::Error::other)?;
            }
            // Waiting for a word is also what lets time pass.
            match stream.read(&mut [0]) {
                Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {
                }
                said => return said.map(drop),
            }
        }
        Ok(())
    }

    /// Tells what has been published by now.
    fn tell(&mut self, mut stream: &UnixStream, run: &dyn Observed, bytes: &mut Vec<u8>) -> io::Result<()> {
        let mut lost: u64 = self.feeds.iter().map(|feed| feed.subscriber.lost()).sum();
        for feed in &mut self.feeds {
            lost -= feed.subscriber.lost();
            for _ in 0..TURN {
                // what is missing before a message is noticed when that is fetched
                let Some(sample) = feed.subscriber.next_sample() else { break };
                let seen = feed.seen(&sample, run, self.payload, lost + feed.subscriber.lost());
                frame::append(&Answer { seen: Some(seen), ..Answer::default() }, bytes);
                if bytes.len() > CHUNK {
                    stream.write_all(bytes)?;
                    bytes.clear();
                }
            }
            lost += feed.subscriber.lost();
        }
        stream.write_all(bytes)?;
        bytes.clear();
        Ok(())
    }
}

impl Feed {
    fn seen(&self, sample: &AnySample, run: &dyn Observed, payload: bool, lost: u64) -> Seen {
        let mut bytes = Vec::new();
        sample.message.encode_to(&mut bytes);
        let header = &sample.header;
        let topic = self.hub.declaration(header.topic);
        Seen {
            host: self.hub.host().into(),
            from: name(self.hub.host_name(header.host)),
            path: topic.map(|topic| topic.path().to_owned()).unwrap_or_default(),
            publisher: name(self.hub.publisher_name(header.publisher)),
            sequence: header.sequence,
            published: header.published.as_nanos(),
            local: header.local.as_nanos(),
            received: header.received.as_nanos(),
            now: run.now().as_nanos(),
            size: bytes.len() as u64,
            payload: if payload && bytes.len() <= PAYLOAD_LIMIT { bytes } else { Vec::new() },
            lost,
        }
    }
}
