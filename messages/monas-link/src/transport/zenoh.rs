//! Transport between computers, on zenoh. Its sessions carry packets; sequence numbers,
//! retransmission and histories belong to the protocol.
//!
//! | key | content |
//! |---|---|
//! | `REALM/HOST/m/TOPIC` | a message of a topic: its protobuf encoding, with the stamp attached |
//! | `REALM/HOST/r/TO/TOPIC` | the same, retransmitted to one host |
//! | `REALM/HOST/c` | a control |
//!
//! A program without a link subscribes to `REALM/*/m/soccer/ball` and decodes the messages; it puts
//! plain protobuf on `REALM/ITS_NAME/m/soccer/command`, and is called a guest.

mod config;

use std::collections::BTreeMap;
use std::fmt::Display;
use std::sync::Arc;

use zenoh::bytes::ZBytes;
use zenoh::pubsub::Publisher;
use zenoh::qos::{CongestionControl, Priority, Reliability};
use zenoh::sample::{Locality, Sample, SampleKind};
use zenoh::shm::ShmBuf as _;
use zenoh::{Session, Wait};

use crate::error::{Error, ErrorKind};
use crate::inbox::PacketInbox;
use crate::link::Transport;
use crate::protocol::{MessageBytes, Node, Packet};

pub use config::{Tls, ZenohSettings};

/// The part of a message for its key and framing.
const FRAMING_SIZE: usize = 1 << 10;

/// A zenoh session.
pub struct Zenoh {
    session: Session,
    /// Realm and host.
    prefix: String,
    publishers: BTreeMap<Arc<str>, Publisher<'static>>,
    largest: usize,
}

impl Zenoh {
    /// Opens a session, and subscribes to the topics that the node receives. Other hosts need not
    /// be present yet.
    ///
    /// # Errors
    /// A name does not fit into a key, a certificate cannot be used, or the session cannot listen
    /// on an endpoint.
    pub fn open(settings: &ZenohSettings, node: &Node, inbox: Arc<PacketInbox>) -> Result<Zenoh, Error> {
        let (realm, host) = (&settings.realm, node.host());
        check_name(realm)?;
        check_name(host)?;
        let session = zenoh::open(settings.config(node.access())?).wait().map_err(refused)?;
        let mut zenoh = Zenoh {
            session,
            prefix: format!("{realm}/{host}"),
            publishers: BTreeMap::new(),
            largest: settings.largest,
        };
        zenoh.subscribe(realm, node, &inbox)?;
        for topic in node.sends() {
            let key = format!("{}/m/{}", zenoh.prefix, topic.path);
            let publisher = zenoh.session.declare_publisher(key);
            // Never block on a slow reader: what is dropped is requested again.
            let publisher = publisher
                .congestion_control(CongestionControl::Drop)
                .priority(priority(topic.priority))
                .reliability(reliability(topic.reliability == crate::Reliability::Reliable));
            zenoh.publishers.insert(topic.path.clone(), publisher.wait().map_err(refused)?);
        }
        Ok(zenoh)
    }

    fn subscribe(&self, realm: &str, node: &Node, inbox: &Arc<PacketInbox>) -> Result<(), Error> {
        let mut keys = vec![format!("{realm}/*/c"), format!("{realm}/*/r/{}/**", node.host())];
        keys.extend(node.receives().iter().map(|topic| format!("{realm}/*/m/{}", topic.path)));
        for key in keys {
            let (inbox, skipped, largest) = (inbox.clone(), realm.len() + 1, self.largest);
            let take = move |sample: Sample| receive(&sample, skipped, largest, &inbox);
            let subscriber =
                self.session.declare_subscriber(key).allowed_origin(Locality::Remote).callback(take);
            subscriber.background().wait().map_err(refused)?;
        }
        Ok(())
    }

    /// Sends packets without a publisher: controls, and packets to one host only.
    fn put(&self, packet: &Packet) -> Result<(), Error> {
        let key = match (&packet.path, &packet.to) {
            (Some(path), Some(to)) => format!("{}/r/{to}/{path}", self.prefix),
            (Some(path), None) => format!("{}/m/{path}", self.prefix),
            (None, _) => format!("{}/c", self.prefix),
        };
        let put =
            self.session.put(key, packet.payload.bytes().clone()).congestion_control(CongestionControl::Drop);
        let put = put.priority(priority(packet.priority)).reliability(reliability(packet.is_reliable));
        put.attachment(&packet.stamp[..]).wait().map_err(refused)
    }
}

impl Transport for Zenoh {
    fn send(&mut self, packet: &Packet) -> Result<(), Error> {
        let publisher = packet.path.as_ref().filter(|_| packet.to.is_none());
        match publisher.and_then(|path| self.publishers.get(path)) {
            Some(publisher) => publisher
                .put(packet.payload.bytes().clone())
                .attachment(&packet.stamp[..])
                .wait()
                .map_err(refused),
            None => self.put(packet),
        }
    }

    fn largest(&self) -> usize {
        self.largest.saturating_sub(FRAMING_SIZE)
    }
}

impl Drop for Zenoh {
    fn drop(&mut self) {
        self.publishers.clear();
        // A session that cannot be closed ends with its process.
        let _ = self.session.close().wait();
    }
}

impl std::fmt::Debug for Zenoh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Zenoh({})", self.prefix)
    }
}

/// The cause of a zenoh error, without the chain of source locations that zenoh appends.
fn refused(error: impl Display) -> Error {
    let text = error.to_string().replace('[', "");
    let reason = text.split(" at /").next().unwrap_or_default();
    Error::new(ErrorKind::Connection, format!("zenoh: {reason}"))
}

fn check_name(name: &str) -> Result<(), Error> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(is_plain) {
        return Ok(());
    }
    let text = format!("`{name}` cannot be part of a key: letters, digits, `_` and `-`");
    Err(Error::new(ErrorKind::Settings, text))
}

fn priority(number: u8) -> Priority {
    Priority::try_from(number.clamp(1, 7)).unwrap_or(Priority::DEFAULT)
}

fn reliability(is_reliable: bool) -> Reliability {
    if is_reliable { Reliability::Reliable } else { Reliability::BestEffort }
}

/// The bytes of a sample. Those in shared memory are not copied: a message is decoded from them
/// once, and the decoder is safe on any input. Only processes of the same user can change them
/// meanwhile, and these could harm this process without it.
fn payload(payload: &ZBytes) -> MessageBytes {
    if payload.as_shm().is_none() {
        return payload.to_bytes().into_owned().into();
    }
    let (lent, asked) = (Shared(payload.clone()), payload.clone());
    MessageBytes::from_shared_memory(lent, move || asked.as_shm().is_some_and(|memory| memory.is_valid()))
}

/// Bytes in shared memory: one slice.
struct Shared(ZBytes);

impl AsRef<[u8]> for Shared {
    fn as_ref(&self) -> &[u8] {
        self.0.slices().next().unwrap_or_default()
    }
}

fn receive(sample: &Sample, skipped: usize, largest: usize, inbox: &PacketInbox) {
    let Some(packet) = packet(sample, skipped, largest) else { return };
    if sample.payload().as_shm().is_some() {
        inbox.count_shared();
    }
    inbox.put(packet);
}

/// The packet in a sample, if its key is one of a link. One that is too long becomes a packet that
/// cannot be parsed, and is counted as such.
fn packet(sample: &Sample, skipped: usize, largest: usize) -> Option<Packet> {
    if sample.kind() != SampleKind::Put {
        return None;
    }
    let (from, rest) = sample.key_expr().as_str().get(skipped..)?.split_once('/')?;
    let (path, to) = match rest.split_once('/') {
        None if rest == "c" => (None, None),
        Some(("m", path)) => (Some(path), None),
        Some(("r", rest)) => rest.split_once('/').map(|(to, path)| (Some(path), Some(to)))?,
        _ => return None,
    };
    let stamp = sample.attachment().map(ZBytes::to_bytes).unwrap_or_default();
    let is_taken = stamp.len() + sample.payload().len() <= largest;
    let (stamp, payload) = match is_taken {
        true => (stamp, payload(sample.payload())),
        false => ((&[0xff]).into(), MessageBytes::default()),
    };
    Some(Packet {
        from: from.into(),
        to: to.map(Arc::from),
        path: path.map(Arc::from),
        stamp: (&*stamp).into(),
        payload,
        priority: sample.priority() as u8,
        is_reliable: sample.reliability() == Reliability::Reliable,
    })
}
