//! The input of the checks: the crates of the workspace, from cargo, and its text files.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// Folders without sources of the project.
const SKIPPED: [&str; 4] = ["target", ".git", "node_modules", "corpus"];

/// Extensions of text files.
const TEXT: [&str; 13] =
    ["rs", "toml", "md", "xml", "srm", "proto", "txt", "json", "svg", "snap", "sh", "yml", "run"];

/// The crates and the text files under one root.
pub(crate) struct Workspace {
    /// The folder to which all paths are relative.
    pub(crate) root: PathBuf,
    /// The members, sorted by name.
    pub(crate) crates: Vec<Crate>,
    /// The text files, sorted by path.
    pub(crate) files: Vec<TextFile>,
}

/// A member of the workspace.
pub(crate) struct Crate {
    /// Its name, with dashes.
    pub(crate) name: String,
    /// Its folder, relative to the root.
    pub(crate) folder: PathBuf,
    /// The root file of its library, if any, relative to the workspace.
    pub(crate) library: Option<PathBuf>,
    /// Its dependencies.
    pub(crate) dependencies: Vec<Dependency>,
}

/// One entry of a crate's dependency tables.
pub(crate) struct Dependency {
    /// The name of the package.
    pub(crate) name: String,
    /// Whether only tests, examples and benches need it.
    pub(crate) is_dev: bool,
}

/// A file and its text.
pub(crate) struct TextFile {
    /// Relative to the root.
    pub(crate) path: PathBuf,
    /// The content.
    pub(crate) text: String,
}

impl TextFile {
    /// Whether it is Rust.
    pub(crate) fn is_rust(&self) -> bool {
        self.path.extension().is_some_and(|extension| extension == "rs")
    }

    /// Whether it contains only tests.
    fn is_test(&self) -> bool {
        self.path.iter().any(|part| part == "tests" || part == "tests.rs")
    }
}

impl Workspace {
    /// Asks cargo for the crates and reads the files.
    pub(crate) fn read(root: &Path) -> Result<Workspace, Box<dyn Error>> {
        let mut files = Vec::new();
        read_folder(root, root, &mut files)?;
        files.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(Workspace { root: root.to_path_buf(), crates: crates(root)?, files })
    }

    /// The file at a path relative to the root.
    pub(crate) fn file(&self, path: &Path) -> Option<&TextFile> {
        self.files.iter().find(|file| file.path == path)
    }

    /// The crate that a file belongs to.
    pub(crate) fn crate_of(&self, file: &TextFile) -> Option<&Crate> {
        let owners = self.crates.iter().filter(|member| file.path.starts_with(&member.folder));
        owners.max_by_key(|member| member.folder.components().count())
    }

    /// The Rust files of a crate's `src` that are not tests.
    pub(crate) fn sources<'a>(&'a self, of: &Crate) -> impl Iterator<Item = &'a TextFile> {
        let folder = of.folder.join("src");
        let is_source =
            move |file: &&TextFile| file.is_rust() && file.path.starts_with(&folder) && !file.is_test();
        self.files.iter().filter(is_source)
    }
}

#[cfg(test)]
impl Workspace {
    /// The files of an example. A folder with a `src` is a crate that is named after it.
    pub(crate) fn example(files: &[(&str, &str)]) -> Workspace {
        let folders = files.iter().filter_map(|(path, _)| path.split_once("/src/").map(|(folder, _)| folder));
        let folders: std::collections::BTreeSet<&str> = folders.collect();
        let member = |folder: &str| Crate {
            name: folder.into(),
            folder: folder.into(),
            library: None,
            dependencies: Vec::new(),
        };
        Workspace {
            root: PathBuf::new(),
            crates: folders.into_iter().map(member).collect(),
            files: files
                .iter()
                .map(|(path, text)| TextFile { path: path.into(), text: (*text).into() })
                .collect(),
        }
    }
}

fn read_folder(root: &Path, folder: &Path, files: &mut Vec<TextFile>) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let path = entry.path();
        let name = entry.file_name();
        if entry.file_type()?.is_dir() {
            if !SKIPPED.iter().any(|skipped| name == *skipped) {
                read_folder(root, &path, files)?;
            }
        } else if is_text(&path) {
            let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
            files.push(TextFile { path: path.strip_prefix(root)?.to_path_buf(), text });
        }
    }
    Ok(())
}

fn is_text(path: &Path) -> bool {
    match path.extension() {
        Some(extension) => TEXT.iter().any(|text| extension == *text),
        None => path.file_name().is_some_and(|name| name == "run" || name == ".gitignore"),
    }
}

fn crates(root: &Path) -> Result<Vec<Crate>, Box<dyn Error>> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["metadata", "--no-deps", "--format-version", "1"])
        .current_dir(root)
        .output()?;
    if !output.status.success() {
        return Err(format!("cargo metadata: {}", String::from_utf8_lossy(&output.stderr)).into());
    }
    let metadata: Value = serde_json::from_slice(&output.stdout)?;
    let packages = metadata["packages"].as_array().ok_or("cargo metadata lists no packages")?;
    let mut crates =
        packages.iter().map(|package| read_crate(root, package)).collect::<Result<Vec<_>, _>>()?;
    crates.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(crates)
}

fn read_crate(root: &Path, package: &Value) -> Result<Crate, Box<dyn Error>> {
    let manifest = relative(root, &package["manifest_path"])?;
    let targets = package["targets"].as_array().map(Vec::as_slice).unwrap_or_default();
    let is_library = |target: &&Value| {
        target["kind"].as_array().is_some_and(|kinds| kinds.iter().any(|kind| kind == "lib"))
    };
    let library =
        targets.iter().find(is_library).map(|target| relative(root, &target["src_path"])).transpose()?;
    let dependencies = package["dependencies"].as_array().map(Vec::as_slice).unwrap_or_default();
    Ok(Crate {
        name: text(&package["name"])?.to_string(),
        folder: manifest.parent().unwrap_or(&manifest).to_path_buf(),
        library,
        dependencies: dependencies.iter().map(read_dependency).collect::<Result<_, _>>()?,
    })
}

fn read_dependency(dependency: &Value) -> Result<Dependency, Box<dyn Error>> {
    Ok(Dependency { name: text(&dependency["name"])?.to_string(), is_dev: dependency["kind"] == "dev" })
}

fn relative(root: &Path, path: &Value) -> Result<PathBuf, Box<dyn Error>> {
    Ok(Path::new(text(path)?).strip_prefix(root)?.to_path_buf())
}

fn text(value: &Value) -> Result<&str, Box<dyn Error>> {
    value.as_str().ok_or_else(|| "cargo metadata is not in the form this program knows".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn test_modules_are_no_sources() {
        let file = |path: &str| TextFile { path: path.into(), text: String::new() };
        let files = ["src/lib.rs", "src/a/tests.rs", "src/tests/b.rs", "tests/c.rs", "src/d.txt"]
            .map(|path| file(&format!("charts/yase/{path}")));
        let member = Crate {
            name: "yase".into(),
            folder: "charts/yase".into(),
            library: None,
            dependencies: Vec::new(),
        };
        let workspace = Workspace { root: PathBuf::new(), crates: Vec::new(), files: files.into() };
        let sources: Vec<&Path> = workspace.sources(&member).map(|file| file.path.as_path()).collect();
        assert_eq!(sources, [Path::new("charts/yase/src/lib.rs")]);
    }
}
