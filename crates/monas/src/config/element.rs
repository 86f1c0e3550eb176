//! Elements of a configuration with their places, whichever language they are written in.

use std::sync::Arc;

use yase::{Diagnostic, Source, Span};

/// Where a value comes from; a later layer goes over an earlier one.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
pub enum Layer {
    /// Nobody says it: the grammar has a default.
    Default,
    /// The configuration says it.
    #[default]
    File,
    /// What is said of one robot says it.
    Robot,
    /// The command line says it.
    CommandLine,
}

impl Layer {
    /// The layer in a word or two.
    pub const fn name(self) -> &'static str {
        match self {
            Layer::Default => "default",
            Layer::File => "file",
            Layer::Robot => "robot",
            Layer::CommandLine => "command line",
        }
    }
}

/// An element with what stands in it. Comments are not kept.
#[derive(Clone, Debug)]
pub struct Element {
    pub(super) name: String,
    pub(super) name_span: Span,
    pub(super) span: Span,
    pub(super) attributes: Vec<Attribute>,
    pub(super) children: Vec<Element>,
    pub(super) text: String,
    pub(super) text_span: Span,
    pub(super) source: Arc<Source>,
    pub(super) layer: Layer,
}

/// An attribute of an element.
#[derive(Clone, Debug)]
pub struct Attribute {
    /// Its name as written.
    pub name: String,
    /// Where its name stands.
    pub name_span: Span,
    /// Its value, entities replaced.
    pub value: String,
    /// Where its value stands, without quotes.
    pub value_span: Span,
    /// The text it stands in; that of its element unless a layer went over it.
    pub source: Arc<Source>,
    /// The layer it comes from.
    pub layer: Layer,
}

impl Attribute {
    /// An error about its value.
    pub fn error(&self, code: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(code, self.value_span, message).in_source(&self.source)
    }

    /// An error about its name.
    pub fn name_error(&self, code: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(code, self.name_span, message).in_source(&self.source)
    }

    /// Whether its name is `key`, in snake case or as the thesis writes names.
    pub fn is(&self, key: &str) -> bool {
        is_written(&self.name, key)
    }
}

impl Element {
    /// Its name as written.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where its name stands.
    pub fn name_span(&self) -> Span {
        self.name_span
    }

    /// Where it stands, from the beginning of its opening tag to the end of its closing one.
    pub fn span(&self) -> Span {
        self.span
    }

    /// The text directly in it, blanks around it removed.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Where that text stands; its name's place if there is none.
    pub fn text_span(&self) -> Span {
        self.text_span
    }

    /// The text it stands in.
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

    /// Whether its name is `name`, in snake case or as the thesis writes names.
    pub fn is(&self, name: &str) -> bool {
        is_written(&self.name, name)
    }

    /// Its elements of one name.
    pub fn children_named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |child| child.is(name))
    }

    /// The attribute of that key, if it is given.
    pub fn attribute(&self, key: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.is(key))
    }

    /// An error about a place in this element's text.
    pub fn error(&self, code: &'static str, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(code, span, message).in_source(&self.source)
    }

    /// An element that nobody has written: everything in it has its default. The source says what it would be part of.
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

    /// The same element with each in it changed.
    pub fn map_children(mut self, change: &mut dyn FnMut(Element) -> Element) -> Element {
        self.children = std::mem::take(&mut self.children).into_iter().map(change).collect();
        self
    }

    /// The same element without those in it.
    pub fn without_children(mut self) -> Element {
        self.children.clear();
        self
    }

    /// The same element with these in it.
    pub fn with_children(mut self, children: impl IntoIterator<Item = Element>) -> Element {
        self.children.extend(children);
        self
    }
}

/// Whether a name in a file is that key: in snake case, or as the thesis writes names (`IsRealTime` for `is_real_time`).
pub fn is_written(name: &str, key: &str) -> bool {
    name == key || name == camel_case(key)
}

/// A key as the thesis writes names.
pub(super) fn camel_case(key: &str) -> String {
    key.split('_').flat_map(capitalised).collect()
}

fn capitalised(word: &str) -> impl Iterator<Item = char> {
    word.chars()
        .enumerate()
        .map(|(index, letter)| if index == 0 { letter.to_ascii_uppercase() } else { letter })
}

/// Words as a person lists them: `a`, `b` or `c`.
pub(super) fn listed(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => "nothing".into(),
    }
}
