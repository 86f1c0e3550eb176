//! Projects of Monas: created from templates, and extended by activities, modules and generated
//! charts.
//!
//! A project is a Cargo workspace whose `Cargo.toml` has a table `[workspace.metadata.monas]`. It
//! names the package of the team, whose program links the project's activities and statecharts, so
//! that configurations can refer to them by name. [`create_project`] writes one that builds and
//! passes its tests at once; [`create_activity`] and [`create_module`] add to it.
//! [`generate_crate`] writes the statechart of a model as a crate and keeps the manifests of the
//! [`Project`] in step, so that no file is edited by hand.
//!
//! ```
//! let folder = tempfile::tempdir()?;
//! let team = folder.path().join("my-team");
//!
//! monas_project::create_project(&team, Some("0.1.0"))?;
//! let activity = monas_project::create_activity("TrackBall", &team)?;
//! assert!(activity.files[0].ends_with("activities/track_ball.rs"));
//! let program = monas_project::project_program(&team).map(|(_, program)| program);
//! assert_eq!(program.as_deref(), Some("my-team"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod generate;
mod linked;
mod manifest;
mod new_activity;
mod new_module;
mod new_project;
mod packages;
mod project;
mod project_root;

pub use error::{Error, ErrorKind};
pub use generate::{GeneratedCrate, generate_crate};
pub use linked::differences;
pub use new_activity::{NewActivity, create_activity};
pub use new_module::{NewModule, create_module};
pub use new_project::create_project;
pub use project::Project;
pub use project_root::{project_program, project_root};
