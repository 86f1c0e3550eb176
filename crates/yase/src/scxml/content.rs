//! Executable content: what `<onentry>`, `<onexit>`, `<transition>` and `<finalize>` hold.

use super::code::{Code, Given};
use super::language::{Expression, Location, Program};

/// Contents that are executed in order, up to the first that fails.
pub(crate) type Block = Vec<Content>;

/// One executable content.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Content {
    /// `<raise event="e"/>`
    Raise(String),
    /// `<if cond="c"> … <elseif cond="d"/> … <else/> … </if>`; the last branch may be without condition.
    If(Vec<(Option<Code<Expression>>, Block)>),
    /// `<foreach array="a" item="i" index="n"> … </foreach>`
    Foreach { array: Code<Expression>, item: String, index: Option<String>, block: Block },
    /// `<log label="l" expr="e"/>`
    Log { label: Option<String>, value: Option<Code<Expression>> },
    /// `<assign location="a" expr="e"/>`
    Assign { location: Code<Location>, value: Source },
    /// `<script> … </script>`
    Script(Script),
    /// `<send …/>`
    Send(Box<Send>),
    /// `<cancel sendid="s"/>`
    Cancel(Given),
}

/// Where a value comes from.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Source {
    /// Nowhere: there is no value.
    Nothing,
    /// `expr="e"`
    Expression(Code<Expression>),
    /// Text between the tags: JSON, a function, or else a text whose blanks are normalised.
    Text(String),
    /// An `<scxml>` element between the tags, as text: a document to invoke.
    Document(String),
    /// `src="uri"`
    Uri(String),
}

/// A script, in the document or elsewhere.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Script {
    Inline(Code<Program>),
    Uri(String),
}

/// `<send>`
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Send {
    pub(crate) event: Option<Given>,
    pub(crate) target: Option<Given>,
    pub(crate) kind: Option<Given>,
    pub(crate) id: Option<String>,
    pub(crate) id_location: Option<Code<Location>>,
    pub(crate) delay: Option<Given>,
    pub(crate) payload: Payload,
}

/// What an event carries: named values, or one value.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Payload {
    /// `namelist="a b"`
    pub(crate) names: Vec<Code<Location>>,
    /// `<param name="n" expr="e"/>`
    pub(crate) parameters: Vec<Parameter>,
    /// `<content expr="e"/>` or `<content> … </content>`
    pub(crate) content: Option<Source>,
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
    Expression(Code<Expression>),
    Location(Code<Location>),
}

/// `<invoke>`
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Invoke {
    pub(crate) kind: Option<Given>,
    pub(crate) source: Option<Given>,
    pub(crate) content: Option<Inner>,
    pub(crate) id: Option<String>,
    pub(crate) id_location: Option<Code<Location>>,
    pub(crate) names: Vec<Code<Location>>,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) autoforward: bool,
    pub(crate) finalize: Option<Block>,
}

/// The document that is invoked, when it stands between the tags.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Inner {
    /// `<content expr="e"/>`: a text that is a document.
    Expression(Code<Expression>),
    /// `<content><scxml> … </scxml></content>`, as text.
    Document(String),
}
