//! A file of names and values, independent of the structure of its tree.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

use yase::{Diagnostic, Source};

use super::element::{Attribute, Element};
use super::lenient_xml;
use super::paths;
use super::xml_editor::{ElementContent, XmlEditor};

/// A file of names and values in XML: a simple store for numbers, texts and tables of them.
///
/// Every element counts as one of the root, at any depth, as in the thesis (Listing 4.8). Elements
/// have a value of any type that converts from and to text, or attributes of one such type.
/// Everything else stays as it is, byte by byte: comments, order, and other elements.
///
/// ```
/// use std::collections::BTreeMap;
/// use monas_config::XmlConfig;
///
/// let mut config = XmlConfig::from_text("poses.xml", "<?xml version=\"1.0\" ?>\n<!-- kept -->\n<speed>0.3</speed>\n");
/// assert_eq!(config.element::<f64>("speed")?, Some(0.3));
/// config.set_element("speed", 0.25, false)?;
/// for yaw in [0.876, 0.227] {
///     config.set_attributes("pose", &BTreeMap::from([("HeadYaw".to_owned(), yaw)]), true)?;
/// }
/// assert_eq!(config.all_attributes::<f64>("pose")?[1]["HeadYaw"], 0.227);
/// assert_eq!(
///     config.text(),
///     "<?xml version=\"1.0\" ?>\n<!-- kept -->\n<speed>0.25</speed>\n<pose HeadYaw=\"0.876\" />\n<pose HeadYaw=\"0.227\" />\n"
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct XmlConfig {
    path: PathBuf,
    document: XmlEditor,
    is_loaded: bool,
}

/// A value that cannot be read or written; its text states the location and reason.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{0}")]
pub struct ValueError(Box<Diagnostic>);

impl ValueError {
    pub(crate) fn new(diagnostic: Diagnostic) -> ValueError {
        ValueError(Box::new(diagnostic))
    }

    /// The diagnostic, with its location.
    pub fn diagnostic(&self) -> &Diagnostic {
        &self.0
    }
}

impl XmlConfig {
    /// Reads a file. A file that does not exist is created by [`save`](XmlConfig::save);
    /// [`is_loaded`](XmlConfig::is_loaded) returns whether it existed.
    pub fn open(path: impl Into<PathBuf>) -> XmlConfig {
        let path = path.into();
        match paths::read(&path) {
            Ok(source) => XmlConfig::of(path, source, true),
            Err(_) => {
                let source = Source::new(path.display().to_string(), "");
                XmlConfig::of(path, source, false)
            }
        }
    }

    /// As [`open`](XmlConfig::open), from a text in memory.
    pub fn from_text(path: impl Into<PathBuf>, text: impl Into<String>) -> XmlConfig {
        let path = path.into();
        let source = Source::new(path.display().to_string(), text);
        XmlConfig::of(path, source, true)
    }

    fn of(path: PathBuf, source: Arc<Source>, is_loaded: bool) -> XmlConfig {
        XmlConfig { path, document: XmlEditor::new(source), is_loaded }
    }

    /// Whether the file existed and has no errors.
    pub fn is_loaded(&self) -> bool {
        self.is_loaded && !self.diagnostics().iter().any(Diagnostic::is_error)
    }

    /// The diagnostics of the text.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        self.document.diagnostics()
    }

    /// The text as it would be saved.
    pub fn text(&self) -> &str {
        &self.document.source().text
    }

    /// The file's path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Saves the file atomically, so that readers never see a partial file: see
    /// [`monas_files::AtomicFile`].
    ///
    /// # Errors
    /// The file cannot be written, or it exists and could not be read.
    pub fn save(&self) -> io::Result<()> {
        if !self.is_loaded && self.path.exists() {
            return Err(io::Error::other(format!(
                "{} could not be read and is not changed",
                self.path.display()
            )));
        }
        monas_files::write(&self.path, self.text())
    }

    /// The value of the first element of that name; none if there is no such element.
    ///
    /// # Errors
    /// Its text is not a valid value.
    pub fn element<T: FromStr>(&self, name: &str) -> Result<Option<T>, ValueError> {
        self.named(name).next().map(value_of).transpose()
    }

    /// The values of all elements of that name, in the order of the file.
    ///
    /// # Errors
    /// A text is not a valid value.
    pub fn elements<T: FromStr>(&self, name: &str) -> Result<Vec<T>, ValueError> {
        self.named(name).map(value_of).collect()
    }

    /// The attributes of the first element of that name; none if there is no such element.
    ///
    /// # Errors
    /// An attribute is not a valid value.
    pub fn attributes<T: FromStr>(&self, name: &str) -> Result<Option<BTreeMap<String, T>>, ValueError> {
        self.named(name).next().map(attributes_of).transpose()
    }

    /// The attributes of all elements of that name, in the order of the file.
    ///
    /// # Errors
    /// An attribute is not a valid value.
    pub fn all_attributes<T: FromStr>(&self, name: &str) -> Result<Vec<BTreeMap<String, T>>, ValueError> {
        self.named(name).map(attributes_of).collect()
    }

    /// Sets the value of the first element of that name; surrounding whitespace is ignored. If
    /// there is none, or with `iterative`, an element is added.
    ///
    /// # Errors
    /// The text has errors, or `name` is not a valid name.
    pub fn set_element(
        &mut self,
        name: &str,
        value: impl Display,
        iterative: bool,
    ) -> Result<(), ValueError> {
        let value = value.to_string();
        self.writable(std::iter::once(name))?;
        check_encodable(&value)?;
        self.set(name, &ElementContent::Text(value.trim()), iterative)
    }

    /// Sets attributes of the first element of that name; its other attributes stay. If there is
    /// none, or with `iterative`, an element is added.
    ///
    /// # Errors
    /// The text has errors, or `name` or a key is not a valid name.
    pub fn set_attributes<T: Display>(
        &mut self,
        name: &str,
        values: &BTreeMap<String, T>,
        iterative: bool,
    ) -> Result<(), ValueError> {
        self.writable(std::iter::once(name).chain(values.keys().map(String::as_str)))?;
        let values: Vec<(String, String)> =
            values.iter().map(|(key, value)| (key.clone(), value.to_string())).collect();
        values.iter().try_for_each(|(_, value)| check_encodable(value))?;
        self.set(name, &ElementContent::Attributes(&values), iterative)
    }

    fn set(&mut self, name: &str, content: &ElementContent<'_>, iterative: bool) -> Result<(), ValueError> {
        let found = self.document.all().iter().position(|element| element.name() == name);
        match found.filter(|_| !iterative) {
            Some(index) => self.document.change(index, content),
            None => self.document.add(name, content),
        }
        Ok(())
    }

    fn named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Element> {
        self.document.all().into_iter().filter(move |element| element.name() == name)
    }

    /// A text is changed only if it has no errors, and only by values that are read back unchanged.
    fn writable<'a>(&self, mut names: impl Iterator<Item = &'a str>) -> Result<(), ValueError> {
        if let Some(wrong) = self.diagnostics().iter().find(|diagnostic| diagnostic.is_error()) {
            return Err(ValueError::new(wrong.clone()));
        }
        match names.find(|name| !lenient_xml::is_name(name)) {
            Some(name) => {
                let message = format!("`{name}` cannot be the name of an element or attribute");
                let hint =
                    "a name starts with a letter or `_`, followed by letters, digits, `_`, `-` and `.`";
                Err(ValueError::new(Diagnostic::error("E0309", 0..0, message).with_hint(hint)))
            }
            None => Ok(()),
        }
    }
}

/// Whether XML can represent a text.
fn check_encodable(text: &str) -> Result<(), ValueError> {
    let is_unsayable = |c: &char| c.is_ascii_control() && !matches!(c, '\t' | '\n' | '\r');
    match text.chars().find(|c| is_unsayable(c) || matches!(c, '\u{fffe}' | '\u{ffff}')) {
        Some(character) => {
            let message = format!("XML cannot represent the character U+{:04X}", character as u32);
            Err(ValueError::new(Diagnostic::error("E0309", 0..0, message)))
        }
        None => Ok(()),
    }
}

/// The text of an element as a value.
pub(crate) fn value_of<T: FromStr>(element: &Element) -> Result<T, ValueError> {
    element.text().parse().map_err(|_| {
        let (name, text) = (element.name(), element.text());
        let message = format!("`<{name}>` is `{text}`, which is not of type {}", type_name::<T>());
        ValueError::new(element.error("E0306", element.text_span(), message))
    })
}

fn attributes_of<T: FromStr>(element: &Element) -> Result<BTreeMap<String, T>, ValueError> {
    element.attributes().iter().map(|given| Ok((given.name.clone(), attribute_value(given)?))).collect()
}

/// An attribute as a value.
pub(crate) fn attribute_value<T: FromStr>(given: &Attribute) -> Result<T, ValueError> {
    given.value.trim().parse().map_err(|_| {
        let message =
            format!("`{}` is `{}`, which is not of type {}", given.name, given.value, type_name::<T>());
        ValueError::new(given.error("E0306", message))
    })
}

/// The last segment of a type's name.
pub(crate) fn type_name<T>() -> &'static str {
    let name = std::any::type_name::<T>();
    name.rsplit("::").next().unwrap_or(name)
}
