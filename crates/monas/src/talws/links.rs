//! The links of a host while they run.

#[cfg(unix)]
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use monas_link::{Bridge, Inbox, Link, Place, Transport};
use narukom::{HostId, Moment, Narukom, TopicSlot};

use super::clock::Clock;
use super::stopper::Stopper;
use crate::error::{Error, ErrorKind};
use crate::link::{LinkConfig, LinkStatistics, LinkTransport};

/// For so long it is waited for the time of another end.
const PATIENCE: Duration = Duration::from_secs(30);

/// How often it is looked whether that is known.
const LOOK: Duration = Duration::from_millis(20);

/// The way there and back of the packets that measure it is not longer than this, so that it is wrong by at most half of it.
const LONGEST_WAY: Duration = Duration::from_millis(20);

/// A link that is running.
pub(super) struct RunningLink {
    host: String,
    name: String,
    /// Whether each topic of the hub is sent.
    sent: Vec<bool>,
    link: Link,
}

impl RunningLink {
    /// Starts a link. `clock` tells the time of the run.
    pub(super) fn start(
        hub: &Narukom,
        config: LinkConfig,
        clock: impl Fn() -> Moment + Send + 'static,
    ) -> Result<RunningLink, Error> {
        let LinkConfig { settings, transport, .. } = config;
        let host = hub.host().to_owned();
        let name = if settings.name.is_empty() { host.clone() } else { settings.name.clone() };
        let mut sent = vec![false; hub.topics().len()];
        for rule in &settings.send {
            let slots = hub.matching(&rule.topics).map_err(Error::hub)?;
            slots.iter().for_each(|slot| sent[slot.number() as usize] = true);
        }
        let way = Way::of(transport, &host)?;
        let link = Link::start(hub, settings, |bridge, inbox| way.connect(bridge, inbox), clock);
        let link = link.map_err(|error| {
            Error::new(ErrorKind::Link, format!("the link `{name}` of `{host}`: {error}")).caused_by(error)
        })?;
        Ok(RunningLink { host, name, sent, link })
    }

    /// How far the clock of another end is ahead of this one's, if that is known well enough to be taken for the own.
    fn clock_of(&self, other: &str) -> Option<i64> {
        let report = self.link.report();
        let offset = report.peers.iter().find(|(name, ..)| name == other)?.2?;
        (offset.way <= LONGEST_WAY.as_nanos() as u64).then_some(offset.ahead)
    }

    /// What it is to be told of publications.
    pub(super) fn waker(&self) -> impl Fn(TopicSlot, HostId) + Send + Sync + 'static {
        let (sent, waker) = (self.sent.clone(), self.link.waker());
        move |topic, host| {
            if sent.get(topic.number() as usize).is_some_and(|sent| *sent) {
                waker.wake(topic, host);
            }
        }
    }

    pub(super) fn statistics(&self) -> LinkStatistics {
        LinkStatistics { host: self.host.clone(), link: self.name.clone(), report: self.link.report() }
    }

    /// Ends it; what it has done.
    pub(super) fn stop(self) -> LinkStatistics {
        let RunningLink { host, name, link, .. } = self;
        LinkStatistics { host, link: name, report: link.stop() }
    }
}

/// The time of the end that a link's configuration names: the link is opened to ask, and closed again.
///
/// # Errors
/// The link does not come up, or the other end does not answer for [`PATIENCE`].
pub(super) fn time_of_other(hub: &Narukom, config: &LinkConfig, other: &str) -> Result<Clock, Error> {
    let (own, waiting) = (Clock::start(), Stopper::new());
    let link = RunningLink::start(hub, config.clone(), move || own.now())?;
    while own.now() < Moment::ZERO + PATIENCE {
        if let Some(ahead) = link.clock_of(other) {
            return Ok(own.ahead_by(ahead));
        }
        waiting.wait_until(own.now() + LOOK, &own);
    }
    let message = format!("the link `{}` of `{}` does not learn the time of `{other}`", link.name, link.host);
    let hint = "is that run there, and does its link send or receive anything of this one?";
    Err(Error::new(ErrorKind::Link, message).with_hint(hint))
}

/// A transport of which everything is known that is needed to open it.
enum Way {
    /// Sockets in a folder.
    #[cfg(unix)]
    Local(PathBuf),
    /// A session of zenoh.
    #[cfg(feature = "zenoh")]
    Zenoh(monas_link::ZenohSettings),
}

impl Way {
    fn of(transport: LinkTransport, host: &str) -> Result<Way, Error> {
        let refused = |reason: &str| {
            Err(Error::new(ErrorKind::Link, format!("a link of `{host}` cannot be opened: {reason}")))
        };
        match transport {
            #[cfg(unix)]
            LinkTransport::Local { folder } => match folder.or_else(monas_link::default_folder) {
                Some(folder) => Ok(Way::Local(folder)),
                None => refused("neither does it name a folder, nor does the system with XDG_RUNTIME_DIR"),
            },
            #[cfg(not(unix))]
            LinkTransport::Local { .. } => refused("local sockets are those of Unix"),
            #[cfg(feature = "zenoh")]
            LinkTransport::Zenoh(endpoints) => Ok(Way::Zenoh(endpoints.settings())),
            #[cfg(not(feature = "zenoh"))]
            LinkTransport::Zenoh(_) => {
                refused("this program has no zenoh; one that is built with `--features zenoh` has it")
            }
        }
    }

    // where neither is there, there is nothing to connect
    #[cfg_attr(not(any(unix, feature = "zenoh")), allow(unused_variables))]
    fn connect(self, bridge: &Bridge, inbox: Arc<Inbox>) -> Result<Box<dyn Transport>, monas_link::Error> {
        match self {
            #[cfg(unix)]
            Way::Local(folder) => Ok(Box::new(monas_link::Local::new(&folder, bridge.node().host(), inbox)?)),
            #[cfg(feature = "zenoh")]
            Way::Zenoh(settings) => Ok(Box::new(monas_link::Zenoh::open(&settings, bridge.node(), inbox)?)),
        }
    }
}

/// Which topics links bring to a host, by their numbers.
#[derive(Debug, Default)]
pub(super) struct Brought {
    /// As messages of other hosts.
    pub(super) others: Vec<TopicSlot>,
    /// As the host's own.
    pub(super) own: Vec<TopicSlot>,
}

impl Brought {
    /// # Errors
    /// A pattern fits no topic.
    pub(super) fn by(links: &[LinkConfig], hub: &Narukom) -> Result<Brought, Error> {
        let mut brought = Brought::default();
        for rule in links.iter().flat_map(|link| &link.settings.receive) {
            let slots = hub.matching(&rule.topics).map_err(Error::hub)?;
            match rule.place {
                Place::Own => brought.own.extend(slots),
                Place::Other => brought.others.extend(slots),
            }
        }
        Ok(brought)
    }
}
