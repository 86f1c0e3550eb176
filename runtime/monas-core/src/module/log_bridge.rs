//! Log lines of a module: it has its own copy of `tracing` without a subscriber, so lines are
//! forwarded to the host.

use std::fmt::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::subscriber::Interest;
use tracing::{Event, Level, Metadata, Subscriber};

/// Functions of the host that receive lines.
#[derive(Clone, Copy)]
pub struct HostLog {
    wants: fn(Level) -> bool,
    take: fn(&ModuleLogLine),
}

/// A line of a module. The host adds the called activity and the time.
struct ModuleLogLine {
    level: Level,
    fatal: bool,
    /// The Rust module that wrote it.
    target: &'static str,
    robot: Option<String>,
    agent: Option<String>,
    activity: Option<String>,
    cycle: Option<u64>,
    words: String,
}

/// The log functions of this program.
pub fn host_log() -> HostLog {
    HostLog { wants: guarded_wants, take: guarded_take }
}

/// In the module: forwards lines and panics to a host from now on.
pub(crate) fn install(log: HostLog) {
    // Always the first subscriber: a module is opened once, before any of its other code runs.
    if tracing::subscriber::set_global_default(ForwardingSubscriber(log)).is_ok() {
        std::panic::set_hook(Box::new(|panic| tracing::error!("{panic}")));
    }
}

/// Calls the filter; a panic of the host's log must not reach the module.
fn guarded_wants(level: Level) -> bool {
    catch_unwind(AssertUnwindSafe(|| wants(level))).unwrap_or_default()
}

fn guarded_take(line: &ModuleLogLine) {
    // A panic of the log cannot be reported.
    let _ = catch_unwind(AssertUnwindSafe(|| take(line)));
}

/// Target of modules' lines in the host. Their source locations are not available there.
pub const TARGET: &str = "monas::module";

macro_rules! at {
    ($level:expr, $wanted:expr, $macro:ident) => {
        if $wanted == $level {
            return tracing::$macro!(target: TARGET, $level);
        }
    };
}

fn wants(level: Level) -> bool {
    at!(Level::ERROR, level, enabled);
    at!(Level::WARN, level, enabled);
    at!(Level::INFO, level, enabled);
    at!(Level::DEBUG, level, enabled);
    tracing::enabled!(target: TARGET, Level::TRACE)
}

fn take(line: &ModuleLogLine) {
    let ModuleLogLine { level, fatal, target, cycle, words, .. } = line;
    let [robot, agent, activity] = [&line.robot, &line.agent, &line.activity].map(Option::as_deref);
    let fatal = fatal.then_some(true);
    macro_rules! say {
        ($level:expr) => {
            tracing::event!(target: TARGET, $level, fatal, robot, agent, activity, cycle, module = *target, "{words}")
        };
    }
    match *level {
        Level::ERROR => say!(Level::ERROR),
        Level::WARN => say!(Level::WARN),
        Level::INFO => say!(Level::INFO),
        Level::DEBUG => say!(Level::DEBUG),
        _ => say!(Level::TRACE),
    }
}

/// In the module: its only subscriber.
struct ForwardingSubscriber(HostLog);

impl Subscriber for ForwardingSubscriber {
    fn register_callsite(&self, _: &'static Metadata<'static>) -> Interest {
        // The filter of the host may change at any time.
        Interest::sometimes()
    }

    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.is_event() && (self.0.wants)(*metadata.level())
    }

    fn event(&self, event: &Event<'_>) {
        let metadata = event.metadata();
        let mut line = ModuleLogLine {
            level: *metadata.level(),
            fatal: false,
            target: metadata.module_path().unwrap_or(""),
            robot: None,
            agent: None,
            activity: None,
            cycle: None,
            words: String::new(),
        };
        event.record(&mut line);
        (self.0.take)(&line);
    }

    // The log does not use spans.
    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }
    fn record(&self, _: &Id, _: &Record<'_>) {}
    fn record_follows_from(&self, _: &Id, _: &Id) {}
    fn enter(&self, _: &Id) {}
    fn exit(&self, _: &Id) {}
}

impl Visit for ModuleLogLine {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        match field.name() {
            "message" => self.words.insert_str(0, &format!("{value:?}")),
            "robot" | "host" => self.robot = Some(format!("{value:?}")),
            "agent" => self.agent = Some(format!("{value:?}")),
            "activity" => self.activity = Some(format!("{value:?}")),
            name => {
                // Writing to a `String` cannot fail.
                let _ = write!(self.words, " {name}={value:?}");
            }
        }
    }

    fn record_str(&mut self, field: &Field, value: &str) {
        match field.name() {
            // names are written as they are, other texts in quotes
            "message" | "robot" | "host" | "agent" | "activity" => {
                self.record_debug(field, &format_args!("{value}"));
            }
            _ => self.record_debug(field, &value),
        }
    }

    fn record_bool(&mut self, field: &Field, value: bool) {
        match field.name() {
            "fatal" => self.fatal = value,
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
