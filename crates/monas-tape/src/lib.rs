//! Records everything published into MCAP files, with protobuf schemas.
//!
//! A [`Tape`] observes one or more hubs and writes each message, as it is published, to a file in the [MCAP] format, which
//! Foxglove and the libraries of several languages read. A [`Recording`] is such a file read again.
//!
//! Each host, topic and publisher has a channel named `host/topic/path`, with the message's schema (encoding `protobuf`,
//! the descriptor set with its imports) and, as metadata, `host`, `publisher`, `topic` and `kind`. A message's log time is when the hub
//! received it, its publish time when it was published; both count from the start of the run.
//!
//! # Why it is so
//!
//! - **The same run gives the same bytes.** The tape reads no clock and does not compress; times are those of the run.
//! - **A killed process loses little.** Chunks are closed once a second of the run's time. What stands in closed chunks is read
//!   up to the cut; what comes after it is missing without an error, and [`Recording::is_finished`] says so.
//! - **Recording does not disturb.** If the disk is full the recording ends and the run goes on; [`Tape::finish`] tells.
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

mod error;
mod playback;
mod recorder;
mod records;
mod tape;

pub use error::{Error, ErrorKind};
pub use playback::{Channel, Message, Messages, Recording, read};
pub use tape::Tape;
