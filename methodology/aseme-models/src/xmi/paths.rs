//! Resolution of references in an XMI document.

use std::collections::BTreeMap;

use roxmltree::{Document, Node};

use super::{XMI, elements};

/// Index of the elements of a document.
pub(crate) struct XmiPaths {
    roots: Vec<usize>,
    /// The child elements by parent and name.
    children: BTreeMap<(usize, String), Vec<usize>>,
    ids: BTreeMap<String, usize>,
}

impl XmiPaths {
    /// Indexes a document. The children of the root `xmi:XMI` are roots themselves.
    pub(crate) fn new(document: &Document<'_>) -> XmiPaths {
        let root = document.root_element();
        let roots = match has_many_roots(root) {
            true => elements(root).map(|node| node.id().get_usize()).collect(),
            false => vec![root.id().get_usize()],
        };
        let mut paths = XmiPaths { roots, children: BTreeMap::new(), ids: BTreeMap::new() };
        for node in document.descendants().filter(Node::is_element) {
            if let Some(parent) = node.parent_element() {
                let key = (parent.id().get_usize(), node.tag_name().name().to_owned());
                paths.children.entry(key).or_default().push(node.id().get_usize());
            }
            if let Some(id) = node.attribute((XMI, "id")) {
                paths.ids.entry(id.to_owned()).or_insert_with(|| node.id().get_usize());
            }
        }
        paths
    }

    /// The element that a reference denotes.
    pub(crate) fn find(&self, reference: &str) -> Option<usize> {
        let reference = reference.strip_prefix('#').unwrap_or(reference);
        let Some(path) = reference.strip_prefix('/') else {
            return self.ids.get(reference).copied();
        };
        let mut steps = path.split('/');
        let root = match steps.next()? {
            "" => 0,
            number => number.parse().ok()?,
        };
        steps.try_fold(*self.roots.get(root)?, |node, step| self.step(node, step))
    }

    /// `@nodes.0`
    fn step(&self, node: usize, step: &str) -> Option<usize> {
        let feature = step.strip_prefix('@')?;
        let (feature, index) = match feature.rsplit_once('.') {
            Some((feature, index)) => (feature, index.parse().ok()?),
            None => (feature, 0_usize),
        };
        self.children.get(&(node, feature.to_owned()))?.get(index).copied()
    }
}

/// Whether an element is `xmi:XMI`.
pub(crate) fn has_many_roots(root: Node<'_, '_>) -> bool {
    root.tag_name().name() == "XMI" && root.tag_name().namespace().is_none_or(|uri| uri == XMI)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name_of(text: &str, reference: &str) -> Option<String> {
        let document = Document::parse(text).unwrap();
        let found = XmiPaths::new(&document).find(reference)?;
        document
            .descendants()
            .find(|node| node.id().get_usize() == found)?
            .attribute("name")
            .map(String::from)
    }

    #[test]
    fn ways_numbers_and_ids_are_found() {
        let nested = r#"<M xmlns:xmi="http://www.omg.org/XMI"><n name="a"><c name="b"/><c name="c" xmi:id="x"/></n><n name="d"/></M>"#;
        for (reference, name) in [
            ("//@n.0", Some("a")),
            ("#//@n.0/@c.1", Some("c")),
            ("//@n.1", Some("d")),
            ("//@n.2", None),
            ("//@n.0/@x.0", None),
            ("/1", None),
            ("x", Some("c")),
            ("#x", Some("c")),
            ("y", None),
            ("//@n.18446744073709551616", None),
            ("", None),
        ] {
            assert_eq!(name_of(nested, reference).as_deref(), name, "{reference}");
        }
        let flat = r#"<xmi:XMI xmlns:xmi="http://www.omg.org/XMI"><n name="a"/><n name="b"><c name="c"/></n></xmi:XMI>"#;
        assert_eq!(name_of(flat, "#/1").as_deref(), Some("b"));
        assert_eq!(name_of(flat, "/1/@c.0").as_deref(), Some("c"));
    }
}
