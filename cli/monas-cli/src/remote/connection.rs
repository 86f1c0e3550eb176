//! Connections to runs by their control sockets.

use std::path::PathBuf;

use monas_link::ErrorKind;
use monas_link::control::ControlClient;
use monas_terminal::{CommandFailure, Format};

use super::live_runs::live_runs;
use super::run_selector::RunSelector;

/// The control socket of the selected run.
pub(crate) fn socket(choice: &RunSelector) -> Result<PathBuf, CommandFailure> {
    if let Some(socket) = &choice.reached {
        return Ok(socket.clone());
    }
    let unreachable = |message: String| Err(CommandFailure::Unreachable(choice.format.value, message));
    let folder = match monas_link::default_folder() {
        Ok(folder) => folder,
        Err(error) => return unreachable(error.to_string()),
    };
    let runs = live_runs();
    let names: Vec<String> = runs.iter().map(|(name, _)| format!("`{name}`")).collect();
    match (&choice.run, runs.as_slice()) {
        (Some(name), _) => match runs.iter().find(|(known, _)| known == name) {
            Some((_, path)) => Ok(path.clone()),
            None if runs.is_empty() => unreachable(no_live_run(&folder)),
            None => unreachable(format!("no run is named `{name}`; there are {}", names.join(", "))),
        },
        (None, [(_, path)]) => Ok(path.clone()),
        (None, []) => unreachable(no_live_run(&folder)),
        (None, _) => Err(CommandFailure::Usage(format!(
            "there are several runs, {}: select one with --run NAME",
            names.join(", ")
        ))),
    }
}

fn no_live_run(folder: &std::path::Path) -> String {
    if let (true, Err(error)) = (folder.exists(), monas_files::check_private(folder)) {
        return format!("control sockets are not used: {error}");
    }
    format!("nothing runs here, by {}; start a run with `monas run`", folder.display())
}

/// A connection to the selected run.
pub(crate) fn client(choice: &RunSelector) -> Result<ControlClient, CommandFailure> {
    ControlClient::connect(&socket(choice)?).map_err(failure(choice.format.value))
}

/// Maps an error of a connection to a failure, for `map_err`.
pub(crate) fn failure(format: Format) -> impl Fn(monas_link::Error) -> CommandFailure {
    move |error| match error.kind() {
        ErrorKind::Connection => CommandFailure::Unreachable(format, error.to_string()),
        _ => CommandFailure::failed(format, error),
    }
}
