//! The workspace that a generated crate becomes a member of, and the package whose program links it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use yase::Diagnostic;

/// The lines that begin and end what is kept in step in a Cargo.toml.
const BEGIN: &str = "# statecharts, kept in step by `monas generate`";
const END: &str = "# end of the statecharts";

/// The crates among the members of a workspace.
const MEMBERS: &str = "\"statecharts/*\"";

/// Where a generated crate says what it was made of.
const METADATA: &str = "[package.metadata.monas]";

/// The file of the package that links the statecharts, beside its main.rs.
const LINKS: &str = "src/statecharts.rs";

/// A workspace.
pub(crate) struct Project {
    root: PathBuf,
    manifest: String,
    /// The folder of the package whose program links the statecharts.
    team: PathBuf,
}

impl Project {
    /// The workspace around a file. Its Cargo.toml says `team = "FOLDER"` under `[workspace.metadata.monas]`, or is that of the package
    /// itself.
    ///
    /// # Errors
    /// There is none, or it does not say which package is the team's.
    pub(crate) fn around(file: &Path) -> Result<Project, Box<Diagnostic>> {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf());
        let found = file.ancestors().skip(1).find_map(|folder| {
            let manifest = fs::read_to_string(folder.join("Cargo.toml")).ok()?;
            table(&manifest, "[workspace]").is_some().then(|| (folder.to_path_buf(), manifest))
        });
        let Some((root, manifest)) = found else {
            let message = format!("{} lies in no workspace of Rust crates", file.display());
            return Err(refusal(message, "a model lies in a folder whose Cargo.toml has a `[workspace]`"));
        };
        let named = table(&manifest, "[workspace.metadata.monas]").and_then(|table| value(table, "team"));
        match named {
            Some(team) => Ok(Project { team: root.join(team), root, manifest }),
            None if table(&manifest, "[package]").is_some() => {
                Ok(Project { team: root.clone(), root, manifest })
            }
            None => {
                let message = format!(
                    "{} does not say which package links statecharts",
                    root.join("Cargo.toml").display()
                );
                Err(refusal(message, "write `team = \"FOLDER\"` under `[workspace.metadata.monas]`"))
            }
        }
    }

    /// The folder of the package whose program links the statecharts.
    #[cfg(unix)]
    pub(crate) fn team(&self) -> &Path {
        &self.team
    }

    /// The folder of the workspace.
    pub(super) fn root(&self) -> &Path {
        &self.root
    }

    /// The folder of the generated crates.
    pub(super) fn statecharts(&self) -> PathBuf {
        self.root.join("statecharts")
    }

    /// A path as it is told: from the root on.
    pub(super) fn relative(&self, path: &Path) -> String {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        path.strip_prefix(&self.root).unwrap_or(&path).display().to_string()
    }

    /// The Cargo.toml of a crate that is generated from a model and names these crates.
    ///
    /// # Errors
    /// The workspace does not say where one of them is.
    pub(super) fn manifest_of(
        &self,
        name: &str,
        model: &Path,
        crates: &BTreeSet<String>,
    ) -> Result<String, Box<Diagnostic>> {
        let shared = table(&self.manifest, "[workspace.dependencies]").unwrap_or_default();
        let mut dependencies = String::new();
        for wanted in crates {
            let package = [wanted.clone(), wanted.replace('_', "-")];
            let Some(package) = package.iter().find(|name| value(shared, name).is_some()) else {
                let message = format!("the workspace does not say where the crate `{wanted}` is");
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
             [dependencies]\n{dependencies}\n{METADATA}\nmodel = \"{}\"\n\n[lib]\ndoctest = false\ntest = false\n{lints}",
            self.relative(model)
        ))
    }

    /// The model that a generated crate was made of, if that lies there.
    pub(super) fn model_of(&self, name: &str) -> Option<PathBuf> {
        let manifest = fs::read_to_string(self.statecharts().join(name).join("Cargo.toml")).ok()?;
        let model = self.root.join(value(table(&manifest, METADATA)?, "model")?);
        model.is_file().then_some(model)
    }

    /// Links every generated crate into the team's program. Gives the files that had to be changed.
    ///
    /// # Errors
    /// A file cannot be read or written.
    pub(super) fn link(&self) -> Result<Vec<PathBuf>, String> {
        let crates = self.generated()?;
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
        let lines: Vec<String> = crates.iter().map(|name| path(name, 0)).collect();
        let text = |manifest: &str| {
            let manifest = with_members(manifest, MEMBERS);
            if is_shared { with_block(&manifest, "[workspace.dependencies]", &lines) } else { manifest }
        };
        changed.extend(edited(&self.root.join("Cargo.toml"), text)?);
        let text = |manifest: &str| with_block(manifest, "[dependencies]", &own);
        changed.extend(edited(&self.team.join("Cargo.toml"), text)?);
        changed.extend(edited(&self.team.join(LINKS), |_| links(&crates))?);
        let main = ["src/main.rs", "src/lib.rs"].map(|file| self.team.join(file));
        if let Some(main) = main.iter().find(|file| file.is_file()) {
            changed.extend(edited(main, with_module)?);
        }
        Ok(changed)
    }

    /// The names of the crates in the folder of statecharts.
    pub(super) fn generated(&self) -> Result<Vec<String>, String> {
        let folder = self.statecharts();
        let entries =
            fs::read_dir(&folder).map_err(|error| format!("cannot read {}: {error}", folder.display()))?;
        let folders = entries.flatten().filter(|entry| entry.path().join("Cargo.toml").is_file());
        let mut names: Vec<String> =
            folders.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort_unstable(); // the order of a folder is nobody's order
        Ok(names)
    }
}

/// What a crate says where the workspace has no common setting.
fn missing_setting(key: &str) -> String {
    match key {
        "version" => "version = \"0.1.0\"\n".into(),
        "edition" => "edition = \"2024\"\n".into(),
        "publish" => "publish = false\n".into(),
        _ => String::new(),
    }
}

/// Rewrites a file, if that changes it.
fn edited(path: &Path, text: impl FnOnce(&str) -> String) -> Result<Option<PathBuf>, String> {
    let there = match fs::read_to_string(path) {
        Ok(there) => there,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
        Err(error) => return Err(format!("cannot read {}: {error}", path.display())),
    };
    let text = text(&there);
    if text == there {
        return Ok(None);
    }
    fs::write(path, text).map_err(|error| format!("cannot write {}: {error}", path.display()))?;
    Ok(Some(path.to_path_buf()))
}

fn links(crates: &[String]) -> String {
    let uses: String = crates.iter().map(|name| format!("use {name} as _;\n")).collect();
    format!(
        "//! Links the generated statecharts, which register themselves. Kept in step by `monas generate`.\n\n{uses}"
    )
}

/// A manifest whose table has these lines in its block. Another table of the same manifest may have a block of its own.
fn with_block(manifest: &str, header: &str, lines: &[String]) -> String {
    let block =
        format!("{BEGIN}\n{}{END}\n", lines.iter().map(|line| format!("{line}\n")).collect::<String>());
    let header = format!("{header}\n");
    let is_header = |at: &usize| *at == 0 || manifest[..*at].ends_with('\n');
    let Some(at) = manifest.match_indices(&header).map(|(at, _)| at).find(is_header) else {
        return format!("{manifest}\n{header}{block}");
    };
    let (before, rest) = manifest.split_at(at + header.len());
    let (table, after) = rest.split_at(rest.find("\n[").map_or(rest.len(), |end| end + 1));
    if let Some((head, rest)) = table.split_once(&format!("{BEGIN}\n"))
        && let Some((_, tail)) = rest.split_once(&format!("{END}\n"))
    {
        return format!("{before}{head}{block}{tail}{after}");
    }
    format!("{before}{block}{rest}")
}

/// A workspace with the crates of a folder among its members, as these are written: `"statecharts/*"`.
pub(crate) fn with_members(manifest: &str, members: &str) -> String {
    match manifest.split_once("members = [") {
        Some((before, after)) if !manifest.contains(members) => {
            format!("{before}members = [{members}, {after}")
        }
        Some(_) => manifest.to_owned(),
        None => manifest.replacen("[workspace]\n", &format!("[workspace]\nmembers = [{members}]\n"), 1),
    }
}

/// A program that has the module of links.
fn with_module(text: &str) -> String {
    let module = "mod statecharts;";
    if text.lines().any(|line| line.trim() == module) {
        return text.to_owned();
    }
    let is_head = |line: &&str| line.starts_with("//!") || line.starts_with("#![") || line.is_empty();
    let head: String = text.split_inclusive('\n').take_while(|line| is_head(&line.trim_end())).collect();
    format!("{head}{module}\n\n{}", &text[head.len()..])
}

/// The lines of a table.
fn table<'a>(manifest: &'a str, header: &str) -> Option<&'a str> {
    let start = manifest.lines().position(|line| line.trim() == header)?;
    let from: usize = manifest.split_inclusive('\n').take(start + 1).map(str::len).sum();
    let rest = &manifest[from..];
    Some(&rest[..rest.find("\n[").map_or(rest.len(), |end| end + 1)])
}

/// The value of a key in a table, without quotes.
fn value<'a>(table: &'a str, key: &str) -> Option<&'a str> {
    table.lines().find_map(|line| {
        let rest = line.strip_prefix(key)?.trim_start();
        Some(rest.strip_prefix('=')?.trim().trim_matches('"'))
    })
}

fn refusal(message: String, hint: &str) -> Box<Diagnostic> {
    Box::new(Diagnostic::error("E0926", 0..0, message).with_hint(hint))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_made_once_and_kept_in_step() {
        let manifest = "[package]\nname = \"a\"\n\n[dependencies]\nb = \"1\"\n\n[lints]\n";
        let one = with_block(manifest, "[dependencies]", &["x = 1".into()]);
        assert!(one.contains(&format!("[dependencies]\n{BEGIN}\nx = 1\n{END}\nb = \"1\"\n")), "{one}");
        let two = with_block(&one, "[dependencies]", &["x = 1".into(), "y = 2".into()]);
        assert_eq!(two, one.replace("x = 1\n", "x = 1\ny = 2\n"));
        assert_eq!(with_block(&two, "[dependencies]", &["x = 1".into()]), one);
    }

    #[test]
    fn two_tables_of_one_manifest_have_a_block_each() {
        let manifest = "[workspace.dependencies]\na = \"1\"\n\n[package]\nname = \"team\"\n\n[dependencies]\na.workspace = true\n";
        let one = with_block(manifest, "[workspace.dependencies]", &["x = { path = \"x\" }".into()]);
        let both = with_block(&one, "[dependencies]", &["x.workspace = true".into()]);
        let expected = format!(
            "[workspace.dependencies]\n{BEGIN}\nx = {{ path = \"x\" }}\n{END}\na = \"1\"\n\n[package]\nname = \"team\"\n\n\
             [dependencies]\n{BEGIN}\nx.workspace = true\n{END}\na.workspace = true\n"
        );
        assert_eq!(both, expected);
        assert_eq!(with_block(&both, "[dependencies]", &["x.workspace = true".into()]), expected);
        assert_eq!(with_block(&both, "[workspace.dependencies]", &["x = { path = \"x\" }".into()]), expected);
    }

    #[test]
    fn the_module_of_links_follows_what_is_said_of_the_whole() {
        let text = "//! A team.\n\nuse legs as _;\n\nfn main() {}\n";
        let expected = "//! A team.\n\nmod statecharts;\n\nuse legs as _;\n\nfn main() {}\n";
        assert_eq!(with_module(text), expected);
        assert_eq!(with_module(expected), expected);
    }

    #[test]
    fn crates_become_members_once() {
        let one = with_members("[workspace]\nresolver = \"3\"\nmembers = [\"a\"]\n", MEMBERS);
        assert_eq!(one, "[workspace]\nresolver = \"3\"\nmembers = [\"statecharts/*\", \"a\"]\n");
        assert_eq!(with_members(&one, MEMBERS), one);
        assert_eq!(with_members("[workspace]\n", MEMBERS), "[workspace]\nmembers = [\"statecharts/*\"]\n");
    }

    #[test]
    fn values_stand_in_their_table() {
        let manifest = "[a]\nteam = \"x\"\n\n[b]\nteam = \"y\"\n";
        assert_eq!(table(manifest, "[b]").and_then(|table| value(table, "team")), Some("y"));
        assert_eq!(table(manifest, "[a]").and_then(|table| value(table, "teams")), None);
    }
}
