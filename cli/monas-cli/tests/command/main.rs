//! The built command, as used by people and programs.

#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot be prepared fails")]

#[cfg(unix)]
mod agent;
mod chapter;
#[cfg(unix)]
mod chart;
mod compose;
mod config;
mod convert;
mod copying;
#[cfg(target_os = "linux")]
mod crashes;
#[cfg(unix)]
mod ctrl_c;
#[cfg(unix)]
mod deploy;
mod doctor;
#[cfg(unix)]
mod elsewhere;
#[cfg(target_os = "linux")]
mod endless;
mod explain;
mod generate;
mod globals;
mod hints;
mod kit;
mod league;
mod linked_topics;
mod log;
mod model;
mod mutate;
mod new;
#[cfg(all(unix, feature = "soccer"))]
mod processes;
mod protocol;
mod reading;
mod recordings;
mod reference;
mod refinement;
mod run;
#[cfg(unix)]
mod running;
mod scenario;
mod schema;
#[cfg(unix)]
mod studio;
mod tape;
#[cfg(unix)]
mod top;
#[cfg(unix)]
mod topic;
mod usage;
#[cfg(feature = "soccer")]
mod vision;
#[cfg(all(unix, feature = "zenoh"))]
mod zenoh;
