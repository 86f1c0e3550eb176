//! Recording.

use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use mcap::McapResult;
use narukom::{HostId, Observer, Publication};

use crate::error::Error;
use crate::playback::{Channel, Facts};
use crate::queue::{Entry, Queue, Size, Waiting, WhenFull};
use crate::recorder::Recorder;
use crate::writer::{self, Thread};

/// Records everything that is published on one or more hubs, and what comes to them from other hosts, into one MCAP file.
///
/// Cloning it gives another handle to the same file. Each hub gets a handle as its observer; the last act is
/// [`finish`](Tape::finish), which says whether everything was written. A tape of which the last handle is dropped is finished too.
///
/// A publisher leaves its message and goes on; a thread of the tape's own encodes and writes it. If that thread falls behind, by
/// 65,536 messages or about 64 MiB, a tape made with [`create`](Tape::create) lets publishers wait, and one made with
/// [`create_real_time`](Tape::create_real_time) leaves messages out and [counts](Tape::dropped) them.
pub struct Tape {
    shared: Arc<Shared>,
    channels: Channels,
}

/// What the handles share.
struct Shared {
    queue: Arc<Queue>,
    when_full: WhenFull,
    /// Gone when it was waited for.
    thread: Mutex<Option<Thread>>,
}

/// The channels that this handle has met, hub by hub.
#[derive(Default)]
struct Channels {
    hubs: Vec<(String, Table)>,
    /// The hub of the last message.
    last: usize,
}

/// By host, then by topic, then by publisher, then by part.
type Table = Vec<Vec<Vec<Vec<Option<(u32, Size)>>>>>;

impl Tape {
    /// A tape that is written to a new file at `path`; a file that is there is replaced. It is for simulated time: nothing is left out,
    /// and the same run gives the same bytes.
    pub fn create(path: impl AsRef<Path>) -> Result<Tape, Error> {
        Tape::new(Box::new(file(path.as_ref())?), WhenFull::Wait)
    }

    /// As [`create`](Tape::create), for real time: no publisher ever waits for the disk, and what was published is on its way there
    /// within two seconds, whether anything follows or not.
    pub fn create_real_time(path: impl AsRef<Path>) -> Result<Tape, Error> {
        Tape::new(Box::new(file(path.as_ref())?), WhenFull::Drop)
    }

    /// A tape that is written to `output`, otherwise as [`create`](Tape::create).
    pub fn to_writer(output: impl Write + Send + 'static) -> Result<Tape, Error> {
        Tape::new(Box::new(output), WhenFull::Wait)
    }

    /// A tape that is written to `output`, otherwise as [`create_real_time`](Tape::create_real_time).
    pub fn to_writer_real_time(output: impl Write + Send + 'static) -> Result<Tape, Error> {
        Tape::new(Box::new(output), WhenFull::Drop)
    }

    fn new(output: Box<dyn Write + Send>, when_full: WhenFull) -> Result<Tape, Error> {
        let recorder = Recorder::new(output).map_err(Error::writing)?;
        let queue = Arc::new(Queue::new(when_full));
        let thread = writer::start(queue.clone(), recorder, when_full).map_err(Error::no_thread)?;
        let shared = Shared { queue, when_full, thread: Mutex::new(Some(thread)) };
        Ok(Tape { shared: Arc::new(shared), channels: Channels::default() })
    }

    /// Writes facts about the run under a name: version, seed, hash of the configuration.
    pub fn describe(&self, name: &str, entries: &BTreeMap<String, String>) -> Result<(), Error> {
        self.add(Entry::Facts(Facts { name: name.to_owned(), entries: entries.clone() }))
    }

    /// Puts a file into the tape: a configuration, a model.
    pub fn attach(&self, name: &str, media_type: &str, content: &[u8]) -> Result<(), Error> {
        self.add(Entry::Attachment(name.to_owned(), media_type.to_owned(), content.to_vec()))
    }

    /// Waits until everything that was published so far is on its way to the disk, where it survives this process.
    pub fn flush(&self) -> Result<(), Error> {
        if self.shared.queue.flush() { Ok(()) } else { Err(Error::finished()) }
    }

    /// How many messages were left out because the disk was too slow.
    pub fn dropped(&self) -> u64 {
        self.shared.queue.dropped()
    }

    /// Ends the recording and answers how many messages it has. It is an error if something could not be written, now or
    /// before, or if the tape is finished already; what is published later is not recorded.
    pub fn finish(&self) -> Result<u64, Error> {
        let written = self.shared.finish().ok_or_else(Error::finished)?;
        written.map_err(Error::writing)
    }

    /// Leaves what is written when it is its turn; whether that went well the end tells.
    fn add(&self, entry: Entry) -> Result<(), Error> {
        if self.shared.queue.add(entry) { Ok(()) } else { Err(Error::finished()) }
    }

    fn record(&mut self, publication: &Publication<'_>) {
        let Tape { shared, channels } = self;
        let known = channels.place(publication);
        if known.is_none() {
            let received_by = (publication.sample.header.host != HostId::LOCAL).then_some(publication.hub);
            let size = Size::default();
            let number = shared.queue.open(Channel::of(publication, received_by), size.clone());
            *known = number.map(|number| (number, size));
        }
        let Some((number, size)) = known else { return };
        let header = &publication.sample.header;
        let waiting = Waiting {
            channel: *number,
            // MCAP has 32 bits for it, which is enough for 49 days at 1000 Hz; the lower half is what is kept.
            sequence: header.sequence as u32,
            published: header.local,
            received: header.received,
            message: publication.sample.message.clone(),
        };
        shared.queue.push(waiting, size);
    }
}

fn file(path: &Path) -> Result<BufWriter<File>, Error> {
    File::create(path).map(BufWriter::new).map_err(|error| Error::file(path, error))
}

impl Shared {
    /// Ends the recording; none if it has ended before.
    fn finish(&self) -> Option<McapResult<u64>> {
        let dropped = self.queue.dropped();
        if self.when_full == WhenFull::Drop {
            let entries = BTreeMap::from([("dropped".to_owned(), dropped.to_string())]);
            self.queue.add(Entry::Facts(Facts { name: "recording".to_owned(), entries }));
        }
        if !self.queue.close() {
            return None;
        }
        let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take()?;
        Some(thread.join())
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        // Whoever wants to know whether all went well finishes the tape.
        let _ = self.finish();
    }
}

/// Another handle to the same file, to observe another hub.
impl Clone for Tape {
    fn clone(&self) -> Tape {
        Tape { shared: self.shared.clone(), channels: Channels::default() }
    }
}

/// Leaves each message for the writer. An error ends the recording; [`Tape::finish`] tells of it.
impl Observer for Tape {
    fn observe(&mut self, publication: Publication<'_>) {
        self.record(&publication);
    }

    fn observe_received(&mut self, publication: Publication<'_>) {
        self.record(&publication);
    }
}

impl fmt::Debug for Tape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Tape").field("when_full", &self.shared.when_full).finish_non_exhaustive()
    }
}

impl Channels {
    /// Where the channel of a publication is kept.
    fn place(&mut self, publication: &Publication<'_>) -> &mut Option<(u32, Size)> {
        let is_last = self.hubs.get(self.last).is_some_and(|(name, _)| name == publication.hub);
        if !is_last {
            let known = self.hubs.iter().position(|(name, _)| name == publication.hub);
            self.last = known.unwrap_or_else(|| {
                self.hubs.push((publication.hub.to_owned(), Table::new()));
                self.hubs.len() - 1
            });
        }
        let header = &publication.sample.header;
        let by_topic = entry(&mut self.hubs[self.last].1, header.host.index());
        let by_publisher = entry(by_topic, header.topic.number() as usize);
        entry(entry(by_publisher, header.publisher.index()), header.part.into())
    }
}

/// The element at `index` of a list that grows as needed.
fn entry<T: Default>(list: &mut Vec<T>, index: usize) -> &mut T {
    if list.len() <= index {
        list.resize_with(index + 1, T::default);
    }
    &mut list[index]
}
