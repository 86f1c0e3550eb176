//! Evaluation of expressions.

use std::cmp::Ordering;
use std::sync::Arc;

use super::convert::{truth, type_of};
use super::heap::{ObjectContent, PropertyMap};
use super::memory::ScriptMemory;
use super::syntax::{Access, Binary, Builtin, ScriptExpression, ScriptFunction, Unary};
use super::value::ScriptValue;
use super::{EvalError, MAX_TEXT};

/// Maximum nesting of evaluations, including nested function calls.
const MAX_DEPTH: u32 = 160;

/// Looks up active states by name.
pub(crate) trait InPredicate {
    /// Whether a state is active; false if no state has that name.
    fn is_in(&self, state: &str) -> bool;
}

/// An evaluation with the variables of a session.
pub(crate) struct Evaluator<'a> {
    pub(crate) memory: &'a mut ScriptMemory,
    states: &'a dyn InPredicate,
    /// The variables of the current function.
    pub(crate) frame: Option<Vec<(Arc<str>, ScriptValue)>>,
    depth: u32,
}

type EvalResult = Result<ScriptValue, EvalError>;

impl<'a> Evaluator<'a> {
    pub(crate) fn new(memory: &'a mut ScriptMemory, states: &'a dyn InPredicate) -> Evaluator<'a> {
        Evaluator { memory, states, frame: None, depth: 0 }
    }

    /// The value of an expression.
    pub(crate) fn value(&mut self, expression: &ScriptExpression) -> EvalResult {
        self.memory.step()?;
        if self.depth == MAX_DEPTH {
            return Err(EvalError::new(format!("evaluations nest deeper than {MAX_DEPTH}")));
        }
        self.depth += 1;
        let value = self.dispatch(expression);
        self.depth -= 1;
        value
    }

    /// Whether a condition holds.
    pub(crate) fn holds(&mut self, condition: &ScriptExpression) -> Result<bool, EvalError> {
        Ok(truth(&self.value(condition)?))
    }

    fn dispatch(&mut self, expression: &ScriptExpression) -> EvalResult {
        match expression {
            ScriptExpression::Literal(value) => Ok(value.clone()),
            ScriptExpression::Variable(name) => self.variable(name),
            ScriptExpression::Array(items) => {
                let items = self.values(items)?;
                self.memory.heap.array(items)
            }
            ScriptExpression::Object(members) => self.object(members),
            ScriptExpression::Function(function) => Ok(ScriptValue::Function(function.clone())),
            ScriptExpression::Unary(operator, operand) => self.unary(*operator, operand),
            ScriptExpression::Chain(first, rest) => self.chain(first, rest),
            ScriptExpression::And(operands) => self.logical(operands, false),
            ScriptExpression::Or(operands) => self.logical(operands, true),
            ScriptExpression::Choose(parts) => {
                let chosen = if self.holds(&parts[0])? { &parts[1] } else { &parts[2] };
                self.value(chosen)
            }
            ScriptExpression::Access(base, path) => self.access(base, path),
            ScriptExpression::Builtin(builtin, argument) => self.builtin(*builtin, argument),
            ScriptExpression::Library(function, arguments) => {
                let arguments = self.values(arguments)?;
                self.library(*function, &arguments)
            }
        }
    }

    pub(crate) fn values(&mut self, expressions: &[ScriptExpression]) -> Result<Vec<ScriptValue>, EvalError> {
        expressions.iter().map(|expression| self.value(expression)).collect()
    }

    fn variable(&self, name: &str) -> EvalResult {
        self.lookup(name).cloned().ok_or_else(|| EvalError::new(format!("there is no variable `{name}`")))
    }

    fn lookup(&self, name: &str) -> Option<&ScriptValue> {
        let local = self.frame.iter().flatten().find(|(local, _)| &**local == name);
        local.map(|(_, value)| value).or_else(|| self.memory.get(name))
    }

    fn object(&mut self, members: &[(Arc<str>, ScriptExpression)]) -> EvalResult {
        let mut record = PropertyMap::default();
        for (name, expression) in members {
            let value = self.value(expression)?;
            record.set(name, value);
        }
        self.memory.heap.record(record, false)
    }

    fn unary(&mut self, operator: Unary, operand: &ScriptExpression) -> EvalResult {
        if let (Unary::TypeOf, ScriptExpression::Variable(name)) = (operator, operand) {
            let kind = self.lookup(name).map_or("undefined", type_of);
            return Ok(ScriptValue::Text(kind.into()));
        }
        let value = self.value(operand)?;
        Ok(match operator {
            Unary::Not => ScriptValue::Bool(!truth(&value)),
            Unary::Minus => ScriptValue::Number(-self.memory.number_of(&value)?),
            Unary::Plus => ScriptValue::Number(self.memory.number_of(&value)?),
            Unary::TypeOf => ScriptValue::Text(type_of(&value).into()),
        })
    }

    fn chain(&mut self, first: &ScriptExpression, rest: &[(Binary, ScriptExpression)]) -> EvalResult {
        let mut value = self.value(first)?;
        for (operator, operand) in rest {
            let operand = self.value(operand)?;
            value = self.binary(*operator, &value, &operand)?;
        }
        Ok(value)
    }

    /// The first operand that decides the result, or the last.
    fn logical(&mut self, operands: &[ScriptExpression], decisive: bool) -> EvalResult {
        let mut value = ScriptValue::Undefined;
        for operand in operands {
            value = self.value(operand)?;
            if truth(&value) == decisive {
                break;
            }
        }
        Ok(value)
    }

    /// Result of a binary operator.
    pub(crate) fn binary(&mut self, operator: Binary, a: &ScriptValue, b: &ScriptValue) -> EvalResult {
        self.memory.charge_reading(size(a) + size(b))?;
        let ScriptMemory { heap, steps, .. } = &mut *self.memory;
        Ok(ScriptValue::Bool(match operator {
            Binary::Equal => heap.equal(a, b, steps)?,
            Binary::NotEqual => !heap.equal(a, b, steps)?,
            Binary::Same => a == b,
            Binary::NotSame => a != b,
            Binary::Less => heap.order(a, b, steps)? == Some(Ordering::Less),
            Binary::Greater => heap.order(a, b, steps)? == Some(Ordering::Greater),
            Binary::LessOrEqual => matches!(heap.order(a, b, steps)?, Some(Ordering::Less | Ordering::Equal)),
            Binary::GreaterOrEqual => {
                matches!(heap.order(a, b, steps)?, Some(Ordering::Greater | Ordering::Equal))
            }
            Binary::Within => self.within(a, b)?,
            Binary::Plus => return self.plus(a, b),
            _ => return self.arithmetic(operator, a, b),
        }))
    }

    fn within(&mut self, name: &ScriptValue, value: &ScriptValue) -> Result<bool, EvalError> {
        let ScriptValue::Object(id) = value else {
            return Err(EvalError::new("`in` needs an object on its right"));
        };
        let name = self.memory.text_of(name)?;
        Ok(match self.memory.heap.get(*id).map(|object| &object.content) {
            Some(ObjectContent::Record(record)) => record.get(&name).is_some(),
            Some(ObjectContent::Array(items)) => {
                &*name == "length" || index_of(&name).is_some_and(|index| index < items.len())
            }
            None => false,
        })
    }

    fn plus(&mut self, a: &ScriptValue, b: &ScriptValue) -> EvalResult {
        let ScriptMemory { heap, steps, .. } = &mut *self.memory;
        let (a, b) = (heap.primitive(a, steps)?, heap.primitive(b, steps)?);
        if !matches!(a, ScriptValue::Text(_)) && !matches!(b, ScriptValue::Text(_)) {
            return Ok(ScriptValue::Number(heap.number_of(&a, steps)? + heap.number_of(&b, steps)?));
        }
        let (a, b) = (heap.text_of(&a, steps)?, heap.text_of(&b, steps)?);
        if a.len() + b.len() > MAX_TEXT {
            return Err(EvalError::new(format!("a text is longer than {MAX_TEXT} bytes")));
        }
        heap.text([&*a, &*b].concat())
    }

    fn arithmetic(&mut self, operator: Binary, a: &ScriptValue, b: &ScriptValue) -> EvalResult {
        let (a, b) = (self.memory.number_of(a)?, self.memory.number_of(b)?);
        Ok(ScriptValue::Number(match operator {
            Binary::Minus => a - b,
            Binary::Times => a * b,
            Binary::Over => a / b,
            _ => a % b,
        }))
    }

    fn builtin(&mut self, builtin: Builtin, argument: &ScriptExpression) -> EvalResult {
        let value = self.value(argument)?;
        let text = self.memory.text_of(&value)?;
        match builtin {
            Builtin::In => Ok(ScriptValue::Bool(self.states.is_in(&text))),
            Builtin::String => self.memory.heap.text(text),
        }
    }

    fn access(&mut self, base: &ScriptExpression, path: &[Access]) -> EvalResult {
        let mut value = self.value(base)?;
        for step in path {
            let size = self.memory.heap.items(&value).map_or(size(&value), <[ScriptValue]>::len);
            let whole = matches!(step, Access::Method(..)) || matches!(value, ScriptValue::Text(_));
            self.memory.charge_reading(if whole { size } else { 0 })?;
            value = match step {
                Access::Member(name) => self.member(&value, name)?,
                Access::Index(index) => {
                    let index = self.value(index)?;
                    let name = self.memory.text_of(&index)?;
                    self.member(&value, &name)?
                }
                Access::Call(arguments) => {
                    let arguments = self.values(arguments)?;
                    self.call(&value, arguments)?
                }
                Access::Method(method, arguments) => {
                    let arguments = self.values(arguments)?;
                    self.method(*method, &value, &arguments)?
                }
            };
        }
        Ok(value)
    }

    /// A member of a value; undefined if there is none with that name.
    pub(crate) fn member(&self, value: &ScriptValue, name: &str) -> EvalResult {
        let found = match value {
            ScriptValue::Undefined | ScriptValue::Null => {
                let what = type_name(value);
                return Err(EvalError::new(format!("{what} has no member `{name}`")));
            }
            ScriptValue::Text(text) if name == "length" => {
                Some(ScriptValue::Number(text.encode_utf16().count() as f64))
            }
            ScriptValue::Text(text) => index_of(name).and_then(|index| letter(text, index)),
            ScriptValue::Object(id) => match self.memory.heap.get(*id).map(|object| &object.content) {
                Some(ObjectContent::Record(record)) => record.get(name).cloned(),
                Some(ObjectContent::Array(items)) if name == "length" => {
                    Some(ScriptValue::Number(items.len() as f64))
                }
                Some(ObjectContent::Array(items)) => {
                    index_of(name).and_then(|index| items.get(index).cloned())
                }
                None => None,
            },
            _ => None,
        };
        Ok(found.unwrap_or(ScriptValue::Undefined))
    }

    fn call(&mut self, value: &ScriptValue, arguments: Vec<ScriptValue>) -> EvalResult {
        let ScriptValue::Function(function) = value else {
            return Err(EvalError::new("what is called is not a function"));
        };
        let frame = Some(bound(function, arguments));
        let caller = std::mem::replace(&mut self.frame, frame);
        let returned = self.run_function(&function.body);
        self.frame = caller;
        returned
    }
}

fn bound(function: &ScriptFunction, arguments: Vec<ScriptValue>) -> Vec<(Arc<str>, ScriptValue)> {
    let mut arguments = arguments.into_iter();
    let next = |name: &Arc<str>| (name.clone(), arguments.next().unwrap_or(ScriptValue::Undefined));
    function.parameters.iter().map(next).collect()
}

fn type_name(value: &ScriptValue) -> &'static str {
    if matches!(value, ScriptValue::Null) { "null" } else { "undefined" }
}

/// Cost of reading a value.
fn size(value: &ScriptValue) -> usize {
    if let ScriptValue::Text(text) = value { text.len() } else { 0 }
}

fn letter(text: &str, index: usize) -> Option<ScriptValue> {
    let unit = text.encode_utf16().nth(index)?;
    Some(ScriptValue::Text(String::from_utf16_lossy(&[unit]).into()))
}

/// The index that a name represents, in the format of ECMAScript.
pub(crate) fn index_of(name: &str) -> Option<usize> {
    let canonical = name == "0" || !name.starts_with('0');
    let digits = name.bytes().all(|byte| byte.is_ascii_digit());
    if canonical && digits { name.parse().ok() } else { None }
}
