//! The flag `--format`.

use clap::{Args, ValueEnum};

/// The option `--format` of a command.
#[derive(Args, Clone, Copy, Debug)]
pub struct FormatArgument {
    /// For people, or for programs: one JSON object per line.
    #[arg(long = "format", value_name = "FORMAT", default_value = "text")]
    pub value: Format,
}

/// The format of results and diagnostics.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}
