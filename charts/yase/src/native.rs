//! The Rust functions of a chart's guards and assignments, as `yase-codegen` collects them.
//! [`Statechart::compile_with_functions`](crate::Statechart::compile_with_functions) uses them
//! instead of the chart's expressions.

use std::collections::BTreeMap;

pub use crate::expression::native::*;

use crate::expression::Origin;
use crate::ids::ActionLocation;
use crate::statechart::TransitionId;

/// The functions of a chart, and the declarations they refer to.
#[derive(Clone, Debug, Default)]
pub struct NativeProgram {
    /// The messages that the functions read and write, by the numbers of their sources.
    pub sources: Vec<SourceDeclaration>,
    /// The names of timers, by number.
    pub timers: Vec<&'static str>,
    /// The names of functions of the type environment, by number.
    pub functions: Vec<&'static str>,
    /// Enumeration, value, and the number that the functions use for the value.
    pub enumerations: Vec<(&'static str, &'static str, i32)>,
    /// The function of each guard.
    pub guards: BTreeMap<TransitionId, GuardFn>,
    /// The functions of each assignment, by location and index in its action list, from 0.
    pub values: BTreeMap<(ActionLocation, usize), NativeAssignment>,
}

/// The functions of an assignment.
#[derive(Clone, Debug)]
pub struct NativeAssignment {
    /// The number of the source that is written.
    pub target: usize,
    /// Computes the value.
    pub value: ValueFn,
    /// Stores the value in the message.
    pub change: FieldSetter,
}

/// Declares a source: the messages that functions read or write by one number.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SourceDeclaration {
    /// The path of their topic.
    pub topic: &'static str,
    /// The name of their type in the type environment.
    pub message: &'static str,
    /// Their publisher; `None` for any.
    pub publisher: Option<&'static str>,
    /// Their host; `None` for this one.
    pub host: Option<&'static str>,
}

impl SourceDeclaration {
    /// The messages of a topic on this host, of any publisher.
    pub const fn own(topic: &'static str, message: &'static str) -> SourceDeclaration {
        SourceDeclaration { topic, message, publisher: None, host: None }
    }

    /// The messages of one publisher.
    pub const fn by(self, publisher: &'static str) -> SourceDeclaration {
        SourceDeclaration { publisher: Some(publisher), ..self }
    }

    /// The messages of another host.
    pub const fn on(self, host: &'static str) -> SourceDeclaration {
        SourceDeclaration { host: Some(host), ..self }
    }

    pub(crate) fn origin(&self) -> Origin {
        match (self.host, self.publisher) {
            (None, None) => Origin::Own,
            (Some(host), None) => Origin::Host(host.into()),
            (None, Some(publisher)) => Origin::Publisher(publisher.into()),
            (Some(host), Some(publisher)) => {
                Origin::HostPublisher { host: host.into(), publisher: publisher.into() }
            }
        }
    }
}
