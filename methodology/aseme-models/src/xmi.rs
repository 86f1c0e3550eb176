//! XMI, the XML in which the Eclipse tools of the method keep their models.
//!
//! Objects refer to each other by their path in the document, `//@nodes.0/@Children.1`, by their
//! index among several roots (`/3` or `#/3`), or by `xmi:id`. [`XmiPaths`] resolves these
//! references.

mod paths;
mod write;

use roxmltree::{Attribute, Node};
use yase::Span;

pub(crate) use aseme::xmi::{decoded, is_xml, parse, tag};
pub(crate) use paths::{XmiPaths, has_many_roots};
pub(crate) use write::{XmiWriter, fits_xml};

/// The namespace of XMI's own attributes.
pub(crate) const XMI: &str = "http://www.omg.org/XMI";

/// The namespace of `xsi:type`.
pub(crate) const XSI: &str = "http://www.w3.org/2001/XMLSchema-instance";

/// The elements in an element.
pub(crate) fn elements<'a, 'input>(node: Node<'a, 'input>) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(|child| child.is_element())
}

/// The attributes of an element that are not XMI's own.
pub(crate) fn features<'a, 'input>(node: Node<'a, 'input>) -> impl Iterator<Item = Attribute<'a, 'input>> {
    let is_own = |namespace: Option<&str>| namespace.is_some_and(|uri| [XMI, XSI].contains(&uri));
    node.attributes().filter(move |attribute| !is_own(attribute.namespace()))
}

/// The span of an attribute's value, without quotes.
pub(crate) fn value_span(attribute: &Attribute<'_, '_>) -> Span {
    attribute.range_value().into()
}
