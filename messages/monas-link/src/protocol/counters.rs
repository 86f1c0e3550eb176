//! Counters per topic. They satisfy the documented equations, which the tests of this crate check.

/// Counts of the messages of a topic that a link has sent.
///
/// `taken == sent + dropped + oversize + waiting`: each message taken from the hub was sent, was
/// dropped, or waits.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct SentCounters {
    /// Messages taken from the hub.
    pub taken: u64,
    /// Messages that left the hub before they could be taken.
    pub lost: u64,
    /// Messages sent.
    pub sent: u64,
    /// Messages retransmitted on request.
    pub resent: u64,
    /// Messages displaced by newer ones before they could be sent.
    pub dropped: u64,
    /// Messages larger than the budget or the link allows.
    pub oversize: u64,
    /// Messages that wait to be sent.
    pub waiting: u64,
    /// Bytes sent, stamps included.
    pub bytes: u64,
}

/// Counts of the messages received of a topic of a host, since the host's link was last started.
///
/// `arrived == delivered + duplicates + late + refused + held`, and
/// `last - start == delivered + gaps + held + missing`: each message from the first one on was
/// delivered, is counted as a gap, or is awaited.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct ReceivedCounters {
    /// Messages that arrived, once or several times.
    pub arrived: u64,
    /// Messages passed to the hub.
    pub delivered: u64,
    /// Messages that had arrived before.
    pub duplicates: u64,
    /// Messages that arrived after they were counted as a gap.
    pub late: u64,
    /// Messages that the access list forbids, or that do not have the topic's type.
    pub refused: u64,
    /// Messages that will not be delivered any more.
    pub gaps: u64,
    /// Messages that have arrived and wait for earlier ones.
    pub held: u64,
    /// Messages that are awaited.
    pub missing: u64,
    /// The number of the message before the first one for this reader.
    pub start: u64,
    /// The number of the newest known message.
    pub last: u64,
    /// Bytes received.
    pub bytes: u64,
}

/// The counters of a link.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Counters {
    /// For each topic that is sent.
    pub sent: Vec<(String, SentCounters)>,
    /// For each host and topic that is received.
    pub received: Vec<(String, String, ReceivedCounters)>,
    /// Packets sent, of any kind.
    pub packets: u64,
    /// Packets that the transport rejected.
    pub failed: u64,
    /// Packets that could not be parsed.
    pub malformed: u64,
    /// Messages of links without a Hello, or of topics that they do not offer.
    pub strangers: u64,
    /// Packets of links that speak another version of the protocol.
    pub foreign: u64,
    /// The number of times that a packet had to wait because the budget was exhausted.
    pub waits: u64,
}
