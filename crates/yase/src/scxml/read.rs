//! From text to a [`Document`].

mod check;
mod content;
mod invoke;
mod states;
mod targets;

pub(crate) use content::{literal, quoted};
pub(crate) use states::is_id;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use roxmltree::Node;

use super::code::Code;
use super::content::{Block, Invoke, Payload, Script};
use super::document::{Binding, DataModel, Declaration, Document};
use super::language::Expression;
use super::xml::{is_scxml, tag};
use crate::diagnostic::{Diagnostic, Source, Span};
use crate::expression::Trigger;
use crate::statechart::{NodeId, Statechart};

/// How deeply elements may nest.
const MAX_DEPTH: usize = 160;
/// How many elements, attributes and texts a document may have.
const MAX_NODES: u32 = 1 << 20;

/// Reads a document: what was understood, and what is wrong with the rest.
///
/// With an error among the diagnostics there may still be a document; it lacks what was refused and must not be run.
pub fn read(source: &Arc<Source>) -> (Option<Document>, Vec<Diagnostic>) {
    let mut reader = Reader::new(&source.text);
    let document = parse(&source.text, &mut reader).and_then(|tree| {
        let deepest = deepest(tree.root());
        match deepest {
            Some(node) => {
                let message = format!("elements nest deeper than {MAX_DEPTH}");
                reader.error("E0614", tag(node), message);
                None
            }
            None => reader.document(tree.root_element()),
        }
    });
    let found = reader.found.into_iter().map(|diagnostic| diagnostic.in_source(source)).collect();
    (document, found)
}

/// Reads executable content that stands in a chart as a script.
pub(super) fn read_block(text: &str, data_model: DataModel) -> Result<Block, Vec<Diagnostic>> {
    let wrapped = format!("<finalize xmlns=\"{}\">{text}</finalize>", super::xml::NAMESPACE);
    let mut reader = Reader::new(&wrapped);
    reader.data_model = data_model;
    let block = parse(&wrapped, &mut reader)
        .filter(|tree| deepest(tree.root()).is_none())
        .map(|tree| reader.block(tree.root_element()));
    match block {
        Some(block) if !reader.found.iter().any(Diagnostic::is_error) => Ok(block),
        _ => Err(reader.found),
    }
}

fn parse<'a>(text: &'a str, reader: &mut Reader<'_>) -> Option<roxmltree::Document<'a>> {
    let options = roxmltree::ParsingOptions { nodes_limit: MAX_NODES, ..Default::default() };
    match roxmltree::Document::parse_with_options(text, options) {
        Ok(tree) => Some(tree),
        Err(error) => {
            let start = byte_of(text, error.pos());
            let length = text[start..].chars().next().map_or(0, char::len_utf8);
            let message = format!("not XML: {}", without_position(&error.to_string()));
            reader.error("E0601", Span::new(start, start + length), message);
            None
        }
    }
}

/// The place is told by the span.
fn without_position(message: &str) -> &str {
    message.rsplit_once(" at ").map_or(message, |(what, _)| what)
}

fn byte_of(text: &str, position: roxmltree::TextPos) -> usize {
    let before: usize =
        text.split_inclusive('\n').take((position.row as usize).saturating_sub(1)).map(str::len).sum();
    let line = text[before..].chars().take((position.col as usize).saturating_sub(1));
    before + line.map(char::len_utf8).sum::<usize>()
}

/// An element that lies too deep, if there is one: what reads documents follows their nesting.
fn deepest<'a, 'input>(root: Node<'a, 'input>) -> Option<Node<'a, 'input>> {
    let mut depth = 0;
    let mut node = root;
    loop {
        if depth > MAX_DEPTH {
            return Some(node);
        }
        if let Some(child) = node.first_child() {
            (node, depth) = (child, depth + 1);
            continue;
        }
        while node.next_sibling().is_none() {
            node = node.parent().filter(|&parent| parent != root)?;
            depth -= 1;
        }
        node = node.next_sibling()?;
    }
}

/// A state that is named and not looked up yet.
struct Target {
    name: String,
    span: Span,
}

/// A transition whose targets are not looked up yet.
struct Pending {
    source: NodeId,
    targets: Vec<Target>,
    internal: bool,
    trigger: Option<Trigger>,
    condition: Option<(Code<Expression>, Span)>,
    block: Block,
    span: Span,
    /// The composite it must not lead out of: that of a START or a history.
    within: Option<NodeId>,
}

impl Pending {
    fn unconditional(source: NodeId, targets: Vec<Target>, span: Span, within: NodeId) -> Pending {
        Pending {
            source,
            targets,
            internal: false,
            trigger: None,
            condition: None,
            block: Block::new(),
            span,
            within: Some(within),
        }
    }
}

/// Reads one document.
pub(super) struct Reader<'a> {
    text: &'a str,
    found: Vec<Diagnostic>,
    data_model: DataModel,
    binding: Binding,
    statechart: Statechart,
    ids: BTreeMap<String, NodeId>,
    variables: BTreeSet<String>,
    unnamed: Vec<NodeId>,
    pending: Vec<Pending>,
    data: Vec<Declaration>,
    script: Option<Script>,
    invokes: Vec<(NodeId, Invoke)>,
    done_data: Vec<(NodeId, Payload)>,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str) -> Reader<'a> {
        Reader {
            text,
            found: Vec::new(),
            data_model: DataModel::Ecmascript,
            binding: Binding::Early,
            statechart: Statechart::new(""),
            ids: BTreeMap::new(),
            variables: BTreeSet::new(),
            unnamed: Vec::new(),
            pending: Vec::new(),
            data: Vec::new(),
            script: None,
            invokes: Vec::new(),
            done_data: Vec::new(),
        }
    }

    fn error(&mut self, code: &'static str, span: Span, message: impl Into<String>) -> &mut Diagnostic {
        self.report(Diagnostic::error(code, span, message))
    }

    fn report(&mut self, diagnostic: Diagnostic) -> &mut Diagnostic {
        self.found.push(diagnostic);
        let last = self.found.len() - 1;
        &mut self.found[last]
    }

    fn document(&mut self, root: Node<'_, '_>) -> Option<Document> {
        if root.tag_name().name() != "scxml" || !is_scxml(root) {
            let message = format!("this is a `{}`, not an SCXML document", root.tag_name().name());
            self.error("E0616", tag(root), message).hint =
                Some(format!("the root is `<scxml xmlns=\"{}\" version=\"1.0\">`", super::xml::NAMESPACE));
            return None;
        }
        let name = root.attribute("name").map(str::to_owned);
        self.statechart = Statechart::new(name.as_deref().unwrap_or_default());
        self.root(root);
        self.name_the_unnamed();
        self.connect();
        Some(Document {
            name,
            data_model: self.data_model,
            binding: self.binding,
            statechart: std::mem::replace(&mut self.statechart, Statechart::new("")),
            data: std::mem::take(&mut self.data),
            script: self.script.take(),
            invokes: std::mem::take(&mut self.invokes),
            done_data: std::mem::take(&mut self.done_data),
        })
    }
}
