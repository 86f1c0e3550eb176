//! Tables that fit a terminal: cells are folded between words, and no word is cut.

use std::fmt;
use std::io::{self, IsTerminal};

use unicode_width::UnicodeWidthStr;

/// Blanks between two columns, and between those of a table that does not fit with them.
const COLUMN_SPACINGS: [usize; 2] = [2, 1];

/// A table whose columns are right-aligned from column `first_number` on.
pub struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
    first_number: usize,
}

/// A table whose columns are right-aligned from column `first_number` on.
pub fn of_numbers<Row: IntoIterator<Item = String>>(
    header: impl IntoIterator<Item: Into<String>>,
    first_number: usize,
    rows: impl IntoIterator<Item = Row>,
) -> Table {
    let header = header.into_iter().map(Into::into).collect();
    Table { header, rows: rows.into_iter().map(|row| row.into_iter().collect()).collect(), first_number }
}

/// The cells of a row, each in one or more lines.
pub type FoldedRow = Vec<Vec<String>>;

/// A table in a given width.
pub struct FoldedTable {
    /// The width of each column.
    pub widths: Vec<usize>,
    /// The names of the columns.
    pub header: FoldedRow,
    /// The rows below the header.
    pub rows: Vec<FoldedRow>,
}

impl Table {
    /// Folds cells until the table has at most this width, with a gap between columns. It stays
    /// wider if single words are too long.
    pub fn folded(&self, limit: usize, gap: usize) -> FoldedTable {
        let all = || self.rows.iter().chain([&self.header]);
        let widest = |column: usize, width: &dyn Fn(&str) -> usize| {
            all().filter_map(|row| row.get(column)).map(|cell| width(cell)).max().unwrap_or_default()
        };
        let mut widths: Vec<usize> =
            (0..self.header.len()).map(|column| widest(column, &UnicodeWidthStr::width)).collect();
        let gaps = gap * widths.len().saturating_sub(1);
        // Names are divided only where folding between words is not enough.
        for divides in [false, true] {
            let min = |column: usize| match column < self.first_number {
                true => widest(column, &|cell| longest(cell, divides)),
                // Numbers stay whole, and their headers are folded.
                false => {
                    let numbers = self.rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.width());
                    numbers.chain([longest(&self.header[column], divides)]).max().unwrap_or_default()
                }
            };
            let min: Vec<usize> = (0..widths.len()).map(min).collect();
            while widths.iter().sum::<usize>() + gaps > limit {
                let can_shrink = (0..widths.len()).filter(|&column| widths[column] > min[column]);
                let Some(column) = can_shrink.max_by_key(|&column| widths[column]) else { break };
                widths[column] -= 1;
            }
        }
        let fold = |row: &Vec<String>| -> FoldedRow {
            row.iter().zip(&widths).map(|(cell, &width)| folded(cell, width)).collect()
        };
        FoldedTable { header: fold(&self.header), rows: self.rows.iter().map(fold).collect(), widths }
    }

    /// Header, a rule, and the rows.
    fn text(&self, limit: usize) -> String {
        let [wide, narrow] = COLUMN_SPACINGS.map(|gap| (gap, self.folded(limit, gap)));
        let (gap, table) = if wide.1.width(wide.0) <= limit { wide } else { narrow };
        let mut lines = self.lines(&table.header, &table.widths, gap);
        lines.push("─".repeat(table.width(gap)));
        lines.extend(table.rows.iter().flat_map(|row| self.lines(row, &table.widths, gap)));
        lines.join("\n")
    }

    fn lines(&self, row: &FoldedRow, widths: &[usize], gap: usize) -> Vec<String> {
        let height = row.iter().map(Vec::len).max().unwrap_or_default();
        (0..height).map(|index| self.line(row, index, widths, gap)).collect()
    }

    fn line(&self, row: &FoldedRow, index: usize, widths: &[usize], gap: usize) -> String {
        let mut line = String::new();
        for (column, (cell, &width)) in row.iter().zip(widths).enumerate() {
            let text = cell.get(index).map(String::as_str).unwrap_or_default();
            let blank = " ".repeat(width.saturating_sub(text.width()));
            let (before, after) = if column < self.first_number { ("", &*blank) } else { (&*blank, "") };
            line += &format!("{before}{text}{after}{:gap$}", "");
        }
        line.truncate(line.trim_end().len());
        line
    }
}

impl FoldedTable {
    fn width(&self, gap: usize) -> usize {
        self.widths.iter().sum::<usize>() + gap * self.widths.len().saturating_sub(1)
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(columns().unwrap_or(usize::MAX)))
    }
}

/// The columns of the terminal on which results are written: `COLUMNS`, or what the terminal says;
/// none without a terminal.
pub fn columns() -> Option<usize> {
    let asked = std::env::var("COLUMNS").ok().and_then(|columns| columns.parse().ok());
    let own = || ratatui::crossterm::terminal::size().ok().filter(|_| io::stdout().is_terminal());
    asked.or_else(|| own().map(|(columns, _)| usize::from(columns)))
}

/// The words of a text, each with the blanks or the sign of paths and lists that separates it from
/// the next. `divides` also divides names, as in `Motion` and `Controller`.
fn words(text: &str, divides: bool) -> Vec<&str> {
    let mut words = Vec::new();
    let (mut start, mut last) = (0, None);
    for (index, c) in text.char_indices() {
        let begins = match last {
            Some(' ' | '/' | '.' | ',' | '|') => c != ' ',
            Some('_') => divides,
            Some(last) => divides && char::is_lowercase(last) && c.is_uppercase(),
            None => false,
        };
        if begins {
            words.push(&text[start..index]);
            start = index;
        }
        last = Some(c);
    }
    words.push(&text[start..]);
    words
}

fn longest(text: &str, divides: bool) -> usize {
    words(text, divides).iter().map(|word| word.trim_end().width()).max().unwrap_or_default()
}

/// The text in lines of at most this width; names are divided if they are longer, and what cannot
/// be divided has its own line.
fn folded(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in words(text, longest(text, false) > width) {
        if let Some(line) = lines.last_mut() {
            match line.is_empty() || line.width() + word.trim_end().width() <= width {
                true => line.push_str(word),
                false => lines.push(word.to_owned()),
            }
        }
    }
    lines.iter().map(|line| line.trim_end().to_owned()).collect()
}

/// The short name of a state, by its path without the root; empty for none.
pub fn state_name(path: &str) -> String {
    if path.is_empty() { String::new() } else { yase::StateNames::brief(&format!("/{path}")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_is_named_by_the_words_of_its_role() {
        let paths = ["", "A", "a/A", "b/a/A", "(a~||b)/2/b/(A|c)/A", "(a~||b)/1/a~"];
        assert_eq!(paths.map(state_name), ["", "A", "a/A", "a/A", "b/A", "1/1/a~"]);
    }

    fn topics() -> Table {
        let rows = [["soccer/attack_status", "MotionController", "12"], ["ball", "Vision", "1.25 ms"]];
        of_numbers(["topic", "by", "mean cycle"], 2, rows.map(|row| row.map(str::to_owned)))
    }

    #[test]
    fn with_room_nothing_is_folded_and_numbers_are_aligned() {
        let expected = "\
topic                 by                mean cycle
──────────────────────────────────────────────────
soccer/attack_status  MotionController          12
ball                  Vision               1.25 ms";
        assert_eq!(topics().text(usize::MAX), expected);
        assert!(of_numbers(["a"], 0, Vec::<Vec<String>>::new()).to_string().ends_with('─'));
    }

    #[test]
    fn cells_are_folded_between_words_and_only_as_far_as_needed() {
        let narrow = topics().folded(42, 2);
        assert_eq!(narrow.width(2), 42);
        assert_eq!(narrow.rows[0][..2], [vec!["soccer/", "attack_status"], vec!["MotionController"]]);
        let min = topics().folded(0, 2);
        assert_eq!(min.widths, [7, 10, 7]);
        assert_eq!(min.rows[0][0], ["soccer/", "attack_", "status"]);
        assert_eq!(min.rows[0][1], ["Motion", "Controller"]);
        assert_eq!(
            (&min.header[2][..], &min.rows[1][2][..]),
            (&["mean".into(), "cycle".into()][..], &["1.25 ms".into()][..])
        );
    }

    #[test]
    fn a_table_that_does_not_fit_has_narrow_gaps() {
        let lines = |limit| topics().text(limit).lines().last().map(str::to_owned);
        assert_eq!(lines(28).as_deref(), Some("ball     Vision      1.25 ms"));
        assert_eq!(lines(26).as_deref(), Some("ball    Vision     1.25 ms"));
    }

    #[test]
    fn folding_loses_nothing() {
        for text in ["", "a b  c", "monas.soccer.CalibrationRequest", "ωω/ω", "data 16"] {
            assert_eq!(words(text, true).concat(), text);
            assert_eq!(folded(text, 3).concat().replace(' ', ""), text.replace(' ', ""));
        }
    }
}
