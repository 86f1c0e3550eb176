//! Messages, functions and activities of the program that runs a chart.

use std::collections::{BTreeMap, BTreeSet};

use yase::TypeEnvironment;

/// The words of a program and its activities.
#[derive(Clone, Debug, Default)]
pub struct ProgramSymbols {
    /// Topics, messages, enumerations and functions.
    pub vocabulary: TypeEnvironment,
    /// Each activity, and the paths of the topics that it publishes, if it says so.
    pub activities: BTreeMap<String, Option<BTreeSet<String>>>,
    /// The paths of the topics that each activity reads, if it says so.
    pub readers: BTreeMap<String, Option<BTreeSet<String>>>,
    /// The paths of the topics that others than activities publish or read: bodies, the runtime.
    pub elsewhere: BTreeSet<String>,
}
