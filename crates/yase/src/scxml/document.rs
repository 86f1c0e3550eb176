//! A document as it was understood.

use super::content::{Invoke, Payload, Script, Source};
use crate::statechart::{NodeId, Statechart};

/// An SCXML document: a statechart, and what a [`Session`](super::Session) needs beside it.
///
/// Whatever a chart can say for itself is in the [`statechart`](Document::statechart): states, histories, transitions, triggers, conditions
/// made of `In()`, raised events. Other conditions and contents stand in it as scripts, which only a session understands.
#[derive(Clone, PartialEq, Debug)]
pub struct Document {
    /// `_name`, if the document has a name.
    pub name: Option<String>,
    /// The language of its expressions.
    pub data_model: DataModel,
    /// When variables get their first values.
    pub binding: Binding,
    pub(crate) statechart: Statechart,
    pub(crate) data: Vec<Declaration>,
    pub(crate) script: Option<Script>,
    pub(crate) invokes: Vec<(NodeId, Invoke)>,
    pub(crate) done_data: Vec<(NodeId, Payload)>,
}

/// The language of a document's expressions.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum DataModel {
    /// `null`: nothing but `In()`.
    Null,
    /// `ecmascript`: the subset that [`scxml`](super) describes.
    Ecmascript,
}

/// When variables get their first values.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Binding {
    /// All when the session starts.
    Early,
    /// Those of a state when it is entered for the first time.
    Late,
}

/// `<data>`
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Declaration {
    pub(crate) state: NodeId,
    pub(crate) name: String,
    pub(crate) value: Source,
}

impl Document {
    /// The chart: nodes named by the ids of the document's states, scripts where it says what a chart alone cannot.
    pub fn statechart(&self) -> &Statechart {
        &self.statechart
    }

    /// How many variables are declared.
    pub fn variables(&self) -> usize {
        self.data.len()
    }
}

impl From<Statechart> for Document {
    /// The document of a chart that has no data; its scripts are conditions and contents in ECMAScript.
    fn from(statechart: Statechart) -> Document {
        let scripts = super::guard::uses_scripts(&statechart);
        Document {
            name: Some(statechart.name.clone()).filter(|name| !name.is_empty()),
            data_model: if scripts { DataModel::Ecmascript } else { DataModel::Null },
            binding: Binding::Early,
            statechart,
            data: Vec::new(),
            script: None,
            invokes: Vec::new(),
            done_data: Vec::new(),
        }
    }
}
