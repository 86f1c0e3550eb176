//! The elements of agents and links.

use std::time::Duration;

use super::{AttributeRule, ElementRule, Grammar, Identity, Kind};
use monas_core::agent::FailurePolicy;
use monas_core::frequency::Frequency;
use monas_core::monitors::ViolationResponse;

impl Grammar {
    /// Agents, providers, links and modules, inside `<agents>` or not: the setup of one host.
    pub fn agents() -> Grammar {
        let agents = ElementRule::new("agents", "what runs on a host")
            .group()
            .children("agent")
            .children("provider")
            .children("link")
            .children("module")
            .children("agents");
        Grammar::default()
            .root(agent())
            .root(provider())
            .root(link())
            .root(module())
            .root(agents)
            .with(ElementRule::new("name", "the name of the agent").text("name", Kind::Text))
            .with(activity())
            .with(statechart())
            .with(monitor())
            .with(send())
            .with(receive())
            .with(budget())
            .with(endpoint("connect", "an endpoint of another that this end connects to"))
            .with(endpoint(
                "listen",
                "an endpoint of this end: `tcp/0.0.0.0:7447`, or a port of this computer",
            ))
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
            "cycles a second, 0 for as many as there can be; needed by a list of activities",
        )
        .alias("frequency"),
        attribute("priority", Kind::whole(), "how urgent it is, from 1 to 99 with real-time scheduling")
            .or("0"),
        attribute("is_real_time", Kind::Flag, "whether real-time scheduling is wanted").or("0"),
        attribute(
            "stats_cycle",
            Kind::whole_from(0),
            "after how many cycles its times are written to the log; 0 for never",
        )
        .or("0"),
        attribute(
            "workers",
            Kind::whole_from(1),
            "how many threads the activities of its statecharts have in real time; as many as can be active at once, \
             at most twelve, if it is not said",
        )
        .alias("threads"),
        attribute(
            "cores",
            Kind::List,
            "the numbers of the computer's cores that its threads may run on; any, if it is not said",
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
            "how often a second it is stepped besides what wakes it; as its agent, if it is not said",
        )
        .alias("frequency"),
        attribute(
            "priority",
            Kind::whole(),
            "how urgent the thread is that steps it; as its agent, if it is not said",
        ),
        attribute(
            "is_real_time",
            Kind::Flag,
            "whether real-time scheduling is wanted for the thread that steps it; as its agent, if it is not said",
        ),
        attribute(
            "stats_cycle",
            Kind::whole_from(0),
            "after how many steps its times are written to the log; as its agent, if it is not said",
        ),
        attribute(
            "workers",
            Kind::whole_from(1),
            "how many threads of its own its activities have in real time; those of its agent, if it is not said",
        )
        .alias("threads"),
        attribute(
            "cores",
            Kind::List,
            "the numbers of the computer's cores that the thread that steps it may run on; as its agent, if it is not said",
        ),
        enable(),
        attribute(
            "on_failure",
            policies,
            "what happens when one of its activities fails; as its agent says, if it is not said",
        ),
        attribute("elsewhere", Kind::List, "activities that another process runs"),
    ]
}

fn agent() -> ElementRule {
    ElementRule::new(
        "agent",
        "activities that run one after the other, statecharts that choose theirs, or both",
    )
    .attributes(settings())
    .required_child("name")
    .children("activity")
    .children("statechart")
    .children("monitor")
    .identified_by(Identity::Child("name"))
}

fn provider() -> ElementRule {
    ElementRule::new("provider", "an agent with the one activity that it is named after")
        .attributes(settings())
        .text("name", Kind::Text)
        .identified_by(Identity::Text)
}

fn activity() -> ElementRule {
    ElementRule::new(
        "activity",
        "an activity by its name; other attributes are its parameters; in a statechart that of every state that has it",
    )
        .attribute(enable())
        .attribute(attribute(
            "on_failure",
            Kind::Word(FailurePolicy::NAMES.map(|(name, _)| name).to_vec()),
            "what happens when it fails; as its agent or statechart says, if it is not said",
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
        .children("monitor")
        .identified_by(Identity::Text)
}

fn monitor() -> ElementRule {
    ElementRule::new("monitor", "a file of properties that its statechart is to keep to, or the one of its agent")
        .attribute(enable())
        .attribute(
            attribute(
                "on_violation",
                Kind::Word(ViolationResponse::NAMES.map(|(name, _)| name).to_vec()),
                "what happens when one is violated, beside that the log and the tape have it: nothing, or what `on_failure` of \
                 the agent says",
            )
            .or("log"),
        )
        .text("properties", Kind::Text)
        .identified_by(Identity::Text)
}

fn module() -> ElementRule {
    ElementRule::new(
        "module",
        "the file of a module, which is loaded when the run begins: agents can have its activities",
    )
    .attribute(enable())
    .text("file", Kind::Text)
    .identified_by(Identity::Text)
}

fn link() -> ElementRule {
    let beat = Kind::Duration { least: Duration::from_millis(1) };
    let ways = Kind::Word(vec!["local", "zenoh"]);
    ElementRule::new("link", "which topics cross to other processes and hosts")
        .attributes([
            attribute("name", Kind::Name, "the name of this end; that of the host if it is not said"),
            attribute("transport", ways, "sockets of one computer, or zenoh in programs that have it")
                .or("local"),
            attribute(
                "folder",
                Kind::Text,
                "of `local`: where the sockets are; $XDG_RUNTIME_DIR/monas if it is not said",
            ),
            attribute("beat", beat, "how often the link says how far it is").or("200ms"),
            attribute(
                "clock",
                Kind::Name,
                "the other end whose time the run takes for its own, in real time only",
            ),
            attribute(
                "access",
                Kind::File,
                "a file that says who may publish what; everybody if it is not said",
            ),
            attribute("guests", Kind::Flag, "`1` lets programs without a link of their own send").or("0"),
            attribute("realm", Kind::Name, "of `zenoh`: the first segment of keys"),
            attribute("scouting", Kind::Flag, "of `zenoh`: `1` looks for others without being told where")
                .or("0"),
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

const TOPICS: &str = "which topics: `soccer/ball`, `soccer/*`, `soccer/**`";

fn send() -> ElementRule {
    let reliabilities = Kind::Word(vec!["reliable", "best_effort"]);
    ElementRule::new("send", "topics that are sent")
        .attribute(attribute("topics", Kind::Text, TOPICS).required())
        .attribute(
            attribute("reliability", reliabilities, "whether what gets lost is sent again").or("reliable"),
        )
        .attribute(attribute("priority", Kind::whole_in(1, 7), "from 1, sent first, to 7, sent last").or("4"))
}

fn receive() -> ElementRule {
    let places = Kind::Word(vec!["other", "own"]);
    ElementRule::new("receive", "topics that are received")
        .attribute(attribute("topics", Kind::Text, TOPICS).required())
        .attribute(attribute("as", places, "as the other host's, or as this host's own").or("other"))
}

fn budget() -> ElementRule {
    ElementRule::new("budget", "how much may be sent: a `profile`, or `packets`, `window` and `payload`")
        .attribute(attribute("profile", Kind::Word(vec!["spl"]), "the rules of a league"))
        .attribute(attribute("robots", Kind::whole_from(1), "how many robots share the budget of a profile"))
        .attribute(attribute("packets", Kind::whole_from(1), "how many packets"))
        .attribute(attribute("window", Kind::Duration { least: Duration::ZERO }, "in how long a time"))
        .attribute(attribute("payload", Kind::whole_from(1), "how many bytes a packet has"))
}

fn endpoint(name: &'static str, doc: &'static str) -> ElementRule {
    ElementRule::new(name, doc).text("endpoint", Kind::Text)
}

fn certificates() -> ElementRule {
    ElementRule::new("certificates", "who this end is, and whom it believes")
        .attribute(attribute("authority", Kind::File, "the certificate of who signs").required())
        .attribute(attribute("certificate", Kind::File, "the certificate of this end").required())
        .attribute(attribute("key", Kind::File, "its key").required())
}
