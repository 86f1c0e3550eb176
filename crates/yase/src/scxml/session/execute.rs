//! What contents do.

use super::Platform;
use super::event::Event;
use super::exchange::Exchange;
use super::prepare::{Prepared, Task};
use super::process::Book;
use crate::scxml::code::{Code, Given};
use crate::scxml::content::{Block, Content, Script, Source};
use crate::scxml::document::{Binding, Declaration};
use crate::scxml::language::{
    ActiveStates, Data, Evaluation, Expression, Fault, Location, Memory, Value, is_variable,
};
use crate::statechart::{NodeId, Statechart};

/// What contents may touch.
pub(super) struct Execution<'a> {
    pub(super) prepared: &'a Prepared,
    pub(super) memory: &'a mut Memory,
    pub(super) book: &'a mut Book,
    pub(super) exchange: &'a mut Exchange,
    pub(super) platform: &'a mut dyn Platform,
    pub(super) states: &'a dyn ActiveStates,
}

/// Whether contents were executed to their end.
pub(super) type Executed = Result<(), Stopped>;

/// Why contents were not executed to their end.
#[derive(Debug)]
pub(super) enum Stopped {
    /// Something failed, which is to be told.
    Fault(Fault),
    /// Something failed, and its event is raised already.
    Told,
}

impl From<Fault> for Stopped {
    fn from(fault: Fault) -> Stopped {
        Stopped::Fault(fault)
    }
}

impl Execution<'_> {
    /// Does what a chart asks for.
    pub(super) fn task(&mut self, task: &Task) -> Executed {
        match task {
            Task::Block(block) => self.block(block),
            Task::Begin => self.begin(),
            Task::Bind(state) => {
                if self.book.bound.insert(*state) {
                    self.bind(|data| data.state == *state);
                }
                Ok(())
            }
            Task::Invoke(state) => {
                self.book.to_invoke.insert(*state);
                Ok(())
            }
            Task::Cancel(state) => {
                self.cancel_invocations(*state);
                Ok(())
            }
            Task::Done(end) => {
                self.done(*end);
                Ok(())
            }
        }
    }

    /// Raises an error for what failed, and notes when nothing more can be done at all.
    pub(super) fn tell(&mut self, executed: Executed) {
        if let Err(Stopped::Fault(fault)) = executed {
            self.book.raised.push(Event::error("error.execution", fault.message));
        }
        if self.memory.is_exhausted() {
            let fault = self.memory.step().err();
            self.book.fatal = self.book.fatal.take().or(fault.map(|fault| fault.message));
        }
    }

    /// Executes contents in order, up to the first that fails.
    pub(super) fn block(&mut self, block: &Block) -> Executed {
        for content in block {
            self.memory.step()?;
            self.memory.tidy()?;
            self.content(content)?;
        }
        Ok(())
    }

    fn content(&mut self, content: &Content) -> Executed {
        match content {
            Content::Raise(event) => self.raise(Event::internal(event))?,
            Content::If(branches) => return self.branches(branches),
            Content::Foreach { array, item, index, block } => {
                return self.foreach(array, item, index.as_deref(), block);
            }
            Content::Log { label, value } => self.log(label.as_deref(), value.as_ref())?,
            Content::Assign { location, value } => {
                let value = self.source(value)?;
                let location = location.get()?;
                self.evaluation().assign(location, value, true)?;
            }
            Content::Script(Script::Inline(code)) => {
                let program = code.get()?;
                self.evaluation().run(program)?;
            }
            Content::Script(Script::Uri(uri)) => {
                return Err(Fault::new(format!("the script `{uri}` was not read")).into());
            }
            Content::Send(send) => return self.send(send),
            Content::Cancel(id) => {
                let id = self.text(id)?;
                self.exchange.cancel(self.book.number, &id);
            }
        }
        Ok(())
    }

    /// Raises an event when the contents are executed.
    pub(super) fn raise(&mut self, event: Event) -> Result<(), Fault> {
        if self.exchange.is_full() || self.book.raised.len() >= MAX_RAISED {
            let message = "more events are on their way than a session may have";
            self.book.fatal.get_or_insert(message.into());
            return Err(Fault::new(message));
        }
        self.book.raised.push(event);
        Ok(())
    }

    pub(super) fn evaluation(&mut self) -> Evaluation<'_> {
        Evaluation::new(self.memory, self.states)
    }

    pub(super) fn value(&mut self, code: &Code<Expression>) -> Result<Value, Fault> {
        let expression = code.get()?;
        self.evaluation().value(expression)
    }

    /// What is given as it is, or computed.
    pub(super) fn text(&mut self, given: &Given) -> Result<String, Fault> {
        match given {
            Given::Fixed(text) => Ok(text.clone()),
            Given::Computed(code) => {
                let value = self.value(code)?;
                Ok(self.memory.heap.text_of(&value)?.to_string())
            }
        }
    }

    /// A condition that fails counts as false, which does not end the contents it stands in.
    fn branches(&mut self, branches: &[(Option<Code<Expression>>, Block)]) -> Executed {
        for (condition, block) in branches {
            let holds = match condition {
                None => Ok(true),
                Some(code) => code.get().and_then(|condition| self.evaluation().holds(condition)),
            };
            match holds {
                Ok(true) => return self.block(block),
                Ok(false) => {}
                Err(fault) => self.raise(Event::error("error.execution", fault.message))?,
            }
        }
        Ok(())
    }

    fn foreach(
        &mut self,
        array: &Code<Expression>,
        item: &str,
        index: Option<&str>,
        block: &Block,
    ) -> Executed {
        let array = self.value(array)?;
        let Some(items) = self.memory.heap.items(&array).map(<[Value]>::to_vec) else {
            return Err(Fault::new("`foreach` needs an array").into());
        };
        for name in std::iter::once(item).chain(index) {
            if !is_variable(name) {
                return Err(Fault::new(format!("`{name}` is not the name of a variable")).into());
            }
            self.memory.declare(name)?;
        }
        // The contents may change the array; what is gone through is as it was.
        let copy = self.memory.heap.array(items.clone())?;
        self.memory.pin(copy);
        let executed = self.each(&items, item, index, block);
        self.memory.unpin();
        executed
    }

    fn each(&mut self, items: &[Value], item: &str, index: Option<&str>, block: &Block) -> Executed {
        for (number, value) in items.iter().enumerate() {
            self.memory.set(item, value.clone())?;
            if let Some(index) = index {
                self.memory.set(index, Value::Number(number as f64))?;
            }
            self.memory.step()?;
            self.block(block)?;
        }
        Ok(())
    }

    fn log(&mut self, label: Option<&str>, value: Option<&Code<Expression>>) -> Result<(), Fault> {
        let text = match value {
            None => String::new(),
            Some(code) => match self.value(code)? {
                Value::Text(text) => text.to_string(),
                object @ Value::Object(_) => self.memory.heap.export(&object)?.to_string(),
                other => self.memory.heap.text_of(&other)?.to_string(),
            },
        };
        let session = super::exchange::session_id(self.book.number);
        self.platform.log(&session, label.unwrap_or_default(), &text);
        Ok(())
    }

    /// The first values of variables, and the document's script.
    fn begin(&mut self) -> Executed {
        for data in &self.prepared.document.data {
            self.memory.declare(&data.name)?;
        }
        let early = self.prepared.document.binding == Binding::Early;
        self.bind(|data| early || data.state == Statechart::ROOT);
        if let Some(script) = &self.prepared.script {
            let program = script.get()?;
            self.evaluation().run(program)?;
        }
        Ok(())
    }

    /// Gives variables their first values; one that cannot be had is an error, and the others get theirs.
    fn bind(&mut self, which: impl Fn(&Declaration) -> bool) {
        let prepared = self.prepared;
        for data in prepared.document.data.iter().filter(|data| which(data)) {
            if let Err(fault) = self.bind_one(data) {
                self.tell(Err(fault.into()));
            }
        }
    }

    fn bind_one(&mut self, data: &Declaration) -> Result<(), Fault> {
        let given =
            self.book.given.iter().find(|(name, _)| *name == data.name && data.state == Statechart::ROOT);
        let value = match given {
            Some((_, given)) => self.memory.heap.import(given)?,
            None => self.source(&data.value)?,
        };
        self.memory.set(&data.name, value)?;
        self.memory.tidy()
    }

    /// The value of what a document gives.
    pub(super) fn source(&mut self, source: &Source) -> Result<Value, Fault> {
        match source {
            Source::Nothing => Ok(Value::Undefined),
            Source::Expression(code) => self.value(code),
            Source::Text(text) => self.value(&crate::scxml::read::literal(text)),
            Source::Document(text) => self.memory.heap.text(text.as_str()),
            Source::Uri(uri) => {
                let text = self
                    .platform
                    .read(uri)
                    .map_err(|why| Fault::new(format!("`{uri}` cannot be had: {why}")))?;
                self.value(&crate::scxml::read::literal(&text))
            }
        }
    }

    /// Puts a value into a variable that the document names for it.
    pub(super) fn store(&mut self, location: &Code<Location>, text: &str) -> Result<(), Fault> {
        let value = self.memory.heap.text(text)?;
        let location = location.get()?;
        self.evaluation().assign(location, value, true)
    }

    /// An end is reached: what its event carries is evaluated now.
    fn done(&mut self, end: NodeId) {
        let prepared = self.prepared;
        let payload = prepared.document.done_data.iter().find(|(state, _)| *state == end);
        let data = match payload {
            Some((_, payload)) => self.payload(payload).unwrap_or_else(|fault| {
                self.tell(Err(fault.into()));
                Data::Undefined
            }),
            None => Data::Undefined,
        };
        let chart = prepared.chart.statechart();
        match chart.node(end).parent {
            Some(Statechart::ROOT) | None => self.book.end = Some((end, data)),
            Some(composite) => {
                self.book.done.entry(chart.node(composite).name.clone()).or_default().push_back(data);
            }
        }
    }
}

/// How many events one block may raise.
const MAX_RAISED: usize = 10_000;
