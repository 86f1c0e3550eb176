//! `monas tape`: inspects, recovers, cuts, merges, draws, exports and replays recordings.

mod arguments;
#[cfg(feature = "soccer")]
mod draw;
mod edit;
mod export;
mod info;
mod replay;
mod select;
mod value_text;
#[cfg(all(feature = "soccer", unix))]
mod what_if;

use monas_terminal::{CommandFailure, CommandOutput, Exit};

#[cfg(unix)]
use crate::commands::studio::ListenArgument;
use arguments::ReplayArguments;

pub(crate) use arguments::TapeCommand;

pub(crate) fn execute(
    command: &TapeCommand,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    match command {
        TapeCommand::Info { file, format } => info::execute(file, format.value, console),
        TapeCommand::Export(arguments) => export::execute(arguments, console),
        #[cfg(feature = "soccer")]
        TapeCommand::Draw(arguments) => draw::execute(arguments, console),
        #[cfg(all(feature = "soccer", unix))]
        TapeCommand::WhatIf(arguments) => what_if::execute(arguments, console),
        TapeCommand::Recover { file, output, format } => {
            edit::recover(file, output.as_deref(), format.value, console)
        }
        TapeCommand::Replay(arguments) => replay::execute(arguments, console),
        TapeCommand::Verify { file, format } => {
            let arguments = ReplayArguments {
                file: file.clone(),
                agents: Vec::new(),
                verify: true,
                config: None,
                #[cfg(unix)]
                studio: false,
                #[cfg(unix)]
                listen: ListenArgument::default(),
                format: *format,
            };
            replay::execute(&arguments, console)
        }
        TapeCommand::Cut(arguments) => edit::cut(arguments, console),
        TapeCommand::Merge { files, output, format } => edit::merge(files, output, format.value, console),
    }
}
