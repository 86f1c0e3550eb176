//! Publishers of a recorded host, which a replay represents beside its agents.

/// A publisher of a recorded host.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct RecordedPublisher {
    /// The host.
    pub host: String,
    /// The publisher's name.
    pub publisher: String,
    /// Whether it was an agent: whether it published records of its cycles.
    pub is_agent: bool,
    /// The last of the parts that published under this name, see
    /// [`Header::part`](narukom::Header::part).
    pub last_part: u16,
}

/// The names of the publishers of a host.
pub(crate) fn names_on(publishers: &[RecordedPublisher], host: &str) -> impl Iterator<Item = String> {
    publishers.iter().filter(move |one| one.host == host).map(|one| one.publisher.clone())
}
