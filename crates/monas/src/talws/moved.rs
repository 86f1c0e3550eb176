//! The topics on which something was published since somebody looked.

use std::sync::{Arc, Mutex, PoisonError};

use narukom::{HostId, Moment, TopicSlot};

use super::instance::Instance;
use crate::origin::{self, Origin};

/// What the waker of a hub notes, until the agents of the host are told.
#[derive(Clone, Default)]
pub(super) struct Moved {
    news: Arc<Mutex<Vec<News>>>,
    /// Where the topics that moved are looked through; kept for its memory.
    looked_through: Vec<News>,
}

/// A message was published: its topic and its host, and the activity of a chart that did it, if one did.
type News = (TopicSlot, HostId, Option<Origin>);

impl Moved {
    /// What takes note of a topic, for the waker of a hub.
    pub(super) fn noting(&self) -> impl Fn(TopicSlot, HostId) + Send + Sync + 'static {
        let news = self.news.clone();
        move |topic, host| {
            news.lock().unwrap_or_else(PoisonError::into_inner).push((topic, host, origin::publishing()));
        }
    }

    /// Tells every agent which topics have moved.
    pub(super) fn tell<'a>(&mut self, instances: impl Iterator<Item = &'a mut Instance>, now: Moment) {
        self.looked_through.clear();
        std::mem::swap(
            &mut *self.news.lock().unwrap_or_else(PoisonError::into_inner),
            &mut self.looked_through,
        );
        if self.looked_through.is_empty() {
            return;
        }
        for instance in instances {
            for (topic, host, origin) in &self.looked_through {
                instance.message_arrived(*topic, *host, *origin, now);
            }
        }
    }
}
