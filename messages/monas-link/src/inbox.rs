//! The queue from transports to the link's thread.

use std::collections::VecDeque;
#[cfg(test)]
use std::sync::Arc;
use std::sync::{Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

use crate::protocol::Packet;

/// The most packets that wait.
const MAX_PACKETS: usize = 16_384;

/// The most bytes that wait, besides the last packet's.
const MAX_BYTES: usize = 64 << 20;

/// Queue of received packets. A packet that does not fit is dropped and counted; the protocol
/// requests it again.
#[derive(Default)]
pub struct PacketInbox {
    content: Mutex<InboxState>,
    changed: Condvar,
    callback: OnceLock<PacketCallback>,
}

/// Processes the queue on the receiving thread; returns `false` if it cannot now and the waiting
/// thread must be woken.
type PacketCallback = Box<dyn Fn() -> bool + Send + Sync>;

#[derive(Default, Debug)]
struct InboxState {
    packets: VecDeque<Packet>,
    bytes: usize,
    dropped: u64,
    shared: u64,
    is_awake: bool,
}

impl PacketInbox {
    /// Adds a packet.
    pub fn put(&self, packet: Packet) {
        let mut content = self.content();
        if content.packets.len() == MAX_PACKETS || content.bytes > MAX_BYTES {
            content.dropped += 1;
            return;
        }
        content.bytes += size(&packet);
        content.packets.push_back(packet);
        drop(content);
        if !self.callback.get().is_some_and(|take| take()) {
            self.wake();
        }
    }

    /// Sets the callback that is called after each packet; can be set once.
    pub(crate) fn set_taker(&self, taker: PacketCallback) {
        // There is one link per inbox.
        let _ = self.callback.set(taker);
    }

    /// The next packet.
    pub fn take(&self) -> Option<Packet> {
        let mut content = self.content();
        let packet = content.packets.pop_front()?;
        content.bytes -= size(&packet);
        Some(packet)
    }

    /// Whether no packet waits.
    pub fn is_empty(&self) -> bool {
        self.content().packets.is_empty()
    }

    /// The number of packets that did not fit.
    pub fn dropped(&self) -> u64 {
        self.content().dropped
    }

    /// Counts a packet in memory shared with its sender.
    pub fn count_shared(&self) {
        self.content().shared += 1;
    }

    /// The number of packets in memory shared with their senders.
    pub fn shared(&self) -> u64 {
        self.content().shared
    }

    /// Wakes the waiting thread, or the next one to wait.
    pub fn wake(&self) {
        self.wake_with(self.content());
    }

    fn wake_with(&self, mut content: MutexGuard<'_, InboxState>) {
        let was_awake = std::mem::replace(&mut content.is_awake, true);
        drop(content);
        if !was_awake {
            self.changed.notify_one();
        }
    }

    /// Waits until it is [woken](PacketInbox::wake), at most for `longest`.
    pub fn wait(&self, longest: Duration) {
        let content = self.content();
        let (mut content, _) = self
            .changed
            .wait_timeout_while(content, longest, |content| !content.is_awake)
            .unwrap_or_else(PoisonError::into_inner);
        content.is_awake = false;
    }

    fn content(&self) -> MutexGuard<'_, InboxState> {
        self.content.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl std::fmt::Debug for PacketInbox {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PacketInbox").field("content", &self.content).finish_non_exhaustive()
    }
}

/// Names count too, since the sender chooses their length.
fn size(packet: &Packet) -> usize {
    let names = [Some(&packet.from), packet.to.as_ref(), packet.path.as_ref()];
    let names: usize = names.into_iter().flatten().map(|name| name.len()).sum();
    names + packet.stamp.len() + packet.payload.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packet(from: &str, payload: usize) -> Packet {
        let (stamp, payload) = (Arc::default(), vec![0; payload].into());
        Packet { from: from.into(), to: None, path: None, stamp, payload, priority: 4, is_reliable: true }
    }

    #[test]
    fn invalid_input_is_dropped_and_counted() {
        let inbox = PacketInbox::default();
        (0..MAX_PACKETS + 10).for_each(|_| inbox.put(packet("a", 0)));
        assert_eq!(inbox.dropped(), 10);
        assert_eq!(std::iter::from_fn(|| inbox.take()).count(), MAX_PACKETS);
        assert!(inbox.is_empty());
        for _ in 0..6 {
            inbox.put(packet(&"x".repeat(MAX_BYTES / 8), MAX_BYTES / 8));
        }
        assert_eq!(inbox.dropped(), 11, "names count as much as what they bring");
    }
}
