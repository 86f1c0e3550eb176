//! XML: positions of nodes, and text that reads back unchanged.

use roxmltree::Node;

use yase::diagnostic::Span;

/// The namespace of SCXML.
pub(crate) const NAMESPACE: &str = "http://www.w3.org/2005/07/scxml";

/// Whether an element belongs to SCXML; a document without a namespace is treated as SCXML.
pub(crate) fn is_scxml(node: Node<'_, '_>) -> bool {
    matches!(node.tag_name().namespace(), None | Some("" | NAMESPACE))
}

/// Position of the name of an element.
pub(crate) fn tag(node: Node<'_, '_>) -> Span {
    let range = node.range();
    let text = node.document().input_text().get(range.clone()).unwrap_or_default();
    let name = text.find(|character: char| character.is_whitespace() || "/>".contains(character));
    let end = range.start + name.filter(|&end| end > 1).unwrap_or(text.len());
    Span::new((range.start + 1).min(end), end)
}

/// The child elements of an element.
pub(crate) fn elements<'a, 'input>(node: Node<'a, 'input>) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(|child| child.is_element())
}

/// The text of an element without that of its child elements.
pub(crate) fn text_of(node: Node<'_, '_>) -> String {
    node.children().filter(|child| child.is_text()).filter_map(|child| child.text()).collect()
}

/// An element with its content as self-contained text: it declares its namespace, even if that is
/// empty.
pub(crate) fn markup(node: Node<'_, '_>) -> String {
    let mut text = String::new();
    write_element(node, None, &mut text);
    text
}

/// Writes an element in surroundings with this namespace (empty for none), or in any surroundings.
fn write_element(node: Node<'_, '_>, surroundings: Option<&str>, text: &mut String) {
    let (name, namespace) = (node.tag_name().name(), node.tag_name().namespace().unwrap_or_default());
    text.push('<');
    text.push_str(name);
    if surroundings != Some(namespace) {
        attribute(text, "xmlns", namespace);
    }
    for (index, given) in node.attributes().enumerate() {
        match given.namespace() {
            None => attribute(text, given.name(), given.value()),
            Some("http://www.w3.org/XML/1998/namespace") => {
                attribute(text, &format!("xml:{}", given.name()), given.value());
            }
            Some(foreign) => {
                attribute(text, &format!("xmlns:n{index}"), foreign);
                attribute(text, &format!("n{index}:{}", given.name()), given.value());
            }
        }
    }
    if !node.children().any(|child| child.is_element() || child.is_text()) {
        text.push_str("/>");
        return;
    }
    text.push('>');
    for child in node.children() {
        match child.text().filter(|_| child.is_text()) {
            Some(part) => escape(part, false, text),
            None if child.is_element() => write_element(child, Some(namespace), text),
            None => {}
        }
    }
    text.push_str("</");
    text.push_str(name);
    text.push('>');
}

/// Adds ` name="value"`.
pub(crate) fn attribute(text: &mut String, name: &str, value: &str) {
    text.push(' ');
    text.push_str(name);
    text.push_str("=\"");
    escape(value, true, text);
    text.push('"');
}

/// Appends a value to XML text so that it reads back unchanged: as the content of an element, or as
/// an attribute between double quotes. In attributes, white space other than a blank is escaped,
/// since it would read back as blanks.
///
/// ```
/// let mut text = String::from("<note of=\"");
/// yase_scxml::escape("a \"b\"", true, &mut text);
/// text.push_str("\">");
/// yase_scxml::escape("1 < 2", false, &mut text);
/// assert_eq!(text, "<note of=\"a &quot;b&quot;\">1 &lt; 2");
/// ```
pub fn escape(value: &str, in_attribute: bool, text: &mut String) {
    for character in value.chars() {
        match character {
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '&' => text.push_str("&amp;"),
            '"' if in_attribute => text.push_str("&quot;"),
            '\n' if in_attribute => text.push_str("&#10;"),
            '\t' if in_attribute => text.push_str("&#9;"),
            '\r' => text.push_str("&#13;"),
            other => text.push(other),
        }
    }
}

/// Whether XML can represent a text.
pub(crate) fn is_xml(text: &str) -> bool {
    let control = |character: char| u32::from(character) < 0x20 && !"\t\n\r".contains(character);
    !text.contains(|character| control(character) || matches!(character, '\u{fffe}' | '\u{ffff}'))
}
