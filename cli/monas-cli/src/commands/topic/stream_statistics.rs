//! `monas topic hz`, `bw` and `delay`: statistics of published messages.

use std::collections::BTreeMap;
use std::time::Duration;

use monas_link::control::messages::Seen;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, Repaint, WallClock};
use serde_json::{Value, json};

use super::echo::hosts;
use crate::remote::{RunSelector, WatchLimits, connection, failure, watch};

/// Time until the first report.
const FIRST_REPORT: Duration = Duration::from_millis(80);

/// Time between later reports.
const REPORT_INTERVAL: Duration = Duration::from_secs(1);

/// Statistics of the messages of one publisher on one topic.
struct StreamStatistics {
    first: Seen,
    last: Seen,
    /// Messages received; others may have been missed.
    seen: u64,
    bytes: u64,
    interval: ValueRange,
    delay: ValueRange,
}

/// Statistics of a quantity, s.
#[derive(Clone, Copy, Default)]
struct ValueRange {
    count: u64,
    sum: f64,
    min: f64,
    max: f64,
}

/// The quantity to report.
#[derive(Clone, Copy)]
enum StreamMetric {
    Hz,
    Bw,
    Delay,
}

pub(crate) fn hz(
    pattern: &str,
    limits: &WatchLimits,
    run: &RunSelector,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    measure(StreamMetric::Hz, pattern, limits, run, console)
}

pub(crate) fn bw(
    pattern: &str,
    limits: &WatchLimits,
    run: &RunSelector,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    measure(StreamMetric::Bw, pattern, limits, run, console)
}

pub(crate) fn delay(
    pattern: &str,
    limits: &WatchLimits,
    run: &RunSelector,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    measure(StreamMetric::Delay, pattern, limits, run, console)
}

fn measure(
    figure: StreamMetric,
    pattern: &str,
    limits: &WatchLimits,
    choice: &RunSelector,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = choice.format.value;
    // The last value of a state is delivered too, although it was published before; it does not
    // count for the rate.
    let begin = connection::client(choice)?.describe().map_err(failure(format))?.now;
    let mut streams: BTreeMap<[String; 4], StreamStatistics> = BTreeMap::new();
    let mut lost = 0;
    let (clock, mut next) = (WallClock::start(), FIRST_REPORT);
    let mut screen = Repaint::of_console(console);
    let exit = watch(pattern, false, limits, choice, console, |seen, console| {
        if let Some(seen) = seen.filter(|seen| seen.local >= begin) {
            lost = seen.lost;
            let key = [&seen.path, &seen.host, &seen.from, &seen.publisher].map(String::clone);
            match streams.get_mut(&key) {
                Some(stream) => stream.add(seen),
                None => drop(streams.insert(key, StreamStatistics::new(seen))),
            }
        }
        if clock.elapsed() >= next && !streams.is_empty() {
            next = clock.elapsed() + REPORT_INTERVAL;
            print(figure, streams.values(), lost, format, &mut screen, console)?;
        }
        Ok(true)
    })?;
    if streams.is_empty() && format == Format::Text {
        writeln!(console.out, "nothing was published on `{pattern}` meanwhile")?;
    }
    // The last report covers everything received.
    print(figure, streams.values(), lost, format, &mut screen, console)?;
    Ok(exit)
}

impl StreamStatistics {
    fn new(seen: Seen) -> StreamStatistics {
        let mut stream = StreamStatistics {
            first: seen.clone(),
            last: seen.clone(),
            seen: 0,
            bytes: 0,
            interval: ValueRange::default(),
            delay: ValueRange::default(),
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

    /// Messages per second of the run's time, including missed ones; unknown before the second
    /// message.
    fn rate(&self) -> Option<f64> {
        let seconds = span(self.first.local, self.last.local);
        let messages = self.last.sequence.saturating_sub(self.first.sequence);
        (seconds > 0.0 && messages > 0).then(|| messages as f64 / seconds)
    }

    fn mean_size(&self) -> f64 {
        self.bytes as f64 / self.seen as f64
    }
}

/// The time from one moment to a later one, s.
fn span(from: u64, to: u64) -> f64 {
    Duration::from_nanos(to.saturating_sub(from)).as_secs_f64()
}

impl ValueRange {
    fn add(&mut self, value: f64) {
        self.min = if self.count == 0 { value } else { self.min.min(value) };
        self.max = self.max.max(value);
        self.sum += value;
        self.count += 1;
    }

    fn mean(self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }

    fn text(self) -> String {
        match self.mean() {
            Some(mean) => {
                format!("{:.1} ms ({:.1} to {:.1})", mean * 1e3, self.min * 1e3, self.max * 1e3)
            }
            None => "unknown".into(),
        }
    }

    fn object(self) -> Value {
        json!({"mean": self.mean(), "least": self.mean().map(|_| self.min), "most": self.mean().map(|_| self.max)})
    }
}

fn print<'a>(
    figure: StreamMetric,
    streams: impl Iterator<Item = &'a StreamStatistics>,
    lost: u64,
    format: Format,
    screen: &mut Repaint,
    console: &mut CommandOutput<'_>,
) -> Result<(), CommandFailure> {
    if format == Format::Json {
        streams
            .map(|stream| object(figure, stream, lost))
            .try_for_each(|it| writeln!(console.out, "{it}"))?;
    } else {
        let mut lines: Vec<String> = streams.map(|stream| line(figure, stream)).collect();
        if lost > 0 {
            lines.push(format!(
                "({lost} messages were overwritten before they were fetched; rates count them)"
            ));
        }
        screen.show(&lines, console.out)?;
    }
    console.out.flush()?;
    Ok(())
}

fn line(figure: StreamMetric, stream: &StreamStatistics) -> String {
    let Seen { path, publisher, .. } = &stream.last;
    let said = match figure {
        StreamMetric::Hz => {
            let rate = stream.rate().map_or_else(|| "no rate yet".into(), |rate| format!("{rate:.2} Hz"));
            format!("{rate}, interval {}, {} seen", stream.interval.text(), stream.seen)
        }
        StreamMetric::Bw => {
            let size = stream.mean_size();
            let bytes =
                stream.rate().map_or_else(|| "no rate yet".into(), |rate| format!("{:.0} B/s", rate * size));
            format!("{bytes}, {size:.1} B a message, {} seen", stream.seen)
        }
        StreamMetric::Delay => format!("{}, {} seen", stream.delay.text(), stream.seen),
    };
    format!("{path} on {} by {publisher}: {said}", hosts(&stream.last))
}

fn object(figure: StreamMetric, stream: &StreamStatistics, lost: u64) -> Value {
    let Seen { host, from, path, publisher, .. } = &stream.last;
    let mut object = json!({"topic": path, "host": host, "from": from, "publisher": publisher, "seen": stream.seen,
        "lost": lost});
    match figure {
        StreamMetric::Hz => {
            object["hz"] = stream.rate().into();
            object["interval_seconds"] = stream.interval.object();
        }
        StreamMetric::Bw => {
            object["bytes_per_second"] = stream.rate().map(|rate| rate * stream.mean_size()).into();
            object["mean_bytes"] = stream.mean_size().into();
        }
        StreamMetric::Delay => object["delay_seconds"] = stream.delay.object(),
    }
    object
}
