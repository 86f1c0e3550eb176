//! Preparation of a document: its chart and scripts are compiled.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::Platform;
use crate::compiled_text::CompiledText;
use crate::content::{Block, ExecutableContent, ScriptSource};
use crate::document::{DataBinding, Document};
use crate::language::{ScriptExpression, ScriptProgram};
use crate::read::read_block;
use crate::write::block_text;
use yase::Semantics;
use yase::diagnostic::{Diagnostic, Span};
use yase::expression::{Action, ActionKind, ScriptId, TextPosition};
use yase::statechart::{NodeId, NodeKind, Statechart};
use yase::vocabulary::TypeEnvironment;
use yase::{CompiledChart, ScriptLocation};

/// A compiled document, shared by its sessions.
#[derive(Debug)]
pub(crate) struct PreparedDocument {
    pub(crate) document: Document,
    pub(crate) chart: Arc<CompiledChart>,
    /// States by their names.
    pub(crate) states: BTreeMap<String, NodeId>,
    pub(crate) script: Option<CompiledText<ScriptProgram>>,
    conditions: Vec<Option<CompiledText<ScriptExpression>>>,
    tasks: Vec<Option<SessionTask>>,
}

/// A task of the session that the chart requests by a script.
#[derive(Clone, Debug)]
pub(crate) enum SessionTask {
    /// Execute contents of the document.
    Block(Block),
    /// The session starts: initialise the variables.
    Begin,
    /// A state with late binding is entered: initialise its variables.
    Bind(NodeId),
    /// A state with invocations is entered.
    Invoke(NodeId),
    /// A state with invocations is exited.
    Cancel(NodeId),
    /// A final state with data for its event is reached.
    Done(NodeId),
}

/// Marks tasks among the scripts of a chart; no content begins with it.
const TASK_PREFIX: char = '#';

impl SessionTask {
    fn text(&self) -> String {
        let (word, node) = match self {
            SessionTask::Block(_) | SessionTask::Begin => ("begin", Statechart::ROOT),
            SessionTask::Bind(node) => ("bind", *node),
            SessionTask::Invoke(node) => ("invoke", *node),
            SessionTask::Cancel(node) => ("cancel", *node),
            SessionTask::Done(node) => ("done", *node),
        };
        format!("{TASK_PREFIX}{word} {}", node.0)
    }

    fn parse(text: &str) -> Option<SessionTask> {
        let (word, node) = text.strip_prefix(TASK_PREFIX)?.split_once(' ')?;
        let node = NodeId(node.parse().ok()?);
        Some(match word {
            "begin" => SessionTask::Begin,
            "bind" => SessionTask::Bind(node),
            "invoke" => SessionTask::Invoke(node),
            "cancel" => SessionTask::Cancel(node),
            "done" => SessionTask::Done(node),
            _ => return None,
        })
    }

    fn action(&self) -> Action {
        Action { kind: ActionKind::Script(self.text()), position: TextPosition::default() }
    }
}

impl PreparedDocument {
    pub(crate) fn new(
        document: &Document,
        semantics: Semantics,
        platform: &mut dyn Platform,
    ) -> Result<PreparedDocument, Vec<Diagnostic>> {
        let vocabulary = TypeEnvironment { scripts: true, ..TypeEnvironment::default() };
        let chart = with_tasks(document).compile_with(&vocabulary, semantics)?;
        let named = chart.statechart().nodes().filter(|(_, node)| !node.name.is_empty());
        let states = named.skip_while(|(id, _)| *id == Statechart::ROOT);
        let states = states.map(|(id, node)| (node.name.clone(), id)).collect();
        let script = document.script.as_ref().map(|script| fetched(script, platform)).transpose()?;
        let scripts = chart.scripts().len();
        let mut prepared = PreparedDocument {
            document: document.clone(),
            chart: Arc::new(chart),
            states,
            script,
            conditions: vec![None; scripts],
            tasks: vec![None; scripts],
        };
        prepared.compile(platform)?;
        Ok(prepared)
    }

    fn compile(&mut self, platform: &mut dyn Platform) -> Result<(), Vec<Diagnostic>> {
        let chart = self.chart.clone();
        for entry in chart.scripts() {
            let index = entry.id.0 as usize;
            for location in entry.locations {
                match location {
                    ScriptLocation::Guard(_) => {
                        self.conditions[index] = Some(CompiledText::expression(entry.text))
                    }
                    _ if self.tasks[index].is_some() => {}
                    _ => self.tasks[index] = Some(self.task(entry.text, platform)?),
                }
            }
        }
        Ok(())
    }

    fn task(&self, text: &str, platform: &mut dyn Platform) -> Result<SessionTask, Vec<Diagnostic>> {
        if let Some(task) = SessionTask::parse(text) {
            return Ok(task);
        }
        let mut block = read_block(text, self.document.data_model)?;
        fetch_scripts(&mut block, platform)?;
        Ok(SessionTask::Block(block))
    }

    pub(crate) fn condition(&self, script: ScriptId) -> Option<&CompiledText<ScriptExpression>> {
        self.conditions.get(script.0 as usize)?.as_ref()
    }

    pub(crate) fn task_of(&self, script: ScriptId) -> Option<&SessionTask> {
        self.tasks.get(script.0 as usize)?.as_ref()
    }
}

/// The document's chart with the tasks of the session, which are not part of the document.
fn with_tasks(document: &Document) -> Statechart {
    let mut chart = document.statechart.clone();
    raise_by_content(&mut chart);
    chart.node_mut(Statechart::ROOT).entry.insert(0, SessionTask::Begin.action());
    if document.binding == DataBinding::Late {
        let states: Vec<NodeId> = document.data.iter().map(|data| data.state).collect();
        for state in states.chunk_by(|a, b| a == b).filter_map(|same| same.first().copied()) {
            if state != Statechart::ROOT {
                chart.node_mut(state).entry.insert(0, SessionTask::Bind(state).action());
            }
        }
    }
    for states in document.invokes.chunk_by(|(a, _), (b, _)| a == b) {
        if let Some(&(state, _)) = states.first() {
            chart.node_mut(state).entry.push(SessionTask::Invoke(state).action());
            chart.node_mut(state).exit.push(SessionTask::Cancel(state).action());
        }
    }
    for end in ends_with_data(document) {
        let node = chart.node_mut(end);
        let actions = if node.parent == Some(Statechart::ROOT) { &mut node.exit } else { &mut node.entry };
        actions.push(SessionTask::Done(end).action());
    }
    chart
}

/// The session raises the events of contents, to distinguish them from events that the chart
/// raises.
fn raise_by_content(chart: &mut Statechart) {
    let replace = |action: &mut Action| {
        if let ActionKind::Raise(event) = &action.kind {
            action.kind = ActionKind::Script(block_text(&vec![ExecutableContent::Raise(event.text())]));
        }
    };
    let nodes: Vec<NodeId> = chart.nodes().map(|(id, _)| id).collect();
    for node in nodes {
        let node = chart.node_mut(node);
        node.entry.iter_mut().chain(&mut node.exit).for_each(replace);
    }
    let transitions: Vec<_> = chart.transitions().map(|(id, _)| id).collect();
    for transition in transitions {
        chart.transition_mut(transition).expression.actions.iter_mut().for_each(replace);
    }
}

/// The ENDs whose completion event must be identified: all ENDs of composites with an END that has
/// data, and those of the document.
fn ends_with_data(document: &Document) -> Vec<NodeId> {
    let chart = &document.statechart;
    let mut parents: Vec<_> = document.done_data.iter().map(|(end, _)| chart.node(*end).parent).collect();
    parents.push(Some(Statechart::ROOT));
    parents.sort();
    parents.dedup();
    let children = parents.into_iter().flatten().flat_map(|parent| chart.children(parent));
    children.copied().filter(|&child| chart.node(child).kind == NodeKind::End).collect()
}

/// Replaces references to external scripts by their texts.
fn fetch_scripts(block: &mut Block, platform: &mut dyn Platform) -> Result<(), Vec<Diagnostic>> {
    for content in block {
        match content {
            ExecutableContent::Script(script) => *script = ScriptSource::Inline(fetched(script, platform)?),
            ExecutableContent::Foreach { block, .. } => fetch_scripts(block, platform)?,
            ExecutableContent::If(branches) => {
                for (_, block) in branches {
                    fetch_scripts(block, platform)?;
                }
            }
            _ => {}
        }
    }
    Ok(())
}

fn fetched(
    script: &ScriptSource,
    platform: &mut dyn Platform,
) -> Result<CompiledText<ScriptProgram>, Vec<Diagnostic>> {
    let uri = match script {
        ScriptSource::Inline(code) => return Ok(code.clone()),
        ScriptSource::Uri(uri) => uri,
    };
    let refuse = |message: String| vec![Diagnostic::error("E0621", Span::default(), message)];
    let text =
        platform.read(uri).map_err(|why| refuse(format!("the script `{uri}` cannot be had: {why}")))?;
    let code = CompiledText::program(&text);
    match code.refused() {
        Some(refused) if code.is_unsupported() => Err(refuse(format!("in `{uri}`: {}", refused.message))),
        _ => Ok(code),
    }
}
