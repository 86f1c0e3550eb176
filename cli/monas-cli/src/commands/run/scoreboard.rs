//! The score during a match: redrawn in place on a terminal, line by line elsewhere.

use std::io::{self, Write};
use std::time::Duration;

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use monas_match::{MatchEvent, RunningMatch};
use monas_terminal::CommandOutput;

use super::field_view::FieldView;

/// Shows the progress of a match.
pub(crate) trait Scoreboard {
    /// Shows what has changed since the last call.
    fn show(&mut self, running: &RunningMatch) -> io::Result<()>;
}

/// The scoreboard for a terminal or a file; the field, if it was requested.
pub(crate) fn for_console<'c>(
    console: &'c mut CommandOutput<'_>,
    length: Duration,
    is_field_shown: bool,
) -> Box<dyn Scoreboard + 'c> {
    if is_field_shown {
        return Box::new(FieldView::new(console));
    }
    match &console.bars {
        _ if console.quiet => Box::new(Lines { out: Box::new(io::sink()), events: 0, minutes: None }),
        Some(bars) => Box::new(Bar::new(bars, length, console.colour_err)),
        None => Box::new(Lines { out: Box::new(&mut *console.err), events: 0, minutes: None }),
    }
}

/// One line for each notable event and for each minute.
struct Lines<'a> {
    out: Box<dyn Write + 'a>,
    /// The number of events that have been written.
    events: usize,
    /// The last minute whose score has been written.
    minutes: Option<u64>,
}

impl Scoreboard for Lines<'_> {
    fn show(&mut self, running: &RunningMatch) -> io::Result<()> {
        for event in &running.events()[self.events..] {
            writeln!(self.out, "{}", event_line(event))?;
        }
        self.events = running.events().len();
        let minutes = running.now().as_secs() / 60;
        if self.minutes.replace(minutes) != Some(minutes) {
            writeln!(self.out, "{}  {}", clock(running.now()), score_line(&running.score()))?;
        }
        Ok(())
    }
}

/// A score and a bar that are redrawn, with the events above.
struct Bar {
    bar: ProgressBar,
    events: usize,
}

impl Bar {
    fn new(bars: &MultiProgress, length: Duration, colour: bool) -> Bar {
        let bar = bars.add(ProgressBar::new(milliseconds(length)));
        let template = if colour { BAR_IN_COLOUR } else { BAR_TEMPLATE };
        // If indicatif rejects the template, its default style shows the same numbers.
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("━╸ "));
        }
        Bar { bar, events: 0 }
    }
}

const BAR_TEMPLATE: &str = "{msg}\n{wide_bar} {prefix} {percent:>3} %";
const BAR_IN_COLOUR: &str = "{msg:.bold}\n{wide_bar:.green} {prefix} {percent:>3} %";

impl Scoreboard for Bar {
    fn show(&mut self, running: &RunningMatch) -> io::Result<()> {
        for event in &running.events()[self.events..] {
            self.bar.println(event_line(event));
        }
        self.events = running.events().len();
        self.bar.set_message(score_line(&running.score()));
        self.bar.set_prefix(clock(running.now()));
        self.bar.set_position(milliseconds(running.now()));
        Ok(())
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

pub(crate) fn event_line(event: &MatchEvent) -> String {
    format!("{}  {}", clock(event.time), event.text)
}

/// `Blue 2 : 1 Red, second half, 4:12 left, PLAYING`
pub(crate) fn score_line(score: &monas_match::Scoreboard) -> String {
    let [left, right] = &score.teams;
    let half = if score.half == 1 { "first half" } else { "second half" };
    let left_over = clock(Duration::from_secs(score.seconds_left.into()));
    let goals = format!("{} {} : {} {}", left.name, left.goals, right.goals, right.name);
    format!("{goals}, {half}, {} left, {}", left_over.trim_start(), score.phase)
}

/// Minutes and seconds, at least six characters wide.
pub(crate) fn clock(time: Duration) -> String {
    let seconds = time.as_secs();
    format!("{:>3}:{:02}", seconds / 60, seconds % 60)
}

fn milliseconds(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_shows_minutes_and_seconds() {
        assert_eq!(clock(Duration::from_millis(61_999)), "  1:01");
        assert_eq!(clock(Duration::from_secs(6000)), "100:00");
    }

    #[test]
    fn both_bars_are_understood() {
        assert!(
            ProgressStyle::with_template(BAR_TEMPLATE).is_ok()
                && ProgressStyle::with_template(BAR_IN_COLOUR).is_ok()
        );
    }
}
