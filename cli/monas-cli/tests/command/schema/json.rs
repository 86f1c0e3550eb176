//! The subset of JSON Schema that the generated schema uses.

use serde_json::{Map, Value};
use toml::de::{DeTable, DeValue};

/// Whether a schema accepts a text in TOML.
pub(super) fn allows(schema: &Value, text: &str) -> bool {
    let table = DeTable::parse(text).expect("the text is TOML");
    is_allowed(schema, schema, &object(table.get_ref()))
}

fn object(table: &DeTable<'_>) -> Value {
    let entries = table.iter().map(|(key, value)| (key.get_ref().to_string(), json(value.get_ref())));
    Value::Object(entries.collect())
}

fn json(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => text.to_string().into(),
        DeValue::Integer(number) => number.as_str().parse::<i64>().expect("a small number").into(),
        DeValue::Float(number) => number.as_str().parse::<f64>().expect("a number").into(),
        DeValue::Boolean(yes) => (*yes).into(),
        DeValue::Datetime(time) => time.to_string().into(),
        DeValue::Array(values) => values.iter().map(|one| json(one.get_ref())).collect(),
        DeValue::Table(table) => object(table),
    }
}

fn is_allowed(root: &Value, schema: &Value, value: &Value) -> bool {
    let schema = schema.as_object().expect("a schema is an object");
    schema.iter().all(|(key, rule)| match key.as_str() {
        "$schema" | "$defs" | "title" | "description" | "default" | "additionalProperties" => true,
        "$ref" => {
            let name = rule.as_str().expect("a reference").trim_start_matches("#/$defs/");
            is_allowed(root, &root["$defs"][name], value)
        }
        "type" => has_type(rule, value),
        "properties" => properties_hold(root, schema, rule, value),
        "items" => value.as_array().is_none_or(|values| values.iter().all(|one| is_allowed(root, rule, one))),
        "anyOf" => rule.as_array().expect("several").iter().any(|one| is_allowed(root, one, value)),
        "enum" => rule.as_array().expect("several").iter().any(|one| one == value || same_number(one, value)),
        "minimum" => value.as_f64().is_none_or(|number| number >= rule.as_f64().expect("a number")),
        "maximum" => value.as_f64().is_none_or(|number| number <= rule.as_f64().expect("a number")),
        "minLength" => value.as_str().is_none_or(|text| !text.is_empty()),
        "pattern" => true, // what patterns allow is tested where the kinds of values are
        other => panic!("the schema uses a word that the test does not know: {other}"),
    })
}

fn same_number(one: &Value, other: &Value) -> bool {
    one.as_f64().is_some_and(|number| other.as_f64() == Some(number))
}

fn has_type(rule: &Value, value: &Value) -> bool {
    let is = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "boolean" => value.is_boolean(),
        other => panic!("a type that the test does not know: {other}"),
    };
    match rule {
        Value::Array(names) => names.iter().filter_map(Value::as_str).any(is),
        name => is(name.as_str().expect("a name")),
    }
}

fn properties_hold(root: &Value, schema: &Map<String, Value>, rule: &Value, value: &Value) -> bool {
    let Some(entries) = value.as_object() else { return true };
    let is_closed = schema.get("additionalProperties") == Some(&Value::Bool(false));
    entries.iter().all(|(key, value)| match rule.get(key) {
        Some(rule) => is_allowed(root, rule, value),
        None => !is_closed,
    })
}
