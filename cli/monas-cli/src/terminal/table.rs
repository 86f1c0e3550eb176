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

/// The last two segments of a state's path: paths in charts made from formulas are long.
pub(crate) fn short_path(path: &str) -> &str {
    path.rmatch_indices('/').nth(1).map_or(path, |(place, _)| &path[place + 1..])
}

#[cfg(test)]
mod tests {
    use super::short_path;

    #[test]
    fn a_short_path_has_the_last_two_states() {
        let paths = ["", "A", "a/A", "b/a/A", "a||(b/c)/d/A"];
        assert_eq!(paths.map(short_path), ["", "A", "a/A", "a/A", "d/A"]);
    }
}
