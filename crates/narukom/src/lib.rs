//! Messages, topics and blackboards: publish and subscribe without threads, sockets or clocks

mod blackboard;
mod catalogue;
mod descriptor;
mod error;
#[doc(hidden)]
pub mod example;
#[doc(hidden)]
#[allow(missing_docs)]
pub mod generated;
mod history;
mod hub;
mod message;
mod moment;
mod observer;
mod pool;
mod publisher;
mod random;
mod reading;
mod ring;
mod sample;
mod subscriber;
mod topic;
mod writing;

pub use blackboard::{Blackboard, OUTBOX_LIMIT};
pub use descriptor::{EnumDescriptor, FieldDescriptor, FieldKind, MessageDescriptor};
pub use error::{Error, ErrorKind};
pub use hub::Narukom;
pub use message::{AnyMessage, Enumeration, FieldError, FieldValue, Message, Reflect};
pub use moment::Moment;
pub use observer::{Observer, Publication, Waker};
pub use publisher::Publisher;
pub use random::Random;
pub use sample::{AnySample, Header, HostId, PublisherId, Sample, TopicSlot};
pub use subscriber::Subscriber;
#[doc(hidden)]
pub use topic::is_topic_path;
pub use topic::{
    Data, Keep, Kind, SIGNAL_DEPTH, STATE_DEPTH, Signal, State, TOPICS, Topic, TopicDeclaration,
};

/// The protobuf library whose traits messages implement; generated code names it through here.
pub use prost;

#[doc(hidden)]
pub use linkme;

/// Includes the messages that `narukom_build` compiled for a package.
///
/// ```text
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
