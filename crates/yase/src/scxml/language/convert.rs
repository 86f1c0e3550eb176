//! From one type of values to another, by the rules of ECMAScript.

use std::cmp::Ordering;
use std::sync::Arc;

use super::heap::{Content, Heap};
use super::value::Value;
use super::{Fault, MAX_TEXT};

/// How deeply arrays may lie in one another when they are made a text.
const MAX_NESTING: usize = 32;

/// The text of a number: the shortest that reads back as the same number, laid out as ECMAScript does.
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

/// Digits with a decimal point before the digit of that number.
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

/// The number that a text says; not a number, if it says none.
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

pub(crate) fn truth(value: &Value) -> bool {
    match value {
        Value::Undefined | Value::Null => false,
        Value::Bool(value) => *value,
        Value::Number(number) => *number != 0.0 && !number.is_nan(),
        Value::Text(text) => !text.is_empty(),
        Value::Object(_) | Value::Function(_) => true,
    }
}

pub(crate) fn type_of(value: &Value) -> &'static str {
    match value {
        Value::Undefined => "undefined",
        Value::Null | Value::Object(_) => "object",
        Value::Bool(_) => "boolean",
        Value::Number(_) => "number",
        Value::Text(_) => "string",
        Value::Function(_) => "function",
    }
}

impl Heap {
    /// The text of a value.
    pub(crate) fn text_of(&self, value: &Value) -> Result<Arc<str>, Fault> {
        match value {
            Value::Text(text) => Ok(text.clone()),
            other => {
                let mut text = String::new();
                self.write_text(other, MAX_NESTING, &mut text)?;
                Ok(text.into())
            }
        }
    }

    fn write_text(&self, value: &Value, depth: usize, text: &mut String) -> Result<(), Fault> {
        match value {
            Value::Undefined => text.push_str("undefined"),
            Value::Null => text.push_str("null"),
            Value::Bool(value) => text.push_str(if *value { "true" } else { "false" }),
            Value::Number(number) => text.push_str(&number_text(*number)),
            Value::Text(part) => text.push_str(part),
            Value::Function(_) => text.push_str("function"),
            Value::Object(id) => match self.get(*id).map(|object| &object.content) {
                Some(Content::Array(items)) => self.write_items(items, ",", depth, text)?,
                _ => text.push_str("[object Object]"),
            },
        }
        match text.len() > MAX_TEXT {
            true => Err(Fault::new(format!("a text is longer than {MAX_TEXT} bytes"))),
            false => Ok(()),
        }
    }

    /// The texts of items, joined.
    pub(crate) fn write_items(
        &self,
        items: &[Value],
        separator: &str,
        depth: usize,
        text: &mut String,
    ) -> Result<(), Fault> {
        if depth == 0 {
            return Err(Fault::new("an array lies in itself, or is nested too deeply to be a text"));
        }
        for (index, item) in items.iter().enumerate() {
            text.push_str(if index == 0 { "" } else { separator });
            if !matches!(item, Value::Undefined | Value::Null) {
                self.write_text(item, depth - 1, text)?;
            } else if text.len() > MAX_TEXT {
                return Err(Fault::new(format!("a text is longer than {MAX_TEXT} bytes")));
            }
        }
        Ok(())
    }

    pub(crate) fn number_of(&self, value: &Value) -> Result<f64, Fault> {
        Ok(match value {
            Value::Undefined => f64::NAN,
            Value::Null => 0.0,
            Value::Bool(value) => f64::from(u8::from(*value)),
            Value::Number(number) => *number,
            Value::Text(text) => text_number(text),
            Value::Object(_) | Value::Function(_) => text_number(&self.text_of(value)?),
        })
    }

    /// What arrays, objects and functions are beside texts and numbers: a text.
    pub(crate) fn primitive(&self, value: &Value) -> Result<Value, Fault> {
        match value {
            Value::Object(_) | Value::Function(_) => Ok(Value::Text(self.text_of(value)?)),
            other => Ok(other.clone()),
        }
    }

    /// Whether `a == b`.
    pub(crate) fn equal(&self, a: &Value, b: &Value) -> Result<bool, Fault> {
        let absent = |value: &Value| matches!(value, Value::Undefined | Value::Null);
        let composed = |value: &Value| matches!(value, Value::Object(_) | Value::Function(_));
        if absent(a) || absent(b) {
            return Ok(absent(a) && absent(b));
        }
        if std::mem::discriminant(a) == std::mem::discriminant(b) || (composed(a) && composed(b)) {
            return Ok(a == b);
        }
        if let (Value::Text(text), other) | (other, Value::Text(text)) = (a, b)
            && composed(other)
        {
            return Ok(*text == self.text_of(other)?);
        }
        Ok(self.number_of(a)? == self.number_of(b)?)
    }

    /// Which of two values is less, if they can be compared.
    pub(crate) fn order(&self, a: &Value, b: &Value) -> Result<Option<Ordering>, Fault> {
        let (a, b) = (self.primitive(a)?, self.primitive(b)?);
        if let (Value::Text(a), Value::Text(b)) = (&a, &b) {
            return Ok(Some(a.encode_utf16().cmp(b.encode_utf16())));
        }
        Ok(self.number_of(&a)?.partial_cmp(&self.number_of(&b)?))
    }
}
