//! The file of a module, read but not loaded.

use std::io::Read;
use std::path::{Path, PathBuf};

use object::{Object, ObjectSection};
use yase::Diagnostic;

use crate::content;
use monas_core::module::note::{self, BuildFingerprint, FingerprintMismatch};

/// Maximum size of a module, in bytes.
const MAX_SIZE: u64 = 1 << 30;

/// Instruction to build a compatible module.
pub(crate) const BUILD_HINT: &str = "build it like this program by `monas module build`";

/// The bytes of a module and the note in them.
#[derive(Clone)]
pub struct ModuleFile {
    pub(crate) path: PathBuf,
    pub(crate) bytes: Vec<u8>,
    note: BuildFingerprint,
}

impl ModuleFile {
    /// Reads the file of a module without running its code.
    ///
    /// # Errors
    /// Diagnostics: it cannot be read, is not a module of Monas, or other users can change it
    /// (`E0360`); it is damaged (`E0368`).
    pub fn read(path: impl AsRef<Path>) -> Result<ModuleFile, Vec<Diagnostic>> {
        // A later use may happen in another working directory.
        let path = path.as_ref();
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        let bytes = bytes_of(&path).map_err(|error| unread(&path, &error.to_string()))?;
        match read_fingerprint(&bytes) {
            Ok(note) => match content::check(&bytes, &note) {
                Ok(()) => Ok(ModuleFile { path, bytes, note }),
                Err(reason) => Err(damaged(&path, &reason)),
            },
            Err(reason) => Err(unread(&path, &format!("this is not a module of Monas: {reason}"))),
        }
    }

    /// Its build fingerprint, with its name.
    pub fn note(&self) -> &BuildFingerprint {
        &self.note
    }

    /// The BLAKE3 hash of its bytes, hexadecimal.
    pub fn digest(&self) -> String {
        blake3::hash(&self.bytes).to_hex().to_string()
    }

    /// Compares its build fingerprint with that of this program.
    ///
    /// # Errors
    /// Diagnostics (`E0361`), one for each field that differs.
    pub fn check(&self) -> Result<(), Vec<Diagnostic>> {
        let wrong = BuildFingerprint::own().differences(&self.note);
        let wrong: Vec<Diagnostic> = wrong.iter().map(|one| self.differing(one)).collect();
        if wrong.is_empty() { Ok(()) } else { Err(wrong) }
    }

    fn differing(&self, FingerprintMismatch { field, expected, found }: &FingerprintMismatch) -> Diagnostic {
        let module = self.note.module();
        let message = format!(
            "module `{module}` does not fit this program: {field} is `{found}`, expected `{expected}`"
        );
        Diagnostic::error("E0361", 0..0, message).with_hint(BUILD_HINT)
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

/// Reads the build fingerprint in the bytes of a module's file.
///
/// # Errors
/// Why there is none.
pub fn read_fingerprint(bytes: &[u8]) -> Result<BuildFingerprint, String> {
    let file = object::File::parse(bytes).map_err(|error| error.to_string().to_lowercase())?;
    let section = file.section_by_name(note::SECTION).ok_or("it has no note")?;
    let section = section.data().map_err(|error| error.to_string().to_lowercase())?;
    BuildFingerprint::parse(note::text_in(section, file.is_little_endian())?)
}

fn bytes_of(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = monas_files::open_trusted(path)?.take(MAX_SIZE + 1).read_to_end(&mut bytes)?;
    match read as u64 > MAX_SIZE {
        true => Err(std::io::Error::new(std::io::ErrorKind::FileTooLarge, "it is too large for a module")),
        false => Ok(bytes),
    }
}

fn unread(path: &Path, reason: &str) -> Vec<Diagnostic> {
    let message = format!("{}: {reason}", path.display());
    vec![Diagnostic::error("E0360", 0..0, message).with_hint("modules are written by `monas module build`")]
}

fn damaged(path: &Path, reason: &str) -> Vec<Diagnostic> {
    let message = format!("{}: this module is damaged: {reason}", path.display());
    let hint = "copy it again, or build it with `monas module build`";
    vec![Diagnostic::error("E0368", 0..0, message).with_hint(hint)]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const OWN: &str = "module eyes\npackage example 0.1.0\n";

    /// A 64-bit ELF file with this section and that of the section names.
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
        note_of(OWN)
    }

    fn note_of(own: &str) -> Vec<u8> {
        let text = format!("{}{own}", note::BUILD);
        let numbers = [6, text.len() as u32, 1];
        let mut bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        bytes.extend(b"Monas\0\0\0");
        bytes.extend(text.as_bytes());
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes
    }

    #[test]
    fn the_note_is_found_among_the_sections() {
        let note = read_fingerprint(&elf(note::SECTION, &note())).unwrap();
        assert_eq!(note.module(), "eyes");
    }

    #[test]
    fn a_library_without_a_fingerprint_is_rejected() {
        for (bytes, reason) in [
            (elf(".note.other", &note()), "it has no note"),
            (elf(note::SECTION, b"short"), "its note is cut off"),
            (elf(note::SECTION, b""), "its note is another's"),
        ] {
            assert_eq!(read_fingerprint(&bytes), Err(reason.to_owned()));
        }
        assert!(read_fingerprint(b"#!/bin/sh\n").is_err());
        assert!(read_fingerprint(b"").is_err());
    }

    #[test]
    #[cfg(unix)]
    fn what_others_can_change_or_what_is_no_file_is_refused() {
        use std::os::unix::fs::PermissionsExt;

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("eyes.so");
        std::fs::write(&path, elf(note::SECTION, &note())).unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o666)).unwrap();
        let wrong = ModuleFile::read(&path).unwrap_err()[0].to_string();
        assert!(wrong.contains("other users may change it"), "{wrong}");
        let pipe = folder.path().join("pipe.so");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let wrong = ModuleFile::read(&pipe).unwrap_err()[0].to_string();
        assert!(wrong.contains("it is not a regular file"), "{wrong}");
    }

    #[test]
    fn a_sealed_module_whose_content_has_changed_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("eyes.so");
        let own = format!("{OWN}{} {}\n", note::CONTENT_FIELD, note::UNSEALED_CONTENT);
        let unsealed = [elf(note::SECTION, &note_of(&own)), b"code".to_vec()].concat();
        std::fs::write(&path, &unsealed).unwrap();
        assert!(ModuleFile::read(&path).is_ok(), "a module that cargo alone has built");
        crate::seal(&path).unwrap();
        let sealed = std::fs::read(&path).unwrap();
        assert!(sealed != unsealed && sealed.len() == unsealed.len());
        assert!(ModuleFile::read(&path).is_ok());
        crate::seal(&path).unwrap();
        assert!(std::fs::read(&path).unwrap() == sealed, "once more changes nothing");
        for change in [
            |bytes: &mut Vec<u8>| bytes.truncate(bytes.len() - 1),
            |bytes: &mut Vec<u8>| {
                let last = bytes.len() - 1;
                bytes[last] ^= 1;
            },
        ] {
            let mut bytes = sealed.clone();
            change(&mut bytes);
            std::fs::write(&path, bytes).unwrap();
            let wrong = ModuleFile::read(&path).unwrap_err()[0].to_string();
            assert!(wrong.starts_with("error[E0368]: ") && wrong.contains("is damaged"), "{wrong}");
        }
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
        // The note is compatible, but the system cannot load the file.
        assert!(file.load().unwrap_err()[0].to_string().starts_with("error[E0362]: module `eyes` cannot be"));
    }

    proptest! {
        #[test]
        fn arbitrary_bytes_are_parsed_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..4096)) {
            let _ = read_fingerprint(&bytes);
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
            if let Ok(note) = read_fingerprint(&file) {
                prop_assert!(!note.module().is_empty());
            }
        }
    }
}
