//! Exploration of several robots together: deadlocks and lost messages.
//!
//! Each model is one robot, or with a name `robot/agent` one agent of a robot. A message passes
//! from one robot to another if the sender's chart writes or publishes it and the receiver's chart
//! reads it by the sender's name (`receiver.news.Signal.Ready`), and between agents of one robot
//! without a name (`news.Signal.Ready`). If nothing is read by a robot's name, all models are
//! agents of one process. It passes through a channel, which holds a bounded number of
//! messages and drops the oldest when it is full, as a link does; a channel may lose any message,
//! if requested. Messages from a chart to itself pass the same way. A chart that has ended, or that
//! TERMINATE has stopped, neither sends nor waits. All other conditions are free inputs, activities
//! return and timers expire in any order.
//!
//! The findings are deadlocks to which the robots come on their machines (E0930; E0937 if that is
//! not confirmed), messages that arrive where no state reads them (E0931) and
//! channels that are too small (E0932). Each has a trace, which [`TeamTrace`] replays. If the
//! search reaches its limit, the result is undecided and reported so (E0933).
//!
//! Messages that an activity publishes are known from [`ProgramSymbols`](crate::ProgramSymbols);
//! they are published when the activity returns.

mod composed_robot;
mod confirmation;
mod content_table;
mod deadlock;
mod message_names;
mod product;
mod team_trace;

use std::sync::Arc;

use yase::{Diagnostic, Source, Span};

use crate::abstraction::Abstraction;
use crate::check_settings::CheckSettings;
use crate::finding::Finding;
use composed_robot::{Behaviour, ComposedRobot, ReceivedMessage, RobotDeployment, SentMessage};
use deadlock::Deadlock;
use message_names::MessageUse;
use product::{GlobalProduct, MessageRoute};

pub use team_trace::{PlayedStep, TeamTrace};

/// Properties of the channels between robots.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct Channels {
    /// Maximum number of messages in transit from one robot to another; one more drops the oldest.
    pub capacity: usize,
    /// Whether any message may be lost.
    pub may_lose: bool,
}

impl Default for Channels {
    fn default() -> Channels {
        Channels { capacity: 2, may_lose: false }
    }
}

/// The result of a composition.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
#[non_exhaustive]
pub struct Composition {
    /// The findings, by robot.
    pub findings: Vec<Finding>,
    /// Each robot, and how many states of its own chart were explored.
    pub robots: Vec<(String, usize)>,
    /// The routes: sender, receiver and name of the message.
    pub passing: Vec<(String, String, String)>,
    /// The number of states of the composition that were found.
    pub states: usize,
    /// Whether the exploration is complete.
    pub is_finished: bool,
    /// Whether the robots are taken for agents of one process: none reads a message by the name of
    /// another, and some read messages that others publish.
    pub is_one_process: bool,
}

impl Composition {
    /// Whether any finding is an error.
    pub fn has_errors(&self) -> bool {
        self.findings.iter().any(|finding| finding.diagnostic.is_error())
    }
}

/// Explores the composition of several robots, given as unique names and models.
///
/// # Errors
/// The errors that prevent exploring a model.
pub fn compose(
    models: &[(String, Arc<Source>)],
    channels: Channels,
    settings: &CheckSettings,
) -> Result<Composition, Vec<Diagnostic>> {
    let by_name: Vec<&str> = models.iter().map(|(name, _)| host_of(name)).collect();
    let mut robots = robots(models, &by_name, settings)?;
    let mut passages = product::passages(&robots);
    let is_alone = |passages: &[MessageRoute]| passages.iter().all(|route| route.from == route.to);
    let is_one_process = models.len() > 1 && is_alone(&passages) && all_differ(&by_name) && {
        let together = self::robots(models, &vec![""; models.len()], settings)?;
        let routes = product::passages(&together);
        let passes = !is_alone(&routes);
        if passes {
            (robots, passages) = (together, routes);
        }
        passes
    };
    let mut found = Composition {
        passing: passages.iter().map(|passage| route_names(&robots, passage)).collect(),
        is_one_process,
        ..Composition::default()
    };
    found.findings.extend(robots.iter().filter_map(unexplorable).map(Finding::from));
    found.findings.extend(unsent_messages(&robots, &passages).map(Finding::from));
    if found.has_errors() {
        return Ok(found);
    }
    let behaviours = behaviours(&robots, &passages, settings);
    let counts = behaviours.iter().map(|it| it.found.states().len());
    found.robots = robots.iter().map(|robot| robot.name.clone()).zip(counts).collect();
    let product = product::product(&robots, &behaviours, &passages, channels, settings);
    (found.states, found.is_finished) = (product.states.len(), product.is_finished());
    let deadlocks = deadlock::deadlocks(&product);
    found.findings.extend(deadlocks.iter().map(|it| deadlock_finding(&product, it, settings)));
    found.findings.extend(product.dropped.iter().map(|(&passage, &edge)| dropped(&product, passage, edge)));
    found.findings.extend(
        product.overflows.iter().map(|(&passage, &edge)| channel_overflow(&product, passage, edge, channels)),
    );
    found.findings.extend((!found.is_finished).then(|| not_decided(&robots, &behaviours, &product)));
    Ok(found)
}

/// The host of a robot: what stands before the name of its agent, `robot/agent`.
fn host_of(name: &str) -> &str {
    name.split_once('/').map_or(name, |(host, _)| host)
}

fn all_differ(hosts: &[&str]) -> bool {
    hosts.iter().enumerate().all(|(number, host)| !hosts[..number].contains(host))
}

fn robots(
    models: &[(String, Arc<Source>)],
    hosts: &[&str],
    settings: &CheckSettings,
) -> Result<Vec<ComposedRobot>, Vec<Diagnostic>> {
    let world = settings.world.as_ref();
    let (mut wrong, mut charts) = (Vec::new(), Vec::new());
    for (_, source) in models {
        match prepare(source, settings) {
            Ok(chart) => charts.push(chart),
            Err(found) => wrong.extend(found),
        }
    }
    if !wrong.is_empty() {
        return Err(wrong);
    }
    let sent = charts.iter().map(|(subject, _)| composed_robot::messages_to_send(&subject.chart, world));
    let sent: Vec<Vec<SentMessage>> = sent.collect();
    let robots = models.iter().zip(charts).enumerate().map(|(number, ((name, source), chart))| {
        let beside = (0..models.len()).filter(|&other| other != number && hosts[other] == hosts[number]);
        let beside = beside.flat_map(|other| sent[other].iter().map(|it| it.name.clone())).collect();
        let deployment = RobotDeployment { host: hosts[number], hosts, sent_by_others: beside };
        ComposedRobot::new(name, source, chart, deployment, world)
    });
    Ok(robots.collect())
}

fn prepare(
    source: &Arc<Source>,
    settings: &CheckSettings,
) -> Result<(crate::checked_model::CheckedModel, Abstraction), Vec<Diagnostic>> {
    let subject = crate::checked_model::subject_of(source)?;
    let abstraction =
        Abstraction::new(&subject).map_err(|found| crate::checked_model::in_source(source, found))?;
    Ok((subject, abstraction.with_events(&settings.events)))
}

/// Explores the behaviour of each robot alone.
fn behaviours(
    robots: &[ComposedRobot],
    passages: &[MessageRoute],
    settings: &CheckSettings,
) -> Vec<Behaviour> {
    let is_read = |number: usize, message: usize| {
        passages.iter().any(|passage| passage.from == number && passage.sent_message == message)
    };
    let explored = |(number, robot): (usize, &ComposedRobot)| {
        let read: Vec<bool> = (0..robot.sent.len()).map(|message| is_read(number, message)).collect();
        robot.explored(settings, &read)
    };
    robots.iter().enumerate().map(explored).collect()
}

fn route_names(robots: &[ComposedRobot], passage: &MessageRoute) -> (String, String, String) {
    let from = &robots[passage.from];
    let name = from.sent[passage.sent_message].name.name().to_owned();
    (from.name.clone(), robots[passage.to].name.clone(), name)
}

/// An error if the messages of a robot cannot be distinguished.
fn unexplorable(robot: &ComposedRobot) -> Option<Diagnostic> {
    robot.ambiguous().or_else(|| {
        let transition = composed_robot::wildcard_trigger(&robot.subject.chart)?;
        let message = format!("`{}` matches every event: it is unknown which messages those are", robot.name);
        let found = Diagnostic::error("E0935", robot.subject.spans.transition(transition), message);
        Some(found.with_hint("name the events").in_source(&robot.source))
    })
}

/// Messages that a chart waits for and that no model sends.
fn unsent_messages<'a>(
    robots: &'a [ComposedRobot],
    passages: &'a [MessageRoute],
) -> impl Iterator<Item = Diagnostic> + 'a {
    robots.iter().enumerate().flat_map(move |(to, robot)| {
        let is_sent = move |message: usize| {
            passages.iter().any(|it| it.to == to && it.received_messages.contains(&message))
        };
        let unsent = robot.received.iter().enumerate().filter(move |(message, _)| !is_sent(*message));
        unsent.map(|(_, message)| no_sender(robot, message))
    })
}

fn no_sender(robot: &ComposedRobot, received: &ReceivedMessage) -> Diagnostic {
    let (host, name) = (&received.called.host, received.called.name.name());
    let message = format!(
        "the chart of `{host}` does not send `{name}`, which `{}` waits for: it is assumed to arrive at any time",
        robot.name
    );
    let found = Diagnostic::warning("E0934", robot.subject.spans.transition(received.transition), message);
    found.with_hint("`--linked` takes the topics of activities from the program").in_source(&robot.source)
}

/// A deadlock to which the robots can come, or why that is not known.
fn deadlock_finding(product: &GlobalProduct<'_>, found: &Deadlock, settings: &CheckSettings) -> Finding {
    let mut unconfirmed = None;
    for &state in &found.states {
        match confirmation::confirm(product, state, settings) {
            Ok(()) => return confirmed_deadlock(product, found, state),
            Err(why) => {
                unconfirmed.get_or_insert((state, why));
            }
        }
    }
    let (state, why) = unconfirmed.unwrap_or_default();
    let Finding { diagnostic, trace } = confirmed_deadlock(product, found, state);
    let message =
        format!("not decided, since the path to it is not confirmed: {} ({why})", diagnostic.message);
    let hint =
        "the trace shows what the exploration has found; with `--linked` the program says who publishes what";
    Finding { diagnostic: Diagnostic { code: "E0937", message, ..diagnostic }.with_hint(hint), trace }
}

fn confirmed_deadlock(product: &GlobalProduct<'_>, found: &Deadlock, state: usize) -> Finding {
    let waits: Vec<String> = found
        .waits
        .iter()
        .map(|&(robot, wait)| {
            let robot = &product.robots[robot];
            let wait = &robot.waits[wait];
            let called = &robot.received[wait.received_message].called;
            let (name, path) = (&robot.name, robot.subject.path(wait.node));
            let of = if called.host.is_empty() { String::new() } else { format!(" of `{}`", called.host) };
            format!("`{name}` waits in `{path}` for `{}`{of}", called.name.name())
        })
        .collect();
    let message = match waits.as_slice() {
        [one] => format!("{one}, which never comes"),
        several => format!("{}: none of these messages ever arrives", several.join(", ")),
    };
    let (robot, wait) = found.waits.first().copied().unwrap_or_default();
    let robot = &product.robots[robot];
    let span =
        robot.waits.get(wait).map_or(Span::default(), |wait| robot.subject.spans.transition(wait.transition));
    let diagnostic = Diagnostic::error("E0930", span, message)
        .with_hint("let one of them continue alone: send its message first, or limit the wait by a timer")
        .in_source(&robot.source);
    Finding { diagnostic, trace: Some(product.trace_text(&product.path_to(state))) }
}

/// The trace to an edge and including it.
fn trace_to_edge(product: &GlobalProduct<'_>, edge: usize) -> Option<String> {
    let edge = product.edges.get(edge)?;
    let mut events = product.path_to(edge.from);
    events.push(edge.by);
    Some(product.trace_text(&events))
}

fn dropped(product: &GlobalProduct<'_>, passage: usize, edge: usize) -> Finding {
    let (from, to, name) = route_names(product.robots, &product.passages[passage]);
    let robot = &product.robots[product.passages[passage].to];
    let received = product.passages[passage].waited.and_then(|message| robot.received.get(message));
    let span =
        received.map_or(Span::default(), |received| robot.subject.spans.transition(received.transition));
    let message = format!("`{name}` of `{from}` may arrive at `{to}` where no state reads it, and is lost");
    let found = Diagnostic::warning("E0931", span, message);
    let hint = "defer it in the states before, or wait for it there";
    Finding {
        diagnostic: found.with_hint(hint).in_source(&robot.source),
        trace: trace_to_edge(product, edge),
    }
}

fn channel_overflow(product: &GlobalProduct<'_>, passage: usize, edge: usize, channels: Channels) -> Finding {
    let (from, to, name) = route_names(product.robots, &product.passages[passage]);
    let robot = &product.robots[product.passages[passage].from];
    let span = match robot.sent[product.passages[passage].sent_message].uses.first() {
        Some(&MessageUse::Way(transition)) => robot.subject.spans.transition(transition),
        Some(&MessageUse::Node(node)) => robot.subject.spans.node(node),
        None => Span::default(),
    };
    let max = channels.capacity;
    let message = format!(
        "`{from}` may send more than {max} messages before `{to}` receives the first: `{name}` is lost then"
    );
    let found = Diagnostic::warning("E0932", span, message);
    let hint = "wait for an answer before sending the next one, or enlarge the channel (`--channel`)";
    Finding {
        diagnostic: found.with_hint(hint).in_source(&robot.source),
        trace: trace_to_edge(product, edge),
    }
}

fn not_decided(robots: &[ComposedRobot], behaviours: &[Behaviour], product: &GlobalProduct<'_>) -> Finding {
    let large = robots.iter().zip(behaviours).find(|(_, behaviour)| !behaviour.found.is_finished());
    let message = match large {
        Some((robot, behaviour)) => {
            let states = behaviour.found.states().len();
            format!(
                "undecided whether the robots deadlock: `{}` alone has more than {states} states",
                robot.name
            )
        }
        None => format!(
            "undecided whether the robots deadlock: together they have more than {} states",
            product.states.len()
        ),
    };
    let found = Diagnostic::error("E0933", Span::default(), message);
    let found = found.with_hint("raise the limit with `--states`, or compose fewer robots");
    match robots.first() {
        Some(robot) => found.in_source(&robot.source).into(),
        None => found.into(),
    }
}
