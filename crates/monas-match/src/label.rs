//! What is written on a tape before anything is recorded: which run it is of, and the files of that run.

use std::collections::BTreeMap;
use std::path::Path;

use monas::{Moment, Provenance};
use monas_tape::{Error, Tape};

/// The name of the facts about a run: `version`, `configuration` (the name of a file that is in the tape), `configuration_hash`, `time`
/// (`simulated` or `real`), `seed` if time is simulated, and `robots`, the hosts, with blanks between them.
pub const RUN: &str = "run";

/// The fact that says what the command line had set over the configuration, a line each; it is there if it had.
pub const SETTINGS: &str = "settings";

/// The fact that says in which folder the configuration was; it is there if that makes a difference: see [`Provenance::folder`].
pub const FOLDER: &str = "folder";

/// The name of the facts about its end: `nanoseconds`, the moment up to which everything happened. What is recorded later was
/// published while agents were being stopped.
pub const END: &str = "end";

/// Begins the tape of a run in simulated time.
pub(crate) fn simulated(
    path: &Path,
    files: &Provenance,
    settings: &str,
    seed: u64,
    robots: &[String],
) -> Result<Tape, Error> {
    let tape = Tape::create(path)?;
    label(&tape, files, settings, robots, &[("time", "simulated".to_owned()), ("seed", seed.to_string())])?;
    Ok(tape)
}

/// Writes on a tape that it is of a run in real time; `settings` are what the command line had set, a line each.
///
/// # Errors
/// The tape cannot be written.
pub fn label_real_time(
    tape: &Tape,
    files: &Provenance,
    settings: &str,
    robots: &[String],
) -> Result<(), Error> {
    label(tape, files, settings, robots, &[("time", "real".to_owned())])
}

fn label(
    tape: &Tape,
    files: &Provenance,
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
    files.files().try_for_each(|(name, media_type, content)| tape.attach(name, media_type, content))
}

/// Writes on a tape when its run ended.
///
/// # Errors
/// The tape cannot be written.
pub fn ended(tape: &Tape, now: Moment) -> Result<(), Error> {
    tape.describe(END, &BTreeMap::from([("nanoseconds".to_owned(), now.as_nanos().to_string())]))
}
