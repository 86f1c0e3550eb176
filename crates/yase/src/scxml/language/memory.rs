//! The variables of a session.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::Fault;
use super::heap::Heap;
use super::value::Value;

/// Variables that the session sets and documents only read.
const SYSTEM: [&str; 5] = ["_event", "_sessionid", "_name", "_ioprocessors", "_x"];

/// How many steps the expressions and contents of one macrostep may take.
const MAX_STEPS: u32 = 2_000_000;

/// Variables, the objects they reach, and what is left of the work that one macrostep may do.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    pub(super) variables: BTreeMap<Arc<str>, Value>,
    pub(crate) heap: Heap,
    /// Values that are in use but in no variable.
    pinned: Vec<Value>,
    steps: u32,
}

impl Memory {
    pub(crate) fn new() -> Memory {
        Memory { variables: BTreeMap::new(), heap: Heap::default(), pinned: Vec::new(), steps: MAX_STEPS }
    }

    pub(crate) fn get(&self, name: &str) -> Option<&Value> {
        self.variables.get(name)
    }

    /// A member of what a variable holds.
    pub(crate) fn member_of(&self, variable: &str, name: &str) -> Option<Value> {
        self.heap.member(self.get(variable)?, name)
    }

    /// Makes a variable, without a value if it has none.
    pub(crate) fn declare(&mut self, name: &str) -> Result<(), Fault> {
        writable(name)?;
        if !self.variables.contains_key(name) {
            self.heap.charge_member(name)?;
            self.variables.insert(name.into(), Value::Undefined);
        }
        Ok(())
    }

    pub(crate) fn set(&mut self, name: &str, value: Value) -> Result<(), Fault> {
        writable(name)?;
        match self.variables.get_mut(name) {
            Some(variable) => *variable = value,
            None => {
                self.heap.charge_member(name)?;
                self.variables.insert(name.into(), value);
            }
        }
        Ok(())
    }

    /// Sets what documents cannot.
    pub(crate) fn set_system(&mut self, name: &str, value: Value) {
        self.variables.insert(name.into(), value);
    }

    /// Keeps a value alive until it is unpinned.
    pub(crate) fn pin(&mut self, value: Value) {
        self.pinned.push(value);
    }

    pub(crate) fn unpin(&mut self) {
        self.pinned.pop();
    }

    /// Frees what is out of reach, if there is much of it. Only between contents: an evaluation holds values of its own.
    pub(crate) fn tidy(&mut self) -> Result<(), Fault> {
        if self.heap.is_due() {
            self.heap.collect(self.variables.values().chain(&self.pinned))?;
        }
        Ok(())
    }

    /// Takes one step of work.
    pub(crate) fn step(&mut self) -> Result<(), Fault> {
        match self.steps.checked_sub(1) {
            Some(steps) => {
                self.steps = steps;
                Ok(())
            }
            None => Err(Fault::new(format!("one macrostep takes more than {MAX_STEPS} steps of evaluation"))),
        }
    }

    /// Takes as many steps as it costs to look through that many bytes or items.
    pub(crate) fn look_through(&mut self, size: usize) -> Result<(), Fault> {
        let steps = u32::try_from(size / 64).unwrap_or(u32::MAX);
        self.steps = self.steps.saturating_sub(steps);
        self.step()
    }

    /// Whether the macrostep has done all the work it may.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.steps == 0
    }

    /// A new macrostep begins.
    pub(crate) fn refresh(&mut self) {
        self.steps = MAX_STEPS;
    }
}

pub(super) fn writable(name: &str) -> Result<(), Fault> {
    match SYSTEM.contains(&name) {
        true => Err(Fault::new(format!("`{name}` cannot be assigned"))),
        false => Ok(()),
    }
}
