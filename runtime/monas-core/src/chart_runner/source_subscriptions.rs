//! Messages of one publisher, or of another host, that guards read.
//!
//! A blackboard keeps one newest message for each topic, regardless of the publisher, and keeps
//! those of other hosts apart. A guard that names a source reads the newest message of that source:
//! publications of others on the topic do not hide it. It changes when the region's blackboard
//! receives its deliveries, and is constant while an activity holds that blackboard.

use std::time::Duration;

use narukom::{AnySample, HostId, Hub, PublisherId, RetentionKind, Subscriber, Timestamp, TopicSlot};
use yase::CompiledChart;
use yase::expression::{MessageSource, Origin};

use super::delivery_log::DeliveryLog;
use crate::error::Error;
use crate::records::{Delivery, topic_in_records};

/// The newest messages that a region has of the sources named by its chart.
pub(crate) struct SourceSubscriptions {
    /// In the order of the chart's sources; equal in all regions.
    subscriptions: Vec<SourceSubscription>,
}

/// The newest message of one source.
struct SourceSubscription {
    source: MessageSource,
    /// The topic as numbered in records.
    topic: u64,
    host: HostId,
    publisher: Option<Box<str>>,
    /// The publisher's number, once a message of it has arrived.
    known: Option<PublisherId>,
    kind: RetentionKind,
    age: Option<Duration>,
    subscriber: Subscriber,
    newest: Option<AnySample>,
    /// Whether `newest` came with the last delivery.
    is_fresh: bool,
}

impl SourceSubscriptions {
    /// Subscribes to the sources of a chart other than "this host, any publisher".
    ///
    /// # Errors
    /// There are more hosts than a hub can number.
    pub(crate) fn new(chart: &CompiledChart, hub: &Hub) -> Result<SourceSubscriptions, Error> {
        let feeds = chart.sources().filter(|source| !is_plain(&source.origin, hub.host()));
        let feeds = feeds.map(|source| SourceSubscription::new(source, hub)).collect::<Result<_, _>>();
        Ok(SourceSubscriptions { subscriptions: feeds.map_err(Error::hub)? })
    }

    /// The newest message of each source that has one.
    pub(crate) fn newest_of_all(&self) -> impl Iterator<Item = &AnySample> {
        self.subscriptions.iter().filter_map(|source| source.newest.as_ref())
    }

    /// Takes what was published since the last delivery.
    pub(crate) fn deliver(&mut self, hub: &Hub, fetching: &mut DeliveryLog) {
        for feed in &mut self.subscriptions {
            fetching.begin();
            feed.deliver(hub);
            fetching.end(feed.subscriber.position());
        }
    }

    /// The messages of the last delivery, for the records.
    pub(crate) fn fresh_deliveries(&self, region: u32) -> impl Iterator<Item = Delivery> {
        self.subscriptions.iter().filter(|feed| feed.is_fresh).filter_map(move |feed| feed.record(region))
    }

    /// Copies the newest messages of another region.
    pub(crate) fn adopt(&mut self, outer: &SourceSubscriptions) {
        for (feed, outer) in self.subscriptions.iter_mut().zip(&outer.subscriptions) {
            feed.newest.clone_from(&outer.newest);
        }
    }

    /// Takes over the subscriptions of a chart that this one replaces, as far as both read the same
    /// sources.
    pub(crate) fn take_over(&mut self, old: SourceSubscriptions) {
        for feed in old.subscriptions {
            if let Some(successor) = self.subscriptions.iter_mut().find(|known| known.source == feed.source) {
                *successor = feed;
            }
        }
    }

    /// The newest message of a source; `None` if the source is not subscribed. `shown` is the
    /// newest message of the topic on the region's blackboard, which includes what the region
    /// itself has written.
    pub(crate) fn newest<'a>(
        &'a self,
        source: &MessageSource,
        shown: Option<&'a AnySample>,
        now: Timestamp,
        hub: &Hub,
    ) -> Option<Option<&'a AnySample>> {
        let feed = self.subscriptions.iter().find(|feed| feed.source == *source)?;
        let own = shown.filter(|sample| feed.host == sample.header.host && feed.is_published_by(sample, hub));
        Some(own.or_else(|| feed.newest.as_ref().filter(|sample| feed.is_recent(sample, now))))
    }
}

/// Whether the region's blackboard already provides the messages of this origin.
fn is_plain(origin: &Origin, own: &str) -> bool {
    match origin {
        Origin::Own => true,
        Origin::Host(host) => **host == *own,
        _ => false,
    }
}

impl SourceSubscription {
    fn new(source: &MessageSource, hub: &Hub) -> Result<SourceSubscription, narukom::Error> {
        let (host, publisher) = match &source.origin {
            Origin::Host(host) => (Some(host), None),
            Origin::Publisher(publisher) => (None, Some(publisher)),
            Origin::HostPublisher { host, publisher } => (Some(host), Some(publisher)),
            _ => (None, None),
        };
        let host = host.map_or(Ok(HostId::LOCAL), |name| hub.host_id(name))?;
        let slot = TopicSlot::new(source.topic.0);
        let topic = hub.declaration(slot);
        Ok(SourceSubscription {
            source: source.clone(),
            topic: topic_in_records(hub, slot),
            host,
            publisher: publisher.cloned(),
            known: None,
            kind: topic.map_or(RetentionKind::State, |topic| topic.kind()),
            age: topic.and_then(|topic| topic.age()),
            subscriber: hub.subscriber_of(host, topic.map_or("", |topic| topic.path()))?,
            newest: None,
            is_fresh: false,
        })
    }

    fn deliver(&mut self, hub: &Hub) {
        if self.kind == RetentionKind::Signal {
            self.newest = None;
        }
        self.is_fresh = false;
        while let Some(sample) = self.subscriber.next_sample() {
            if self.matches_source(&sample, hub) {
                self.newest = Some(sample);
                self.is_fresh = true;
            }
        }
    }

    fn record(&self, region: u32) -> Option<Delivery> {
        let header = self.newest.as_ref()?.header;
        let (host, publisher) = match &self.source.origin {
            Origin::Host(host) => (&**host, ""),
            Origin::Publisher(publisher) => ("", &**publisher),
            Origin::HostPublisher { host, publisher } => (&**host, &**publisher),
            _ => ("", ""),
        };
        Some(Delivery {
            topic: self.topic,
            sequence: header.sequence,
            region,
            host: host.into(),
            publisher: publisher.into(),
        })
    }

    /// Whether a message comes from the named publisher, which is looked up until its first
    /// message.
    fn matches_source(&mut self, sample: &AnySample, hub: &Hub) -> bool {
        let publisher = sample.header.publisher;
        if let (Some(name), None) = (&self.publisher, self.known) {
            self.known = hub.publisher_name(publisher).filter(|met| **met == **name).map(|_| publisher);
        }
        self.is_known(sample)
    }

    fn is_known(&self, sample: &AnySample) -> bool {
        self.publisher.is_none() || self.known == Some(sample.header.publisher)
    }

    /// As [`is_known`](SourceSubscription::is_known), also before the publisher's first message has
    /// been delivered.
    fn is_published_by(&self, sample: &AnySample, hub: &Hub) -> bool {
        let by = |name: &str| hub.publisher_name(sample.header.publisher).is_some_and(|met| *met == *name);
        self.is_known(sample) || self.known.is_none() && self.publisher.as_deref().is_some_and(by)
    }

    fn is_recent(&self, sample: &AnySample, now: Timestamp) -> bool {
        self.age.is_none_or(|age| sample.header.local >= now - age)
    }
}
