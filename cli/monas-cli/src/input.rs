//! Files that several commands read: configurations, models and recordings.

use std::path::{Path, PathBuf};

use clap::builder::{PathBufValueParser, TypedValueParser};

mod configuration;
pub(crate) mod layers;
mod model;
mod recorded_run;

pub(crate) use configuration::{
    ConfigurationKind, DEFAULT_CONFIGURATION, checked, checked_with, grammar, kind_of, load_agents,
};
pub(crate) use layers::{LayerArguments, robot_file};
pub(crate) use model::{valid_chart, valid_model};
#[cfg(feature = "soccer")]
pub(crate) use recorded_run::recorded_configuration;
pub(crate) use recorded_run::{
    check_within, chosen_hosts, end_of, recorded_charts, recorded_hosts, replay, run_of,
};

/// Parses the path of a file that is written beside standard output.
pub(crate) fn file_parser() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| match path == Path::new("-") {
        true => Err("standard output has the results: name a file"),
        false => Ok(path),
    })
}
