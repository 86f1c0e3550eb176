//! Metadata of a recording: the run and its files.

use std::collections::BTreeMap;

use monas::{ConfigurationBundle, Timestamp};
use monas_tape::{Error, ErrorKind, Tape};

/// The name of the metadata about a run: `version`, `configuration` (the name of a file in the
/// tape), `configuration_hash`, `time` (`simulated` or `real`), `seed` if time is simulated, and
/// `robots`, the hosts separated by blanks.
pub const RUN: &str = "run";

/// The entry with the command-line settings, one per line; present if there are any.
pub const SETTINGS: &str = "settings";

/// The entry with the folder of the configuration; present if it is relevant: see
/// [`ConfigurationBundle::folder`].
pub const FOLDER: &str = "folder";

/// The name of the metadata about the overrides of a run's robot: `name`, that of the robot;
/// present if there are any.
pub const ROBOT: &str = "robot";

/// The name of the metadata about the end of a run: `nanoseconds`, the end time. Later messages
/// were published while agents were being stopped.
pub const END: &str = "end";

/// Writes the metadata of a run in simulated time.
///
/// # Errors
/// The tape cannot be written.
pub fn label_simulated(
    tape: &Tape,
    files: &ConfigurationBundle,
    settings: &str,
    seed: u64,
    robots: &[String],
) -> Result<(), Error> {
    label(tape, files, settings, robots, &[("time", "simulated".to_owned()), ("seed", seed.to_string())])
}

/// Writes the metadata of a run in real time; `settings` are the command-line settings, one per
/// line.
///
/// # Errors
/// The tape cannot be written.
pub fn label_real_time(
    tape: &Tape,
    files: &ConfigurationBundle,
    settings: &str,
    robots: &[String],
) -> Result<(), Error> {
    label(tape, files, settings, robots, &[("time", "real".to_owned())])
}

fn label(
    tape: &Tape,
    files: &ConfigurationBundle,
    settings: &str,
    robots: &[String],
    more: &[(&str, String)],
) -> Result<(), Error> {
    let set = (!settings.is_empty()).then(|| (SETTINGS, settings.to_owned()));
    let folder = files.folder().map(|folder| (FOLDER, folder.display().to_string()));
    let facts = [
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("configuration", files.root().to_owned()),
        ("configuration_hash", files.hash()),
        ("robots", robots.join(" ")),
    ];
    let facts = facts
        .iter()
        .chain(more)
        .chain(&set)
        .chain(&folder)
        .map(|(key, value)| ((*key).to_owned(), value.clone()));
    tape.describe(RUN, &facts.collect())?;
    files.files().try_for_each(|(name, media_type, content)| tape.attach(name, media_type, content))?;
    // A process that is killed early leaves a tape that names its run.
    match tape.flush() {
        Err(error) if error.kind() == ErrorKind::Finished => Err(error),
        // The tape reports what it cannot write, and the run goes on.
        _ => Ok(()),
    }
}

/// Writes the robot whose overrides the configuration of a run has.
///
/// # Errors
/// The tape cannot be written.
pub fn label_robot(tape: &Tape, name: &str) -> Result<(), Error> {
    tape.describe(ROBOT, &BTreeMap::from([("name".to_owned(), name.to_owned())]))
}

/// Writes the end time of a run.
///
/// # Errors
/// The tape cannot be written.
pub fn ended(tape: &Tape, now: Timestamp) -> Result<(), Error> {
    tape.describe(END, &BTreeMap::from([("nanoseconds".to_owned(), now.as_nanos().to_string())]))
}
