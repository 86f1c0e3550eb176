//! Replaces a file in one step.

use std::ffi::OsString;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// The longest chain of symbolic links that is followed.
const MAX_LINKS: usize = 40;

/// Distinguishes the drafts of this process.
static DRAFTS: AtomicU64 = AtomicU64::new(0);

/// Replaces the content of the file at `path` with `content`, or leaves it unchanged: see
/// [`AtomicFile`].
///
/// # Errors
/// The file cannot be written; then it is unchanged.
pub fn write(path: impl AsRef<Path>, content: impl AsRef<[u8]>) -> io::Result<()> {
    let mut file = AtomicFile::create(path)?;
    file.write_all(content.as_ref())?;
    file.commit()
}

/// Creates the file at `path` with `content`. Of several writers at once, one succeeds.
///
/// # Errors
/// The file exists ([`io::ErrorKind::AlreadyExists`]) or cannot be written; then it is not created.
pub fn write_new(path: impl AsRef<Path>, content: impl AsRef<[u8]>) -> io::Result<()> {
    let path = path.as_ref();
    let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
    let written = file.write_all(content.as_ref()).and_then(|()| file.sync_all());
    if written.is_err() {
        // A partly written file is of no use.
        let _ = fs::remove_file(path);
    }
    written
}

/// A file that replaces another one when it is complete.
///
/// The content is written to a draft in the same folder, passed to the disk, and renamed by
/// [`commit`](AtomicFile::commit). Dropped before, the draft is deleted and the old file stays. On
/// Linux the draft has no name before it is complete, where the file system supports it, so that a
/// killed process leaves nothing behind. The new file has the mode of the old one and, where the
/// system permits it, its owner and group; a symbolic link stays a link, and the file that it
/// points to is replaced. Other hard links keep the old content. Terminals, pipes and devices have
/// no content to protect and are written directly.
#[derive(Debug)]
pub struct AtomicFile {
    output: BufWriter<File>,
    /// `None` if the output is not a regular file.
    draft: Option<Draft>,
}

/// A file that is deleted unless it is renamed.
#[derive(Debug)]
struct Draft {
    /// `None` while the file has no name.
    path: Option<PathBuf>,
    target: PathBuf,
}

impl AtomicFile {
    /// Creates the draft of the file at `path`.
    ///
    /// # Errors
    /// The folder takes no file, or `path` cannot be written.
    pub fn create(path: impl AsRef<Path>) -> io::Result<AtomicFile> {
        let target = resolved(path.as_ref())?;
        let replaced = match fs::metadata(&target) {
            Ok(there) if there.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
            Ok(there) if !there.is_file() => {
                let output = BufWriter::new(OpenOptions::new().write(true).open(&target)?);
                return Ok(AtomicFile { output, draft: None });
            }
            Ok(there) => Some(there),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        if let Some(there) = &replaced
            && there.permissions().readonly()
        {
            // A rename would replace a read-only file too.
            OpenOptions::new().write(true).open(&target)?;
        }
        let (file, path) = draft(&target)?;
        let draft = Draft { path, target };
        if let Some(there) = &replaced {
            adopt(&file, there)?;
        }
        Ok(AtomicFile { output: BufWriter::new(file), draft: Some(draft) })
    }

    /// Passes the content to the disk and replaces the file.
    ///
    /// # Errors
    /// The content cannot be written; then the old file is unchanged.
    pub fn commit(mut self) -> io::Result<()> {
        self.output.flush()?;
        let Some(mut draft) = self.draft.take() else { return Ok(()) };
        let file = self.output.get_ref();
        file.sync_all()?;
        let path = match draft.path.take() {
            Some(path) => path,
            None => unnamed::name(file, &draft.target)?,
        };
        // From here on the draft is deleted unless it is renamed.
        let path = draft.path.insert(path);
        fs::rename(path, &draft.target)?;
        sync_folder(&draft.target)
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.output.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.output.flush()
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        // After success it has been renamed.
        let _ = self.path.take().map(fs::remove_file);
    }
}

/// The file that a chain of symbolic links leads to; it need not exist.
fn resolved(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_path_buf();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&path) {
            Ok(next) => path = folder_of(&path).join(next),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other(format!("{}: too many symbolic links", path.display())))
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Creates a new file in the folder of `target`: without a name if possible, otherwise with one
/// that no other draft has.
fn draft(target: &Path) -> io::Result<(File, Option<PathBuf>)> {
    if let Some(file) = unnamed::create(folder_of(target)) {
        return Ok((file, None));
    }
    let open = |path: &Path| OpenOptions::new().write(true).create_new(true).open(path);
    named(target, open).map(|(file, path)| (file, Some(path)))
}

/// Creates something beside `target` by `create`, with a name that no other draft has.
fn named<T>(target: &Path, create: impl Fn(&Path) -> io::Result<T>) -> io::Result<(T, PathBuf)> {
    let name = target.file_name().ok_or(io::ErrorKind::InvalidInput)?;
    loop {
        let number = DRAFTS.fetch_add(1, Ordering::Relaxed);
        let mut hidden = OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{}-{number}.part", std::process::id()));
        let path = folder_of(target).join(hidden);
        match create(&path) {
            Ok(created) => return Ok((created, path)),
            // Left by a killed process that had this number.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

/// Files without a name, which the system deletes with the process.
#[cfg(target_os = "linux")]
mod unnamed {
    use std::fs::File;
    use std::io;
    use std::os::fd::AsRawFd;
    use std::path::{Path, PathBuf};

    use rustix::fs::{AtFlags, CWD, Mode, OFlags};

    /// A file in a folder; `None` if the file system has no such files, or they could not be named.
    pub(super) fn create(folder: &Path) -> Option<File> {
        let flags = OFlags::WRONLY | OFlags::TMPFILE | OFlags::CLOEXEC;
        let file = File::from(rustix::fs::open(folder, flags, Mode::from_raw_mode(0o666)).ok()?);
        link(&file).symlink_metadata().is_ok().then_some(file)
    }

    /// Gives the file a name beside `target`.
    pub(super) fn name(file: &File, target: &Path) -> io::Result<PathBuf> {
        let give = |path: &Path| Ok(rustix::fs::linkat(CWD, link(file), CWD, path, AtFlags::SYMLINK_FOLLOW)?);
        Ok(super::named(target, give)?.1)
    }

    /// The link to the file by which it can be named without privileges.
    fn link(file: &File) -> PathBuf {
        PathBuf::from(format!("/proc/self/fd/{}", file.as_raw_fd()))
    }
}

#[cfg(not(target_os = "linux"))]
mod unnamed {
    use std::fs::File;
    use std::io;
    use std::path::{Path, PathBuf};

    pub(super) fn create(_: &Path) -> Option<File> {
        None
    }

    pub(super) fn name(_: &File, _: &Path) -> io::Result<PathBuf> {
        Err(io::ErrorKind::Unsupported.into())
    }
}

/// Gives the draft the owner and mode of the replaced file.
#[cfg(unix)]
fn adopt(draft: &File, replaced: &Metadata) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};

    let own = draft.metadata()?;
    if (own.uid(), own.gid()) != (replaced.uid(), replaced.gid()) {
        // Only root may give a file away; the content is what was requested, and the mode below
        // never has a set-user-ID bit.
        let _ = fchown(draft, Some(replaced.uid()), Some(replaced.gid()))
            .or_else(|_| fchown(draft, None, Some(replaced.gid())));
    }
    draft.set_permissions(fs::Permissions::from_mode(replaced.permissions().mode() & 0o777))
}

#[cfg(not(unix))]
fn adopt(draft: &File, replaced: &Metadata) -> io::Result<()> {
    draft.set_permissions(replaced.permissions())
}

/// Passes the renaming itself to the disk.
#[cfg(unix)]
fn sync_folder(target: &Path) -> io::Result<()> {
    match File::open(folder_of(target)).and_then(|folder| folder.sync_all()) {
        // Some file systems do not support it, and a folder may not be readable.
        Err(error)
            if matches!(error.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::PermissionDenied) =>
        {
            Ok(())
        }
        done => done,
    }
}

#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
        let mut names: Vec<String> = entries.map(|name| name.to_string_lossy().into_owned()).collect();
        names.sort_unstable();
        names
    }

    #[test]
    fn a_file_is_replaced_only_when_it_is_complete() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("role.srm");
        fs::write(&path, "old").unwrap();
        let mut file = AtomicFile::create(&path).unwrap();
        file.write_all(b"half of the new").unwrap();
        file.flush().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        drop(file);
        assert_eq!((fs::read_to_string(&path).unwrap().as_str(), names(folder.path()).len()), ("old", 1));
        write(&path, "new").unwrap();
        assert_eq!((fs::read_to_string(&path).unwrap().as_str(), names(folder.path()).len()), ("new", 1));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_killed_process_leaves_no_draft() {
        let folder = tempfile::tempdir().unwrap();
        if unnamed::create(folder.path()).is_none() {
            println!("SKIPPED: this file system has no files without a name");
            return;
        }
        let path = folder.path().join("cut.mcap");
        fs::write(&path, "old").unwrap();
        let mut file = AtomicFile::create(&path).unwrap();
        file.write_all(b"half of the new").unwrap();
        file.flush().unwrap();
        // A killed process drops nothing.
        std::mem::forget(file);
        assert_eq!(
            (names(folder.path()), fs::read_to_string(&path).unwrap()),
            (vec!["cut.mcap".into()], "old".into())
        );
    }

    #[test]
    #[cfg(unix)]
    fn mode_and_symbolic_link_stay() {
        use std::os::unix::fs::{PermissionsExt, symlink};

        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("models")).unwrap();
        fs::write(at("models/role.srm"), "old").unwrap();
        fs::set_permissions(at("models/role.srm"), fs::Permissions::from_mode(0o640)).unwrap();
        symlink("models/role.srm", at("first")).unwrap();
        symlink("first", at("second")).unwrap();
        write(at("second"), "new").unwrap();
        assert_eq!(fs::read_link(at("second")).unwrap(), Path::new("first"));
        assert_eq!(fs::read_to_string(at("models/role.srm")).unwrap(), "new");
        assert_eq!(fs::metadata(at("models/role.srm")).unwrap().permissions().mode() & 0o7777, 0o640);
        assert_eq!(names(&at("models")), ["role.srm"]);
        symlink("models/none.srm", at("dangling")).unwrap();
        write(at("dangling"), "created").unwrap();
        assert_eq!(fs::read_to_string(at("models/none.srm")).unwrap(), "created");
        symlink("around", at("around")).unwrap();
        assert!(write(at("around"), "never").is_err());
    }

    #[test]
    #[cfg(unix)]
    fn pipes_and_devices_are_written_directly() {
        write("/dev/null", "gone").unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }

    #[test]
    fn what_cannot_be_written_says_so() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(write(folder.path(), "x").unwrap_err().kind(), io::ErrorKind::IsADirectory);
        let missing = folder.path().join("no/role.srm");
        assert_eq!(write(missing, "x").unwrap_err().kind(), io::ErrorKind::NotFound);
    }

    #[test]
    fn of_many_creators_at_once_one_succeeds() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("vision.rs");
        let created = std::thread::scope(|threads| {
            let path = &path;
            let creators: Vec<_> = (0..30).map(|_| threads.spawn(move || write_new(path, "new"))).collect();
            creators.into_iter().map(|one| one.join().unwrap()).collect::<Vec<_>>()
        });
        assert_eq!(created.iter().filter(|one| one.is_ok()).count(), 1);
        let mut refused = created.into_iter().filter_map(Result::err);
        assert!(refused.all(|error| error.kind() == io::ErrorKind::AlreadyExists));
    }

    /// Each writer's content is there as a whole at some time, and nothing else is left.
    #[test]
    fn of_many_writers_at_once_each_succeeds() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("agents.xml");
        std::thread::scope(|threads| {
            let writers: Vec<_> = (0..30_u8)
                .map(|number| {
                    let path = &path;
                    threads.spawn(move || write(path, vec![number; 20_000]))
                })
                .collect();
            writers.into_iter().for_each(|writer| writer.join().unwrap().unwrap());
        });
        let content = fs::read(&path).unwrap();
        assert!(content.len() == 20_000 && content.iter().all(|byte| *byte == content[0]));
        assert_eq!(names(folder.path()), ["agents.xml"]);
    }
}
