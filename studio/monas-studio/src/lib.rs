//! A view of a run, or of a recording, in the browser.
//!
//! A [`Studio`] serves a page on loopback: statecharts with their active states, agents, topics,
//! the log, and a view from above. It watches a run through its control socket, as the commands of
//! the terminal do, so that a run without a studio pays nothing, and a viewer cannot block a run.
//! It changes one only if the studio was [allowed](StudioSettings::allows_control) to, by the same
//! requests as these commands. The view from above is a [`Scene`] of the program: this crate
//! knows no sport.
//!
//! # Design rationale
//!
//! - **Threads, no runtime.** One thread accepts connections, one follows the run, and each viewer
//!   has a thread: at most 32 connections and eight viewers. HTTP is a page of three files, so a
//!   request line and its headers are all that is parsed.
//! - **Newest wins.** A viewer gets at most 30 frames per second, each with all that has changed
//!   since its last one. A slow page gets fewer frames, and after five seconds none.
//! - **Only its own page is answered.** The `Host` must name this server, an `Origin` must be its
//!   own, and any other address than loopback needs a random token. Viewers that use Foxglove's
//!   protocol get the topics of a run under the same rules; their origins can be allowed.
//! - **The server refuses, not the page.** Requests that change a run are a type of their own, read
//!   strictly, and refused in one place.
//! - **Edits are edits of text.** Models can be edited that the program lists in a
//!   [`ModelWorkspace`]; what a page does in a drawing becomes replacements in the text of the
//!   file. The language of models is a [`ModelLanguage`]; that of the method
//!   is [`AsemeLanguage`], to which the program gives its names.
//! - **The drawing comes from the run.** Shapes are those of [`yase_export::to_picture`], the same
//!   layout as in drawings of models. The page only draws them.
//!
//! # Example
//!
//! ```
//! use monas_studio::{Studio, StudioSettings};
//!
//! # let folder = tempfile::tempdir()?;
//! let socket = folder.path().join("match.sock");
//! let listen = Some("127.0.0.1:0".parse()?);
//! let studio = Studio::of_run(&socket, StudioSettings { listen, ..StudioSettings::default() })?;
//! assert!(studio.url().starts_with("http://127.0.0.1:"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod access;
mod aseme_language;
mod asset;
mod base64;
mod cameras;
mod chart_history;
#[cfg_attr(not(unix), allow(dead_code, reason = "only runs of Unix are followed"))]
mod chart_values;
mod chart_view;
#[cfg_attr(not(unix), allow(dead_code, reason = "only runs of Unix are changed"))]
mod control_request;
mod error;
#[cfg(unix)]
mod foxglove;
#[cfg(unix)]
mod foxglove_cameras;
#[cfg(unix)]
mod foxglove_frame;
#[cfg(unix)]
mod foxglove_views;
mod guard_atom;
mod http_request;
#[cfg(unix)]
mod live_run;
#[cfg(unix)]
mod live_session;
#[cfg(unix)]
mod live_state;
mod message_chain;
mod message_decoder;
mod model_request;
mod model_session;
mod model_workspace;
mod models_only;
mod pace;
mod read_value;
#[cfg(unix)]
mod run_control;
#[cfg(unix)]
mod run_ring;
#[cfg_attr(not(unix), allow(dead_code, reason = "only runs of Unix are followed"))]
mod run_view;
mod scene;
#[cfg_attr(not(unix), allow(dead_code, reason = "only runs of Unix are served to others"))]
mod scene_update;
mod server;
mod source;
#[cfg_attr(not(unix), allow(dead_code, reason = "only runs of Unix are served to others"))]
mod state_name;
mod tape_difference;
mod tape_moment;
mod tape_pair;
mod tape_run;
mod tape_session;
mod tape_values;
mod text_positions;
mod time;
mod transition_explanation;
mod viewer;
mod viewer_request;
mod why;

pub use aseme_language::AsemeLanguage;
pub use cameras::Cameras;
pub use error::{Error, ErrorKind};
pub use guard_atom::GuardAtom;
pub use message_chain::{ChainLink, MessageChain};
pub use message_decoder::message_json;
pub use model_workspace::{ModelLanguage, ModelWorkspace};
pub use pace::Pace;
pub use read_value::ReadValue;
pub use scene::{
    Banner, Belief, Body, Ground, GroundMark, Scene, SceneAction, SceneEvent, SceneMessages, SceneObject,
    ScenePicture, SeenLine,
};
pub use server::{ListenAddress, Studio, StudioSettings};
pub use tape_difference::{TapeDifference, TapeEvent};
pub use tape_run::{TapeChart, TapeRun};
pub use transition_explanation::{TransitionExplanation, TransitionQuestion, TriggerArrival, Verdict};
pub use why::{Explanation, TakenSegment, WhyQuestion};
