//! The state of one topic on a blackboard.

use std::cell::OnceCell;

use crate::inbox::{Inbox, ReaderView};
use crate::outbox::Outbox;
use crate::sample::HostId;

/// The messages of one topic on a blackboard: those delivered from this host, those from other
/// hosts, and its own.
#[derive(Default)]
pub(super) struct TopicEntry {
    reading: OnceCell<Box<Inbox>>,
    /// The inboxes of other hosts as a linked list, so that one can be added while others are
    /// borrowed.
    remote: OnceCell<Box<RemoteInbox>>,
    pub(super) writing: Option<Box<Outbox>>,
}

struct RemoteInbox {
    host: HostId,
    reading: Inbox,
    next: OnceCell<Box<RemoteInbox>>,
}

impl TopicEntry {
    #[inline]
    pub(super) fn inbox(&self, host: HostId) -> Option<&Inbox> {
        if host == HostId::LOCAL {
            return self.reading.get().map(|reading| &**reading);
        }
        self.others().find(|other| other.host == host).map(|other| &other.reading)
    }

    /// The reader of a host's messages.
    #[inline]
    pub(super) fn reader(&self, blackboard: u32, host: HostId) -> ReaderView {
        let own = self.writing.as_ref().filter(|_| host == HostId::LOCAL);
        ReaderView { blackboard, seen: own.map_or(0, |writing| writing.seen()) }
    }

    #[inline]
    pub(super) fn inbox_mut(&mut self, host: HostId) -> Option<&mut Inbox> {
        if host == HostId::LOCAL {
            return self.reading.get_mut().map(|reading| &mut **reading);
        }
        let mut link = &mut self.remote;
        while let Some(other) = link.get_mut() {
            if other.host == host {
                return Some(&mut other.reading);
            }
            link = &mut other.next;
        }
        None
    }

    /// The inboxes of all hosts.
    pub(super) fn inboxes(&self) -> impl Iterator<Item = &Inbox> {
        let own = self.reading.get().map(|reading| &**reading);
        own.into_iter().chain(self.others().map(|other| &other.reading))
    }

    fn others(&self) -> impl Iterator<Item = &RemoteInbox> {
        let first = self.remote.get();
        std::iter::successors(first, |other| other.next.get()).map(|other| &**other)
    }

    /// Inserts an inbox for a host that has none.
    pub(super) fn insert_inbox(&self, host: HostId, reading: Inbox) -> &Inbox {
        if host == HostId::LOCAL {
            return self.reading.get_or_init(|| Box::new(reading));
        }
        let mut link = &self.remote;
        while let Some(other) = link.get() {
            link = &other.next;
        }
        &link.get_or_init(|| Box::new(RemoteInbox { host, reading, next: OnceCell::new() })).reading
    }

    /// Ends a cycle; returns whether the end of the next cycle has work to do here.
    pub(super) fn close(&mut self, host: HostId) -> bool {
        self.inbox_mut(host).into_iter().for_each(Inbox::close);
        let writing = self.writing.as_mut().filter(|_| host == HostId::LOCAL);
        writing.is_some_and(|writing| {
            writing.close();
            writing.is_open()
        })
    }

    /// Whether the end of the cycle has work to do here.
    pub(super) fn is_open(&self, host: HostId) -> bool {
        let writing = self.writing.as_ref().filter(|_| host == HostId::LOCAL);
        self.inbox(host).is_some_and(Inbox::is_open) || writing.is_some_and(|writing| writing.is_open())
    }
}
