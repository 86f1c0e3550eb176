//! Reads a [`Document`] from text.

mod check;
mod content;
mod invoke;
mod states;
mod targets;

pub(crate) use content::literal;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use roxmltree::Node;

use super::compiled_text::CompiledText;
use super::content::{Block, Invoke, Payload, ScriptSource};
use super::document::{DataBinding, DataDeclaration, DataModel, Document};
use super::language::ScriptExpression;
use super::xml::{is_scxml, tag};
use yase::diagnostic::{Diagnostic, Source, Span, Suggestions};
use yase::expression::Trigger;
use yase::statechart::{NodeId, Statechart};

/// Maximum nesting of elements.
const MAX_DEPTH: usize = 160;
/// Maximum number of elements, attributes and texts of a document.
const MAX_NODES: u32 = 1 << 20;

/// Reads a document and returns it with diagnostics.
///
/// If one of the diagnostics is an error there may still be a document; it lacks the rejected parts
/// and must not be run.
pub fn read(source: &Arc<Source>) -> (Option<Document>, Vec<Diagnostic>) {
    let mut reader = DocumentReader::new(&source.text);
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

/// Reads executable content from a script of a chart.
pub(crate) fn read_block(text: &str, data_model: DataModel) -> Result<Block, Vec<Diagnostic>> {
    let wrapped = format!("<finalize xmlns=\"{}\">{text}</finalize>", super::xml::NAMESPACE);
    let mut reader = DocumentReader::new(&wrapped);
    reader.data_model = data_model;
    let block = parse(&wrapped, &mut reader)
        .filter(|tree| deepest(tree.root()).is_none())
        .map(|tree| reader.block(tree.root_element()));
    match block {
        Some(block) if !reader.found.iter().any(Diagnostic::is_error) => Ok(block),
        _ => Err(reader.found),
    }
}

fn parse<'a>(text: &'a str, reader: &mut DocumentReader<'_>) -> Option<roxmltree::Document<'a>> {
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

/// Removes the position, which the span contains.
fn without_position(message: &str) -> &str {
    message.rsplit_once(" at ").map_or(message, |(what, _)| what)
}

fn byte_of(text: &str, position: roxmltree::TextPos) -> usize {
    let before: usize =
        text.split_inclusive('\n').take((position.row as usize).saturating_sub(1)).map(str::len).sum();
    let line = text[before..].chars().take((position.col as usize).saturating_sub(1));
    before + line.map(char::len_utf8).sum::<usize>()
}

/// An element nested too deeply, if there is one: readers recurse over the elements.
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

/// A named state that has not been resolved.
struct TargetReference {
    name: String,
    span: Span,
}

/// A transition whose targets have not been resolved.
struct PendingTransition {
    source: NodeId,
    targets: Vec<TargetReference>,
    internal: bool,
    trigger: Option<Trigger>,
    condition: Option<(CompiledText<ScriptExpression>, Span)>,
    block: Block,
    span: Span,
    /// The composite that it must not leave: that of a START or a history.
    within: Option<NodeId>,
}

impl PendingTransition {
    fn unconditional(
        source: NodeId,
        targets: Vec<TargetReference>,
        span: Span,
        within: NodeId,
    ) -> PendingTransition {
        PendingTransition {
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
pub(crate) struct DocumentReader<'a> {
    text: &'a str,
    found: Vec<Diagnostic>,
    suggestions: Suggestions,
    data_model: DataModel,
    binding: DataBinding,
    statechart: Statechart,
    ids: BTreeMap<String, NodeId>,
    variables: BTreeSet<String>,
    unnamed: Vec<NodeId>,
    pending: Vec<PendingTransition>,
    data: Vec<DataDeclaration>,
    script: Option<ScriptSource>,
    invokes: Vec<(NodeId, Invoke)>,
    done_data: Vec<(NodeId, Payload)>,
}

impl<'a> DocumentReader<'a> {
    fn new(text: &'a str) -> DocumentReader<'a> {
        DocumentReader {
            text,
            found: Vec::new(),
            suggestions: Suggestions::default(),
            data_model: DataModel::Ecmascript,
            binding: DataBinding::Early,
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
