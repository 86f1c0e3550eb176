//! Whether the content of a module's file is what was built.

use std::fs::OpenOptions;
use std::io::{self, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;

use monas_core::module::note::{self, BuildFingerprint};
use object::{Object, ObjectSection, ObjectSegment};

/// Writes the hash of a module's content into its note, after the build. A file that is sealed
/// already stays as it is.
///
/// # Errors
/// The file cannot be read or written, or has no note with a place for the hash.
pub fn seal(path: impl AsRef<Path>) -> io::Result<()> {
    let bytes = std::fs::read(&path)?;
    let span = hash_range(&bytes).ok_or_else(|| io::Error::other("its note has no place for a hash"))?;
    let hash = hash(&bytes, &span);
    if bytes[span.clone()] == *hash.as_bytes() {
        return Ok(());
    }
    // In place, since cargo keeps the file under two names.
    let mut file = OpenOptions::new().write(true).open(path)?;
    file.seek(SeekFrom::Start(span.start as u64))?;
    file.write_all(hash.as_bytes())?;
    file.sync_all()
}

/// Checks the parts of a file and, if it is sealed, its hash.
///
/// # Errors
/// A message for people.
pub(crate) fn check(bytes: &[u8], note: &BuildFingerprint) -> Result<(), String> {
    let file = object::File::parse(bytes).map_err(|error| error.to_string().to_lowercase())?;
    let is_outside =
        |(offset, size): (u64, u64)| offset.checked_add(size).is_none_or(|end| end > bytes.len() as u64);
    let segments = file.segments().map(|segment| segment.file_range());
    let sections = file.sections().filter_map(|section| section.file_range());
    if segments.chain(sections).any(is_outside) {
        return Err("it is cut off".into());
    }
    match note.field(note::CONTENT_FIELD) {
        None | Some(note::UNSEALED_CONTENT) => Ok(()),
        Some(expected) => match hash_range(bytes).map(|span| hash(bytes, &span)) {
            Some(found) if found == expected => Ok(()),
            _ => Err("its content is not what was built".into()),
        },
    }
}

/// The position at which the note of a file states the hash of its content.
fn hash_range(bytes: &[u8]) -> Option<Range<usize>> {
    let file = object::File::parse(bytes).ok()?;
    let (offset, size) = file.section_by_name(note::SECTION)?.file_range()?;
    let offset = usize::try_from(offset).ok()?;
    let section = bytes.get(offset..)?.get(..usize::try_from(size).ok()?)?;
    let field = format!("\n{} ", note::CONTENT_FIELD);
    let found = section.windows(field.len()).position(|window| window == field.as_bytes())?;
    let start = offset + found + field.len();
    let span = start..start + note::UNSEALED_CONTENT.len();
    bytes.get(span.clone())?.iter().all(u8::is_ascii_hexdigit).then_some(span)
}

/// The hash of a file whose own place counts as unsealed.
fn hash(bytes: &[u8], index: &Range<usize>) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&bytes[..index.start]);
    hasher.update(note::UNSEALED_CONTENT.as_bytes());
    hasher.update(&bytes[index.end..]);
    hasher.finalize().to_hex().to_string()
}
