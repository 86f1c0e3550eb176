//! Execution of contents.

use super::Platform;
use super::event::ScxmlEvent;
use super::event_router::EventRouter;
use super::prepare::{PreparedDocument, SessionTask};
use super::process::SessionState;
use crate::compiled_text::{CompiledText, LiteralOrExpression};
use crate::content::{Block, ExecutableContent, ScriptSource, ValueSource};
use crate::document::{DataBinding, DataDeclaration};
use crate::language::{
    DataValue, EvalError, Evaluator, InPredicate, Location, ScriptExpression, ScriptMemory, ScriptValue,
    is_variable,
};
use yase::statechart::{NodeId, Statechart};

/// Everything that contents access.
pub(crate) struct ContentExecutor<'a> {
    pub(crate) prepared: &'a PreparedDocument,
    pub(crate) memory: &'a mut ScriptMemory,
    pub(crate) state: &'a mut SessionState,
    pub(crate) exchange: &'a mut EventRouter,
    pub(crate) platform: &'a mut dyn Platform,
    pub(crate) states: &'a dyn InPredicate,
}

/// Whether contents were executed to their end.
pub(crate) type Completion = Result<(), ExecutionAbort>;

/// Why contents were not executed to their end.
#[derive(Debug)]
pub(crate) enum ExecutionAbort {
    /// An error that still has to be reported.
    Fault(EvalError),
    /// An error whose event has already been raised.
    AlreadyReported,
}

impl From<EvalError> for ExecutionAbort {
    fn from(fault: EvalError) -> ExecutionAbort {
        ExecutionAbort::Fault(fault)
    }
}

impl ContentExecutor<'_> {
    /// Performs a task of the chart.
    pub(crate) fn task(&mut self, task: &SessionTask) -> Completion {
        match task {
            SessionTask::Block(block) => self.block(block),
            SessionTask::Begin => self.begin(),
            SessionTask::Bind(state) => {
                if self.state.bound.insert(*state) {
                    self.bind(|data| data.state == *state);
                }
                Ok(())
            }
            SessionTask::Invoke(state) => {
                self.state.to_invoke.insert(*state);
                Ok(())
            }
            SessionTask::Cancel(state) => {
                self.cancel_invocations(*state);
                Ok(())
            }
            SessionTask::Done(end) => {
                self.done(*end);
                Ok(())
            }
        }
    }

    /// Raises an error event for a failure, and records failures that end the session.
    pub(crate) fn raise_execution_error(&mut self, executed: Completion) {
        if let Err(ExecutionAbort::Fault(fault)) = executed {
            self.state.raised.push(ScxmlEvent::error("error.execution", fault.message));
        }
        if self.memory.is_exhausted() {
            let fault = self.memory.step().err();
            self.state.fatal = self.state.fatal.take().or(fault.map(|fault| fault.message));
        }
    }

    /// Executes contents in order, up to the first that fails.
    pub(crate) fn block(&mut self, block: &Block) -> Completion {
        for content in block {
            self.memory.step()?;
            self.memory.collect_garbage()?;
            self.content(content)?;
        }
        Ok(())
    }

    fn content(&mut self, content: &ExecutableContent) -> Completion {
        match content {
            ExecutableContent::Raise(event) => self.raise(ScxmlEvent::internal(event))?,
            ExecutableContent::If(branches) => return self.branches(branches),
            ExecutableContent::Foreach { array, item, index, block } => {
                return self.foreach(array, item, index.as_deref(), block);
            }
            ExecutableContent::Log { label, value } => self.log(label.as_deref(), value.as_ref())?,
            ExecutableContent::Assign { location, value } => {
                let value = self.source(value)?;
                let location = location.get()?;
                self.evaluation().assign(location, value, true)?;
            }
            ExecutableContent::Script(ScriptSource::Inline(code)) => {
                let program = code.get()?;
                self.evaluation().run(program)?;
            }
            ExecutableContent::Script(ScriptSource::Uri(uri)) => {
                return Err(EvalError::new(format!("the script `{uri}` was not read")).into());
            }
            ExecutableContent::Send(send) => return self.send(send),
            ExecutableContent::Cancel(id) => {
                let id = self.text(id)?;
                self.memory.charge_reading(self.exchange.delayed_count())?;
                self.exchange.cancel(self.state.number, &id);
            }
        }
        Ok(())
    }

    /// Raises an event after the contents are executed.
    pub(crate) fn raise(&mut self, event: ScxmlEvent) -> Result<(), EvalError> {
        if self.exchange.is_full() || self.state.raised.len() >= MAX_RAISED {
            let message = "more events are in transit than a session may have";
            self.state.fatal.get_or_insert(message.into());
            return Err(EvalError::new(message));
        }
        self.state.raised.push(event);
        Ok(())
    }

    pub(crate) fn evaluation(&mut self) -> Evaluator<'_> {
        Evaluator::new(self.memory, self.states)
    }

    pub(crate) fn value(&mut self, code: &CompiledText<ScriptExpression>) -> Result<ScriptValue, EvalError> {
        let expression = code.get()?;
        self.evaluation().value(expression)
    }

    /// A text given literally or as an expression.
    pub(crate) fn text(&mut self, given: &LiteralOrExpression) -> Result<String, EvalError> {
        match given {
            LiteralOrExpression::Fixed(text) => Ok(text.clone()),
            LiteralOrExpression::Computed(code) => {
                let value = self.value(code)?;
                Ok(self.memory.text_of(&value)?.to_string())
            }
        }
    }

    /// A condition that fails counts as false and does not abort the surrounding contents.
    fn branches(&mut self, branches: &[(Option<CompiledText<ScriptExpression>>, Block)]) -> Completion {
        for (condition, block) in branches {
            let holds = match condition {
                None => Ok(true),
                Some(code) => code.get().and_then(|condition| self.evaluation().holds(condition)),
            };
            match holds {
                Ok(true) => return self.block(block),
                Ok(false) => {}
                Err(fault) => self.raise(ScxmlEvent::error("error.execution", fault.message))?,
            }
        }
        Ok(())
    }

    fn foreach(
        &mut self,
        array: &CompiledText<ScriptExpression>,
        item: &str,
        index: Option<&str>,
        block: &Block,
    ) -> Completion {
        let array = self.value(array)?;
        let Some(items) = self.memory.heap.items(&array).map(<[ScriptValue]>::to_vec) else {
            return Err(EvalError::new("`foreach` needs an array").into());
        };
        for name in std::iter::once(item).chain(index) {
            if !is_variable(name) {
                return Err(EvalError::new(format!("`{name}` is not the name of a variable")).into());
            }
            self.memory.declare(name)?;
        }
        // The contents may change the array; the loop uses its original items.
        let copy = self.memory.heap.array(items.clone())?;
        self.memory.pin(copy);
        let executed = self.each(&items, item, index, block);
        self.memory.unpin();
        executed
    }

    fn each(&mut self, items: &[ScriptValue], item: &str, index: Option<&str>, block: &Block) -> Completion {
        for (number, value) in items.iter().enumerate() {
            self.memory.set(item, value.clone())?;
            if let Some(index) = index {
                self.memory.set(index, ScriptValue::Number(number as f64))?;
            }
            self.memory.step()?;
            self.block(block)?;
        }
        Ok(())
    }

    fn log(
        &mut self,
        label: Option<&str>,
        value: Option<&CompiledText<ScriptExpression>>,
    ) -> Result<(), EvalError> {
        let text = match value {
            None => String::new(),
            Some(code) => match self.value(code)? {
                ScriptValue::Text(text) => text.to_string(),
                object @ ScriptValue::Object(_) => self.memory.export(&object)?.to_string(),
                other => self.memory.text_of(&other)?.to_string(),
            },
        };
        let session = super::event_router::session_id(self.state.number);
        self.platform.log(&session, label.unwrap_or_default(), &text);
        Ok(())
    }

    /// Initialises the variables and runs the document's script.
    fn begin(&mut self) -> Completion {
        for data in &self.prepared.document.data {
            self.memory.declare(&data.name)?;
        }
        let early = self.prepared.document.binding == DataBinding::Early;
        self.bind(|data| early || data.state == Statechart::ROOT);
        if let Some(script) = &self.prepared.script {
            let program = script.get()?;
            self.evaluation().run(program)?;
        }
        Ok(())
    }

    /// Initialises variables; a failure is an error of that variable only.
    fn bind(&mut self, which: impl Fn(&DataDeclaration) -> bool) {
        let prepared = self.prepared;
        for data in prepared.document.data.iter().filter(|data| which(data)) {
            if let Err(fault) = self.bind_one(data) {
                self.raise_execution_error(Err(fault.into()));
            }
        }
    }

    fn bind_one(&mut self, data: &DataDeclaration) -> Result<(), EvalError> {
        let given =
            self.state.given.iter().find(|(name, _)| *name == data.name && data.state == Statechart::ROOT);
        let value = match given {
            Some((_, given)) => self.memory.heap.import(given)?,
            None => self.source(&data.value)?,
        };
        self.memory.set(&data.name, value)?;
        self.memory.collect_garbage()
    }

    /// The value of a source.
    pub(crate) fn source(&mut self, source: &ValueSource) -> Result<ScriptValue, EvalError> {
        match source {
            ValueSource::Nothing => Ok(ScriptValue::Undefined),
            ValueSource::Expression(code) => self.value(code),
            ValueSource::Text(text) => self.value(&crate::read::literal(text)),
            ValueSource::Document(text) => self.memory.heap.text(text.as_str()),
            ValueSource::Uri(uri) => {
                let text = self
                    .platform
                    .read(uri)
                    .map_err(|why| EvalError::new(format!("`{uri}` cannot be had: {why}")))?;
                self.value(&crate::read::literal(&text))
            }
        }
    }

    /// Assigns a value to the variable that the document names for it.
    pub(crate) fn store(&mut self, location: &CompiledText<Location>, text: &str) -> Result<(), EvalError> {
        let value = self.memory.heap.text(text)?;
        let location = location.get()?;
        self.evaluation().assign(location, value, true)
    }

    /// A final state is reached: evaluates the data of its event.
    fn done(&mut self, end: NodeId) {
        let prepared = self.prepared;
        let payload = prepared.document.done_data.iter().find(|(state, _)| *state == end);
        let data = match payload {
            Some((_, payload)) => self.payload(payload).unwrap_or_else(|fault| {
                self.raise_execution_error(Err(fault.into()));
                DataValue::Undefined
            }),
            None => DataValue::Undefined,
        };
        let chart = prepared.chart.statechart();
        match chart.node(end).parent {
            Some(Statechart::ROOT) | None => self.state.end = Some((end, data)),
            Some(composite) => {
                self.state
                    .completion_data
                    .entry(chart.node(composite).name.clone())
                    .or_default()
                    .push_back(data);
            }
        }
    }
}

/// Maximum number of events that one block may raise.
const MAX_RAISED: usize = 10_000;
