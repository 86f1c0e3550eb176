//! The models that pages may edit.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};

use serde_json::{Value, json};

/// The extensions of model files in a folder.
const EXTENSIONS: [&str; 8] = ["srm", "sag", "suc", "aip", "ft", "eac", "iac", "stct"];

/// The longest file, in bytes: a request has its text with escapes.
const FILE_LIMIT: u64 = 1 << 19;

/// The language of models. Its replies are read by the page: positions are counted in
/// UTF-16 code units, as a page counts them.
pub trait ModelLanguage: Send + Sync {
    /// The structure of a text, which may have errors: `picture`, `findings`, and `parts`, which
    /// lists the editable parts.
    fn outline(&self, name: &str, text: &str) -> Value;

    /// All findings about a text, as `findings`. It may take long, and ends early when `stop` is
    /// set.
    fn check(&self, name: &str, text: &str, stop: &Arc<AtomicBool>) -> Value;

    /// Completions at a position of a text, or of an expression of the model: `from`, `to`
    /// and `entries`.
    fn complete(&self, text: &str, expression: Option<&str>, at: usize) -> Value;

    /// The replacements of a text that make an edit: a list of `from`, `to` and `insert`.
    ///
    /// # Errors
    /// The reason why the edit is not possible, as a sentence.
    fn edit(&self, text: &str, edit: Value) -> Result<Value, String>;
}

/// Files of models with the language that they are in. Pages read and write these files and no
/// other.
pub struct ModelWorkspace {
    files: Vec<ModelFile>,
    language: Arc<dyn ModelLanguage>,
    /// Held while a file is compared and replaced: if two pages save at once, the second is
    /// refused.
    saving: Mutex<()>,
}

/// A file that can be edited.
struct ModelFile {
    /// The path as given.
    name: String,
    /// The path with links resolved, so that the file itself is replaced.
    path: PathBuf,
}

impl ModelWorkspace {
    /// The files at these paths, each once; of a folder all that are named like a model.
    ///
    /// # Errors
    /// There is no file, or a path does not exist.
    pub fn new(paths: &[PathBuf], language: Arc<dyn ModelLanguage>) -> io::Result<ModelWorkspace> {
        let file = |path: PathBuf| {
            let name = path.display().to_string();
            let found = fs::canonicalize(&path).and_then(|path| match path.is_file() {
                true => Ok(path),
                false => Err(io::Error::other("not a file")),
            });
            found
                .map(|path| ModelFile { name: name.clone(), path })
                .map_err(|error| io::Error::new(error.kind(), format!("{name}: {error}")))
        };
        let mut files: Vec<ModelFile> = Vec::new();
        for path in given(paths)? {
            let found = file(path)?;
            if !files.iter().any(|known| known.path == found.path) {
                files.push(found);
            }
        }
        if files.is_empty() {
            let message = format!("there is no model to edit; models end in .{}", EXTENSIONS.join(", ."));
            return Err(io::Error::other(message));
        }
        Ok(ModelWorkspace { files, language, saving: Mutex::default() })
    }

    pub(crate) fn language(&self) -> &dyn ModelLanguage {
        &*self.language
    }

    pub(crate) fn names(&self) -> Vec<&str> {
        self.files.iter().map(|file| file.name.as_str()).collect()
    }

    pub(crate) fn name(&self, file: usize) -> Result<&str, String> {
        self.file(file).map(|file| file.name.as_str())
    }

    /// A file's text, and its revision, which a page sends back on saving.
    pub(crate) fn open(&self, file: usize) -> Result<Value, String> {
        let file = self.file(file)?;
        let text = file.read()?.ok_or_else(|| format!("{}: the file was deleted", file.name))?;
        Ok(json!({"done": true, "revision": revision(Some(&text)), "text": text}))
    }

    /// Replaces a file if it still has the revision that the page has read; otherwise the reply has
    /// the present revision and text, which is null if the file was deleted. A page that sends that
    /// revision knows what it replaces.
    pub(crate) fn save(&self, file: usize, text: &str, known: &str) -> Result<Value, String> {
        let file = self.file(file)?;
        if text.len() as u64 > FILE_LIMIT {
            return Err(format!("{} bytes are too many to edit here, at most {FILE_LIMIT}", text.len()));
        }
        let _saving = self.saving.lock().unwrap_or_else(PoisonError::into_inner);
        let present = file.read()?;
        let present_revision = revision(present.as_deref());
        if present_revision != known {
            return Ok(json!({"done": false, "reason": "the file has changed since it was read",
                "revision": present_revision, "text": present}));
        }
        monas_files::write(&file.path, text).map_err(|error| format!("{}: {error}", file.name))?;
        Ok(json!({"done": true, "revision": revision(Some(text))}))
    }

    fn file(&self, file: usize) -> Result<&ModelFile, String> {
        self.files.get(file).ok_or_else(|| "the studio was not given such a file".to_owned())
    }
}

impl ModelFile {
    /// Reads the text; there is none if the file was deleted. The path leads over no link, since
    /// links are followed when it is given: one that has taken its place since would lead
    /// elsewhere.
    fn read(&self) -> Result<Option<String>, String> {
        if self.path.is_symlink() {
            return Err(format!("{}: the file was replaced by a link", self.name));
        }
        match read_text(&self.path) {
            Ok(text) => Ok(Some(text)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(format!("{}: {error}", self.name)),
        }
    }
}

/// The paths of files: those given, and the models in folders in order.
fn given(paths: &[PathBuf]) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in paths {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let inside =
            fs::read_dir(path)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<PathBuf>>>()?;
        let mut models: Vec<PathBuf> = inside.into_iter().filter(|path| is_model(path)).collect();
        models.sort();
        files.extend(models);
    }
    Ok(files)
}

fn is_model(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str());
    path.is_file() && ending.is_some_and(|ending| EXTENSIONS.contains(&ending))
}

fn read_text(path: &Path) -> io::Result<String> {
    let size = fs::metadata(path)?.len();
    if size > FILE_LIMIT {
        return Err(io::Error::other(format!(
            "{size} bytes are too many to edit here, at most {FILE_LIMIT}"
        )));
    }
    fs::read_to_string(path)
}

/// The revision of a text; that of a deleted file is empty.
fn revision(text: Option<&str>) -> String {
    text.map_or_else(String::new, |text| blake3::hash(text.as_bytes()).to_hex().to_string())
}

impl std::fmt::Debug for ModelWorkspace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.names()).finish()
    }
}
