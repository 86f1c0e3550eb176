//! Messages of one publisher, or of another host, that guards read.
//!
//! A blackboard keeps one newest message for each topic, whoever published it, and keeps other hosts' apart. A guard that names whose
//! message it means reads the newest of those: what others publish on the topic does not hide it. It moves when the region's blackboard
//! is delivered, and stands still while an activity has that blackboard.

use std::time::Duration;

use narukom::{AnySample, HostId, Kind, Moment, Narukom, PublisherId, Subscriber, TopicSlot};
use yase::Chart;
use yase::expression::{MessageSource, Origin};

use super::fetching::Fetching;
use crate::error::Error;
use crate::records::Delivery;

/// What a region knows of the sources that its chart names.
pub(super) struct Following {
    /// In the order of the chart's sources; the same in each region.
    feeds: Vec<Feed>,
}

/// The newest message of one source.
struct Feed {
    source: MessageSource,
    host: HostId,
    publisher: Option<Box<str>>,
    /// The publisher's number, once it has been met.
    known: Option<PublisherId>,
    kind: Kind,
    age: Option<Duration>,
    subscriber: Subscriber,
    newest: Option<AnySample>,
    /// Whether the last delivery brought the newest.
    is_fresh: bool,
}

impl Following {
    /// Follows what a chart reads of others than "this host, whoever publishes".
    ///
    /// # Errors
    /// There are more hosts than a hub tells apart.
    pub(super) fn new(chart: &Chart, hub: &Narukom) -> Result<Following, Error> {
        let feeds = chart.sources().filter(|source| !is_plain(&source.origin, hub.host()));
        let feeds = feeds.map(|source| Feed::new(source, hub)).collect::<Result<_, _>>();
        Ok(Following { feeds: feeds.map_err(Error::hub)? })
    }

    /// Takes what was published since the last time.
    pub(super) fn deliver(&mut self, hub: &Narukom, fetching: &mut Fetching) {
        for feed in &mut self.feeds {
            fetching.begin();
            feed.deliver(hub);
            fetching.end(feed.subscriber.position());
        }
    }

    /// What the last delivery brought, for the records.
    pub(super) fn fresh(&self, region: u32) -> impl Iterator<Item = Delivery> {
        self.feeds.iter().filter(|feed| feed.is_fresh).filter_map(move |feed| feed.record(region))
    }

    /// Takes over what another region knows.
    pub(super) fn adopt(&mut self, outer: &Following) {
        for (feed, outer) in self.feeds.iter_mut().zip(&outer.feeds) {
            feed.newest.clone_from(&outer.newest);
        }
    }

    /// Takes over the feeds of a chart that this one replaces, as far as it reads the same sources.
    pub(super) fn take_over(&mut self, old: Following) {
        for feed in old.feeds {
            if let Some(successor) = self.feeds.iter_mut().find(|known| known.source == feed.source) {
                *successor = feed;
            }
        }
    }

    /// The newest message of a source; none if it is not one that is followed. `shown` is the newest message of the topic on the region's
    /// blackboard, which holds what the region itself has written.
    pub(super) fn newest<'a>(
        &'a self,
        source: &MessageSource,
        shown: Option<&'a AnySample>,
        now: Moment,
        hub: &Narukom,
    ) -> Option<Option<&'a AnySample>> {
        let feed = self.feeds.iter().find(|feed| feed.source == *source)?;
        let own = shown.filter(|sample| feed.host == sample.header.host && feed.is_by(sample, hub));
        Some(own.or_else(|| feed.newest.as_ref().filter(|sample| feed.is_young(sample, now))))
    }
}

/// Whether the region's blackboard says it all.
fn is_plain(origin: &Origin, own: &str) -> bool {
    match origin {
        Origin::Own => true,
        Origin::Host(host) => **host == *own,
        _ => false,
    }
}

impl Feed {
    fn new(source: &MessageSource, hub: &Narukom) -> Result<Feed, narukom::Error> {
        let (host, publisher) = match &source.origin {
            Origin::Host(host) => (Some(host), None),
            Origin::Publisher(publisher) => (None, Some(publisher)),
            Origin::HostPublisher { host, publisher } => (Some(host), Some(publisher)),
            _ => (None, None),
        };
        let host = host.map_or(Ok(HostId::LOCAL), |name| hub.host_id(name))?;
        let slot = TopicSlot::new(source.topic.0);
        let topic = hub.declaration(slot);
        Ok(Feed {
            source: source.clone(),
            host,
            publisher: publisher.cloned(),
            known: None,
            kind: topic.map_or(Kind::State, |topic| topic.kind()),
            age: topic.and_then(|topic| topic.age()),
            subscriber: hub.subscriber_of(host, topic.map_or("", |topic| topic.path()))?,
            newest: None,
            is_fresh: false,
        })
    }

    fn deliver(&mut self, hub: &Narukom) {
        if self.kind == Kind::Signal {
            self.newest = None;
        }
        self.is_fresh = false;
        while let Some(sample) = self.subscriber.next_sample() {
            if self.is_meant(&sample, hub) {
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
            topic: header.topic.number(),
            sequence: header.sequence,
            region,
            host: host.into(),
            publisher: publisher.into(),
        })
    }

    /// Whether a message is by the publisher that is meant, which is looked up until it is met.
    fn is_meant(&mut self, sample: &AnySample, hub: &Narukom) -> bool {
        let publisher = sample.header.publisher;
        if let (Some(name), None) = (&self.publisher, self.known) {
            self.known = hub.publisher_name(publisher).filter(|met| **met == **name).map(|_| publisher);
        }
        self.is_known(sample)
    }

    fn is_known(&self, sample: &AnySample) -> bool {
        self.publisher.is_none() || self.known == Some(sample.header.publisher)
    }

    /// As [`is_known`](Feed::is_known), also before the publisher's first message has been delivered.
    fn is_by(&self, sample: &AnySample, hub: &Narukom) -> bool {
        let by = |name: &str| hub.publisher_name(sample.header.publisher).is_some_and(|met| *met == *name);
        self.is_known(sample) || self.known.is_none() && self.publisher.as_deref().is_some_and(by)
    }

    fn is_young(&self, sample: &AnySample, now: Moment) -> bool {
        self.age.is_none_or(|age| sample.header.local >= now - age)
    }
}
