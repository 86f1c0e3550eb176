//! Formats messages as text lines or as JSON.

use std::fmt::Write;

use humantime::format_rfc3339_micros;
use serde::Serialize;

use crate::record::{Record, RecordTime};
use monas_config::Severity;

/// Appends a text line, with or without colours.
pub(crate) fn text(record: &Record, colour: bool, line: &mut String) {
    let (begin, end) = if colour { (colour_of(record.severity), "\x1b[0m") } else { ("", "") };
    let _ = write!(line, "{} {begin}{:<5}{end}", time(record.time), record.severity.name());
    let index = origin(record);
    if !index.is_empty() {
        let _ = write!(line, " [{index}]");
    }
    line.push(' ');
    record.message.as_str().trim_start().chars().for_each(|letter| shown(letter, line));
    line.push('\n');
}

/// `blue-2 behavior/BehaviorGoalie #733`, as far as known.
fn origin(record: &Record) -> String {
    let names = [record.agent.as_str(), record.activity.as_str()];
    let names: Vec<&str> = names.into_iter().filter(|name| !name.is_empty()).collect();
    let cycle = record.cycle.map(|cycle| format!("#{cycle}"));
    let parts = [record.robot.as_str(), &names.join("/"), cycle.as_deref().unwrap_or_default()];
    let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    let mut index = String::new();
    parts.join(" ").chars().for_each(|letter| shown(letter, &mut index));
    index
}

/// Escapes a character, so that a message is one line and cannot control a terminal.
fn shown(letter: char, line: &mut String) {
    match letter {
        '\t' => line.push(letter),
        '\n' => line.push_str("\\n"),
        _ if letter.is_control() => line.extend(letter.escape_default()),
        _ => line.push(letter),
    }
}

fn time(time: RecordTime) -> String {
    match time {
        RecordTime::Wall(time) => format_rfc3339_micros(time).to_string(),
        RecordTime::Simulated(moment) => format!("{:>12.6} s", moment.as_nanos() as f64 / 1e9),
    }
}

const fn colour_of(severity: Severity) -> &'static str {
    match severity {
        Severity::FatalError => "\x1b[1;37;41m",
        Severity::Error => "\x1b[31m",
        Severity::Warning => "\x1b[33m",
        Severity::Info => "\x1b[32m",
        Severity::ExtraInfo => "\x1b[34m",
        Severity::ExtraExtraInfo => "\x1b[2m",
    }
}

/// A message as a JSON object. Unknown fields are left out.
#[derive(Serialize)]
struct JsonLine<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    time: Option<String>,
    /// Seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    simulated_time: Option<f64>,
    level: &'static str,
    #[serde(skip_serializing_if = "str::is_empty")]
    robot: &'a str,
    #[serde(skip_serializing_if = "str::is_empty")]
    agent: &'a str,
    #[serde(skip_serializing_if = "str::is_empty")]
    activity: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    cycle: Option<u64>,
    message: &'a str,
}

/// Appends a line with a JSON object.
pub(crate) fn json(record: &Record, line: &mut String) {
    let (wall, simulated) = match record.time {
        RecordTime::Wall(wall) => (Some(format_rfc3339_micros(wall).to_string()), None),
        RecordTime::Simulated(moment) => (None, Some(moment.as_nanos() as f64 / 1e9)),
    };
    let object = JsonLine {
        time: wall,
        simulated_time: simulated,
        level: record.severity.name(),
        robot: record.robot.as_str(),
        agent: record.agent.as_str(),
        activity: record.activity.as_str(),
        cycle: record.cycle,
        message: record.message.as_str().trim_start(),
    };
    // Serialization of texts and numbers cannot fail.
    line.push_str(&serde_json::to_string(&object).unwrap_or_default());
    line.push('\n');
}
