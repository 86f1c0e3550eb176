//! The hand-over between threads: what is to be done goes out through [`Work`], what has happened comes back through a [`Mailbox`].
//!
//! Two things must never happen here: that something is put in and nobody who sleeps is woken for it, and that somebody goes to
//! sleep who has not seen what was put in. Both structures keep everything that decides about sleeping under one lock, and look again
//! under it before they sleep. They are written against [`Primitives`], so that the tests run this very code on the primitives of a
//! checker, which tries one interleaving of the threads after the other.

mod habit;
mod mailbox;
#[cfg(test)]
mod model;
mod primitives;
mod work;

pub(super) use mailbox::{Mail, Mailbox};
pub(super) use work::Work;
