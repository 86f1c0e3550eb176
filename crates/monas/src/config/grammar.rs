//! What may be written in a configuration: one table of elements.
//!
//! The readers of XML and of TOML, the command line's `--set`, `monas config show` and the schemas for editors all go by a
//! [`Grammar`], so that they cannot disagree. Crates that add elements of their own start from [`Grammar::agents`]:
//!
//! ```
//! use monas::config::{AttributeRule, ElementRule, Grammar, Kind};
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

use std::path::Path;
use std::sync::Arc;

use yase::{Diagnostic, Source};

use super::element::Element;
use super::{toml, xml};

pub use kind::Kind;
pub(super) use kind::{duration, flag};

/// The elements that a configuration may hold.
#[derive(Clone, Debug, Default)]
pub struct Grammar {
    elements: Vec<ElementRule>,
    roots: Vec<&'static str>,
}

/// What may stand in an element.
#[derive(Clone, Debug)]
pub struct ElementRule {
    pub(super) name: &'static str,
    pub(super) doc: &'static str,
    pub(super) text: Option<TextRule>,
    pub(super) attributes: Vec<AttributeRule>,
    pub(super) children: Vec<ChildRule>,
    pub(super) takes_parameters: bool,
    pub(super) is_group: bool,
    pub(super) is_layer: bool,
    pub(super) identity: Identity,
    pub(super) default: Option<String>,
}

/// The text in an element.
#[derive(Clone, Debug)]
pub(super) struct TextRule {
    /// What TOML calls it, where an element has attributes too.
    pub(super) key: &'static str,
    pub(super) kind: Kind,
}

/// An element in an element.
#[derive(Clone, Debug)]
pub(super) struct ChildRule {
    pub(super) name: &'static str,
    pub(super) is_required: bool,
    pub(super) is_single: bool,
}

/// An attribute of an element.
#[derive(Clone, Debug)]
pub struct AttributeRule {
    pub(super) key: &'static str,
    pub(super) kind: Kind,
    pub(super) doc: &'static str,
    pub(super) is_required: bool,
    pub(super) default: Option<String>,
    pub(super) alias: Option<&'static str>,
}

/// What tells elements of one name apart.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Identity {
    /// There is one at most, or they cannot be told apart.
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

    /// The elements that may stand at the root of a file.
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

    /// Reads a text: as TOML if its name ends with `.toml`, as XML otherwise. Everything that the grammar does not allow is said;
    /// what the elements mean is for others to say.
    pub fn read(&self, source: &Arc<Source>) -> (Vec<Element>, Vec<Diagnostic>) {
        let (elements, mut diagnostics) = self.parse(source);
        self.check(&elements, &mut diagnostics);
        (elements, diagnostics)
    }

    /// As [`read`](Grammar::read), without a look at what the grammar allows.
    pub fn parse(&self, source: &Arc<Source>) -> (Vec<Element>, Vec<Diagnostic>) {
        match Path::new(&source.name).extension().is_some_and(|extension| extension == "toml") {
            true => toml::parse(source, self),
            false => xml::parse(source),
        }
    }
}

impl ElementRule {
    /// An element without text, attributes and elements; `doc` says what it is.
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

    /// Text of this kind in it. TOML calls it `key` where there are attributes beside it.
    pub fn text(mut self, key: &'static str, kind: Kind) -> ElementRule {
        self.text = Some(TextRule { key, kind });
        self
    }

    /// What holds if it is not given, for one that has nothing but a text.
    pub fn or(mut self, default: impl Into<String>) -> ElementRule {
        self.default = Some(default.into());
        self
    }

    /// One more attribute.
    pub fn attribute(mut self, attribute: AttributeRule) -> ElementRule {
        self.attributes.push(attribute);
        self
    }

    /// More attributes.
    pub fn attributes(mut self, attributes: impl IntoIterator<Item = AttributeRule>) -> ElementRule {
        self.attributes.extend(attributes);
        self
    }

    /// Any number of elements of that name in it.
    pub fn children(self, name: &'static str) -> ElementRule {
        self.child_rule(name, false, false)
    }

    /// At most one element of that name in it.
    pub fn child(self, name: &'static str) -> ElementRule {
        self.child_rule(name, false, true)
    }

    /// Just one element of that name in it.
    pub fn required_child(self, name: &'static str) -> ElementRule {
        self.child_rule(name, true, true)
    }

    fn child_rule(mut self, name: &'static str, is_required: bool, is_single: bool) -> ElementRule {
        self.children.push(ChildRule { name, is_required, is_single });
        self
    }

    /// Any other attribute is a parameter of what it names: who takes it checks it.
    pub fn with_parameters(mut self) -> ElementRule {
        self.takes_parameters = true;
        self
    }

    /// It only holds others, which count as standing where it stands.
    pub fn group(mut self) -> ElementRule {
        self.is_group = true;
        self
    }

    /// What stands in it goes over what it names: it is no part of its own.
    pub fn layer(mut self) -> ElementRule {
        self.is_layer = true;
        self
    }

    /// What tells it from others of its name.
    pub fn identified_by(mut self, identity: Identity) -> ElementRule {
        self.identity = identity;
        self
    }

    /// Its name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Whether a text may stand in it.
    pub fn allows_text(&self, text: &str) -> bool {
        self.text.as_ref().is_some_and(|rule| rule.kind.allows(text))
    }

    /// The attribute of that name, written in any way.
    pub(crate) fn attribute_named(&self, name: &str) -> Option<&AttributeRule> {
        self.attributes.iter().find(|attribute| attribute.is(name))
    }

    /// The element in it of that name, written either way.
    pub(super) fn child_named(&self, name: &str) -> Option<&ChildRule> {
        self.children.iter().find(|child| super::element::is_written(name, child.name))
    }

    /// What tells this element from others of its name.
    pub(super) fn identity_of<'a>(&self, element: &'a Element) -> Option<&'a str> {
        match self.identity {
            Identity::None => None,
            Identity::Text => Some(element.text()),
            Identity::Child(name) => element.children_named(name).next().map(Element::text),
            Identity::Attribute(key) => element.attribute(key).map(|given| &*given.value),
        }
    }
}

impl AttributeRule {
    /// An attribute that may be left out; `doc` says what it means.
    pub fn new(key: &'static str, kind: Kind, doc: &'static str) -> AttributeRule {
        AttributeRule { key, kind, doc, is_required: false, default: None, alias: None }
    }

    /// It must be given.
    pub fn required(mut self) -> AttributeRule {
        self.is_required = true;
        self
    }

    /// What holds if it is not given.
    pub fn or(mut self, default: impl Into<String>) -> AttributeRule {
        self.default = Some(default.into());
        self
    }

    /// A shorter name that is understood too.
    pub fn alias(mut self, alias: &'static str) -> AttributeRule {
        self.alias = Some(alias);
        self
    }

    /// Whether a name in a file means it.
    pub(crate) fn key(&self) -> &'static str {
        self.key
    }

    pub(crate) fn kind(&self) -> &Kind {
        &self.kind
    }

    pub(super) fn is(&self, name: &str) -> bool {
        let is_written = super::element::is_written;
        is_written(name, self.key) || self.alias.is_some_and(|alias| is_written(name, alias))
    }
}
