//! A parsed document.

use super::content::{Invoke, Payload, ScriptSource, ValueSource};
use yase::statechart::{NodeId, Statechart};

/// An SCXML document: a statechart, and the data that a [`Session`](super::Session) needs beside
/// it.
///
/// The [`statechart`](Document::statechart) contains everything that a chart can express: states,
/// histories, transitions, triggers, conditions made of `In()`, raised events. Other conditions and
/// contents are scripts, which only a session can execute.
#[derive(Clone, PartialEq, Debug)]
pub struct Document {
    /// `_name`, if the document has a name.
    pub name: Option<String>,
    /// The language of its expressions.
    pub data_model: DataModel,
    /// When variables are initialised.
    pub binding: DataBinding,
    pub(crate) statechart: Statechart,
    pub(crate) data: Vec<DataDeclaration>,
    pub(crate) script: Option<ScriptSource>,
    pub(crate) invokes: Vec<(NodeId, Invoke)>,
    pub(crate) done_data: Vec<(NodeId, Payload)>,
}

/// The language of a document's expressions.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum DataModel {
    /// `null`: only `In()`.
    Null,
    /// `ecmascript`: the subset described in [`scxml`](super).
    Ecmascript,
}

/// When variables are initialised.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DataBinding {
    /// All when the session starts.
    Early,
    /// Those of a state when it is entered for the first time.
    Late,
}

/// `<data>`
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct DataDeclaration {
    pub(crate) state: NodeId,
    pub(crate) name: String,
    pub(crate) value: ValueSource,
}

impl Document {
    /// The chart: nodes have the ids of the document's states, and scripts replace everything that
    /// a chart cannot express.
    pub fn statechart(&self) -> &Statechart {
        &self.statechart
    }

    /// The number of declared variables.
    pub fn variables(&self) -> usize {
        self.data.len()
    }
}

impl From<Statechart> for Document {
    /// The document of a chart without data; its scripts are conditions and contents in ECMAScript.
    fn from(statechart: Statechart) -> Document {
        let scripts = super::guard::uses_scripts(&statechart);
        Document {
            name: Some(statechart.name.clone()).filter(|name| !name.is_empty()),
            data_model: if scripts { DataModel::Ecmascript } else { DataModel::Null },
            binding: DataBinding::Early,
            statechart,
            data: Vec::new(),
            script: None,
            invokes: Vec::new(),
            done_data: Vec::new(),
        }
    }
}
