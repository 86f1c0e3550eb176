//! A file that one process writes.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The largest number in the name of a file.
const LARGEST_NUMBER: u32 = 999_999;

/// The treatment of an existing file with the requested name.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum ExistingFile {
    /// It stays; the new file gets the next free name: `run-2.mcap`.
    #[default]
    Keep,
    /// It is replaced, unless another process is writing it.
    Replace,
}

/// A file that this process alone writes, at its end.
///
/// It was created by this process or locked before it was truncated. The lock ends with the file or
/// with the process. Readers are not hindered on Unix. Terminals, pipes and devices are opened
/// without a lock.
#[derive(Debug)]
pub struct ExclusiveFile {
    file: File,
    path: PathBuf,
}

impl ExclusiveFile {
    /// Creates the file at `path`, or one with a number in its name if that exists.
    ///
    /// # Errors
    /// The file cannot be created, or it is to be replaced and another process is writing it
    /// ([`io::ErrorKind::ResourceBusy`]).
    pub fn create(path: impl AsRef<Path>, existing: ExistingFile) -> io::Result<ExclusiveFile> {
        let path = path.as_ref();
        match existing {
            ExistingFile::Keep => ExclusiveFile::next_free(path),
            ExistingFile::Replace => ExclusiveFile::replace(path),
        }
    }

    fn next_free(path: &Path) -> io::Result<ExclusiveFile> {
        for number in 1..=LARGEST_NUMBER {
            let path = numbered(path, number);
            match OpenOptions::new().append(true).create_new(true).open(&path) {
                // Another process that replaces files may have been faster.
                Ok(file) if is_locked(&file)? => return Ok(ExclusiveFile { file, path }),
                Ok(_) => {}
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    if number == 1 && is_special(&path) {
                        let file = OpenOptions::new().append(true).open(&path)?;
                        return Ok(ExclusiveFile { file, path });
                    }
                }
                Err(error) => return Err(error),
            }
        }
        Err(io::ErrorKind::AlreadyExists.into())
    }

    fn replace(path: &Path) -> io::Result<ExclusiveFile> {
        let file = OpenOptions::new().append(true).create(true).open(path)?;
        if !is_special(path) {
            if !is_locked(&file)? {
                return Err(io::Error::new(io::ErrorKind::ResourceBusy, "another process is writing it"));
            }
            file.set_len(0)?;
        }
        Ok(ExclusiveFile { file, path: path.to_path_buf() })
    }

    /// The path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file, for several writers in this process: each write appends in one step.
    pub fn file(&self) -> &File {
        &self.file
    }
}

impl Write for ExclusiveFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// The path itself for 1, and `run-2.mcap`, `run-3.mcap` for the next ones.
pub fn numbered(path: &Path, number: u32) -> PathBuf {
    if number <= 1 {
        return path.to_path_buf();
    }
    let mut name = path.file_stem().map(OsString::from).unwrap_or_default();
    name.push(format!("-{number}"));
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

/// Locks a file; `false` if another process has locked it. A file system without locks cannot tell,
/// and the file was created exclusively.
fn is_locked(file: &File) -> io::Result<bool> {
    match file.try_lock() {
        Ok(()) => Ok(true),
        Err(TryLockError::WouldBlock) => Ok(false),
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(true),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

/// Whether something is there that is neither a regular file nor a folder.
fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_existing_file_is_left_alone_and_the_next_name_is_taken() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.mcap");
        fs::write(&path, "evidence").unwrap();
        let mut second = ExclusiveFile::create(&path, ExistingFile::Keep).unwrap();
        second.write_all(b"more").unwrap();
        let third = ExclusiveFile::create(&path, ExistingFile::Keep).unwrap();
        assert_eq!(second.path(), folder.path().join("run-2.mcap"));
        assert_eq!(third.path(), folder.path().join("run-3.mcap"));
        assert_eq!(fs::read_to_string(&path).unwrap(), "evidence");
        assert_eq!(fs::read_to_string(second.path()).unwrap(), "more");
    }

    #[test]
    fn what_is_being_written_is_not_replaced_and_what_is_finished_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.mcap");
        let mut live = ExclusiveFile::create(&path, ExistingFile::Keep).unwrap();
        live.write_all(b"live").unwrap();
        let busy = ExclusiveFile::create(&path, ExistingFile::Replace).unwrap_err();
        assert_eq!(busy.kind(), io::ErrorKind::ResourceBusy);
        assert_eq!(fs::read_to_string(&path).unwrap(), "live");
        drop(live);
        let replaced = ExclusiveFile::create(&path, ExistingFile::Replace).unwrap();
        assert_eq!((replaced.path(), fs::read_to_string(&path).unwrap().as_str()), (path.as_path(), ""));
    }

    #[test]
    #[cfg(unix)]
    fn a_device_is_no_file_to_keep() {
        for existing in [ExistingFile::Keep, ExistingFile::Replace] {
            let file = ExclusiveFile::create("/dev/null", existing).unwrap();
            assert_eq!(file.path(), Path::new("/dev/null"));
        }
    }

    #[test]
    fn numbers_come_before_the_extension() {
        let name = |path: &str, number| numbered(Path::new(path), number).display().to_string();
        assert_eq!(name("a/run.mcap", 1), "a/run.mcap");
        assert_eq!(name("a/run.mcap", 2), "a/run-2.mcap");
        assert_eq!(name("run", 3), "run-3");
    }
}
