//! The grammar of configurations: one table of elements.
//!
//! The readers of XML and TOML, the option `--set`, `monas config show` and the schemas for editors
//! all use a [`Grammar`], so that they agree. Crates that add elements start from
//! [`Grammar::agents`]:
//!
//! ```
//! use monas_config::{AttributeRule, ElementRule, Grammar, Kind};
//!
//! let lamp = ElementRule::new("lamp", "a lamp on a shelf")
//!     .attribute(AttributeRule::new("watts", Kind::number_from(0.0), "how bright it is").or("5"));
//! let grammar = Grammar::agents().root(lamp);
//! let source = yase::Source::new("lamps.toml", "[[lamp]]\nwats = 3\n");
//! let (_, diagnostics) = grammar.read(&source);
//! assert_eq!(
//!     diagnostics[0].to_string(),
//!     "lamps.toml:2:1: error[E0304]: unknown attribute `wats` of `lamp` (did you mean `watts`?)"
//! );
//! ```

mod agents;
mod check;
mod kind;

use std::borrow::Cow;
use std::sync::Arc;

use yase::{Diagnostic, Source};

use super::element::Element;
use super::{toml, xml};

pub use kind::Kind;
pub(crate) use kind::flag;

/// The elements of configurations.
#[derive(Clone, Debug, Default)]
pub struct Grammar {
    elements: Vec<ElementRule>,
    roots: Vec<&'static str>,
}

/// The contents of an element.
#[derive(Clone, Debug)]
pub struct ElementRule {
    pub(crate) name: &'static str,
    pub(crate) doc: &'static str,
    pub(crate) text: Option<TextRule>,
    pub(crate) attributes: Vec<AttributeRule>,
    pub(crate) children: Vec<ChildRule>,
    pub(crate) takes_parameters: bool,
    pub(crate) is_group: bool,
    pub(crate) is_layer: bool,
    pub(crate) identity: Identity,
    pub(crate) default: Option<String>,
}

/// The text in an element.
#[derive(Clone, Debug)]
pub(crate) struct TextRule {
    /// Its key in TOML, for an element with attributes.
    pub(crate) key: &'static str,
    pub(crate) kind: Kind,
}

/// An element in an element.
#[derive(Clone, Debug)]
pub(crate) struct ChildRule {
    pub(crate) name: &'static str,
    pub(crate) is_required: bool,
    pub(crate) is_single: bool,
}

/// An attribute of an element.
#[derive(Clone, Debug)]
pub struct AttributeRule {
    pub(crate) key: Cow<'static, str>,
    pub(crate) kind: Kind,
    pub(crate) doc: &'static str,
    pub(crate) is_required: bool,
    pub(crate) default: Option<String>,
    pub(crate) alias: Option<&'static str>,
}

/// Identity of elements with the same name.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Identity {
    /// At most one element, or no identity.
    #[default]
    None,
    /// Their text.
    Text,
    /// The text of this element in them.
    Child(&'static str),
    /// This attribute.
    Attribute(&'static str),
}

impl Grammar {
    /// Adds an element that may stand at the root of a file.
    pub fn root(mut self, element: ElementRule) -> Grammar {
        self.roots.push(element.name);
        self.with(element)
    }

    /// Adds an element that stands in others.
    pub fn with(mut self, element: ElementRule) -> Grammar {
        self.elements.push(element);
        self
    }

    /// The names of root elements.
    pub fn roots(&self) -> &[&'static str] {
        &self.roots
    }

    /// Every element, in the order of their addition.
    pub fn elements(&self) -> &[ElementRule] {
        &self.elements
    }

    /// The element of that name, written either way.
    pub fn element(&self, name: &str) -> Option<&ElementRule> {
        self.elements.iter().find(|element| super::element::is_written(name, element.name))
    }

    /// Parses a text, as TOML if its name ends with `.toml`, otherwise as XML, and reports
    /// everything the grammar does not allow. The meaning of the elements is not checked.
    pub fn read(&self, source: &Arc<Source>) -> (Vec<Element>, Vec<Diagnostic>) {
        let (elements, mut diagnostics) = self.parse(source);
        self.check(&elements, &mut diagnostics);
        (elements, diagnostics)
    }

    /// As [`read`](Grammar::read), without checking the grammar.
    pub fn parse(&self, source: &Arc<Source>) -> (Vec<Element>, Vec<Diagnostic>) {
        match crate::is_toml_text(source) {
            true => toml::parse(source, self),
            false => xml::parse(source),
        }
    }
}

impl ElementRule {
    /// An element without text, attributes and children; `doc` describes it.
    pub fn new(name: &'static str, doc: &'static str) -> ElementRule {
        ElementRule {
            name,
            doc,
            text: None,
            attributes: Vec::new(),
            children: Vec::new(),
            takes_parameters: false,
            is_group: false,
            is_layer: false,
            identity: Identity::None,
            default: None,
        }
    }

    /// Allows text of this kind. Its key in TOML is `key` if the element has attributes.
    pub fn text(mut self, key: &'static str, kind: Kind) -> ElementRule {
        self.text = Some(TextRule { key, kind });
        self
    }

    /// Sets the default of an element that contains only a text.
    pub fn or(mut self, default: impl Into<String>) -> ElementRule {
        self.default = Some(default.into());
        self
    }

    /// Adds an attribute.
    pub fn attribute(mut self, attribute: AttributeRule) -> ElementRule {
        self.attributes.push(attribute);
        self
    }

    /// Adds attributes.
    pub fn attributes(mut self, attributes: impl IntoIterator<Item = AttributeRule>) -> ElementRule {
        self.attributes.extend(attributes);
        self
    }

    /// Allows any number of children of that name.
    pub fn children(self, name: &'static str) -> ElementRule {
        self.child_rule(name, false, false)
    }

    /// Allows at most one child of that name.
    pub fn child(self, name: &'static str) -> ElementRule {
        self.child_rule(name, false, true)
    }

    /// Requires exactly one child of that name.
    pub fn required_child(self, name: &'static str) -> ElementRule {
        self.child_rule(name, true, true)
    }

    fn child_rule(mut self, name: &'static str, is_required: bool, is_single: bool) -> ElementRule {
        self.children.push(ChildRule { name, is_required, is_single });
        self
    }

    /// Allows any other attribute as a parameter, which the named item checks.
    pub fn with_parameters(mut self) -> ElementRule {
        self.takes_parameters = true;
        self
    }

    /// Makes it a group: its children count as siblings.
    pub fn group(mut self) -> ElementRule {
        self.is_group = true;
        self
    }

    /// Makes it a layer: its children override the elements they name.
    pub fn layer(mut self) -> ElementRule {
        self.is_layer = true;
        self
    }

    /// Sets its identity.
    pub fn identified_by(mut self, identity: Identity) -> ElementRule {
        self.identity = identity;
        self
    }

    /// Its name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Whether it allows this text.
    pub fn allows_text(&self, text: &str) -> bool {
        self.text.as_ref().is_some_and(|rule| rule.kind.allows(text))
    }

    /// The attribute of that name, in any spelling.
    pub fn attribute_named(&self, name: &str) -> Option<&AttributeRule> {
        self.attributes.iter().find(|attribute| attribute.is(name))
    }

    /// The child of that name, in either spelling.
    pub(crate) fn child_named(&self, name: &str) -> Option<&ChildRule> {
        self.children.iter().find(|child| super::element::is_written(name, child.name))
    }

    /// The identity of this element.
    pub(crate) fn identity_of<'a>(&self, element: &'a Element) -> Option<&'a str> {
        match self.identity {
            Identity::None => None,
            Identity::Text => Some(element.text()),
            Identity::Child(name) => element.children_named(name).next().map(Element::text),
            Identity::Attribute(key) => element.attribute(key).map(|given| &*given.value),
        }
    }
}

impl AttributeRule {
    /// An optional attribute; `doc` describes it.
    pub fn new(key: impl Into<Cow<'static, str>>, kind: Kind, doc: &'static str) -> AttributeRule {
        AttributeRule { key: key.into(), kind, doc, is_required: false, default: None, alias: None }
    }

    /// Makes it required.
    pub fn required(mut self) -> AttributeRule {
        self.is_required = true;
        self
    }

    /// Sets its default.
    pub fn or(mut self, default: impl Into<String>) -> AttributeRule {
        self.default = Some(default.into());
        self
    }

    /// Adds a shorter name.
    pub fn alias(mut self, alias: &'static str) -> AttributeRule {
        self.alias = Some(alias);
        self
    }

    /// Whether a name in a file means it.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// The kind of its values.
    pub fn kind(&self) -> &Kind {
        &self.kind
    }

    pub(crate) fn is(&self, name: &str) -> bool {
        let is_written = super::element::is_written;
        is_written(name, &self.key) || self.alias.is_some_and(|alias| is_written(name, alias))
    }
}
