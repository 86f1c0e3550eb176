//! Files named by a file.

use std::fs;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, OnceLock};

use yase::diagnostic::nearest;
use yase::{Diagnostic, Source};

/// The largest file that is read, in bytes, unless [`MAX_SIZE_VARIABLE`] says another number.
const DEFAULT_MAX_SIZE: u64 = 64 << 20;

/// The environment variable with the size of the largest file that is read, in MiB.
const MAX_SIZE_VARIABLE: &str = "MONAS_DOCUMENT_LIMIT";

/// The name of standard input in diagnostics.
pub(crate) const STANDARD_INPUT: &str = "<stdin>";

/// Whether a path means standard input.
pub(crate) fn is_standard_input(path: &Path) -> bool {
    path == Path::new("-")
}

/// The name of a file in messages: its path as given, `<stdin>` for standard input.
pub fn shown_name(path: &Path) -> String {
    match is_standard_input(path) {
        true => STANDARD_INPUT.to_owned(),
        false => path.display().to_string(),
    }
}

/// The text of a file; that of standard input for the path `-`, which is read once.
///
/// # Errors
/// A diagnostic that names the file. Files of more than 64 MiB, or what the environment variable
/// `MONAS_DOCUMENT_LIMIT` says in MiB, are refused (E0317).
pub fn read(path: &Path) -> Result<Arc<Source>, Box<Diagnostic>> {
    let set = std::env::var(MAX_SIZE_VARIABLE).ok().and_then(|text| text.parse().ok());
    let largest = set.map_or(DEFAULT_MAX_SIZE, |mebibytes: u64| mebibytes.saturating_mul(1 << 20));
    // A process has one standard input, and reads a configuration more than once.
    static TEXT: OnceLock<Result<Arc<Source>, Box<Diagnostic>>> = OnceLock::new();
    match is_standard_input(path) {
        true => TEXT.get_or_init(|| read_up_to(path, largest)).clone(),
        false => read_up_to(path, largest),
    }
}

fn read_up_to(path: &Path, largest: u64) -> Result<Arc<Source>, Box<Diagnostic>> {
    let name = shown_name(path);
    let content = match is_standard_input(path) {
        true => bytes_of(io::stdin(), largest),
        false => fs::File::open(path).and_then(|file| bytes_of(file, largest)),
    };
    match content {
        Ok(bytes) if bytes.len() as u64 > largest => {
            let message = format!("`{name}` has more than {} MiB", largest >> 20);
            let hint = format!("set the environment variable {MAX_SIZE_VARIABLE} to a larger number of MiB");
            Err(Box::new(unreadable("E0317", &name, message).with_hint(hint)))
        }
        Ok(bytes) => match String::from_utf8(bytes) {
            Ok(text) => Ok(Source::new(name, text)),
            Err(error) => {
                let at = error.utf8_error().valid_up_to();
                Err(unreadable("E0317", &name, format!("`{name}` is not UTF-8 text at byte {at}")))
            }
        },
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let diagnostic = unreadable("E0316", &name, format!("no file `{name}`"));
            Err(match neighbour(path).or_else(|| in_folder_above(path)) {
                Some(found) => Box::new(diagnostic.with_hint(format!("did you mean `{}`?", found.display()))),
                None => diagnostic,
            })
        }
        Err(_) if path.is_dir() => {
            let diagnostic = unreadable("E0317", &name, format!("`{name}` is a folder, not a file"));
            Err(match files_in(path).into_iter().next() {
                Some(file) => Box::new(
                    diagnostic
                        .with_hint(format!("name a file in it, for example `{}`", path.join(file).display())),
                ),
                None => diagnostic,
            })
        }
        Err(error) => Err(unreadable("E0317", &name, format!("`{name}` cannot be read: {error}"))),
    }
}

/// The content, up to one byte more than is allowed.
fn bytes_of(from: impl Read, largest: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    from.take(largest.saturating_add(1)).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn unreadable(code: &'static str, name: &str, message: String) -> Box<Diagnostic> {
    Box::new(Diagnostic::error(code, 0..0, message).in_source(&Source::new(name, "")))
}

/// Resolves `named` in a file at `path`: in the folder of that file, then in each parent folder, so
/// that the files of a project name each other from the project's root independent of the working
/// directory.
///
/// A folder of this name is found if there is no file: reading it says that it is a folder.
///
/// # Errors
/// The path of a file with a similar name, if there is one.
pub fn locate(path: &Path, named: &str) -> Result<PathBuf, Option<String>> {
    let working_folder = std::env::current_dir().unwrap_or_default();
    let candidates: Vec<PathBuf> =
        folders_of(path, &working_folder).into_iter().map(|folder| folder.join(named)).collect();
    let folder = || candidates.iter().find(|candidate| !named.is_empty() && candidate.is_dir());
    match candidates.iter().find(|candidate| candidate.is_file()).or_else(folder) {
        Some(found) => Ok(found.clone()),
        None => {
            let near = candidates.iter().find_map(|candidate| neighbour(candidate));
            let name = near.and_then(|near| near.file_name().map(|name| name.to_string_lossy().into_owned()));
            Err(name.map(|name| Path::new(named).with_file_name(name).display().to_string()))
        }
    }
}

/// The folder of a file and all parents of that folder, the innermost first. For a relative path,
/// those above the working folder are `..`, `../..` and so on.
fn folders_of(path: &Path, working_folder: &Path) -> Vec<PathBuf> {
    let mut folders: Vec<PathBuf> = path.ancestors().skip(1).map(Path::to_owned).collect();
    if path.is_relative() {
        let upwards = path.components().take_while(|part| *part == Component::ParentDir).count();
        // The rest of `../..` without its last part is no parent of it.
        folders.truncate(folders.len().saturating_sub(upwards));
        let depth = working_folder.ancestors().skip(1).count();
        let above = (upwards + 1..=depth).map(|parents| PathBuf::from_iter(vec![".."; parents]));
        folders.extend(above);
    }
    folders
}

/// The file in the same folder with the most similar name.
fn neighbour(path: &Path) -> Option<PathBuf> {
    let name = path.file_name()?.to_str()?;
    let folder = path.parent()?;
    let listed = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let names = files_in(listed);
    nearest(name, names.iter().map(String::as_str)).map(|found| folder.join(found))
}

/// The same path from the nearest folder above the working directory that has such a file: commands
/// are often typed in a folder of a project that names its files from its root.
fn in_folder_above(path: &Path) -> Option<PathBuf> {
    let depth = std::env::current_dir().ok()?.ancestors().count();
    let above = std::iter::successors(Some(PathBuf::from("..")), |folder| Some(folder.join("..")));
    let mut found = above.take(depth.saturating_sub(1)).map(|folder| folder.join(path));
    if path.is_relative() { found.find(|path| path.is_file()) } else { None }
}

/// The names of the files in a folder, sorted: the order of a directory listing is unspecified.
fn files_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let files = entries.filter(|entry| entry.path().is_file());
    let mut names: Vec<String> = files.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort_unstable();
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_parents_of_a_file_are_searched() {
        let folders = |path: &str, working_folder: &str| -> Vec<String> {
            let folders = folders_of(Path::new(path), Path::new(working_folder));
            folders.iter().map(|folder| folder.display().to_string()).collect()
        };
        assert_eq!(folders("/p/config/m.xml", "/elsewhere"), ["/p/config", "/p", "/"]);
        assert_eq!(folders("config/roles/r.xml", "/p"), ["config/roles", "config", "", ".."]);
        assert_eq!(folders("m.xml", "/p/config"), ["", "..", "../.."]);
        assert_eq!(folders("../models/m.srm", "/p/config"), ["../models", "..", "../.."]);
        assert_eq!(folders("../../m.srm", "/a/b/c"), ["../..", "../../.."]);
    }

    #[test]
    fn a_file_that_is_too_large_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large.srm");
        fs::write(&path, "r = A").unwrap();
        assert_eq!(read_up_to(&path, 5).unwrap().text, "r = A");
        let refused = read_up_to(&path, 4).unwrap_err();
        assert_eq!(refused.code, "E0317");
        assert!(refused.hint.as_deref().unwrap_or_default().contains(MAX_SIZE_VARIABLE));
    }
}
