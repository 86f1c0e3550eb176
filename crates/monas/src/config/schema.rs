//! Schemas for editors, written from the grammar that the readers use.

mod json;
mod xsd;

use super::grammar::Grammar;

impl Grammar {
    /// What files of XML may hold, as an XML Schema 1.0: for files with one root and quotes around values, which is what editors read.
    pub fn xml_schema(&self) -> String {
        xsd::write(self)
    }

    /// What files of TOML may hold, as a JSON Schema 2020-12.
    pub fn json_schema(&self) -> String {
        json::write(self)
    }
}
