//! Queries on an XML file.

use std::collections::BTreeMap;
use std::path::Path;
use std::str::FromStr;

use yase::Diagnostic;

use super::element::Element;
use super::paths;
use super::xml;
use super::xml_config::{ValueError, attribute_value, type_name, value_of};

/// An XML file as a tree: elements are queried by name, at the root or within an element found
/// before (Listing 4.13 of the thesis).
///
/// ```
/// use monas_config::{Xml, XmlNode};
/// use yase::Source;
///
/// let text = "<leg side=left><joint min=-1.1 max=0.7>Hip</joint></leg>\n<leg side=right/>";
/// let xml = Xml::read(&yase::Source::new("legs.xml", text));
/// let legs: Vec<XmlNode<String, String>> = xml.query("leg")?;
/// assert_eq!((legs.len(), legs[1].attributes["side"].as_str()), (2, "right"));
/// let joints: Vec<XmlNode<String, f64>> = xml.query_within("joint", &legs[0])?;
/// assert_eq!((joints[0].value.as_deref(), joints[0].attributes["max"]), (Some("Hip"), 0.7));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Xml {
    elements: Vec<Element>,
    diagnostics: Vec<Diagnostic>,
}

/// An element found: its name, its text as a `T`, its attributes of type `A` by keys of type `K`
/// (Listing 4.12).
#[derive(Clone, Debug)]
pub struct XmlNode<T, A, K = String> {
    /// Its name.
    pub name: String,
    /// Its text; none if it is empty and not a valid `T`.
    pub value: Option<T>,
    /// Its attributes.
    pub attributes: BTreeMap<K, A>,
    /// Its path from the root: its index among all elements, at each level.
    path: Vec<usize>,
}

impl Xml {
    /// Reads a file; [`diagnostics`](Xml::diagnostics) reports its errors, also that it does not
    /// exist.
    pub fn open(path: impl AsRef<Path>) -> Xml {
        match paths::read(path.as_ref()) {
            Ok(source) => Xml::read(&source),
            Err(diagnostic) => Xml { elements: Vec::new(), diagnostics: vec![*diagnostic] },
        }
    }

    /// As [`open`](Xml::open), from a text in memory.
    pub fn read(source: &std::sync::Arc<yase::Source>) -> Xml {
        let (elements, diagnostics) = xml::parse(source);
        Xml { elements, diagnostics }
    }

    /// The diagnostics of the text.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// The elements of that name at the root.
    ///
    /// # Errors
    /// A text, an attribute or its key is not of the requested type.
    pub fn query<T: FromStr, A: FromStr, K: FromStr + Ord>(
        &self,
        name: &str,
    ) -> Result<Vec<XmlNode<T, A, K>>, ValueError> {
        found(&self.elements, name, &[])
    }

    /// The elements of that name directly in an element found before.
    ///
    /// # Errors
    /// A text, an attribute or its key is not of the requested type.
    pub fn query_within<T: FromStr, A: FromStr, K: FromStr + Ord, T2, A2, K2>(
        &self,
        name: &str,
        node: &XmlNode<T2, A2, K2>,
    ) -> Result<Vec<XmlNode<T, A, K>>, ValueError> {
        let mut elements = &self.elements[..];
        for index in &node.path {
            match elements.get(*index) {
                Some(element) => elements = element.children(),
                // It was found in another file.
                None => return Ok(Vec::new()),
            }
        }
        found(elements, name, &node.path)
    }
}

fn found<T: FromStr, A: FromStr, K: FromStr + Ord>(
    elements: &[Element],
    name: &str,
    above: &[usize],
) -> Result<Vec<XmlNode<T, A, K>>, ValueError> {
    let named = elements.iter().enumerate().filter(|(_, element)| element.name() == name);
    named.map(|(index, element)| node(element, [above, &[index]].concat())).collect()
}

fn node<T: FromStr, A: FromStr, K: FromStr + Ord>(
    element: &Element,
    indices: Vec<usize>,
) -> Result<XmlNode<T, A, K>, ValueError> {
    let value = match element.text() {
        "" => "".parse().ok(),
        _ => Some(value_of(element)?),
    };
    let attributes = element.attributes().iter().map(|given| {
        let key = given.name.parse().map_err(|_| {
            let message = format!("the attribute's name `{}` is not {}", given.name, type_name::<K>());
            ValueError::new(given.name_error("E0306", message))
        })?;
        Ok((key, attribute_value(given)?))
    });
    let attributes = attributes.collect::<Result<_, ValueError>>()?;
    Ok(XmlNode { name: element.name().to_owned(), value, attributes, path: indices })
}
