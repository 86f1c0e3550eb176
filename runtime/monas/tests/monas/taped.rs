//! A recording in memory, and its replay.
#![allow(dead_code)] // not every test needs all of it

use std::sync::{Arc, Mutex};

use monas::replay::{
    ComparisonCounts, RecordedMessage, RecordedPublisher, RecordedStream, Replay, ReplayDifference,
};
use monas::{Error, Talws, Timestamp};
use narukom::{Observer, Publication};

/// A message as a recorder keeps it.
#[derive(Clone)]
pub(crate) struct Kept {
    pub(crate) host: String,
    pub(crate) publisher: String,
    pub(crate) part: u16,
    pub(crate) topic: String,
    pub(crate) sequence: u32,
    pub(crate) published: Timestamp,
    pub(crate) received: Timestamp,
    pub(crate) bytes: Vec<u8>,
}

#[derive(Clone, Default)]
pub(crate) struct Tape(Arc<Mutex<Vec<Kept>>>);

impl Tape {
    pub(crate) fn kept(&self) -> Vec<Kept> {
        self.0.lock().unwrap().clone()
    }
}

impl Observer for Tape {
    fn observe(&mut self, publication: Publication<'_>) {
        let header = publication.sample.header;
        self.0.lock().unwrap().push(Kept {
            host: publication.host.into(),
            publisher: publication.publisher.into(),
            part: header.part,
            topic: publication.topic.path().into(),
            sequence: header.sequence as u32,
            published: header.local,
            received: header.received,
            bytes: publication.bytes().to_vec(),
        });
    }
}

/// Outcome of a replay.
pub(crate) struct Outcome {
    pub(crate) tallies: Vec<ComparisonCounts>,
    pub(crate) differences: Vec<ReplayDifference>,
}

impl Outcome {
    pub(crate) fn compared(&self, agent: &str, topic: &str) -> u64 {
        let tallies = self.tallies.iter().filter(|tally| tally.agent == agent && tally.topic == topic);
        tallies.map(|tally| tally.compared).sum()
    }
}

fn publishers(messages: &[Kept]) -> Vec<RecordedPublisher> {
    let mut names: Vec<(&str, &str)> =
        messages.iter().map(|kept| (kept.host.as_str(), kept.publisher.as_str())).collect();
    names.sort_unstable();
    names.dedup();
    let parts = messages.iter();
    let recorded = |(host, publisher): (&str, &str)| RecordedPublisher {
        host: host.into(),
        publisher: publisher.into(),
        is_agent: !["monas", "outside"].contains(&publisher),
        last_part: parts
            .clone()
            .filter(|kept| kept.publisher == publisher)
            .map(|kept| kept.part)
            .max()
            .unwrap_or(0),
    };
    names.into_iter().map(recorded).collect()
}

/// Replays agents on a recording of real time.
pub(crate) fn replay(talws: Talws, messages: &[Kept]) -> Result<Outcome, Error> {
    play(talws.replay_real_time(&publishers(messages))?, messages)
}

/// Replays agents on a recording of simulated time.
pub(crate) fn replay_simulated(talws: Talws, seed: u64, messages: &[Kept]) -> Result<Outcome, Error> {
    play(talws.replay(seed, &publishers(messages))?, messages)
}

fn play(mut replay: Replay, messages: &[Kept]) -> Result<Outcome, Error> {
    let mut differences = Vec::new();
    let mut on_difference = |difference| differences.push(difference);
    let mut inputs = std::collections::BTreeMap::new();
    for kept in messages {
        let Kept { host, publisher, part, topic, sequence, published, received, bytes } = kept;
        let part = *part;
        let input = match inputs.get(&(host, publisher, part, topic)) {
            Some(input) => *input,
            None => {
                let input =
                    replay.input(RecordedStream { host, received_by: None, publisher, part, topic })?;
                inputs.insert((host, publisher, part, topic), input);
                input
            }
        };
        let (sequence, published, received) = (*sequence, *published, *received);
        replay.feed(input, RecordedMessage { sequence, published, received, bytes }, &mut on_difference)?;
    }
    let tallies = replay.finish(true, &mut on_difference)?;
    Ok(Outcome { tallies, differences })
}
