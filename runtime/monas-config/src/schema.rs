//! Schemas for editors, generated from the grammar of the readers.

mod json;
mod xsd;

use super::grammar::Grammar;

impl Grammar {
    /// An XML Schema 1.0: for files with one root and quoted values, as editors require.
    pub fn xml_schema(&self) -> String {
        xsd::write(self)
    }

    /// A JSON Schema 2020-12 of TOML files.
    pub fn json_schema(&self) -> String {
        json::write(self)
    }
}
