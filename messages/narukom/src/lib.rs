//! Messages, topics and blackboards: publish/subscribe without threads, sockets or clocks.
//!
//! Agents on one host communicate through a [`Hub`]. Messages are structs compiled from `.proto`
//! files, shared behind a reference count and never serialised within a process. Topics are
//! constants declared by [`topic!`], each with a path, a message type and a retention kind:
//!
//! | | keeps | a reader sees |
//! |---|---|---|
//! | [`State`] | the latest message | the latest, whenever it subscribes |
//! | [`Signal`] | messages that readers have not fetched | each message in one cycle |
//! | [`Data`] | a history of bounded depth and age | the history, by time |
//!
//! An agent reads and writes through its [`Blackboard`]. Its cycle is a transaction: it begins with
//! [`process_messages`](Blackboard::process_messages), which delivers what others have published,
//! runs the agent's code on a blackboard that does not change meanwhile, and ends with
//! [`publish_all`](Blackboard::publish_all), which publishes everything atomically. A region of a
//! statechart has a blackboard too. Code outside of agents (a body, a recorder, a link) uses a
//! [`Publisher`], a [`Subscriber`] or an [`Observer`].
//!
//! # Design rationale
//!
//! - **Time is an argument.** Nothing here reads a clock, sleeps or starts a thread, so the same
//!   agents run in real and in simulated time, and a simulated run produces the same messages each
//!   time. A hub can nevertheless be shared by threads.
//! - **Readers poll.** A hub holds a bounded ring per topic; each reader has its own cursor. A
//!   reader that never polls slows down no publisher and uses no additional memory. Lost messages
//!   are counted ([`Blackboard::lost`]); a state never loses its last value.
//! - **No lookup by string.** A topic is found by a hash computed at compile time; a read costs one
//!   table access. In the steady state publishing, delivering and reading small messages do not
//!   allocate.
//! - **Mismatches are errors**: two message types on one topic (when the hub is created, with the
//!   names of both), or a message on an undeclared topic.
//!
//! # Memory
//!
//! Per topic and publishing host, a hub holds at most as many messages as the depth of the topic
//! ([`STATE_DEPTH`], [`SIGNAL_DEPTH`], or the depth given to [`State`] and [`Data`]); in addition a
//! topic takes less than 512 bytes, and each ring entry 96. A blackboard takes 24 bytes per topic
//! of the hub and, per topic that it reads, less than 200 bytes and 64 for a reference to each
//! delivered message, of which there are at most as many again. Messages are shared: with N topics
//! of depth D and M readers the hub holds at most N·D messages, and readers that stop polling
//! retain at most D more each. Each writer keeps four messages of a topic that left the hub, to
//! reuse their memory. A topic with encoded subscribers also holds the encodings of its messages,
//! and of four that left. `tests/memory.rs` checks these limits. The numbers of hosts, and of
//! publisher names of other hosts, are bounded too ([`HOST_LIMIT`], [`REMOTE_PUBLISHER_LIMIT`]).
//!
//! # Other hosts, and topics known at run time
//!
//! A link delivers the messages of another host through a [`Receiver`], with times by both clocks;
//! agents read them as `blackboard.from(host).read(BALL)`, separate from those published here. A
//! link sends the bytes that it reads from an [`EncodedSubscriber`]: a message is encoded once,
//! however many subscribers and observers there are, and never for readers in the process. Received
//! bytes, like those given to an [`AnyPublisher`], are decoded once, and rejected with the reason
//! if they do not encode a message of the topic. [`Blackboard::subscribe`], [`Blackboard::samples`]
//! and [`Blackboard::peek`] serve tools that know a topic only by its path.
//!
//! # Performance
//!
//! `cargo bench -p narukom` measures publishing and reading in one thread and across threads, in
//! comparison with other crates.
//!
//! A reader that polls without a new message compares one number and takes no lock: the channels of
//! the last publications are in the same cache line. The last publication is stored next to the
//! hub's lock, and moves to its topic's ring when the next one is published or the ring is read: a
//! blackboard that is one publication behind takes it from the two cache lines that start with the
//! lock. A reader that is further behind fetches from the rings, so that messages of all topics
//! arrive as they were published together.
//!
//! Within a thread the cost is atomic operations, about 5 ns each: the publisher takes and releases
//! the lock, and checks twice that the memory it reuses is exclusive; the reader takes and releases
//! the lock, increments the message's count, and drops the previous message.
//!
//! Across threads the cost is the transfer of cache lines that the other core wrote: the
//! publication number, the lock with the last publication, and the message with its count. Reused
//! message memory is prefetched when it is returned. `cargo bench -p narukom -- polling`, six runs
//! alternating with a variant in which the last publication had a separate lock, on two processors
//! of a virtual machine that are near each other in some runs and far apart in others (medians,
//! µs):
//!
//! | | with a separate lock | beside the hub's lock | `arc-swap`, which holds one value |
//! |---|---:|---:|---:|
//! | near | 0.26 to 0.34 | 0.20 | 0.17 to 0.19 |
//! | far | 0.82 to 0.90 | 0.75 to 0.85 | 0.57 to 0.65 |
//!
//! The remaining difference to `arc-swap` is one cache line, which takes 0.15 µs when far apart:
//! `arc-swap` polls the pointer itself, whereas here the polled number is separate from the lock,
//! so that polling readers do not slow down publishers; in addition the reference count in the
//! message is written.
//!
//! All tables of one run of `cargo bench -p narukom -- 7` on that machine, with the processors near
//! each other and under other load (medians; the figures of other crates are of rounds without
//! interruption):
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
//! A state keeps the message that was read, so the next image is built in different memory, as with
//! `arc-swap`; a channel frees its message and reuses memory that is still in the processor's
//! cache. A channel whose reader keeps the last image until the next one arrives is as fast as a
//! state: in that later run the fastest round of `std::sync::mpsc` took 9.8 µs, of one whose reader
//! does that 11.7, of `arc-swap` 11.9 and of narukom 11.6 (medians 13.8, 14.1, 14.1 and 13.9).
//!
//! From blackboard to blackboard there are two cycles, and a written message is also kept by the
//! writer, to be readable at once: this adds one more reference to the message, and entries in the
//! writer's outbox and in the list of messages to publish.
//!
//! # Example
//!
//! The messages are declared in a `.proto` file,
//!
//! ```text
//! syntax = "proto3";
//! package narukom.example;
//!
//! // Position of the ball relative to the robot.
//! message Ball {
//!   double distance = 1;  // metres
//!   double bearing = 2;   // radians, to the left
//! }
//! ```
//!
//! which `narukom_build::compile(&["proto/ball.proto"], &["proto"])` compiles in the build script,
//! and `narukom::include_messages!("narukom.example")` includes. Then:
//!
//! ```
//! # use narukom::example::Ball;
//! use narukom::{Hub, State, Timestamp, topic};
//!
//! topic! {
//!     /// Position of the ball.
//!     pub BALL: State<Ball> = "soccer/ball";
//! }
//!
//! fn main() -> Result<(), narukom::Error> {
//!     let hub = Hub::with_linked_topics("robot_1")?;
//!     let mut vision = hub.blackboard("vision");
//!     let mut behaviour = hub.blackboard("behaviour");
//!
//!     // A cycle of the first agent: it sees a ball.
//!     vision.process_messages(Timestamp::from_nanos(10));
//!     vision.publish(BALL, Ball { distance: 1.5, bearing: 0.2 })?;
//!     assert!(vision.read(BALL).is_some(), "own messages are read at once");
//!     assert!(behaviour.read(BALL).is_none(), "others' only as delivered");
//!     vision.publish_all(Timestamp::from_nanos(20));
//!
//!     // A cycle of the second agent.
//!     behaviour.process_messages(Timestamp::from_nanos(30));
//!     let ball = behaviour.sample(BALL).unwrap();
//!     assert_eq!(ball.distance, 1.5);
//!     assert_eq!(ball.header.published, Timestamp::from_nanos(20));
//!     Ok(())
//! }
//! ```

mod blackboard;
mod cancellation;
mod cursors;
mod descriptor;
mod encoded_subscriber;
mod encoding;
mod error;
#[doc(hidden)]
pub mod example;
#[doc(hidden)]
#[allow(missing_docs)]
pub mod generated;
mod history;
mod hub;
mod hub_state;
mod inbox;
mod message;
mod observer;
mod outbox;
mod pool;
mod publication_index;
mod publisher;
mod random;
mod receiver;
mod ring;
mod sample;
mod subscriber;
mod timestamp;
mod topic;
mod topic_table;

pub use blackboard::{Blackboard, EVENT_LIMIT, HostView, OUTBOX_LIMIT};
pub use cancellation::Cancellation;
pub use descriptor::{EnumDescriptor, FieldDescriptor, FieldKind, MessageDescriptor};
pub use encoded_subscriber::EncodedSubscriber;
pub use encoding::{ENCODED_LIMIT, EncodedMessage, SharedEncoding};
pub use error::{Error, ErrorKind};
pub use history::SurroundingSamples;
pub use hub::Hub;
pub use hub_state::{HOST_LIMIT, REMOTE_PUBLISHER_LIMIT};
pub use message::{AnyMessage, Enumeration, FieldError, FieldValue, Message, Reflect};
pub use observer::{Observer, Publication, Waker};
pub use publisher::{AnyPublisher, Publisher};
pub use random::Random;
pub use receiver::{Receiver, RemoteHeader};
pub use sample::{AnySample, Header, HostId, PublisherId, Sample, TopicSlot};
pub use subscriber::{Subscriber, is_topic_pattern, pattern_fits};
pub use timestamp::Timestamp;
#[doc(hidden)]
pub use topic::is_topic_path;
pub use topic::{
    Data, Retention, RetentionKind, SIGNAL_DEPTH, STATE_DEPTH, Signal, State, TOPICS, Timed, Topic,
    TopicDeclaration, topic_hash,
};

/// The protobuf library whose traits messages implement, re-exported for generated code.
pub use prost;

#[doc(hidden)]
pub use linkme;

/// Includes the messages that `narukom_build` compiled for a package, in a separate module:
///
/// ```text
/// /// Messages of the soccer team.
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
