//! The variables of a session.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::EvalError;
use super::heap::Heap;
use super::value::{DataValue, ScriptValue};

/// Variables that only the session sets; documents only read them.
const SYSTEM_VARIABLES: [&str; 5] = ["_event", "_sessionid", "_name", "_ioprocessors", "_x"];

/// Maximum number of steps of the expressions and contents in one macrostep.
const MAX_STEPS: u32 = 2_000_000;

/// Variables, the objects they reach, and the remaining work of the macrostep.
#[derive(Clone, Debug)]
pub(crate) struct ScriptMemory {
    pub(crate) variables: BTreeMap<Arc<str>, ScriptValue>,
    pub(crate) heap: Heap,
    /// Values in use that no variable holds.
    pinned: Vec<ScriptValue>,
    pub(crate) steps: StepBudget,
}

/// The remaining steps of evaluation of a macrostep.
#[derive(Clone, Debug)]
pub(crate) struct StepBudget {
    left: u32,
}

impl Default for StepBudget {
    fn default() -> StepBudget {
        StepBudget { left: MAX_STEPS }
    }
}

impl StepBudget {
    /// Charges one step of work.
    pub(crate) fn step(&mut self) -> Result<(), EvalError> {
        match self.left.checked_sub(1) {
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => {
                Err(EvalError::new(format!("one macrostep takes more than {MAX_STEPS} steps of evaluation")))
            }
        }
    }

    /// Charges the steps for reading this many bytes or items.
    pub(crate) fn charge_reading(&mut self, size: usize) -> Result<(), EvalError> {
        let steps = u32::try_from(size / 64).unwrap_or(u32::MAX);
        self.left = self.left.saturating_sub(steps);
        self.step()
    }

    /// Whether all steps are used.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.left == 0
    }
}

impl ScriptMemory {
    pub(crate) fn new() -> ScriptMemory {
        ScriptMemory {
            variables: BTreeMap::new(),
            heap: Heap::default(),
            pinned: Vec::new(),
            steps: StepBudget::default(),
        }
    }

    pub(crate) fn get(&self, name: &str) -> Option<&ScriptValue> {
        self.variables.get(name)
    }

    /// A member of the value of a variable.
    pub(crate) fn member_of(&self, variable: &str, name: &str) -> Option<ScriptValue> {
        self.heap.member(self.get(variable)?, name)
    }

    /// Declares a variable; a new one has no value.
    pub(crate) fn declare(&mut self, name: &str) -> Result<(), EvalError> {
        writable(name)?;
        if !self.variables.contains_key(name) {
            self.heap.charge_member(name)?;
            self.variables.insert(name.into(), ScriptValue::Undefined);
        }
        Ok(())
    }

    pub(crate) fn set(&mut self, name: &str, value: ScriptValue) -> Result<(), EvalError> {
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

    /// Sets a system variable.
    pub(crate) fn set_system(&mut self, name: &str, value: ScriptValue) {
        self.variables.insert(name.into(), value);
    }

    /// Keeps a value alive until it is unpinned.
    pub(crate) fn pin(&mut self, value: ScriptValue) {
        self.pinned.push(value);
    }

    pub(crate) fn unpin(&mut self) {
        self.pinned.pop();
    }

    /// Frees unreachable objects if there are many. Call only between contents: an evaluation holds
    /// values.
    pub(crate) fn collect_garbage(&mut self) -> Result<(), EvalError> {
        if self.heap.is_due() {
            self.heap.collect(self.variables.values().chain(&self.pinned))?;
        }
        Ok(())
    }

    /// Charges one step of work.
    pub(crate) fn step(&mut self) -> Result<(), EvalError> {
        self.steps.step()
    }

    /// Charges the steps for reading this many bytes or items.
    pub(crate) fn charge_reading(&mut self, size: usize) -> Result<(), EvalError> {
        self.steps.charge_reading(size)
    }

    /// Copies a value with everything that it refers to, and charges the steps for reading it.
    pub(crate) fn export(&mut self, value: &ScriptValue) -> Result<DataValue, EvalError> {
        self.heap.export(value, &mut self.steps)
    }

    /// The text of a value.
    pub(crate) fn text_of(&mut self, value: &ScriptValue) -> Result<Arc<str>, EvalError> {
        self.heap.text_of(value, &mut self.steps)
    }

    /// The number of a value.
    pub(crate) fn number_of(&mut self, value: &ScriptValue) -> Result<f64, EvalError> {
        self.heap.number_of(value, &mut self.steps)
    }

    /// Whether the macrostep has used all its steps.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.steps.is_exhausted()
    }

    /// Begins a new macrostep.
    pub(crate) fn refresh(&mut self) {
        self.steps = StepBudget::default();
    }
}

pub(crate) fn writable(name: &str) -> Result<(), EvalError> {
    match SYSTEM_VARIABLES.contains(&name) {
        true => Err(EvalError::new(format!("`{name}` cannot be assigned"))),
        false => Ok(()),
    }
}
