//! What scripts do.

use std::sync::Arc;

use super::Fault;
use super::evaluate::{Evaluation, index_of};
use super::heap::Content;
use super::memory::writable;
use super::syntax::{Access, Location, Program, Statement};
use super::value::Value;

/// The longest array there may be.
const MAX_ITEMS: usize = 1 << 18;

impl Evaluation<'_> {
    /// Runs a script.
    pub(crate) fn run(&mut self, program: &Program) -> Result<(), Fault> {
        self.statements(&program.statements).map(|_| ())
    }

    pub(super) fn run_function(&mut self, body: &[Statement]) -> Result<Value, Fault> {
        Ok(self.statements(body)?.unwrap_or(Value::Undefined))
    }

    /// Runs statements up to the first that returns something.
    fn statements(&mut self, statements: &[Statement]) -> Result<Option<Value>, Fault> {
        for statement in statements {
            self.memory.step()?;
            let returned = self.statement(statement)?;
            if returned.is_some() {
                return Ok(returned);
            }
        }
        Ok(None)
    }

    fn statement(&mut self, statement: &Statement) -> Result<Option<Value>, Fault> {
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
                return Ok(Some(value.unwrap_or(Value::Undefined)));
            }
        }
        Ok(None)
    }

    fn declare(&mut self, name: &Arc<str>, value: Option<Value>) -> Result<(), Fault> {
        match &mut self.frame {
            Some(frame) => {
                let known = frame.iter_mut().find(|(local, _)| local == name);
                match (known, value) {
                    (Some((_, variable)), Some(value)) => *variable = value,
                    (Some(_), None) => {}
                    (None, value) => frame.push((name.clone(), value.unwrap_or(Value::Undefined))),
                }
                Ok(())
            }
            None => match value {
                Some(value) => self.memory.set(name, value),
                None => self.memory.declare(name),
            },
        }
    }

    /// The value that a place holds.
    pub(crate) fn read(&mut self, location: &Location) -> Result<Value, Fault> {
        let mut value = self.value(&super::Expression::Variable(location.variable.clone()))?;
        for step in &location.path {
            let name = self.name_of(step)?;
            value = self.member(&value, &name)?;
        }
        Ok(value)
    }

    fn name_of(&mut self, step: &Access) -> Result<Arc<str>, Fault> {
        match step {
            Access::Member(name) => Ok(name.clone()),
            Access::Index(index) => {
                let index = self.value(index)?;
                self.memory.heap.text_of(&index)
            }
            _ => Err(Fault::new("nothing can be assigned to what a function returns")),
        }
    }

    /// Puts a value into a place. `declared`: whether the variable must have been declared.
    pub(crate) fn assign(&mut self, location: &Location, value: Value, declared: bool) -> Result<(), Fault> {
        let Some((last, path)) = location.path.split_last() else {
            return self.assign_variable(&location.variable, value, declared);
        };
        writable(&location.variable)?;
        let owner = Location { variable: location.variable.clone(), path: path.to_vec() };
        let owner = self.read(&owner)?;
        let name = self.name_of(last)?;
        self.set_member(&owner, &name, value)
    }

    fn assign_variable(&mut self, name: &Arc<str>, value: Value, declared: bool) -> Result<(), Fault> {
        let local = self.frame.iter_mut().flatten().find(|(local, _)| local == name);
        if let Some((_, variable)) = local {
            *variable = value;
            return Ok(());
        }
        writable(name)?;
        if declared && self.memory.get(name).is_none() {
            return Err(Fault::new(format!("there is no variable `{name}`")));
        }
        self.memory.set(name, value)
    }

    fn set_member(&mut self, owner: &Value, name: &str, value: Value) -> Result<(), Fault> {
        let Value::Object(id) = owner else {
            return Err(Fault::new(format!("`{name}` is assigned to what is no object")));
        };
        let heap = &mut self.memory.heap;
        let array = heap.items(owner).map(<[Value]>::len);
        match (array, index_of(name)) {
            (Some(length), Some(index)) if index < MAX_ITEMS => {
                heap.charge_items((index + 1).saturating_sub(length))?;
            }
            (Some(_), _) => {
                return Err(Fault::new(format!("`{name}` is not a place in an array")));
            }
            (None, _) => heap.charge_member(name)?,
        }
        match heap.change(*id)? {
            Content::Array(items) => {
                let index = index_of(name).unwrap_or_default();
                if items.len() <= index {
                    items.resize(index + 1, Value::Undefined);
                }
                items[index] = value;
            }
            Content::Record(record) => record.set(name, value),
        }
        Ok(())
    }
}
