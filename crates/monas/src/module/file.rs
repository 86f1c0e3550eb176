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
        // Whoever asks for it later may be in another folder.
        let path = path.as_ref();
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const OWN: &str = "module eyes\npackage example 0.1.0\n";

    /// An ELF file of a 64-bit computer with this one section, besides that of the names.
    fn elf(name: &str, section: &[u8]) -> Vec<u8> {
        let names = format!("\0{name}\0.shstrtab\0");
        let (names_at, section_at) = (64, 64 + names.len());
        let headers_at = section_at + section.len();
        let mut file = vec![0x7f, b'E', b'L', b'F', 2, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        file.extend([3_u16, 62].iter().flat_map(|half| half.to_le_bytes()));
        file.extend(1_u32.to_le_bytes());
        file.extend([0, 0, headers_at as u64].iter().flat_map(|word| word.to_le_bytes()));
        file.extend(0_u32.to_le_bytes());
        file.extend([64_u16, 0, 0, 64, 3, 2].iter().flat_map(|half| half.to_le_bytes()));
        file.extend(names.as_bytes());
        file.extend(section);
        let header = |name: usize, kind: u32, at: usize, length: usize| {
            let mut header = [(name as u32).to_le_bytes(), kind.to_le_bytes()].concat();
            let words = [0, 0, at as u64, length as u64, 0, 4, 0];
            header.extend(words.iter().flat_map(|word| word.to_le_bytes()));
            header
        };
        file.extend(header(0, 0, 0, 0));
        file.extend(header(1, 7, section_at, section.len()));
        file.extend(header(name.len() + 2, 3, names_at, names.len()));
        file
    }

    fn note() -> Vec<u8> {
        let text = format!("{}{OWN}", note::BUILD);
        let numbers = [6, text.len() as u32, 1];
        let mut bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        bytes.extend(b"Monas\0\0\0");
        bytes.extend(text.as_bytes());
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes
    }

    #[test]
    fn the_note_is_found_among_the_sections() {
        let note = BuildNote::of_file(&elf(note::SECTION, &note())).unwrap();
        assert_eq!(note.module(), "eyes");
    }

    #[test]
    fn what_has_no_note_of_monas_is_refused_with_its_reason() {
        for (bytes, reason) in [
            (elf(".note.other", &note()), "it has no note"),
            (elf(note::SECTION, b"short"), "its note is cut off"),
            (elf(note::SECTION, b""), "its note is another's"),
        ] {
            assert_eq!(BuildNote::of_file(&bytes), Err(reason.to_owned()));
        }
        assert!(BuildNote::of_file(b"#!/bin/sh\n").is_err());
        assert!(BuildNote::of_file(b"").is_err());
    }

    #[test]
    fn a_file_that_is_no_module_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let wrong = ModuleFile::read(folder.path()).unwrap_err();
        assert!(wrong[0].to_string().starts_with("error[E0360]: "), "{}", wrong[0]);
        let path = folder.path().join("eyes.so");
        std::fs::write(&path, elf(note::SECTION, &note())).unwrap();
        let file = ModuleFile::read(&path).unwrap();
        assert!(file.check().is_ok());
        // It says that it fits, and is nothing that the system can load.
        assert!(file.load().unwrap_err()[0].to_string().starts_with("error[E0362]: module `eyes` cannot be"));
    }

    proptest! {
        #[test]
        fn whatever_the_bytes_are_reading_them_ends_well(bytes in prop::collection::vec(any::<u8>(), 0..4096)) {
            let _ = BuildNote::of_file(&bytes);
            for is_little in [true, false] {
                let _ = note::text_in(&bytes, is_little);
            }
        }

        #[test]
        fn a_module_whose_bytes_were_changed_is_read_or_refused(
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
            length in any::<prop::sample::Index>(),
            is_cut in any::<bool>(),
        ) {
            let mut file = elf(note::SECTION, &note());
            for (at, byte) in changes {
                let at = at.index(file.len());
                file[at] = byte;
            }
            if is_cut {
                file.truncate(length.index(file.len()));
            }
            if let Ok(note) = BuildNote::of_file(&file) {
                prop_assert!(!note.module().is_empty());
            }
        }
    }
}
