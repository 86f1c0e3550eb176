//! Records all publications into MCAP files, with protobuf schemas.
//!
//! A [`Tape`] observes one or more hubs and writes each message, as it is published, to a file in
//! the [MCAP] format, which Foxglove and libraries in several languages read. A [`Recording`] reads
//! such a file.
//!
//! Each host, topic and publisher has a channel named `host/topic/path`, with the message's schema
//! (encoding `protobuf`, the descriptor set with its imports) and, as metadata, `host`,
//! `publisher`, `topic` and `kind`. Messages that a host received from another one have a channel
//! `receiver/from/host/topic/path` with `received_by` in addition. Threads of one agent have a
//! channel each, with a `part` from the second on. A message's log time is when the hub received
//! it, its publish time when it was published, by the clock of that hub; both count from the start
//! of the run.
//!
//! # Design rationale
//!
//! - **Recording does not disturb.** Publishers enqueue a message and continue; a thread of the
//!   tape encodes and writes. In real time a disk that is too slow costs messages, which are
//!   counted, but does not block publishers. If the disk is full the run goes on, an error is
//!   logged at once, and the recording continues in a new file when there is room; [`Tape::finish`]
//!   reports what is missing.
//! - **A recording is not overwritten.** A [`TapeFile`] is created exclusively and locked while it
//!   is written. A [`RecordingFolder`] keeps the newest recordings of a robot.
//! - **Recordings are reproducible.** In simulated time no message is dropped, and the file does
//!   not depend on any clock. Nothing is compressed.
//! - **A killed process loses little.** Chunks are closed once per second of the run's time, at its
//!   beginning sooner, in real time also when no message follows. Closed chunks are readable up to
//!   the point of truncation; what follows is missing without an error, and
//!   [`Recording::is_finished`] returns `false`. [`recover`] turns such a file into an intact tape.
//! - **Input is not trusted.** A tape takes as much memory as its file, and the size of a decoded
//!   message is bounded, whatever the file claims.
//!
//! [`cut`] and [`merge`] create tapes from tapes, and a [`Decoder`] decodes messages by the schemas
//! in the tape.
//!
//! # Performance
//!
//! `cargo bench -p monas-tape`, on two processors of a virtual machine: a tape takes 196 ns of the
//! publisher's processor time for a message of 200 bytes. Until the last is in the file, 284 MB of
//! such messages are written per second (242 to 318), and 1746 MB of messages of 1 MiB (506 to
//! 1946). Reading finds 7 messages of 9 bytes per microsecond, and decodes 3.5.
//!
//! [MCAP]: https://mcap.dev
//!
//! # Example
//!
//! ```
//! # use narukom::example::Ball;
//! use monas_tape::{Tape, read};
//! use narukom::{Hub, State, Timestamp, topic};
//!
//! topic! {
//!     /// Position of the ball.
//!     pub BALL: State<Ball> = "soccer/ball";
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("run.mcap");
//! let tape = Tape::create(&path)?;
//! let hub = Hub::with_linked_topics("robot_1")?;
//! hub.observe(Box::new(tape.clone()));
//! hub.publisher(BALL, "vision")?.publish(Ball::default(), Timestamp::from_nanos(10));
//! assert_eq!(tape.finish()?, 1);
//!
//! for message in read(&path)?.messages()? {
//!     let message = message?;
//!     assert_eq!(message.channel.topic, "soccer/ball");
//!     assert_eq!(message.published, Timestamp::from_nanos(10));
//! }
//! # Ok(())
//! # }
//! ```

mod crash_flush;
mod edit;
mod error;
mod queue;
mod recorder;
mod recording;
mod recording_folder;
mod records;
mod schema;
mod tape;
mod tape_copy;
mod tape_file;
mod tape_overview;
mod value;
mod writer;

pub use crash_flush::CrashFlush;
pub use edit::{Recovery, TapeFilter, cut, merge, recover};
pub use error::{Error, ErrorKind};
pub use monas_files::ExistingFile;
pub use recording::{
    Attachment, Channel, Messages, MetadataEntry, RecordedSample, Recording, RecordingItem, RecordingItems,
    Schema, read,
};
pub use recording_folder::{RecordingFolder, RecordingLimits};
pub use schema::descriptor_pool;
pub use tape::Tape;
pub use tape_file::TapeFile;
pub use tape_overview::{ChannelOverview, TapeOverview};
pub use value::{Decoder, FieldDifference, Value};
pub use writer::CONTINUATION;
