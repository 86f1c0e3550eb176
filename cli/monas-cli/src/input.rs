//! Files that several commands read: configurations, models and recordings.

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
pub(crate) use recorded_run::{chosen_hosts, recorded_charts, recorded_hosts, replay, run_of};
