//! Messages, topics and blackboards: publish and subscribe without threads, sockets or clocks.
//!
//! Agents on one host talk through a hub, [`Narukom`]. What they say are messages: structs compiled from `.proto` files,
//! shared behind a reference count and never serialised inside a process. Where they say it are topics: constants made by
//! [`topic!`], each with a path, a message type and a way of keeping:
//!
//! | | keeps | a reader sees |
//! |---|---|---|
//! | [`State`] | the latest message | the latest, however late it comes |
//! | [`Signal`] | what readers have not fetched yet | each message in one cycle |
//! | [`Data`] | a history of bounded depth and age | the history, by time |
//!
//! An agent reads and writes through its [`Blackboard`]. Its cycle is a transaction: it begins with
//! [`process_messages`](Blackboard::process_messages), which delivers what others have published, runs the agent's code on a
//! blackboard that does not move meanwhile, and ends with [`publish_all`](Blackboard::publish_all), which publishes everything at
//! once. A region of a statechart has a blackboard too. Whoever is no agent (a body, a recorder, a link) uses a [`Publisher`], a
//! [`Subscriber`] or an [`Observer`].
//!
//! # Why it is so
//!
//! - **Time is handed in.** Nothing here reads a clock, sleeps or starts a thread, so the same agents run in real and in
//!   simulated time, and a simulated run gives the same messages each time. Threads may share a hub all the same.
//! - **Readers fetch.** A hub holds a bounded ring for each topic; each reader has its own place in it. A reader that never
//!   fetches slows nobody and fills no memory. What it misses is counted ([`Blackboard::lost`]); a state never loses its last value.
//! - **Nothing is looked up by text.** A topic is found by a hash that is made when it is compiled; reading costs a table
//!   access. In the steady state publishing, delivering and reading small messages do not allocate.
//! - **What does not fit is an error**: two message types on one topic (when the hub is made, with the names of both),
//!   or a message on a topic that nobody declared.
//!
//! # Memory
//!
//! A hub holds at most as many messages of each topic as the topic is deep ([`STATE_DEPTH`], [`SIGNAL_DEPTH`], or what
//! [`State`] and [`Data`] say), of each host that publishes on it; besides that a topic takes less than 512 bytes and each place for a
//! message 96. A blackboard takes 24 bytes for each topic of the hub, and for each topic that it reads less than 200 bytes and
//! 64 for a reference to each message that it was delivered, which are at most as many again. Messages are shared: with N topics of depth
//! D and M readers there are at most N·D messages in the hub, and readers that stop fetching hold on to at most D more each.
//! Each writer keeps four messages of a topic that left the hub, to make the next ones of. A topic that is tapped holds the encodings of its messages
//! too, and of four that left. `tests/memory.rs` holds the crate to this.
//! Hosts, and the names that other hosts give their publishers, are bounded too ([`HOST_LIMIT`], [`REMOTE_PUBLISHER_LIMIT`]).
//!
//! # Other hosts, and topics known at run time
//!
//! A link takes in what another host publishes through a [`Receiver`], with the moments of both clocks; agents read it as
//! `blackboard.from(host).read(BALL)`, apart from what is published here. On its way out a link reads bytes from a [`Tap`]: a message is
//! encoded once however many taps and observers look, and never for readers in the process. On its way in, as for an [`AnyPublisher`],
//! bytes are decoded once, and refused with the reason when they are no message of the topic.
//! [`Blackboard::subscribe`], [`Blackboard::samples`] and [`Blackboard::peek`] are for tools that know a topic by its path only.
//!
//! # Speed
//!
//! `cargo bench -p narukom` measures publishing and reading in one thread and across threads, beside what others make of it.
//!
//! Whoever polls and finds nothing for itself compares one number, and takes no lock: the channels of the last publications stand in the
//! same cache line. The last publication lies beside the hub's lock, and is put into its topic's ring when the next one comes or somebody looks
//! there: a blackboard that is one publication behind takes it from the two cache lines that the lock begins. Whoever has missed more
//! fetches from the rings, so that messages of all topics come as they were published together.
//!
//! Within a thread the time goes to atomic operations, about 5 ns each: the publisher takes and frees the lock, and makes sure twice that nobody
//! holds the memory that it uses again; the reader takes and frees the lock, counts itself, and lets go of the message before.
//!
//! Across threads it goes where one processor waits for lines that the other one wrote: the number, the lock with the last publication, and the
//! message with its count. The memory that a message is made in is fetched earlier, when it comes back. `cargo bench -p narukom -- polling`,
//! six runs in turns with the same when the last publication had a lock of its own, on two processors of a virtual machine, which stand near
//! each other in some runs and far apart in others (medians, µs):
//!
//! | | with a lock of its own | beside the hub's lock | `arc-swap`, which holds one value |
//! |---|---:|---:|---:|
//! | near | 0.26 to 0.34 | 0.20 | 0.17 to 0.19 |
//! | far | 0.82 to 0.90 | 0.75 to 0.85 | 0.57 to 0.65 |
//!
//! What is left beside `arc-swap` is one line, which far apart takes 0.15 µs to come: `arc-swap` polls the pointer itself, where here the number that
//! is polled is apart from the lock, so that those who poll do not slow down those who publish; and the count of readers in the message is written.
//!
//! All tables of one run of `cargo bench -p narukom -- 7` there, the processors near each other and much other work on them (medians; what is shown
//! of others had no round in which it was held up):
//!
//! | | narukom | best of the others |
//! |---|---:|---|
//! | one thread, publish and read 200 bytes | 88.3 ns (86.3 to 97.6) | 19.9 ns, `std::sync::mpsc`; `arc-swap` 111 ns; encoded and decoded 96.2 ns |
//! | the same from blackboard to blackboard, two cycles | 123 ns (122 to 137) | |
//! | nearest of 256 | 27.7 ns | |
//! | a cycle beside 10,000 idle topics | 92.4 ns (91.7 to 93.1) | 93.9 ns (93.1 to 94.2) beside none |
//! | two threads, polling, 64 bytes | 0.22 µs | 0.17 µs, `crossbeam-channel`; `arc-swap` 0.18 µs |
//! | two threads, blocking, 64 bytes | 2.87 µs | 2.78 µs, `std::sync::mpsc` |
//! | two threads, blocking, 1 MiB | 14.3 µs (12.2 to 17.2) | 10.5 µs, `std::sync::mpsc`; `arc-swap` and a Condvar 12.8 µs (12.3 to 14.5) |
//! | one to eight, blocking, 64 bytes | 21.1 µs (18.0 to 26.7) | 21.0 µs (18.0 to 24.2), `arc-swap` and a Condvar |
//! | one to eight, blocking, 1 MiB | 35.5 µs (27.4 to 43.4), in a later run | 32.8 µs (26.2 to 33.9), `arc-swap` and a Condvar |
//!
//! A state stays when it was read, so that the next picture is made in other memory than the one before, as with `arc-swap`; a channel's is freed by then, and made again
//! where it still lies in the processor's cache. A channel whose reader keeps the last picture until the next comes is as fast as a state: in that later run the quickest round
//! of `std::sync::mpsc` took 9.8 µs, of one whose reader does that 11.7, of `arc-swap` 11.9 and of narukom 11.6 (medians 13.8, 14.1, 14.1 and 13.9).
//!
//! From blackboard to blackboard there are two cycles, and what is written is kept beside the hub's to be read at once: one more message to count in and out, and its place in the
//! writer's own list and in the list of what is to be published.
//!
//! # Example
//!
//! The messages are declared in a `.proto` file,
//!
//! ```text
//! syntax = "proto3";
//! package narukom.example;
//!
//! // Where the ball is, as seen from the robot.
//! message Ball {
//!   double distance = 1;  // metres
//!   double bearing = 2;   // radians, to the left
//! }
//! ```
//!
//! which `narukom_build::compile(&["proto/ball.proto"], &["proto"])` compiles in the build script, and
//! `narukom::include_messages!("narukom.example")` includes. Then:
//!
//! ```
//! # use narukom::example::Ball;
//! use narukom::{Moment, Narukom, State, topic};
//!
//! topic! {
//!     /// Where the ball is.
//!     pub BALL: State<Ball> = "soccer/ball";
//! }
//!
//! fn main() -> Result<(), narukom::Error> {
//!     let hub = Narukom::with_linked_topics("robot_1")?;
//!     let mut vision = hub.blackboard("vision");
//!     let mut behaviour = hub.blackboard("behaviour");
//!
//!     // A cycle of the one: it sees a ball.
//!     vision.process_messages(Moment::from_nanos(10));
//!     vision.publish(BALL, Ball { distance: 1.5, bearing: 0.2 })?;
//!     assert!(vision.read(BALL).is_some(), "own messages are read at once");
//!     assert!(behaviour.read(BALL).is_none(), "others' only as delivered");
//!     vision.publish_all(Moment::from_nanos(20));
//!
//!     // A cycle of the other.
//!     behaviour.process_messages(Moment::from_nanos(30));
//!     let ball = behaviour.sample(BALL).unwrap();
//!     assert_eq!(ball.distance, 1.5);
//!     assert_eq!(ball.header.published, Moment::from_nanos(20));
//!     Ok(())
//! }
//! ```

mod blackboard;
mod cancellation;
mod catalogue;
mod cursors;
mod descriptor;
mod encoding;
mod error;
#[doc(hidden)]
pub mod example;
mod exchange;
#[doc(hidden)]
#[allow(missing_docs)]
pub mod generated;
mod head;
mod history;
mod hub;
mod message;
mod moment;
mod observer;
mod pool;
mod publisher;
mod random;
mod reading;
mod receiver;
mod ring;
mod sample;
mod subscriber;
mod tap;
mod topic;
mod writing;

pub use blackboard::{Blackboard, EVENT_LIMIT, OUTBOX_LIMIT, View};
pub use cancellation::Cancellation;
pub use descriptor::{EnumDescriptor, FieldDescriptor, FieldKind, MessageDescriptor};
pub use encoding::{ENCODED_LIMIT, Encoded, SharedEncoding};
pub use error::{Error, ErrorKind};
pub use exchange::{HOST_LIMIT, REMOTE_PUBLISHER_LIMIT};
pub use history::Neighbours;
pub use hub::Narukom;
pub use message::{AnyMessage, Enumeration, FieldError, FieldValue, Message, Reflect};
pub use moment::Moment;
pub use observer::{Observer, Publication, Waker};
pub use publisher::{AnyPublisher, Publisher};
pub use random::Random;
pub use receiver::{Arrival, Receiver};
pub use sample::{AnySample, Header, HostId, PublisherId, Sample, TopicSlot};
pub use subscriber::{Subscriber, pattern_fits};
pub use tap::Tap;
#[doc(hidden)]
pub use topic::is_topic_path;
pub use topic::{
    Data, Keep, Kind, SIGNAL_DEPTH, STATE_DEPTH, Signal, State, TOPICS, Timed, Topic, TopicDeclaration,
};

/// The protobuf library whose traits messages implement; generated code names it through here.
pub use prost;

#[doc(hidden)]
pub use linkme;

/// Includes the messages that `narukom_build` compiled for a package, from a module of their own:
///
/// ```text
/// /// The messages of soccer.
/// pub mod messages {
///     narukom::include_messages!("monas.soccer");
/// }
/// ```
#[macro_export]
macro_rules! include_messages {
    ($package:literal) => {
        include!(concat!(env!("OUT_DIR"), "/", $package, ".rs"));
    };
}
