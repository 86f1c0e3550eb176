//! Regions added by a migration: they are entered when the next step begins.

use crate::compile::NodeIndex;
use crate::host::Host;
use crate::ids::ScopeId;
use crate::machine::errors::StepError;
use crate::machine::machine_state::MachineState;
use crate::machine::step::Macrostep;
use crate::trace::MicroStepCause;

/// The pending entries of a machine after a migration.
#[derive(Clone, Debug, Default)]
pub(crate) struct RegionsToEnter {
    /// New regions of active ANDs, to be entered by default; in document order.
    pub(crate) regions: Vec<NodeIndex>,
    /// Blackboards of regions that were added around active nodes, to be filled; in document order.
    pub(crate) blackboards: Vec<ScopeId>,
}

impl RegionsToEnter {
    pub(crate) fn is_empty(&self) -> bool {
        self.regions.is_empty() && self.blackboards.is_empty()
    }
}

impl<H: Host> Macrostep<'_, H> {
    pub(crate) fn enter_new_regions(&mut self) -> Result<(), StepError> {
        let RegionsToEnter { regions, blackboards } = std::mem::take(&mut self.run.regions_to_enter);
        for region in blackboards {
            if let Some(around) = self.chart.regions[region.index()].parent {
                self.host.inherit(region, around);
            }
        }
        if regions.is_empty() {
            return Ok(());
        }
        self.run.begin_micro_step();
        for region in regions {
            self.enter(region);
            self.enter_inside(region)?;
        }
        self.emit_trace(MicroStepCause::Swap, None);
        self.stop_if_terminated();
        Ok(())
    }
}

impl MachineState {
    /// Whether a new region waits to be entered.
    pub(crate) fn is_to_enter(&self, node: NodeIndex) -> bool {
        self.regions_to_enter.regions.contains(&node)
    }
}
