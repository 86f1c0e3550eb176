//! Deploys a program with its configuration and models to a robot over ssh.
//!
//! A [`Release`] is a folder whose name is the hash of its content: the program, the configuration,
//! what the configuration names, and the hashes of all files. A [`Deployment`] copies it to a
//! [`Robot`]. The robot uses it only after every file matches its hash and the program has started
//! once. Then the release becomes the current one and its service starts; if the program does not
//! keep running, the release before it becomes the current one again. So a robot never runs a
//! partial release.
//!
//! On the robot a POSIX shell suffices: the steps are tasks of the script `robot.sh`, which each
//! call of ssh transfers.
//!
//! ```no_run
//! use std::path::Path;
//!
//! use monas_deploy::{Deployment, Release, find_robot};
//!
//! let robot = find_robot(Path::new("robots.xml"), "nao-2").map_err(|wrong| format!("{wrong:?}"))?;
//! let release = Release::gather(&robot, Path::new("target/release/my-team"))?;
//! let installation = Deployment::new(&robot).install(&release)?;
//! println!("{} runs {}: {}", robot.name, release.name, installation.service);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod build;
mod deployment;
mod error;
mod modules;
mod release;
mod remote;
mod robot;
mod shell;

pub use build::build_program;
pub use deployment::{Deployment, Installation, InstalledReleases, Rollback};
pub use error::{Error, ErrorKind};
pub use modules::missing_modules;
pub use release::Release;
pub use robot::{Robot, find_robot, robots_grammar};
