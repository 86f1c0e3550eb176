//! Memory of messages, used again when their last reader has let go.

use std::sync::Arc;

use crate::encoding::decode;
use crate::error::Error;
use crate::message::{AnyMessage, Message};
use crate::topic::TopicDeclaration;

/// How many messages wait for their last reader. Readers in step have let go of what the hub's ring gives back by the time
/// the next message is made; the others are for readers that are a few cycles behind.
const SPARE: usize = 4;

/// Messages that left the hub's ring when this writer published.
#[derive(Default)]
pub(crate) struct Pool {
    spares: Vec<Arc<dyn AnyMessage>>,
    /// Whose turn it is to go when there are too many.
    turn: usize,
}

impl Pool {
    /// Puts `message` behind a reference count.
    pub(crate) fn wrap<M: Message>(&mut self, message: M) -> Arc<dyn AnyMessage> {
        for spare in 0..self.spares.len() {
            if let Some(place) = exclusive(&mut self.spares[spare]) {
                *place = message;
                return self.spares.swap_remove(spare);
            }
        }
        Arc::new(message)
    }

    /// A message made in place: `make` is given one with nothing set, whose texts, bytes and lists may have memory.
    pub(crate) fn build<M: Message>(&mut self, make: impl FnOnce(&mut M)) -> Arc<dyn AnyMessage> {
        for spare in 0..self.spares.len() {
            if let Some(place) = exclusive::<M>(&mut self.spares[spare]) {
                place.clear();
                make(place);
                return self.spares.swap_remove(spare);
            }
        }
        let mut message = M::default();
        make(&mut message);
        Arc::new(message)
    }

    /// The message of a topic that `bytes` encode.
    pub(crate) fn decoded(
        &mut self,
        topic: &TopicDeclaration,
        bytes: &[u8],
    ) -> Result<Arc<dyn AnyMessage>, Error> {
        let mut message = self.vacant().unwrap_or_else(|| topic.default_message());
        if let Some(place) = Arc::get_mut(&mut message)
            && let Err(error) = decode(topic, place, bytes)
        {
            self.keep(message);
            return Err(error);
        }
        Ok(message)
    }

    /// A message that nobody else holds, equal to `source` or with nothing set.
    pub(crate) fn copied(
        &mut self,
        topic: &TopicDeclaration,
        source: Option<&dyn AnyMessage>,
    ) -> Arc<dyn AnyMessage> {
        let Some(source) = source else { return topic.default_message() };
        let mut message = self.vacant().unwrap_or_else(|| topic.default_message());
        if let Some(place) = Arc::get_mut(&mut message) {
            place.copy_from(source);
        }
        message
    }

    /// A message that nobody else holds, with any content.
    fn vacant(&mut self) -> Option<Arc<dyn AnyMessage>> {
        let place = self.spares.iter_mut().position(|spare| Arc::get_mut(spare).is_some())?;
        Some(self.spares.swap_remove(place))
    }

    /// Takes what left the hub's ring.
    pub(crate) fn take_back(&mut self, message: Option<Arc<dyn AnyMessage>>) {
        let Some(mut message) = message else { return };
        // Its counts are with the core that let go of it last. They are fetched now, when nobody waits, and not for the next message.
        std::hint::black_box(Arc::get_mut(&mut message).is_some());
        self.keep(message);
    }

    /// Keeps `message` for when its last reader has let go.
    #[inline]
    fn keep(&mut self, message: Arc<dyn AnyMessage>) {
        if self.spares.len() < SPARE {
            self.spares.push(message);
        } else {
            self.turn = (self.turn + 1) % SPARE;
            self.spares[self.turn] = message;
        }
    }
}

fn exclusive<M: Message>(message: &mut Arc<dyn AnyMessage>) -> Option<&mut M> {
    Arc::get_mut(message)?.as_any_mut().downcast_mut()
}
