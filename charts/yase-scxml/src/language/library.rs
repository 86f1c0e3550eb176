//! The part of ECMAScript's library that documents may use: `Math` without `random`,
//! `JSON.stringify`, `isNaN` and `isFinite`.
//!
//! Functions of `Math` come from `libm`, so that equal documents compute equal numbers everywhere.

use std::fmt::Write;
use std::sync::Arc;

use super::convert::number_text;
use super::evaluate::Evaluator;
use super::heap::{Heap, ObjectContent};
use super::memory::{ScriptMemory, StepBudget};
use super::value::{ScriptValue, quoted};
use super::{EvalError, MAX_TEXT};

/// Maximum nesting of a value that is written as JSON.
const MAX_NESTING: usize = 64;

/// The widest indentation of JSON, by the recommendation.
const MAX_INDENT: usize = 10;

/// A function of the library.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum LibraryFunction {
    /// `JSON.stringify(value, null, indentation)`.
    Stringify,
    /// A function of one number, by its index in [`OF_ONE`].
    OfOne(usize),
    /// `Math.pow(base, exponent)`.
    Power,
    /// `Math.atan2(y, x)`.
    Atan2,
    /// `Math.hypot(…)`.
    Hypot,
    /// `Math.max(…)`.
    Max,
    /// `Math.min(…)`.
    Min,
    /// `isNaN(value)`.
    IsNan,
    /// `isFinite(value)`.
    IsFinite,
}

/// A name and a function of one number.
type NamedFunction = (&'static str, fn(f64) -> f64);

/// The functions of `Math` of one number.
const OF_ONE: [NamedFunction; 27] = [
    ("abs", f64::abs),
    ("acos", libm::acos),
    ("acosh", libm::acosh),
    ("asin", libm::asin),
    ("asinh", libm::asinh),
    ("atan", libm::atan),
    ("atanh", libm::atanh),
    ("cbrt", libm::cbrt),
    ("ceil", f64::ceil),
    ("cos", libm::cos),
    ("cosh", libm::cosh),
    ("exp", libm::exp),
    ("expm1", libm::expm1),
    ("floor", f64::floor),
    ("fround", |number| f64::from(number as f32)),
    ("log", libm::log),
    ("log10", libm::log10),
    ("log1p", libm::log1p),
    ("log2", libm::log2),
    ("round", round),
    ("sign", sign),
    ("sin", libm::sin),
    ("sinh", libm::sinh),
    ("sqrt", f64::sqrt),
    ("tan", libm::tan),
    ("tanh", libm::tanh),
    ("trunc", f64::trunc),
];

/// The constants of `Math`.
const CONSTANTS: [(&str, f64); 8] = [
    ("E", std::f64::consts::E),
    ("LN10", std::f64::consts::LN_10),
    ("LN2", std::f64::consts::LN_2),
    ("LOG10E", std::f64::consts::LOG10_E),
    ("LOG2E", std::f64::consts::LOG2_E),
    ("PI", std::f64::consts::PI),
    ("SQRT1_2", std::f64::consts::FRAC_1_SQRT_2),
    ("SQRT2", std::f64::consts::SQRT_2),
];

/// The number that `object.name` is.
pub(crate) fn constant(object: &str, name: &str) -> Option<f64> {
    CONSTANTS.iter().find(|(known, _)| object == "Math" && *known == name).map(|(_, value)| *value)
}

impl LibraryFunction {
    /// The function that `object.name` is; without an object the one that is global.
    pub(crate) fn find(object: &str, name: &str) -> Option<LibraryFunction> {
        Some(match (object, name) {
            ("", "isNaN") => LibraryFunction::IsNan,
            ("", "isFinite") => LibraryFunction::IsFinite,
            ("JSON", "stringify") => LibraryFunction::Stringify,
            ("Math", "atan2") => LibraryFunction::Atan2,
            ("Math", "pow") => LibraryFunction::Power,
            ("Math", "hypot") => LibraryFunction::Hypot,
            ("Math", "max") => LibraryFunction::Max,
            ("Math", "min") => LibraryFunction::Min,
            ("Math", name) => LibraryFunction::OfOne(OF_ONE.iter().position(|(known, _)| *known == name)?),
            _ => return None,
        })
    }
}

/// To the nearest whole number, halves upwards.
fn round(number: f64) -> f64 {
    let below = number.floor();
    if number - below >= 0.5 { below + 1.0 } else { below }
}

fn sign(number: f64) -> f64 {
    if number > 0.0 {
        1.0
    } else if number < 0.0 {
        -1.0
    } else {
        number
    }
}

/// Unlike in C, the result is NaN if the exponent is NaN, or infinite with a base of 1 or -1.
fn power(base: f64, exponent: f64) -> f64 {
    let is_undecided = exponent.is_nan() || base.abs() == 1.0 && exponent.is_infinite();
    if is_undecided { f64::NAN } else { libm::pow(base, exponent) }
}

/// One of two numbers; NaN if either is NaN.
fn extreme(a: f64, b: f64, is_first: bool) -> f64 {
    match (a.is_nan() || b.is_nan(), is_first) {
        (true, _) => f64::NAN,
        (false, true) => a,
        (false, false) => b,
    }
}

impl Evaluator<'_> {
    /// The result of a function of the library.
    pub(crate) fn library(
        &mut self,
        function: LibraryFunction,
        arguments: &[ScriptValue],
    ) -> Result<ScriptValue, EvalError> {
        let mut number =
            |index: usize| arguments.get(index).map_or(Ok(f64::NAN), |value| self.memory.number_of(value));
        Ok(ScriptValue::Number(match function {
            LibraryFunction::Stringify => return self.stringify(arguments),
            LibraryFunction::IsNan => return Ok(ScriptValue::Bool(number(0)?.is_nan())),
            LibraryFunction::IsFinite => return Ok(ScriptValue::Bool(number(0)?.is_finite())),
            LibraryFunction::OfOne(index) => OF_ONE[index].1(number(0)?),
            LibraryFunction::Power => power(number(0)?, number(1)?),
            LibraryFunction::Atan2 => libm::atan2(number(0)?, number(1)?),
            LibraryFunction::Hypot => self.of_all(arguments, 0.0, libm::hypot)?,
            LibraryFunction::Max => self.of_all(arguments, f64::NEG_INFINITY, |a, b| extreme(a, b, a > b))?,
            LibraryFunction::Min => self.of_all(arguments, f64::INFINITY, |a, b| extreme(a, b, a < b))?,
        }))
    }

    /// The result of a function of two numbers, applied to all arguments in order.
    fn of_all(
        &mut self,
        arguments: &[ScriptValue],
        first: f64,
        function: fn(f64, f64) -> f64,
    ) -> Result<f64, EvalError> {
        let mut numbers = arguments.iter().map(|value| self.memory.number_of(value));
        numbers.try_fold(first, |result, number| number.map(|number| function(result, number)))
    }

    fn stringify(&mut self, arguments: &[ScriptValue]) -> Result<ScriptValue, EvalError> {
        if !matches!(arguments.get(1), None | Some(ScriptValue::Undefined | ScriptValue::Null)) {
            return Err(EvalError::new("`JSON.stringify` takes no replacer here: write `null` for it"));
        }
        let indent = match arguments.get(2) {
            Some(ScriptValue::Number(width)) => " ".repeat((width.max(0.0) as usize).min(MAX_INDENT)),
            Some(ScriptValue::Text(text)) => text.chars().take(MAX_INDENT).collect(),
            _ => String::new(),
        };
        let Some(value) = arguments.first().filter(|value| has_json(value)) else {
            return Ok(ScriptValue::Undefined);
        };
        let ScriptMemory { heap, steps, .. } = &mut *self.memory;
        let mut writer = JsonWriter { heap, steps, indent, text: String::new() };
        writer.value(value, 0)?;
        let text: Arc<str> = writer.text.into();
        self.memory.charge_reading(text.len())?;
        self.memory.heap.text(text)
    }
}

/// Whether a value can be written as JSON; members that cannot are left out.
fn has_json(value: &ScriptValue) -> bool {
    !matches!(value, ScriptValue::Undefined | ScriptValue::Function(_))
}

struct JsonWriter<'a> {
    heap: &'a Heap,
    steps: &'a mut StepBudget,
    indent: String,
    text: String,
}

impl JsonWriter<'_> {
    fn value(&mut self, value: &ScriptValue, depth: usize) -> Result<(), EvalError> {
        if depth > MAX_NESTING {
            return Err(EvalError::new("the value lies in itself, or is nested too deeply for JSON"));
        }
        self.steps.charge_reading(self.size(value))?;
        match value {
            ScriptValue::Undefined | ScriptValue::Null | ScriptValue::Function(_) => {
                self.text.push_str("null");
            }
            ScriptValue::Bool(truth) => self.text.push_str(if *truth { "true" } else { "false" }),
            ScriptValue::Number(number) if number.is_finite() => self.text.push_str(&number_text(*number)),
            ScriptValue::Number(_) => self.text.push_str("null"),
            ScriptValue::Text(text) => self.quoted(text),
            ScriptValue::Object(id) => match self.heap.get(*id).map(|object| &object.content) {
                Some(ObjectContent::Array(items)) => {
                    self.text.push('[');
                    for (index, item) in items.iter().enumerate() {
                        self.separate(index, depth + 1);
                        self.value(item, depth + 1)?;
                    }
                    self.close(']', items.len(), depth);
                }
                Some(ObjectContent::Record(record)) => {
                    let members = record.members().iter().filter(|(_, value)| has_json(value));
                    self.text.push('{');
                    let mut count = 0;
                    for (name, value) in members {
                        self.separate(count, depth + 1);
                        count += 1;
                        self.quoted(name);
                        self.text.push_str(if self.indent.is_empty() { ":" } else { ": " });
                        self.value(value, depth + 1)?;
                    }
                    self.close('}', count, depth);
                }
                None => return Err(EvalError::new("the object is gone")),
            },
        }
        match self.text.len() > MAX_TEXT {
            true => Err(EvalError::new(format!("a text is longer than {MAX_TEXT} bytes"))),
            false => Ok(()),
        }
    }

    /// Cost of reading a value without its members.
    fn size(&self, value: &ScriptValue) -> usize {
        match value {
            ScriptValue::Text(text) => text.len(),
            ScriptValue::Object(id) => match self.heap.get(*id).map(|object| &object.content) {
                Some(ObjectContent::Array(items)) => items.len(),
                Some(ObjectContent::Record(record)) => record.members().len(),
                None => 0,
            },
            _ => 0,
        }
    }

    fn quoted(&mut self, text: &str) {
        // writing to a String cannot fail
        let _ = quoted(&mut self.text, text);
    }

    fn separate(&mut self, index: usize, depth: usize) {
        self.text.push_str(if index > 0 { "," } else { "" });
        self.line(depth);
    }

    fn close(&mut self, bracket: char, count: usize, depth: usize) {
        if count > 0 {
            self.line(depth);
        }
        self.text.push(bracket);
    }

    fn line(&mut self, depth: usize) {
        if !self.indent.is_empty() {
            let _ = write!(self.text, "\n{}", self.indent.repeat(depth));
        }
    }
}
