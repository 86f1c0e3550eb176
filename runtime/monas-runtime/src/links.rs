//! The links of a host during a run.

#[cfg(unix)]
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use monas_link::{HubBridge, Link, PacketInbox, PublishAs, Transport};
use narukom::{HostId, Hub, Timestamp, TopicSlot};

use super::clock::RunClock;
use super::stop_handle::StopHandle;
use monas_core::error::{Error, ErrorKind};
use monas_link::LinkConfig;
use monas_link::LinkStatistics;
use monas_link::LinkTransport;

/// Maximum wait for the clock of another end.
const TIMEOUT: Duration = Duration::from_secs(30);

/// Interval between checks for the clock of another end.
const CHECK_INTERVAL: Duration = Duration::from_millis(20);

/// Maximum round-trip time of the packets that measure a clock offset; the error is at most half of
/// it.
const LONGEST_WAY: Duration = Duration::from_millis(20);

/// A link during a run.
pub(crate) struct RunningLink {
    host: String,
    name: String,
    /// Whether each topic of the hub is sent.
    sent: Vec<bool>,
    link: Link,
}

impl RunningLink {
    /// Starts a link. `clock` returns the time of the run.
    pub(crate) fn start(
        hub: &Hub,
        config: LinkConfig,
        clock: impl Fn() -> Timestamp + Send + 'static,
    ) -> Result<RunningLink, Error> {
        let LinkConfig { settings, transport, .. } = config;
        let host = hub.host().to_owned();
        let name = if settings.name.is_empty() { host.clone() } else { settings.name.clone() };
        let mut sent = vec![false; hub.topics().len()];
        for rule in &settings.send {
            let slots = hub.matching(&rule.topics).map_err(Error::hub)?;
            slots.iter().for_each(|slot| sent[slot.number() as usize] = true);
        }
        let transport = ResolvedTransport::of(transport, &host)?;
        let link = Link::start(hub, settings, |bridge, inbox| transport.connect(bridge, inbox), clock);
        let link = link.map_err(|error| {
            Error::new(ErrorKind::Link, format!("the link `{name}` of `{host}`: {error}")).caused_by(error)
        })?;
        Ok(RunningLink { host, name, sent, link })
    }

    /// The offset by which the clock of another end is ahead of this one, in nanoseconds, if it is
    /// known precisely enough to be adopted.
    fn clock_of(&self, other: &str) -> Option<i64> {
        let report = self.link.report();
        let offset = report.peers.iter().find(|(name, ..)| name == other)?.2?;
        (offset.round_trip <= LONGEST_WAY.as_nanos() as u64).then_some(offset.ahead)
    }

    /// The callback for publications.
    pub(crate) fn waker(&self) -> impl Fn(TopicSlot, HostId) + Send + Sync + 'static {
        let (sent, waker) = (self.sent.clone(), self.link.waker());
        move |topic, host| {
            if sent.get(topic.number() as usize).is_some_and(|sent| *sent) {
                waker.wake(topic, host);
            }
        }
    }

    pub(crate) fn statistics(&self) -> LinkStatistics {
        LinkStatistics { host: self.host.clone(), link: self.name.clone(), report: self.link.report() }
    }

    /// Stops the link and returns its statistics.
    pub(crate) fn stop(self) -> LinkStatistics {
        let RunningLink { host, name, link, .. } = self;
        LinkStatistics { host, link: name, report: link.stop() }
    }
}

/// The time of the end named by a link's configuration: opens the link for the query and closes it
/// again.
///
/// # Errors
/// The link cannot be established, or the other end does not reply within [`TIMEOUT`].
pub(crate) fn time_of_other(hub: &Hub, config: &LinkConfig, other: &str) -> Result<RunClock, Error> {
    let (own, waiting) = (RunClock::start(), StopHandle::new());
    let link = RunningLink::start(hub, config.clone(), move || own.now())?;
    while own.now() < Timestamp::ZERO + TIMEOUT {
        if let Some(ahead) = link.clock_of(other) {
            return Ok(own.ahead_by(ahead));
        }
        waiting.wait_until(own.now() + CHECK_INTERVAL, &own);
    }
    let message = format!("the link `{}` of `{}` has no clock of `{other}`", link.name, link.host);
    let hint = "is that run active, and does its link exchange topics with this one?";
    Err(Error::new(ErrorKind::Link, message).with_hint(hint))
}

/// A transport with everything that is needed to open it.
enum ResolvedTransport {
    /// Sockets in a directory.
    #[cfg(unix)]
    Local(PathBuf),
    /// A zenoh session.
    #[cfg(feature = "zenoh")]
    Zenoh(monas_link::ZenohSettings),
}

impl ResolvedTransport {
    fn of(transport: LinkTransport, host: &str) -> Result<ResolvedTransport, Error> {
        let refused = |reason: &str| {
            Err(Error::new(ErrorKind::Link, format!("a link of `{host}` cannot be opened: {reason}")))
        };
        match transport {
            #[cfg(unix)]
            LinkTransport::Local { folder } => match folder.map_or_else(monas_link::default_folder, Ok) {
                Ok(folder) => Ok(ResolvedTransport::Local(folder)),
                Err(error) => refused(&error.to_string()),
            },
            #[cfg(not(unix))]
            LinkTransport::Local { .. } => refused("local sockets need Unix"),
            #[cfg(feature = "zenoh")]
            LinkTransport::Zenoh(endpoints) => Ok(ResolvedTransport::Zenoh(endpoints.settings())),
            #[cfg(not(feature = "zenoh"))]
            LinkTransport::Zenoh(_) => refused("this program was built without `--features zenoh`"),
        }
    }

    // Without either transport there is nothing to connect.
    #[cfg_attr(not(any(unix, feature = "zenoh")), allow(unused_variables))]
    fn connect(
        self,
        bridge: &HubBridge,
        inbox: Arc<PacketInbox>,
    ) -> Result<Box<dyn Transport>, monas_link::Error> {
        match self {
            #[cfg(unix)]
            ResolvedTransport::Local(folder) => {
                Ok(Box::new(monas_link::LocalTransport::new(&folder, bridge.node().host(), inbox)?))
            }
            #[cfg(feature = "zenoh")]
            ResolvedTransport::Zenoh(settings) => {
                Ok(Box::new(monas_link::Zenoh::open(&settings, bridge.node(), inbox)?))
            }
        }
    }
}

/// The topics that links bring to a host, by their numbers.
#[derive(Debug, Default)]
pub(crate) struct LinkedTopics {
    /// Topics received as messages of other hosts.
    pub(crate) others: Vec<TopicSlot>,
    /// Topics received as the host's own messages.
    pub(crate) own: Vec<TopicSlot>,
}

impl LinkedTopics {
    /// # Errors
    /// A pattern matches no topic.
    pub(crate) fn by(links: &[LinkConfig], hub: &Hub) -> Result<LinkedTopics, Error> {
        let mut brought = LinkedTopics::default();
        for rule in links.iter().flat_map(|link| &link.settings.receive) {
            let slots = hub.matching(&rule.topics).map_err(Error::hub)?;
            match rule.publish_as {
                PublishAs::Own => brought.own.extend(slots),
                PublishAs::Other => brought.others.extend(slots),
            }
        }
        Ok(brought)
    }
}
