//! Several robots together: whether they wait for each other for ever.
//!
//! Each model is a robot of its own. A message passes from one to another if the one's chart writes or publishes it and the other's reads it by that one's name
//! (`receiver.news.Signal.Ready`). It goes by a channel from the one to the other, which holds a bounded number of messages and loses the oldest when one more comes,
//! as a link does; a channel may lose any, if that is asked for. What a chart says to itself, and waits for, goes the same way. A chart that has ended, or that TERMINATE has stopped, says
//! and waits for nothing any more. Everything else that guards ask is free to hold or not, activities return and timers expire in any order.
//!
//! What is found: waits that never end, since no robot will say what they are for (E0930); messages that come where nobody takes them (E0931);
//! channels that are too small (E0932). A finding shows a way there, which [`Joint`] plays. What the search did not come to the end of is not decided, and said so (E0933).
//!
//! Of a message that an activity publishes only a [`World`](super::World) knows; it is taken to be published when the activity returns.

mod contents;
mod joint;
mod product;
mod robot;
mod stuck;
mod words;

use std::sync::Arc;

use yase::{Diagnostic, Source, Span};

use super::abstraction::Abstraction;
use super::{Finding, Settings};
use product::{Passage, Product};
use robot::{Behaviour, Hearing, Robot};
use stuck::Standstill;
use words::Place;

pub use joint::{Joint, Played};

/// How messages go from robot to robot.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct Channels {
    /// How many messages are on their way at once from one robot to another; one more, and the oldest is lost.
    pub capacity: usize,
    /// Whether any message may be lost.
    pub may_lose: bool,
}

impl Default for Channels {
    fn default() -> Channels {
        Channels { capacity: 2, may_lose: false }
    }
}

/// What is to be said of robots together.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
#[non_exhaustive]
pub struct Composition {
    /// What is wrong, by robot.
    pub findings: Vec<Finding>,
    /// Each robot, and how many states of its own were looked at.
    pub robots: Vec<(String, usize)>,
    /// What passes: from whom, to whom, and the message's name.
    pub passing: Vec<(String, String, String)>,
    /// How many states of all together were found.
    pub states: usize,
    /// Whether these are all.
    pub is_finished: bool,
}

impl Composition {
    /// Whether something is wrong that is an error.
    pub fn has_errors(&self) -> bool {
        self.findings.iter().any(|finding| finding.diagnostic.is_error())
    }
}

/// Looks at all that robots can do together: names, each once, and their models.
///
/// # Errors
/// What keeps a model from being explored.
pub fn compose(
    models: &[(String, Arc<Source>)],
    channels: Channels,
    settings: &Settings,
) -> Result<Composition, Vec<Diagnostic>> {
    let robots = robots(models, settings)?;
    let passages = product::passages(&robots);
    let mut found = Composition {
        passing: passages.iter().map(|passage| passing(&robots, passage)).collect(),
        ..Composition::default()
    };
    found.findings.extend(robots.iter().filter_map(unexplorable).map(Finding::from));
    found.findings.extend(unsaid(&robots, &passages).map(Finding::from));
    if found.has_errors() {
        return Ok(found);
    }
    let behaviours = behaviours(&robots, &passages, settings);
    let counts = behaviours.iter().map(|it| it.found.states().len());
    found.robots = robots.iter().map(|robot| robot.name.clone()).zip(counts).collect();
    let product = product::product(&robots, &behaviours, &passages, channels, settings.states);
    (found.states, found.is_finished) = (product.states.len(), product.is_finished());
    found.findings.extend(stuck::standstills(&product).iter().map(|it| standstill(&product, it)));
    found.findings.extend(product.dropped.iter().map(|(&passage, &edge)| dropped(&product, passage, edge)));
    found
        .findings
        .extend(product.crowded.iter().map(|(&passage, &edge)| crowded(&product, passage, edge, channels)));
    found.findings.extend((!found.is_finished).then(|| not_decided(&robots, &behaviours, &product)));
    Ok(found)
}

fn robots(models: &[(String, Arc<Source>)], settings: &Settings) -> Result<Vec<Robot>, Vec<Diagnostic>> {
    let hosts: Vec<&str> = models.iter().map(|(name, _)| name.as_str()).collect();
    let mut wrong = Vec::new();
    let mut robots = Vec::new();
    for (name, source) in models {
        match ready(source, settings) {
            Ok(chart) => robots.push(Robot::new(name, source, chart, &hosts, settings.world.as_ref())),
            Err(found) => wrong.extend(found),
        }
    }
    if wrong.is_empty() { Ok(robots) } else { Err(wrong) }
}

fn ready(
    source: &Arc<Source>,
    settings: &Settings,
) -> Result<(super::subject::Subject, Abstraction), Vec<Diagnostic>> {
    let subject = super::subject_of(source)?;
    let abstraction = Abstraction::new(&subject).map_err(|found| super::placed(source, found))?;
    Ok((subject, abstraction.with_events(&settings.events)))
}

/// What each robot does, explored alone.
fn behaviours(robots: &[Robot], passages: &[Passage], settings: &Settings) -> Vec<Behaviour> {
    let is_heard = |number: usize, saying: usize| {
        passages.iter().any(|passage| passage.from == number && passage.saying == saying)
    };
    let explored = |(number, robot): (usize, &Robot)| {
        let heard: Vec<bool> = (0..robot.sayings.len()).map(|saying| is_heard(number, saying)).collect();
        robot.explored(settings, &heard)
    };
    robots.iter().enumerate().map(explored).collect()
}

fn passing(robots: &[Robot], passage: &Passage) -> (String, String, String) {
    let from = &robots[passage.from];
    let name = from.sayings[passage.saying].word.name().to_owned();
    (from.name.clone(), robots[passage.to].name.clone(), name)
}

/// What keeps a robot's messages from being told apart.
fn unexplorable(robot: &Robot) -> Option<Diagnostic> {
    robot.ambiguous().or_else(|| {
        let way = robot::takes_whatever(&robot.subject.chart)?;
        let message =
            format!("`{}` takes whatever event comes: it is not known which messages those are", robot.name);
        let found = Diagnostic::error("E0935", robot.subject.places.transition(way), message);
        Some(found.with_hint("name the events").in_source(&robot.source))
    })
}

/// Messages that are waited for, and that no model says.
fn unsaid<'a>(robots: &'a [Robot], passages: &'a [Passage]) -> impl Iterator<Item = Diagnostic> + 'a {
    robots.iter().enumerate().flat_map(move |(to, robot)| {
        let is_said =
            move |hearing: usize| passages.iter().any(|it| it.to == to && it.hearings.contains(&hearing));
        let unsaid = robot.hearings.iter().enumerate().filter(move |(hearing, _)| !is_said(*hearing));
        unsaid.map(|(_, hearing)| nobody_says(robot, hearing))
    })
}

fn nobody_says(robot: &Robot, hearing: &Hearing) -> Diagnostic {
    let (host, name) = (&hearing.called.host, hearing.called.word.name());
    let message = format!(
        "the chart of `{host}` does not say `{name}`, which `{}` waits for: it may come at any time",
        robot.name
    );
    let found = Diagnostic::warning("E0934", robot.subject.places.transition(hearing.way), message);
    found.with_hint("with `--linked` the program says what activities publish").in_source(&robot.source)
}

fn standstill(product: &Product<'_>, found: &Standstill) -> Finding {
    let waits: Vec<String> = found
        .waits
        .iter()
        .map(|&(robot, wait)| {
            let robot = &product.robots[robot];
            let wait = &robot.waits[wait];
            let called = &robot.hearings[wait.hearing].called;
            let (name, path) = (&robot.name, robot.subject.path(wait.node));
            format!("`{name}` waits in `{path}` for `{}` of `{}`", called.word.name(), called.host)
        })
        .collect();
    let message = match waits.as_slice() {
        [one] => format!("{one}, which never comes"),
        several => format!("{}: none of it ever comes", several.join(", ")),
    };
    let (robot, wait) = found.waits.first().copied().unwrap_or_default();
    let robot = &product.robots[robot];
    let place =
        robot.waits.get(wait).map_or(Span::default(), |wait| robot.subject.places.transition(wait.way));
    let diagnostic = Diagnostic::error("E0930", place, message)
        .with_hint("let one of them go on by itself: say its message first, or wait no longer than a timer")
        .in_source(&robot.source);
    Finding { diagnostic, trace: Some(product.told(&product.way_to(found.state))) }
}

/// The way to an edge, and that.
fn told_with(product: &Product<'_>, edge: usize) -> Option<String> {
    let edge = product.edges.get(edge)?;
    let mut way = product.way_to(edge.from);
    way.push(edge.by);
    Some(product.told(&way))
}

fn dropped(product: &Product<'_>, passage: usize, edge: usize) -> Finding {
    let (from, to, name) = passing(product.robots, &product.passages[passage]);
    let robot = &product.robots[product.passages[passage].to];
    let hearing = product.passages[passage].waited.and_then(|hearing| robot.hearings.get(hearing));
    let place = hearing.map_or(Span::default(), |hearing| robot.subject.places.transition(hearing.way));
    let message =
        format!("`{name}` of `{from}` may come to `{to}` where nothing waits for it: then it is lost");
    let found = Diagnostic::warning("E0931", place, message);
    let hint = "defer it in the states before, or wait for it there too";
    Finding { diagnostic: found.with_hint(hint).in_source(&robot.source), trace: told_with(product, edge) }
}

fn crowded(product: &Product<'_>, passage: usize, edge: usize, channels: Channels) -> Finding {
    let (from, to, name) = passing(product.robots, &product.passages[passage]);
    let robot = &product.robots[product.passages[passage].from];
    let place = match robot.sayings[product.passages[passage].saying].places.first() {
        Some(&Place::Way(way)) => robot.subject.places.transition(way),
        Some(&Place::Node(node)) => robot.subject.places.node(node),
        None => Span::default(),
    };
    let most = channels.capacity;
    let message = format!(
        "`{from}` may say more than {most} messages before `{to}` has heard the first: `{name}` is lost then"
    );
    let found = Diagnostic::warning("E0932", place, message);
    let hint = "wait for an answer before the next one is said, or let the channel hold more (`--channel`)";
    Finding { diagnostic: found.with_hint(hint).in_source(&robot.source), trace: told_with(product, edge) }
}

fn not_decided(robots: &[Robot], behaviours: &[Behaviour], product: &Product<'_>) -> Finding {
    let large = robots.iter().zip(behaviours).find(|(_, behaviour)| !behaviour.found.is_finished());
    let message = match large {
        Some((robot, behaviour)) => {
            let states = behaviour.found.states().len();
            format!(
                "it is not decided whether the robots wait for ever: `{}` alone has more than {states} states",
                robot.name
            )
        }
        None => format!(
            "it is not decided whether the robots wait for ever: together they have more than {} states",
            product.states.len()
        ),
    };
    let found = Diagnostic::error("E0933", Span::default(), message);
    let found = found.with_hint("look at more with `--states`, or at fewer robots at once");
    match robots.first() {
        Some(robot) => found.in_source(&robot.source).into(),
        None => found.into(),
    }
}
