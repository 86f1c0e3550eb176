//! Talws, which runs the agents of one robot or of a whole team, in simulated or in real time.
//!
//! [`Talws`] holds hosts with their agents and bodies, and the world. [`Simulation`] advances time
//! as fast as the run can be computed, on one thread and in a defined order; [`RealTimeRun`] uses a
//! thread for each list of activities and each chart, and a pool for the activities of charts;
//! [`replay`] executes agents again on recorded inputs. A [`RunHandle`] changes agents while they
//! run. This is the only crate of the runtime that reads a clock, waits, or starts threads for
//! agents.
//!
//! All of them drive a chart by the one loop of
//! [`ChartRunner`](monas_core::chart_runner::ChartRunner), as implementations of its trait
//! `ChartDriver`.
//!
//! ```
//! use monas_core::{Agent, Blackboard, Hz, Timestamp};
//! use monas_runtime::Talws;
//!
//! fn hello(blackboard: &mut Blackboard) {
//!     println!("hello at {}", blackboard.now());
//! }
//!
//! let mut simulation = Talws::new().agent(Agent::new("greeter", Hz(10)).activity(hello)).simulate(7)?;
//! simulation.run_until(Timestamp::from_secs_f64(1.0))?;
//! assert_eq!(simulation.statistics().calls("local", "hello"), 10);
//! # Ok::<(), monas_core::Error>(())
//! ```

mod admin;
mod agent_entry;
mod agent_factory;
mod agent_instance;
mod agent_shared;
mod agent_update;
mod body;
mod body_thread;
mod call_meter;
mod chart_thread;
mod clock;
mod cycle_recorder;
mod deadlines;
mod duration_text;
mod free_loop;
mod host_status;
mod links;
mod list;
mod list_thread;
mod observed_thread;
mod observers;
mod pool;
mod real_time;
mod real_time_host;
mod recorded_publisher;
mod remote_activity;
pub mod replay;
mod round_trip;
mod run_config;
mod run_handle;
mod setup;
mod simulated_chart;
mod simulation;
mod simulation_thread;
mod stall_watchdog;
mod stop_handle;
mod supervisor;
mod supervisor_request;
mod sync;
mod talws;
mod thread_scheduling;
mod turn_record;
mod watchdog;

pub use real_time::RealTimeRun;
pub use run_config::{HostConfig, World};
pub use run_handle::RunHandle;
pub use simulation::Simulation;
pub use stop_handle::StopHandle;
pub use talws::Talws;
pub use thread_scheduling::permits_real_time;

pub(crate) use clock::RunClock;
pub use clock::cpu_time;
pub(crate) use watchdog::Watchdog;

/// Stop reason of agents at the regular end of a run.
const END_REASON: &str = "the run has ended";

/// Internals measured by the benches of this crate.
#[doc(hidden)]
pub mod measured {
    pub use crate::round_trip::RoundTrip;
}
