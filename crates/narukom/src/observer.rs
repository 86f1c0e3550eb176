//! Those whom a hub tells of publications: observers see every message, a waker learns which topics moved.

use crate::encoding::Encoding;
use crate::sample::{AnySample, HostId, TopicSlot};
use crate::topic::TopicDeclaration;

/// A message as it is published, with the names behind its header's numbers.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Publication<'a> {
    /// The host whose hub shows it.
    pub hub: &'a str,
    /// The host on which it was published.
    pub host: &'a str,
    /// Who published it.
    pub publisher: &'a str,
    /// The topic.
    pub topic: &'a TopicDeclaration,
    /// The message and its header.
    pub sample: &'a AnySample,
    pub(crate) encoding: &'a Encoding,
}

impl<'a> Publication<'a> {
    /// The protobuf encoding. However many observers and taps ask, the message is encoded once.
    pub fn bytes(&self) -> &'a [u8] {
        self.encoding.bytes(&*self.sample.message)
    }
}

/// Sees every message that is published on a hub: a recorder, a run hash.
///
/// It is called once for each message, in the order of publication, on the publisher's thread. Other publishers of
/// the hub wait meanwhile, readers do not. So it must be quick, and must not publish on the same hub: that would wait for itself.
pub trait Observer: Send {
    /// A message was published.
    fn observe(&mut self, publication: Publication<'_>);

    /// A message came from another host, which published it. By default it is not looked at.
    fn observe_received(&mut self, publication: Publication<'_>) {
        let _ = publication;
    }
}

impl<F: FnMut(Publication<'_>) + Send> Observer for F {
    fn observe(&mut self, publication: Publication<'_>) {
        self(publication);
    }
}

/// Learns that a message was published on a topic, here or on another host, so that whoever waits for it can be woken.
///
/// It is called on the publisher's thread, when no lock of the hub is held and the messages can be fetched.
pub trait Waker: Send + Sync {
    /// A message of `host` was published on `topic`.
    fn wake(&self, topic: TopicSlot, host: HostId);
}

impl<F: Fn(TopicSlot, HostId) + Send + Sync> Waker for F {
    fn wake(&self, topic: TopicSlot, host: HostId) {
        self(topic, host);
    }
}
