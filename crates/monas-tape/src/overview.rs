//! What a tape holds, counted.

use std::collections::BTreeMap;
use std::sync::Arc;

use narukom::Moment;

use crate::error::Error;
use crate::playback::{Channel, Content, Facts, Message, Recording};

/// What a tape holds.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct Overview {
    /// How many bytes the file has.
    pub bytes: usize,
    /// Whether it was finished: whether nothing is missing at its end.
    pub is_finished: bool,
    /// What is damaged, in the order in which it was met.
    pub damages: Vec<String>,
    /// When the first and the last message came, if there are any.
    pub span: Option<(Moment, Moment)>,
    /// All facts.
    pub facts: Vec<Facts>,
    /// Name, media type and number of bytes of each file that was put into it.
    pub attachments: Vec<(String, String, usize)>,
    /// Its channels with at least one message, by host, topic and publisher.
    pub channels: Vec<ChannelOverview>,
}

/// What a channel of a tape holds.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct ChannelOverview {
    /// The channel.
    pub channel: Arc<Channel>,
    /// How many messages it has.
    pub messages: u64,
    /// How many bytes their encodings have together.
    pub bytes: u64,
    /// The sequence number of the first.
    pub first_sequence: u32,
    /// When the first and the last came.
    pub span: (Moment, Moment),
}

impl Recording {
    /// Counts everything.
    ///
    /// # Errors
    /// The file is no MCAP file. One that is damaged is no error: see [`Overview::damages`].
    pub fn overview(&self) -> Result<Overview, Error> {
        let mut overview = Overview {
            bytes: self.size(),
            is_finished: self.is_finished(),
            damages: Vec::new(),
            span: None,
            facts: Vec::new(),
            attachments: Vec::new(),
            channels: Vec::new(),
        };
        let mut counts = Counts::default();
        for content in self.contents()? {
            match content {
                Ok(Content::Message(message)) => counts.add(&message),
                Ok(Content::Facts(facts)) => overview.facts.push(facts),
                Ok(Content::Attachment(file)) => {
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

impl Overview {
    /// How many messages there are.
    pub fn messages(&self) -> u64 {
        self.channels.iter().map(|channel| channel.messages).sum()
    }

    /// A fact, of whatever has it.
    pub fn fact(&self, key: &str) -> Option<&str> {
        self.facts.iter().find_map(|facts| facts.entries.get(key)).map(String::as_str)
    }
}

impl ChannelOverview {
    /// How many messages came a second, if that can be said: if there are two at different moments.
    pub fn frequency(&self) -> Option<f64> {
        let (first, last) = self.span;
        let seconds = last.since(first).as_secs_f64();
        (self.messages > 1 && seconds > 0.0).then(|| (self.messages - 1) as f64 / seconds)
    }
}

/// The channels met so far. Most messages are on a channel that was met, so places are found by the address of what they share.
#[derive(Default)]
struct Counts {
    places: BTreeMap<*const Channel, usize>,
    channels: Vec<ChannelOverview>,
}

impl Counts {
    fn add(&mut self, message: &Message<'_>) {
        let address = Arc::as_ptr(&message.channel);
        let place = match self.places.get(&address) {
            Some(&place) => place,
            None => self.place(address, message),
        };
        let counted = &mut self.channels[place];
        counted.messages += 1;
        counted.bytes += message.bytes.len() as u64;
        let (first, last) = counted.span;
        counted.span = (first.min(message.received), last.max(message.received));
    }

    /// The place of a channel that is new, or equal to one that was met under another number.
    fn place(&mut self, address: *const Channel, message: &Message<'_>) -> usize {
        let known = self.channels.iter().position(|counted| counted.channel == message.channel);
        let place = known.unwrap_or_else(|| {
            self.channels.push(ChannelOverview {
                channel: message.channel.clone(),
                messages: 0,
                bytes: 0,
                first_sequence: message.sequence,
                span: (message.received, message.received),
            });
            self.channels.len() - 1
        });
        // An address means one channel as long as the channel lives: only that of one that is kept is noted.
        if known.is_none() {
            self.places.insert(address, place);
        }
        place
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
