//! A folder of recordings, of which the newest are kept.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::tape_file::TapeFile;

/// The extension of recordings.
const EXTENSION: &str = "mcap";

/// The limits of the recordings that a [`RecordingFolder`] keeps.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RecordingLimits {
    /// The most recordings.
    pub count: usize,
    /// The most bytes of all recordings together.
    pub bytes: u64,
}

/// A folder with one recording for each run of a robot.
///
/// A recording is named by its number and its run: `0007-goalie-2026-03-01T14-00-07Z.mcap`. The
/// number grows by one with each recording and decides which one is older, because the clock of a
/// robot may be wrong. The oldest recordings are removed when there are too many or when they are
/// too large; neither the one that is being written is, nor one that another process is writing.
#[derive(Clone, Debug)]
pub struct RecordingFolder {
    path: PathBuf,
    limits: RecordingLimits,
}

/// A recording in the folder.
struct StoredRecording {
    number: u64,
    path: PathBuf,
    bytes: u64,
}

impl RecordingFolder {
    /// The folder at `path`, which is created with the first recording.
    pub fn new(path: impl Into<PathBuf>, limits: RecordingLimits) -> RecordingFolder {
        RecordingFolder { path: path.into(), limits }
    }

    /// Creates the file for the recording of a run, which is named by its name and its time, and
    /// removes the oldest recordings.
    ///
    /// # Errors
    /// The file cannot be created.
    pub fn create(&self, run: &str) -> Result<TapeFile, Error> {
        let failed = |error: io::Error| Error::file(&self.path, error);
        fs::create_dir_all(&self.path).map_err(failed)?;
        let stored = self.stored().map_err(failed)?;
        let number = stored.last().map_or(1, |newest| newest.number.saturating_add(1));
        let path = self.path.join(format!("{number:04}-{run}.{EXTENSION}"));
        let file = TapeFile::in_folder(&path, self.clone())?;
        self.remove_oldest(file.path());
        Ok(file)
    }

    /// Removes the oldest recordings beyond the limits, except the one at `current`. Recordings
    /// that cannot be removed are logged and stay.
    pub(crate) fn remove_oldest(&self, current: &Path) {
        let Ok(stored) = self.stored() else { return };
        let mut count = stored.len();
        let mut bytes: u64 = stored.iter().map(|one| one.bytes).sum();
        for oldest in stored {
            if count <= self.limits.count && bytes <= self.limits.bytes {
                return;
            }
            if oldest.path == current || is_live(&oldest.path) {
                continue;
            }
            match fs::remove_file(&oldest.path) {
                Ok(()) => {
                    tracing::info!("removed the oldest recording {}", oldest.path.display());
                    count -= 1;
                    bytes -= oldest.bytes;
                }
                Err(error) => {
                    tracing::warn!("cannot remove the recording {}: {error}", oldest.path.display());
                }
            }
        }
    }

    /// The recordings, oldest first. Files with other names are not touched.
    fn stored(&self) -> io::Result<Vec<StoredRecording>> {
        let mut stored = Vec::new();
        for entry in fs::read_dir(&self.path)? {
            let entry = entry?;
            let path = entry.path();
            if let Some(number) = number_of(&path)
                && let Ok(there) = entry.metadata()
                && there.is_file()
            {
                stored.push(StoredRecording { number, path, bytes: there.len() });
            }
        }
        stored.sort_unstable_by(|one, other| (one.number, &one.path).cmp(&(other.number, &other.path)));
        Ok(stored)
    }
}

/// The number in the name of a recording.
fn number_of(path: &Path) -> Option<u64> {
    if path.extension()? != EXTENSION {
        return None;
    }
    let (number, _) = path.file_stem()?.to_str()?.split_once('-')?;
    number.parse().ok()
}

/// Whether a process is writing the file.
fn is_live(path: &Path) -> bool {
    File::open(path).is_ok_and(|file| matches!(file.try_lock_shared(), Err(fs::TryLockError::WouldBlock)))
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
    fn recordings_are_named_by_number_and_run_and_the_oldest_go_first() {
        let folder = tempfile::tempdir().unwrap();
        let recordings =
            RecordingFolder::new(folder.path().join("r"), RecordingLimits { count: 2, bytes: 1000 });
        for _ in 0..3 {
            drop(recordings.create("goalie-2026-03-01T14-00-07Z").unwrap());
        }
        // The clock of this run is wrong.
        drop(recordings.create("goalie-1970-01-01T00-00-00Z").unwrap());
        assert_eq!(
            names(&folder.path().join("r")),
            ["0003-goalie-2026-03-01T14-00-07Z.mcap", "0004-goalie-1970-01-01T00-00-00Z.mcap"]
        );
    }

    #[test]
    fn size_counts_too_and_what_is_written_or_no_recording_stays() {
        let folder = tempfile::tempdir().unwrap();
        let recordings = RecordingFolder::new(folder.path(), RecordingLimits { count: 9, bytes: 100 });
        let at = |name: &str| folder.path().join(name);
        let live = recordings.create("a").unwrap();
        fs::write(live.path(), [0; 60]).unwrap();
        fs::write(at("0002-b.mcap"), [0; 60]).unwrap();
        fs::write(at("0003-c.mcap"), [0; 60]).unwrap();
        for other in ["notes.txt", "mine.mcap"] {
            fs::write(at(other), [0; 200]).unwrap();
        }
        let current = recordings.create("d").unwrap();
        let name = |file: &TapeFile| file.path().file_name().unwrap().to_string_lossy().into_owned();
        let mut kept = vec![name(&live), name(&current), "notes.txt".into(), "mine.mcap".into()];
        kept.sort_unstable();
        assert_eq!(names(folder.path()), kept);
    }
}
