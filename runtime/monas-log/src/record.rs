//! A message before it is written: its text, origin and time.

use std::fmt::{self, Write};
use std::time::SystemTime;

use narukom::Timestamp;
use tracing::field::{Field, Visit};
use tracing::{Event, Level};

use monas_config::Severity;
use monas_core::activity_context as context;
use monas_core::call_slot;

/// Maximum length of a message, in bytes.
const MAX_MESSAGE_LENGTH: usize = 1024;
/// Maximum length of a name, in bytes.
const MAX_NAME_LENGTH: usize = 64;
/// Marks a cut text.
const ELLIPSIS: char = '…';

/// The severity of a level of `tracing`; a fatal error is marked by a field.
pub(crate) fn severity_of(level: Level) -> Severity {
    match level {
        Level::ERROR => Severity::Error,
        Level::WARN => Severity::Warning,
        Level::INFO => Severity::Info,
        Level::DEBUG => Severity::ExtraInfo,
        _ => Severity::ExtraExtraInfo,
    }
}

/// When a message was written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum RecordTime {
    Wall(SystemTime),
    Simulated(Timestamp),
}

/// A message. Its memory is allocated at construction.
#[derive(Debug)]
pub(crate) struct Record {
    pub(crate) severity: Severity,
    pub(crate) time: RecordTime,
    pub(crate) cycle: Option<u64>,
    pub(crate) robot: BoundedText,
    pub(crate) agent: BoundedText,
    pub(crate) activity: BoundedText,
    pub(crate) message: BoundedText,
}

impl Record {
    pub(crate) fn new() -> Record {
        Record {
            severity: Severity::Info,
            time: RecordTime::Simulated(Timestamp::ZERO),
            cycle: None,
            robot: BoundedText::of(MAX_NAME_LENGTH),
            agent: BoundedText::of(MAX_NAME_LENGTH),
            activity: BoundedText::of(MAX_NAME_LENGTH),
            message: BoundedText::of(MAX_MESSAGE_LENGTH),
        }
    }

    /// Fills it with a message of the logger itself.
    #[expect(clippy::disallowed_methods, reason = "a message of the logger itself has no other time")]
    pub(crate) fn of_logger(words: fmt::Arguments<'_>) -> Record {
        let mut record = Record::new();
        record.severity = Severity::Warning;
        record.time = RecordTime::Wall(SystemTime::now());
        record.message.append(words);
        record
    }

    /// Fills it with an event of this thread at the current time. It does not allocate.
    #[expect(clippy::disallowed_methods, reason = "the log of a run in real time has its time")]
    pub(crate) fn take(&mut self, event: &Event<'_>) {
        let Record { severity, time, cycle, robot, agent, activity, message: words } = self;
        *severity = severity_of(*event.metadata().level());
        *time =
            context::simulated().map_or_else(|| RecordTime::Wall(SystemTime::now()), RecordTime::Simulated);
        *cycle = None;
        [&mut *robot, agent, activity, words].into_iter().for_each(BoundedText::clear);
        call_slot::called(|caller, number| {
            *cycle = Some(number);
            robot.set(&caller.robot);
            agent.set(&caller.agent);
            activity.set(&caller.activity);
        });
        event.record(self);
    }
}

/// Fields that name the origin are stored as such; others are appended to the message.
impl Visit for Record {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        let text = match field.name() {
            "message" => &mut self.message,
            "robot" | "host" => &mut self.robot,
            "agent" => &mut self.agent,
            "activity" => &mut self.activity,
            name => return self.message.append(format_args!(" {name}={value:?}")),
        };
        text.clear();
        text.append(format_args!("{value:?}"));
    }

    fn record_str(&mut self, field: &Field, value: &str) {
        match field.name() {
            // names are written as they are, other texts in quotes
            "message" | "robot" | "host" | "agent" | "activity" => {
                self.record_debug(field, &format_args!("{value}"))
            }
            _ => self.record_debug(field, &value),
        }
    }

    fn record_bool(&mut self, field: &Field, value: bool) {
        match (field.name(), self.severity) {
            ("fatal", Severity::Error) if value => self.severity = Severity::FatalError,
            _ => self.record_debug(field, &value),
        }
    }

    fn record_u64(&mut self, field: &Field, value: u64) {
        match field.name() {
            "cycle" => self.cycle = Some(value),
            _ => self.record_debug(field, &value),
        }
    }
}

/// A text of fixed capacity: an overflow is cut and marked.
#[derive(Debug)]
pub(crate) struct BoundedText {
    text: String,
    /// Maximum length in bytes, without the mark.
    max_bytes: usize,
    is_cut: bool,
}

impl BoundedText {
    fn of(max: usize) -> BoundedText {
        BoundedText { text: String::with_capacity(max + ELLIPSIS.len_utf8()), max_bytes: max, is_cut: false }
    }

    pub(crate) fn as_str(&self) -> &str {
        &self.text
    }

    fn clear(&mut self) {
        self.text.clear();
        self.is_cut = false;
    }

    fn set(&mut self, text: &str) {
        self.clear();
        self.push(text);
    }

    fn append(&mut self, words: fmt::Arguments<'_>) {
        // If formatting fails, the text up to there is kept.
        let _ = self.write_fmt(words);
    }

    fn push(&mut self, text: &str) {
        if self.is_cut {
            return;
        }
        let room = self.max_bytes - self.text.len();
        if text.len() <= room {
            return self.text.push_str(text);
        }
        let fits = (0..=room).rev().find(|&end| text.is_char_boundary(end)).unwrap_or(0);
        self.text.push_str(&text[..fits]);
        self.text.push(ELLIPSIS);
        self.is_cut = true;
    }
}

impl Write for BoundedText {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.push(text);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_truncated_at_characters_without_allocation() {
        let mut text = BoundedText::of(7);
        let memory = text.text.capacity();
        text.append(format_args!("{}{}", "naïve", "té and more"));
        text.append(format_args!("{}", "even more"));
        assert_eq!(text.as_str(), "naïvet…");
        assert_eq!(text.text.capacity(), memory);
        text.set("short");
        assert_eq!(text.as_str(), "short");
    }

    #[test]
    fn severities_are_the_thesis_s() {
        let all = [
            Severity::FatalError,
            Severity::Error,
            Severity::Info,
            Severity::ExtraInfo,
            Severity::ExtraExtraInfo,
        ];
        assert_eq!(all.map(Severity::number), [0, 1, 2, 3, 4]);
        assert!(all.is_sorted());
    }
}
