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
//! | `thread_frequency` | cycles a second, 0 for as many as there can be; needed by a list of activities |
//! | `is_real_time`, `priority` | whether the system's real-time scheduling is wanted for its threads, and how urgent they are then, from 1 to 99; where it is not permitted the log says so, and they run on like others |
//! | `cores` | the numbers of the cores that its threads may run on, such as `2 3`; any, if it is not said |
//! | `stats_cycle` | after how many cycles its times are written to the log; 0 for never |
//! | `workers` | how many threads the activities of its statecharts have in real time; as many as can be active at once, at most twelve, if it is not said |
//! | `enable` | `0` leaves it out |
//! | `on_failure` | what happens when an activity fails: `restart`, `skip`, `stop-agent`, `safe-state` |
//!
//! `frequency` is short for `thread_frequency`. An `activity` may have `enable` and an `on_failure` of its own; all its other attributes are its [parameters](crate::Parameters). A `provider` is an agent with the one activity
//! that it is named after. Files may hold any number of agents, in an `<agents>` or not.
//!
//! A `<statechart elsewhere="Vision">` leaves the named activities to another process: their states do nothing here, and a link brings what
//! they publish.
//!
//! # TOML
//!
//! A file whose name ends with `.toml` says the same in TOML, with the same diagnostics: a table is an element, an array of tables or
//! values several of one name, a key an attribute. What stands between the tags of an activity, a provider or an agent's name is its `name`,
//! that of a statechart its `model`.
//!
//! ```toml
//! [[agent]]
//! name = "Motion"
//! thread_frequency = 10
//! activity = ["Vision", { name = "MotionController", gait = "quick" }]
//! ```
//!
//! # Layers
//!
//! Defaults, the file, what is said of one robot, and the command line go over each other in this order ([`Layers`]): a setting such as
//! `agent.Motion.frequency=50` is a way through elements and what tells them apart, to an attribute. [`entries`] lists every value with the
//! layer and the place it comes from. What may be written is one table, the [`Grammar`], which schemas for editors are written from too.
//!
//! # Files of an activity's own
//!
//! [`XmlConfig`] keeps names, numbers and tables in a file, and [`Xml`] asks a tree; both read what the thesis prints, and what is
//! changed leaves everything else in the file as it was.
//!
//! # Links
//!
//! ```xml
//! <link name="blue-2">
//!   <send topics="body/*" priority="2"/>
//!   <send topics="soccer/game_state" reliability="best_effort"/>
//!   <receive topics="soccer/ball" as="own"/>
//! </link>
//! <link transport="zenoh" name="robot_1" access="config/access.txt">
//!   <listen>7447</listen>
//!   <connect>tls/192.168.1.22:7447</connect>
//!   <certificates authority="team.pem" certificate="robot_1.pem" key="robot_1.key"/>
//!   <budget profile="spl" robots="5"/>
//!   <send topics="soccer/hello"/>
//!   <receive topics="soccer/hello"/>
//! </link>
//! ```
//!
//! | attribute of `link` | means |
//! |---|---|
//! | `name` | the name of this end; that of the host if it is not said |
//! | `transport` | `local`, sockets of one computer; or `zenoh`, in programs that have it |
//! | `folder` | of `local`: where the sockets are; `$XDG_RUNTIME_DIR/monas` if it is not said |
//! | `beat` | how often the link says how far it is; 200 ms if it is not said |
//! | `clock` | the name of the other end whose time the run takes for its own, for processes of one robot; in real time only |
//! | `access` | a file that says who may publish what, see [`AccessList`](monas_link::AccessList); everybody if it is not said |
//! | `guests` | `1` lets programs without a link of their own send |
//! | `realm`, `scouting`, `shared_memory` | of `zenoh`: the first segment of keys; `1` looks for others without being told where; `0` keeps large messages out of shared memory |
//! | `enable` | `0` leaves it out |
//!
//! Links whose sockets are in one folder hear each other, so each robot has a folder of its own.
//!
//! `<send>` and `<receive>` name `topics` (`soccer/ball`, `soccer/*`, `soccer/**`). What is sent has a `priority` from 1, first, to 7, last (4),
//! and a `reliability`: `reliable`, or `best_effort`. What is received is that of the other host, read with
//! `blackboard.from(host)`, or with `as="own"` this host's own: then the other end is a process of the same robot. `<budget>` is a
//! `profile` (`spl`: 1200 packets of 128 bytes in 20 minutes for a team, divided by its `robots`), or `packets`, `window` and `payload`.
//! `<listen>` is an endpoint (a port alone is reached from this computer only), `<connect>` another's.
//!
//! [`load`] reads a file and everything it names, and returns every [`Diagnostic`](yase::Diagnostic): of the XML, of names that the
//! [`Registry`](crate::Registry) does not know, of model files, formulas and expressions. Nothing runs before there is none.

mod agents;
mod edit;
mod element;
mod grammar;
mod layers;
mod links;
mod model;
mod modules;
mod paths;
mod repair;
mod resolve;
mod schema;
mod toml;
mod tree;
mod update;
mod values;
pub mod xml;
mod xml_config;

pub use agents::{Setup, assemble, load, load_with, read};
pub use element::{Attribute, Element, Layer, is_written};
pub use grammar::{AttributeRule, ElementRule, Grammar, Identity, Kind};
pub use layers::{Layers, Unmatched};
pub use model::load as load_model;
pub use paths::{locate, read as read_file};
pub use resolve::{Entry, Resolved, entries, resolve, resolve_text, sort as sort_diagnostics};
pub use tree::{Xml, XmlNode};
pub(crate) use update::{updated, written_anew};
pub use values::Values;
pub use xml_config::{ValueError, XmlConfig};

/// Whether a file of that name is TOML.
pub(crate) fn is_toml(name: &str) -> bool {
    std::path::Path::new(name).extension().is_some_and(|ending| ending == "toml")
}

/// Reads a length of time: a number and `ns`, `us`, `ms`, `s` or `min`.
pub fn duration(text: &str) -> Option<std::time::Duration> {
    grammar::duration(text)
}
