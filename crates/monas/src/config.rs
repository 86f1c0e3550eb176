//! Configuration: agents as people write them.
//!
//! An agent is written as in Listing 4.17 of the thesis, quotes or not; attributes are canonically in snake case, the thesis's
//! own names are accepted too:
//!
//! ```xml
//! <agent thread_frequency="10" priority="1" on_failure="restart">
//!   <name>Motion</name>
//!   <activity gait="quick">MotionController</activity>
//!   <activity enable="0">LedHandler</activity>
//!   <statechart>models/goalie.srm</statechart>
//! </agent>
//! <provider thread_frequency="100">Sensors</provider>
//! ```
//!
//! | attribute of `agent` and `provider` | means |
//! |---|---|
//! | `thread_frequency` | cycles a second; needed by a list of activities |
//! | `priority`, `is_real_time` | how urgent it is, and whether real-time scheduling is wanted; kept with the agent, while threads are still left to the system's ordinary scheduling |
//! | `stats_cycle` | after how many cycles its times are written to the log; 0 for never |
//! | `workers` | how many threads the activities of its statecharts have in real time; as many as can be active at once, at most twelve, if it is not said |
//! | `enable` | `0` leaves it out |
//! | `on_failure` | what happens when an activity fails: `restart`, `skip`, `stop-agent`, `safe-state` |
//!
//! All other attributes of an `activity` are its [parameters](crate::Parameters). A `provider` is an agent with the one activity
//! that it is named after. Files may hold any number of agents, in an `<agents>` or not.
//!
//! [`load`] reads a file and everything it names, and returns every [`Diagnostic`](yase::Diagnostic): of the XML, of names that the
//! [`Registry`](crate::Registry) does not know, of model files, formulas and expressions. Nothing runs before there is none.

mod agents;
mod model;
mod paths;
mod repair;
pub mod xml;

pub use agents::{load, read};
pub use model::load as load_model;
pub use paths::{locate, read as read_file};
