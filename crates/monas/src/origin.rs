//! Tells a hub's waker whose messages it is told of.
//!
//! An activity that waits is called early when a message arrives on a topic it reads, but not by what it has just published
//! itself. The waker is called on the publisher's thread while that publishes, so what the thread says it is doing holds.

use std::cell::Cell;

use yase::Activation;

/// An activity of a chart: the number of its runner, and the activation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Origin {
    pub(crate) runner: u64,
    pub(crate) activation: Activation,
}

thread_local! {
    static PUBLISHING: Cell<Option<Origin>> = const { Cell::new(None) };
}

/// Publishes in the name of an activity.
pub(crate) fn publish_as(origin: Origin, publish: impl FnOnce()) {
    PUBLISHING.set(Some(origin));
    publish();
    PUBLISHING.set(None);
}

/// In whose name this thread publishes at this point, if in an activity's.
pub(crate) fn publishing() -> Option<Origin> {
    PUBLISHING.get()
}
