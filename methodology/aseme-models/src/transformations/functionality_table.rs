//! SRM to FT: the functionality table of a system, and its output formats.

use std::fmt::Write;

use crate::functionality::{FunctionalityRow, FunctionalityTable};
use crate::roles::SystemRoles;

/// The functionality of each activity of each role: first activities of the role itself, then those
/// of its capabilities.
pub fn functionality_table(srm: &SystemRoles) -> FunctionalityTable {
    let mut rows = Vec::new();
    for role in &srm.roles {
        let capabilities = role.capabilities.iter().filter_map(|&index| srm.capabilities.get(index));
        let of_capabilities: Vec<(&str, &[usize])> = capabilities
            .map(|capability| (capability.name.as_str(), capability.activities.as_slice()))
            .collect();
        let in_capability =
            |activity: &usize| of_capabilities.iter().any(|(_, activities)| activities.contains(activity));
        let own: Vec<usize> =
            role.activities.iter().copied().filter(|activity| !in_capability(activity)).collect();
        for (capability, activities) in
            std::iter::once(("", own.as_slice())).chain(of_capabilities.iter().copied())
        {
            rows.extend(activities.iter().filter_map(|&activity| row(srm, &role.name, capability, activity)));
        }
    }
    FunctionalityTable { rows }
}

fn row(srm: &SystemRoles, role: &str, capability: &str, activity: usize) -> Option<FunctionalityRow> {
    let activity = srm.activities.get(activity)?;
    let functionality =
        activity.functionality.and_then(|index| srm.functionalities.get(index)).cloned().unwrap_or_default();
    Some(FunctionalityRow {
        role: role.into(),
        capability: capability.into(),
        activity: activity.name.clone(),
        functionality: functionality.description,
        technology: functionality.technology,
        environment: functionality.environment,
        permissions: functionality.permissions,
        algorithm: functionality.algorithm,
        ..FunctionalityRow::default()
    })
}

/// The heads of the columns.
const COLUMN_HEADS: [&str; 8] = [
    "role",
    "capability",
    "activity",
    "functionality",
    "technology",
    "environment",
    "permissions",
    "algorithm",
];

impl FunctionalityTable {
    /// A table in text, without empty columns. Roles and capabilities are written once, in their
    /// first row.
    pub fn to_table(&self) -> String {
        let shown = self.shown();
        let rows: Vec<[String; 8]> = self.without_repetitions();
        let width = |column: usize| {
            let cells = rows.iter().map(|row| row[column].chars().count());
            cells.chain([COLUMN_HEADS[column].len()]).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..COLUMN_HEADS.len()).map(width).collect();
        let line = |cells: &[String; 8]| {
            let cells = shown.iter().map(|&column| format!("{:1$}", cells[column], widths[column]));
            format!("{}\n", cells.collect::<Vec<_>>().join("  ").trim_end())
        };
        let rules = std::array::from_fn(|column| "-".repeat(widths[column]));
        let head = [line(&COLUMN_HEADS.map(String::from)), line(&rules)].concat();
        head + &rows.iter().map(line).collect::<String>()
    }

    /// An HTML table; roles and capabilities span their rows.
    pub fn to_html(&self) -> String {
        let shown = self.shown();
        let mut html = String::from("<table>\n  <tr>");
        shown.iter().for_each(|&column| html.extend(["<th>", COLUMN_HEADS[column], "</th>"]));
        html.push_str("</tr>\n");
        for (index, row) in self.rows.iter().enumerate() {
            html.push_str("  <tr>");
            for &column in &shown {
                let rows = if column < 2 { self.rows_of(index, column) } else { 1 };
                let cell = escaped(row.cells()[column]);
                // writing to a String cannot fail
                let _ = match rows {
                    0 => Ok(()),
                    1 => write!(html, "<td>{cell}</td>"),
                    rows => write!(html, "<td rowspan=\"{rows}\">{cell}</td>"),
                };
            }
            html.push_str("</tr>\n");
        }
        html + "</table>\n"
    }

    /// Comma-separated values according to RFC 4180, with all columns and cells filled.
    pub fn to_csv(&self) -> String {
        let line = |cells: [&str; 8]| format!("{}\r\n", cells.map(csv_cell).join(","));
        line(COLUMN_HEADS) + &self.rows.iter().map(|row| line(row.cells())).collect::<String>()
    }

    /// The columns that are not empty, and always the first four.
    fn shown(&self) -> Vec<usize> {
        let is_used =
            |column: &usize| *column < 4 || self.rows.iter().any(|row| !row.cells()[*column].is_empty());
        (0..COLUMN_HEADS.len()).filter(is_used).collect()
    }

    fn without_repetitions(&self) -> Vec<[String; 8]> {
        let cells = |index: usize, row: &FunctionalityRow| {
            let mut cells = row.cells().map(String::from);
            (0..2)
                .filter(|&column| self.rows_of(index, column) == 0)
                .for_each(|column| cells[column].clear());
            cells
        };
        self.rows.iter().enumerate().map(|(index, row)| cells(index, row)).collect()
    }

    /// The number of rows that the role or capability of a row spans; 0 in its further rows.
    fn rows_of(&self, index: usize, column: usize) -> usize {
        let key = |row: &FunctionalityRow| {
            row.cells()[..=column].iter().map(ToString::to_string).collect::<Vec<String>>()
        };
        let own = key(&self.rows[index]);
        if index > 0 && key(&self.rows[index - 1]) == own {
            return 0;
        }
        self.rows[index..].iter().take_while(|row| key(row) == own).count()
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('\n', "<br>")
}

fn csv_cell(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.into(),
    }
}
