//! Copies items of tapes to a new tape.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mcap::McapError;
use monas_files::AtomicFile;

use crate::error::Error;
use crate::recorder::Recorder;
use crate::recording::{Attachment, Channel, MetadataEntry, RecordedSample, RecordingItem};

/// A tape copied from others.
pub(crate) struct TapeCopy {
    recorder: Recorder<AtomicFile>,
    /// The file, for errors.
    path: PathBuf,
    /// The numbers of the channels, by the address of the shared channel; the reference is kept, so
    /// that the address remains unique.
    numbers: BTreeMap<*const Channel, (u16, Arc<Channel>)>,
}

impl TapeCopy {
    /// Writes a new file at `path`, or none on failure: an existing file stays until the new one is
    /// complete.
    pub(crate) fn write<T>(
        path: &Path,
        fill: impl FnOnce(&mut TapeCopy) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let unwritable = |error| Error::unwritable(path, error);
        let file = AtomicFile::create(path).map_err(unwritable)?;
        let recorder = Recorder::new(file).map_err(|error| unwritten(path, error))?;
        let mut copy = TapeCopy { recorder, path: path.to_owned(), numbers: BTreeMap::new() };
        let value = fill(&mut copy)?;
        let (_, file) = copy.recorder.finish().map_err(|error| unwritten(path, error))?;
        file.commit().map_err(unwritable)?;
        Ok(value)
    }

    pub(crate) fn add(&mut self, content: &RecordingItem<'_>) -> Result<(), Error> {
        match content {
            RecordingItem::Message(message) => self.message(message),
            RecordingItem::Facts(facts) => self.facts(facts),
            RecordingItem::Attachment(file) => self.attachment(file),
        }
    }

    pub(crate) fn message(&mut self, message: &RecordedSample<'_>) -> Result<(), Error> {
        let number = self.channel(&message.channel)?;
        self.recorder.write(number, message).map_err(|error| unwritten(&self.path, error))
    }

    /// The number of a channel in the new tape; equal channels have the same.
    pub(crate) fn channel(&mut self, channel: &Arc<Channel>) -> Result<u16, Error> {
        let address = Arc::as_ptr(channel);
        if let Some((number, _)) = self.numbers.get(&address) {
            return Ok(*number);
        }
        let number = self.recorder.channel(channel).map_err(|error| unwritten(&self.path, error))?;
        self.numbers.insert(address, (number, channel.clone()));
        Ok(number)
    }

    pub(crate) fn facts(&mut self, facts: &MetadataEntry) -> Result<(), Error> {
        self.recorder.describe(facts).map_err(|error| unwritten(&self.path, error))
    }

    pub(crate) fn attachment(&mut self, file: &Attachment<'_>) -> Result<(), Error> {
        self.recorder.attach(file).map_err(|error| unwritten(&self.path, error))
    }

    /// The number of messages.
    pub(crate) fn messages(&self) -> u64 {
        self.recorder.messages()
    }
}

/// The error of the system or of the MCAP library, with the file.
fn unwritten(path: &Path, error: McapError) -> Error {
    match error {
        McapError::Io(error) => Error::unwritable(path, error),
        error => Error::writing(error).of_file(Some(path)),
    }
}
