//! The time between the exposure of a picture and its delivery.

use std::collections::VecDeque;
use std::time::Duration;

use narukom::Timestamp;

/// Pictures that were taken and are not delivered yet, the oldest first.
#[derive(Debug)]
pub(super) struct PictureQueue<T>(VecDeque<(Timestamp, T)>);

impl<T> PictureQueue<T> {
    pub(super) fn new() -> Self {
        Self(VecDeque::new())
    }

    /// Adds a picture that was exposed now.
    pub(super) fn expose(&mut self, now: Timestamp, picture: T) {
        self.0.push_back((now, picture));
    }

    /// The newest picture that was exposed at least `latency` ago. Older ones are discarded: a
    /// camera's driver keeps only the newest.
    pub(super) fn deliver(&mut self, now: Timestamp, latency: Duration) -> Option<T> {
        let due = self.0.iter().take_while(|(exposed_at, _)| now.since(*exposed_at) >= latency).count();
        self.0.drain(..due).last().map(|(_, picture)| picture)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_delivered_once_and_not_before_its_latency() {
        let at = |millis: u64| Timestamp::from_nanos(millis * 1_000_000);
        let latency = Duration::from_millis(60);
        let mut queue = PictureQueue::new();
        for (now, picture) in [(0, 'a'), (40, 'b'), (60, 'c')] {
            queue.expose(at(now), picture);
        }
        let delivered = [59, 60, 80, 120, 140].map(|now| queue.deliver(at(now), latency));
        assert_eq!(delivered, [None, Some('a'), None, Some('c'), None]);
        queue.expose(at(200), 'd');
        assert_eq!(queue.deliver(at(200), Duration::ZERO), Some('d'));
    }
}
