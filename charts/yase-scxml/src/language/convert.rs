//! Conversions between types of values by the rules of ECMAScript.

use std::cmp::Ordering;
use std::sync::Arc;

use super::heap::{Heap, ObjectContent};
use super::memory::StepBudget;
use super::value::ScriptValue;
use super::{EvalError, MAX_TEXT};

/// Maximum nesting of arrays that are converted to text.
const MAX_NESTING: usize = 32;

/// The text of a number: the shortest that parses to the same number, in the format of ECMAScript.
pub(crate) fn number_text(number: f64) -> String {
    if number.is_nan() {
        return "NaN".into();
    }
    if number.is_infinite() {
        return if number > 0.0 { "Infinity".into() } else { "-Infinity".into() };
    }
    if number == 0.0 {
        return "0".into();
    }
    let scientific = format!("{:e}", number.abs());
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let digits = mantissa.replace('.', "");
    let point = exponent.parse::<i32>().unwrap_or(0) + 1;
    let sign = if number < 0.0 { "-" } else { "" };
    format!("{sign}{}", laid_out(&digits, point))
}

/// Digits with a decimal point before the digit with that index.
fn laid_out(digits: &str, point: i32) -> String {
    let count = digits.len() as i32;
    match point {
        22.. | ..=-6 => {
            let (first, rest) = digits.split_at(1);
            let fraction = if rest.is_empty() { String::new() } else { format!(".{rest}") };
            let exponent = point - 1;
            format!("{first}{fraction}e{}{}", if exponent < 0 { "-" } else { "+" }, exponent.abs())
        }
        ..=0 => format!("0.{}{digits}", "0".repeat(point.unsigned_abs() as usize)),
        _ if point >= count => format!("{digits}{}", "0".repeat((point - count) as usize)),
        _ => format!("{}.{}", &digits[..point as usize], &digits[point as usize..]),
    }
}

/// The number that a text represents; NaN if it represents none.
pub(crate) fn text_number(text: &str) -> f64 {
    let text = text.trim();
    if text.is_empty() {
        return 0.0;
    }
    if let Some(digits) = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        return u64::from_str_radix(digits, 16).map_or(f64::NAN, |value| value as f64);
    }
    match text.strip_prefix(['+', '-']).unwrap_or(text) {
        "Infinity" if text.starts_with('-') => f64::NEG_INFINITY,
        "Infinity" => f64::INFINITY,
        digits if digits.starts_with(|first: char| first.is_ascii_digit() || first == '.') => {
            text.parse().unwrap_or(f64::NAN)
        }
        _ => f64::NAN,
    }
}

pub(crate) fn truth(value: &ScriptValue) -> bool {
    match value {
        ScriptValue::Undefined | ScriptValue::Null => false,
        ScriptValue::Bool(value) => *value,
        ScriptValue::Number(number) => *number != 0.0 && !number.is_nan(),
        ScriptValue::Text(text) => !text.is_empty(),
        ScriptValue::Object(_) | ScriptValue::Function(_) => true,
    }
}

pub(crate) fn type_of(value: &ScriptValue) -> &'static str {
    match value {
        ScriptValue::Undefined => "undefined",
        ScriptValue::Null | ScriptValue::Object(_) => "object",
        ScriptValue::Bool(_) => "boolean",
        ScriptValue::Number(_) => "number",
        ScriptValue::Text(_) => "string",
        ScriptValue::Function(_) => "function",
    }
}

impl Heap {
    /// The text of a value; charges the steps for reading it.
    pub(crate) fn text_of(&self, value: &ScriptValue, steps: &mut StepBudget) -> Result<Arc<str>, EvalError> {
        match value {
            ScriptValue::Text(text) => {
                steps.charge_reading(text.len())?;
                Ok(text.clone())
            }
            other => {
                let mut text = String::new();
                self.write_text(other, MAX_NESTING, &mut text, steps)?;
                Ok(text.into())
            }
        }
    }

    fn write_text(
        &self,
        value: &ScriptValue,
        depth: usize,
        text: &mut String,
        steps: &mut StepBudget,
    ) -> Result<(), EvalError> {
        steps.charge_reading(if let ScriptValue::Text(part) = value { part.len() } else { 0 })?;
        match value {
            ScriptValue::Undefined => text.push_str("undefined"),
            ScriptValue::Null => text.push_str("null"),
            ScriptValue::Bool(value) => text.push_str(if *value { "true" } else { "false" }),
            ScriptValue::Number(number) => text.push_str(&number_text(*number)),
            ScriptValue::Text(part) => text.push_str(part),
            ScriptValue::Function(_) => text.push_str("function"),
            ScriptValue::Object(id) => match self.get(*id).map(|object| &object.content) {
                Some(ObjectContent::Array(items)) => self.write_items(items, ",", depth, text, steps)?,
                _ => text.push_str("[object Object]"),
            },
        }
        match text.len() > MAX_TEXT {
            true => Err(EvalError::new(format!("a text is longer than {MAX_TEXT} bytes"))),
            false => Ok(()),
        }
    }

    /// The joined texts of items.
    pub(crate) fn write_items(
        &self,
        items: &[ScriptValue],
        separator: &str,
        depth: usize,
        text: &mut String,
        steps: &mut StepBudget,
    ) -> Result<(), EvalError> {
        if depth == 0 {
            return Err(EvalError::new("an array lies in itself, or is nested too deeply to be a text"));
        }
        steps.charge_reading(items.len().saturating_mul(separator.len().max(1)))?;
        for (index, item) in items.iter().enumerate() {
            text.push_str(if index == 0 { "" } else { separator });
            if !matches!(item, ScriptValue::Undefined | ScriptValue::Null) {
                self.write_text(item, depth - 1, text, steps)?;
            } else if text.len() > MAX_TEXT {
                return Err(EvalError::new(format!("a text is longer than {MAX_TEXT} bytes")));
            }
        }
        Ok(())
    }

    /// The number of a value; charges the steps for reading it.
    pub(crate) fn number_of(&self, value: &ScriptValue, steps: &mut StepBudget) -> Result<f64, EvalError> {
        Ok(match value {
            ScriptValue::Undefined => f64::NAN,
            ScriptValue::Null => 0.0,
            ScriptValue::Bool(value) => f64::from(u8::from(*value)),
            ScriptValue::Number(number) => *number,
            ScriptValue::Text(_) | ScriptValue::Object(_) | ScriptValue::Function(_) => {
                text_number(&self.text_of(value, steps)?)
            }
        })
    }

    /// The primitive value of arrays, objects and functions: a text.
    pub(crate) fn primitive(
        &self,
        value: &ScriptValue,
        steps: &mut StepBudget,
    ) -> Result<ScriptValue, EvalError> {
        match value {
            ScriptValue::Object(_) | ScriptValue::Function(_) => {
                Ok(ScriptValue::Text(self.text_of(value, steps)?))
            }
            other => Ok(other.clone()),
        }
    }

    /// Whether `a == b`.
    pub(crate) fn equal(
        &self,
        a: &ScriptValue,
        b: &ScriptValue,
        steps: &mut StepBudget,
    ) -> Result<bool, EvalError> {
        let absent = |value: &ScriptValue| matches!(value, ScriptValue::Undefined | ScriptValue::Null);
        let composed =
            |value: &ScriptValue| matches!(value, ScriptValue::Object(_) | ScriptValue::Function(_));
        if absent(a) || absent(b) {
            return Ok(absent(a) && absent(b));
        }
        if std::mem::discriminant(a) == std::mem::discriminant(b) || (composed(a) && composed(b)) {
            return Ok(a == b);
        }
        if let (ScriptValue::Text(text), other) | (other, ScriptValue::Text(text)) = (a, b)
            && composed(other)
        {
            return Ok(*text == self.text_of(other, steps)?);
        }
        Ok(self.number_of(a, steps)? == self.number_of(b, steps)?)
    }

    /// The order of two values, if they can be compared.
    pub(crate) fn order(
        &self,
        a: &ScriptValue,
        b: &ScriptValue,
        steps: &mut StepBudget,
    ) -> Result<Option<Ordering>, EvalError> {
        let (a, b) = (self.primitive(a, steps)?, self.primitive(b, steps)?);
        if let (ScriptValue::Text(a), ScriptValue::Text(b)) = (&a, &b) {
            return Ok(Some(a.encode_utf16().cmp(b.encode_utf16())));
        }
        Ok(self.number_of(&a, steps)?.partial_cmp(&self.number_of(&b, steps)?))
    }
}
