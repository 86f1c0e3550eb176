//! A message before it is written: its words, who wrote it, and when.

use std::fmt::{self, Write};
use std::time::SystemTime;

use narukom::Moment;
use tracing::field::{Field, Visit};
use tracing::{Event, Level};

use super::context;

/// How much of a message is kept, in bytes.
const WORDS: usize = 1024;
/// How much of a name is kept, in bytes.
const NAME: usize = 64;
/// What stands where a text was cut.
const MARK: char = '…';

/// How grave a message is, in the thesis's words; the graver comes first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Severity {
    /// The process will not survive it, or not usefully.
    FatalError,
    /// Something has gone wrong.
    Error,
    /// Something may go wrong. The thesis does not know it; it is filtered like [`Info`](Severity::Info).
    Warning,
    /// Worth knowing.
    Info,
    /// Worth knowing for who looks for something.
    ExtraInfo,
    /// All the rest.
    ExtraExtraInfo,
}

impl Severity {
    /// The number that the thesis gives it, from 0 for the gravest to 4.
    pub const fn number(self) -> u8 {
        match self {
            Severity::FatalError => 0,
            Severity::Error => 1,
            Severity::Warning | Severity::Info => 2,
            Severity::ExtraInfo => 3,
            Severity::ExtraExtraInfo => 4,
        }
    }

    /// The word for it in a line.
    pub const fn name(self) -> &'static str {
        match self {
            Severity::FatalError => "FATAL",
            Severity::Error => "ERROR",
            Severity::Warning => "WARN",
            Severity::Info => "INFO",
            Severity::ExtraInfo => "DEBUG",
            Severity::ExtraExtraInfo => "TRACE",
        }
    }

    /// Whether it is written whatever the settings are, and before the call returns.
    pub(super) const fn is_urgent(self) -> bool {
        matches!(self, Severity::FatalError | Severity::Error)
    }

    /// What a level of `tracing` means; a fatal error is marked by a field.
    pub(super) fn of(level: Level) -> Severity {
        match level {
            Level::ERROR => Severity::Error,
            Level::WARN => Severity::Warning,
            Level::INFO => Severity::Info,
            Level::DEBUG => Severity::ExtraInfo,
            _ => Severity::ExtraExtraInfo,
        }
    }
}

/// When a message was written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Time {
    Wall(SystemTime),
    Simulated(Moment),
}

/// A message. It has all its memory from the beginning.
#[derive(Debug)]
pub(super) struct Record {
    pub(super) severity: Severity,
    pub(super) time: Time,
    pub(super) cycle: Option<u64>,
    pub(super) robot: Text,
    pub(super) agent: Text,
    pub(super) activity: Text,
    pub(super) words: Text,
}

impl Record {
    pub(super) fn new() -> Record {
        Record {
            severity: Severity::Info,
            time: Time::Simulated(Moment::ZERO),
            cycle: None,
            robot: Text::of(NAME),
            agent: Text::of(NAME),
            activity: Text::of(NAME),
            words: Text::of(WORDS),
        }
    }

    /// What the logger itself has to say.
    #[expect(clippy::disallowed_methods, reason = "nobody else has a time for it")]
    pub(super) fn of_logger(words: fmt::Arguments<'_>) -> Record {
        let mut record = Record::new();
        record.severity = Severity::Warning;
        record.time = Time::Wall(SystemTime::now());
        record.words.append(words);
        record
    }

    /// Takes an event that happens on this thread now. It allocates nothing.
    #[expect(clippy::disallowed_methods, reason = "the log of a run in real time has its time")]
    pub(super) fn take(&mut self, event: &Event<'_>) {
        let Record { severity, time, cycle, robot, agent, activity, words } = self;
        *severity = Severity::of(*event.metadata().level());
        *time = context::simulated().map_or_else(|| Time::Wall(SystemTime::now()), Time::Simulated);
        *cycle = None;
        [&mut *robot, agent, activity, words].into_iter().for_each(Text::clear);
        context::called(|caller, number| {
            *cycle = Some(number);
            robot.set(&caller.robot);
            agent.set(&caller.agent);
            activity.set(&caller.activity);
        });
        event.record(self);
    }
}

/// Fields that say who it was are taken as that, the others follow the message.
impl Visit for Record {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        let text = match field.name() {
            "message" => &mut self.words,
            "robot" | "host" => &mut self.robot,
            "agent" => &mut self.agent,
            "activity" => &mut self.activity,
            name => return self.words.append(format_args!(" {name}={value:?}")),
        };
        text.clear();
        text.append(format_args!("{value:?}"));
    }

    fn record_str(&mut self, field: &Field, value: &str) {
        match field.name() {
            // names stand there as they are, other texts in quotes
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

/// A text in memory of its own: what does not fit is cut, and a mark is put there.
#[derive(Debug)]
pub(super) struct Text {
    text: String,
    /// How many bytes it may have before the mark.
    most: usize,
    is_cut: bool,
}

impl Text {
    fn of(most: usize) -> Text {
        Text { text: String::with_capacity(most + MARK.len_utf8()), most, is_cut: false }
    }

    pub(super) fn as_str(&self) -> &str {
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
        // Who cannot say what he is has said as much of it as stands there.
        let _ = self.write_fmt(words);
    }

    fn push(&mut self, text: &str) {
        if self.is_cut {
            return;
        }
        let room = self.most - self.text.len();
        if text.len() <= room {
            return self.text.push_str(text);
        }
        let fits = (0..=room).rev().find(|&end| text.is_char_boundary(end)).unwrap_or(0);
        self.text.push_str(&text[..fits]);
        self.text.push(MARK);
        self.is_cut = true;
    }
}

impl Write for Text {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.push(text);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_long_is_cut_between_letters_and_marked_and_takes_no_memory() {
        let mut text = Text::of(7);
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
