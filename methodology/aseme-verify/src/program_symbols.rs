//! Messages, functions and activities of the program that runs a chart.

use std::collections::{BTreeMap, BTreeSet};

use yase::TypeEnvironment;
use yase::expression::Path;

/// The symbols of a program and its activities.
#[derive(Clone, Debug, Default)]
pub struct ProgramSymbols {
    /// Topics, messages, enumerations and functions.
    pub vocabulary: TypeEnvironment,
    /// The paths of the topics that each activity publishes, if it declares them.
    pub activities: BTreeMap<String, Option<BTreeSet<String>>>,
    /// The paths of the topics that each activity reads, if it declares them.
    pub readers: BTreeMap<String, Option<BTreeSet<String>>>,
    /// The paths of the topics on whose messages each activity ends, if it waits for any.
    pub ended_by: BTreeMap<String, BTreeSet<String>>,
    /// The paths of the topics that are published or read outside activities: by bodies or the
    /// runtime.
    pub elsewhere: BTreeSet<String>,
}

impl ProgramSymbols {
    /// Whether an activity, a body or the runtime may publish the message that a path names, or one
    /// of whose fields it is. An activity that does not say what it publishes may.
    pub(crate) fn may_publish(&self, path: &Path) -> bool {
        let named = |name: &str| path.segments.iter().any(|it| it.text.rsplit('/').next() == Some(name));
        let is_meant = |topic: &&yase::vocabulary::TopicEntry| {
            named(&topic.message) || topic.path.rsplit('/').next().is_some_and(named)
        };
        self.vocabulary.topics.iter().filter(is_meant).any(|topic| {
            let publishes = |topics: &Option<BTreeSet<String>>| {
                topics.as_ref().is_none_or(|topics| topics.contains(&topic.path))
            };
            self.elsewhere.contains(&topic.path) || self.activities.values().any(publishes)
        })
    }
}
