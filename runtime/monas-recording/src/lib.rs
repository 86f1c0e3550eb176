//! The description of a run on its tape: configuration, settings, seed and end.
//!
//! A tape with this description can be replayed: its agents run again, from the recorded
//! configuration and files. `monas-tape` knows neither configurations nor runs, and `monas` knows
//! no tapes; this crate combines them.
//!
//! ```
//! use monas::{ConfigurationBundle, Timestamp};
//! use monas_tape::Tape;
//!
//! # let folder = tempfile::tempdir()?;
//! # let (path, config) = (folder.path().join("run.mcap"), folder.path().join("agents.xml"));
//! # std::fs::write(&config, "<agents/>")?;
//! let tape = Tape::create_real_time(&path)?;
//! let files = ConfigurationBundle::of(&config);
//! monas_recording::label_real_time(&tape, &files, "", &["robot".to_owned()])?;
//! monas_recording::ended(&tape, Timestamp::from_nanos(20))?;
//! tape.finish()?;
//!
//! let overview = monas_tape::read(&path)?.overview()?;
//! let run = overview.facts.iter().find(|facts| facts.name == monas_recording::RUN);
//! assert_eq!(run.map(|run| run.entries["time"].as_str()), Some("real"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod tape_metadata;

pub use tape_metadata::{
    END, FOLDER, ROBOT, RUN, SETTINGS, ended, label_real_time, label_robot, label_simulated,
};
