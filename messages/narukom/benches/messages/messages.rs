//! The messages that are passed: 64 and 200 bytes, and a large one.

use narukom::prost;
use narukom::{
    AnyMessage, Data, FieldError, FieldValue, Hub, Message, MessageDescriptor, Reflect, Retention, State,
    Topic, TopicDeclaration,
};

macro_rules! message {
    ($name:ident, $descriptor:ident) => {
        static $descriptor: MessageDescriptor = MessageDescriptor {
            full_name: concat!("narukom.bench.", stringify!($name)),
            name: stringify!($name),
            fields: &[],
            file_descriptor_set: &[],
        };

        impl Reflect for $name {
            fn descriptor(&self) -> &'static MessageDescriptor {
                &$descriptor
            }

            fn field(&self, _index: usize) -> FieldValue<'_> {
                FieldValue::Missing
            }

            fn set_field(&mut self, _index: usize, _value: FieldValue<'_>) -> Result<(), FieldError> {
                Err(FieldError::NoSuchField)
            }

            fn message_mut(&mut self, _index: usize) -> Option<&mut dyn AnyMessage> {
                None
            }
        }

        impl Message for $name {
            const DESCRIPTOR: &'static MessageDescriptor = &$descriptor;
        }
    };
}

/// Eight numbers: 64 bytes.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub(crate) struct Small {
    #[prost(fixed64, tag = "1")]
    pub(crate) sent: u64,
    #[prost(fixed64, tag = "2")]
    pub(crate) b: u64,
    #[prost(fixed64, tag = "3")]
    pub(crate) c: u64,
    #[prost(fixed64, tag = "4")]
    pub(crate) d: u64,
    #[prost(fixed64, tag = "5")]
    pub(crate) e: u64,
    #[prost(fixed64, tag = "6")]
    pub(crate) f: u64,
    #[prost(fixed64, tag = "7")]
    pub(crate) g: u64,
    #[prost(fixed64, tag = "8")]
    pub(crate) h: u64,
}
message!(Small, SMALL_MESSAGE);

/// Five numbers by five: 200 bytes.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub(crate) struct Joints {
    #[prost(message, required, tag = "1")]
    pub(crate) a: Five,
    #[prost(message, required, tag = "2")]
    pub(crate) b: Five,
    #[prost(message, required, tag = "3")]
    pub(crate) c: Five,
    #[prost(message, required, tag = "4")]
    pub(crate) d: Five,
    #[prost(message, required, tag = "5")]
    pub(crate) e: Five,
}
message!(Joints, JOINTS_MESSAGE);

#[derive(Clone, Copy, PartialEq, prost::Message)]
pub(crate) struct Five {
    #[prost(double, tag = "1")]
    pub(crate) a: f64,
    #[prost(double, tag = "2")]
    pub(crate) b: f64,
    #[prost(double, tag = "3")]
    pub(crate) c: f64,
    #[prost(double, tag = "4")]
    pub(crate) d: f64,
    #[prost(double, tag = "5")]
    pub(crate) e: f64,
}

impl Joints {
    pub(crate) fn new(number: u32) -> Joints {
        let a = f64::from(number);
        let five = Five { a, b: a + 0.5, c: 1.0, d: 2.0, e: 3.0 };
        Joints { a: five, b: five, c: five, d: five, e: five }
    }
}

/// A mebibyte.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct Large {
    #[prost(fixed64, tag = "1")]
    pub(crate) sent: u64,
    #[prost(bytes = "vec", tag = "2")]
    pub(crate) content: Vec<u8>,
}
message!(Large, LARGE_MESSAGE);

pub(crate) const LARGE_SIZE: usize = 1 << 20;

pub(crate) const SMALL: Topic<State<Small>> = Topic::new("bench/small");
pub(crate) const JOINTS: Topic<State<Joints>> = Topic::new("bench/joints");
pub(crate) const HISTORY: Topic<Data<Small, 256>> = Topic::new("bench/history");
pub(crate) const LARGE: Topic<State<Large, 1>> = Topic::new("bench/large");

/// A hub with these topics and `idle` others.
pub(crate) fn hub(idle: usize) -> Hub {
    let mut declarations = vec![
        declared::<State<Small>>("bench/small"),
        declared::<State<Joints>>("bench/joints"),
        declared::<Data<Small, 256>>("bench/history"),
        declared::<State<Large, 1>>("bench/large"),
    ];
    let names = (0..idle).map(|number| &*format!("idle/topic_{number}").leak());
    declarations.extend(names.map(declared::<State<Small>>));
    Hub::new("bench", &declarations).unwrap()
}

fn declared<K: Retention>(path: &'static str) -> TopicDeclaration {
    TopicDeclaration::new::<K>(path, "bench")
}
