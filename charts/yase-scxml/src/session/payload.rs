//! Data of events.

use super::event::ScxmlEvent;
use super::execute::ContentExecutor;
use crate::compiled_text::CompiledText;
use crate::content::{Parameter, ParameterValue, Payload};
use crate::language::{DataValue, EvalError, Location};

impl ContentExecutor<'_> {
    /// The data of an event. A parameter that cannot be evaluated is left out and raises its own
    /// error.
    pub(crate) fn payload(&mut self, payload: &Payload) -> Result<DataValue, EvalError> {
        if let Some(content) = &payload.content {
            let value = self.source(content)?;
            return self.memory.export(&value);
        }
        let mut members = self.named(&payload.names)?;
        self.parameters(&payload.parameters, &mut members);
        Ok(if members.is_empty() { DataValue::Undefined } else { DataValue::Object(members) })
    }

    /// The values of a `namelist`.
    pub(crate) fn named(
        &mut self,
        names: &[CompiledText<Location>],
    ) -> Result<Vec<(String, DataValue)>, EvalError> {
        let mut members = Vec::new();
        for name in names {
            let location = name.get()?;
            let value = self.evaluation().read(location)?;
            members.push((name.text.clone(), self.memory.export(&value)?));
        }
        Ok(members)
    }

    pub(crate) fn parameters(&mut self, parameters: &[Parameter], members: &mut Vec<(String, DataValue)>) {
        for parameter in parameters {
            match self.parameter(&parameter.value) {
                Ok(data) => members.push((parameter.name.clone(), data)),
                Err(fault) => {
                    let message = format!("parameter `{}`: {}", parameter.name, fault.message);
                    self.state.raised.push(ScxmlEvent::error("error.execution", message));
                }
            }
        }
    }

    fn parameter(&mut self, value: &ParameterValue) -> Result<DataValue, EvalError> {
        let value = match value {
            ParameterValue::Expression(code) => self.value(code)?,
            ParameterValue::Location(code) => {
                let location = code.get()?;
                self.evaluation().read(location)?
            }
        };
        self.memory.export(&value)
    }
}
