//! The errors with which a machine stops.

use crate::compile::CompiledChart;
use crate::ids::CompoundTransitionId;
use crate::machine::{ErrorDetails, MachineError, MachineErrorKind};
use crate::statechart::{NodeId, TransitionId};

/// Why a step fails.
#[derive(Clone, Copy, Debug)]
pub(crate) enum StepError {
    NeverRests,
    NeverAdvances,
    /// No transition out of a CHOICE is enabled.
    NoBranch(NodeId),
}

impl MachineError {
    pub(crate) fn new(
        fault: StepError,
        chart: &CompiledChart,
        cycle: &[CompoundTransitionId],
    ) -> MachineError {
        let limit = chart.semantics_ref().limit;
        match fault {
            StepError::NeverRests => {
                let what = format!("the chart does not come to rest in {limit} micro-steps");
                MachineError::endless(MachineErrorKind::NeverRests, &what, chart, cycle)
            }
            StepError::NeverAdvances => {
                let what = format!("the chart makes more than {limit} steps at one moment");
                MachineError::endless(MachineErrorKind::NeverAdvances, &what, chart, cycle)
            }
            StepError::NoBranch(node) => {
                let text =
                    format!("no outgoing transition of CHOICE `{}` is enabled", chart.names().name(node));
                let kind = MachineErrorKind::NoBranch;
                MachineError(Box::new(ErrorDetails { kind, cycle: Box::default(), node: Some(node), text }))
            }
        }
    }

    fn endless(
        kind: MachineErrorKind,
        what: &str,
        chart: &CompiledChart,
        cycle: &[CompoundTransitionId],
    ) -> MachineError {
        let segments: Box<[TransitionId]> =
            cycle.iter().flat_map(|&compound| chart.segments(compound)).copied().collect();
        let names: Vec<String> = segments.iter().map(|&segment| name(chart, segment)).collect();
        let text = format!("{what}: it repeats {}", names.join(", "));
        MachineError(Box::new(ErrorDetails { kind, cycle: segments, node: None, text }))
    }
}

fn name(chart: &CompiledChart, segment: TransitionId) -> String {
    let transition = chart.statechart().transition(segment);
    format!("`{}` -> `{}`", chart.names().name(transition.source), chart.names().name(transition.target))
}
