//! The file of a module, read but not loaded.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use object::{Object, ObjectSection};
use yase::Diagnostic;

use super::note::{self, BuildNote, Differing};

/// A module has no more bytes than this.
const MOST: u64 = 1 << 30;

/// How a module is built that fits.
pub(super) const HINT: &str = "`monas module build` builds it as this program is built";

/// The bytes of a module with the note that is in them.
#[derive(Clone)]
pub struct ModuleFile {
    pub(super) path: PathBuf,
    pub(super) bytes: Vec<u8>,
    note: BuildNote,
}

impl ModuleFile {
    /// Reads the file of a module; nothing of it is run.
    ///
    /// # Errors
    /// Diagnostics (`E0360`): it cannot be read, or is no module of Monas.
    pub fn read(path: impl AsRef<Path>) -> Result<ModuleFile, Vec<Diagnostic>> {
        let path = path.as_ref().to_path_buf();
        let bytes = bytes_of(&path).map_err(|error| unread(&path, &error.to_string()))?;
        match BuildNote::of_file(&bytes) {
            Ok(note) => Ok(ModuleFile { path, bytes, note }),
            Err(reason) => Err(unread(&path, &format!("this is no module of Monas: {reason}"))),
        }
    }

    /// How it was built, and what it is called.
    pub fn note(&self) -> &BuildNote {
        &self.note
    }

    /// The hash of its bytes, as hexadecimal digits.
    pub fn digest(&self) -> String {
        blake3::hash(&self.bytes).to_hex().to_string()
    }

    /// Whether it was built as this program was, so far as notes tell.
    ///
    /// # Errors
    /// Diagnostics (`E0361`), one for each field that differs.
    pub fn check(&self) -> Result<(), Vec<Diagnostic>> {
        let wrong = BuildNote::own().differences(&self.note);
        let wrong: Vec<Diagnostic> = wrong.iter().map(|one| self.differing(one)).collect();
        if wrong.is_empty() { Ok(()) } else { Err(wrong) }
    }

    fn differing(&self, Differing { field, expected, found }: &Differing) -> Diagnostic {
        let module = self.note.module();
        let message = format!(
            "module `{module}` does not fit this program: {field} is `{found}`, expected `{expected}`"
        );
        Diagnostic::error("E0361", 0..0, message).with_hint(HINT)
    }
}

impl std::fmt::Debug for ModuleFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ModuleFile")
            .field("path", &self.path)
            .field("note", &self.note)
            .finish_non_exhaustive()
    }
}

impl BuildNote {
    /// The note in the bytes of a module's file.
    ///
    /// # Errors
    /// Why there is none.
    pub fn of_file(bytes: &[u8]) -> Result<BuildNote, String> {
        let file = object::File::parse(bytes).map_err(|error| error.to_string().to_lowercase())?;
        let section = file.section_by_name(note::SECTION).ok_or("it has no note")?;
        let section = section.data().map_err(|error| error.to_string().to_lowercase())?;
        BuildNote::parse(note::text_in(section, file.is_little_endian())?)
    }
}

fn bytes_of(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = File::open(path)?.take(MOST + 1).read_to_end(&mut bytes)?;
    match read as u64 > MOST {
        true => Err(std::io::Error::new(std::io::ErrorKind::FileTooLarge, "it is too large for a module")),
        false => Ok(bytes),
    }
}

fn unread(path: &Path, reason: &str) -> Vec<Diagnostic> {
    let message = format!("{}: {reason}", path.display());
    vec![Diagnostic::error("E0360", 0..0, message).with_hint("a module is what `monas module build` writes")]
}
