//! Configuration of agents.
//!
//! Agents are written as in Listing 4.17 of the thesis, with or without quotes; attributes are
//! canonically in snake case, the names of the thesis are accepted too:
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
//! | `thread_frequency` | cycles per second, 0 for no limit; required for a list of activities |
//! | `is_real_time`, `priority` | whether its threads request real-time scheduling, and their priority, from 1 to 99; if the system denies the request, the log reports it and the threads use ordinary scheduling |
//! | `cores` | the numbers of the cores that its threads may run on, such as `2 3`; by default any |
//! | `stats_cycle` | number of cycles between reports of its times in the log; 0 for none |
//! | `workers` | number of threads for the activities of its statecharts in real time; by default as many as can be active at once, at most twelve |
//! | `enable` | `0` leaves it out |
//! | `on_failure` | what happens when an activity fails: `restart`, `skip`, `stop-agent`, `safe-state` |
//!
//! `frequency` is an alias of `thread_frequency`. An `activity` may have `enable` and `on_failure`;
//! all its other attributes are its [parameters](monas_core::Parameters). A `provider` is an agent
//! with one activity of the same name. Files may contain any number of agents, inside an `<agents>`
//! element or not.
//!
//! A `<statechart elsewhere="Vision">` leaves the named activities to another process: their states
//! do nothing here, and a link delivers their publications.
//!
//! # TOML
//!
//! A file whose name ends with `.toml` contains the same in TOML, with the same diagnostics: a
//! table is an element, an array of tables or values several elements of one name, a key an
//! attribute. The text of an activity, a provider or an agent's name element is its key `name`,
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
//! Defaults, the file, settings for one robot, and the command line override each other in this
//! order ([`Layers`]): a setting such as `agent.Motion.frequency=50` is a path of elements and
//! their identities to an attribute. [`entries`] lists every value with its layer and location. The
//! [`Grammar`] defines all elements and attributes; schemas for editors are generated from it.
//!
//! # Files of activities
//!
//! [`XmlConfig`] stores names, numbers and tables in a file, and [`Xml`] queries a tree; both read
//! the listings of the thesis, and changes leave the rest of the file as it was.
//!
//! # Special actions
//!
//! [`poses`] reads motions of a body's joints, which options of `body` name.
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
//! | `name` | the name of this end; by default that of the host |
//! | `transport` | `local`, sockets of one computer; or `zenoh`, in programs that have it |
//! | `folder` | of `local`: the folder of the sockets; by default `$XDG_RUNTIME_DIR/monas`, or without that variable `monas-UID` in the folder for temporary files, for its user only |
//! | `beat` | interval of the link's progress reports; default 200 ms |
//! | `clock` | the name of the other end whose time the run takes for its own, for processes of one robot; in real time only |
//! | `access` | a file that lists who may publish what, see [`AccessList`](monas_link::AccessList); default everyone |
//! | `guests` | `1` accepts messages of programs without a link |
//! | `realm`, `scouting`, `shared_memory` | `zenoh` only: the first segment of keys; `1` discovers peers by multicast; `0` keeps large messages out of shared memory |
//! | `enable` | `0` leaves it out |
//!
//! Links whose sockets are in one folder communicate, so each robot has a separate folder.
//!
//! `<send>` and `<receive>` name `topics` (`soccer/ball`, `soccer/*`, `soccer/**`). Sent topics
//! have a `priority` from 1, first, to 7, last (default 4), and a `reliability`: `reliable` or
//! `best_effort`. Received topics belong to the other host and are read with
//! `blackboard.from(host)`, or with `as="own"` to this host: then the peer is a process of the same
//! robot. `<budget>` is a `profile` (`spl`: 1200 packets of 128 bytes in 20 minutes for a team,
//! divided by its `robots`), or `packets`, `window` and `payload`. `<listen>` is a local endpoint
//! (a port alone is reachable from this computer only), `<connect>` that of a peer.
//!
//! [`load`] reads a file and all files it names, and returns every
//! [`Diagnostic`](yase::Diagnostic): of the XML, of names unknown to the
//! [`Registry`](monas_core::Registry), of model files, formulas and expressions. Nothing runs while
//! there are errors.

mod agents;
pub mod colours;
mod configuration_bundle;
mod element;
mod grammar;
mod layers;
mod lenient_xml;
mod links;
mod log_settings;
mod model;
mod modules;
mod paths;
pub mod poses;
mod resolve;
mod schema;
mod severity;
mod toml;
mod tree;
pub mod urdf;
mod values;
mod write_back;
pub mod xml;
mod xml_config;
mod xml_editor;

pub use agents::{HostSetup, assemble, load, load_with, read, read_without_loading};
pub use configuration_bundle::ConfigurationBundle;
pub use element::{Attribute, Element, Layer, is_written};
pub use grammar::{AttributeRule, ElementRule, Grammar, Identity, Kind};
pub use layers::{Layers, UnmatchedSetting};
pub use log_settings::{LogFormat, LogSettings};
pub use model::load as load_model;
pub use paths::{locate, read as read_file, shown_name};
pub use resolve::{Resolved, ResolvedEntry, entries, resolve, resolve_text, sort as sort_diagnostics};
pub use severity::Severity;
pub use tree::{Xml, XmlNode};
pub use values::Values;
pub use write_back::{rewritten, updated};
pub use xml_config::{ValueError, XmlConfig};

/// Whether a file name is that of a TOML file.
pub fn is_toml(name: &str) -> bool {
    std::path::Path::new(name).extension().is_some_and(|ending| ending == "toml")
}

/// Whether a text is TOML: by the name of its file; standard input, if it does not begin as XML.
pub(crate) fn is_toml_text(source: &yase::Source) -> bool {
    match source.name == paths::STANDARD_INPUT {
        true => !source.text.trim_start().starts_with('<'),
        false => is_toml(&source.name),
    }
}

/// Parses a duration: a number and `ns`, `us`, `ms`, `s`, `min` or `h`.
pub fn duration(text: &str) -> Option<std::time::Duration> {
    monas_core::duration::parse(text).ok()
}
