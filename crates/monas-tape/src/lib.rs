//! Records everything published into MCAP files, with protobuf schemas.
//!
//! A [`Tape`] observes one or more hubs and writes each message, as it is published, to a file in the [MCAP] format, which
//! Foxglove and the libraries of several languages read. A [`Recording`] is such a file read again.
//!
//! Each host, topic and publisher has a channel named `host/topic/path`, with the message's schema (encoding `protobuf`,
//! the descriptor set with its imports) and, as metadata, `host`, `publisher`, `topic` and `kind`. What came to a host from another one has
//! a channel `receiver/from/host/topic/path` with `received_by` besides. Threads of one agent have a channel each, with a `part` from the
//! second on. A message's log time is when the hub received it, its publish
//! time when it was published, by the clock of that hub; both count from the start of the run.
//!
//! # Why it is so
//!
//! - **Recording does not disturb.** Publishers leave a message and go on; a thread of the tape encodes and writes. In real time a
//!   disk that is too slow costs messages, which are counted, and no publisher's time. If the disk is full the recording ends and the
//!   run goes on; [`Tape::finish`] tells.
//! - **The same run gives the same bytes.** In simulated time nothing is left out, and what is written depends on no clock. Nothing is
//!   compressed.
//! - **A killed process loses little.** Chunks are closed once a second of the run's time, in real time also when nothing follows. What
//!   stands in closed chunks is read up to the cut; what comes after it is missing without an error, and [`Recording::is_finished`] says
//!   so. [`recover`] makes a whole tape of it.
//! - **Reading trusts nothing.** A tape takes up as much memory as its file, and what is taken apart at a time is bounded, whatever the
//!   file says of itself.
//!
//! [`cut`] and [`merge`] make tapes of tapes, and a [`Decoder`] takes messages apart by the schemas that the tape brings.
//!
//! # Speed
//!
//! `cargo bench -p monas-tape`, on two processors of a virtual machine: a tape takes 196 ns of the publisher's processor time for a message of
//! 200 bytes. Until the last is in the file, 284 MB of such messages pass in a second (242 to 318), and 1746 MB of messages of 1 MiB (506 to
//! 1946). Reading finds 7 messages of 9 bytes in a microsecond, and takes 3.5 apart.
//!
//! [MCAP]: https://mcap.dev
//!
//! # Example
//!
//! ```
//! # use narukom::example::Ball;
//! use monas_tape::{Tape, read};
//! use narukom::{Moment, Narukom, State, topic};
//!
//! topic! {
//!     /// Where the ball is.
//!     pub BALL: State<Ball> = "soccer/ball";
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("run.mcap");
//! let tape = Tape::create(&path)?;
//! let hub = Narukom::with_linked_topics("robot_1")?;
//! hub.observe(Box::new(tape.clone()));
//! hub.publisher(BALL, "vision")?.publish(Ball::default(), Moment::from_nanos(10));
//! assert_eq!(tape.finish()?, 1);
//!
//! for message in read(&path)?.messages()? {
//!     let message = message?;
//!     assert_eq!(message.channel.topic, "soccer/ball");
//!     assert_eq!(message.published, Moment::from_nanos(10));
//! }
//! # Ok(())
//! # }
//! ```

mod copy;
mod edit;
mod error;
mod overview;
mod playback;
mod queue;
mod recorder;
mod records;
mod schema;
mod tape;
mod value;
mod writer;

pub use edit::{Cut, Recovery, cut, merge, recover};
pub use error::{Error, ErrorKind};
pub use overview::{ChannelOverview, Overview};
pub use playback::{
    Attachment, Channel, Content, Contents, Facts, Message, Messages, Recording, Schema, read,
};
pub use schema::descriptor_pool;
pub use tape::Tape;
pub use value::{Decoder, FieldDifference, Value};
