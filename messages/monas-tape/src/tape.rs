//! Recording.

use std::collections::BTreeMap;
use std::fmt;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use monas_files::ExistingFile;
use narukom::{HostId, Observer, Publication};

use crate::crash_flush::CrashFlush;
use crate::error::Error;
use crate::queue::{OverflowPolicy, QueueEntry, QueuedMessage, SizeHint, WriteQueue};
use crate::recording::{Channel, MetadataEntry};
use crate::tape_file::{SingleOutput, TapeFile, TapeStorage};
use crate::writer::{self, WriterReport, WriterThread};

/// Records all messages that are published on one or more hubs, and those that the hubs receive
/// from other hosts, into one MCAP file.
///
/// Cloning it gives another handle to the same file. Each hub gets a handle as its observer; at the
/// end [`finish`](Tape::finish) returns whether everything was written. Dropping the last handle
/// finishes the tape too.
///
/// A publisher enqueues its message and continues; a thread of the tape encodes and writes it. If
/// that thread falls behind, by 65,536 messages or about 64 MiB, a tape created with
/// [`create`](Tape::create) blocks publishers, and one created with
/// [`create_real_time`](Tape::create_real_time) drops messages and [counts](Tape::dropped) them.
///
/// If the file cannot be written any more, the run goes on: [`failure`](Tape::failure) returns the
/// reason, messages are [counted](Tape::missing), and the recording continues in a new file when
/// that can be written.
pub struct Tape {
    shared: Arc<TapeShared>,
    channels: ChannelCache,
}

/// The state shared by the handles.
struct TapeShared {
    queue: Arc<WriteQueue>,
    report: Arc<WriterReport>,
    crash: CrashFlush,
    when_full: OverflowPolicy,
    /// `None` once it was joined.
    thread: Mutex<Option<WriterThread>>,
}

/// The channels that this handle has used, hub by hub.
#[derive(Default)]
struct ChannelCache {
    hubs: Vec<(String, ChannelTable)>,
    /// The hub of the last message.
    last: usize,
}

/// By host, then by topic, then by publisher, then by part.
type ChannelTable = Vec<Vec<Vec<Vec<Option<(u32, SizeHint)>>>>>;

impl Tape {
    /// Creates a tape in a file at `path`, or in one with a number in its name if that exists: see
    /// [`files`](Tape::files). For simulated time: no message is dropped, and the same run gives
    /// the same bytes.
    pub fn create(path: impl AsRef<Path>) -> Result<Tape, Error> {
        Tape::to_file(TapeFile::create(path, ExistingFile::Keep)?)
    }

    /// Like [`create`](Tape::create), for real time: publishers never wait for the disk, and
    /// messages are passed to the operating system within two seconds, whether others follow or
    /// not.
    pub fn create_real_time(path: impl AsRef<Path>) -> Result<Tape, Error> {
        Tape::to_file_real_time(TapeFile::create(path, ExistingFile::Keep)?)
    }

    /// Creates a tape in a file, otherwise like [`create`](Tape::create).
    pub fn to_file(file: TapeFile) -> Result<Tape, Error> {
        Tape::new(Box::new(file), OverflowPolicy::Wait)
    }

    /// Creates a tape in a file, otherwise like [`create_real_time`](Tape::create_real_time).
    pub fn to_file_real_time(file: TapeFile) -> Result<Tape, Error> {
        Tape::new(Box::new(file), OverflowPolicy::Drop)
    }

    /// Creates a tape that is written to `output`, otherwise like [`create`](Tape::create).
    pub fn to_writer(output: impl Write + Send + 'static) -> Result<Tape, Error> {
        Tape::new(Box::new(SingleOutput(Some(Box::new(output)))), OverflowPolicy::Wait)
    }

    /// Creates a tape that is written to `output`, otherwise like
    /// [`create_real_time`](Tape::create_real_time).
    pub fn to_writer_real_time(output: impl Write + Send + 'static) -> Result<Tape, Error> {
        Tape::new(Box::new(SingleOutput(Some(Box::new(output)))), OverflowPolicy::Drop)
    }

    fn new(storage: Box<dyn TapeStorage>, when_full: OverflowPolicy) -> Result<Tape, Error> {
        let queue = Arc::new(WriteQueue::new(when_full));
        let report = Arc::<WriterReport>::default();
        let crash = CrashFlush::default();
        let thread = writer::start(queue.clone(), storage, report.clone(), crash.clone(), when_full)?;
        let shared = TapeShared { queue, report, crash, when_full, thread: Mutex::new(Some(thread)) };
        Ok(Tape { shared: Arc::new(shared), channels: ChannelCache::default() })
    }

    /// Writes a named metadata entry about the run: version, seed, hash of the configuration.
    pub fn describe(&self, name: &str, entries: &BTreeMap<String, String>) -> Result<(), Error> {
        self.add(QueueEntry::Facts(MetadataEntry { name: name.to_owned(), entries: entries.clone() }))
    }

    /// Attaches a file: a configuration, a model.
    pub fn attach(&self, name: &str, media_type: &str, content: &[u8]) -> Result<(), Error> {
        self.add(QueueEntry::Attachment(name.to_owned(), media_type.to_owned(), content.to_vec()))
    }

    /// Waits until everything published so far is passed to the operating system, where it survives
    /// this process.
    ///
    /// # Errors
    /// The tape is finished, or its file cannot be written at present.
    pub fn flush(&self) -> Result<(), Error> {
        if !self.shared.queue.flush() {
            return Err(Error::finished());
        }
        self.failure().map_or(Ok(()), |failure| Err(Error::interrupted(&failure, self.missing())))
    }

    /// Why messages are not recorded at present; `None` if they are.
    pub fn failure(&self) -> Option<String> {
        self.shared.report.failure()
    }

    /// The most messages that are missing because the tape could not be written.
    pub fn missing(&self) -> u64 {
        self.shared.report.missing()
    }

    /// The files of the tape: one, and another one after each time that it could not be written;
    /// none if it is not written to files.
    pub fn files(&self) -> Vec<PathBuf> {
        self.shared.report.files()
    }

    /// Passes what was published to the operating system although the process is about to end.
    pub fn crash_flush(&self) -> CrashFlush {
        self.shared.crash.clone()
    }

    /// The number of messages dropped because the disk was too slow.
    pub fn dropped(&self) -> u64 {
        self.shared.queue.dropped()
    }

    /// Ends the recording and returns its number of messages. Fails if anything could not be
    /// written, now or before, or if the tape is finished already; later publications are not
    /// recorded.
    pub fn finish(&self) -> Result<u64, Error> {
        self.shared.finish().ok_or_else(Error::finished)?
    }

    /// Enqueues an entry; write errors are reported by `finish`.
    fn add(&self, entry: QueueEntry) -> Result<(), Error> {
        if self.shared.queue.add(entry) { Ok(()) } else { Err(Error::finished()) }
    }

    fn record(&mut self, publication: &Publication<'_>) {
        let Tape { shared, channels } = self;
        let known = channels.entry(publication);
        if known.is_none() {
            let received_by = (publication.sample.header.host != HostId::LOCAL).then_some(publication.hub);
            let size = SizeHint::default();
            let number = shared.queue.open(Channel::of(publication, received_by), size.clone());
            *known = number.map(|number| (number, size));
        }
        let Some((number, size)) = known else { return };
        let header = &publication.sample.header;
        let waiting = QueuedMessage {
            channel: *number,
            // MCAP has 32 bits for it, which is enough for 49 days at 1000 Hz; the lower half is
            // kept.
            sequence: header.sequence as u32,
            published: header.local,
            received: header.received,
            message: publication.sample.message.clone(),
        };
        shared.queue.push(waiting, size);
    }
}

impl TapeShared {
    /// Ends the recording; `None` if it has ended before.
    fn finish(&self) -> Option<Result<u64, Error>> {
        let dropped = self.queue.dropped();
        if self.when_full == OverflowPolicy::Drop {
            let entries = BTreeMap::from([("dropped".to_owned(), dropped.to_string())]);
            self.queue.add(QueueEntry::Facts(MetadataEntry { name: "recording".to_owned(), entries }));
        }
        if !self.queue.close() {
            return None;
        }
        let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take()?;
        Some(thread.join())
    }
}

impl Drop for TapeShared {
    fn drop(&mut self) {
        // To learn of errors, call `finish`.
        let _ = self.finish();
    }
}

/// Another handle to the same file, to observe another hub.
impl Clone for Tape {
    fn clone(&self) -> Tape {
        Tape { shared: self.shared.clone(), channels: ChannelCache::default() }
    }
}

/// Enqueues each message for the writer. [`Tape::finish`] reports errors.
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

impl ChannelCache {
    /// The cache entry for the channel of a publication.
    fn entry(&mut self, publication: &Publication<'_>) -> &mut Option<(u32, SizeHint)> {
        let is_last = self.hubs.get(self.last).is_some_and(|(name, _)| name == publication.hub);
        if !is_last {
            let known = self.hubs.iter().position(|(name, _)| name == publication.hub);
            self.last = known.unwrap_or_else(|| {
                self.hubs.push((publication.hub.to_owned(), ChannelTable::new()));
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
