//! What events carry.

use super::event::Event;
use super::execute::Execution;
use crate::scxml::code::Code;
use crate::scxml::content::{Parameter, ParameterValue, Payload};
use crate::scxml::language::{Data, Fault, Location};

impl Execution<'_> {
    /// The data of an event. A parameter that cannot be evaluated is left out, and is an error of its own.
    pub(super) fn payload(&mut self, payload: &Payload) -> Result<Data, Fault> {
        if let Some(content) = &payload.content {
            let value = self.source(content)?;
            return self.memory.heap.export(&value);
        }
        let mut members = self.named(&payload.names)?;
        self.parameters(&payload.parameters, &mut members);
        Ok(if members.is_empty() { Data::Undefined } else { Data::Object(members) })
    }

    /// The values of a `namelist`.
    pub(super) fn named(&mut self, names: &[Code<Location>]) -> Result<Vec<(String, Data)>, Fault> {
        let mut members = Vec::new();
        for name in names {
            let location = name.get()?;
            let value = self.evaluation().read(location)?;
            members.push((name.text.clone(), self.memory.heap.export(&value)?));
        }
        Ok(members)
    }

    pub(super) fn parameters(&mut self, parameters: &[Parameter], members: &mut Vec<(String, Data)>) {
        for parameter in parameters {
            match self.parameter(&parameter.value) {
                Ok(data) => members.push((parameter.name.clone(), data)),
                Err(fault) => {
                    let message = format!("parameter `{}`: {}", parameter.name, fault.message);
                    self.book.raised.push(Event::error("error.execution", message));
                }
            }
        }
    }

    fn parameter(&mut self, value: &ParameterValue) -> Result<Data, Fault> {
        let value = match value {
            ParameterValue::Expression(code) => self.value(code)?,
            ParameterValue::Location(code) => {
                let location = code.get()?;
                self.evaluation().read(location)?
            }
        };
        self.memory.heap.export(&value)
    }
}
