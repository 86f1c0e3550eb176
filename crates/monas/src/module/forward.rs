//! The log lines of a module: it has a copy of `tracing` of its own, which nobody listens to, so they are handed to the host.

use std::fmt::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::subscriber::Interest;
use tracing::{Event, Level, Metadata, Subscriber};

/// How the host takes lines.
#[derive(Clone, Copy)]
pub(super) struct HostLog {
    wants: fn(Level) -> bool,
    take: fn(&Line),
}

/// What a module has to say. Who is being called, and when, the host knows by itself.
struct Line {
    level: Level,
    fatal: bool,
    /// The module of Rust that says it.
    target: &'static str,
    robot: Option<String>,
    agent: Option<String>,
    activity: Option<String>,
    cycle: Option<u64>,
    words: String,
}

/// That of this program.
pub(super) fn host_log() -> HostLog {
    HostLog { wants: guarded_wants, take: guarded_take }
}

/// In the module: hands lines to a host from now on, and tells it of panics as the host's own are told.
pub(super) fn install(log: HostLog) {
    // It is the first: whoever opens a module does so once, before anything else of it runs.
    if tracing::subscriber::set_global_default(Forwarding(log)).is_ok() {
        std::panic::set_hook(Box::new(|panic| tracing::error!("{panic}")));
    }
}

/// A panic of the host's log must not get into the module either.
fn guarded_wants(level: Level) -> bool {
    catch_unwind(AssertUnwindSafe(|| wants(level))).unwrap_or_default()
}

fn guarded_take(line: &Line) {
    // There is nobody to be told of a log that panics.
    let _ = catch_unwind(AssertUnwindSafe(|| take(line)));
}

/// Lines of modules have this target in the host. Their places in the module's text are not known there.
pub(crate) const TARGET: &str = "monas::module";

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

fn take(line: &Line) {
    let Line { level, fatal, target, cycle, words, .. } = line;
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

/// In the module: the one subscriber it has.
struct Forwarding(HostLog);

impl Subscriber for Forwarding {
    fn register_callsite(&self, _: &'static Metadata<'static>) -> Interest {
        // What the host wants may change at any time.
        Interest::sometimes()
    }

    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.is_event() && (self.0.wants)(*metadata.level())
    }

    fn event(&self, event: &Event<'_>) {
        let metadata = event.metadata();
        let mut line = Line {
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

    // Spans are of no use to the log.
    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }
    fn record(&self, _: &Id, _: &Record<'_>) {}
    fn record_follows_from(&self, _: &Id, _: &Id) {}
    fn enter(&self, _: &Id) {}
    fn exit(&self, _: &Id) {}
}

impl Visit for Line {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        match field.name() {
            "message" => self.words.insert_str(0, &format!("{value:?}")),
            "robot" | "host" => self.robot = Some(format!("{value:?}")),
            "agent" => self.agent = Some(format!("{value:?}")),
            "activity" => self.activity = Some(format!("{value:?}")),
            name => {
                // Writing into a text does not fail.
                let _ = write!(self.words, " {name}={value:?}");
            }
        }
    }

    fn record_str(&mut self, field: &Field, value: &str) {
        match field.name() {
            // names stand there as they are, other texts in quotes
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
