//! The cycles of bodies in real time.

use std::io::{self, Write};

use monas::{BodyStatistics, Percentiles};
use monas_terminal::{Format, table};
use serde_json::{Value, json};

/// Writes a table of the bodies, or one object for each.
pub(super) fn write(out: &mut dyn Write, format: Format, bodies: &[BodyStatistics]) -> io::Result<()> {
    match format {
        Format::Json => bodies.iter().try_for_each(|body| writeln!(out, "{}", object(body))),
        Format::Text if bodies.is_empty() => Ok(()),
        Format::Text => {
            let header = [
                "body of",
                "Hz",
                "cycles",
                "overruns",
                "late p50 ms",
                "p99 ms",
                "sense to act p50 ms",
                "p99 ms",
            ];
            writeln!(out, "{}\n", table::of_numbers(header, 1, bodies.iter().map(row)))
        }
    }
}

fn row(body: &BodyStatistics) -> Vec<String> {
    let mut cells = vec![body.host.clone(), format!("{:.0}", body.period.as_secs_f64().recip())];
    cells.extend([body.cycles, body.overruns].map(|count| count.to_string()));
    cells.extend(median_and_p99(body.lateness));
    cells.extend(median_and_p99(body.latency));
    cells
}

/// The median and the 99th percentile in milliseconds.
pub(super) fn median_and_p99(times: Option<Percentiles>) -> [String; 2] {
    times.map_or_else(
        || ["-", "-"].map(str::to_owned),
        |times| [times.p50, times.p99].map(|time| format!("{:.2}", time.as_secs_f64() * 1e3)),
    )
}

/// A body as an object.
pub(super) fn object(body: &BodyStatistics) -> Value {
    let seconds = |times: Option<Percentiles>, which: fn(&Percentiles) -> std::time::Duration| {
        times.map(|times| which(&times).as_secs_f64())
    };
    json!({
        "kind": "body",
        "host": body.host,
        "period_seconds": body.period.as_secs_f64(),
        "cycles": body.cycles,
        "overruns": body.overruns,
        "failures": body.failures,
        "lateness_p50_seconds": seconds(body.lateness, |times| times.p50),
        "lateness_p99_seconds": seconds(body.lateness, |times| times.p99),
        "sense_to_act_p50_seconds": seconds(body.latency, |times| times.p50),
        "sense_to_act_p99_seconds": seconds(body.latency, |times| times.p99),
    })
}
