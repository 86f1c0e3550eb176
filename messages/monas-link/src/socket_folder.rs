//! The folder of sockets, which only its owner can access.

use std::fs::{File, OpenOptions};
use std::io;
use std::path::Path;

use crate::error::{Error, ErrorKind};

/// The file that is locked while a name is taken.
const LOCK_FILE: &str = ".lock";

/// Creates the folder or checks that it is this user's alone, and locks its names: of two processes
/// that take a name at once, one finds the socket of the other. Dropping the file unlocks them.
pub(crate) fn lock_names(folder: &Path) -> Result<File, Error> {
    let failed =
        |error: io::Error| Error::new(ErrorKind::Connection, format!("{}: {error}", folder.display()));
    monas_files::private_folder(folder)
        .map_err(|error| Error::new(ErrorKind::Connection, error.to_string()))?;
    let path = folder.join(LOCK_FILE);
    let file = OpenOptions::new().create(true).truncate(false).write(true).open(path).map_err(failed)?;
    file.lock().map_err(failed)?;
    Ok(file)
}
