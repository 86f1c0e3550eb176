//! What a machine says when it stops by itself.

use crate::chart::{Chart, CompoundId};
use crate::machine::{MachineError, MachineErrorKind};
use crate::statechart::TransitionId;

impl MachineError {
    pub(super) fn new(kind: MachineErrorKind, chart: &Chart, cycle: &[CompoundId]) -> MachineError {
        let segments: Box<[TransitionId]> =
            cycle.iter().flat_map(|&compound| chart.segments(compound)).copied().collect();
        let names: Vec<String> = segments.iter().map(|&segment| name(chart, segment)).collect();
        let limit = chart.semantics().limit;
        let what = match kind {
            MachineErrorKind::NeverRests => format!("the chart does not come to rest in {limit} micro-steps"),
            MachineErrorKind::NeverAdvances => {
                format!("the chart makes more than {limit} steps at one moment")
            }
        };
        let text = format!("{what}: it repeats {}", names.join(", "));
        MachineError { kind, cycle: segments, text }
    }
}

fn name(chart: &Chart, segment: TransitionId) -> String {
    let transition = chart.statechart().transition(segment);
    format!("`{}` -> `{}`", chart.short_path(transition.source), chart.short_path(transition.target))
}
