//! Build fingerprint of a module, in a section of its file that is read before the module is
//! loaded.

use std::fmt;

/// The name of the section.
pub const SECTION: &str = ".note.monas";
/// Owner of the note.
const OWNER: [u8; 8] = *b"Monas\0\0\0";
/// Type of the note: a text.
const KIND: u32 = 1;

/// The build of this copy of Monas.
pub const BUILD: &str = concat!(
    "format 1\ncompiler ",
    env!("MONAS_BUILD_COMPILER"),
    "\ntarget ",
    env!("MONAS_BUILD_TARGET"),
    "\nprofile ",
    env!("MONAS_BUILD_PROFILE"),
    "\nflags ",
    env!("MONAS_BUILD_FLAGS"),
    "\nmonas ",
    env!("CARGO_PKG_VERSION"),
    "\nfeatures ",
    env!("MONAS_BUILD_FEATURES"),
    "\nlock ",
    env!("MONAS_BUILD_LOCK"),
    "\n"
);

/// The field with the BLAKE3 hash of the module's file, in which the value of this field counts as
/// [`UNSEALED_CONTENT`]. `monas module build` writes it.
pub const CONTENT_FIELD: &str = "content";

/// The value of the field [`CONTENT_FIELD`] before it is written.
pub const UNSEALED_CONTENT: &str = "0000000000000000000000000000000000000000000000000000000000000000";

/// Fields that must be equal in a module and in the program that loads it.
const COMPARED_FIELDS: [&str; 8] =
    ["format", "compiler", "target", "profile", "flags", "monas", "features", "lock"];

/// Build fingerprint of a program or a module.
///
/// Equal fingerprints do not guarantee equal types: these are compared when the module is loaded.
/// Different fingerprints imply different types, and are detected without running code of the
/// module.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BuildFingerprint {
    /// Keys and values, in the order of the text.
    fields: Vec<(String, String)>,
}

/// A difference between two fingerprints.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FingerprintMismatch {
    /// The field that differs.
    pub field: String,
    /// The value of this program.
    pub expected: String,
    /// The value of the module.
    pub found: String,
}

impl BuildFingerprint {
    /// The fingerprint of this program.
    pub fn own() -> BuildFingerprint {
        BuildFingerprint { fields: fields(BUILD).unwrap_or_default() }
    }

    /// Parses the text of a note.
    pub fn parse(text: &str) -> Result<BuildFingerprint, String> {
        let note = BuildFingerprint { fields: fields(text)? };
        match note.field("module").is_some_and(is_identifier) {
            true => Ok(note),
            false => Err("it does not name the module".into()),
        }
    }

    /// Keys and values, in the order of the text.
    pub fn fields(&self) -> impl Iterator<Item = (&str, &str)> {
        self.fields.iter().map(|(key, value)| (key.as_str(), value.as_str()))
    }

    /// The value of a field.
    pub fn field(&self, key: &str) -> Option<&str> {
        self.fields.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }

    /// The name of the module; empty for a program.
    pub fn module(&self) -> &str {
        self.field("module").unwrap_or_default()
    }

    /// Fields that must be equal and are not.
    pub fn differences(&self, found: &BuildFingerprint) -> Vec<FingerprintMismatch> {
        let said = |note: &BuildFingerprint, key: &str| note.field(key).unwrap_or_default().to_owned();
        COMPARED_FIELDS
            .into_iter()
            .filter(|key| self.field(key) != found.field(key))
            .map(|key| FingerprintMismatch {
                field: key.into(),
                expected: said(self, key),
                found: said(found, key),
            })
            .collect()
    }
}

impl fmt::Display for BuildFingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.fields().try_for_each(|(key, value)| writeln!(f, "{key:10}{value}"))
    }
}

/// Lines of a key, a space and a value.
fn fields(text: &str) -> Result<Vec<(String, String)>, String> {
    let line = |line: &str| match line.split_once(' ') {
        Some((key, value)) if is_identifier(key) => Ok((key.to_owned(), value.to_owned())),
        _ => Err(format!("`{}` is not a line of a note", line.escape_debug())),
    };
    text.lines().map(line).collect()
}

/// Whether a name can be part of a symbol.
fn is_identifier(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// The bytes of the section: one ELF note whose text has `LENGTH` bytes with its padding.
#[doc(hidden)]
#[repr(C)]
pub struct NoteSection<const LENGTH: usize> {
    owner_length: u32,
    text_length: u32,
    kind: u32,
    owner: [u8; 8],
    text: [u8; LENGTH],
}

/// Length of the text of a module's note, padded to four bytes.
#[doc(hidden)]
pub const fn padded_length(module: &str) -> usize {
    (BUILD.len() + module.len()).next_multiple_of(4)
}

impl<const LENGTH: usize> NoteSection<LENGTH> {
    /// The note of a module; `module` contains its own lines.
    pub const fn new(module: &str) -> NoteSection<LENGTH> {
        let mut text = [0; LENGTH];
        let at = put(&mut text, BUILD.as_bytes(), 0);
        let end = put(&mut text, module.as_bytes(), at);
        // "Monas" with its terminating zero; padding is not counted.
        NoteSection { owner_length: 6, text_length: end as u32, kind: KIND, owner: OWNER, text }
    }
}

const fn put<const LENGTH: usize>(text: &mut [u8; LENGTH], bytes: &[u8], at: usize) -> usize {
    let mut index = 0;
    while index < bytes.len() {
        text[at + index] = bytes[index];
        index += 1;
    }
    at + bytes.len()
}

/// The text of the first note of Monas among the notes of a section.
pub fn text_in(mut section: &[u8], is_little: bool) -> Result<&str, String> {
    let cut = || "its note is cut off".to_owned();
    while !section.is_empty() {
        let (owner_length, rest) = number(section, is_little).ok_or_else(cut)?;
        let (text_length, rest) = number(rest, is_little).ok_or_else(cut)?;
        let (kind, rest) = number(rest, is_little).ok_or_else(cut)?;
        let (owner, rest) = padded(rest, owner_length).ok_or_else(cut)?;
        let (text, rest) = padded(rest, text_length).ok_or_else(cut)?;
        if owner == b"Monas\0" && kind == KIND as usize {
            return std::str::from_utf8(text).map_err(|_| "its note is not a text".into());
        }
        section = rest;
    }
    Err("its note is another's".into())
}

fn number(bytes: &[u8], is_little: bool) -> Option<(usize, &[u8])> {
    let (number, rest) = bytes.split_first_chunk::<4>()?;
    let number = if is_little { u32::from_le_bytes(*number) } else { u32::from_be_bytes(*number) };
    Some((usize::try_from(number).ok()?, rest))
}

/// Splits off `length` bytes and their padding to a multiple of four; padding at the end may be
/// missing.
fn padded(bytes: &[u8], length: usize) -> Option<(&[u8], &[u8])> {
    let (taken, _) = bytes.split_at_checked(length)?;
    let next = length.checked_next_multiple_of(4)?.min(bytes.len());
    Some((taken, &bytes[next..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const EYES: &str = "module eyes\npackage example 0.1.0\n";

    /// The bytes of a section as in a file of this computer.
    fn section() -> Vec<u8> {
        let section = NoteSection::<{ padded_length(EYES) }>::new(EYES);
        let numbers = [section.owner_length, section.text_length, section.kind];
        let mut bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        bytes.extend(section.owner);
        bytes.extend(section.text);
        bytes
    }

    #[test]
    fn inserted_entries_are_parsed_from_their_section() {
        let bytes = section();
        let note = BuildFingerprint::parse(text_in(&bytes, true).unwrap()).unwrap();
        assert_eq!((note.module(), note.field("package")), ("eyes", Some("example 0.1.0")));
        assert_eq!(BuildFingerprint::own().differences(&note), []);
        assert!(note.field("compiler").unwrap().starts_with("rustc "), "{note}");
        assert_eq!(note.field("lock").unwrap().len(), 16, "{note}");
    }

    #[test]
    fn notes_of_others_are_passed_over() {
        let other = [&4_u32.to_le_bytes()[..], &2_u32.to_le_bytes(), &1_u32.to_le_bytes(), b"GNU\0ab\0\0"];
        let bytes = [other.concat(), section()].concat();
        assert!(text_in(&bytes, true).unwrap().contains("module eyes"));
        assert_eq!(text_in(&other.concat(), true), Err("its note is another's".into()));
    }

    #[test]
    fn truncated_packets_and_wrong_lengths_are_rejected() {
        let bytes = section();
        for length in 1..bytes.len() - 3 {
            assert!(text_in(&bytes[..length], true).is_err(), "{length}");
        }
        let mut lying = bytes;
        lying[4..8].fill(0xff);
        assert_eq!(text_in(&lying, true), Err("its note is cut off".into()));
    }

    #[test]
    fn each_field_that_differs_is_named_with_both_values() {
        let own = BuildFingerprint::own();
        let text = own.to_string();
        assert!(text.starts_with("format    1\ncompiler  rustc "), "{text}");
        let other = BUILD.replace("format 1", "format 2").replace("\nlock ", "\nlock 0");
        let found = BuildFingerprint { fields: fields(&other).unwrap() };
        let differences = own.differences(&found);
        let names: Vec<&str> = differences.iter().map(|one| one.field.as_str()).collect();
        assert_eq!(names, ["format", "lock"]);
        assert_eq!((differences[0].expected.as_str(), differences[0].found.as_str()), ("1", "2"));
    }

    #[test]
    fn a_module_has_a_name_that_symbols_can_have() {
        for module in ["", "module \n", "module a-b\n", "module a/b\n", "no line\n\n"] {
            assert!(BuildFingerprint::parse(&format!("{BUILD}{module}")).is_err(), "{module}");
        }
    }
}
