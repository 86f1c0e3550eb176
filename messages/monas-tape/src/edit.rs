//! Recovering, cutting and merging tapes.

use std::collections::BTreeMap;
use std::path::Path;

use narukom::Timestamp;

use crate::error::Error;
use crate::recording::{Channel, MetadataEntry, RecordedSample, Recording, RecordingItem, RecordingItems};
use crate::tape_copy::TapeCopy;

/// The result of recovering a truncated or damaged tape.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct Recovery {
    /// Whether the recording had been finished.
    pub was_finished: bool,
    /// The damaged parts, which are lost.
    pub damages: Vec<String>,
    /// The number of readable messages.
    pub messages: u64,
}

impl Recovery {
    /// Whether the tape was intact.
    pub fn was_whole(&self) -> bool {
        self.was_finished && self.damages.is_empty()
    }
}

/// Writes everything readable of a truncated or damaged tape to an intact tape at `to`, which may
/// be `path` itself. An intact tape is not rewritten in place.
///
/// # Errors
/// The file cannot be read, is not an MCAP file, or `to` cannot be written; then `to` is unchanged.
pub fn recover(path: impl AsRef<Path>, to: impl AsRef<Path>) -> Result<Recovery, Error> {
    let (path, to) = (path.as_ref(), to.as_ref());
    let recording = Recording::open(path)?;
    if path == to {
        let overview = recording.overview()?;
        if overview.is_finished && overview.damages.is_empty() {
            let messages = overview.messages();
            return Ok(Recovery { was_finished: true, damages: Vec::new(), messages });
        }
    }
    TapeCopy::write(to, |copy| {
        let mut damages = Vec::new();
        for content in recording.contents()? {
            match content {
                Ok(content) => copy.add(&content)?,
                Err(error) => damages.push(error.to_string()),
            }
        }
        Ok(Recovery { was_finished: recording.is_finished(), damages, messages: copy.messages() })
    })
}

/// Selects the part of a tape to keep.
#[derive(Default)]
pub struct TapeFilter<'a> {
    /// Start time, inclusive.
    pub from: Option<Timestamp>,
    /// End time, exclusive.
    pub to: Option<Timestamp>,
    /// These channels; all if `None`.
    pub channels: Option<&'a dyn Fn(&Channel) -> bool>,
    /// Channels of which earlier messages are kept too, since later messages depend on them.
    pub always: Option<&'a dyn Fn(&Channel) -> bool>,
    /// These metadata entries; all if `None`.
    pub facts: Option<&'a dyn Fn(&MetadataEntry) -> bool>,
}

impl TapeFilter<'_> {
    fn wants(&self, channel: &Channel) -> bool {
        self.channels.is_none_or(|wanted| wanted(channel))
    }

    fn is_early(&self, message: &RecordedSample<'_>) -> bool {
        self.from.is_some_and(|from| message.received < from)
    }

    fn is_late(&self, message: &RecordedSample<'_>) -> bool {
        self.to.is_some_and(|to| message.received >= to)
    }
}

/// Writes a part of a tape to a tape at `to`. Attachments are kept. The last message of each
/// `state` topic before the start is included, since it is still valid. Returns the number of
/// messages.
///
/// # Errors
///
/// The tape is damaged or not an MCAP file, or `to` cannot be written.
pub fn cut(recording: &Recording, cut: &TapeFilter<'_>, to: impl AsRef<Path>) -> Result<u64, Error> {
    let standing = early_messages(recording, cut)?;
    TapeCopy::write(to.as_ref(), |copy| {
        let mut number = 0;
        for content in recording.contents()? {
            let content = content?;
            let is_wanted = match &content {
                RecordingItem::Message(message) => {
                    number += 1;
                    let stands = || standing.binary_search(&number).is_ok();
                    let is_within = !cut.is_late(message) && (!cut.is_early(message) || stands());
                    is_within && cut.wants(&message.channel)
                }
                RecordingItem::Facts(facts) => cut.facts.is_none_or(|wanted| wanted(facts)),
                RecordingItem::Attachment(_) => true,
            };
            if is_wanted {
                copy.add(&content)?;
            }
        }
        Ok(copy.messages())
    })
}

/// The numbers, from 1, of the early messages that are kept.
fn early_messages(recording: &Recording, cut: &TapeFilter<'_>) -> Result<Vec<u64>, Error> {
    let mut always = Vec::new();
    let mut latest: BTreeMap<(String, Option<String>, String), u64> = BTreeMap::new();
    for (number, message) in (1..).zip(recording.messages()?) {
        let message = message?;
        let channel = &message.channel;
        if !cut.is_early(&message) {
            continue;
        }
        if cut.always.is_some_and(|always| always(channel)) {
            always.push(number);
        } else if channel.kind == "state" {
            let key = (channel.host.clone(), channel.received_by.clone(), channel.topic.clone());
            latest.insert(key, number);
        }
    }
    always.extend(latest.into_values());
    always.sort_unstable();
    Ok(always)
}

/// Merges several tapes into one at `to`, in order of arrival; for equal times in the order of the
/// arguments. Messages, metadata and attachments that are equal in several tapes are written once,
/// so that parts of a tape that overlap become the tape again. Returns the number of messages.
///
/// # Errors
/// A tape is damaged or not an MCAP file, or `to` cannot be written.
pub fn merge(recordings: &[Recording], to: impl AsRef<Path>) -> Result<u64, Error> {
    TapeCopy::write(to.as_ref(), |copy| {
        others(recordings, copy)?;
        let mut sources = recordings
            .iter()
            .map(|one| MergeSource::new(one.contents()?))
            .collect::<Result<Vec<_>, Error>>()?;
        let mut written = MergedMessages::default();
        while let Some(number) = next(&sources) {
            if let Some(message) = sources[number].advance()?
                && written.admits(number, copy.channel(&message.channel)?, &message)
            {
                copy.message(&message)?;
            }
        }
        Ok(copy.messages())
    })
}

/// Copies everything but messages.
fn others(recordings: &[Recording], copy: &mut TapeCopy) -> Result<(), Error> {
    let mut seen: Vec<RecordingItem<'_>> = Vec::new();
    for recording in recordings {
        for content in recording.contents()? {
            let content = content?;
            if !matches!(content, RecordingItem::Message(_)) && !seen.contains(&content) {
                copy.add(&content)?;
                seen.push(content);
            }
        }
    }
    Ok(())
}

/// A tape with its next message.
struct MergeSource<'a> {
    contents: RecordingItems<'a>,
    next: Option<RecordedSample<'a>>,
}

impl<'a> MergeSource<'a> {
    fn new(contents: RecordingItems<'a>) -> Result<MergeSource<'a>, Error> {
        let mut source = MergeSource { contents, next: None };
        source.advance()?;
        Ok(source)
    }

    /// Returns the next message, and reads the one after it.
    fn advance(&mut self) -> Result<Option<RecordedSample<'a>>, Error> {
        let next = loop {
            match self.contents.next().transpose()? {
                Some(RecordingItem::Message(message)) => break Some(message),
                Some(_) => {}
                None => break None,
            }
        };
        Ok(std::mem::replace(&mut self.next, next))
    }
}

/// The number of the source with the earliest message; the first of several.
fn next(sources: &[MergeSource<'_>]) -> Option<usize> {
    let waiting = sources.iter().enumerate();
    let waiting = waiting.filter_map(|(number, source)| Some((source.next.as_ref()?.received, number)));
    waiting.min().map(|(_, number)| number)
}

/// The messages written, with the first source that has each. Their bytes are those of the sources.
#[derive(Default)]
struct MergedMessages<'a>(BTreeMap<(u16, u32, Timestamp, Timestamp, &'a [u8]), usize>);

impl<'a> MergedMessages<'a> {
    /// Notes a message; `false` if another source has had it.
    fn admits(&mut self, source: usize, channel: u16, message: &RecordedSample<'a>) -> bool {
        let RecordedSample { sequence, published, received, bytes, .. } = *message;
        *self.0.entry((channel, sequence, received, published, bytes)).or_insert(source) == source
    }
}
