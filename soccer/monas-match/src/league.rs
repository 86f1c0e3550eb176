//! A match as an endpoint of the league's network protocol: its robots, or its referee.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use monas::{BoxError, Timestamp};
use monas_gamecontroller::{Peer, Received};
use monas_sim::SharedField;

use crate::summary::MatchEvent;

/// The most packets that are read in one step; more would be a flood.
const MAX_PACKETS_PER_STEP: usize = 64;
/// The most different problems that are reported.
const MAX_PROBLEMS: usize = 16;

/// Counts of packets that a match has exchanged with a GameController, or as one.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct LeagueCounts {
    /// Packets of control data: received by the robots, or sent by the referee.
    pub control: u64,
    /// Reports of robots: sent by the robots, or received by the referee.
    pub reports: u64,
    /// Packets that could not be read, or that are for other teams.
    pub refused: u64,
}

/// One end of the protocol.
pub(crate) trait LeagueEnd: Send {
    /// Receives what has arrived, and sends what is due.
    fn exchange(
        &mut self,
        pitch: &SharedField,
        now: Timestamp,
        journal: &mut LeagueJournal,
    ) -> Result<(), BoxError>;
}

/// The packets and errors at one end of the protocol.
#[derive(Default)]
pub(crate) struct LeagueJournal {
    pub(crate) counts: LeagueCounts,
    /// Remarks that the world has not published yet.
    remarks: Vec<String>,
    /// Remarks that the match has not shown yet.
    events: Vec<MatchEvent>,
    /// Problems that were reported; each is reported once.
    problems: Vec<String>,
}

impl LeagueJournal {
    /// Adds a remark for people.
    pub(crate) fn note(&mut self, text: impl Into<String>) {
        self.remarks.push(text.into());
    }

    /// Adds a problem, if it is a new one and not one of too many.
    pub(crate) fn warn(&mut self, problem: String) {
        if self.problems.len() < MAX_PROBLEMS && !self.problems.contains(&problem) {
            self.note(problem.clone());
            self.problems.push(problem);
        }
    }

    /// The packets that have arrived and can be read, with their senders.
    pub(crate) fn read<T>(
        &mut self,
        mut receive: impl FnMut() -> std::io::Result<Option<Received<T>>>,
    ) -> Vec<(Peer, T)> {
        let mut packets = Vec::new();
        for _ in 0..MAX_PACKETS_PER_STEP {
            match receive() {
                Ok(None) => break,
                Ok(Some(Received { from, content: Ok(content) })) => packets.push((from, content)),
                Ok(Some(Received { from, content: Err(error) })) => {
                    self.counts.refused += 1;
                    self.warn(format!("a packet of {} is ignored: {error}", from));
                }
                Err(error) => {
                    self.warn(format!("the network of the GameController fails: {error}"));
                    break;
                }
            }
        }
        packets
    }
}

/// One end of the protocol, shared by the world, which drives it, and the match, which shows it.
#[derive(Clone)]
pub(crate) struct League(Arc<Mutex<(Box<dyn LeagueEnd>, LeagueJournal)>>);

impl League {
    pub(crate) fn new(end: Box<dyn LeagueEnd>) -> League {
        League(Arc::new(Mutex::new((end, LeagueJournal::default()))))
    }

    /// Receives and sends, and returns new remarks.
    pub(crate) fn exchange(&self, pitch: &SharedField, now: Timestamp) -> Result<Vec<String>, BoxError> {
        let mut inner = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (end, journal) = &mut *inner;
        end.exchange(pitch, now, journal)?;
        let remarks = std::mem::take(&mut journal.remarks);
        let time = Duration::from_nanos(now.as_nanos());
        journal.events.extend(remarks.iter().map(|text| MatchEvent { time, text: text.clone() }));
        Ok(remarks)
    }

    /// The remarks since the last call.
    pub(crate) fn take_events(&self) -> Vec<MatchEvent> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner).1.events)
    }

    /// The counts so far.
    pub(crate) fn counts(&self) -> LeagueCounts {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).1.counts
    }
}
