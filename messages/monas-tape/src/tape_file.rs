//! The files of a tape.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use monas_files::{ExclusiveFile, ExistingFile};

use crate::error::Error;
use crate::recording_folder::RecordingFolder;

/// The output of a recorder.
pub(crate) type Output = Box<dyn Write + Send>;

/// The outputs of a tape: one, and after a failure further ones.
pub(crate) trait TapeStorage: Send {
    /// Opens the next output; none if there is only one.
    fn open_next(&mut self) -> io::Result<Option<Output>>;

    /// Removes the present output, which has no message.
    fn discard(&mut self);

    /// Called from time to time while the tape is written.
    fn limit(&mut self);

    /// The file of the present output.
    fn path(&self) -> Option<&Path>;
}

/// A new file for a [`Tape`](crate::Tape), which this process alone writes.
///
/// If it cannot be written any more, for example since the disk is full, the tape continues in the
/// next file when there is room: `run-2.mcap`.
#[derive(Debug)]
pub struct TapeFile {
    /// `None` after it was opened.
    file: Option<ExclusiveFile>,
    requested: PathBuf,
    path: PathBuf,
    folder: Option<RecordingFolder>,
}

impl TapeFile {
    /// Creates the file at `path`. If it exists, `existing` decides what happens.
    ///
    /// # Errors
    /// The file cannot be created, or it is to be replaced while another process is writing it.
    pub fn create(path: impl AsRef<Path>, existing: ExistingFile) -> Result<TapeFile, Error> {
        let requested = path.as_ref();
        let file =
            ExclusiveFile::create(requested, existing).map_err(|error| Error::file(requested, error))?;
        let path = file.path().to_path_buf();
        Ok(TapeFile { file: Some(file), requested: requested.to_path_buf(), path, folder: None })
    }

    /// The same in a folder of recordings, whose oldest ones are removed while the tape is written.
    pub(crate) fn in_folder(path: &Path, folder: RecordingFolder) -> Result<TapeFile, Error> {
        let file = TapeFile::create(path, ExistingFile::Keep)?;
        Ok(TapeFile { folder: Some(folder), ..file })
    }

    /// The path of the file; it differs from the requested one if that exists.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl TapeStorage for TapeFile {
    fn open_next(&mut self) -> io::Result<Option<Output>> {
        let file = match self.file.take() {
            Some(file) => file,
            None => ExclusiveFile::create(&self.requested, ExistingFile::Keep)?,
        };
        self.path = file.path().to_path_buf();
        Ok(Some(Box::new(BufWriter::new(file))))
    }

    fn discard(&mut self) {
        if fs::metadata(&self.path).is_ok_and(|there| there.is_file()) {
            // A file that stays is an empty tape.
            let _ = fs::remove_file(&self.path);
        }
    }

    fn limit(&mut self) {
        if let Some(folder) = &self.folder {
            folder.remove_oldest(&self.path);
        }
    }

    fn path(&self) -> Option<&Path> {
        Some(&self.path)
    }
}

/// The only output of a tape.
pub(crate) struct SingleOutput(pub(crate) Option<Output>);

impl TapeStorage for SingleOutput {
    fn open_next(&mut self) -> io::Result<Option<Output>> {
        Ok(self.0.take())
    }

    fn discard(&mut self) {}

    fn limit(&mut self) {}

    fn path(&self) -> Option<&Path> {
        None
    }
}
