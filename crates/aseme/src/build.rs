//! Charts as Rust for a build script: the way for those who commit no generated code.
//!
//! The build script says which models, and what their names mean:
//!
//! ```no_run
//! // build.rs
//! fn main() -> Result<(), aseme::build::Error> {
//!     aseme::build::generate("models/goalie.srm").write()?;
//!     Ok(())
//! }
//! ```
//!
//! and the crate takes the module in, which is called like the model's file:
//!
//! ```ignore
//! // src/lib.rs
//! include!(concat!(env!("OUT_DIR"), "/goalie.rs"));
//! ```
//!
//! A chart that reads messages or whose activities are made with it is given [`Words`] by [`Generation::words`]; those of a program of Monas are
//! `monas::generated::words`. What the compiler then finds missing, an activity or a field, it finds as in a crate that `monas generate` wrote.

use std::fmt;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use yase::{Diagnostic, Source};

use crate::generate::{self, SKELETONS, Words};

/// What is to be generated from a model; [`write`](Generation::write) does it.
#[derive(Clone, Debug)]
#[must_use = "nothing is written before `write`"]
pub struct Generation {
    model: PathBuf,
    words: Words,
    folder: Option<PathBuf>,
}

/// Begins with a model, whose path counts from the folder of the crate's Cargo.toml.
pub fn generate(model: impl Into<PathBuf>) -> Generation {
    Generation { model: model.into(), words: Words::default(), folder: None }
}

impl Generation {
    /// What the names in the chart mean; charts without messages and activities need none.
    pub fn words(mut self, words: Words) -> Generation {
        self.words = words;
        self
    }

    /// Another folder than that of generated files (`OUT_DIR`).
    pub fn into(mut self, folder: impl Into<PathBuf>) -> Generation {
        self.folder = Some(folder.into());
        self
    }

    /// Writes the module, tells cargo to come back when the model changes, and gives the file that is to be included.
    ///
    /// # Errors
    /// The model cannot be read or has errors, the chart has no counterpart in Rust, an activity is nowhere, or the files cannot be written.
    pub fn write(self) -> Result<PathBuf, Error> {
        tell_cargo(&format!("rerun-if-changed={}", self.model.display()))?;
        let folder = match &self.folder {
            Some(folder) => folder.clone(),
            None => std::env::var_os("OUT_DIR").map(PathBuf::from).ok_or_else(|| {
                Error::said(
                    "OUT_DIR is not set: this is for build scripts; others name a folder with `into`".into(),
                )
            })?,
        };
        let name = self.name()?;
        let text =
            fs::read_to_string(&self.model).map_err(|error| Error::file("read", &self.model, &error))?;
        let source = Source::new(self.model.display().to_string(), text);
        let (chart, found) = crate::statechart_of(&source);
        for warning in found.iter().filter(|found| !found.is_error()) {
            tell_cargo(&format!("warning={warning}"))?;
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
            false => Err(Error::said(format!(
                "{}: a module is called like the file, with small letters, digits and underscores",
                self.model.display()
            ))),
        }
    }
}

/// A line that cargo reads.
fn tell_cargo(line: &str) -> Result<(), Error> {
    let told = writeln!(std::io::stdout(), "cargo::{line}");
    told.map_err(|error| Error::said(format!("cannot tell cargo anything: {error}")))
}

/// An activity that would get a skeleton: what nobody may edit is no place for one.
fn missing(path: &str) -> Option<Diagnostic> {
    let module = path.strip_prefix(SKELETONS)?.trim_end_matches(".rs");
    let message = format!(
        "the chart has an activity that would be in the module `{module}`, and nobody has written it"
    );
    let hint = "write it and name it in the words, or have `monas generate` write a skeleton";
    Some(Diagnostic::error("E0923", 0..0, message).with_hint(hint))
}

/// The files in a folder of their own, and the one that takes them in as a module.
fn written(folder: &Path, name: &str, files: &generate::Files) -> Result<PathBuf, Error> {
    let own = folder.join(name);
    for (path, text) in files {
        let path = own.join(path);
        let made = path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(&path, text));
        made.map_err(|error| Error::file("write", &path, &error))?;
    }
    let file = folder.join(format!("{name}.rs"));
    let library = own.join("src/lib.rs");
    // The module has words of its own; links in them would be looked up here if there were any before it.
    let text = format!("#[path = {library:?}]\npub mod {name};\n");
    fs::write(&file, text).map_err(|error| Error::file("write", &file, &error))?;
    Ok(file)
}

/// Why nothing was generated.
pub struct Error {
    message: String,
    found: Vec<Diagnostic>,
}

impl Error {
    fn said(message: String) -> Error {
        Error { message, found: Vec::new() }
    }

    fn file(verb: &str, path: &Path, error: &std::io::Error) -> Error {
        Error::said(format!("cannot {verb} {}: {error}", path.display()))
    }

    fn found(found: Vec<Diagnostic>) -> Error {
        let lines: Vec<String> = found.iter().map(Diagnostic::to_string).collect();
        Error { message: lines.join("\n"), found }
    }

    /// What is wrong with the model, with places in its text.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.found
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// As it is displayed: what a `main` returns is shown by this.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl std::error::Error for Error {}
