//! What is wrong with a model that can be read: the checks of `monas model check`.
//!
//! [`check`] reads a model of any kind and looks for faults that no grammar sees: states that nothing leads to, choices that may have no way out,
//! guards that cannot hold. [`CHECKS`] lists them all. Their kinds say how they know:
//!
//! - **structure**: the tree of states and the transitions between them, whatever guards say;
//! - **guards**: what conditions say, by the [`logic`] of comparisons. What lies outside of it (functions, products of messages) is unknown, and of what is
//!   unknown nothing is reported;
//! - **exploration**: what a chart can do, found by the machine's own steps ([`yase::explore`]). Such a finding shows a way there, which [`yase::explore::replay`] plays.
//!
//! A [`Finding`] is a [`Diagnostic`] with a place in the model's file. The code `false` as a guard means *never*, and is never held against a model.
//!
//! ```
//! use aseme::check::{Settings, check};
//! use yase::{Severity, Source};
//!
//! let source = Source::new("walker.srm", "
//! Role: walker
//! Liveness:
//! walker = Look . (Turn | Walk)
//! Transitions:
//! CONDITION -> Turn : [Ball.distance > 2]
//! CONDITION -> Walk : [Ball.distance < 2]
//! ");
//! let report = check(&source, &Settings::default());
//! let matters = report.findings.iter().filter(|finding| finding.diagnostic.severity > Severity::Information);
//! let said: Vec<String> = matters.map(ToString::to_string).collect();
//! assert_eq!(said, ["walker.srm:4:18: warning[M05]: the ways out of `CONDITION` leave cases open: there `Ball.distance` is 2 \
//!     (let one of them be without a guard: it is taken when no other is)"]);
//! ```

pub(crate) mod abstraction;
pub mod compose;
mod conformance;
mod events;
mod exploration;
mod guards;
mod language;
pub mod logic;
mod places;
mod profiles;
mod protocol;
mod roles;
mod structure;
mod subject;
mod timers;
mod topics;
mod world;

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

use yase::{Diagnostic, Severity, Source, Span, Statechart};

pub use protocol::{Conformance, chart_conforms, parts_taken, player_conforms};
pub use world::World;

use crate::convert::{self, Model};
use crate::iac::Variable;
use crate::ontology;
use subject::Subject;

/// How a check knows.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum Kind {
    /// From states and transitions.
    Structure,
    /// From what guards say.
    Guards,
    /// From what the chart can do.
    Exploration,
    /// From a model of roles, activities and protocols.
    Roles,
}

/// A check.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Check {
    /// The code of its findings.
    pub id: &'static str,
    /// How it knows.
    pub kind: Kind,
    /// How much its findings matter at most.
    pub severity: Severity,
    /// What it finds.
    pub title: &'static str,
}

const fn of(id: &'static str, kind: Kind, severity: Severity, title: &'static str) -> Check {
    Check { id, kind, severity, title }
}

/// Every check there is.
pub const CHECKS: &[Check] = {
    use Kind::{Exploration, Guards, Roles, Structure};
    use Severity::{Error, Information, Warning};
    &[
        of("M01", Structure, Error, "a composite does not begin as it should"),
        of(
            "M02",
            Structure,
            Error,
            "START or END in a wrong place; a state that nothing leads out of and that is no END",
        ),
        of("M03", Structure, Error, "a transition to where none can lead"),
        of("M04", Structure, Error, "FORK or JOIN between states that are not active together"),
        of("M05", Guards, Error, "a branch that may have no open way"),
        of("M06", Structure, Error, "connectors in a circle, or a way through them that is never open"),
        of("M07", Guards, Warning, "a transition that an earlier one always wins over"),
        of(
            "M08",
            Guards,
            Warning,
            "two transitions that may be enabled together, with nothing said of which is taken",
        ),
        of("M09", Guards, Warning, "a guard that never holds, or always"),
        of("M10", Guards, Warning, "an event that one region answers by leaving and another by staying"),
        of("M11", Structure, Warning, "a region that reads what another one may write in the same step"),
        of("M12", Exploration, Warning, "a state that is never reached, a transition that is never taken"),
        of("M13", Exploration, Error, "transitions that lead on and on within one step"),
        of("M14", Exploration, Warning, "a state that is never left and is no END"),
        of(
            "M15",
            Exploration,
            Warning,
            "a transition that waits for a composite to complete which never can",
        ),
        of("M16", Structure, Warning, "an event that is never raised, or never waited for"),
        of(
            "M17",
            Structure,
            Error,
            "a message, field, function or type that the program does not have, or that nobody publishes or reads",
        ),
        of("M18", Exploration, Warning, "a guard on a message that need not have come"),
        of(
            "M19",
            Structure,
            Warning,
            "a timer that is read but not started, not read, or started again before it can expire",
        ),
        of("M20", Structure, Warning, "a HISTORY that may be entered with nothing recorded and no default"),
        of(
            "M21",
            Exploration,
            Error,
            "an activity that the program does not have, or that runs twice at once and publishes; more of them than the pool runs",
        ),
        of(
            "M22",
            Exploration,
            Warning,
            "a transition that can only be taken while an activity that it leaves runs",
        ),
        of("M23", Structure, Error, "weights that are no shares, or contradict priorities"),
        of("M24", Exploration, Error, "a chart that does other than its formulas say"),
        of("M25", Structure, Information, "what other engines read in another way"),
        of("M26", Exploration, Information, "how large the chart is"),
        of("S01", Roles, Warning, "an activity without a functionality"),
        of("S02", Roles, Warning, "a functionality that no activity uses"),
        of("S03", Roles, Warning, "an activity in no formula"),
        of("S04", Roles, Warning, "a participant of no protocol"),
        of("S05", Roles, Warning, "a name in a formula that is no activity of the model"),
    ]
};

/// What a check is told beside the model.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Settings {
    /// Events that come from outside the chart: activities, other agents and people raise them.
    pub events: BTreeSet<String>,
    /// How many states an exploration looks at; with 0 there is none.
    pub states: usize,
    /// How many activities the agent's pool runs at once; 12 if it is not said.
    pub pool: Option<usize>,
    /// The messages, functions and activities that there are; names are not judged if it is not said.
    pub world: Option<World>,
    /// What charts have been through, as recordings tell.
    pub recorded: Vec<Recorded>,
}

/// What a chart has been through in runs that were recorded.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// The chart.
    pub chart: Statechart,
    /// The nodes that were entered at least once.
    pub entered: BTreeSet<yase::NodeId>,
    /// The transitions that fired at least once.
    pub fired: BTreeSet<yase::TransitionId>,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings { events: BTreeSet::new(), states: 100_000, pool: None, world: None, recorded: Vec::new() }
    }
}

/// Something that a check has found.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct Finding {
    /// What is wrong, where, and what would be right.
    pub diagnostic: Diagnostic,
    /// A way there, as text that [`yase::explore::Trace::parse`] reads on the [abstraction](explorable) of the chart.
    pub trace: Option<String>,
}

impl From<Diagnostic> for Finding {
    fn from(diagnostic: Diagnostic) -> Finding {
        Finding { diagnostic, trace: None }
    }
}

/// How far an exploration came.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct Explored {
    /// How many states of the machine it found.
    pub states: usize,
    /// How many different configurations there are among them.
    pub configurations: usize,
    /// Whether these are all.
    pub is_finished: bool,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.diagnostic.fmt(f)
    }
}

/// What is to be said of a model.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
#[non_exhaustive]
pub struct Report {
    /// What kind of model it is; none if it could not be read.
    pub what: Option<String>,
    /// What is wrong, in the order of the file.
    pub findings: Vec<Finding>,
    /// How far the exploration of the chart came, if it was explored.
    pub explored: Option<Explored>,
}

impl Report {
    /// What is to be said of a file that cannot be read.
    pub fn of_unreadable(diagnostic: Diagnostic) -> Report {
        unreadable(vec![diagnostic])
    }

    /// Whether the model could not be read: then nothing was checked.
    pub fn is_unreadable(&self) -> bool {
        self.what.is_none()
    }

    /// Whether something is wrong that is an error.
    pub fn has_errors(&self) -> bool {
        self.findings.iter().any(|finding| finding.diagnostic.is_error())
    }
}

/// Reads a model and checks it. If it cannot be read, what is wrong with the text is all that is said; else that comes before what the checks find.
pub fn check(source: &Arc<Source>, settings: &Settings) -> Report {
    let (found, read) = convert::read(source);
    let mut report = match found {
        None => unreadable(read),
        Some((Model::Role(file), _)) => about(subject::of_role(file.srm()), &[], read, settings),
        Some((Model::Chart(_), convert::Format::Scxml)) => scxml(source, settings),
        Some((Model::Chart(chart), _)) => about(subject::of_chart(&chart), &chart.variables, read, settings),
        Some((model, _)) if !read.iter().any(Diagnostic::is_error) => {
            let what = format!("a model of the kind {}", model.kind());
            Report { what: Some(what), findings: findings(read, roles::check(&model)), explored: None }
        }
        Some(_) => unreadable(read),
    };
    for finding in &mut report.findings {
        finding.diagnostic = finding.diagnostic.clone().in_source(source);
    }
    report.findings.sort_by_key(|finding| (finding.diagnostic.span, finding.diagnostic.code));
    report.findings.dedup();
    report
}

fn unreadable(read: Vec<Diagnostic>) -> Report {
    Report { what: None, findings: findings(read, Vec::new()), explored: None }
}

fn findings(read: Vec<Diagnostic>, found: Vec<Diagnostic>) -> Vec<Finding> {
    read.into_iter().chain(found).map(Finding::from).collect()
}

/// SCXML is read with its own meaning, and its expressions are in a language of its own, of which nothing is known here.
fn scxml(source: &Arc<Source>, settings: &Settings) -> Report {
    let (document, read) = yase::scxml::read(source);
    match document {
        Some(document) => charted((subject::of_scxml(&document), Vec::new()), read, settings),
        None => unreadable(read),
    }
}

/// A chart in our own language, and what it says of messages.
fn about(
    (subject, made): (Subject, Vec<Diagnostic>),
    variables: &[Variable],
    read: Vec<Diagnostic>,
    settings: &Settings,
) -> Report {
    let (_, mut found) = ontology::of(&subject.chart, variables);
    found.extend(settings.world.iter().flat_map(|world| ontology::check(variables, &world.vocabulary)));
    let mut report = charted((subject, made), read, settings);
    report.findings.extend(findings(found, Vec::new()));
    report
}

fn charted(
    (subject, made): (Subject, Vec<Diagnostic>),
    read: Vec<Diagnostic>,
    settings: &Settings,
) -> Report {
    let read: Vec<Diagnostic> = read.into_iter().chain(made).collect();
    if read.iter().any(Diagnostic::is_error) {
        return unreadable(read);
    }
    let mut found = structure::check(&subject);
    if !found.iter().any(Diagnostic::is_error) {
        found.extend(events::check(&subject, settings));
        found.extend(timers::check(&subject));
        found.extend(guards::check(&subject));
        found.extend(profiles::check(&subject));
        found.extend(world::same_step(&subject));
        found.extend(settings.world.iter().flat_map(|world| world::names(&subject, world)));
        found.extend(settings.world.iter().flat_map(|world| topics::unmet(&subject, world)));
    }
    let can_be_explored = settings.states > 0 && is_ours(&subject) && !found.iter().any(Diagnostic::is_error);
    let (explored, extent) = match can_be_explored {
        true => exploration::check(&subject, settings, &found),
        false => (Vec::new(), None),
    };
    let (nodes, transitions) = (subject.chart.nodes().len(), subject.chart.transitions().len());
    let mut findings = findings(read, found);
    findings.extend(explored);
    Report { what: Some(format!("{nodes} nodes, {transitions} transitions")), findings, explored: extent }
}

/// Whether a chart is read as the thesis has it: of others it is not known what their scripts do.
fn is_ours(subject: &Subject) -> bool {
    subject.semantics == yase::Semantics::yase()
}

/// The chart that explorations of a model run on and that their traces are about: what guards ask of data is a condition of the surroundings.
///
/// # Errors
/// What keeps the model from being read or made ready to run.
pub fn explorable(source: &Arc<Source>) -> Result<Arc<yase::Chart>, Vec<Diagnostic>> {
    abstracted(source).map(|abstraction| abstraction.chart)
}

/// A model made ready to be explored.
pub(crate) fn abstracted(source: &Arc<Source>) -> Result<abstraction::Abstraction, Vec<Diagnostic>> {
    let subject = subject_of(source)?;
    abstraction::Abstraction::new(&subject).map_err(|found| placed(source, found))
}

/// The chart of a model, and where each of its transitions stands in the text.
///
/// # Errors
/// What keeps the model from being read.
pub(crate) fn chart_and_places(source: &Arc<Source>) -> Result<(Statechart, Vec<Span>), Vec<Diagnostic>> {
    let Subject { chart, places, .. } = subject_of(source)?;
    Ok((chart, places.transitions))
}

/// What there is to be looked at in a model with a chart.
fn subject_of(source: &Arc<Source>) -> Result<Subject, Vec<Diagnostic>> {
    let (found, mut read) = convert::read(source);
    let (subject, made) = match found {
        Some((Model::Role(file), _)) => subject::of_role(file.srm()),
        Some((Model::Chart(chart), _)) => subject::of_chart(&chart),
        Some((model, _)) => {
            let message = format!("a model of the kind {} has no statechart", model.kind());
            return Err(placed(source, vec![Diagnostic::error("E0230", Span::default(), message)]));
        }
        None => return Err(read),
    };
    read.extend(made);
    if read.iter().any(Diagnostic::is_error) {
        return Err(placed(source, read));
    }
    Ok(subject)
}

fn placed(source: &Arc<Source>, found: Vec<Diagnostic>) -> Vec<Diagnostic> {
    found.into_iter().map(|diagnostic| diagnostic.in_source(source)).collect()
}
