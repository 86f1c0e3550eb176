//! Streams published messages to one tool.

use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use narukom::{AnySample, HostId, Hub, Subscriber, TopicSlot};

use super::messages::{Answer, Seen, Watch};
use super::server::name;
use super::{ControlTarget, PAYLOAD_LIMIT, frame};

/// Polling interval of the hubs; the maximum delay of a message.
const POLL_INTERVAL: Duration = Duration::from_millis(2);

/// Number of polls after which new remote hosts are searched.
const HOST_SEARCH_POLLS: u32 = 50;

/// The most messages of one hub that are sent before the next hub has its turn.
const MAX_MESSAGES_PER_HUB: usize = 1024;

/// The most bytes that are buffered before they are written.
const MAX_BUFFERED_BYTES: usize = 64 << 10;

/// The topics that a tool watches.
pub(super) struct TopicWatch {
    feeds: Vec<HostWatch>,
    /// Each pattern with the topics that match it.
    patterns: Vec<(String, Vec<TopicSlot>)>,
    payload: bool,
}

/// The watched topics of one host on one hub.
struct HostWatch {
    hub: Hub,
    host: HostId,
    /// Index of the pattern.
    pattern: usize,
    subscriber: Subscriber,
}

impl TopicWatch {
    /// # Errors
    /// The reason why the pattern matches no topic.
    pub(super) fn new(hubs: Vec<Hub>, watch: &Watch) -> Result<TopicWatch, String> {
        let first = if watch.pattern.is_empty() { "**" } else { &watch.pattern };
        let mut watcher = TopicWatch { feeds: Vec::new(), patterns: Vec::new(), payload: watch.payload };
        for pattern in std::iter::once(first).chain(watch.more.iter().map(String::as_str)) {
            let topics = hubs.iter().map(|hub| hub.matching(pattern));
            let topics: Result<Vec<Vec<TopicSlot>>, narukom::Error> = topics.collect();
            match topics {
                Ok(topics) => {
                    watcher
                        .patterns
                        .push((pattern.to_owned(), topics.into_iter().next().unwrap_or_default()));
                    for hub in &hubs {
                        watcher.watch_host(hub.clone(), HostId::LOCAL, watcher.patterns.len() - 1)?;
                    }
                }
                Err(error) if watch.more.is_empty() => return Err(error.to_string()),
                Err(_) => {}
            }
        }
        if watcher.patterns.is_empty() {
            return Err("none of the patterns matches a topic".into());
        }
        watcher.add_new_hosts()?;
        Ok(watcher)
    }

    fn watch_host(&mut self, hub: Hub, host: HostId, pattern: usize) -> Result<(), String> {
        let subscriber =
            hub.subscriber_of(host, &self.patterns[pattern].0).map_err(|error| error.to_string())?;
        self.feeds.push(HostWatch { hub, host, pattern, subscriber });
        Ok(())
    }

    /// Watches further remote hosts whose messages have arrived at a hub.
    fn add_new_hosts(&mut self) -> Result<(), String> {
        let feeds = self.feeds.iter().filter(|feed| feed.host == HostId::LOCAL);
        let hubs: Vec<(Hub, usize)> = feeds.map(|feed| (feed.hub.clone(), feed.pattern)).collect();
        for (hub, pattern) in hubs {
            let topics = &self.patterns[pattern].1;
            let mut hosts: Vec<HostId> = topics.iter().flat_map(|slot| hub.hosts_of(*slot)).collect();
            hosts.sort_unstable();
            hosts.dedup();
            for host in hosts {
                let is_known = |feed: &HostWatch| {
                    feed.host == host && feed.pattern == pattern && feed.hub.host() == hub.host()
                };
                if !self.feeds.iter().any(is_known) {
                    self.watch_host(hub.clone(), host, pattern)?;
                }
            }
        }
        Ok(())
    }

    /// Streams publications until the tool disconnects or sends a request, or the run ends.
    pub(super) fn run(
        mut self,
        mut stream: &UnixStream,
        run: &dyn ControlTarget,
        stops: &AtomicBool,
    ) -> io::Result<()> {
        stream.set_read_timeout(Some(POLL_INTERVAL))?;
        let mut bytes = Vec::new();
        for look in 1_u32.. {
            self.send_messages(stream, run, &mut bytes)?;
            if stops.load(Ordering::SeqCst) {
                break;
            }
            if look % HOST_SEARCH_POLLS == 0 {
                self.add_new_hosts().map_err(io::Error::other)?;
            }
            // Waiting for input also serves as the polling interval.
            match stream.read(&mut [0]) {
                Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {
                }
                said => return said.map(drop),
            }
        }
        Ok(())
    }

    /// Sends what has been published so far.
    fn send_messages(
        &mut self,
        mut stream: &UnixStream,
        run: &dyn ControlTarget,
        bytes: &mut Vec<u8>,
    ) -> io::Result<()> {
        let mut lost: u64 = self.feeds.iter().map(|feed| feed.subscriber.lost()).sum();
        for feed in &mut self.feeds {
            lost -= feed.subscriber.lost();
            for _ in 0..MAX_MESSAGES_PER_HUB {
                // Losses before a message are detected when it is fetched.
                let Some(sample) = feed.subscriber.next_sample() else { break };
                let seen = feed.seen(&sample, run, self.payload, lost + feed.subscriber.lost());
                frame::append(&Answer { seen: Some(seen), ..Answer::default() }, bytes);
                if bytes.len() > MAX_BUFFERED_BYTES {
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

impl HostWatch {
    fn seen(&self, sample: &AnySample, run: &dyn ControlTarget, payload: bool, lost: u64) -> Seen {
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
