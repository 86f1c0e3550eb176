//! Messages, functions and activities of the program that runs a chart.

use std::collections::{BTreeMap, BTreeSet};

use yase::TypeEnvironment;

/// The symbols of a program and its activities.
#[derive(Clone, Debug, Default)]
pub struct ProgramSymbols {
    /// Topics, messages, enumerations and functions.
    pub vocabulary: TypeEnvironment,
    /// The paths of the topics that each activity publishes, if it declares them.
    pub activities: BTreeMap<String, Option<BTreeSet<String>>>,
    /// The paths of the topics that each activity reads, if it declares them.
    pub readers: BTreeMap<String, Option<BTreeSet<String>>>,
    /// The paths of the topics that are published or read outside activities: by bodies or the
    /// runtime.
    pub elsewhere: BTreeSet<String>,
}
