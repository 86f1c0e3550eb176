//! Memory of messages, used again when their last reader has let go.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::message::{AnyMessage, Message};

/// More messages than the hub's ring holds: readers may hold the oldest for one cycle longer.
const SPARE: usize = 4;

/// The messages that one publisher made for one topic, oldest first. With every reader in step, the oldest has been
/// let go by the time a new one is made, and its memory is used again.
pub(crate) struct Pool {
    made: VecDeque<Arc<dyn AnyMessage>>,
    limit: usize,
}

impl Pool {
    /// A pool for a topic of which the hub holds `depth` messages.
    pub(crate) fn new(depth: usize) -> Pool {
        Pool { made: VecDeque::new(), limit: depth + SPARE }
    }

    /// Puts `message` behind a reference count. It is to be remembered when it is published.
    pub(crate) fn wrap<M: Message>(&mut self, message: M) -> Arc<dyn AnyMessage> {
        match self.vacant() {
            Some(vacant) => refill(vacant, message),
            None => Arc::new(message),
        }
    }

    /// The memory of a message that nobody holds any more.
    pub(crate) fn vacant(&mut self) -> Option<Arc<dyn AnyMessage>> {
        Arc::get_mut(self.made.front_mut()?)?;
        self.made.pop_front()
    }

    /// Keeps `message` for when its last reader has let go.
    pub(crate) fn remember(&mut self, message: &Arc<dyn AnyMessage>) {
        if self.made.len() == self.limit {
            self.made.pop_front();
        }
        self.made.push_back(message.clone());
    }
}

/// `vacant` with `message` in place of its old content; a new one if it is of another type.
fn refill<M: Message>(mut vacant: Arc<dyn AnyMessage>, message: M) -> Arc<dyn AnyMessage> {
    match Arc::get_mut(&mut vacant).and_then(|place| place.as_any_mut().downcast_mut::<M>()) {
        Some(place) => {
            *place = message;
            vacant
        }
        None => Arc::new(message),
    }
}
