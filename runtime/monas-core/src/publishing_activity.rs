//! Identifies the activity on whose behalf a thread publishes.
//!
//! A waiting activity is called early when a message arrives on a topic it reads, except for its
//! own publications. The hub's waker is called on the publishing thread during the publication, so
//! a thread-local can identify the publisher.

use std::cell::Cell;

use yase::Activation;

/// An activity of a chart: the number of its runner, and the activation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PublishingActivity {
    pub(crate) runner: u64,
    pub(crate) activation: Activation,
}

thread_local! {
    static PUBLISHING: Cell<Option<PublishingActivity>> = const { Cell::new(None) };
}

/// Publishes on behalf of an activity.
pub(crate) fn publish_as(origin: PublishingActivity, publish: impl FnOnce()) {
    PUBLISHING.set(Some(origin));
    publish();
    PUBLISHING.set(None);
}

/// The activity on whose behalf this thread publishes, if any.
pub fn publishing() -> Option<PublishingActivity> {
    PUBLISHING.get()
}
