//! The elements of agents and links.

use std::time::Duration;

use super::{AttributeRule, ElementRule, Grammar, Identity, Kind};
use monas_core::agent::FailurePolicy;
use monas_core::frequency::Frequency;
use monas_core::monitors::ViolationResponse;
use monas_robot::{CameraOutput, IMAGE_WIDTHS};

impl Grammar {
    /// Agents, providers, links and modules, inside `<agents>` or not: the setup of one host.
    pub fn agents() -> Grammar {
        let agents = ElementRule::new("agents", "the agents of a host")
            .group()
            .children("agent")
            .children("provider")
            .children("link")
            .children("module")
            .children("body")
            .children("agents");
        Grammar::default()
            .root(agent())
            .root(provider())
            .root(link())
            .root(module())
            .root(body())
            .root(agents)
            .with(ElementRule::new("name", "the name of the agent").text("name", Kind::Text))
            .with(activity())
            .with(statechart())
            .with(constant())
            .with(monitor())
            .with(send())
            .with(receive())
            .with(budget())
            .with(endpoint("connect", "a remote endpoint to connect to"))
            .with(endpoint("listen", "a local endpoint: `tcp/0.0.0.0:7447`, or a port of this computer"))
            .with(certificates())
    }
}

fn attribute(key: &'static str, kind: Kind, doc: &'static str) -> AttributeRule {
    AttributeRule::new(key, kind, doc)
}

fn enable() -> AttributeRule {
    attribute("enable", Kind::Flag, "`0` leaves it out").or("1")
}

/// The attributes of agents and providers.
fn settings() -> [AttributeRule; 8] {
    let hertz = Kind::number_in(0.0, Frequency::HIGHEST);
    let policies = Kind::Word(FailurePolicy::NAMES.map(|(name, _)| name).to_vec());
    [
        attribute(
            "thread_frequency",
            hertz,
            "cycles per second, 0 for no limit; required for a list of activities",
        )
        .alias("frequency"),
        attribute("priority", Kind::whole(), "its priority, from 1 to 99 with real-time scheduling")
            .or("0"),
        attribute("is_real_time", Kind::Flag, "whether to use real-time scheduling").or("0"),
        attribute(
            "stats_cycle",
            Kind::whole_from(0),
            "number of cycles between reports of its times in the log; 0 for none",
        )
        .or("0"),
        attribute(
            "workers",
            Kind::whole_from(1),
            "number of threads for the activities of its statecharts in real time; by default as many as can be active at once, at most twelve",
        )
        .alias("threads"),
        attribute(
            "cores",
            Kind::List,
            "the cores that its threads may run on, by number; by default all",
        ),
        enable(),
        attribute("on_failure", policies, "what happens when an activity fails").or("restart"),
    ]
}

/// The attributes of statecharts. They have no defaults, since the agent's settings apply.
fn chart_settings() -> [AttributeRule; 9] {
    let hertz = Kind::number_in(0.0, Frequency::HIGHEST);
    let policies = Kind::Word(FailurePolicy::NAMES.map(|(name, _)| name).to_vec());
    [
        attribute(
            "thread_frequency",
            hertz,
            "steps per second in addition to its wake-ups; by default as its agent",
        )
        .alias("frequency"),
        attribute("priority", Kind::whole(), "the priority of its thread; by default as its agent"),
        attribute(
            "is_real_time",
            Kind::Flag,
            "whether its thread uses real-time scheduling; by default as its agent",
        ),
        attribute(
            "stats_cycle",
            Kind::whole_from(0),
            "number of steps between reports of its times in the log; by default as its agent",
        ),
        attribute(
            "workers",
            Kind::whole_from(1),
            "number of separate threads for its activities in real time; by default those of its agent",
        )
        .alias("threads"),
        attribute(
            "cores",
            Kind::List,
            "the cores that its thread may run on, by number; by default as its agent",
        ),
        enable(),
        attribute(
            "on_failure",
            policies,
            "what happens when one of its activities fails; by default as its agent",
        ),
        attribute("elsewhere", Kind::List, "activities that run in another process"),
    ]
}

fn body() -> ElementRule {
    let doc = "the body of the robot; in a match that of the field by default; other attributes are options of its kind";
    ElementRule::new("body", doc)
        .attributes([
            attribute("kind", Kind::Name, "its kind; `monas doctor` lists those of the program").or("field"),
            attribute(
                "address",
                Kind::Text,
                "where its interface answers; by default the usual one of the kind",
            ),
            attribute(
                "vision",
                Kind::Word(CameraOutput::NAMES.map(|(name, _)| name).to_vec()),
                "what its cameras deliver: finished sightings, or images",
            )
            .or("sightings"),
            attribute(
                "image_width",
                Kind::Word(IMAGE_WIDTHS.map(|(name, _)| name).to_vec()),
                "width of its images, pixels; their height is three quarters of it; those of the field have 320 by default",
            ),
            attribute(
                "colours",
                Kind::File,
                "the colour table with which the calibration of images begins; `monas vision --calibrate` makes one",
            ),
            attribute("delay", Kind::Duration { min: Duration::ZERO }, "delay of commands, for trials")
                .or("0s"),
            attribute(
                "noise",
                Kind::number_in(0.0, 1.0),
                "standard deviation of what is added to measured angles and bearings, rad, for trials",
            )
            .or("0"),
            attribute(
                "loss",
                Kind::number_in(0.0, 1.0),
                "probability with which sightings and radio messages are lost, for trials",
            )
            .or("0"),
        ])
        .with_parameters()
}

fn agent() -> ElementRule {
    ElementRule::new(
        "agent",
        "a list of activities that run in order, statecharts that select activities, or both",
    )
    .attributes(settings())
    .required_child("name")
    .children("activity")
    .children("statechart")
    .children("monitor")
    .identified_by(Identity::Child("name"))
}

fn provider() -> ElementRule {
    ElementRule::new("provider", "an agent with one activity of the same name")
        .attributes(settings())
        .text("name", Kind::Text)
        .identified_by(Identity::Text)
}

fn activity() -> ElementRule {
    ElementRule::new(
        "activity",
        "an activity by name; other attributes are its parameters; in a statechart it applies to every state that runs it",
    )
        .attribute(enable())
        .attribute(attribute(
            "on_failure",
            Kind::Word(FailurePolicy::NAMES.map(|(name, _)| name).to_vec()),
            "what happens when it fails; by default as its agent or statechart",
        ))
        .text("name", Kind::Text)
        .with_parameters()
        .identified_by(Identity::Text)
}

fn statechart() -> ElementRule {
    ElementRule::new("statechart", "a model file, or the name of a generated statechart")
        .attributes(chart_settings())
        .text("model", Kind::Text)
        .children("activity")
        .children("constant")
        .children("monitor")
        .identified_by(Identity::Text)
}

fn constant() -> ElementRule {
    let doc = "a value for a constant of the model, in place of the one that the model gives";
    ElementRule::new("constant", doc)
        .attribute(attribute("name", Kind::Name, "the name of the constant").required())
        .text("value", Kind::Text)
        .identified_by(Identity::Attribute("name"))
}

fn monitor() -> ElementRule {
    ElementRule::new("monitor", "a file of properties to monitor in its statechart, or in the one of its agent")
        .attribute(enable())
        .attribute(
            attribute(
                "on_violation",
                Kind::Word(ViolationResponse::NAMES.map(|(name, _)| name).to_vec()),
                "what happens at a violation, in addition to the log and the tape: nothing, or the agent's `on_failure`",
            )
            .or("log"),
        )
        .text("properties", Kind::Text)
        .identified_by(Identity::Text)
}

fn module() -> ElementRule {
    ElementRule::new(
        "module",
        "the file of a module that is loaded at the start of the run and provides activities",
    )
    .attribute(enable())
    .text("file", Kind::Text)
    .identified_by(Identity::Text)
}

fn link() -> ElementRule {
    let beat = Kind::Duration { min: Duration::from_millis(1) };
    let transports = Kind::Word(vec!["local", "zenoh"]);
    ElementRule::new("link", "a connection to other processes and hosts")
        .attributes([
            attribute("name", Kind::Name, "the name of this end; by default that of the host"),
            attribute("transport", transports, "local sockets, or zenoh in programs built with it").or("local"),
            attribute(
                "folder",
                Kind::Text,
                "of `local`: the folder of the sockets; by default $XDG_RUNTIME_DIR/monas, or without that variable \
                 monas-UID in the folder for temporary files, for its user only",
            ),
            attribute("beat", beat, "interval of the link's reports").or("200ms"),
            attribute("clock", Kind::Name, "the other end whose clock the run follows, in real time only"),
            attribute(
                "access",
                Kind::File,
                "an access list: who may publish which topics; by default no restriction",
            ),
            attribute("guests", Kind::Flag, "`1` accepts messages of programs without a link").or("0"),
            attribute("realm", Kind::Name, "of `zenoh`: the first segment of keys"),
            attribute("scouting", Kind::Flag, "of `zenoh`: `1` enables discovery of other hosts").or("0"),
            attribute(
                "shared_memory",
                Kind::Flag,
                "of `zenoh`: `0` keeps large messages out of shared memory",
            )
            .or("1"),
            enable(),
        ])
        .children("send")
        .children("receive")
        .child("budget")
        .children("connect")
        .children("listen")
        .child("certificates")
        .identified_by(Identity::Attribute("name"))
}

const TOPICS_HINT: &str = "which topics: `soccer/ball`, `soccer/*`, `soccer/**`";

fn send() -> ElementRule {
    let reliabilities = Kind::Word(vec!["reliable", "best_effort"]);
    ElementRule::new("send", "topics that are sent")
        .attribute(attribute("topics", Kind::Text, TOPICS_HINT).required())
        .attribute(
            attribute("reliability", reliabilities, "whether lost messages are sent again").or("reliable"),
        )
        .attribute(attribute("priority", Kind::whole_in(1, 7), "from 1 (first) to 7 (last)").or("4"))
}

fn receive() -> ElementRule {
    let places = Kind::Word(vec!["other", "own"]);
    ElementRule::new("receive", "topics that are received")
        .attribute(attribute("topics", Kind::Text, TOPICS_HINT).required())
        .attribute(attribute("as", places, "as messages of the other host, or of this host").or("other"))
}

fn budget() -> ElementRule {
    ElementRule::new("budget", "a limit on sending: a `profile`, or `packets`, `window` and `payload`")
        .attribute(attribute("profile", Kind::Word(vec!["spl"]), "the rules of a league"))
        .attribute(attribute(
            "robots",
            Kind::whole_from(1),
            "number of robots that share the budget of a profile",
        ))
        .attribute(attribute("packets", Kind::whole_from(1), "how many packets"))
        .attribute(attribute("window", Kind::Duration { min: Duration::ZERO }, "the duration of the window"))
        .attribute(attribute("payload", Kind::whole_from(1), "bytes per packet"))
}

fn endpoint(name: &'static str, doc: &'static str) -> ElementRule {
    ElementRule::new(name, doc).text("endpoint", Kind::Text)
}

fn certificates() -> ElementRule {
    ElementRule::new("certificates", "the certificates of this end and of its authority")
        .attribute(attribute("authority", Kind::File, "the certificate of the authority").required())
        .attribute(attribute("certificate", Kind::File, "the certificate of this end").required())
        .attribute(attribute("key", Kind::File, "its key").required())
}
