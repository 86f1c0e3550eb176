//! What a blackboard has of one topic.

use std::cell::OnceCell;

use crate::reading::{Reader, Reading};
use crate::sample::HostId;
use crate::writing::Writing;

/// The messages of one topic on a blackboard: those of this host that were delivered, those of others, and its own.
#[derive(Default)]
pub(super) struct Place {
    reading: OnceCell<Box<Reading>>,
    /// Those of other hosts, each linked to the next, so that one more can be made while the others are being read.
    others: OnceCell<Box<Other>>,
    pub(super) writing: Option<Box<Writing>>,
}

struct Other {
    host: HostId,
    reading: Reading,
    next: OnceCell<Box<Other>>,
}

impl Place {
    #[inline]
    pub(super) fn reading(&self, host: HostId) -> Option<&Reading> {
        if host == HostId::LOCAL {
            return self.reading.get().map(|reading| &**reading);
        }
        self.others().find(|other| other.host == host).map(|other| &other.reading)
    }

    /// Who reads the messages of a host here.
    #[inline]
    pub(super) fn reader(&self, blackboard: u32, host: HostId) -> Reader {
        let own = self.writing.as_ref().filter(|_| host == HostId::LOCAL);
        Reader { blackboard, seen: own.map_or(0, |writing| writing.seen()) }
    }

    #[inline]
    pub(super) fn reading_mut(&mut self, host: HostId) -> Option<&mut Reading> {
        if host == HostId::LOCAL {
            return self.reading.get_mut().map(|reading| &mut **reading);
        }
        let mut link = &mut self.others;
        while let Some(other) = link.get_mut() {
            if other.host == host {
                return Some(&mut other.reading);
            }
            link = &mut other.next;
        }
        None
    }

    /// The readings of all hosts.
    pub(super) fn readings(&self) -> impl Iterator<Item = &Reading> {
        let own = self.reading.get().map(|reading| &**reading);
        own.into_iter().chain(self.others().map(|other| &other.reading))
    }

    fn others(&self) -> impl Iterator<Item = &Other> {
        let first = self.others.get();
        std::iter::successors(first, |other| other.next.get()).map(|other| &**other)
    }

    /// Puts a reading in its place, which is empty.
    pub(super) fn keep(&self, host: HostId, reading: Reading) -> &Reading {
        if host == HostId::LOCAL {
            return self.reading.get_or_init(|| Box::new(reading));
        }
        let mut link = &self.others;
        while let Some(other) = link.get() {
            link = &other.next;
        }
        &link.get_or_init(|| Box::new(Other { host, reading, next: OnceCell::new() })).reading
    }

    /// Ends a cycle; answers whether the end of the next one has something to do here.
    pub(super) fn close(&mut self, host: HostId) -> bool {
        self.reading_mut(host).into_iter().for_each(Reading::close);
        let writing = self.writing.as_mut().filter(|_| host == HostId::LOCAL);
        writing.is_some_and(|writing| {
            writing.close();
            writing.is_open()
        })
    }

    /// Whether the end of the cycle has something to do here.
    pub(super) fn is_open(&self, host: HostId) -> bool {
        let writing = self.writing.as_ref().filter(|_| host == HostId::LOCAL);
        self.reading(host).is_some_and(Reading::is_open) || writing.is_some_and(|writing| writing.is_open())
    }
}
