//! How a message is written: as a line for people, or as JSON.

use std::fmt::Write;

use humantime::format_rfc3339_micros;
use serde::Serialize;

use super::record::{Record, Severity, Time};

/// Appends a line for people, in colours or not.
pub(super) fn text(record: &Record, colour: bool, line: &mut String) {
    let (begin, end) = if colour { (colour_of(record.severity), "\x1b[0m") } else { ("", "") };
    let _ = write!(line, "{} {begin}{:<5}{end}", time(record.time), record.severity.name());
    let place = place(record);
    if !place.is_empty() {
        let _ = write!(line, " [{place}]");
    }
    line.push(' ');
    record.words.as_str().trim_start().chars().for_each(|letter| shown(letter, line));
    line.push('\n');
}

/// `blue-2 behavior/BehaviorGoalie #733`, as much of it as is known.
fn place(record: &Record) -> String {
    let names = [record.agent.as_str(), record.activity.as_str()];
    let names: Vec<&str> = names.into_iter().filter(|name| !name.is_empty()).collect();
    let cycle = record.cycle.map(|cycle| format!("#{cycle}"));
    let parts = [record.robot.as_str(), &names.join("/"), cycle.as_deref().unwrap_or_default()];
    let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    let mut place = String::new();
    parts.join(" ").chars().for_each(|letter| shown(letter, &mut place));
    place
}

/// A message is one line, and nothing in it steers a terminal.
fn shown(letter: char, line: &mut String) {
    match letter {
        '\t' => line.push(letter),
        '\n' => line.push_str("\\n"),
        _ if letter.is_control() => line.extend(letter.escape_default()),
        _ => line.push(letter),
    }
}

fn time(time: Time) -> String {
    match time {
        Time::Wall(time) => format_rfc3339_micros(time).to_string(),
        Time::Simulated(moment) => format!("{:>12.6} s", moment.as_nanos() as f64 / 1e9),
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

/// A message as a JSON object. What is not known is left out.
#[derive(Serialize)]
struct Json<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    time: Option<String>,
    /// In seconds.
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
pub(super) fn json(record: &Record, line: &mut String) {
    let (wall, simulated) = match record.time {
        Time::Wall(wall) => (Some(format_rfc3339_micros(wall).to_string()), None),
        Time::Simulated(moment) => (None, Some(moment.as_nanos() as f64 / 1e9)),
    };
    let object = Json {
        time: wall,
        simulated_time: simulated,
        level: record.severity.name(),
        robot: record.robot.as_str(),
        agent: record.agent.as_str(),
        activity: record.activity.as_str(),
        cycle: record.cycle,
        message: record.words.as_str().trim_start(),
    };
    // Texts and numbers can always be written.
    line.push_str(&serde_json::to_string(&object).unwrap_or_default());
    line.push('\n');
}
