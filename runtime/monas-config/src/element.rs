//! Elements of a configuration with their locations, in either language.

use std::sync::Arc;

use yase::{Diagnostic, Source, Span};

/// Origin of a value; later layers override earlier ones.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
pub enum Layer {
    /// The default of the grammar.
    Default,
    /// The configuration file.
    #[default]
    File,
    /// Settings of one robot.
    Robot,
    /// The command line.
    CommandLine,
}

impl Layer {
    /// The name of the layer.
    pub const fn name(self) -> &'static str {
        match self {
            Layer::Default => "default",
            Layer::File => "file",
            Layer::Robot => "robot",
            Layer::CommandLine => "command line",
        }
    }
}

/// An element with its contents. Comments are not kept.
#[derive(Clone, Debug)]
pub struct Element {
    pub(crate) name: String,
    pub(crate) name_span: Span,
    pub(crate) span: Span,
    pub(crate) attributes: Vec<Attribute>,
    pub(crate) children: Vec<Element>,
    pub(crate) text: String,
    pub(crate) text_span: Span,
    pub(crate) source: Arc<Source>,
    pub(crate) layer: Layer,
}

/// An attribute of an element.
#[derive(Clone, Debug)]
pub struct Attribute {
    /// Its name as written.
    pub name: String,
    /// The location of its name.
    pub name_span: Span,
    /// Its value, with entities replaced.
    pub value: String,
    /// The location of its value, without quotes.
    pub value_span: Span,
    /// The text it is in; that of its element unless a layer overrides it.
    pub source: Arc<Source>,
    /// The layer it comes from.
    pub layer: Layer,
}

impl Attribute {
    /// An error at its value.
    pub fn error(&self, code: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(code, self.value_span, message).in_source(&self.source)
    }

    /// An error at its name.
    pub fn name_error(&self, code: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(code, self.name_span, message).in_source(&self.source)
    }

    /// Whether its name is `key`, in snake case or in the spelling of the thesis.
    pub fn is(&self, key: &str) -> bool {
        is_written(&self.name, key)
    }
}

impl Element {
    /// Its name as written.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The location of its name.
    pub fn name_span(&self) -> Span {
        self.name_span
    }

    /// Its location, from the start of its opening tag to the end of its closing tag.
    pub fn span(&self) -> Span {
        self.span
    }

    /// The text directly in it, trimmed.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The location of that text; that of its name if there is none.
    pub fn text_span(&self) -> Span {
        self.text_span
    }

    /// The text it is in.
    pub fn source(&self) -> &Arc<Source> {
        &self.source
    }

    /// The layer it comes from.
    pub fn layer(&self) -> Layer {
        self.layer
    }

    /// Its attributes in the order of the file.
    pub fn attributes(&self) -> &[Attribute] {
        &self.attributes
    }

    /// Its elements in the order of the file.
    pub fn children(&self) -> &[Element] {
        &self.children
    }

    /// Whether its name is `name`, in snake case or in the spelling of the thesis.
    pub fn is(&self, name: &str) -> bool {
        is_written(&self.name, name)
    }

    /// Its elements of one name.
    pub fn children_named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |child| child.is(name))
    }

    /// The attribute with that key, if present.
    pub fn attribute(&self, key: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.is(key))
    }

    /// An error at a location in this element's text.
    pub fn error(&self, code: &'static str, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(code, span, message).in_source(&self.source)
    }

    /// An element that is not written: all its values are defaults. The source is that of the text
    /// it would be part of.
    pub fn new(name: &str, source: &Arc<Source>) -> Element {
        Element {
            name: name.to_owned(),
            name_span: Span::default(),
            span: Span::default(),
            attributes: Vec::new(),
            children: Vec::new(),
            text: String::new(),
            text_span: Span::default(),
            source: source.clone(),
            layer: Layer::Default,
        }
    }

    /// The same element with each child changed.
    pub fn map_children(mut self, change: &mut dyn FnMut(Element) -> Element) -> Element {
        self.children = std::mem::take(&mut self.children).into_iter().map(change).collect();
        self
    }

    /// The same element without children.
    pub fn without_children(mut self) -> Element {
        self.children.clear();
        self
    }

    /// The same element with these children.
    pub fn with_children(mut self, children: impl IntoIterator<Item = Element>) -> Element {
        self.children.extend(children);
        self
    }
}

/// Whether a name in a file is that key: in snake case, or in the spelling of the thesis
/// (`IsRealTime` for `is_real_time`).
pub fn is_written(name: &str, key: &str) -> bool {
    name == key || letters_of_camel_case(key).eq(name.chars())
}

/// A key in the spelling of the thesis.
pub(crate) fn camel_case(key: &str) -> String {
    letters_of_camel_case(key).collect()
}

fn letters_of_camel_case(key: &str) -> impl Iterator<Item = char> {
    key.split('_').flat_map(capitalised)
}

fn capitalised(word: &str) -> impl Iterator<Item = char> {
    word.chars()
        .enumerate()
        .map(|(index, letter)| if index == 0 { letter.to_ascii_uppercase() } else { letter })
}

/// A list of words in prose: `a`, `b` or `c`.
pub(crate) fn listed(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => "nothing".into(),
    }
}
