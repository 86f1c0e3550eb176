//! Hand-over between threads: calls go out through a [`WorkQueue`], returns and other wake-ups come
//! back through a [`Mailbox`].
//!
//! Two errors must be excluded: an item is added without waking a sleeping receiver, and a receiver
//! goes to sleep without having seen an added item. Both structures keep everything that decides
//! about sleeping under one lock, and check again under it before they sleep. They are generic over
//! [`Primitives`](primitives::Primitives), so that the tests execute the same code on the
//! primitives of a checker, which explores interleavings of the threads.

mod adaptive_spin;
mod mailbox;
mod primitives;
#[cfg(test)]
mod shuttle_model;
mod work_queue;

pub(crate) use mailbox::{Mailbox, Wakeups};
pub(crate) use work_queue::WorkQueue;
