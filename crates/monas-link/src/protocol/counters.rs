//! What is counted, for each topic. The figures add up; the tests of this crate hold them to it.

/// What a link has sent of a topic.
///
/// `taken == sent + dropped + oversize + waiting`: each message taken from the hub was sent, was given up, or waits.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Sent {
    /// Messages taken from the hub.
    pub taken: u64,
    /// Messages that the hub no longer had when they should have been taken.
    pub lost: u64,
    /// Messages sent.
    pub sent: u64,
    /// Messages sent again, because somebody lacked them.
    pub resent: u64,
    /// Messages that newer ones pushed out before they could be sent.
    pub dropped: u64,
    /// Messages larger than the budget or the link allows.
    pub oversize: u64,
    /// Messages that wait to be sent.
    pub waiting: u64,
    /// Bytes sent, stamps included.
    pub bytes: u64,
}

/// What a link has received of a topic of a host, since the host's link was last started.
///
/// `arrived == delivered + duplicates + late + refused + held`, and `last - start == delivered + gaps + held + missing`: each message
/// from the first one on was delivered, is counted as a gap, or is awaited.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Received {
    /// Messages that came, one or several times.
    pub arrived: u64,
    /// Messages given to the hub.
    pub delivered: u64,
    /// Messages that had been there before.
    pub duplicates: u64,
    /// Messages that came when their place had passed.
    pub late: u64,
    /// Messages that the access list forbids, or that are not of the topic's type.
    pub refused: u64,
    /// Messages that will not be delivered any more.
    pub gaps: u64,
    /// Messages that are here and wait for earlier ones.
    pub held: u64,
    /// Messages that are awaited.
    pub missing: u64,
    /// The number of the message before the first one that is for this reader.
    pub start: u64,
    /// The number of the newest message heard of.
    pub last: u64,
    /// Bytes that came.
    pub bytes: u64,
}

/// What a link has done.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Counters {
    /// For each topic that is sent.
    pub sent: Vec<(String, Sent)>,
    /// For each host and topic that is received.
    pub received: Vec<(String, String, Received)>,
    /// Packets sent, whatever they carried.
    pub packets: u64,
    /// Packets that the transport did not take.
    pub failed: u64,
    /// Packets that could not be understood.
    pub malformed: u64,
    /// Messages of links that had not introduced themselves, or of topics that they do not offer.
    pub strangers: u64,
    /// Packets of links that speak another version of the protocol.
    pub foreign: u64,
    /// How often a packet had to wait since the budget was spent.
    pub waits: u64,
}
