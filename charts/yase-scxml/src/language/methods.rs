//! The methods of arrays and texts.

use super::EvalError;
use super::evaluate::Evaluator;
use super::heap::ObjectContent;
use super::memory::ScriptMemory;
use super::syntax::Method;
use super::value::ScriptValue;

impl Evaluator<'_> {
    /// The result of a method of a value.
    pub(crate) fn method(
        &mut self,
        method: Method,
        owner: &ScriptValue,
        arguments: &[ScriptValue],
    ) -> Result<ScriptValue, EvalError> {
        match (owner, method) {
            (ScriptValue::Text(text), Method::Slice) => {
                let units: Vec<u16> = text.encode_utf16().collect();
                let (start, end) = self.range(units.len(), arguments)?;
                self.memory.heap.text(String::from_utf16_lossy(&units[start..end]))
            }
            (ScriptValue::Text(text), Method::Concat) => {
                let mut whole = text.to_string();
                for argument in arguments {
                    whole.push_str(&self.memory.text_of(argument)?);
                    if whole.len() > super::MAX_TEXT {
                        return Err(EvalError::new(format!(
                            "a text is longer than {} bytes",
                            super::MAX_TEXT
                        )));
                    }
                }
                self.memory.heap.text(whole)
            }
            (ScriptValue::Object(_), method) => self.array_method(method, owner, arguments),
            _ => Err(no_method(method)),
        }
    }

    fn array_method(
        &mut self,
        method: Method,
        owner: &ScriptValue,
        arguments: &[ScriptValue],
    ) -> Result<ScriptValue, EvalError> {
        let Some(length) = self.memory.heap.items(owner).map(<[ScriptValue]>::len) else {
            return Err(no_method(method));
        };
        match method {
            Method::Slice => {
                let (start, end) = self.range(length, arguments)?;
                self.copied(owner, start, end)
            }
            Method::Concat => self.joined(owner, arguments),
            Method::Push => self.pushed(owner, arguments),
            Method::Join => {
                let separator = match arguments.first() {
                    None | Some(ScriptValue::Undefined) => ",".into(),
                    Some(separator) => self.memory.text_of(separator)?,
                };
                let mut text = String::new();
                let ScriptMemory { heap, steps, .. } = &mut *self.memory;
                let items = heap.items(owner).unwrap_or_default();
                heap.write_items(items, &separator, 32, &mut text, steps)?;
                self.memory.heap.text(text)
            }
        }
    }

    fn copied(&mut self, owner: &ScriptValue, start: usize, end: usize) -> Result<ScriptValue, EvalError> {
        self.memory.heap.charge_items(end - start)?;
        let items = self.memory.heap.items(owner).unwrap_or_default()[start..end].to_vec();
        self.memory.heap.array(items)
    }

    fn joined(&mut self, owner: &ScriptValue, arguments: &[ScriptValue]) -> Result<ScriptValue, EvalError> {
        let mut whole = Vec::new();
        for part in std::iter::once(owner).chain(arguments) {
            let length = self.memory.heap.items(part).map_or(1, <[ScriptValue]>::len);
            self.memory.charge_reading(length)?;
            self.memory.heap.charge_items(length)?;
            match self.memory.heap.items(part) {
                Some(items) => whole.extend_from_slice(items),
                None => whole.push(part.clone()),
            }
        }
        self.memory.heap.array(whole)
    }

    fn pushed(&mut self, owner: &ScriptValue, arguments: &[ScriptValue]) -> Result<ScriptValue, EvalError> {
        self.memory.heap.charge_items(arguments.len())?;
        let ScriptValue::Object(id) = owner else { return Err(no_method(Method::Push)) };
        match self.memory.heap.change(*id)? {
            ObjectContent::Array(items) => {
                items.extend_from_slice(arguments);
                Ok(ScriptValue::Number(items.len() as f64))
            }
            ObjectContent::Record(_) => Err(no_method(Method::Push)),
        }
    }

    /// The range of a value of this length that the arguments of `slice` select.
    fn range(&mut self, length: usize, arguments: &[ScriptValue]) -> Result<(usize, usize), EvalError> {
        let mut place = |argument: Option<&ScriptValue>, missing: usize| match argument {
            None | Some(ScriptValue::Undefined) => Ok(missing),
            Some(value) => {
                let number = self.memory.number_of(value)?.trunc();
                let from_end = if number < 0.0 { number + length as f64 } else { number };
                Ok(from_end.clamp(0.0, length as f64) as usize)
            }
        };
        let start = place(arguments.first(), 0)?;
        let end = place(arguments.get(1), length)?;
        Ok((start, end.max(start)))
    }
}

fn no_method(method: Method) -> EvalError {
    EvalError::new(format!("the value has no method `{}`", format!("{method:?}").to_lowercase()))
}
