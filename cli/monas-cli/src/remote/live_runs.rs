//! The runs on this computer that answer on their control sockets.

use std::collections::BTreeSet;
use std::path::PathBuf;

use monas_link::control::{ControlClient, control_sockets};

/// The runs that answer, by the name and path of their sockets.
pub(crate) fn live_runs() -> Vec<(String, PathBuf)> {
    let Ok(folder) = monas_link::default_folder() else { return Vec::new() };
    let sockets = control_sockets(&folder).into_iter();
    sockets.filter(|(_, path)| ControlClient::connect(path).is_ok()).collect()
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
