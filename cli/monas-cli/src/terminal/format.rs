//! The flag `--format`.

use clap::{Args, ValueEnum};

#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct FormatArgument {
    /// For people, or for programs: one JSON object per line.
    #[arg(long = "format", value_name = "FORMAT", default_value = "text")]
    pub(crate) value: Format,
}

/// The format of results and diagnostics.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}
