//! Statistics of a tape.

use std::collections::BTreeMap;
use std::sync::Arc;

use narukom::Timestamp;

use crate::error::Error;
use crate::recording::{Channel, MetadataEntry, RecordedSample, Recording, RecordingItem};

/// Statistics of a tape.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct TapeOverview {
    /// The size of the file in bytes.
    pub bytes: usize,
    /// Whether the recording was finished, so that nothing is missing at its end.
    pub is_finished: bool,
    /// The damaged parts, in order.
    pub damages: Vec<String>,
    /// The times of the first and the last message, if there are any.
    pub span: Option<(Timestamp, Timestamp)>,
    /// All metadata entries.
    pub facts: Vec<MetadataEntry>,
    /// Name, media type and size in bytes of each attachment.
    pub attachments: Vec<(String, String, usize)>,
    /// Its channels with at least one message, by host, topic and publisher.
    pub channels: Vec<ChannelOverview>,
}

/// Statistics of a channel.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct ChannelOverview {
    /// The channel.
    pub channel: Arc<Channel>,
    /// The number of messages.
    pub messages: u64,
    /// The total size of their encodings in bytes.
    pub bytes: u64,
    /// The sequence number of the first.
    pub first_sequence: u32,
    /// The times of the first and the last message.
    pub span: (Timestamp, Timestamp),
}

impl Recording {
    /// Computes the statistics.
    ///
    /// # Errors
    /// The file is not an MCAP file. Damage is not an error: see [`TapeOverview::damages`].
    pub fn overview(&self) -> Result<TapeOverview, Error> {
        let mut overview = TapeOverview {
            bytes: self.size(),
            is_finished: self.is_finished(),
            damages: Vec::new(),
            span: None,
            facts: Vec::new(),
            attachments: Vec::new(),
            channels: Vec::new(),
        };
        let mut counts = ChannelCounts::default();
        for content in self.contents()? {
            match content {
                Ok(RecordingItem::Message(message)) => counts.add(&message),
                Ok(RecordingItem::Facts(facts)) => overview.facts.push(facts),
                Ok(RecordingItem::Attachment(file)) => {
                    overview.attachments.push((file.name.into(), file.media_type.into(), file.bytes.len()));
                }
                Err(error) => overview.damages.push(error.to_string()),
            }
        }
        overview.channels = counts.finish();
        let spans = overview.channels.iter().map(|channel| channel.span);
        overview.span = spans.reduce(|(a, b), (c, d)| (a.min(c), b.max(d)));
        Ok(overview)
    }
}

impl TapeOverview {
    /// The number of messages.
    pub fn messages(&self) -> u64 {
        self.channels.iter().map(|channel| channel.messages).sum()
    }

    /// The value of a key, of any metadata entry that has it.
    pub fn fact(&self, key: &str) -> Option<&str> {
        self.facts.iter().find_map(|facts| facts.entries.get(key)).map(String::as_str)
    }
}

impl ChannelOverview {
    /// The messages per second; `None` unless there are two at different times.
    pub fn frequency(&self) -> Option<f64> {
        let (first, last) = self.span;
        let seconds = last.since(first).as_secs_f64();
        (self.messages > 1 && seconds > 0.0).then(|| (self.messages - 1) as f64 / seconds)
    }
}

/// The channels found so far. Most messages are on a known channel, so entries are found by the
/// address of the shared channel.
#[derive(Default)]
struct ChannelCounts {
    indices: BTreeMap<*const Channel, usize>,
    channels: Vec<ChannelOverview>,
}

impl ChannelCounts {
    fn add(&mut self, message: &RecordedSample<'_>) {
        let address = Arc::as_ptr(&message.channel);
        let index = match self.indices.get(&address) {
            Some(&position) => position,
            None => self.channel_index(address, message),
        };
        let counted = &mut self.channels[index];
        counted.messages += 1;
        counted.bytes += message.bytes.len() as u64;
        let (first, last) = counted.span;
        counted.span = (first.min(message.received), last.max(message.received));
    }

    /// The index of a channel that is new, or equal to a known one with another number.
    fn channel_index(&mut self, address: *const Channel, message: &RecordedSample<'_>) -> usize {
        let known = self.channels.iter().position(|counted| counted.channel == message.channel);
        let index = known.unwrap_or_else(|| {
            self.channels.push(ChannelOverview {
                channel: message.channel.clone(),
                messages: 0,
                bytes: 0,
                first_sequence: message.sequence,
                span: (message.received, message.received),
            });
            self.channels.len() - 1
        });
        // An address identifies a channel only while the channel lives: only those of kept channels
        // are stored.
        if known.is_none() {
            self.indices.insert(address, index);
        }
        index
    }

    fn finish(mut self) -> Vec<ChannelOverview> {
        self.channels.sort_by(|a, b| {
            let key = |one: &ChannelOverview| {
                let Channel { host, topic, publisher, received_by, .. } = &*one.channel;
                (received_by.is_some(), host.clone(), topic.clone(), publisher.clone())
            };
            key(a).cmp(&key(b))
        });
        self.channels
    }
}
