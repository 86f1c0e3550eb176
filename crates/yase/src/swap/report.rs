//! What a swap does, or why it does nothing.

use std::fmt;

use crate::chart::RegionId;
use crate::host::Activation;

/// What a swap did to what was there.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
#[non_exhaustive]
pub struct Report {
    /// What became of everything.
    pub findings: Vec<Finding>,
    /// The activities that run or wait, as they were known and as they are known from now on.
    pub activations: Vec<(Activation, Activation)>,
    /// The blackboards that go on, as they were numbered and as they are numbered from now on: all others of the old chart are no longer
    /// used, and all others of the new chart are filled when their region is entered, or in the next step.
    pub regions: Vec<(RegionId, RegionId)>,
    /// The regions, by path, that are entered in the next step.
    pub to_enter: Vec<String>,
}

impl Report {
    /// What was lost.
    pub fn losses(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(|finding| matches!(finding.verdict, Verdict::Lost(_)))
    }

    pub(super) fn add(&mut self, subject: Subject, name: impl Into<String>, verdict: Verdict) {
        self.findings.push(Finding { subject, name: name.into(), verdict });
    }
}

/// What became of one thing.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Finding {
    /// What it is.
    pub subject: Subject,
    /// Its name in the old chart; of a state that was added, in the new one.
    pub name: String,
    /// What became of it.
    pub verdict: Verdict,
}

/// What a [`Finding`] is about.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
#[non_exhaustive]
pub enum Subject {
    /// An active node.
    State,
    /// The activity of an active state.
    Activation,
    /// What a HISTORY remembers.
    History,
    /// A transition into a JOIN that waits for the others.
    Arrival,
    /// A timer that is set.
    Timer,
    /// An event that waits for its turn.
    Event,
    /// An event that a state has put off.
    DeferredEvent,
    /// An event that waits for running activities.
    HeldEvent,
    /// An interrupting transition that waits for activities to return.
    PendingTransition,
}

/// What became of something.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Verdict {
    /// It is as it was.
    Kept,
    /// It is the same, by another name.
    Moved(String),
    /// That stands for it, as the caller wants.
    Replaced(String),
    /// It is new: a composite around what was kept is active as if it had always been there.
    Added,
    /// It is no more, and why.
    Lost(&'static str),
}

/// Why a machine goes on with its old chart: everything that stands against the swap. Nothing has changed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Refusal {
    reasons: Box<[Objection]>,
}

/// One thing that stands against a swap.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Objection {
    /// The plan is for a machine that runs another chart.
    #[error("the plan is not for the chart that runs")]
    OtherChart,
    /// The new chart was compiled for another semantics.
    #[error("the new chart is read in another way")]
    OtherSemantics,
    /// A step is under way.
    #[error("a step is under way: a chart is swapped between steps")]
    MidStep,
    /// An active node has no counterpart.
    #[error("`{state}` is active, and {why}: say what replaces it")]
    StateGone {
        /// Its path.
        state: String,
        /// What is known.
        why: &'static str,
    },
    /// An activity that runs or waits belongs to a state that is gone or has no activity now.
    #[error("`{activity}` runs in `{state}`, which has no such activity now")]
    ActivityGone {
        /// The path of the state.
        state: String,
        /// The name of the activity.
        activity: String,
    },
    /// An active state has another activity, which has not run.
    #[error(
        "the activity of `{state}` is `{new}` now, which has not run: have the state replaced by one that leads to it"
    )]
    ActivityChanged {
        /// The path of the state.
        state: String,
        /// The activity that its new self has.
        new: String,
    },
    /// A transition that waits for activities it has asked to return is not in the new chart.
    #[error("`{0}` waits for activities that it has asked to return, and is no more: let it happen first")]
    PendingGone(String),
    /// What would be active is no configuration of the new chart.
    #[error("{0}")]
    NotClosed(String),
    /// Something would be lost, which the caller has not agreed to.
    #[error("the {} `{}` would be lost: {}", .0.subject, .0.name, .0.verdict)]
    Loss(Finding),
}

impl Refusal {
    pub(super) fn of(reasons: Vec<Objection>) -> Refusal {
        Refusal { reasons: reasons.into() }
    }

    /// All that stands against it; at least one thing.
    pub fn reasons(&self) -> &[Objection] {
        &self.reasons
    }
}

impl std::error::Error for Refusal {}

impl fmt::Display for Refusal {
    /// One objection a line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the chart is not swapped")?;
        self.reasons.iter().try_for_each(|reason| write!(f, "\n  {reason}"))
    }
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Subject::State => "state",
            Subject::Activation => "activity",
            Subject::History => "history",
            Subject::Arrival => "arrival",
            Subject::Timer => "timer",
            Subject::Event => "event",
            Subject::DeferredEvent => "deferred event",
            Subject::HeldEvent => "held event",
            Subject::PendingTransition => "pending transition",
        })
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Kept => f.write_str("kept"),
            Verdict::Moved(to) => write!(f, "moved to `{to}`"),
            Verdict::Replaced(by) => write!(f, "replaced by `{by}`"),
            Verdict::Added => f.write_str("added"),
            Verdict::Lost(why) => f.write_str(why),
        }
    }
}

impl fmt::Display for Finding {
    /// ``timer `c/a: v`: kept``
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lost = if matches!(self.verdict, Verdict::Lost(_)) { "lost, " } else { "" };
        write!(f, "{} `{}`: {lost}{}", self.subject, self.name, self.verdict)
    }
}
