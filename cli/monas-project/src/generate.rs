//! Generates the statechart of a model as a crate of the workspace, linked into the team's program.
//!
//! The crate goes to `statecharts/NAME`. The program links it by a block of its Cargo.toml and a
//! file of `use` lines, both derived from the content of that folder. `aseme_codegen::generate`
//! writes the code; this module places it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use aseme_codegen::generate::{self, CrateFiles, RustActivity, RustBindings, SKELETONS};
use aseme_models::convert::{self, Model};
use aseme_models::ontology;
use monas::{Registry, config, generated};
use yase::{Diagnostic, Statechart};

use crate::error::{Error, ErrorKind};
use crate::new_project::RESERVED_NAMES;
use crate::packages::package_folder;
use crate::project::Project;

/// A generated crate.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct GeneratedCrate {
    /// The files that were written, changed or removed.
    pub changed: Vec<PathBuf>,
    /// Whether rustfmt has formatted the sources.
    pub is_formatted: bool,
}

/// Writes the statechart of a model as a crate of the project, and links it into the project's
/// program. `folder` is that of the crate; without it, the crate is named after the model.
///
/// # Errors
/// The folder is not in `statecharts`, its name cannot be that of a crate, the chart cannot be
/// generated, or a file cannot be read or written.
pub fn generate_crate(
    model: &Path,
    chart: &Statechart,
    folder: Option<&Path>,
    project: &Project,
) -> Result<GeneratedCrate, Error> {
    let folder = crate_folder(model, folder, project)?;
    let name = crate_name(&folder, project)?;
    let mut words = generated::words(&Registry::linked())
        .map_err(|error| Error::new(ErrorKind::Program, error.to_string()))?;
    words.origin = project.relative(model);
    words.name.clone_from(&name);
    let source = config::read_file(model).map_err(|unread| Error::invalid(vec![*unread]))?;
    if let (Some((Model::Chart(chart), _)), _) = convert::read(&source) {
        words.subjects = ontology::subjects(&chart);
    }
    remove_own_entries(&mut words, &name);
    add_skeletons(&mut words, &folder, project)?;
    let files = generate::generate(chart, &words).map_err(Error::invalid)?;
    let (files, is_formatted) =
        formatted(files, project).map_err(|error| Error::new(ErrorKind::File, error.to_string()))?;
    let crates = crates(&files, &words);
    if let Some(other) = crates.iter().find(|other| project.depends_on(other, &name)) {
        return Err(circle(&name, other));
    }
    let manifest = project.manifest_of(&name, model, &crates)?;
    let mut writer = FileWriter { folder: &folder, changed: Vec::new() };
    writer.write("Cargo.toml", &manifest)?;
    for (path, text) in &files {
        writer.write(path, text)?;
    }
    writer.remove_leftovers(&files)?;
    let mut changed = writer.changed;
    changed.extend(project.link()?);
    Ok(GeneratedCrate { changed, is_formatted })
}

/// The folder of the crate.
fn crate_folder(model: &Path, folder: Option<&Path>, project: &Project) -> Result<PathBuf, Error> {
    let stem = || {
        let stem = model.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        project.statecharts().join(stem.unwrap_or_default())
    };
    let folder = folder.map_or_else(stem, Path::to_path_buf);
    let folder =
        std::path::absolute(&folder).map_err(|error| Error::new(ErrorKind::File, error.to_string()))?;
    match folder.parent() == Some(project.statecharts().as_path()) {
        true => Ok(folder),
        false => {
            let message =
                format!("the crate must be in {}, whose crates are linked", project.statecharts().display());
            Err(Error::new(ErrorKind::Argument, message))
        }
    }
}

/// The name of the crate is that of its folder. A second crate of a name that the project uses
/// would keep Cargo from building it.
fn crate_name(folder: &Path, project: &Project) -> Result<String, Error> {
    let name = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let is_plain = name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
        && name.starts_with(|first: char| first.is_ascii_lowercase())
        && generate::identifier(&[&name]) == name;
    let refused = |message, hint: &str| {
        let found = Diagnostic::error("E0925", 0..0, message).with_hint(hint);
        Err(Error::invalid(vec![found]))
    };
    if !is_plain {
        let hint = "name the folder with lower-case letters, digits and underscores: --to statecharts/NAME";
        return refused(format!("`{name}` cannot be the name of a crate"), hint);
    }
    let is_same = |other: &str| other.replace('-', "_") == name;
    if RESERVED_NAMES.into_iter().any(is_same)
        || project.team_package().is_some_and(|package| is_same(&package))
        || package_folder(project.root(), &name).is_some_and(|other| other != folder)
    {
        let message = format!("`{name}` is the name of another crate");
        return refused(message, &format!("name the folder otherwise: --to statecharts/{name}_chart"));
    }
    Ok(name)
}

/// Removes activities of the crate itself: those are its skeletons.
fn remove_own_entries(words: &mut RustBindings, name: &str) {
    let own = format!("{name}::");
    words.activities.retain(|_, activity| !activity.path.starts_with(&own));
}

/// Adds the skeletons of the project's other generated crates that this program does not have yet:
/// roles that share an activity have one skeleton of it.
fn add_skeletons(words: &mut RustBindings, folder: &Path, project: &Project) -> Result<(), Error> {
    let own = registered_in(&folder.join(SKELETONS))?;
    for name in project.generated()? {
        let other = project.statecharts().join(&name);
        if other == folder {
            continue;
        }
        for (activity, rust, is_function) in registered_in(&other.join(SKELETONS))? {
            if !own.iter().any(|(known, ..)| *known == activity) {
                let path = format!("{name}::activities::{rust}");
                words.activities.entry(activity).or_insert(RustActivity { path, is_function });
            }
        }
    }
    Ok(())
}

/// The activities that the files of a folder register: the name, that in Rust, and whether it is a
/// function.
fn registered_in(folder: &Path) -> Result<Vec<(String, String, bool)>, Error> {
    let Ok(entries) = fs::read_dir(folder) else { return Ok(Vec::new()) };
    let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    files.sort_unstable(); // independent of the file system's order
    let mut found = Vec::new();
    for file in files.iter().filter(|file| file.extension().is_some_and(|ending| ending == "rs")) {
        let text = fs::read_to_string(file).map_err(|error| Error::file("read", file, &error))?;
        let registered = text.lines().filter_map(|line| {
            let declaration = line.trim().strip_prefix("monas::activity!(")?.strip_suffix(");")?;
            let (rust, name) = declaration.split_once(" as ").unwrap_or((declaration, declaration));
            let function = rust.strip_prefix("fn ");
            let name = name.trim().trim_matches('"').trim_start_matches("fn ").to_owned();
            Some((name, function.unwrap_or(rust).trim().to_owned(), function.is_some()))
        });
        found.extend(registered);
    }
    Ok(found)
}

/// Two crates that would each use an activity of the other.
fn circle(name: &str, other: &str) -> Error {
    let message = format!("`{name}` uses an activity of `{other}`, which uses one of `{name}`");
    let hint = "move the file of the activity that both use to a crate of activities";
    Error::invalid(vec![Diagnostic::error("E0924", 0..0, message).with_hint(hint)])
}

/// The crates of messages and activities that the code refers to.
fn crates(files: &CrateFiles, words: &RustBindings) -> BTreeSet<String> {
    let activities = words.activities.values().map(|activity| &activity.path);
    let paths = words.messages.values().chain(words.topics.values()).chain(activities);
    let known: BTreeSet<&str> = paths.filter_map(|path| path.split("::").next()).collect();
    let is_named = |name: &str| {
        let path = format!("{name}::");
        let begins = |text: &str, at: usize| {
            // the paths of generated code begin with `::`, those of skeletons with the crate
            let before = text[..at].strip_suffix("::").unwrap_or(&text[..at]);
            before.chars().next_back().is_none_or(|c| !c.is_alphanumeric() && !matches!(c, '_' | ':' | '>'))
        };
        files.values().any(|text| text.match_indices(&path).any(|(at, _)| begins(text, at)))
    };
    let named = known.into_iter().filter(|name| is_named(name)).map(str::to_owned);
    named.chain(["monas".to_owned()]).collect()
}

/// Writes files whose content has changed.
struct FileWriter<'a> {
    folder: &'a Path,
    changed: Vec<PathBuf>,
}

impl FileWriter<'_> {
    /// Writes a file; existing skeletons are left alone, since they are edited by hand.
    fn write(&mut self, path: &str, text: &str) -> Result<(), Error> {
        let is_skeleton = path.starts_with(SKELETONS);
        let path = self.folder.join(path);
        let there = fs::read_to_string(&path).ok();
        if there.as_deref() == Some(text) || (is_skeleton && path.exists()) {
            return Ok(());
        }
        let written =
            path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| monas_files::write(&path, text));
        written.map_err(|error| Error::file("write", &path, &error))?;
        self.changed.push(path);
        Ok(())
    }

    /// Removes sources of earlier versions of the generator; skeletons stay.
    fn remove_leftovers(&mut self, files: &CrateFiles) -> Result<(), Error> {
        let folder = self.folder.join("src");
        let entries = fs::read_dir(&folder).map_err(|error| Error::file("read", &folder, &error))?;
        for entry in entries.flatten().map(|entry| entry.path()).filter(|path| path.is_file()) {
            let name = entry.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            if !files.contains_key(&format!("src/{name}")) {
                fs::remove_file(&entry).map_err(|error| Error::file("remove", &entry, &error))?;
                self.changed.push(entry);
            }
        }
        Ok(())
    }
}

/// Formats the sources with the project's rustfmt, if installed.
fn formatted(files: CrateFiles, project: &Project) -> std::io::Result<(CrateFiles, bool)> {
    let folder = tempfile::tempdir()?;
    for (path, text) in &files {
        let path = folder.path().join(path);
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        fs::write(path, text)?;
    }
    let mut command = Command::new("rustfmt");
    command.args(["--quiet", "--edition", "2024", "--config-path"]).arg(project.root());
    let output = command.arg(folder.path().join("src/lib.rs")).output();
    let is_formatted = output.is_ok_and(|output| output.status.success());
    let read = |path: String| fs::read_to_string(folder.path().join(&path)).map(|text| (path, text));
    Ok((files.into_keys().map(read).collect::<Result<_, _>>()?, is_formatted))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_does_not_have_the_name_of_another_crate() {
        let folder = tempfile::tempdir().expect("a folder");
        let manifest = folder.path().join("Cargo.toml");
        fs::write(&manifest, "[workspace]\n\n[package]\nname = \"my-team\"\n").expect("a file");
        let project = Project::around(&manifest).expect("a project");
        let name = |name: &str| crate_name(&project.statecharts().join(name), &project);
        assert_eq!(name("goalie").expect("it is free"), "goalie");
        let module = folder.path().join("modules/look");
        fs::create_dir_all(&module).expect("folders");
        fs::write(module.join("Cargo.toml"), "[package]\nname = \"look\"\n").expect("a file");
        for taken in ["activities", "core", "look", "monas_cli", "my_team"] {
            let refused = name(taken).expect_err("it is taken").to_string();
            assert!(refused.contains(&format!("`{taken}` is the name of another crate")), "{refused}");
        }
    }
}
