//! Explanations of all diagnostic codes, for `monas explain` and for the book.
//!
//! The folder `explanations` is the only source. It has one Markdown file per [`Family`] of codes,
//! with one section per code: what the diagnostic means, the files of an example and the command
//! that reports it, and a paragraph that begins with `Remedy:`. An example without a command is
//! checked by the usual command of its last file. A code that no file can provoke has a paragraph
//! that begins with `Arises:` instead of an example.
//!
//! The crates that emit diagnostics do not depend on this one, so that a library carries no texts.
//! Tests compare: each code in the sources of the workspace is explained, each explained code is in
//! the sources, and each example gives its code.
//!
//! ```
//! let explained = monas_diagnostics::explanations();
//! let found = explained.iter().find(|it| it.code == "E0205").ok_or("not explained")?;
//! assert_eq!(found.title, "an operator lacks a term");
//! assert_eq!(found.command().as_deref(), Some("monas model check example.srm"));
//! assert!(found.text(80).contains("Remedy: "));
//! # Ok::<(), &str>(())
//! ```

mod explanation;

use std::fmt::Write;

pub use explanation::{Explanation, ExplanationPart};

/// Codes about one subject, which begin with the same characters.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Family {
    /// The subject.
    pub title: &'static str,
    /// The file in the folder `explanations`.
    file: &'static str,
    /// Its text, as Markdown.
    text: &'static str,
}

impl Family {
    /// The explanations of the family, in the order of their codes.
    pub fn explanations(&self) -> impl Iterator<Item = Explanation> + use<> {
        self.text.split("\n## ").skip(1).map(Explanation::parse)
    }
}

/// Reads a file of the folder `explanations`.
macro_rules! family {
    ($title:literal, $file:literal) => {
        Family { title: $title, file: $file, text: include_str!(concat!("../explanations/", $file)) }
    };
}

/// All families, in the order of their codes.
pub const FAMILIES: &[Family] = &[
    family!("Expressions of transitions", "expressions.md"),
    family!("Charts as Rust code", "chart_code.md"),
    family!("Formulas and roles", "roles.md"),
    family!("Configurations and running agents", "configurations.md"),
    family!("Matches", "matches.md"),
    family!("Structure of charts", "charts.md"),
    family!("SCXML documents", "scxml.md"),
    family!("Exports and deployment", "exports.md"),
    family!("Models, protocols, properties and scenarios", "models.md"),
    family!("Generated code and composition", "generation.md"),
    family!("Checks of models", "checks.md"),
    family!("Checks of role models", "role_checks.md"),
];

/// All explanations, in the order of their codes.
pub fn explanations() -> Vec<Explanation> {
    FAMILIES.iter().flat_map(Family::explanations).collect()
}

/// The page of the book: an index of the codes, which includes the files of this crate.
pub fn page() -> String {
    let mut page = String::from(
        "# Diagnostics\n\nEach diagnostic has a code. `monas explain E0205` prints the section of a code, and \
         `monas explain`\nlists all codes. Below the index are the same sections. An example without a command \
         is reported by\n`monas model check`, or `monas config check` if it is a configuration.\n",
    );
    // Writing to a string does not fail.
    for family in FAMILIES {
        let _ = write!(page, "\n**{}**\n\n| code | diagnostic |\n|---|---|\n", family.title);
        for Explanation { code, title, .. } in family.explanations() {
            let _ = writeln!(
                page,
                "| [{code}](#{}) | {} |",
                anchor(&format!("{code}: {title}")),
                title.replace('|', "\\|")
            );
        }
    }
    page.push('\n');
    for Family { file, .. } in FAMILIES {
        let _ = writeln!(page, "{{{{#include ../cli/monas-diagnostics/explanations/{file}}}}}");
    }
    page
}

/// The identifier that mdBook derives from a heading.
fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|&c| c.is_alphanumeric() || matches!(c, ' ' | '_' | '-'));
    kept.map(|c| if c == ' ' { '-' } else { c.to_ascii_lowercase() }).collect()
}
