//! What is read from tapes, written to a new one.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::error::Error;
use crate::playback::{Attachment, Channel, Content, Facts, Message};
use crate::recorder::Recorder;

/// A tape that is made of others.
pub(crate) struct Copy {
    recorder: Recorder,
    /// The numbers of the channels, by the address of what their messages share; it is kept, so that the address stays its own.
    numbers: BTreeMap<*const Channel, (u16, Arc<Channel>)>,
}

impl Copy {
    /// Writes a new file at `path`, or none if something goes wrong: a file that is there stays until the new one is whole.
    pub(crate) fn write<T>(
        path: &Path,
        fill: impl FnOnce(&mut Copy) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let draft = Draft::beside(path);
        let file = File::create(&draft.path).map_err(|error| Error::unwritable(path, error))?;
        let recorder = Recorder::new(Box::new(BufWriter::new(file))).map_err(Error::writing)?;
        let mut copy = Copy { recorder, numbers: BTreeMap::new() };
        let value = fill(&mut copy)?;
        copy.recorder.finish().map_err(Error::writing)?;
        fs::rename(&draft.path, path).map_err(|error| Error::unwritable(path, error))?;
        Ok(value)
    }

    pub(crate) fn add(&mut self, content: &Content<'_>) -> Result<(), Error> {
        match content {
            Content::Message(message) => self.message(message),
            Content::Facts(facts) => self.facts(facts),
            Content::Attachment(file) => self.attachment(file),
        }
    }

    pub(crate) fn message(&mut self, message: &Message<'_>) -> Result<(), Error> {
        let address = Arc::as_ptr(&message.channel);
        let number = match self.numbers.get(&address) {
            Some((number, _)) => *number,
            None => {
                let number = self.recorder.channel(&message.channel).map_err(Error::writing)?;
                self.numbers.insert(address, (number, message.channel.clone()));
                number
            }
        };
        self.recorder.write(number, message).map_err(Error::writing)
    }

    pub(crate) fn facts(&mut self, facts: &Facts) -> Result<(), Error> {
        self.recorder.describe(facts).map_err(Error::writing)
    }

    pub(crate) fn attachment(&mut self, file: &Attachment<'_>) -> Result<(), Error> {
        self.recorder.attach(file).map_err(Error::writing)
    }

    /// How many messages it has.
    pub(crate) fn messages(&self) -> u64 {
        self.recorder.messages()
    }
}

/// A file that goes away unless it is renamed.
struct Draft {
    path: PathBuf,
}

impl Draft {
    fn beside(path: &Path) -> Draft {
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(".part");
        Draft { path: path.with_file_name(name) }
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        // It is not there any more if all went well.
        let _ = fs::remove_file(&self.path);
    }
}
