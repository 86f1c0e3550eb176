//! Owner and mode of folders and files that a process relies on.

use std::fs::File;
use std::io;
use std::path::Path;

/// Creates a folder that only its owner can access, or checks that an existing one is such a
/// folder.
///
/// # Errors
/// It cannot be created, belongs to another user, or is open to others
/// ([`io::ErrorKind::PermissionDenied`]).
#[cfg(unix)]
pub fn private_folder(path: &Path) -> io::Result<()> {
    use std::os::unix::fs::DirBuilderExt;

    let failed = |error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", path.display()));
    std::fs::DirBuilder::new().recursive(true).mode(0o700).create(path).map_err(failed)?;
    check_private(path)
}

/// Checks that only this user can access a folder.
///
/// # Errors
/// It does not exist, belongs to another user, or is open to others
/// ([`io::ErrorKind::PermissionDenied`]).
#[cfg(unix)]
pub fn check_private(path: &Path) -> io::Result<()> {
    use std::fs;
    use std::os::unix::fs::MetadataExt;

    // A symbolic link of another user may lead elsewhere at any time.
    for found in [fs::symlink_metadata(path)?, fs::metadata(path)?] {
        if !is_own(found.uid()) {
            return Err(denied(format!("{} belongs to another user", path.display())));
        }
    }
    let mode = fs::metadata(path)?.mode() & 0o777;
    if mode & 0o077 != 0 {
        let path = path.display();
        return Err(denied(format!(
            "{path} is open to other users (mode {mode:o}); `chmod 700 {path}` closes it"
        )));
    }
    Ok(())
}

/// Creates a folder. Owners and modes are those of Unix.
///
/// # Errors
/// It cannot be created.
#[cfg(not(unix))]
pub fn private_folder(path: &Path) -> io::Result<()> {
    std::fs::create_dir_all(path)
}

/// Checks that a folder exists. Owners and modes are those of Unix.
///
/// # Errors
/// It does not exist.
#[cfg(not(unix))]
pub fn check_private(path: &Path) -> io::Result<()> {
    std::fs::metadata(path).map(drop)
}

/// Opens a regular file for reading that only this user or root can change: it belongs to one of
/// them, and neither others nor a group other than the user's own may write it. Never blocks.
///
/// # Errors
/// It cannot be opened, is not a regular file ([`io::ErrorKind::InvalidInput`]), or can be changed
/// by others ([`io::ErrorKind::PermissionDenied`]).
#[cfg(unix)]
pub fn open_trusted(path: &Path) -> io::Result<File> {
    use std::os::unix::fs::MetadataExt;

    use rustix::fs::{Mode, OFlags};

    // Without `NONBLOCK`, opening a pipe waits for its writer.
    let flags = OFlags::RDONLY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let file = File::from(rustix::fs::open(path, flags, Mode::empty())?);
    let found = file.metadata()?;
    if !found.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a regular file"));
    }
    if !is_own(found.uid()) {
        return Err(denied(format!("it belongs to another user (number {})", found.uid())));
    }
    let mode = found.mode() & 0o777;
    let is_open_to_group = mode & 0o020 != 0 && found.gid() != rustix::process::getegid().as_raw();
    if mode & 0o002 != 0 || is_open_to_group {
        return Err(denied(format!("other users may change it (mode {mode:o}); `chmod go-w` closes it")));
    }
    Ok(file)
}

/// Opens a regular file for reading. Owners and modes are those of Unix.
///
/// # Errors
/// It cannot be opened, or is not a regular file.
#[cfg(not(unix))]
pub fn open_trusted(path: &Path) -> io::Result<File> {
    let file = File::open(path)?;
    match file.metadata()?.is_file() {
        true => Ok(file),
        false => Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a regular file")),
    }
}

/// Whether a user is root or the one who runs this process.
#[cfg(unix)]
fn is_own(user: u32) -> bool {
    user == 0 || user == rustix::process::geteuid().as_raw()
}

#[cfg(unix)]
fn denied(reason: String) -> io::Error {
    io::Error::new(io::ErrorKind::PermissionDenied, reason)
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use std::fs::{self, Permissions};
    use std::os::unix::fs::{PermissionsExt, chown, symlink};
    use std::process::Command;

    use super::*;

    fn chmod(path: &Path, mode: u32) {
        fs::set_permissions(path, Permissions::from_mode(mode)).unwrap();
    }

    /// Whether this process may give files away.
    fn is_root() -> bool {
        rustix::process::geteuid().is_root()
    }

    #[test]
    fn a_folder_is_created_for_its_owner_alone_and_an_open_one_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run/monas");
        private_folder(&path).unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o700);
        private_folder(&path).unwrap();
        for mode in [0o755, 0o770, 0o701] {
            chmod(&path, mode);
            let refused = private_folder(&path).unwrap_err();
            assert_eq!(refused.kind(), io::ErrorKind::PermissionDenied, "{mode:o}");
            assert!(refused.to_string().contains("chmod 700"), "{refused}");
        }
    }

    #[test]
    fn a_folder_or_a_link_of_another_user_is_refused() {
        if !is_root() {
            return; // only root can give a folder away
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("monas");
        private_folder(&path).unwrap();
        let link = folder.path().join("link");
        symlink(&path, &link).unwrap();
        private_folder(&link).unwrap();
        std::os::unix::fs::lchown(&link, Some(12345), None).unwrap();
        assert!(private_folder(&link).unwrap_err().to_string().contains("another user"));
        chown(&path, Some(12345), None).unwrap();
        assert!(private_folder(&path).unwrap_err().to_string().contains("another user"));
    }

    #[test]
    fn a_file_that_others_may_change_is_not_trusted() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("eyes.so");
        fs::write(&path, "code").unwrap();
        for mode in [0o600, 0o644, 0o755, 0o775] {
            chmod(&path, mode);
            open_trusted(&path).unwrap();
        }
        for mode in [0o646, 0o777] {
            chmod(&path, mode);
            let refused = open_trusted(&path).unwrap_err();
            assert!(refused.to_string().contains("other users may change it"), "{refused}");
        }
        if is_root() {
            chmod(&path, 0o664);
            chown(&path, None, Some(12345)).unwrap();
            assert_eq!(open_trusted(&path).unwrap_err().kind(), io::ErrorKind::PermissionDenied);
            chmod(&path, 0o644);
            open_trusted(&path).unwrap();
            chown(&path, Some(12345), None).unwrap();
            assert!(open_trusted(&path).unwrap_err().to_string().contains("belongs to another user"));
        }
    }

    #[test]
    fn a_pipe_or_a_folder_is_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for path in [pipe.as_path(), folder.path()] {
            assert_eq!(open_trusted(path).unwrap_err().kind(), io::ErrorKind::InvalidInput);
        }
    }
}
