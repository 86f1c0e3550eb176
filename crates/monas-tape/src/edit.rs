//! Tapes made of tapes: mended, cut, merged.

use std::collections::BTreeMap;
use std::path::Path;

use narukom::Moment;

use crate::copy::Copy;
use crate::error::Error;
use crate::playback::{Channel, Content, Contents, Facts, Message, Recording};

/// What became of a tape that was cut off or damaged.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct Recovery {
    /// Whether it had been finished.
    pub was_finished: bool,
    /// What was damaged and is gone.
    pub damages: Vec<String>,
    /// How many messages could be read.
    pub messages: u64,
}

impl Recovery {
    /// Whether there was nothing to mend.
    pub fn was_whole(&self) -> bool {
        self.was_finished && self.damages.is_empty()
    }
}

/// Writes everything that can be read of a tape that was cut off or damaged to a whole tape at `to`, which may be `path` itself. One
/// that is whole already is left alone if it is to be written over itself.
///
/// # Errors
/// The file cannot be read, is no MCAP file, or `to` cannot be written; then it stays as it was.
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
    Copy::write(to, |copy| {
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

/// What is to be kept of a tape.
#[derive(Default)]
pub struct Cut<'a> {
    /// From this moment on, which belongs to it.
    pub from: Option<Moment>,
    /// Up to this moment, which does not.
    pub to: Option<Moment>,
    /// On these channels; on all if it is not said.
    pub channels: Option<&'a dyn Fn(&Channel) -> bool>,
    /// What stays of these channels, however early it was: what gives later messages their meaning.
    pub always: Option<&'a dyn Fn(&Channel) -> bool>,
    /// These facts; all if it is not said.
    pub facts: Option<&'a dyn Fn(&Facts) -> bool>,
}

impl Cut<'_> {
    fn wants(&self, channel: &Channel) -> bool {
        self.channels.is_none_or(|wanted| wanted(channel))
    }

    fn is_early(&self, message: &Message<'_>) -> bool {
        self.from.is_some_and(|from| message.received < from)
    }

    fn is_late(&self, message: &Message<'_>) -> bool {
        self.to.is_some_and(|to| message.received >= to)
    }
}

/// Writes a part of a tape to a tape at `to`. Its files are kept. A `state` that was published last before the part
/// begins is its beginning, since it holds then. Answers how many messages it has.
///
/// # Errors
/// The tape is no MCAP file or damaged, or `to` cannot be written.
pub fn cut(recording: &Recording, cut: &Cut<'_>, to: impl AsRef<Path>) -> Result<u64, Error> {
    let standing = standing(recording, cut)?;
    Copy::write(to.as_ref(), |copy| {
        let mut number = 0;
        for content in recording.contents()? {
            let content = content?;
            let is_wanted = match &content {
                Content::Message(message) => {
                    number += 1;
                    let stands = || standing.binary_search(&number).is_ok();
                    let is_within = !cut.is_late(message) && (!cut.is_early(message) || stands());
                    is_within && cut.wants(&message.channel)
                }
                Content::Facts(facts) => cut.facts.is_none_or(|wanted| wanted(facts)),
                Content::Attachment(_) => true,
            };
            if is_wanted {
                copy.add(&content)?;
            }
        }
        Ok(copy.messages())
    })
}

/// The numbers, counted from 1, of the early messages that are kept.
fn standing(recording: &Recording, cut: &Cut<'_>) -> Result<Vec<u64>, Error> {
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

/// Writes several tapes into one at `to`, in the order of the moments at which messages came; of equal ones that of the tape
/// that is named first. Facts and files that are the same in several are there once. Answers how many messages it has.
///
/// # Errors
/// A tape is no MCAP file or damaged, or `to` cannot be written.
pub fn merge(recordings: &[Recording], to: impl AsRef<Path>) -> Result<u64, Error> {
    Copy::write(to.as_ref(), |copy| {
        others(recordings, copy)?;
        let mut sources =
            recordings.iter().map(|one| Source::new(one.contents()?)).collect::<Result<Vec<_>, Error>>()?;
        while let Some(source) = next(&mut sources) {
            if let Some(message) = source.advance()? {
                copy.message(&message)?;
            }
        }
        Ok(copy.messages())
    })
}

/// Copies what are no messages.
fn others(recordings: &[Recording], copy: &mut Copy) -> Result<(), Error> {
    let mut seen: Vec<Content<'_>> = Vec::new();
    for recording in recordings {
        for content in recording.contents()? {
            let content = content?;
            if !matches!(content, Content::Message(_)) && !seen.contains(&content) {
                copy.add(&content)?;
                seen.push(content);
            }
        }
    }
    Ok(())
}

/// A tape of which the next message is known.
struct Source<'a> {
    contents: Contents<'a>,
    next: Option<Message<'a>>,
}

impl<'a> Source<'a> {
    fn new(contents: Contents<'a>) -> Result<Source<'a>, Error> {
        let mut source = Source { contents, next: None };
        source.advance()?;
        Ok(source)
    }

    /// The next message, after which another one is the next.
    fn advance(&mut self) -> Result<Option<Message<'a>>, Error> {
        let next = loop {
            match self.contents.next().transpose()? {
                Some(Content::Message(message)) => break Some(message),
                Some(_) => {}
                None => break None,
            }
        };
        Ok(std::mem::replace(&mut self.next, next))
    }
}

/// The source with the earliest message; the first of those.
fn next<'s, 'a>(sources: &'s mut [Source<'a>]) -> Option<&'s mut Source<'a>> {
    let earliest = sources.iter().filter_map(|source| Some(source.next.as_ref()?.received)).min()?;
    sources.iter_mut().find(|source| source.next.as_ref().is_some_and(|next| next.received == earliest))
}
