//! The field during a match as text: redrawn in place on a terminal, one picture per second
//! elsewhere.

use std::io::{self, Write};
use std::time::Duration;

use monas_match::RunningMatch;
use monas_terminal::{CommandOutput, Repaint};

use super::scoreboard::{Scoreboard, clock, event_line, score_line};

/// The size of the field on a terminal with 80 columns and 24 rows, of which the score, the last
/// event and the cursor take three.
const COLUMNS: usize = 79;
const ROWS: usize = 21;

/// Simulated time between two pictures that do not replace each other.
const FRAME_INTERVAL: Duration = Duration::from_secs(1);

/// Shows the field of a match.
pub(crate) struct FieldView<'a> {
    out: Box<dyn Write + 'a>,
    repaint: Repaint,
    is_coloured: bool,
    /// The time of the next picture.
    next: Duration,
    step: Duration,
}

impl<'a> FieldView<'a> {
    pub(crate) fn new(console: &'a mut CommandOutput<'_>) -> FieldView<'a> {
        let (repaint, is_coloured) = (Repaint::of_progress(console), console.colour_err);
        let step = if repaint.replaces() { Duration::ZERO } else { FRAME_INTERVAL };
        FieldView { out: console.remarks(), repaint, is_coloured, next: Duration::ZERO, step }
    }
}

impl Scoreboard for FieldView<'_> {
    fn show(&mut self, running: &RunningMatch) -> io::Result<()> {
        if running.now() < self.next {
            return Ok(());
        }
        self.next = running.now() + self.step;
        let mut lines = vec![format!("{}  {}", clock(running.now()), score_line(&running.score()))];
        lines.extend(running.text(COLUMNS, ROWS, self.is_coloured));
        lines.push(running.events().last().map(event_line).unwrap_or_default());
        self.repaint.show(&lines, &mut self.out)
    }
}
