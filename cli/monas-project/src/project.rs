//! The workspace of generated crates, and the package whose program links them.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use aseme_codegen::generate::SKELETONS;
use yase::Diagnostic;

use crate::error::Error;
use crate::manifest::{table, value, with_block, with_members};

/// The crates among the members of a workspace.
const STATECHART_MEMBERS: &str = "\"statecharts/*\"";

/// The table in which a generated crate names its model.
const METADATA_TABLE: &str = "[package.metadata.monas]";

/// The file of the team's package that links the statecharts.
const LINK_FILE: &str = "src/statecharts.rs";

/// A Cargo workspace with the package of a team.
pub struct Project {
    root: PathBuf,
    manifest: String,
    /// The folder of the package whose program links the statecharts.
    team: PathBuf,
}

impl Project {
    /// The workspace around a file. Its Cargo.toml has `team = "FOLDER"` under
    /// `[workspace.metadata.monas]`, or is also that of the package.
    ///
    /// # Errors
    /// There is no workspace, or it does not name the team's package.
    pub fn around(file: &Path) -> Result<Project, Error> {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf());
        let found = file.ancestors().skip(1).find_map(|folder| {
            let manifest = fs::read_to_string(folder.join("Cargo.toml")).ok()?;
            table(&manifest, "[workspace]").is_some().then(|| (folder.to_path_buf(), manifest))
        });
        let Some((root, manifest)) = found else {
            let message = format!("{} is not in a Cargo workspace", file.display());
            return Err(refusal(
                message,
                "put the model below a folder whose Cargo.toml has a `[workspace]`",
            ));
        };
        let named = table(&manifest, "[workspace.metadata.monas]").and_then(|table| value(table, "team"));
        match named {
            Some(team) => Ok(Project { team: root.join(team), root, manifest }),
            None if table(&manifest, "[package]").is_some() => {
                Ok(Project { team: root.clone(), root, manifest })
            }
            None => {
                let message = format!(
                    "{} does not name the package that links statecharts",
                    root.join("Cargo.toml").display()
                );
                Err(refusal(message, "write `team = \"FOLDER\"` under `[workspace.metadata.monas]`"))
            }
        }
    }

    /// The folder of the package whose program links the statecharts.
    pub fn team(&self) -> &Path {
        &self.team
    }

    /// Whether a file is in no other package of the workspace than the team's. Files of another
    /// package belong to the program of that package.
    pub(crate) fn contains(&self, file: &Path) -> bool {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf());
        let is_package = |folder: &&Path| {
            let manifest = fs::read_to_string(folder.join("Cargo.toml"));
            manifest.is_ok_and(|manifest| table(&manifest, "[package]").is_some())
        };
        let mut folders = file.ancestors().skip(1).take_while(|folder| *folder != self.root);
        folders.find(is_package).is_none_or(|folder| folder == self.team)
    }

    /// The folder of the workspace.
    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    /// The folder of the generated crates.
    pub(crate) fn statecharts(&self) -> PathBuf {
        self.root.join("statecharts")
    }

    /// A path relative to the workspace.
    pub fn relative(&self, path: &Path) -> String {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        path.strip_prefix(&self.root).unwrap_or(&path).display().to_string()
    }

    /// The Cargo.toml of a crate that is generated from a model and uses these crates.
    ///
    /// # Errors
    /// The workspace has no dependency on one of the crates.
    pub(crate) fn manifest_of(
        &self,
        name: &str,
        model: &Path,
        crates: &BTreeSet<String>,
    ) -> Result<String, Error> {
        let shared = table(&self.manifest, "[workspace.dependencies]").unwrap_or_default();
        let mut dependencies = String::new();
        for wanted in crates {
            let package = [wanted.clone(), wanted.replace('_', "-")];
            let Some(package) = package.iter().find(|name| value(shared, name).is_some()) else {
                let message = format!("the workspace has no dependency on the crate `{wanted}`");
                return Err(refusal(message, "name it under `[workspace.dependencies]`"));
            };
            dependencies += &format!("{package}.workspace = true\n");
        }
        let package = table(&self.manifest, "[workspace.package]").unwrap_or_default();
        let settings = ["version", "edition", "rust-version", "license", "authors", "publish"];
        let line = |key: &&str| match value(package, key) {
            Some(_) => format!("{key}.workspace = true\n"),
            None => missing_setting(key),
        };
        let settings: String = settings.iter().map(line).collect();
        let lints = match self.manifest.contains("[workspace.lints") {
            true => "\n[lints]\nworkspace = true\n",
            false => "",
        };
        Ok(format!(
            "# Generated with its sources by `monas generate`.\n[package]\nname = \"{name}\"\n\
             description = \"The statechart {name}, generated from its model\"\n{settings}\n\
             [dependencies]\n{dependencies}\n{METADATA_TABLE}\nmodel = \"{}\"\n\n[lib]\ndoctest = false\ntest = false\n{lints}",
            self.relative(model)
        ))
    }

    /// Whether a generated crate uses another, itself or by way of others.
    pub(crate) fn depends_on(&self, name: &str, wanted: &str) -> bool {
        let (mut open, mut seen) = (vec![name.to_owned()], BTreeSet::new());
        while let Some(name) = open.pop() {
            if name == wanted {
                return true;
            }
            let manifest = fs::read_to_string(self.statecharts().join(&name).join("Cargo.toml"));
            if let Some(dependencies) =
                manifest.ok().as_deref().and_then(|text| table(text, "[dependencies]"))
            {
                let names = dependencies.lines().filter_map(|line| line.split(['.', ' ', '=']).next());
                open.extend(names.filter(|name| seen.insert((*name).to_owned())).map(str::to_owned));
            }
        }
        false
    }

    /// The model of a generated crate, if the file exists.
    pub(crate) fn model_of(&self, name: &str) -> Option<PathBuf> {
        let manifest = fs::read_to_string(self.statecharts().join(name).join("Cargo.toml")).ok()?;
        let model = self.root.join(value(table(&manifest, METADATA_TABLE)?, "model")?);
        model.is_file().then_some(model)
    }

    /// The name of the team's package.
    pub(crate) fn team_package(&self) -> Option<String> {
        let manifest = fs::read_to_string(self.team.join("Cargo.toml")).ok()?;
        value(table(&manifest, "[package]")?, "name").map(str::to_owned)
    }

    /// Links all generated crates into the team's program, and no others. Returns the changed
    /// files.
    ///
    /// # Errors
    /// A file cannot be read or written.
    pub fn link(&self) -> Result<Vec<PathBuf>, Error> {
        self.link_crates(&self.generated()?)
    }

    /// Links the generated crates that Cargo can build: those whose skeletons are there, and that
    /// use no other. A skeleton that was moved to a crate of activities is declared until its model
    /// is generated again, by a program that would not be built with it.
    ///
    /// # Errors
    /// A file cannot be read or written.
    pub fn link_complete(&self) -> Result<Vec<PathBuf>, Error> {
        let (incomplete, mut crates): (Vec<_>, Vec<_>) =
            self.generated()?.into_iter().partition(|name| lacks_skeleton(&self.statecharts().join(name)));
        crates.retain(|name| !incomplete.iter().any(|other| self.depends_on(name, other)));
        self.link_crates(&crates)
    }

    fn link_crates(&self, crates: &[String]) -> Result<Vec<PathBuf>, Error> {
        let is_shared = table(&self.manifest, "[workspace.dependencies]").is_some();
        let way_up = self.team.strip_prefix(&self.root).map_or(0, |path| path.components().count());
        let path = |name: &str, up: usize| {
            format!("{name} = {{ path = \"{}statecharts/{name}\" }}", "../".repeat(up))
        };
        let own: Vec<String> = crates
            .iter()
            .map(|name| if is_shared { format!("{name}.workspace = true") } else { path(name, way_up) })
            .collect();
        let mut changed = Vec::new();
        // Generated crates name each other there, whether the program links them or not.
        let lines: Vec<String> = self.generated()?.iter().map(|name| path(name, 0)).collect();
        let text = |manifest: &str| {
            let manifest = with_members(manifest, STATECHART_MEMBERS);
            if is_shared { with_block(&manifest, "[workspace.dependencies]", &lines) } else { manifest }
        };
        changed.extend(edited(&self.root.join("Cargo.toml"), text)?);
        let text = |manifest: &str| {
            let lines: Vec<String> =
                crates.iter().zip(&own).map(|(name, line)| as_there(manifest, name, line)).collect();
            with_block(manifest, "[dependencies]", &lines)
        };
        changed.extend(edited(&self.team.join("Cargo.toml"), text)?);
        changed.extend(edited(&self.team.join(LINK_FILE), |_| links(crates))?);
        let main = ["src/main.rs", "src/lib.rs"].map(|file| self.team.join(file));
        if let Some(main) = main.iter().find(|file| file.is_file()) {
            changed.extend(edited(main, with_module)?);
        }
        // The team's package may be that of the root: both edits are of one file.
        changed.dedup();
        Ok(changed)
    }

    /// The names of the crates in the folder of statecharts.
    pub(crate) fn generated(&self) -> Result<Vec<String>, Error> {
        let folder = self.statecharts();
        let entries = fs::read_dir(&folder).map_err(|error| Error::file("read", &folder, &error))?;
        let folders = entries.flatten().filter(|entry| entry.path().join("Cargo.toml").is_file());
        let mut names: Vec<String> =
            folders.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort_unstable(); // independent of the file system's order
        Ok(names)
    }
}

/// The line of a crate for a setting that the workspace does not share.
fn missing_setting(key: &str) -> String {
    match key {
        "version" => "version = \"0.1.0\"\n".into(),
        "edition" => "edition = \"2024\"\n".into(),
        "publish" => "publish = false\n".into(),
        _ => String::new(),
    }
}

/// Whether a generated crate declares a skeleton whose file is gone.
fn lacks_skeleton(folder: &Path) -> bool {
    let skeletons = folder.join(SKELETONS);
    let declared = fs::read_to_string(skeletons.with_extension("rs")).unwrap_or_default();
    let mut names = declared.lines().filter_map(|line| line.strip_prefix("mod ")?.strip_suffix(';'));
    names.any(|name| !skeletons.join(format!("{}.rs", name.trim_start_matches("r#"))).is_file())
}

/// The dependency on a crate as the manifest has it, which may be optional; `line` if it has none.
fn as_there(manifest: &str, name: &str, line: &str) -> String {
    let dependencies = table(manifest, "[dependencies]").unwrap_or_default();
    let is_it = |there: &&str| there.split(['.', ' ', '=']).next() == Some(name);
    dependencies.lines().find(is_it).unwrap_or(line).to_owned()
}

/// Rewrites a file if its text changes.
fn edited(path: &Path, text: impl FnOnce(&str) -> String) -> Result<Option<PathBuf>, Error> {
    let there = match fs::read_to_string(path) {
        Ok(there) => there,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
        Err(error) => return Err(Error::file("read", path, &error)),
    };
    let text = text(&there);
    if text == there {
        return Ok(None);
    }
    monas_files::write(path, text).map_err(|error| Error::file("write", path, &error))?;
    Ok(Some(path.to_path_buf()))
}

fn links(crates: &[String]) -> String {
    let uses: String = crates.iter().map(|name| format!("use {name} as _;\n")).collect();
    format!(
        "//! Links the generated statecharts, which register themselves. Kept in step by `monas generate`.\n\n{uses}"
    )
}

/// A program with the declaration of the module that links statecharts.
fn with_module(text: &str) -> String {
    let module = "mod statecharts;";
    if text.lines().any(|line| line.trim() == module) {
        return text.to_owned();
    }
    let is_head = |line: &&str| line.starts_with("//!") || line.starts_with("#![") || line.is_empty();
    let head: String = text.split_inclusive('\n').take_while(|line| is_head(&line.trim_end())).collect();
    format!("{head}{module}\n\n{}", &text[head.len()..])
}

fn refusal(message: String, hint: &str) -> Error {
    Error::invalid(vec![Diagnostic::error("E0926", 0..0, message).with_hint(hint)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crate_that_is_gone_is_linked_no_more() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |file: &str, text: &str| {
            let path = folder.path().join(file);
            fs::create_dir_all(path.parent().expect("it has a folder")).expect("folders");
            fs::write(path, text).expect("the folder takes files");
        };
        let manifest = "[workspace]\nmembers = [\"statecharts/*\"]\n\n[workspace.dependencies]\n\n\
                        [package]\nname = \"my-team\"\n\n[dependencies]\n";
        write("Cargo.toml", manifest);
        write("src/main.rs", "fn main() {}\n");
        for name in ["goalie", "scout"] {
            write(&format!("statecharts/{name}/Cargo.toml"), "[package]\n");
        }
        let project = || Project::around(&folder.path().join("Cargo.toml")).expect("a project");
        assert_eq!(project().team_package().as_deref(), Some("my-team"));
        let changed = project().link().expect("it is linked");
        assert_eq!(changed.iter().filter(|path| path.ends_with("Cargo.toml")).count(), 1, "{changed:?}");
        let read = |file: &str| fs::read_to_string(folder.path().join(file)).expect("a file");
        assert_eq!(read("Cargo.toml").matches("scout").count(), 3);
        fs::remove_dir_all(folder.path().join("statecharts/scout")).expect("it is there");
        project().link().expect("it is linked");
        assert!(!read("Cargo.toml").contains("scout") && !read(LINK_FILE).contains("scout"));
        assert!(read("Cargo.toml").contains("goalie") && read(LINK_FILE).contains("goalie"));
        assert!(project().link().expect("it is linked").is_empty());
    }

    #[test]
    fn crates_without_their_skeletons_are_linked_when_they_are_complete() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |file: &str, text: &str| {
            let path = folder.path().join(file);
            fs::create_dir_all(path.parent().expect("it has a folder")).expect("folders");
            fs::write(path, text).expect("the folder takes files");
        };
        write("Cargo.toml", "[workspace]\n\n[workspace.dependencies]\n\n[package]\n\n[dependencies]\n");
        write("src/main.rs", "fn main() {}\n");
        for (name, dependency) in [("goalie", ""), ("scout", ""), ("shooter", "scout.workspace = true\n")] {
            let manifest = format!("[package]\n\n[dependencies]\n{dependency}");
            write(&format!("statecharts/{name}/Cargo.toml"), &manifest);
        }
        write("statecharts/scout/src/activities.rs", "//! Activities.\n\nmod r#match;\nmod scan;\n");
        write("statecharts/scout/src/activities/match.rs", "");
        let linked = || {
            let project = Project::around(&folder.path().join("Cargo.toml")).expect("a project");
            project.link_complete().expect("it is linked");
            let read = |file: &str| fs::read_to_string(folder.path().join(file)).expect("a file");
            assert!(read("Cargo.toml").contains("scout = { path = "), "the shooter names it");
            let links = read(LINK_FILE);
            ["goalie", "scout", "shooter"].map(|name| links.contains(&format!("use {name} as _;")))
        };
        assert_eq!(linked(), [true, false, false]);
        write("statecharts/scout/src/activities/scan.rs", "");
        assert_eq!(linked(), [true, true, true]);
    }

    #[test]
    fn the_module_of_links_follows_the_project_settings() {
        let text = "//! A team.\n\nuse legs as _;\n\nfn main() {}\n";
        let expected = "//! A team.\n\nmod statecharts;\n\nuse legs as _;\n\nfn main() {}\n";
        assert_eq!(with_module(text), expected);
        assert_eq!(with_module(expected), expected);
    }
}
