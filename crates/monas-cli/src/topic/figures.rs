//! `monas topic hz`, `bw` and `delay`: figures of what is published.

use std::collections::BTreeMap;
use std::time::Duration;

use monas_link::control::messages::Seen;
use serde_json::{Value, json};

use super::arguments::{Limits, RunChoice};
use super::connect::{self, failure};
use super::echo::{place, watch};
use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::run::WallClock;

/// When figures are first told,
const FIRST: Duration = Duration::from_millis(80);

/// and how often from then on.
const AGAIN: Duration = Duration::from_secs(1);

/// What is known of the messages of one publisher on one topic.
struct Stream {
    first: Seen,
    last: Seen,
    /// Messages that were seen; others may have been missed.
    seen: u64,
    bytes: u64,
    interval: Spread,
    delay: Spread,
}

/// The values of something, s.
#[derive(Clone, Copy, Default)]
struct Spread {
    count: u64,
    sum: f64,
    least: f64,
    most: f64,
}

/// How a stream is told.
#[derive(Clone, Copy)]
enum Figure {
    Hz,
    Bw,
    Delay,
}

pub(super) fn hz(
    pattern: &str,
    limits: &Limits,
    run: &RunChoice,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    measure(Figure::Hz, pattern, limits, run, console)
}

pub(super) fn bw(
    pattern: &str,
    limits: &Limits,
    run: &RunChoice,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    measure(Figure::Bw, pattern, limits, run, console)
}

pub(super) fn delay(
    pattern: &str,
    limits: &Limits,
    run: &RunChoice,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    measure(Figure::Delay, pattern, limits, run, console)
}

fn measure(
    figure: Figure,
    pattern: &str,
    limits: &Limits,
    choice: &RunChoice,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let format = choice.format.value;
    // What was published before is told too of states, and says nothing of how often.
    let begin = connect::client(choice)?.describe().map_err(failure(format))?.now;
    let mut streams: BTreeMap<[String; 4], Stream> = BTreeMap::new();
    let mut lost = 0;
    let (clock, mut next) = (WallClock::start(), FIRST);
    let exit = watch(pattern, false, limits, choice, console, |seen, console| {
        if let Some(seen) = seen.filter(|seen| seen.local >= begin) {
            lost = seen.lost;
            let key = [&seen.path, &seen.host, &seen.from, &seen.publisher].map(String::clone);
            match streams.get_mut(&key) {
                Some(stream) => stream.add(seen),
                None => drop(streams.insert(key, Stream::new(seen))),
            }
        }
        if clock.elapsed() >= next && !streams.is_empty() {
            next = clock.elapsed() + AGAIN;
            tell(figure, streams.values(), lost, format, console)?;
        }
        Ok(true)
    })?;
    if streams.is_empty() && format == Format::Text {
        writeln!(console.out, "nothing was published on `{pattern}` meanwhile")?;
    }
    // The last word is on all that was seen.
    tell(figure, streams.values(), lost, format, console)?;
    Ok(exit)
}

impl Stream {
    fn new(seen: Seen) -> Stream {
        let mut stream = Stream {
            first: seen.clone(),
            last: seen.clone(),
            seen: 0,
            bytes: 0,
            interval: Spread::default(),
            delay: Spread::default(),
        };
        stream.count(&seen);
        stream
    }

    fn add(&mut self, seen: Seen) {
        if seen.sequence == self.last.sequence + 1 {
            self.interval.add(span(self.last.local, seen.local));
        }
        self.count(&seen);
        self.last = seen;
    }

    fn count(&mut self, seen: &Seen) {
        self.seen += 1;
        self.bytes += seen.size;
        self.delay.add(span(seen.local, seen.now));
    }

    /// Messages a second of the run's time, those that were missed included; unknown before the second message.
    fn rate(&self) -> Option<f64> {
        let seconds = span(self.first.local, self.last.local);
        let messages = self.last.sequence.saturating_sub(self.first.sequence);
        (seconds > 0.0 && messages > 0).then(|| messages as f64 / seconds)
    }

    fn mean_size(&self) -> f64 {
        self.bytes as f64 / self.seen as f64
    }
}

/// From one moment to a later one, s.
fn span(from: u64, to: u64) -> f64 {
    Duration::from_nanos(to.saturating_sub(from)).as_secs_f64()
}

impl Spread {
    fn add(&mut self, value: f64) {
        self.least = if self.count == 0 { value } else { self.least.min(value) };
        self.most = self.most.max(value);
        self.sum += value;
        self.count += 1;
    }

    fn mean(self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }

    fn text(self) -> String {
        match self.mean() {
            Some(mean) => {
                format!("{:.1} ms ({:.1} to {:.1})", mean * 1e3, self.least * 1e3, self.most * 1e3)
            }
            None => "unknown".into(),
        }
    }

    fn object(self) -> Value {
        json!({"mean": self.mean(), "least": self.mean().map(|_| self.least), "most": self.mean().map(|_| self.most)})
    }
}

fn tell<'a>(
    figure: Figure,
    streams: impl Iterator<Item = &'a Stream>,
    lost: u64,
    format: Format,
    console: &mut Console<'_>,
) -> Result<(), Failure> {
    for stream in streams {
        match format {
            Format::Json => writeln!(console.out, "{}", object(figure, stream, lost))?,
            Format::Text => writeln!(console.out, "{}", line(figure, stream))?,
        }
    }
    if lost > 0 && format == Format::Text {
        writeln!(console.out, "({lost} messages were gone before they could be fetched; rates count them)")?;
    }
    console.out.flush()?;
    Ok(())
}

fn line(figure: Figure, stream: &Stream) -> String {
    let Seen { path, publisher, .. } = &stream.last;
    let said = match figure {
        Figure::Hz => {
            let rate = stream.rate().map_or_else(|| "no rate yet".into(), |rate| format!("{rate:.2} Hz"));
            format!("{rate}, interval {}, {} seen", stream.interval.text(), stream.seen)
        }
        Figure::Bw => {
            let size = stream.mean_size();
            let bytes =
                stream.rate().map_or_else(|| "no rate yet".into(), |rate| format!("{:.0} B/s", rate * size));
            format!("{bytes}, {size:.1} B a message, {} seen", stream.seen)
        }
        Figure::Delay => format!("{}, {} seen", stream.delay.text(), stream.seen),
    };
    format!("{path} on {} by {publisher}: {said}", place(&stream.last))
}

fn object(figure: Figure, stream: &Stream, lost: u64) -> Value {
    let Seen { host, from, path, publisher, .. } = &stream.last;
    let mut object = json!({"topic": path, "host": host, "from": from, "publisher": publisher, "seen": stream.seen,
        "lost": lost});
    match figure {
        Figure::Hz => {
            object["hz"] = stream.rate().into();
            object["interval_seconds"] = stream.interval.object();
        }
        Figure::Bw => {
            object["bytes_per_second"] = stream.rate().map(|rate| rate * stream.mean_size()).into();
            object["mean_bytes"] = stream.mean_size().into();
        }
        Figure::Delay => object["delay_seconds"] = stream.delay.object(),
    }
    object
}
