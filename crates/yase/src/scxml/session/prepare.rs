//! A document made ready to run: its chart compiled, its scripts too.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::Platform;
use crate::chart::{Chart, ScriptPlace};
use crate::diagnostic::{Diagnostic, Span};
use crate::expression::{Action, ActionKind, Place, ScriptId};
use crate::scxml::code::Code;
use crate::scxml::content::{Block, Content, Script};
use crate::scxml::document::{Binding, Document};
use crate::scxml::language::{Expression, Program};
use crate::scxml::read::read_block;
use crate::scxml::write::block_text;
use crate::semantics::Semantics;
use crate::statechart::{NodeId, NodeKind, Statechart};
use crate::vocabulary::Vocabulary;

/// A document, compiled; shared by the sessions that run it.
#[derive(Debug)]
pub(super) struct Prepared {
    pub(super) document: Document,
    pub(super) chart: Arc<Chart>,
    /// States by their names.
    pub(super) states: BTreeMap<String, NodeId>,
    pub(super) script: Option<Code<Program>>,
    conditions: Vec<Option<Code<Expression>>>,
    tasks: Vec<Option<Task>>,
}

/// What a chart asks a session to do.
#[derive(Clone, Debug)]
pub(super) enum Task {
    /// Execute what the document says.
    Block(Block),
    /// The session begins: give the variables their first values.
    Begin,
    /// A state is entered whose variables get their values then.
    Bind(NodeId),
    /// A state with invocations is entered.
    Invoke(NodeId),
    /// A state with invocations is left.
    Cancel(NodeId),
    /// An end is reached: this is what its event carries.
    Done(NodeId),
}

/// Marks tasks among the scripts of a chart; no content begins so.
const MARK: char = '#';

impl Task {
    fn text(&self) -> String {
        let (word, node) = match self {
            Task::Block(_) | Task::Begin => ("begin", Statechart::ROOT),
            Task::Bind(node) => ("bind", *node),
            Task::Invoke(node) => ("invoke", *node),
            Task::Cancel(node) => ("cancel", *node),
            Task::Done(node) => ("done", *node),
        };
        format!("{MARK}{word} {}", node.0)
    }

    fn parse(text: &str) -> Option<Task> {
        let (word, node) = text.strip_prefix(MARK)?.split_once(' ')?;
        let node = NodeId(node.parse().ok()?);
        Some(match word {
            "begin" => Task::Begin,
            "bind" => Task::Bind(node),
            "invoke" => Task::Invoke(node),
            "cancel" => Task::Cancel(node),
            "done" => Task::Done(node),
            _ => return None,
        })
    }

    fn action(&self) -> Action {
        Action { kind: ActionKind::Script(self.text()), place: Place::default() }
    }
}

impl Prepared {
    pub(super) fn new(
        document: &Document,
        semantics: Semantics,
        platform: &mut dyn Platform,
    ) -> Result<Prepared, Vec<Diagnostic>> {
        let vocabulary = Vocabulary { scripts: true, ..Vocabulary::default() };
        let chart = with_tasks(document).compile_with(&vocabulary, semantics)?;
        let named = chart.statechart().nodes().filter(|(_, node)| !node.name.is_empty());
        let states = named.skip_while(|(id, _)| *id == Statechart::ROOT);
        let states = states.map(|(id, node)| (node.name.clone(), id)).collect();
        let script = document.script.as_ref().map(|script| fetched(script, platform)).transpose()?;
        let scripts = chart.scripts().len();
        let mut prepared = Prepared {
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
            for place in entry.places {
                match place {
                    ScriptPlace::Guard(_) => self.conditions[index] = Some(Code::expression(entry.text)),
                    _ if self.tasks[index].is_some() => {}
                    _ => self.tasks[index] = Some(self.task(entry.text, platform)?),
                }
            }
        }
        Ok(())
    }

    fn task(&self, text: &str, platform: &mut dyn Platform) -> Result<Task, Vec<Diagnostic>> {
        if let Some(task) = Task::parse(text) {
            return Ok(task);
        }
        let mut block = read_block(text, self.document.data_model)?;
        fetch_scripts(&mut block, platform)?;
        Ok(Task::Block(block))
    }

    pub(super) fn condition(&self, script: ScriptId) -> Option<&Code<Expression>> {
        self.conditions.get(script.0 as usize)?.as_ref()
    }

    pub(super) fn task_of(&self, script: ScriptId) -> Option<&Task> {
        self.tasks.get(script.0 as usize)?.as_ref()
    }
}

/// The document's chart with the tasks of the session in it, which are no part of the document.
fn with_tasks(document: &Document) -> Statechart {
    let mut chart = document.statechart.clone();
    raise_by_content(&mut chart);
    chart.node_mut(Statechart::ROOT).entry.insert(0, Task::Begin.action());
    if document.binding == Binding::Late {
        let states: Vec<NodeId> = document.data.iter().map(|data| data.state).collect();
        for state in states.chunk_by(|a, b| a == b).filter_map(|same| same.first().copied()) {
            if state != Statechart::ROOT {
                chart.node_mut(state).entry.insert(0, Task::Bind(state).action());
            }
        }
    }
    for states in document.invokes.chunk_by(|(a, _), (b, _)| a == b) {
        if let Some(&(state, _)) = states.first() {
            chart.node_mut(state).entry.push(Task::Invoke(state).action());
            chart.node_mut(state).exit.push(Task::Cancel(state).action());
        }
    }
    for end in ends_with_data(document) {
        let node = chart.node_mut(end);
        let place = if node.parent == Some(Statechart::ROOT) { &mut node.exit } else { &mut node.entry };
        place.push(Task::Done(end).action());
    }
    chart
}

/// What the document raises is raised by the session, so that it can be told from what the chart raises by itself.
fn raise_by_content(chart: &mut Statechart) {
    let replace = |action: &mut Action| {
        if let ActionKind::Raise(event) = &action.kind {
            action.kind = ActionKind::Script(block_text(&vec![Content::Raise(event.text())]));
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

/// The ENDs of composites in which one END has data, since the events of all of them must be told apart; and those of the document.
fn ends_with_data(document: &Document) -> Vec<NodeId> {
    let chart = &document.statechart;
    let mut parents: Vec<_> = document.done_data.iter().map(|(end, _)| chart.node(*end).parent).collect();
    parents.push(Some(Statechart::ROOT));
    parents.sort();
    parents.dedup();
    let children = parents.into_iter().flatten().flat_map(|parent| chart.children(parent));
    children.copied().filter(|&child| chart.node(child).kind == NodeKind::End).collect()
}

/// Replaces scripts that stand elsewhere by their texts.
fn fetch_scripts(block: &mut Block, platform: &mut dyn Platform) -> Result<(), Vec<Diagnostic>> {
    for content in block {
        match content {
            Content::Script(script) => *script = Script::Inline(fetched(script, platform)?),
            Content::Foreach { block, .. } => fetch_scripts(block, platform)?,
            Content::If(branches) => {
                for (_, block) in branches {
                    fetch_scripts(block, platform)?;
                }
            }
            _ => {}
        }
    }
    Ok(())
}

fn fetched(script: &Script, platform: &mut dyn Platform) -> Result<Code<Program>, Vec<Diagnostic>> {
    let uri = match script {
        Script::Inline(code) => return Ok(code.clone()),
        Script::Uri(uri) => uri,
    };
    let refuse = |message: String| vec![Diagnostic::error("E0621", Span::default(), message)];
    let text =
        platform.read(uri).map_err(|why| refuse(format!("the script `{uri}` cannot be had: {why}")))?;
    let code = Code::program(&text);
    match code.refused() {
        Some(refused) if code.is_unsupported() => Err(refuse(format!("in `{uri}`: {}", refused.message))),
        _ => Ok(code),
    }
}
