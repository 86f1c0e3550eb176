//! What a machine says when it stops by itself.

use crate::chart::{Chart, CompoundId};
use crate::machine::{Fatality, MachineError, MachineErrorKind};
use crate::statechart::{NodeId, TransitionId};

/// Why a step cannot go on.
#[derive(Clone, Copy, Debug)]
pub(super) enum Fault {
    NeverRests,
    NeverAdvances,
    /// None of the ways out of a CHOICE is open.
    NoBranch(NodeId),
}

impl MachineError {
    pub(super) fn new(fault: Fault, chart: &Chart, cycle: &[CompoundId]) -> MachineError {
        let limit = chart.semantics_ref().limit;
        match fault {
            Fault::NeverRests => {
                let what = format!("the chart does not come to rest in {limit} micro-steps");
                MachineError::endless(MachineErrorKind::NeverRests, &what, chart, cycle)
            }
            Fault::NeverAdvances => {
                let what = format!("the chart makes more than {limit} steps at one moment");
                MachineError::endless(MachineErrorKind::NeverAdvances, &what, chart, cycle)
            }
            Fault::NoBranch(node) => {
                let text = format!("no way out of CHOICE `{}` is open", chart.short_path(node));
                let kind = MachineErrorKind::NoBranch;
                MachineError(Box::new(Fatality { kind, cycle: Box::default(), node: Some(node), text }))
            }
        }
    }

    fn endless(kind: MachineErrorKind, what: &str, chart: &Chart, cycle: &[CompoundId]) -> MachineError {
        let segments: Box<[TransitionId]> =
            cycle.iter().flat_map(|&compound| chart.segments(compound)).copied().collect();
        let names: Vec<String> = segments.iter().map(|&segment| name(chart, segment)).collect();
        let text = format!("{what}: it repeats {}", names.join(", "));
        MachineError(Box::new(Fatality { kind, cycle: segments, node: None, text }))
    }
}

fn name(chart: &Chart, segment: TransitionId) -> String {
    let transition = chart.statechart().transition(segment);
    format!("`{}` -> `{}`", chart.short_path(transition.source), chart.short_path(transition.target))
}
