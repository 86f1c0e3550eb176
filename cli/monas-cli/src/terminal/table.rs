//! Tables.

use comfy_table::{Cell, CellAlignment, Table};

/// A table whose columns are right-aligned from column `first_number` on.
pub(crate) fn of_numbers<Row: IntoIterator<Item = String>>(
    header: impl IntoIterator<Item: Into<Cell>>,
    first_number: usize,
    rows: impl IntoIterator<Item = Row>,
) -> Table {
    let mut table = Table::new();
    table.load_style(comfy_table::presets::UTF8_FULL_CONDENSED).set_header(header);
    for row in rows {
        table.add_row(row);
    }
    for column in table.column_iter_mut().skip(first_number) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

/// The short name of a state, by its path without the root; empty for none.
pub(crate) fn state_name(path: &str) -> String {
    if path.is_empty() { String::new() } else { yase::StateNames::brief(&format!("/{path}")) }
}

#[cfg(test)]
mod tests {
    use super::state_name;

    #[test]
    fn a_state_is_named_by_the_words_of_its_role() {
        let paths = ["", "A", "a/A", "b/a/A", "(a~||b)/2/b/(A|c)/A", "(a~||b)/1/a~"];
        assert_eq!(paths.map(state_name), ["", "A", "a/A", "a/A", "b/A", "1/1/a~"]);
    }
}
