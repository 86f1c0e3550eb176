//! Regions that a new chart has brought: they are entered when the next step begins.

use crate::chart::{Place, RegionId};
use crate::host::Host;
use crate::machine::errors::Fault;
use crate::machine::run::Run;
use crate::machine::step::Step;
use crate::trace::Occasion;

/// What a machine that took a new chart has still to do.
#[derive(Clone, Debug, Default)]
pub(super) struct Newcomers {
    /// New regions of active ANDs, to be entered by default; in the order of the document.
    pub(super) regions: Vec<Place>,
    /// Blackboards of regions that have come to be around what was active, to be filled; in the order of the document.
    pub(super) blackboards: Vec<RegionId>,
}

impl Newcomers {
    pub(super) fn is_empty(&self) -> bool {
        self.regions.is_empty() && self.blackboards.is_empty()
    }
}

impl<H: Host> Step<'_, H> {
    pub(super) fn welcome(&mut self) -> Result<(), Fault> {
        let Newcomers { regions, blackboards } = std::mem::take(&mut self.run.newcomers);
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
        self.emit(Occasion::Swap, None);
        self.stop_if_terminated();
        Ok(())
    }
}

impl Run {
    /// Whether a new region waits to be entered.
    pub(super) fn is_to_enter(&self, place: Place) -> bool {
        self.newcomers.regions.contains(&place)
    }
}
