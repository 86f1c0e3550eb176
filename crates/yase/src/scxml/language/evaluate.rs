//! What expressions are worth.

use std::cmp::Ordering;
use std::sync::Arc;

use super::convert::{truth, type_of};
use super::heap::{Content, Record};
use super::memory::Memory;
use super::syntax::{Access, Binary, Builtin, Expression, Function, Unary};
use super::value::Value;
use super::{Fault, MAX_TEXT};

/// How deeply evaluations may nest, functions that call functions included.
const MAX_DEPTH: u32 = 160;

/// Which states are active, by name.
pub(crate) trait ActiveStates {
    /// Whether a state is active; not, if there is none of that name.
    fn is_in(&self, state: &str) -> bool;
}

/// An evaluation on the variables of a session.
pub(crate) struct Evaluation<'a> {
    pub(super) memory: &'a mut Memory,
    states: &'a dyn ActiveStates,
    /// The variables of the function that runs.
    pub(super) frame: Option<Vec<(Arc<str>, Value)>>,
    depth: u32,
}

type Evaluated = Result<Value, Fault>;

impl<'a> Evaluation<'a> {
    pub(crate) fn new(memory: &'a mut Memory, states: &'a dyn ActiveStates) -> Evaluation<'a> {
        Evaluation { memory, states, frame: None, depth: 0 }
    }

    /// The value of an expression.
    pub(crate) fn value(&mut self, expression: &Expression) -> Evaluated {
        self.memory.step()?;
        if self.depth == MAX_DEPTH {
            return Err(Fault::new(format!("evaluations nest deeper than {MAX_DEPTH}")));
        }
        self.depth += 1;
        let value = self.dispatch(expression);
        self.depth -= 1;
        value
    }

    /// Whether a condition holds.
    pub(crate) fn holds(&mut self, condition: &Expression) -> Result<bool, Fault> {
        Ok(truth(&self.value(condition)?))
    }

    fn dispatch(&mut self, expression: &Expression) -> Evaluated {
        match expression {
            Expression::Literal(value) => Ok(value.clone()),
            Expression::Variable(name) => self.variable(name),
            Expression::Array(items) => {
                let items = self.values(items)?;
                self.memory.heap.array(items)
            }
            Expression::Object(members) => self.object(members),
            Expression::Function(function) => Ok(Value::Function(function.clone())),
            Expression::Unary(operator, operand) => self.unary(*operator, operand),
            Expression::Chain(first, rest) => self.chain(first, rest),
            Expression::And(operands) => self.logical(operands, false),
            Expression::Or(operands) => self.logical(operands, true),
            Expression::Choose(parts) => {
                let chosen = if self.holds(&parts[0])? { &parts[1] } else { &parts[2] };
                self.value(chosen)
            }
            Expression::Access(base, path) => self.access(base, path),
            Expression::Builtin(builtin, argument) => self.builtin(*builtin, argument),
        }
    }

    pub(super) fn values(&mut self, expressions: &[Expression]) -> Result<Vec<Value>, Fault> {
        expressions.iter().map(|expression| self.value(expression)).collect()
    }

    fn variable(&self, name: &str) -> Evaluated {
        self.lookup(name).cloned().ok_or_else(|| Fault::new(format!("there is no variable `{name}`")))
    }

    fn lookup(&self, name: &str) -> Option<&Value> {
        let local = self.frame.iter().flatten().find(|(local, _)| &**local == name);
        local.map(|(_, value)| value).or_else(|| self.memory.get(name))
    }

    fn object(&mut self, members: &[(Arc<str>, Expression)]) -> Evaluated {
        let mut record = Record::default();
        for (name, expression) in members {
            let value = self.value(expression)?;
            record.set(name, value);
        }
        self.memory.heap.record(record, false)
    }

    fn unary(&mut self, operator: Unary, operand: &Expression) -> Evaluated {
        if let (Unary::TypeOf, Expression::Variable(name)) = (operator, operand) {
            let kind = self.lookup(name).map_or("undefined", type_of);
            return Ok(Value::Text(kind.into()));
        }
        let value = self.value(operand)?;
        Ok(match operator {
            Unary::Not => Value::Bool(!truth(&value)),
            Unary::Minus => Value::Number(-self.memory.heap.number_of(&value)?),
            Unary::Plus => Value::Number(self.memory.heap.number_of(&value)?),
            Unary::TypeOf => Value::Text(type_of(&value).into()),
        })
    }

    fn chain(&mut self, first: &Expression, rest: &[(Binary, Expression)]) -> Evaluated {
        let mut value = self.value(first)?;
        for (operator, operand) in rest {
            let operand = self.value(operand)?;
            value = self.binary(*operator, &value, &operand)?;
        }
        Ok(value)
    }

    /// The first operand that decides, or the last.
    fn logical(&mut self, operands: &[Expression], decisive: bool) -> Evaluated {
        let mut value = Value::Undefined;
        for operand in operands {
            value = self.value(operand)?;
            if truth(&value) == decisive {
                break;
            }
        }
        Ok(value)
    }

    /// The value of an operator between two values.
    pub(super) fn binary(&mut self, operator: Binary, a: &Value, b: &Value) -> Evaluated {
        self.memory.look_through(size(a) + size(b))?;
        let heap = &self.memory.heap;
        Ok(Value::Bool(match operator {
            Binary::Equal => heap.equal(a, b)?,
            Binary::NotEqual => !heap.equal(a, b)?,
            Binary::Same => a == b,
            Binary::NotSame => a != b,
            Binary::Less => heap.order(a, b)? == Some(Ordering::Less),
            Binary::Greater => heap.order(a, b)? == Some(Ordering::Greater),
            Binary::LessOrEqual => matches!(heap.order(a, b)?, Some(Ordering::Less | Ordering::Equal)),
            Binary::GreaterOrEqual => matches!(heap.order(a, b)?, Some(Ordering::Greater | Ordering::Equal)),
            Binary::Within => self.within(a, b)?,
            Binary::Plus => return self.plus(a, b),
            _ => return self.arithmetic(operator, a, b),
        }))
    }

    fn within(&self, name: &Value, value: &Value) -> Result<bool, Fault> {
        let Value::Object(id) = value else {
            return Err(Fault::new("`in` needs an object on its right"));
        };
        let name = self.memory.heap.text_of(name)?;
        Ok(match self.memory.heap.get(*id).map(|object| &object.content) {
            Some(Content::Record(record)) => record.get(&name).is_some(),
            Some(Content::Array(items)) => {
                &*name == "length" || index_of(&name).is_some_and(|index| index < items.len())
            }
            None => false,
        })
    }

    fn plus(&mut self, a: &Value, b: &Value) -> Evaluated {
        let heap = &mut self.memory.heap;
        let (a, b) = (heap.primitive(a)?, heap.primitive(b)?);
        if !matches!(a, Value::Text(_)) && !matches!(b, Value::Text(_)) {
            return Ok(Value::Number(heap.number_of(&a)? + heap.number_of(&b)?));
        }
        let (a, b) = (heap.text_of(&a)?, heap.text_of(&b)?);
        if a.len() + b.len() > MAX_TEXT {
            return Err(Fault::new(format!("a text is longer than {MAX_TEXT} bytes")));
        }
        heap.text([&*a, &*b].concat())
    }

    fn arithmetic(&self, operator: Binary, a: &Value, b: &Value) -> Evaluated {
        let (a, b) = (self.memory.heap.number_of(a)?, self.memory.heap.number_of(b)?);
        Ok(Value::Number(match operator {
            Binary::Minus => a - b,
            Binary::Times => a * b,
            Binary::Over => a / b,
            _ => a % b,
        }))
    }

    fn builtin(&mut self, builtin: Builtin, argument: &Expression) -> Evaluated {
        let value = self.value(argument)?;
        let text = self.memory.heap.text_of(&value)?;
        match builtin {
            Builtin::In => Ok(Value::Bool(self.states.is_in(&text))),
            Builtin::String => self.memory.heap.text(text),
        }
    }

    fn access(&mut self, base: &Expression, path: &[Access]) -> Evaluated {
        let mut value = self.value(base)?;
        for step in path {
            let size = self.memory.heap.items(&value).map_or(size(&value), <[Value]>::len);
            let whole = matches!(step, Access::Method(..)) || matches!(value, Value::Text(_));
            self.memory.look_through(if whole { size } else { 0 })?;
            value = match step {
                Access::Member(name) => self.member(&value, name)?,
                Access::Index(index) => {
                    let index = self.value(index)?;
                    let name = self.memory.heap.text_of(&index)?;
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

    /// A member of a value; undefined, if it has none of that name.
    pub(super) fn member(&self, value: &Value, name: &str) -> Evaluated {
        let found = match value {
            Value::Undefined | Value::Null => {
                let what = type_name(value);
                return Err(Fault::new(format!("{what} has no member `{name}`")));
            }
            Value::Text(text) if name == "length" => Some(Value::Number(text.encode_utf16().count() as f64)),
            Value::Text(text) => index_of(name).and_then(|index| letter(text, index)),
            Value::Object(id) => match self.memory.heap.get(*id).map(|object| &object.content) {
                Some(Content::Record(record)) => record.get(name).cloned(),
                Some(Content::Array(items)) if name == "length" => Some(Value::Number(items.len() as f64)),
                Some(Content::Array(items)) => index_of(name).and_then(|index| items.get(index).cloned()),
                None => None,
            },
            _ => None,
        };
        Ok(found.unwrap_or(Value::Undefined))
    }

    fn call(&mut self, value: &Value, arguments: Vec<Value>) -> Evaluated {
        let Value::Function(function) = value else {
            return Err(Fault::new("what is called is not a function"));
        };
        let frame = Some(bound(function, arguments));
        let caller = std::mem::replace(&mut self.frame, frame);
        let returned = self.run_function(&function.body);
        self.frame = caller;
        returned
    }
}

fn bound(function: &Function, arguments: Vec<Value>) -> Vec<(Arc<str>, Value)> {
    let mut arguments = arguments.into_iter();
    let next = |name: &Arc<str>| (name.clone(), arguments.next().unwrap_or(Value::Undefined));
    function.parameters.iter().map(next).collect()
}

fn type_name(value: &Value) -> &'static str {
    if matches!(value, Value::Null) { "null" } else { "undefined" }
}

/// What it costs to look through a value.
fn size(value: &Value) -> usize {
    if let Value::Text(text) = value { text.len() } else { 0 }
}

fn letter(text: &str, index: usize) -> Option<Value> {
    let unit = text.encode_utf16().nth(index)?;
    Some(Value::Text(String::from_utf16_lossy(&[unit]).into()))
}

/// The index that a name is, as ECMAScript writes it.
pub(super) fn index_of(name: &str) -> Option<usize> {
    let canonical = name == "0" || !name.starts_with('0');
    let digits = name.bytes().all(|byte| byte.is_ascii_digit());
    if canonical && digits { name.parse().ok() } else { None }
}
