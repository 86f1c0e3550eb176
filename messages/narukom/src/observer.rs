//! Notification of publications: observers see every message, a waker learns which topics changed.

use crate::encoding::EncodingSlot;
use crate::sample::{AnySample, HostId, TopicSlot};
use crate::topic::TopicDeclaration;

/// A message as it is published, with the names for the numbers in its header.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Publication<'a> {
    /// The host of the hub that reports it.
    pub hub: &'a str,
    /// The host on which it was published.
    pub host: &'a str,
    /// Its publisher.
    pub publisher: &'a str,
    /// The topic.
    pub topic: &'a TopicDeclaration,
    /// The message and its header.
    pub sample: &'a AnySample,
    pub(crate) encoding: &'a EncodingSlot,
}

impl<'a> Publication<'a> {
    /// The protobuf encoding. A message is encoded once, however many observers and subscribers use
    /// it.
    pub fn bytes(&self) -> &'a [u8] {
        self.encoding.bytes(&*self.sample.message)
    }
}

/// Sees every message that is published on a hub, for example to record or to hash a run.
///
/// It is called once per message, in order of publication, on the publisher's thread. Other
/// publishers of the hub are blocked meanwhile, readers are not. So it must be quick, and must not
/// publish on the same hub, which would deadlock.
pub trait Observer: Send {
    /// A message was published.
    fn observe(&mut self, publication: Publication<'_>);

    /// A message published by another host was received. Ignored by default.
    fn observe_received(&mut self, publication: Publication<'_>) {
        let _ = publication;
    }
}

impl<F: FnMut(Publication<'_>) + Send> Observer for F {
    fn observe(&mut self, publication: Publication<'_>) {
        self(publication);
    }
}

/// Notified when a message is published on a topic, here or on another host, to wake waiting
/// threads.
///
/// It is called on the publisher's thread when no lock of the hub is held and the messages can be
/// fetched.
pub trait Waker: Send + Sync {
    /// A message of `host` was published on `topic`.
    fn wake(&self, topic: TopicSlot, host: HostId);
}

impl<F: Fn(TopicSlot, HostId) + Send + Sync> Waker for F {
    fn wake(&self, topic: TopicSlot, host: HostId) {
        self(topic, host);
    }
}
