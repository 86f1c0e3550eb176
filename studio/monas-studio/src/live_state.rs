//! State of a run shared by all viewers.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::chart_values::WatchedCharts;
use crate::pace::Pace;
use crate::run_ring::RunRing;
use crate::run_view::RunView;
use crate::scene::Scene;

/// The state of a run, shared by its viewers.
pub(crate) struct LiveState {
    pub(crate) socket: PathBuf,
    pub(crate) scene: Option<Arc<dyn Scene>>,
    pub(crate) pace: Option<Pace>,
    /// Whether viewers may change the run.
    pub(crate) allows_control: bool,
    pub(crate) watched_charts: WatchedCharts,
    view: Mutex<RunView>,
    /// The recent past of the run. It is locked after the view.
    ring: Mutex<RunRing>,
}

impl LiveState {
    pub(crate) fn new(
        socket: PathBuf,
        scene: Option<Arc<dyn Scene>>,
        pace: Option<Pace>,
        allows_control: bool,
    ) -> LiveState {
        let (view, ring) = (Mutex::default(), Mutex::default());
        let watched_charts = WatchedCharts::default();
        LiveState { socket, scene, pace, allows_control, watched_charts, view, ring }
    }

    pub(crate) fn view(&self) -> MutexGuard<'_, RunView> {
        self.view.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn ring(&self) -> MutexGuard<'_, RunRing> {
        self.ring.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
