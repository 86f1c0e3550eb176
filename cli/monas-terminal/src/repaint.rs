//! Lines that replace each other on a terminal.

use std::io::{self, IsTerminal, Write};

use unicode_width::UnicodeWidthStr;

use crate::{CommandOutput, table};

/// Shows lines in place of the lines shown before; elsewhere than on a terminal, below them.
pub struct Repaint {
    /// The width of the terminal, if there is one.
    columns: Option<usize>,
    /// The number of rows of the terminal that are shown.
    rows: usize,
}

impl Repaint {
    /// On the terminal of the command's results.
    pub fn of_console(console: &CommandOutput<'_>) -> Repaint {
        let is_terminal = console.bars.is_some() && io::stdout().is_terminal();
        Repaint { columns: is_terminal.then(table::columns).flatten(), rows: 0 }
    }

    /// On the terminal of the command's progress.
    pub fn of_progress(console: &CommandOutput<'_>) -> Repaint {
        Repaint { columns: console.bars.as_ref().and_then(|_| table::columns()), rows: 0 }
    }

    /// Whether lines replace those shown before.
    pub const fn replaces(&self) -> bool {
        self.columns.is_some()
    }

    /// Shows these lines.
    pub fn show(&mut self, lines: &[String], out: &mut dyn Write) -> io::Result<()> {
        if self.rows > 0 {
            // To the begin of the first row, and erase from there on.
            write!(out, "\x1b[{}F\x1b[J", self.rows)?;
        }
        lines.iter().try_for_each(|line| writeln!(out, "{line}"))?;
        let rows =
            |columns: usize| lines.iter().map(|line| width(line).div_ceil(columns.max(1)).max(1)).sum();
        self.rows = self.columns.map_or(0, rows);
        Ok(())
    }
}

/// The columns of a line, without sequences that choose a colour.
fn width(line: &str) -> usize {
    let mut parts = line.split("\x1b[");
    let first = parts.next().map_or(0, UnicodeWidthStr::width);
    first + parts.map(|part| part.split_once('m').map_or(0, |(_, text)| text.width())).sum::<usize>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(columns: Option<usize>) -> String {
        let mut out = Vec::new();
        let mut screen = Repaint { columns, rows: 0 };
        for lines in [["ball", "a line that is folded"], ["ball again", "short"]] {
            screen.show(&lines.map(str::to_owned), &mut out).unwrap();
        }
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn lines_replace_all_rows_of_a_terminal_and_nothing_elsewhere() {
        let first = "ball\na line that is folded\n";
        assert_eq!(shown(Some(10)), format!("{first}\x1b[4F\x1b[Jball again\nshort\n"));
        assert_eq!(shown(None), format!("{first}ball again\nshort\n"));
    }
}
