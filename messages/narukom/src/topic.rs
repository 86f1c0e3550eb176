//! Topics: a path, a message type and a retention kind, bound together at compile time.

use std::any::TypeId;
use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;
use std::time::Duration;

use linkme::distributed_slice;

use crate::descriptor::MessageDescriptor;
use crate::message::{AnyMessage, Message};

/// The default number of messages of a `state` topic that a hub holds. Readers see the latest; the
/// others serve subscribers, and readers that poll late in a cycle.
pub const STATE_DEPTH: usize = 8;

/// The number of messages of a `signal` topic that a hub holds for readers that have not fetched
/// them.
pub const SIGNAL_DEPTH: usize = 64;

/// A topic that keeps the latest message, also for late readers.
///
/// The hub holds the last `DEPTH` messages, at least one. One suffices for large messages, such as
/// images: then few are in memory at a time, and these stay in the processor's caches.
pub struct State<M, const DEPTH: usize = STATE_DEPTH>(PhantomData<fn() -> M>);

/// A topic whose messages each reader sees in one cycle.
pub struct Signal<M>(PhantomData<fn() -> M>);

/// A topic that keeps a history, read by time: the last `DEPTH` messages, at least one, restricted
/// to those of the last `MILLIS` milliseconds (unlimited by default).
pub struct Data<M, const DEPTH: usize, const MILLIS: u64 = { u64::MAX }>(PhantomData<fn() -> M>);

/// The retention of messages by a topic, without the message type.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum RetentionKind {
    /// The latest message: [`State`].
    State,
    /// Each message for one cycle of each reader: [`Signal`].
    Signal,
    /// A bounded history: [`Data`].
    Data,
}

impl fmt::Display for RetentionKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            RetentionKind::State => "state",
            RetentionKind::Signal => "signal",
            RetentionKind::Data => "data",
        })
    }
}

mod sealed {
    pub trait Sealed {}
    impl<M, const DEPTH: usize> Sealed for super::State<M, DEPTH> {}
    impl<M> Sealed for super::Signal<M> {}
    impl<M, const DEPTH: usize, const MILLIS: u64> Sealed for super::Data<M, DEPTH, MILLIS> {}
}

/// A retention of messages of one type: [`State`], [`Signal`] or [`Data`].
pub trait Retention: sealed::Sealed + 'static {
    /// The type of the messages.
    type Message: Message;
    /// The retention kind.
    const KIND: RetentionKind;
    /// The number of messages that a hub holds.
    const DEPTH: usize;
    /// The maximum age of a readable message, if limited.
    const AGE: Option<Duration> = None;
}

/// A retention that is read by time: [`Data`].
pub trait Timed: Retention {}

impl<M: Message, const DEPTH: usize> Retention for State<M, DEPTH> {
    type Message = M;
    const KIND: RetentionKind = RetentionKind::State;
    const DEPTH: usize = if DEPTH == 0 { 1 } else { DEPTH };
}

impl<M: Message> Retention for Signal<M> {
    type Message = M;
    const KIND: RetentionKind = RetentionKind::Signal;
    const DEPTH: usize = SIGNAL_DEPTH;
}

impl<M: Message, const DEPTH: usize, const MILLIS: u64> Retention for Data<M, DEPTH, MILLIS> {
    type Message = M;
    const KIND: RetentionKind = RetentionKind::Data;
    const DEPTH: usize = if DEPTH == 0 { 1 } else { DEPTH };
    const AGE: Option<Duration> = if MILLIS == u64::MAX { None } else { Some(Duration::from_millis(MILLIS)) };
}

impl<M: Message, const DEPTH: usize, const MILLIS: u64> Timed for Data<M, DEPTH, MILLIS> {}

/// A typed topic; declared by [`topic!`](crate::topic!).
pub struct Topic<K> {
    path: &'static str,
    hash: u64,
    keep: PhantomData<fn() -> K>,
}

impl<K: Retention> Topic<K> {
    /// Called by [`topic!`](crate::topic!).
    #[doc(hidden)]
    pub const fn new(path: &'static str) -> Topic<K> {
        Topic { path, hash: hash(path), keep: PhantomData }
    }
}

impl<K> Topic<K> {
    /// The path: segments of `[a-z0-9_]+` separated by `/`.
    pub const fn path(self) -> &'static str {
        self.path
    }

    pub(crate) const fn hash(self) -> u64 {
        self.hash
    }
}

impl<K> Clone for Topic<K> {
    fn clone(&self) -> Topic<K> {
        *self
    }
}

impl<K> Copy for Topic<K> {}

impl<K: Retention> fmt::Debug for Topic<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({} of {})", self.path, K::KIND, K::Message::DESCRIPTOR.full_name)
    }
}

/// The declaration of a topic as the hub needs it.
#[derive(Clone, Copy)]
pub struct TopicDeclaration {
    path: &'static str,
    hash: u64,
    kind: RetentionKind,
    depth: usize,
    age: Option<Duration>,
    descriptor: &'static MessageDescriptor,
    module: &'static str,
    constant: Option<&'static str>,
    message_type: fn() -> TypeId,
    rust_type: fn() -> &'static str,
    make: fn() -> Arc<dyn AnyMessage>,
}

impl TopicDeclaration {
    /// Declares a topic at `path` in `module`. The hub checks the path.
    pub const fn new<K: Retention>(path: &'static str, module: &'static str) -> TopicDeclaration {
        TopicDeclaration {
            path,
            hash: hash(path),
            kind: K::KIND,
            depth: K::DEPTH,
            age: K::AGE,
            descriptor: K::Message::DESCRIPTOR,
            module,
            constant: None,
            message_type: TypeId::of::<K::Message>,
            rust_type: std::any::type_name::<K::Message>,
            make: || Arc::new(K::Message::default()),
        }
    }

    /// Sets the name of the constant that stands for the topic in its module.
    pub const fn called(mut self, constant: &'static str) -> TopicDeclaration {
        self.constant = Some(constant);
        self
    }

    /// The path: `soccer/ball`.
    pub fn path(&self) -> &'static str {
        self.path
    }

    /// The retention kind.
    pub fn kind(&self) -> RetentionKind {
        self.kind
    }

    /// The number of messages that a hub holds.
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// The maximum age of a readable message, if limited.
    pub fn age(&self) -> Option<Duration> {
        self.age
    }

    /// The message type.
    pub fn descriptor(&self) -> &'static MessageDescriptor {
        self.descriptor
    }

    /// The module that declares it.
    pub fn module(&self) -> &'static str {
        self.module
    }

    /// The name of the constant that stands for it in that module, if it has one.
    pub fn constant(&self) -> Option<&'static str> {
        self.constant
    }

    /// The path of the message type in Rust, for code generation.
    pub fn rust_type(&self) -> &'static str {
        (self.rust_type)()
    }

    /// A default message of the topic's type.
    pub fn default_message(&self) -> Arc<dyn AnyMessage> {
        (self.make)()
    }

    /// The [`topic_hash`] of the path; unique within a hub.
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// The declaration with another hash, for tests of collisions.
    #[cfg(test)]
    pub(crate) fn with_hash(self, hash: u64) -> TopicDeclaration {
        TopicDeclaration { hash, ..self }
    }

    pub(crate) fn message_type(&self) -> TypeId {
        (self.message_type)()
    }
}

impl fmt::Debug for TopicDeclaration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({} of {}, in {})", self.path, self.kind, self.descriptor.full_name, self.module)
    }
}

/// Every topic that [`topic!`](crate::topic!) declares in a linked crate. The order depends on the
/// linker; hubs sort by path.
///
/// The linker drops a crate that is never referenced, together with its topics:
/// `use that_crate as _;` keeps it.
#[distributed_slice]
pub static TOPICS: [TopicDeclaration];

/// Declares topics.
///
/// Each becomes a constant of type [`Topic`] and is part of every hub created by
/// [`Hub::with_linked_topics`](crate::Hub::with_linked_topics). The path is checked at compile
/// time.
///
/// ```
/// # use narukom::example::Ball;
/// use narukom::{Data, Signal, State, topic};
///
/// topic! {
///     /// Position of the ball.
///     pub BALL: State<Ball> = "soccer/ball";
///     /// Each sighting, for filters.
///     pub SIGHTING: Data<Ball, 64> = "soccer/sighting";
///     /// Positions of the last half second, at most 32.
///     pub TRACK: Data<Ball, 32, 500> = "soccer/track";
///     /// The ball was touched.
///     pub TOUCH: Signal<Ball> = "soccer/touch";
/// }
/// assert_eq!(BALL.path(), "soccer/ball");
/// ```
///
/// ```compile_fail
/// # use narukom::example::Ball;
/// narukom::topic! { pub BALL: narukom::State<Ball> = "Soccer/Ball"; }
/// ```
#[macro_export]
macro_rules! topic {
    ($($(#[$attribute:meta])* $visibility:vis $name:ident : $keep:ty = $path:literal);* $(;)?) => {
        $(
            $(#[$attribute])*
            $visibility const $name: $crate::Topic<$keep> = {
                const _: () = assert!(
                    $crate::is_topic_path($path),
                    "a topic's path is segments of a-z, 0-9 and _ separated by /"
                );
                #[$crate::linkme::distributed_slice($crate::TOPICS)]
                #[linkme(crate = $crate::linkme)]
                static DECLARATION: $crate::TopicDeclaration =
                    $crate::TopicDeclaration::new::<$keep>($path, module_path!()).called(stringify!($name));
                $crate::Topic::new($path)
            };
        )*
    };
}

/// Whether `path` consists of segments of `[a-z0-9_]+` separated by `/`.
#[doc(hidden)]
pub const fn is_topic_path(path: &str) -> bool {
    let bytes = path.as_bytes();
    let mut segment = 0;
    let mut index = 0;
    while index < bytes.len() {
        match bytes[index] {
            b'a'..=b'z' | b'0'..=b'9' | b'_' => segment += 1,
            b'/' if segment > 0 => segment = 0,
            _ => return false,
        }
        index += 1;
    }
    segment > 0
}

/// Hash of a topic that depends on its path only: 64-bit FNV-1a. Slots depend on which other topics
/// a program links, so data that outlives the program identifies topics by this hash.
pub const fn topic_hash(path: &str) -> u64 {
    hash(path)
}

/// FNV-1a, 64 bits (Fowler, Noll, Vo).
pub(crate) const fn hash(text: &str) -> u64 {
    let bytes = text.as_bytes();
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut index = 0;
    while index < bytes.len() {
        hash = (hash ^ bytes[index] as u64).wrapping_mul(0x0000_0100_0000_01b3);
        index += 1;
    }
    hash
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_lower_case_segments() {
        for path in ["a", "soccer/ball", "body/joint_3", "_/0"] {
            assert!(is_topic_path(path), "{path}");
        }
        for path in ["", "/", "a/", "/a", "a//b", "A", "a b", "a.b", "a*", "ä"] {
            assert!(!is_topic_path(path), "{path}");
        }
    }

    #[test]
    fn the_hash_is_fnv_1a() {
        // From the reference test vectors of FNV.
        assert_eq!(hash(""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(hash("a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(hash("foobar"), 0x8594_4171_f739_67e8);
    }
}
