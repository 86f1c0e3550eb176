//! The reference pages in `docs` are what the program says of itself. `MONAS_BLESS=1` writes them anew.

use std::fmt::Write;
use std::fs;

use serde_json::{Map, Value};

use crate::kit::{monas, root};

fn is_up_to_date(page: &str, text: &str) {
    let path = root().join("docs").join(page);
    if std::env::var_os("MONAS_BLESS").is_some() {
        return fs::write(path, format!("{text}\n")).expect("the folder takes files");
    }
    let written = fs::read_to_string(path).expect("the page");
    assert!(written.trim_end() == text, "docs/{page} is not up to date: run the tests with MONAS_BLESS=1");
}

/// The help of a command, and of those below it.
fn add_command(words: &[&str], page: &mut String) {
    let help = monas(&[words, &["--help"]].concat()).out;
    let below =
        help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let below: Vec<String> = below
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next().map(str::to_owned))
        .filter(|word| word != "help")
        .collect();
    let shown: Vec<&str> = help.trim_end().lines().map(str::trim_end).collect();
    let shown = shown.join("\n");
    let name = [&["monas"], words].concat().join(" ");
    let _ = write!(page, "\n{name}\n{}\n\n{shown}\n\n", "=".repeat(name.len()));
    for word in &below {
        add_command(&[words, &[word.as_str()]].concat(), page);
    }
}

#[test]
fn the_page_of_commands_is_up_to_date() {
    let mut page = String::from("What each command says of itself with `--help`.\n");
    add_command(&[], &mut page);
    assert!(page.contains("\nmonas run\n") && page.contains("\nmonas agent swap\n"), "{page}");
    is_up_to_date("commands.txt", page.trim_end());
}

/// What a value may be, in a word or two.
fn kind_of(schema: &Map<String, Value>) -> String {
    if let Some(values) = schema.get("enum").and_then(Value::as_array) {
        let words: Vec<String> =
            values.iter().filter_map(Value::as_str).map(|word| format!("`{word}`")).collect();
        return match words.iter().any(|word| word == "`true`") {
            true => "`0` or `1`".into(),
            false => words.join(", "),
        };
    }
    let number = |key: &str| schema.get(key).map(Value::to_string);
    match (schema.get("type"), schema.get("pattern").and_then(Value::as_str)) {
        (_, Some(pattern)) if pattern.contains("ms|s|min") => "a time: `200ms`, `5 s`, `1min`".into(),
        (_, Some(_)) => "a name".into(),
        (Some(Value::String(kind)), _) if kind == "integer" || kind == "number" => {
            let kind = if kind == "integer" { "whole number" } else { "number" };
            match (number("minimum"), number("maximum")) {
                (Some(least), Some(most)) if most.len() < 10 => format!("{kind}, {least} to {most}"),
                (Some(least), _) if !least.starts_with('-') => format!("{kind}, {least} at least"),
                _ => kind.into(),
            }
        }
        _ => "text".into(),
    }
}

/// The properties that are not another spelling of the one before (`thread_frequency`, `ThreadFrequency`).
fn spelt_once(properties: &Map<String, Value>) -> impl Iterator<Item = (&str, &Map<String, Value>)> {
    let properties =
        properties.iter().filter_map(|(name, schema)| Some((name.as_str(), schema.as_object()?)));
    properties.filter(|(name, _)| !name.contains(|letter: char| letter.is_ascii_uppercase()))
}

fn add_element(name: &str, schema: &Map<String, Value>, page: &mut String) {
    let text = |key: &str| schema.get(key).and_then(Value::as_str).unwrap_or_default();
    let _ = write!(page, "\n## `<{name}>`\n\n{}.\n", text("description").trim_end_matches('.'));
    // What is a text, or a table with that text and more.
    let either = schema.get("anyOf").and_then(Value::as_array).into_iter().flatten();
    let table = either.filter_map(Value::as_object).chain([schema]).find_map(|one| one.get("properties"));
    let Some(properties) = table.and_then(Value::as_object) else { return };
    let (inside, attributes): (Vec<_>, Vec<_>) = spelt_once(properties)
        .filter(|(_, schema)| schema.contains_key("description") || !schema.contains_key("type"))
        .partition(|(_, schema)| schema.contains_key("anyOf") || schema.contains_key("$ref"));
    if !attributes.is_empty() {
        page.push_str("\n| attribute | value | default | |\n|---|---|---|---|\n");
    }
    for (name, schema) in attributes {
        let text = |key: &str| schema.get(key).and_then(Value::as_str).unwrap_or_default();
        let default = schema.get("default").and_then(Value::as_str).map(|value| format!("`{value}`"));
        let (kind, what) = (kind_of(schema), text("description").replace('|', "\\|"));
        let _ = writeln!(page, "| `{name}` | {kind} | {} | {what} |", default.unwrap_or_default());
    }
    if !inside.is_empty() {
        let names: Vec<String> = inside.iter().map(|(name, _)| format!("`<{name}>`")).collect();
        let _ = write!(page, "\nInside: {}.\n", names.join(", "));
    }
}

#[test]
fn the_page_of_configurations_is_up_to_date() {
    let answer = monas(&["config", "schema", "--json"]);
    let schema: Value = serde_json::from_str(&answer.out).expect("it is JSON");
    let mut page = String::from(
        "# Configuration\n\nWhat a configuration may hold, in XML; in TOML attributes are keys and elements are tables. Names may be spelt as the thesis \
         does, too: `thread_frequency` or `ThreadFrequency`. `monas config schema` writes the same for editors, and `monas config show` says where each value of \
         a configuration comes from.\n",
    );
    let elements = schema["$defs"].as_object().expect("definitions");
    for (name, schema) in elements {
        add_element(name, schema.as_object().expect("a schema"), &mut page);
    }
    assert!(page.contains("## `<agent>`") && page.contains("| `stats_cycle` | whole number"), "{page}");
    is_up_to_date("configuration.md", page.trim_end());
}
