//! Executable content: the children of `<onentry>`, `<onexit>`, `<transition>` and `<finalize>`.

use super::compiled_text::{CompiledText, LiteralOrExpression};
use super::language::{Location, ScriptExpression, ScriptProgram};

/// Contents that are executed in order, up to the first that fails.
pub(crate) type Block = Vec<ExecutableContent>;

/// One executable content.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum ExecutableContent {
    /// `<raise event="e"/>`
    Raise(String),
    /// `<if cond="c"> … <elseif cond="d"/> … <else/> … </if>`; the last branch may be without
    /// condition.
    If(Vec<(Option<CompiledText<ScriptExpression>>, Block)>),
    /// `<foreach array="a" item="i" index="n"> … </foreach>`
    Foreach { array: CompiledText<ScriptExpression>, item: String, index: Option<String>, block: Block },
    /// `<log label="l" expr="e"/>`
    Log { label: Option<String>, value: Option<CompiledText<ScriptExpression>> },
    /// `<assign location="a" expr="e"/>`
    Assign { location: CompiledText<Location>, value: ValueSource },
    /// `<script> … </script>`
    Script(ScriptSource),
    /// `<send …/>`
    Send(Box<Send>),
    /// `<cancel sendid="s"/>`
    Cancel(LiteralOrExpression),
}

/// Source of a value.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum ValueSource {
    /// No value.
    Nothing,
    /// `expr="e"`
    Expression(CompiledText<ScriptExpression>),
    /// Text between the tags: JSON, a function, or else a text with normalised blanks.
    Text(String),
    /// An `<scxml>` element between the tags, as text: a document to invoke.
    Document(String),
    /// `src="uri"`
    Uri(String),
}

/// A script, inside or outside of the document.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum ScriptSource {
    Inline(CompiledText<ScriptProgram>),
    Uri(String),
}

/// `<send>`
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Send {
    pub(crate) event: Option<LiteralOrExpression>,
    pub(crate) target: Option<LiteralOrExpression>,
    pub(crate) kind: Option<LiteralOrExpression>,
    pub(crate) id: Option<String>,
    pub(crate) id_location: Option<CompiledText<Location>>,
    pub(crate) delay: Option<LiteralOrExpression>,
    pub(crate) payload: Payload,
}

/// The data of an event: named values, or one value.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Payload {
    /// `namelist="a b"`
    pub(crate) names: Vec<CompiledText<Location>>,
    /// `<param name="n" expr="e"/>`
    pub(crate) parameters: Vec<Parameter>,
    /// `<content expr="e"/>` or `<content> … </content>`
    pub(crate) content: Option<ValueSource>,
}

/// `<param>`
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Parameter {
    pub(crate) name: String,
    pub(crate) value: ParameterValue,
}

/// `expr` or `location` of a `<param>`.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum ParameterValue {
    Expression(CompiledText<ScriptExpression>),
    Location(CompiledText<Location>),
}

/// `<invoke>`
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Invoke {
    pub(crate) kind: Option<LiteralOrExpression>,
    pub(crate) source: Option<LiteralOrExpression>,
    pub(crate) content: Option<InlineDocument>,
    pub(crate) id: Option<String>,
    pub(crate) id_location: Option<CompiledText<Location>>,
    pub(crate) names: Vec<CompiledText<Location>>,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) autoforward: bool,
    pub(crate) finalize: Option<Block>,
}

/// The document to invoke, if it is given between the tags.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum InlineDocument {
    /// `<content expr="e"/>`: an expression whose text is a document.
    Expression(CompiledText<ScriptExpression>),
    /// `<content><scxml> … </scxml></content>`, as text.
    Document(String),
}
