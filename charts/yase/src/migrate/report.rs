//! The result of a migration, or the reasons for its rejection.

use std::fmt;

use crate::ids::{Activation, ScopeId};
use crate::statechart::StateNames;

/// The result of a migration.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
#[non_exhaustive]
pub struct MigrationReport {
    /// The disposition of each item.
    pub findings: Vec<MigrationFinding>,
    /// The running or waiting activities, with their old and new activations.
    pub activations: Vec<(Activation, Activation)>,
    /// The scopes that continue, with their old and new numbers: all others of the old chart are no
    /// longer used, and all others of the new chart are filled when their region is entered, or in
    /// the next step.
    pub regions: Vec<(ScopeId, ScopeId)>,
    /// The regions, by path, that are entered in the next step.
    pub to_enter: Vec<String>,
}

impl MigrationReport {
    /// The items that were lost.
    pub fn losses(&self) -> impl Iterator<Item = &MigrationFinding> {
        self.findings.iter().filter(|finding| matches!(finding.verdict, Disposition::Lost(_)))
    }

    pub(crate) fn add(&mut self, subject: MigratedItem, name: impl Into<String>, verdict: Disposition) {
        self.findings.push(MigrationFinding { subject, name: name.into(), verdict });
    }
}

/// The disposition of one item.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct MigrationFinding {
    /// The kind of item.
    pub subject: MigratedItem,
    /// Its name in the old chart; for an added state, in the new one.
    pub name: String,
    /// Its disposition.
    pub verdict: Disposition,
}

/// The kind of item of a [`MigrationFinding`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
#[non_exhaustive]
pub enum MigratedItem {
    /// An active node.
    State,
    /// The activity of an active state.
    Activation,
    /// The value of a HISTORY.
    History,
    /// A transition into a JOIN that waits for the others.
    Arrival,
    /// A timer that is set.
    Timer,
    /// A queued event.
    Event,
    /// A deferred event.
    DeferredEvent,
    /// An event that waits for running activities.
    HeldEvent,
    /// An interrupting transition that waits for activities to return.
    PendingTransition,
}

/// The outcome of a migration for one item.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Disposition {
    /// It is unchanged.
    Kept,
    /// It continues under another name.
    Moved(String),
    /// This node replaces it, as the caller requested.
    Replaced(String),
    /// It is new: a composite added around active nodes is active as if it had always been there.
    Added,
    /// It is lost, for this reason.
    Lost(&'static str),
}

/// A rejected migration: the list of all conflicts. Nothing has changed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct MigrationError {
    reasons: Box<[Conflict]>,
}

/// One conflict of a migration.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Conflict {
    /// The mapping is for a machine of another chart.
    #[error("the plan is not for the chart that runs")]
    OtherChart,
    /// The new chart was compiled for another semantics.
    #[error("the new chart has other semantics")]
    OtherSemantics,
    /// A step is in progress.
    #[error("a step is under way: a chart is swapped between steps")]
    MidStep,
    /// An active node has no counterpart.
    #[error("`{state}` is active, and {why}: say what replaces it")]
    StateGone {
        /// Its path.
        state: String,
        /// The reason.
        why: &'static str,
    },
    /// A running or waiting activity belongs to a state that is gone or has no activity now.
    #[error("`{activity}` runs in `{state}`, which has no such activity now")]
    ActivityGone {
        /// The path of the state.
        state: String,
        /// The name of the activity.
        activity: String,
    },
    /// An active state has another activity, which has not been started.
    #[error(
        "the activity of `{state}` is `{new}` now, which has not run: have the state replaced by one that leads to it"
    )]
    ActivityChanged {
        /// The path of the state.
        state: String,
        /// The activity of its counterpart.
        new: String,
    },
    /// A transition that waits for activities requested to return is not in the new chart.
    #[error("`{0}` waits for activities that it has asked to return, and is no more: let it happen first")]
    PendingGone(String),
    /// The active nodes would not be a configuration of the new chart.
    #[error("{0}")]
    NotClosed(String),
    /// An item would be lost without the consent of the caller.
    #[error("the {} `{}` would be lost: {}", .0.subject, .0.name, .0.verdict)]
    Loss(MigrationFinding),
}

/// Findings and conflicts as text, with the short names of states instead of their paths.
pub fn brief_lines(lines: &[&str]) -> Vec<String> {
    // what a line is about belongs to one chart; what follows may belong to the other
    let names = StateNames::from_some(lines.iter().filter_map(|line| quoted_paths(line).next()));
    let brief = |line: &&str| {
        let mut text = (*line).to_owned();
        for (index, path) in quoted_paths(line).enumerate() {
            let name = if index == 0 { names.short(path).to_owned() } else { StateNames::brief(path) };
            text = text.replacen(path, &name, 1);
        }
        text
    };
    lines.iter().map(brief).collect()
}

/// The paths of states between backquotes. Other texts there may look like paths, such as topics:
/// these have no operators of formulas, and stand in other lines.
fn quoted_paths(line: &str) -> impl Iterator<Item = &str> {
    let is_finding = ["state `", "activity `", "history `", "arrival `", "timer `", "pending transition `"]
        .iter()
        .any(|word| line.starts_with(word));
    let items = line.split('`').skip(1).step_by(2).flat_map(|quoted| quoted.split(" -> "));
    let paths = items.map(|item| item.split_once(": ").map_or(item, |(path, _)| path));
    paths.filter(move |path| path.contains('/') && (is_finding || path.contains(['~', '|', '('])))
}

impl MigrationError {
    pub(crate) fn of(reasons: Vec<Conflict>) -> MigrationError {
        MigrationError { reasons: reasons.into() }
    }

    /// All conflicts; at least one.
    pub fn reasons(&self) -> &[Conflict] {
        &self.reasons
    }
}

impl std::error::Error for MigrationError {}

impl fmt::Display for MigrationError {
    /// One conflict per line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the chart is not swapped")?;
        self.reasons.iter().try_for_each(|reason| write!(f, "\n  {reason}"))
    }
}

impl fmt::Display for MigratedItem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            MigratedItem::State => "state",
            MigratedItem::Activation => "activity",
            MigratedItem::History => "history",
            MigratedItem::Arrival => "arrival",
            MigratedItem::Timer => "timer",
            MigratedItem::Event => "event",
            MigratedItem::DeferredEvent => "deferred event",
            MigratedItem::HeldEvent => "held event",
            MigratedItem::PendingTransition => "pending transition",
        })
    }
}

impl fmt::Display for Disposition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Disposition::Kept => f.write_str("kept"),
            Disposition::Moved(to) => write!(f, "moved to `{to}`"),
            Disposition::Replaced(by) => write!(f, "replaced by `{by}`"),
            Disposition::Added => f.write_str("added"),
            Disposition::Lost(why) => f.write_str(why),
        }
    }
}

impl fmt::Display for MigrationFinding {
    /// ``timer `c/a: v`: kept``
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lost = if matches!(self.verdict, Disposition::Lost(_)) { "lost, " } else { "" };
        write!(f, "{} `{}`: {lost}{}", self.subject, self.name, self.verdict)
    }
}

#[cfg(test)]
mod tests {
    use super::brief_lines;

    #[test]
    fn brief_lines_name_states_by_the_words_of_the_role() {
        let lines = [
            "state `player`: kept",
            "state `player/(Led~||active)/2/active/(Search|kick)/Search`: moved to `player/active/Search`",
            "timer `player/(Led~||active)/2: led_timeout`: kept",
            "`player/(Led~||active)/1/Led~/Led` is active, and there is nothing like it: say what replaces it",
            "the topic `monas/change` is not a path",
        ];
        assert_eq!(
            brief_lines(&lines),
            [
                "state `player`: kept",
                "state `active/Search`: moved to `active/Search`",
                "timer `1/2: led_timeout`: kept",
                "`Led` is active, and there is nothing like it: say what replaces it",
                "the topic `monas/change` is not a path",
            ]
        );
    }
}
