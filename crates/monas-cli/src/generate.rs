//! `monas generate`: a model as a Rust crate of the workspace, linked into its program.
//!
//! The crate goes to `statecharts/NAME`. What the program needs to link it, a block of its Cargo.toml and a file of `use` lines, is kept in
//! step with that folder, so that nobody edits another file. `aseme::generate` writes the code; this command knows where it goes.

mod linked;
mod project;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use aseme::convert::{self, Model};
use aseme::generate::{self, Files, SKELETONS, Words};
use aseme::ontology;
use monas::{Registry, config, generated};
use yase::Diagnostic;

use crate::arguments::{Format, GenerateArguments};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::model;

pub(crate) use linked::differences;
pub(crate) use project::{Project, with_members};

pub(crate) fn execute(arguments: &GenerateArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let chart = model::valid_chart(&arguments.model, format, console)?;
    let project =
        Project::around(&arguments.model).map_err(|found| Failure::Invalid(format, vec![*found]))?;
    let folder = folder(arguments, &project, format)?;
    let name = name(&folder, format)?;
    let mut words = generated::words(&Registry::linked()).map_err(|error| Failure::failed(format, error))?;
    words.origin = project.relative(&arguments.model);
    words.name.clone_from(&name);
    let source =
        config::read_file(&arguments.model).map_err(|unread| Failure::Invalid(format, vec![*unread]))?;
    if let (Some((Model::Chart(chart), _)), _) = convert::read(&source) {
        words.subjects = ontology::subjects(&chart);
    }
    forget_own(&mut words, &name);
    let files = generate::generate(&chart, &words).map_err(|found| Failure::Invalid(format, found))?;
    let files = laid_out(files, &project, console).map_err(|error| Failure::failed(format, error))?;
    let manifest = project
        .manifest_of(&name, &arguments.model, &crates(&files, &words))
        .map_err(|found| Failure::Invalid(format, vec![*found]))?;
    let mut writing = Writing { folder: &folder, format, changed: Vec::new() };
    writing.write("Cargo.toml", &manifest)?;
    for (path, text) in &files {
        writing.write(path, text)?;
    }
    writing.remove_leftovers(&files)?;
    let mut changed = writing.changed;
    changed.extend(project.link().map_err(|message| Failure::Failed(format, message))?);
    tell(&changed, &project, format, console)
}

/// Where the crate goes.
fn folder(arguments: &GenerateArguments, project: &Project, format: Format) -> Result<PathBuf, Failure> {
    let stem = || {
        let stem = arguments.model.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        project.statecharts().join(stem.unwrap_or_default())
    };
    let folder = arguments.to.clone().unwrap_or_else(stem);
    let folder = std::path::absolute(&folder).map_err(|error| Failure::failed(format, error))?;
    match folder.parent() == Some(project.statecharts().as_path()) {
        true => Ok(folder),
        false => {
            let message =
                format!("the crate must lie in {}: what is there is linked", project.statecharts().display());
            Err(Failure::Usage(message))
        }
    }
}

/// The crate is called like its folder.
fn name(folder: &Path, format: Format) -> Result<String, Failure> {
    let name = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let is_plain = name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
        && name.starts_with(|first: char| first.is_ascii_lowercase())
        && generate::identifier(&[&name]) == name;
    match is_plain {
        true => Ok(name),
        false => {
            let message = format!("`{name}` cannot be the name of a crate");
            let hint = "name the folder with small letters, digits and underscores: --to statecharts/NAME";
            let found = Diagnostic::error("E0925", 0..0, message).with_hint(hint);
            Err(Failure::Invalid(format, vec![found]))
        }
    }
}

/// The activities that the crate itself has are its own skeletons, filled in by now.
fn forget_own(words: &mut Words, name: &str) {
    let own = format!("{name}::");
    words.activities.retain(|_, activity| !activity.path.starts_with(&own));
}

/// The crates that the code names: those of the messages and activities that stand in it.
fn crates(files: &Files, words: &Words) -> BTreeSet<String> {
    let activities = words.activities.values().map(|activity| &activity.path);
    let paths = words.messages.values().chain(words.topics.values()).chain(activities);
    let known: BTreeSet<&str> = paths.filter_map(|path| path.split("::").next()).collect();
    let is_named = |name: &str| {
        let path = format!("{name}::");
        let begins = |text: &str, at: usize| {
            text[..at].chars().next_back().is_none_or(|c| !c.is_alphanumeric() && !matches!(c, '_' | ':'))
        };
        files.values().any(|text| text.match_indices(&path).any(|(at, _)| begins(text, at)))
    };
    let named = known.into_iter().filter(|name| is_named(name)).map(str::to_owned);
    named.chain(["monas".to_owned()]).collect()
}

/// Writes what has changed.
struct Writing<'a> {
    folder: &'a Path,
    format: Format,
    changed: Vec<PathBuf>,
}

impl Writing<'_> {
    /// A skeleton that is there belongs to whoever filled it in.
    fn write(&mut self, path: &str, text: &str) -> Result<(), Failure> {
        let is_skeleton = path.starts_with(SKELETONS);
        let path = self.folder.join(path);
        let there = fs::read_to_string(&path).ok();
        if there.as_deref() == Some(text) || (is_skeleton && path.exists()) {
            return Ok(());
        }
        let written = path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(&path, text));
        written.map_err(|error| self.failed("write", &path, &error))?;
        self.changed.push(path);
        Ok(())
    }

    /// Sources that an earlier generator wrote and this one does not; skeletons stay.
    fn remove_leftovers(&mut self, files: &Files) -> Result<(), Failure> {
        let folder = self.folder.join("src");
        let entries = fs::read_dir(&folder).map_err(|error| self.failed("read", &folder, &error))?;
        for entry in entries.flatten().map(|entry| entry.path()).filter(|path| path.is_file()) {
            let name = entry.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            if !files.contains_key(&format!("src/{name}")) {
                fs::remove_file(&entry).map_err(|error| self.failed("remove", &entry, &error))?;
                self.changed.push(entry);
            }
        }
        Ok(())
    }

    fn failed(&self, verb: &str, path: &Path, error: &std::io::Error) -> Failure {
        Failure::Failed(self.format, format!("cannot {verb} {}: {error}", path.display()))
    }
}

/// What the generator could not lay out as the project's rustfmt does is left to that, where it is installed.
fn laid_out(files: Files, project: &Project, console: &mut Console<'_>) -> std::io::Result<Files> {
    let folder = tempfile::tempdir()?;
    for (path, text) in &files {
        let path = folder.path().join(path);
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        fs::write(path, text)?;
    }
    let mut command = Command::new("rustfmt");
    command.args(["--quiet", "--edition", "2024", "--config-path"]).arg(project.root());
    if !command.arg(folder.path().join("src/lib.rs")).output().is_ok_and(|output| output.status.success()) {
        writeln!(console.err, "rustfmt is not there: long lines are as they were generated")?;
    }
    let read = |path: String| fs::read_to_string(folder.path().join(&path)).map(|text| (path, text));
    files.into_keys().map(read).collect()
}

fn tell(
    changed: &[PathBuf],
    project: &Project,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    for path in changed {
        let path = project.relative(path);
        match format {
            Format::Text => writeln!(console.out, "{path}")?,
            Format::Json => writeln!(console.out, "{}", serde_json::json!({ "written": path }))?,
        }
    }
    if changed.is_empty() && matches!(format, Format::Text) {
        writeln!(console.out, "nothing has changed")?;
    }
    Ok(Exit::Success)
}
