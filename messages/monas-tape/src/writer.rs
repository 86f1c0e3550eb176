//! The thread that writes a tape: it encodes messages, so that publishers need not.

use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

use mcap::{McapError, McapResult};

use crate::crash_flush::CrashFlush;
use crate::error::Error;
use crate::queue::{OverflowPolicy, QueueEntry, QueuedMessage, SizeHint, WriteQueue};
use crate::recorder::Recorder;
use crate::recording::{Attachment, Channel, MetadataEntry, RecordedSample};
use crate::tape_file::TapeStorage;

/// Number of polls without entries after which a chunk is flushed: about a second.
const IDLE_POLLS: u32 = 100;

/// Number of polls after which another file is tried: about a second at first,
const FIRST_PAUSE: u32 = 100;
/// and at most about 16 seconds.
const LONGEST_PAUSE: u32 = 1600;

/// Number of polls after which old recordings are removed.
const LIMIT_INTERVAL: u32 = 500;

/// The name of the metadata of a tape that continues another one: `of`, the file that could not be
/// written any more, and `missing`, the most messages that neither of them has.
pub const CONTINUATION: &str = "continuation";

/// The running thread.
pub(crate) struct WriterThread(JoinHandle<Result<u64, Error>>);

impl WriterThread {
    /// Joins the thread, and returns the number of messages written.
    pub(crate) fn join(self) -> Result<u64, Error> {
        let panicked = |_| Err(Error::no_thread(io::Error::other("it panicked")));
        self.0.join().unwrap_or_else(panicked)
    }
}

/// The state of a recording that its writer reports.
#[derive(Default)]
pub(crate) struct WriterReport(Mutex<ReportState>);

#[derive(Default)]
struct ReportState {
    files: Vec<PathBuf>,
    /// Why nothing is recorded at present.
    failure: Option<String>,
    missing: u64,
}

impl WriterReport {
    fn state(&self) -> MutexGuard<'_, ReportState> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn files(&self) -> Vec<PathBuf> {
        self.state().files.clone()
    }

    pub(crate) fn failure(&self) -> Option<String> {
        self.state().failure.clone()
    }

    pub(crate) fn missing(&self) -> u64 {
        self.state().missing
    }
}

/// Writes the entries of a queue.
pub(crate) struct TapeWriter {
    queue: Arc<WriteQueue>,
    storage: Box<dyn TapeStorage>,
    report: Arc<WriterReport>,
    crash: CrashFlush,
    /// `None` while nothing can be written.
    recorder: Option<Recorder>,
    channels: Vec<OpenChannel>,
    /// The entries at the beginning of each file of the tape.
    kept: Vec<KeptEntry>,
    /// Buffer for encodings, kept to reuse its memory.
    bytes: Vec<u8>,
    is_real_time: bool,
    /// Whether anything was written since the last flush.
    is_dirty: bool,
    silent_polls: u32,
    polls: u32,
    /// Polls until another file is tried, and the pause after the next failure.
    pause: u32,
    next_pause: u32,
    /// The messages of complete files.
    messages: u64,
    first_failure: Option<String>,
}

/// A channel, and its number in the present file.
struct OpenChannel {
    channel: Arc<Channel>,
    size: SizeHint,
    number: Option<u16>,
}

/// An entry that further files repeat.
enum KeptEntry {
    Facts(MetadataEntry),
    Attachment(String, String, Vec<u8>),
}

impl KeptEntry {
    fn write(&self, recorder: &mut Recorder) -> McapResult<()> {
        match self {
            KeptEntry::Facts(facts) => recorder.describe(facts),
            KeptEntry::Attachment(name, media_type, bytes) => {
                recorder.attach(&Attachment { name, media_type, bytes })
            }
        }
    }
}

/// Starts the thread. It ends, with the number of messages, when the queue is closed.
pub(crate) fn start(
    queue: Arc<WriteQueue>,
    mut storage: Box<dyn TapeStorage>,
    report: Arc<WriterReport>,
    crash: CrashFlush,
    when_full: OverflowPolicy,
) -> Result<WriterThread, Error> {
    let recorder = open_next(&mut *storage).map_err(Error::writing)?;
    report.state().files.extend(storage.path().map(PathBuf::from));
    let writer = TapeWriter {
        queue,
        storage,
        report,
        crash,
        recorder,
        channels: Vec::new(),
        kept: Vec::new(),
        bytes: Vec::new(),
        is_real_time: when_full == OverflowPolicy::Drop,
        is_dirty: false,
        silent_polls: 0,
        polls: 0,
        pause: FIRST_PAUSE,
        next_pause: FIRST_PAUSE,
        messages: 0,
        first_failure: None,
    };
    let thread = thread::Builder::new().name("tape".into()).spawn(move || writer.run());
    thread.map(WriterThread).map_err(Error::no_thread)
}

fn open_next(storage: &mut dyn TapeStorage) -> McapResult<Option<Recorder>> {
    let begun = storage.open_next()?.map(Recorder::new).transpose();
    if begun.is_err() {
        storage.discard();
    }
    begun
}

impl TapeWriter {
    fn run(mut self) -> Result<u64, Error> {
        let mut entries = Vec::new();
        loop {
            let is_crashing = self.crash.is_requested();
            if !self.queue.fetch(&mut entries) {
                break;
            }
            self.silent_polls = if entries.is_empty() { self.silent_polls + 1 } else { 0 };
            entries.drain(..).for_each(|entry| self.take(entry));
            if is_crashing {
                self.flush();
                self.crash.answer();
            }
            // In simulated time chunks end by that time alone, so that two tapes of one run are
            // equal.
            if self.is_real_time && self.is_dirty && self.silent_polls >= IDLE_POLLS {
                self.flush();
            }
            self.polls = self.polls.wrapping_add(1);
            if self.polls.is_multiple_of(LIMIT_INTERVAL) {
                self.storage.limit();
            }
            if self.recorder.is_none() {
                self.resume_after_pause();
            }
        }
        self.queue.end();
        self.finish()
    }

    fn finish(mut self) -> Result<u64, Error> {
        if let Some(recorder) = self.recorder.take() {
            match recorder.finish() {
                Ok((messages, _)) => self.messages += messages,
                Err(error) => {
                    // The number in the file is not known.
                    self.first_failure.get_or_insert(error.to_string());
                }
            }
        }
        match self.first_failure {
            None => Ok(self.messages),
            Some(failure) => Err(Error::interrupted(&failure, self.report.missing())),
        }
    }

    fn take(&mut self, entry: QueueEntry) {
        let messages = u64::from(matches!(entry, QueueEntry::Message(_)));
        let written = match entry {
            QueueEntry::Channel(channel, size) => {
                self.channels.push(OpenChannel { channel, size, number: None });
                Ok(())
            }
            QueueEntry::Message(waiting) => self.message(&waiting),
            QueueEntry::Facts(facts) => self.keep(KeptEntry::Facts(facts)),
            QueueEntry::Attachment(name, media_type, content) => {
                self.keep(KeptEntry::Attachment(name, media_type, content))
            }
            QueueEntry::Flush => {
                self.flush();
                self.queue.flushed();
                Ok(())
            }
        };
        if let Err(error) = written {
            self.interrupt(&error, messages);
        }
    }

    fn message(&mut self, waiting: &QueuedMessage) -> McapResult<()> {
        let Some(open) = self.channels.get_mut(waiting.channel as usize) else { return Ok(()) };
        let Some(recorder) = &mut self.recorder else {
            self.report.state().missing += 1;
            return Ok(());
        };
        let number = match open.number {
            Some(number) => number,
            None => *open.number.insert(recorder.channel(&open.channel)?),
        };
        self.bytes.clear();
        waiting.message.encode_to(&mut self.bytes);
        open.size.note(self.bytes.len());
        self.is_dirty = true;
        let message = RecordedSample {
            channel: open.channel.clone(),
            sequence: waiting.sequence,
            published: waiting.published,
            received: waiting.received,
            bytes: &self.bytes,
        };
        recorder.write(number, &message)
    }

    fn keep(&mut self, entry: KeptEntry) -> McapResult<()> {
        let written = self.recorder.as_mut().map_or(Ok(()), |recorder| entry.write(recorder));
        self.kept.push(entry);
        written
    }

    fn flush(&mut self) {
        self.is_dirty = false;
        if let Some(Err(error)) = self.recorder.as_mut().map(Recorder::flush) {
            self.interrupt(&error, 0);
        }
    }

    /// Abandons the present file; the number of messages that were being written is unknown.
    fn interrupt(&mut self, error: &McapError, lost: u64) {
        let Some(recorder) = self.recorder.take() else { return };
        let (written, missing) = recorder.abandon();
        let is_continuation = self.first_failure.is_some();
        if is_continuation && written == 0 {
            self.storage.discard();
            self.report.state().files.pop();
        }
        self.messages += written;
        let tape = self.storage.path().map_or_else(String::new, |path| format!(" {}", path.display()));
        let failure = format!("the tape{tape} cannot be written: {}", cause(error));
        tracing::error!("{failure}; the run goes on, and messages are not recorded");
        self.first_failure.get_or_insert_with(|| failure.clone());
        let mut report = self.report.state();
        report.missing += missing + lost;
        report.failure = Some(failure);
        self.pause = self.next_pause;
        self.next_pause = LONGEST_PAUSE.min(self.next_pause * 2);
    }

    /// Continues in another file if there is one that takes everything a tape begins with.
    fn resume_after_pause(&mut self) {
        self.pause = self.pause.saturating_sub(1);
        if self.pause > 0 {
            return;
        }
        self.pause = self.next_pause;
        self.next_pause = LONGEST_PAUSE.min(self.next_pause * 2);
        let before = self.storage.path().map(PathBuf::from);
        self.storage.limit();
        match self.next_file(before) {
            Ok(Some(recorder)) => {
                self.recorder = Some(recorder);
                self.channels.iter_mut().for_each(|open| open.number = None);
                let mut report = self.report.state();
                report.failure = None;
                if let Some(path) = self.storage.path() {
                    let missing = report.missing;
                    tracing::warn!(
                        "the recording continues in {}, up to {missing} messages are missing",
                        path.display()
                    );
                    report.files.push(path.to_path_buf());
                }
            }
            Ok(None) => {}
            Err(error) => tracing::debug!("the recording does not continue: {}", cause(&error)),
        }
    }

    fn next_file(&mut self, before: Option<PathBuf>) -> McapResult<Option<Recorder>> {
        let Some(mut recorder) = open_next(&mut *self.storage)? else { return Ok(None) };
        let of = before.map(|path| path.display().to_string()).unwrap_or_default();
        let missing = self.report.missing().to_string();
        let entries = BTreeMap::from([("of".to_owned(), of), ("missing".to_owned(), missing)]);
        let continuation = MetadataEntry { name: CONTINUATION.to_owned(), entries };
        let begun = recorder.describe(&continuation).and_then(|()| {
            self.kept.iter().try_for_each(|entry| entry.write(&mut recorder))?;
            recorder.flush()
        });
        match begun {
            Ok(()) => Ok(Some(recorder)),
            Err(error) => {
                recorder.abandon();
                self.storage.discard();
                Err(error)
            }
        }
    }
}

/// The error of the system, without the words of the MCAP library.
fn cause(error: &McapError) -> String {
    match error {
        McapError::Io(error) => error.to_string(),
        error => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::path::Path;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use narukom::Timestamp;

    use super::*;
    use crate::recording::{Recording, RecordingItem};
    use crate::tape_file::Output;

    /// Files on a disk of limited size, in memory.
    #[derive(Clone, Default)]
    struct Disk {
        room: Arc<AtomicUsize>,
        files: Arc<Mutex<Vec<Vec<u8>>>>,
    }

    struct DiskFile(Disk, usize);

    impl Write for DiskFile {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let DiskFile(disk, index) = self;
            let taken = disk.room.fetch_update(Ordering::SeqCst, Ordering::SeqCst, |room| {
                (room > 0).then(|| room - room.min(bytes.len()))
            });
            let room = taken.map_err(|_| io::Error::from(io::ErrorKind::StorageFull))?;
            let taken = room.min(bytes.len());
            disk.files.lock().unwrap()[*index].extend(&bytes[..taken]);
            Ok(taken)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl TapeStorage for Disk {
        fn open_next(&mut self) -> io::Result<Option<Output>> {
            let mut files = self.files.lock().unwrap();
            files.push(Vec::new());
            Ok(Some(Box::new(DiskFile(self.clone(), files.len() - 1))))
        }

        fn discard(&mut self) {
            self.files.lock().unwrap().pop();
        }

        fn limit(&mut self) {}

        fn path(&self) -> Option<&Path> {
            None
        }
    }

    /// A writer whose thread the test is.
    fn writer(disk: &Disk) -> TapeWriter {
        let mut storage = Box::new(disk.clone());
        let recorder = open_next(&mut *storage).unwrap();
        TapeWriter {
            queue: Arc::new(WriteQueue::new(OverflowPolicy::Wait)),
            storage,
            report: Arc::default(),
            crash: CrashFlush::default(),
            recorder,
            channels: Vec::new(),
            kept: Vec::new(),
            bytes: Vec::new(),
            is_real_time: false,
            is_dirty: false,
            silent_polls: 0,
            polls: 0,
            pause: FIRST_PAUSE,
            next_pause: FIRST_PAUSE,
            messages: 0,
            first_failure: None,
        }
    }

    fn channel() -> Arc<Channel> {
        let channel = Channel {
            host: "robot".into(),
            received_by: None,
            publisher: "vision".into(),
            part: 0,
            topic: "soccer/ball".into(),
            kind: "data".into(),
            schema: Arc::default(),
            name: "robot/soccer/ball".into(),
            encoding: crate::recording::PROTOBUF.into(),
            facts: BTreeMap::new(),
        };
        Arc::new(channel)
    }

    fn publish(writer: &mut TapeWriter, sequence: u32) {
        let at = Timestamp::from_nanos(u64::from(sequence) * 100_000_000);
        let message = Arc::new(narukom::example::Ball { distance: 1.0, ..Default::default() });
        writer.take(QueueEntry::Message(QueuedMessage {
            channel: 0,
            sequence,
            published: at,
            received: at,
            message,
        }));
    }

    fn sequences(bytes: &[u8]) -> Vec<u32> {
        let recording = Recording::from_bytes(bytes.to_vec());
        recording.messages().unwrap().map(|message| message.unwrap().sequence).collect()
    }

    #[test]
    fn after_a_full_disk_the_recording_continues_in_a_new_file_that_begins_like_the_first() {
        let disk = Disk::default();
        disk.room.store(4000, Ordering::SeqCst);
        let mut writer = writer(&disk);
        writer.take(QueueEntry::Attachment("match.xml".into(), "text/xml".into(), b"<match/>".to_vec()));
        writer.take(QueueEntry::Channel(channel(), SizeHint::default()));
        let mut sequence = 0;
        while writer.recorder.is_some() {
            sequence += 1;
            publish(&mut writer, sequence);
        }
        assert!(
            writer.report.failure().unwrap().contains("no storage space"),
            "{:?}",
            writer.report.failure()
        );
        // There is still no room: each attempt leaves no file.
        (0..10_000).for_each(|_| writer.resume_after_pause());
        assert!(writer.recorder.is_none() && disk.files.lock().unwrap().len() == 1);
        sequence += 1;
        publish(&mut writer, sequence);

        disk.room.store(1 << 20, Ordering::SeqCst);
        (0..LONGEST_PAUSE).for_each(|_| writer.resume_after_pause());
        assert_eq!(writer.report.failure(), None);
        let first_after = sequence + 1;
        (first_after..first_after + 5).for_each(|sequence| publish(&mut writer, sequence));
        let report = writer.report.clone();
        let error = writer.finish().unwrap_err().to_string();
        assert!(error.contains("no storage space") && error.contains("messages are missing"), "{error}");

        let files = disk.files.lock().unwrap().clone();
        let [first, second] = &files[..] else { panic!("{} files", files.len()) };
        let (early, late) = (sequences(first), sequences(second));
        assert!(!early.is_empty() && early.is_sorted() && early[0] == 1, "{early:?}");
        assert_eq!(late, (first_after..first_after + 5).collect::<Vec<_>>());
        let missing = u64::from(first_after - 1) - early.len() as u64;
        assert!((missing..missing + 3).contains(&report.missing()), "{missing} of {}", report.missing());
        let second = Recording::from_bytes(second.clone());
        assert!(second.is_finished());
        let items: Vec<_> = second.contents().unwrap().map(|item| item.unwrap()).collect();
        let RecordingItem::Facts(facts) = &items[0] else { panic!("{:?}", items[0]) };
        assert_eq!(facts.name, CONTINUATION);
        assert!(matches!(&items[1], RecordingItem::Attachment(file) if file.name == "match.xml"));
    }
}
