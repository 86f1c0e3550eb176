//! The way to a run: its control socket.

use std::collections::BTreeSet;
use std::path::PathBuf;

use monas_link::ErrorKind;
use monas_link::control::{ControlClient, control_sockets};

use super::arguments::RunChoice;
use crate::arguments::Format;
use crate::failure::Failure;

/// A run that answers, by the name and place of its socket.
pub(crate) fn live_runs() -> Vec<(String, PathBuf)> {
    let Some(folder) = monas_link::default_folder() else { return Vec::new() };
    let sockets = control_sockets(&folder).into_iter();
    sockets.filter(|(_, path)| ControlClient::connect(path).is_ok()).collect()
}

/// The run that is meant.
pub(crate) fn socket(choice: &RunChoice) -> Result<PathBuf, Failure> {
    if let Some(socket) = &choice.reached {
        return Ok(socket.clone());
    }
    let unreachable = |message: String| Err(Failure::Unreachable(choice.format.value, message));
    let Some(folder) = monas_link::default_folder() else {
        return unreachable(
            "there are no control sockets: the system does not say where, with XDG_RUNTIME_DIR".into(),
        );
    };
    let runs = live_runs();
    let names: Vec<String> = runs.iter().map(|(name, _)| format!("`{name}`")).collect();
    match (&choice.run, runs.as_slice()) {
        (Some(name), _) => match runs.iter().find(|(known, _)| known == name) {
            Some((_, path)) => Ok(path.clone()),
            None if runs.is_empty() => unreachable(nobody(&folder)),
            None => unreachable(format!("no run is named `{name}`; there are {}", names.join(", "))),
        },
        (None, [(_, path)]) => Ok(path.clone()),
        (None, []) => unreachable(nobody(&folder)),
        (None, _) => Err(Failure::Usage(format!(
            "there are several runs, {}: say which with --run NAME",
            names.join(", ")
        ))),
    }
}

fn nobody(folder: &std::path::Path) -> String {
    format!("nothing runs here, as far as {} tells; `monas run` starts something", folder.display())
}

/// A connection to the run that is meant.
pub(crate) fn client(choice: &RunChoice) -> Result<ControlClient, Failure> {
    ControlClient::connect(&socket(choice)?).map_err(failure(choice.format.value))
}

/// What an error of the connection means for the command.
pub(crate) fn failure(format: Format) -> impl Fn(monas_link::Error) -> Failure {
    move |error| match error.kind() {
        ErrorKind::Connection => Failure::Unreachable(format, error.to_string()),
        _ => Failure::failed(format, error),
    }
}

/// The paths of the topics of all runs.
pub(crate) fn known_topics() -> Vec<String> {
    let clients = live_runs().into_iter().filter_map(|(_, path)| ControlClient::connect(&path).ok());
    let topics = clients.filter_map(|mut client| client.topics("", "").ok()).flatten();
    topics.map(|topic| topic.path).collect::<BTreeSet<_>>().into_iter().collect()
}

/// The hosts of all runs.
pub(crate) fn known_hosts() -> Vec<String> {
    let clients = live_runs().into_iter().filter_map(|(_, path)| ControlClient::connect(&path).ok());
    let hosts = clients.filter_map(|mut client| client.describe().ok()).flat_map(|run| run.hosts);
    hosts.collect::<BTreeSet<_>>().into_iter().collect()
}
