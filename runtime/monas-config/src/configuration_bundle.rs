//! The files of a run's configuration, as they were when it started.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use yase::{Source, Span};

use crate::paths::is_standard_input;
use crate::{Element, Grammar};

/// Name endings and media types of the configurations and models included in a bundle. Other files,
/// above all keys, are excluded.
const BUNDLED_TYPES: [(&str, &str); 6] = [
    ("xml", "text/xml"),
    ("toml", "application/toml"),
    ("srm", "text/plain"),
    ("xmi", "text/xml"),
    ("scxml", "text/xml"),
    ("properties", "text/plain"),
];

/// A configuration with all configurations and models that it names, directly or indirectly, so
/// that the same agents can be assembled again elsewhere and later.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct ConfigurationBundle {
    /// The name of the first file.
    root: String,
    /// The files' contents by name: the path relative to the common folder, with slashes.
    files: BTreeMap<String, Vec<u8>>,
    /// The common folder, if the contents of the files depend on their location.
    folder: Option<PathBuf>,
}

impl ConfigurationBundle {
    /// The configuration at `path` with the files it names. Missing files are left out: loading the
    /// configuration reports them.
    pub fn of(path: impl AsRef<Path>) -> ConfigurationBundle {
        ConfigurationBundle::including(path, &[])
    }

    /// The same with other files and the files that these name, such as the overrides of a robot.
    pub fn including(path: impl AsRef<Path>, others: &[PathBuf]) -> ConfigurationBundle {
        let path = path.as_ref();
        let absolute = |path: &Path| normal(&std::path::absolute(path).unwrap_or_else(|_| path.to_owned()));
        let mut found = BTreeMap::new();
        let root = match crate::read_file(path) {
            Ok(input) if is_standard_input(path) => {
                let name = if crate::is_toml_text(&input) { "stdin.toml" } else { "stdin.xml" };
                let root = absolute(Path::new(name));
                add(&root, &input, &mut found);
                root
            }
            _ => absolute(path),
        };
        collect(&root, &mut found);
        others.iter().for_each(|other| collect(&absolute(other), &mut found));
        let folder = common_folder(found.keys().chain([&root]));
        let name = |path: &Path| slashes(path.strip_prefix(&folder).unwrap_or(path));
        let is_bound = found.iter().any(|(path, content)| {
            named_in(path, content).1.iter().any(|named| named.resolved(path).is_some())
        });
        ConfigurationBundle {
            root: name(&root),
            files: found.iter().map(|(path, content)| (name(path), content.clone())).collect(),
            folder: is_bound.then_some(folder),
        }
    }

    /// A bundle of files in memory.
    pub fn from_files(
        root: impl Into<String>,
        files: impl IntoIterator<Item = (String, Vec<u8>)>,
    ) -> ConfigurationBundle {
        ConfigurationBundle { root: root.into(), files: files.into_iter().collect(), folder: None }
    }

    /// The same bundle with the folder its files were in.
    #[must_use]
    pub fn in_folder(self, folder: impl Into<PathBuf>) -> ConfigurationBundle {
        ConfigurationBundle { folder: Some(folder.into()), ..self }
    }

    /// The folder of the files, if their contents depend on it: a file is named by its absolute
    /// path, or a module, which is not part of the bundle, by a relative path.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The name of the configuration itself.
    pub fn root(&self) -> &str {
        &self.root
    }

    /// Name, media type and content of each file, by name.
    pub fn files(&self) -> impl Iterator<Item = (&str, &'static str, &[u8])> {
        self.files.iter().map(|(name, content)| {
            (name.as_str(), media_type(Path::new(name)).unwrap_or("text/plain"), &content[..])
        })
    }

    /// Hash of the bundle, 64 hexadecimal digits: BLAKE3 of the files in the order of their names,
    /// for each its name and its content, each preceded by its length (u64, little endian).
    pub fn hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        for (name, content) in &self.files {
            for part in [name.as_bytes(), content] {
                hasher.update(&(part.len() as u64).to_le_bytes());
                hasher.update(part);
            }
        }
        hasher.finalize().to_hex().to_string()
    }

    /// Writes the files into a folder and returns the path of the configuration there. Absolute
    /// paths of bundled files are replaced by those of the written files; modules are named by
    /// absolute paths.
    ///
    /// # Errors
    /// A file cannot be written, or its name leads out of the folder.
    pub fn unpack(&self, folder: &Path) -> io::Result<PathBuf> {
        let inside = |name: &str| {
            let path = Path::new(name);
            let is_inside =
                !name.is_empty() && path.components().all(|part| matches!(part, Component::Normal(_)));
            match is_inside {
                true => Ok(folder.join(path)),
                false => {
                    Err(io::Error::other(format!("`{name}` is not a name of a file of a configuration")))
                }
            }
        };
        for (name, content) in &self.files {
            let path = inside(name)?;
            path.parent().map_or(Ok(()), fs::create_dir_all)?;
            let elsewhere = self.folder.as_deref().map(|home| self.moved(&home.join(name), home, folder));
            fs::write(path, elsewhere.transpose()?.as_deref().unwrap_or(content))?;
        }
        inside(&self.root)
    }

    /// The content to write for the file at `path` in `home` after the files of that folder are
    /// moved to another one.
    fn moved(&self, path: &Path, home: &Path, folder: &Path) -> io::Result<Vec<u8>> {
        let name = |path: &Path| slashes(path.strip_prefix(home).unwrap_or(path));
        let content = self.files.get(&name(path)).map_or(&[][..], Vec::as_slice);
        let (source, named) = named_in(path, content);
        let mut text = source.text.clone();
        // From the end, so that earlier spans stay valid.
        for named in named.iter().rev() {
            let Some(target) = named.resolved(path) else { continue };
            let target =
                if self.files.contains_key(&name(&target)) { folder.join(name(&target)) } else { target };
            let target = target.display().to_string();
            let is_plain = source.text.get(named.span.start..named.span.end) == Some(&*named.text);
            if !is_plain || target.contains(['<', '>', '&', '"', '\'', '\\', '\n']) {
                let file = path.display();
                return Err(io::Error::other(format!(
                    "{file} names `{}`, which cannot become `{target}`",
                    named.text
                )));
            }
            text.replace_range(named.span.start..named.span.end, &target);
        }
        Ok(text.into_bytes())
    }
}

/// A file that a configuration names.
struct NamedFile {
    text: String,
    span: Span,
    is_module: bool,
}

impl NamedFile {
    /// The location of the file, if it is absolute or depends on the location of the configuration
    /// at `path`.
    fn resolved(&self, path: &Path) -> Option<PathBuf> {
        let named = Path::new(&self.text);
        if named.is_absolute() {
            return Some(normal(named));
        }
        self.is_module.then(|| crate::locate(path, &self.text).ok()).flatten()
    }
}

/// The text of the file at `path` and, for a configuration, the files it names in the order of the
/// text.
fn named_in(path: &Path, content: &[u8]) -> (Arc<Source>, Vec<NamedFile>) {
    let text = String::from_utf8_lossy(content);
    let source = Source::new(path.display().to_string(), &*text);
    let mut named = Vec::new();
    if is_configuration(path) {
        Grammar::agents().parse(&source).0.iter().for_each(|element| add_named(element, &mut named));
    }
    named.sort_by_key(|named| named.span.start);
    (source, named)
}

/// Adds the files named in attributes or texts of an element and its descendants.
fn add_named(element: &Element, named: &mut Vec<NamedFile>) {
    let values = element.attributes().iter().map(|attribute| (&*attribute.value, attribute.value_span));
    for (text, span) in values.chain([(element.text(), element.text_span())]) {
        let is_module = element.is("module");
        if is_module || media_type(Path::new(text)).is_some() {
            named.push(NamedFile { text: text.to_owned(), span, is_module });
        }
    }
    element.children().iter().for_each(|child| add_named(child, named));
}

/// Adds a file and the files it names.
fn collect(path: &Path, found: &mut BTreeMap<PathBuf, Vec<u8>>) {
    if media_type(path).is_none() || found.contains_key(path) {
        return;
    }
    if let Ok(source) = crate::read_file(path) {
        add(path, &source, found);
    }
}

/// Adds the text of a file and the files it names.
fn add(path: &Path, source: &Source, found: &mut BTreeMap<PathBuf, Vec<u8>>) {
    let content = source.text.clone().into_bytes();
    let (_, named) = named_in(path, &content);
    found.insert(path.to_owned(), content);
    for named in named.iter().filter(|named| !named.is_module) {
        if let Ok(file) = crate::locate(path, &named.text) {
            collect(&normal(&file), found);
        }
    }
}

fn is_configuration(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "xml" || extension == "toml")
}

fn media_type(path: &Path) -> Option<&'static str> {
    let extension = path.extension()?.to_str()?;
    BUNDLED_TYPES.iter().find(|(known, _)| *known == extension).map(|(_, media_type)| *media_type)
}

/// The path without `.` and, where it can be resolved lexically, without `..`.
fn normal(path: &Path) -> PathBuf {
    let mut parts: Vec<Component<'_>> = Vec::new();
    for part in path.components() {
        match (part, parts.last()) {
            (Component::CurDir, _) => {}
            (Component::ParentDir, Some(Component::Normal(_))) => drop(parts.pop()),
            _ => parts.push(part),
        }
    }
    parts.into_iter().collect()
}

/// The innermost folder that contains all files.
fn common_folder<'a>(mut paths: impl Iterator<Item = &'a PathBuf>) -> PathBuf {
    let first = paths.next().and_then(|path| path.parent()).unwrap_or(Path::new("")).to_owned();
    paths.fold(first, |folder, path| {
        let both = folder.components().zip(path.components());
        both.take_while(|(a, b)| a == b).map(|(part, _)| part).collect()
    })
}

fn slashes(path: &Path) -> String {
    let parts: Vec<_> = path.components().map(|part| part.as_os_str().to_string_lossy()).collect();
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn project(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, content).unwrap();
        }
        folder
    }

    const FILES: [(&str, &str); 5] = [
        (
            "config/match.xml",
            "<match field='config/field.xml'><robot role='roles/goalie.xml' key='config/secret.pem'/></match>",
        ),
        ("config/field.xml", "<field/>"),
        ("config/roles/goalie.xml", "<agent><name>G</name><statechart>models/g.srm</statechart></agent>"),
        ("config/secret.pem", "a secret"),
        ("models/g.srm", "Liveness:\ng = A"),
    ];

    #[test]
    fn a_configuration_is_all_that_it_names_and_no_more() {
        let folder = project(&FILES);
        let provenance = ConfigurationBundle::of(folder.path().join("config/match.xml"));
        assert_eq!(provenance.root(), "config/match.xml");
        let names: Vec<&str> = provenance.files().map(|(name, ..)| name).collect();
        assert_eq!(
            names,
            ["config/field.xml", "config/match.xml", "config/roles/goalie.xml", "models/g.srm"]
        );
    }

    #[test]
    fn it_can_be_unpacked_and_is_the_same_then() {
        let folder = project(&FILES);
        let provenance = ConfigurationBundle::of(folder.path().join("config/match.xml"));
        let elsewhere = tempfile::tempdir().unwrap();
        let root = provenance.unpack(elsewhere.path()).unwrap();
        let again = ConfigurationBundle::of(root);
        assert_eq!((&again, again.hash()), (&provenance, provenance.hash()));
        fs::write(elsewhere.path().join("models/g.srm"), "Liveness:\ng = B").unwrap();
        assert_ne!(
            ConfigurationBundle::of(elsewhere.path().join("config/match.xml")).hash(),
            provenance.hash()
        );
    }

    #[test]
    fn whole_paths_lead_to_the_files_that_were_unpacked() {
        let folder = project(&[("models/g.srm", "Liveness:\ng = A"), ("lib/eyes.so", "code")]);
        let home = folder.path().display().to_string();
        let agents = format!(
            "<agents><module>../lib/eyes.so</module><agent><statechart>{home}/models/../models/g.srm</statechart></agent></agents>"
        );
        fs::create_dir(folder.path().join("config")).unwrap();
        fs::write(folder.path().join("config/agents.xml"), &agents).unwrap();
        let provenance = ConfigurationBundle::of(folder.path().join("config/agents.xml"));
        assert_eq!(provenance.folder(), Some(folder.path()));
        assert_eq!(
            provenance.files().map(|(name, ..)| name).collect::<Vec<_>>(),
            ["config/agents.xml", "models/g.srm"]
        );
        let elsewhere = tempfile::tempdir().unwrap();
        let files = provenance.files().map(|(name, _, content)| (name.to_owned(), content.to_vec()));
        let carried = ConfigurationBundle::from_files(provenance.root(), files).in_folder(folder.path());
        fs::write(folder.path().join("models/g.srm"), "changed since").unwrap();
        let root = carried.unpack(elsewhere.path()).unwrap();
        let there = elsewhere.path().display();
        let expected = format!(
            "<agents><module>{home}/config/../lib/eyes.so</module><agent><statechart>{there}/models/g.srm</statechart></agent></agents>"
        );
        assert_eq!(fs::read_to_string(root).unwrap(), expected);
        assert_eq!(fs::read_to_string(elsewhere.path().join("models/g.srm")).unwrap(), "Liveness:\ng = A");
    }

    #[test]
    fn a_configuration_that_names_files_from_where_it_is_can_be_anywhere() {
        assert_eq!(ConfigurationBundle::of(project(&FILES).path().join("config/match.xml")).folder(), None);
    }

    #[test]
    fn nothing_is_written_outside_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["../out.xml", "/tmp/out.xml", "a/../../out.xml", ""] {
            let hostile = ConfigurationBundle::from_files(name, [(name.to_owned(), b"x".to_vec())]);
            assert!(hostile.unpack(&folder.path().join("in")).is_err(), "{name}");
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn paths_are_written_in_one_way() {
        assert_eq!(normal(Path::new("./config/../models/g.srm")), Path::new("models/g.srm"));
        assert_eq!(normal(Path::new("../config/m.xml")), Path::new("../config/m.xml"));
        assert_eq!(
            ConfigurationBundle::of("nowhere.xml"),
            ConfigurationBundle::from_files("nowhere.xml", [])
        );
    }
}
