//! Generation of Rust in a build script, for projects that do not commit generated code.
//!
//! The build script names the models and what their names refer to:
//!
//! ```no_run
//! // build.rs
//! fn main() -> Result<(), aseme_codegen::build::Error> {
//!     aseme_codegen::build::generate("models/goalie.srm").write()?;
//!     Ok(())
//! }
//! ```
//!
//! and the crate includes the module, which is named after the model's file:
//!
//! ```ignore
//! // src/lib.rs
//! include!(concat!(env!("OUT_DIR"), "/goalie.rs"));
//! ```
//!
//! A chart that reads messages, or whose activities are created with the module, needs
//! [`RustBindings`], set by [`Generation::bindings`]; those of a Monas program are
//! `monas::generated::words`. Missing activities and fields are compile errors, as in a crate
//! written by `monas generate`.

use std::fmt;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use yase::{Diagnostic, Source};

use crate::generate::{self, RustBindings, SKELETONS};

/// A model from which Rust is generated; [`write`](Generation::write) generates it.
#[derive(Clone, Debug)]
#[must_use = "nothing is written before `write`"]
pub struct Generation {
    model: PathBuf,
    words: RustBindings,
    folder: Option<PathBuf>,
}

/// Starts a generation. The model's path is relative to the folder of the crate's Cargo.toml.
pub fn generate(model: impl Into<PathBuf>) -> Generation {
    Generation { model: model.into(), words: RustBindings::default(), folder: None }
}

impl Generation {
    /// Sets the bindings of names; charts without messages and activities need none.
    pub fn bindings(mut self, words: RustBindings) -> Generation {
        self.words = words;
        self
    }

    /// Sets the output folder; the default is `OUT_DIR`.
    pub fn into(mut self, folder: impl Into<PathBuf>) -> Generation {
        self.folder = Some(folder.into());
        self
    }

    /// Writes the module, declares the model as an input to cargo, and returns the file to include.
    ///
    /// # Errors
    /// The model cannot be read or has errors, the chart cannot be represented in Rust, an activity
    /// has no implementation, or the files cannot be written.
    pub fn write(self) -> Result<PathBuf, Error> {
        print_cargo_directive(&format!("rerun-if-changed={}", self.model.display()))?;
        let folder = match &self.folder {
            Some(folder) => folder.clone(),
            None => std::env::var_os("OUT_DIR").map(PathBuf::from).ok_or_else(|| {
                Error::from_message(
                    "OUT_DIR is not set: call this in a build script, or set a folder with `into`".into(),
                )
            })?,
        };
        let name = self.name()?;
        let text =
            fs::read_to_string(&self.model).map_err(|error| Error::file("read", &self.model, &error))?;
        let source = Source::new(self.model.display().to_string(), text);
        let (chart, found) = aseme_models::statechart_of(&source);
        for warning in found.iter().filter(|found| !found.is_error()) {
            print_cargo_directive(&format!("warning={warning}"))?;
        }
        let errors: Vec<Diagnostic> = found.into_iter().filter(Diagnostic::is_error).collect();
        if !errors.is_empty() {
            return Err(Error::found(errors));
        }
        let mut words = self.words;
        words.origin = self.model.display().to_string();
        words.name.clone_from(&name);
        let files = generate::generate(&chart, &words).map_err(|found| {
            Error::found(found.into_iter().map(|found| found.in_source(&source)).collect())
        })?;
        let missing: Vec<Diagnostic> = files.keys().filter_map(|path| missing(path)).collect();
        if !missing.is_empty() {
            return Err(Error::found(missing));
        }
        written(&folder, &name, &files)
    }

    /// The name of the module.
    fn name(&self) -> Result<String, Error> {
        let name = self.model.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let is_plain = name.starts_with(|first: char| first.is_ascii_lowercase())
            && name
                .chars()
                .all(|letter| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '_')
            && generate::identifier(&[&name]) == name;
        match is_plain {
            true => Ok(name),
            false => Err(Error::from_message(format!(
                "{}: the file's name becomes the module's: use lower-case letters, digits and underscores",
                self.model.display()
            ))),
        }
    }
}

/// Prints a directive to cargo.
fn print_cargo_directive(line: &str) -> Result<(), Error> {
    let written = writeln!(std::io::stdout(), "cargo::{line}");
    written.map_err(|error| Error::from_message(format!("cannot write to cargo: {error}")))
}

/// An activity without implementation: generated code in a build folder has no skeletons.
fn missing(path: &str) -> Option<Diagnostic> {
    let module = path.strip_prefix(SKELETONS)?.trim_end_matches(".rs");
    let message = format!("the activity of the module `{module}` has no implementation");
    let hint = "write it and add it to the bindings, or let `monas generate` write a skeleton";
    Some(Diagnostic::error("E0923", 0..0, message).with_hint(hint))
}

/// Writes the files into a folder, and the file that includes them as a module.
fn written(folder: &Path, name: &str, files: &generate::CrateFiles) -> Result<PathBuf, Error> {
    let own = folder.join(name);
    for (path, text) in files {
        let path = own.join(path);
        let made = path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(&path, text));
        made.map_err(|error| Error::file("write", &path, &error))?;
    }
    let file = folder.join(format!("{name}.rs"));
    let library = own.join("src/lib.rs");
    // The documentation of the module is inside it, since links in outer documentation would be
    // resolved here.
    let text = format!("#[path = {library:?}]\npub mod {name};\n");
    fs::write(&file, text).map_err(|error| Error::file("write", &file, &error))?;
    Ok(file)
}

/// The error of a generation.
pub struct Error {
    message: String,
    found: Vec<Diagnostic>,
}

impl Error {
    fn from_message(message: String) -> Error {
        Error { message, found: Vec::new() }
    }

    fn file(verb: &str, path: &Path, error: &std::io::Error) -> Error {
        Error::from_message(format!("cannot {verb} {}: {error}", path.display()))
    }

    fn found(found: Vec<Diagnostic>) -> Error {
        let lines: Vec<String> = found.iter().map(Diagnostic::to_string).collect();
        Error { message: lines.join("\n"), found }
    }

    /// The errors of the model, with positions in its text.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.found
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// Shown like `Display`, because a `main` that returns the error prints it by `Debug`.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl std::error::Error for Error {}
