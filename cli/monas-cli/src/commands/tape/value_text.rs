//! Values of messages as JSON and as cells of a table.

use monas_tape::Value;
use serde_json::{Map, Number, Value as Json};

/// As JSON. Numbers stay numbers, whatever their size; non-finite numbers and bytes are written as
/// in the JSON mapping of protobuf.
pub(crate) fn json(value: &Value) -> Json {
    match value {
        Value::Bool(value) => Json::Bool(*value),
        Value::Int(value) => (*value).into(),
        Value::Uint(value) => (*value).into(),
        Value::Float(value) => {
            Number::from_f64(*value).map_or_else(|| not_finite(*value).into(), Json::Number)
        }
        Value::Text(text) | Value::Enum(text) => text.as_str().into(),
        Value::Bytes(bytes) => base64(bytes).into(),
        Value::List(list) => list.iter().map(json).collect(),
        Value::Fields(fields) => Json::Object(
            fields.iter().map(|(name, value)| (name.clone(), json(value))).collect::<Map<_, _>>(),
        ),
        _ => Json::Null,
    }
}

/// As text in one line.
pub(crate) fn plain(value: &Value) -> String {
    match value {
        Value::Text(text) | Value::Enum(text) => text.clone(),
        Value::Float(value) if !value.is_finite() => not_finite(*value).into(),
        Value::Missing | Value::NoMessage => String::new(),
        other => json(other).to_string(),
    }
}

/// Each scalar value of a message with its path: `ball.x`. Lists are not split.
pub(crate) fn cells<'v>(value: &'v Value, cell: &mut dyn FnMut(&str, &'v Value)) {
    flatten(&mut String::new(), value, cell);
}

fn flatten<'v>(path: &mut String, value: &'v Value, cell: &mut dyn FnMut(&str, &'v Value)) {
    let Value::Fields(fields) = value else { return cell(path, value) };
    for (name, value) in fields {
        let length = path.len();
        if length > 0 {
            path.push('.');
        }
        path.push_str(name);
        flatten(path, value, cell);
        path.truncate(length);
    }
}

/// A cell of a CSV file, quoted if necessary.
pub(crate) fn quoted(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

fn not_finite(value: f64) -> &'static str {
    match (value.is_nan(), value > 0.0) {
        (true, _) => "NaN",
        (false, true) => "Infinity",
        (false, false) => "-Infinity",
    }
}

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Base 64 as in RFC 4648, with padding.
fn base64(bytes: &[u8]) -> String {
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let byte = |index| u32::from(group.get(index).copied().unwrap_or_default());
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for position in 0..4 {
            let digit = char::from(DIGITS[(bits >> (18 - 6 * position) & 63) as usize]);
            text.push(if position <= group.len() { digit } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base_64_is_that_of_the_standard() {
        let cases = [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
        for (bytes, text) in cases {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(base64(&[0xfb, 0xff]), "+/8=");
    }

    #[test]
    fn numbers_that_json_lacks_are_texts() {
        let texts = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(|value| json(&Value::Float(value)));
        assert_eq!(texts, ["NaN", "Infinity", "-Infinity"].map(Json::from));
        assert_eq!(json(&Value::Uint(u64::MAX)).to_string(), "18446744073709551615");
    }

    #[test]
    fn cells_are_quoted_where_they_have_to_be() {
        assert_eq!([quoted("a b"), quoted("a,b"), quoted("a\"b")], ["a b", "\"a,b\"", "\"a\"\"b\""]);
    }

    #[test]
    fn nested_fields_have_paths() {
        let inner = Value::Fields(vec![("x".into(), Value::Float(1.5)), ("y".into(), Value::Missing)]);
        let outer = Value::Fields(vec![("ball".into(), inner), ("found".into(), Value::Bool(true))]);
        let mut found = Vec::new();
        cells(&outer, &mut |path, value| found.push(format!("{path}={}", plain(value))));
        assert_eq!(found, ["ball.x=1.5", "ball.y=", "found=true"]);
    }
}
