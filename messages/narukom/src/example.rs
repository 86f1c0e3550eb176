//! A message as `narukom-build` generates it, for the examples in the documentation.

use crate::descriptor::{FieldDescriptor, FieldKind, MessageDescriptor};
use crate::message::{AnyMessage, FieldError, FieldValue, Message, Reflect};

/// Position of the ball relative to the robot.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub struct Ball {
    /// Distance in metres.
    #[prost(double, tag = "1")]
    pub distance: f64,
    /// Bearing in radians, to the left.
    #[prost(double, tag = "2")]
    pub bearing: f64,
}

static BALL: MessageDescriptor = MessageDescriptor {
    full_name: "narukom.example.Ball",
    name: "Ball",
    fields: &[
        FieldDescriptor { name: "distance", tag: 1, kind: FieldKind::F64 },
        FieldDescriptor { name: "bearing", tag: 2, kind: FieldKind::F64 },
    ],
    file_descriptor_set: &[],
};

impl Reflect for Ball {
    fn descriptor(&self) -> &'static MessageDescriptor {
        &BALL
    }

    fn field(&self, index: usize) -> FieldValue<'_> {
        match index {
            0 => FieldValue::Float(self.distance),
            1 => FieldValue::Float(self.bearing),
            _ => FieldValue::Missing,
        }
    }

    fn set_field(&mut self, index: usize, value: FieldValue<'_>) -> Result<(), FieldError> {
        let (target, field) = match index {
            0 => (&mut self.distance, "distance"),
            1 => (&mut self.bearing, "bearing"),
            _ => return Err(FieldError::NoSuchField),
        };
        *target = match value {
            FieldValue::Missing => 0.0,
            FieldValue::Float(value) => value,
            _ => return Err(FieldError::WrongKind { field }),
        };
        Ok(())
    }

    fn message_mut(&mut self, _index: usize) -> Option<&mut dyn AnyMessage> {
        None
    }
}

impl Message for Ball {
    const DESCRIPTOR: &'static MessageDescriptor = &BALL;
}
