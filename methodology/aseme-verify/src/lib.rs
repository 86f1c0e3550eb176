//! Verification of models: checks, composition, conformance, properties, scenarios and mutation.
//!
//! - [`check`] runs the checks of `monas model check` on a model of any kind: structure, guards,
//!   exploration.
//! - [`composition`] explores the charts of several robots together: deadlocks, unread messages,
//!   channels that are too small.
//! - [`protocol`] checks the chart of a protocol, and the chart of a player, against the protocol.
//! - [`properties`] has a temporal language, a model checker and a run-time [`Monitor`] for it.
//! - [`scenario`] parses and binds scenarios: what happens to a chart, and what is expected.
//! - [`mutation`] makes the mutants of a chart, by which scenarios are evaluated.
//!
//! A chart is explored without its program: conditions on data become free inputs, as far as
//! [`logic`] finds them satisfiable together ([`explorable`]). A proof therefore holds for every
//! program. A fault comes with a trace that [`yase_explore::replay`] replays on that abstraction.
//! An exploration that reaches its limit reports so and proves nothing.
//!
//! [`Monitor`]: properties::Monitor
//!
//! ```
//! use aseme_verify::CheckSettings;
//! use aseme_verify::check::check;
//! use aseme_verify::properties::{self, PropertyOutcome};
//! use yase::{Severity, Source};
//!
//! let role = Source::new("walker.srm", "
//! Role: walker
//! Liveness:
//! walker = Look . (Turn | Walk)
//! Transitions:
//! CONDITION -> Turn : [Ball.distance > 2]
//! CONDITION -> Walk : [Ball.distance <= 2]
//! ");
//! let settings = CheckSettings::default();
//! let report = check(&role, &settings);
//! assert!(report.findings.iter().all(|it| it.diagnostic.severity == Severity::Information));
//!
//! let file = Source::new("walker.properties", "property \"looks first\": not in Walk until leaving Look");
//! let (results, _) = properties::check(&role, &file, &settings).expect("the model is valid");
//! assert_eq!(results[0].outcome, PropertyOutcome::Holds);
//! ```

mod abstraction;
pub mod check;
mod check_settings;
mod checked_model;
pub mod composition;
mod cone_of_influence;
mod conformance;
mod diagnostic_names;
mod exploration_extent;
mod external_events;
mod finding;
pub mod logic;
pub mod mutation;
mod program_symbols;
pub mod properties;
pub mod protocol;
mod run_replay;
pub mod scenario;
mod strongly_connected_components;

pub use abstraction::explorable;
pub use check_settings::{CheckProgress, CheckSettings, ProgressObserver, RecordedCoverage};
pub use diagnostic_names::DiagnosticNames;
pub use exploration_extent::ExplorationExtent;
pub use external_events::check_external_events;
pub use finding::Finding;
pub use program_symbols::ProgramSymbols;
