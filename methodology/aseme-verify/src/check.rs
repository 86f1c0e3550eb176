//! Checks of models that can be parsed: `monas model check`.
//!
//! [`check`] reads a model of any kind and searches for faults beyond syntax: unreachable states,
//! choices without an enabled transition, guards that cannot hold. [`CHECKS`] lists all checks.
//! They use three methods:
//!
//! - **structure**: analysis of the tree of states and the transitions between them, independent of
//!   guards;
//! - **guards**: satisfiability of conditions in the [`logic`](crate::logic) of comparisons. What
//!   lies outside it (functions, products of fields) is unknown and never reported;
//! - **exploration**: the state space of the chart, computed with the steps of the machine
//!   ([`yase_explore`]). Such a finding has a trace, which [`yase_explore::replay`] replays.
//!
//! A [`Finding`] is a [`Diagnostic`] with a position in the model's file. The guard `false` means
//! *never* and is never reported.
//!
//! ```
//! use aseme_verify::check::check;
//! use aseme_verify::CheckSettings;
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
//! let report = check(&source, &CheckSettings::default());
//! let matters = report.findings.iter().filter(|finding| finding.diagnostic.severity > Severity::Information);
//! let said: Vec<String> = matters.map(ToString::to_string).collect();
//! assert_eq!(said, ["walker.srm:4:18: warning[M05]: the guards out of `CONDITION` leave cases uncovered: there `Ball.distance` is 2 \
//!     (remove the guard of one transition: it is then taken if no other is)"]);
//! ```

pub(crate) mod events;
mod exploration;
mod freshness;
mod guards;
mod messages;
mod profiles;
mod roles;
mod structure;
mod timers;
mod topics;

use std::collections::BTreeMap;
use std::sync::Arc;

use yase::{Diagnostic, Severity, Source};

use aseme_models::convert::{self, Model};
use aseme_models::iac::Variable;
use aseme_models::ontology;

use crate::check_settings::{CheckSettings, CheckedParts};
use crate::checked_model::{self, CheckedModel};
use crate::diagnostic_names::DiagnosticNames;
use crate::exploration_extent::ExplorationExtent;
use crate::finding::Finding;

/// The method of a check.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum CheckMethod {
    /// Analysis of states and transitions.
    Structure,
    /// Analysis of guards.
    Guards,
    /// Exploration of the chart.
    Exploration,
    /// Analysis of a model of roles, activities and protocols.
    Roles,
}

/// A check.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Check {
    /// The code of its findings.
    pub id: &'static str,
    /// Its method.
    pub kind: CheckMethod,
    /// The highest severity of its findings.
    pub severity: Severity,
    /// The faults that it finds.
    pub title: &'static str,
}

const fn of(id: &'static str, kind: CheckMethod, severity: Severity, title: &'static str) -> Check {
    Check { id, kind, severity, title }
}

/// All checks.
pub const CHECKS: &[Check] = {
    use CheckMethod::{Exploration, Guards, Roles, Structure};
    use Severity::{Error, Information, Warning};
    &[
        of("M01", Structure, Error, "a composite without a valid START"),
        of(
            "M02",
            Structure,
            Error,
            "START or END in a wrong place; a state without an exit that is not an END",
        ),
        of("M03", Structure, Error, "a transition to an invalid target"),
        of("M04", Structure, Error, "FORK or JOIN between states that are not active together"),
        of("M05", Guards, Error, "a branch that may have no enabled transition"),
        of(
            "M06",
            Structure,
            Error,
            "a cycle of connectors, or a path through connectors that is never enabled",
        ),
        of("M07", Guards, Warning, "a transition that is always shadowed by an earlier one"),
        of("M08", Guards, Warning, "two transitions that may be enabled together, without priorities"),
        of("M09", Guards, Warning, "a guard that never or always holds"),
        of("M10", Guards, Warning, "an event on which one region leaves the AND and another stays in it"),
        of("M11", Structure, Warning, "a region that reads what another one may write in the same step"),
        of("M12", Exploration, Warning, "a state that is never reached, a transition that is never taken"),
        of("M13", Exploration, Error, "a livelock: transitions that repeat within one step"),
        of("M14", Exploration, Warning, "a state that is never left and is not an END"),
        of("M15", Exploration, Warning, "a transition that waits for a composite that never completes"),
        of("M16", Structure, Warning, "an event that is never raised or never awaited"),
        of(
            "M17",
            Structure,
            Error,
            "a message, field, function or type that the program does not have, or that is never published or read",
        ),
        of("M18", Exploration, Warning, "a guard on a message that may not have arrived"),
        of(
            "M19",
            Structure,
            Warning,
            "a timer that is read but not started, not read, or restarted before it can expire",
        ),
        of("M20", Structure, Warning, "a HISTORY without a default that may be entered before its composite"),
        of(
            "M21",
            Exploration,
            Error,
            "an activity that the program does not have, or that runs twice at once and publishes; more activities than the pool runs",
        ),
        of(
            "M22",
            Exploration,
            Warning,
            "a transition that can only be taken while an activity that it leaves runs",
        ),
        of("M23", Structure, Error, "weights that are not shares, or contradict priorities"),
        of("M24", Exploration, Error, "a chart that does other than its formulas say"),
        of("M25", Structure, Information, "what other engines read differently"),
        of("M26", Exploration, Information, "how large the chart is"),
        of("M27", Exploration, Warning, "a loop in which nothing waits"),
        of("M28", Exploration, Warning, "an event that may wait any number of times"),
        of(
            "M29",
            Structure,
            Warning,
            "a guard that reads, right after an activity ended, what is derived elsewhere from what ended it",
        ),
        of("S01", Roles, Warning, "an activity without a functionality"),
        of("S02", Roles, Warning, "a functionality that no activity uses"),
        of("S03", Roles, Warning, "an activity in no formula"),
        of("S04", Roles, Warning, "a participant of no protocol"),
        of("S05", Roles, Warning, "a name in a formula that is not an activity of the model"),
    ]
};

/// The result of a check.
#[derive(Clone, PartialEq, Debug, Default)]
#[non_exhaustive]
pub struct CheckReport {
    /// The kind of the model; none if it could not be read.
    pub kind: Option<String>,
    /// The findings, in the order of the file.
    pub findings: Vec<Finding>,
    /// The extent of the exploration, if the chart was explored.
    pub explored: Option<ExplorationExtent>,
    /// Whether the observer stopped the checks of nodes and transitions, so that some are missing.
    pub is_stopped: bool,
    /// The names of the chart's nodes in messages.
    names: Option<Arc<DiagnosticNames>>,
}

impl CheckReport {
    /// The report for a file that cannot be read.
    pub fn of_unreadable(diagnostic: Diagnostic) -> CheckReport {
        unreadable(vec![diagnostic])
    }

    /// Whether the model could not be read; then no checks were run.
    pub fn is_unreadable(&self) -> bool {
        self.kind.is_none()
    }

    /// The paths of the states that a finding names, by the names that its message and its hint
    /// have for them.
    pub fn state_paths(&self, finding: &Finding) -> BTreeMap<String, String> {
        let Some(names) = &self.names else { return BTreeMap::new() };
        let texts = [Some(&finding.diagnostic.message), finding.diagnostic.hint.as_ref()];
        let quoted = texts.into_iter().flatten().flat_map(|text| text.split('`').skip(1).step_by(2));
        let ends = quoted.flat_map(|quoted| quoted.split(" -> "));
        ends.filter_map(|name| Some((name.to_owned(), names.path(names.find(name)?)))).collect()
    }

    /// Whether any finding is an error.
    pub fn has_errors(&self) -> bool {
        self.findings.iter().any(|finding| finding.diagnostic.is_error())
    }
}

/// Reads a model and checks it. If it cannot be read, the report has only the errors of reading;
/// otherwise these come before the findings of the checks.
pub fn check(source: &Arc<Source>, settings: &CheckSettings) -> CheckReport {
    let (found, read) = convert::read(source);
    let mut report = match found {
        None => unreadable(read),
        Some((Model::Role(_), _)) if aseme::have_formula_errors(&read) => unreadable(read),
        Some((Model::Role(file), _)) => about(checked_model::of_role(file.srm()), &[], read, settings),
        Some((Model::Chart(_), convert::Format::Scxml)) => scxml(source, settings),
        Some((Model::Chart(chart), _)) => {
            about(checked_model::of_chart(&chart), &chart.variables, read, settings)
        }
        Some((model, _)) if !read.iter().any(Diagnostic::is_error) => {
            let what = format!("a model of the kind {}", model.kind());
            CheckReport {
                kind: Some(what),
                findings: findings(read, roles::check(&model, settings.world.as_ref())),
                ..CheckReport::default()
            }
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

fn unreadable(read: Vec<Diagnostic>) -> CheckReport {
    CheckReport { findings: findings(read, Vec::new()), ..CheckReport::default() }
}

fn findings(read: Vec<Diagnostic>, found: Vec<Diagnostic>) -> Vec<Finding> {
    read.into_iter().chain(found).map(Finding::from).collect()
}

/// An SCXML document has its own semantics, and its expressions are in a script language that is
/// not analysed.
fn scxml(source: &Arc<Source>, settings: &CheckSettings) -> CheckReport {
    let (document, read) = yase_scxml::read(source);
    match document {
        Some(document) => charted((checked_model::of_scxml(&document), Vec::new()), read, settings),
        None => unreadable(read),
    }
}

/// Checks a chart with YASE expressions and its messages.
fn about(
    (subject, made): (CheckedModel, Vec<Diagnostic>),
    variables: &[Variable],
    read: Vec<Diagnostic>,
    settings: &CheckSettings,
) -> CheckReport {
    let (_, mut found) = ontology::of(&subject.chart, variables);
    found.extend(settings.world.iter().flat_map(|world| ontology::check(variables, &world.vocabulary)));
    let mut report = charted((subject, made), read, settings);
    report.findings.extend(findings(found, Vec::new()));
    report
}

fn charted(
    (subject, made): (CheckedModel, Vec<Diagnostic>),
    read: Vec<Diagnostic>,
    settings: &CheckSettings,
) -> CheckReport {
    let read: Vec<Diagnostic> = read.into_iter().chain(made).collect();
    if read.iter().any(Diagnostic::is_error) {
        return unreadable(read);
    }
    // The guards of each are checked, and names and structure once for all.
    let size = subject.chart.nodes().len() + subject.chart.transitions().len();
    let parts = CheckedParts::new(settings, 2 * size);
    let mut found = structure::check(&subject);
    if parts.go_on_after(size) && !found.iter().any(Diagnostic::is_error) {
        about_parts(&subject, settings, &parts, &mut found);
    }
    let is_stopped = parts.is_stopped();
    let can_be_explored =
        settings.states > 0 && !is_stopped && is_ours(&subject) && !found.iter().any(Diagnostic::is_error);
    let (explored, extent) = match can_be_explored {
        true => exploration::check(&subject, settings, &found),
        false => (Vec::new(), None),
    };
    let (nodes, transitions) = (subject.chart.nodes().len(), subject.chart.transitions().len());
    let mut findings = findings(read, found);
    findings.extend(explored);
    CheckReport {
        kind: Some(format!("{nodes} nodes, {transitions} transitions")),
        findings,
        explored: extent,
        is_stopped,
        names: Some(subject.names.clone()),
    }
}

/// The checks of a chart without structural errors, until the observer stops them.
fn about_parts(
    subject: &CheckedModel,
    settings: &CheckSettings,
    parts: &CheckedParts<'_>,
    found: &mut Vec<Diagnostic>,
) {
    found.extend(events::check(subject, settings));
    found.extend(timers::check(subject));
    found.extend(guards::check(subject, parts));
    let checks: [&dyn Fn() -> Vec<Diagnostic>; 4] = [
        &|| profiles::check(subject),
        &|| messages::same_step(subject),
        // The scripts of other charts name nothing of the program.
        &|| match settings.world.as_ref().filter(|_| is_ours(subject)) {
            Some(world) => {
                let mut found = messages::names(subject, world);
                found.extend(topics::unmet(subject, world));
                found
            }
            None => messages::names_like_formulas(subject),
        },
        &|| settings.world.iter().flat_map(|world| freshness::stale(subject, world)).collect(),
    ];
    for check in checks {
        if !parts.go_on_after(0) {
            return;
        }
        found.extend(check());
    }
}

/// Whether a chart has YASE semantics; scripts of other charts are not analysed.
fn is_ours(subject: &CheckedModel) -> bool {
    subject.semantics == yase::Semantics::yase()
}
