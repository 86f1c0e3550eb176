//! The ontology of a chart: the messages and fields that its expressions use.
//!
//! A chart's variables name message types (`worldstate.State.GameStateMessage`), and its
//! expressions use their fields. [`of`] collects both: the messages, their topics, and the types of
//! fields as far as their use determines them. [`Ontology::to_proto`] writes them as an initial
//! `.proto` file; [`check`] compares the variables with the messages of a program.
//!
//! A message is the first name of a path that begins with a capital letter, or the one after
//! `State`, `Signal` or `Data`. A field that is calculated with or compared with a number is a
//! number, one that is compared with a text is a text, one that is compared with a constant is of
//! its kind, one that is compared with another bare name is an enumeration with that value; any
//! other field is a boolean. Fields of a message with a value in common have one enumeration.
//!
//! ```
//! let (chart, _) = aseme_models::statechart_of(&yase::Source::new("dog", "Role: dog\nLiveness:\ndog = Sit . Bark\nTransitions:\nSit -> Bark : [Cat.distance < 2 && Cat.mood == LAZY]\n"));
//! let (ontology, found) = aseme_models::ontology::of(&chart, &[]);
//! assert!(found.is_empty());
//! assert!(ontology.to_proto("pets").ends_with("\
//! message Cat {
//!   // The values of `mood`.
//!   enum Mood {
//!     LAZY = 0;
//!   }
//!   double distance = 1;
//!   Mood mood = 2;
//! }
//! "));
//! ```

mod gather;
mod proto;

use std::collections::BTreeMap;

use yase::vocabulary::TopicKind;
use yase::{Diagnostic, Statechart, TypeEnvironment};

use crate::iac::{Iac, Variable};
use gather::Gatherer;

/// The messages that a chart uses, in the order of their first use.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Ontology {
    /// The messages.
    pub messages: Vec<OntologyMessage>,
}

/// A message that a chart uses.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct OntologyMessage {
    /// Its name.
    pub name: String,
    /// Its topics, where the chart names them.
    pub topics: Vec<OntologyTopic>,
    /// The fields that are used.
    pub fields: Vec<OntologyField>,
}

/// A topic, as a path or a variable's type names it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct OntologyTopic {
    /// Its name.
    pub name: String,
    /// `State`, `Signal` or `Data`.
    pub kind: String,
}

/// A field of a message.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct OntologyField {
    /// Its name.
    pub name: String,
    /// Its kind, as far as its use determines it.
    pub kind: OntologyFieldKind,
}

/// The kind of a field, as far as its use determines it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum OntologyFieldKind {
    /// It is only compared with other fields.
    Unknown,
    /// A condition.
    Condition,
    /// A number.
    Number,
    /// A text.
    Text,
    /// One of these, and perhaps others.
    OneOf(Vec<String>),
    /// It has fields itself.
    Fields(Vec<OntologyField>),
}

/// The ontology of a chart and the variables of its model, with warnings about variables that are
/// no messages or have two kinds.
pub fn of(chart: &Statechart, variables: &[Variable]) -> (Ontology, Vec<Diagnostic>) {
    let mut gatherer = Gatherer::new(chart);
    variables.iter().for_each(|variable| gatherer.variable(variable));
    chart.transitions().for_each(|(_, transition)| gatherer.transition(&transition.expression));
    for (_, node) in chart.nodes() {
        node.entry.iter().chain(&node.exit).for_each(|action| gatherer.action(action));
    }
    gatherer.finish()
}

/// Reports variables that name messages or topics which the program does not have.
pub fn check(variables: &[Variable], vocabulary: &TypeEnvironment) -> Vec<Diagnostic> {
    variables.iter().filter_map(|variable| fits(variable, vocabulary)).collect()
}

/// The subjects of each activity: the variables of its states, with their types.
pub fn subjects(chart: &Iac) -> BTreeMap<String, Vec<(String, String)>> {
    let mut subjects: BTreeMap<String, Vec<(String, String)>> = BTreeMap::new();
    for node in chart.nodes.iter().filter(|node| !node.variables.is_empty()) {
        let activity = node.refinement.activity.as_ref().unwrap_or(&node.name);
        let known = subjects.entry(activity.clone()).or_default();
        for variable in node.variables.iter().filter_map(|&index| chart.variables.get(index)) {
            let subject = (variable.name.clone(), variable.kind.clone());
            if !known.contains(&subject) {
                known.push(subject);
            }
        }
    }
    subjects
}

fn fits(variable: &Variable, vocabulary: &TypeEnvironment) -> Option<Diagnostic> {
    let (topic, kind, message) = parts(&variable.kind)?;
    let (span, name) = (variable.position.0, &variable.name);
    if !vocabulary.messages.iter().any(|known| known.name == message) {
        let names = vocabulary.messages.iter().map(|known| known.name.as_str());
        let text = format!("the variable `{name}` has the unknown message type `{message}`");
        return Some(Diagnostic::error("E0881", span, text).with_nearest(message, names));
    }
    let known = vocabulary
        .topics
        .iter()
        .find(|known| known.path.rsplit('/').next().is_some_and(|last| last == topic))?;
    if known.message != message {
        let text = format!(
            "the variable `{name}` is of `{message}`, but `{}` carries `{}`",
            known.path, known.message
        );
        return Some(Diagnostic::error("E0882", span, text));
    }
    let is_kept = kind_word(known.kind);
    (is_kept != kind).then(|| {
        let text =
            format!("the variable `{name}` has the retention `{kind}`, but `{}` has `{is_kept}`", known.path);
        Diagnostic::error("E0883", span, text)
    })
}

fn kind_word(kind: TopicKind) -> &'static str {
    match kind {
        TopicKind::State => "State",
        TopicKind::Signal => "Signal",
        TopicKind::Data => "Data",
    }
}

/// Topic, kind and message of a type `topic.Kind.Message`.
fn parts(kind: &str) -> Option<(&str, &str, &str)> {
    let (front, message) = kind.rsplit_once('.')?;
    let (topic, kind) = front.rsplit_once('.')?;
    (is_kind(kind) && !topic.is_empty() && !message.is_empty()).then_some((topic, kind, message))
}

fn is_kind(word: &str) -> bool {
    matches!(word, "State" | "Signal" | "Data")
}

#[cfg(test)]
mod tests;
