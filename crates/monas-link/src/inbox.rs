//! Where transports put what has come, until the link's thread takes it.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::protocol::Packet;

/// So many packets wait,
const PACKETS: usize = 16_384;

/// and so many bytes, besides the last packet's.
const BYTES: usize = 64 << 20;

/// Packets that have come. What does not fit is dropped and counted; the protocol asks for it again.
#[derive(Default, Debug)]
pub struct Inbox {
    content: Mutex<Content>,
    changed: Condvar,
}

#[derive(Default, Debug)]
struct Content {
    packets: VecDeque<Packet>,
    bytes: usize,
    dropped: u64,
    is_awake: bool,
}

impl Inbox {
    /// Puts a packet in.
    pub fn put(&self, packet: Packet) {
        let mut content = self.content();
        if content.packets.len() == PACKETS || content.bytes > BYTES {
            content.dropped += 1;
            return;
        }
        content.bytes += packet.stamp.len() + packet.payload.len();
        content.packets.push_back(packet);
        drop(content);
        self.wake();
    }

    /// The next packet.
    pub fn take(&self) -> Option<Packet> {
        let mut content = self.content();
        let packet = content.packets.pop_front()?;
        content.bytes -= packet.stamp.len() + packet.payload.len();
        Some(packet)
    }

    /// How many packets did not fit.
    pub fn dropped(&self) -> u64 {
        self.content().dropped
    }

    /// Wakes whoever waits, or will wait next.
    pub fn wake(&self) {
        let mut content = self.content();
        let was_awake = std::mem::replace(&mut content.is_awake, true);
        drop(content);
        if !was_awake {
            self.changed.notify_one();
        }
    }

    /// Waits until somebody [wakes](Inbox::wake) it, but not longer than `longest`.
    pub fn wait(&self, longest: Duration) {
        let content = self.content();
        let (mut content, _) = self
            .changed
            .wait_timeout_while(content, longest, |content| !content.is_awake)
            .unwrap_or_else(PoisonError::into_inner);
        content.is_awake = false;
    }

    fn content(&self) -> MutexGuard<'_, Content> {
        self.content.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
