//! Execution of scripts.

use std::sync::Arc;

use super::EvalError;
use super::evaluate::{Evaluator, index_of};
use super::heap::ObjectContent;
use super::memory::writable;
use super::syntax::{Access, Location, ScriptProgram, Statement};
use super::value::ScriptValue;

/// Maximum length of an array.
const MAX_ITEMS: usize = 1 << 18;

impl Evaluator<'_> {
    /// Runs a script.
    pub(crate) fn run(&mut self, program: &ScriptProgram) -> Result<(), EvalError> {
        self.statements(&program.statements).map(|_| ())
    }

    pub(crate) fn run_function(&mut self, body: &[Statement]) -> Result<ScriptValue, EvalError> {
        Ok(self.statements(body)?.unwrap_or(ScriptValue::Undefined))
    }

    /// Runs statements up to the first that returns a value.
    fn statements(&mut self, statements: &[Statement]) -> Result<Option<ScriptValue>, EvalError> {
        for statement in statements {
            self.memory.step()?;
            let returned = self.statement(statement)?;
            if returned.is_some() {
                return Ok(returned);
            }
        }
        Ok(None)
    }

    fn statement(&mut self, statement: &Statement) -> Result<Option<ScriptValue>, EvalError> {
        match statement {
            Statement::Declare(names) => {
                for (name, value) in names {
                    let value = value.as_ref().map(|value| self.value(value)).transpose()?;
                    self.declare(name, value)?;
                }
            }
            Statement::Assign(location, operator, expression) => {
                let value = match operator {
                    None => self.value(expression)?,
                    Some(operator) => {
                        let old = self.read(location)?;
                        let operand = self.value(expression)?;
                        self.binary(*operator, &old, &operand)?
                    }
                };
                self.assign(location, value, false)?;
            }
            Statement::Evaluate(expression) => {
                self.value(expression)?;
            }
            Statement::If(condition, yes, no) => {
                let branch = if self.holds(condition)? { yes } else { no };
                return self.statements(branch);
            }
            Statement::Return(value) => {
                let value = value.as_ref().map(|value| self.value(value)).transpose()?;
                return Ok(Some(value.unwrap_or(ScriptValue::Undefined)));
            }
        }
        Ok(None)
    }

    fn declare(&mut self, name: &Arc<str>, value: Option<ScriptValue>) -> Result<(), EvalError> {
        match &mut self.frame {
            Some(frame) => {
                let known = frame.iter_mut().find(|(local, _)| local == name);
                match (known, value) {
                    (Some((_, variable)), Some(value)) => *variable = value,
                    (Some(_), None) => {}
                    (None, value) => frame.push((name.clone(), value.unwrap_or(ScriptValue::Undefined))),
                }
                Ok(())
            }
            None => match value {
                Some(value) => self.memory.set(name, value),
                None => self.memory.declare(name),
            },
        }
    }

    /// The value at a location.
    pub(crate) fn read(&mut self, location: &Location) -> Result<ScriptValue, EvalError> {
        let mut value = self.value(&super::ScriptExpression::Variable(location.variable.clone()))?;
        for step in &location.path {
            let name = self.name_of(step)?;
            value = self.member(&value, &name)?;
        }
        Ok(value)
    }

    fn name_of(&mut self, step: &Access) -> Result<Arc<str>, EvalError> {
        match step {
            Access::Member(name) => Ok(name.clone()),
            Access::Index(index) => {
                let index = self.value(index)?;
                self.memory.text_of(&index)
            }
            _ => Err(EvalError::new("nothing can be assigned to what a function returns")),
        }
    }

    /// Stores a value at a location. `declared`: whether the variable must have been declared.
    pub(crate) fn assign(
        &mut self,
        location: &Location,
        value: ScriptValue,
        declared: bool,
    ) -> Result<(), EvalError> {
        let Some((last, path)) = location.path.split_last() else {
            return self.assign_variable(&location.variable, value, declared);
        };
        writable(&location.variable)?;
        let owner = Location { variable: location.variable.clone(), path: path.to_vec() };
        let owner = self.read(&owner)?;
        let name = self.name_of(last)?;
        self.set_member(&owner, &name, value)
    }

    fn assign_variable(
        &mut self,
        name: &Arc<str>,
        value: ScriptValue,
        declared: bool,
    ) -> Result<(), EvalError> {
        let local = self.frame.iter_mut().flatten().find(|(local, _)| local == name);
        if let Some((_, variable)) = local {
            *variable = value;
            return Ok(());
        }
        writable(name)?;
        if declared && self.memory.get(name).is_none() {
            return Err(EvalError::new(format!("there is no variable `{name}`")));
        }
        self.memory.set(name, value)
    }

    fn set_member(&mut self, owner: &ScriptValue, name: &str, value: ScriptValue) -> Result<(), EvalError> {
        let ScriptValue::Object(id) = owner else {
            return Err(EvalError::new(format!("`{name}` is assigned to what is not an object")));
        };
        let heap = &mut self.memory.heap;
        let array = heap.items(owner).map(<[ScriptValue]>::len);
        match (array, index_of(name)) {
            (Some(length), Some(index)) if index < MAX_ITEMS => {
                heap.charge_items((index + 1).saturating_sub(length))?;
            }
            (Some(_), _) => {
                return Err(EvalError::new(format!("`{name}` is not a place in an array")));
            }
            (None, _) => heap.charge_member(name)?,
        }
        match heap.change(*id)? {
            ObjectContent::Array(items) => {
                let index = index_of(name).unwrap_or_default();
                if items.len() <= index {
                    items.resize(index + 1, ScriptValue::Undefined);
                }
                items[index] = value;
            }
            ObjectContent::Record(record) => record.set(name, value),
        }
        Ok(())
    }
}
