//! Recording.

use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mcap::{McapError, McapResult};
use narukom::{Observer, Publication};

use crate::error::Error;
use crate::recorder::Recorder;

/// Records everything that is published on one or more hubs into one MCAP file.
///
/// Cloning it gives another handle to the same file. Each hub gets a handle as its observer; the last act is
/// [`finish`](Tape::finish), which says whether everything was written.
pub struct Tape {
    progress: Arc<Mutex<Progress>>,
    channels: Channels,
}

/// The file, until it is finished or cannot be written.
enum Progress {
    Running(Box<Recorder>),
    Failed(McapError),
    Finished,
}

/// The channels of the hub that one handle observes: by topic, then by publisher.
#[derive(Default)]
struct Channels {
    host: String,
    channels: Vec<Vec<Option<u16>>>,
}

impl Tape {
    /// A tape that is written to a new file at `path`; a file that is there is replaced.
    pub fn create(path: impl AsRef<Path>) -> Result<Tape, Error> {
        let file = File::create(path.as_ref()).map_err(|error| Error::file(path.as_ref(), error))?;
        Tape::to_writer(BufWriter::new(file))
    }

    /// A tape that is written to `output`.
    pub fn to_writer(output: impl Write + Send + 'static) -> Result<Tape, Error> {
        let recorder = Recorder::new(Box::new(output)).map_err(Error::writing)?;
        let progress = Arc::new(Mutex::new(Progress::Running(Box::new(recorder))));
        Ok(Tape { progress, channels: Channels::default() })
    }

    /// Writes facts about the run under a name: version, seed, hash of the configuration.
    pub fn describe(&self, name: &str, entries: &BTreeMap<String, String>) -> Result<(), Error> {
        self.change(|recorder| recorder.describe(name, entries))
    }

    /// Puts a file into the tape: a configuration, a model.
    pub fn attach(&self, name: &str, media_type: &str, content: &[u8]) -> Result<(), Error> {
        self.change(|recorder| recorder.attach(name, media_type, content))
    }

    /// Ends the recording and answers how many messages it has. It is an error if something could not be written, now or
    /// before, or if the tape is finished already; what is published later is not recorded.
    pub fn finish(&self) -> Result<u64, Error> {
        match std::mem::replace(&mut *self.progress(), Progress::Finished) {
            Progress::Running(recorder) => recorder.finish().map_err(Error::writing),
            Progress::Failed(error) => Err(Error::writing(error)),
            Progress::Finished => Err(Error::finished()),
        }
    }

    fn progress(&self) -> MutexGuard<'_, Progress> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does what can be answered at once; the recording goes on after an error.
    fn change(&self, act: impl FnOnce(&mut Recorder) -> McapResult<()>) -> Result<(), Error> {
        match &mut *self.progress() {
            Progress::Running(recorder) => act(recorder).map_err(Error::writing),
            Progress::Failed(_) | Progress::Finished => Err(Error::finished()),
        }
    }
}

/// Another handle to the same file, to observe another hub.
impl Clone for Tape {
    fn clone(&self) -> Tape {
        Tape { progress: self.progress.clone(), channels: Channels::default() }
    }
}

/// Records each message on the publisher's thread. An error ends the recording; [`Tape::finish`] tells of it.
impl Observer for Tape {
    fn observe(&mut self, publication: Publication<'_>) {
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        let Progress::Running(recorder) = &mut *progress else { return };
        let channel = self.channels.of(publication, recorder);
        if let Err(error) = channel.and_then(|channel| recorder.write(channel, publication)) {
            *progress = Progress::Failed(error);
        }
    }
}

impl fmt::Debug for Tape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match &*self.progress() {
            Progress::Running(_) => "Tape(running)",
            Progress::Failed(_) => "Tape(failed)",
            Progress::Finished => "Tape(finished)",
        })
    }
}

impl Channels {
    /// The channel of a publication, opened if need be.
    fn of(&mut self, publication: Publication<'_>, recorder: &mut Recorder) -> McapResult<u16> {
        if self.host != publication.host {
            *self = Channels { host: publication.host.to_owned(), channels: Vec::new() };
        }
        let header = &publication.sample.header;
        let by_publisher = entry(&mut self.channels, header.topic.number() as usize);
        let channel = entry(by_publisher, header.publisher.index());
        match *channel {
            Some(channel) => Ok(channel),
            None => Ok(*channel.insert(recorder.channel(publication)?)),
        }
    }
}

/// The element at `index` of a list that grows as needed.
fn entry<T: Default>(list: &mut Vec<T>, index: usize) -> &mut T {
    if list.len() <= index {
        list.resize_with(index + 1, T::default);
    }
    &mut list[index]
}
