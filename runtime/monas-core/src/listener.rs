//! Listeners for the micro-steps of charts.

use std::sync::{Arc, Mutex, PoisonError};

use yase::{CompiledChart, TraceRecord};

/// Receives every micro-step of every chart, on the thread that executes it; for trace recorders
/// and debuggers.
///
/// Every function of a [`MicroStep`] is a listener:
///
/// ```
/// use std::sync::{Arc, Mutex};
/// use monas_core::{ChartListener, MicroStep};
///
/// let lines = Arc::new(Mutex::new(Vec::new()));
/// let written = lines.clone();
/// let listener: Box<dyn ChartListener> = Box::new(move |step: MicroStep<'_>| {
///     if let Ok(mut lines) = written.lock() {
///         lines.push(step.record.display(step.chart).to_string());
///     }
/// });
/// # drop(listener);
/// ```
pub trait ChartListener: Send {
    /// Called after each micro-step.
    fn micro_step(&mut self, step: MicroStep<'_>);
}

impl<F: FnMut(MicroStep<'_>) + Send> ChartListener for F {
    fn micro_step(&mut self, step: MicroStep<'_>) {
        self(step);
    }
}

/// One micro-step of a chart, with its origin.
#[derive(Clone, Copy, Debug)]
pub struct MicroStep<'a> {
    /// The host.
    pub host: &'a str,
    /// The agent.
    pub agent: &'a str,
    /// The chart.
    pub chart: &'a CompiledChart,
    /// Its record.
    pub record: &'a TraceRecord<'a>,
}

/// The listeners of all charts, called one at a time.
#[derive(Clone, Default)]
pub struct ListenerSet {
    /// None without listeners, which avoids the lock.
    shared: Option<SharedListener>,
}

type SharedListener = Arc<Mutex<Vec<Box<dyn ChartListener>>>>;

impl ListenerSet {
    /// A set of listeners.
    pub fn new(listeners: Vec<Box<dyn ChartListener>>) -> ListenerSet {
        ListenerSet { shared: (!listeners.is_empty()).then(|| Arc::new(Mutex::new(listeners))) }
    }

    pub(crate) fn micro_step(
        &self,
        host: &str,
        agent: &str,
        chart: &CompiledChart,
        record: &TraceRecord<'_>,
    ) {
        let Some(shared) = &self.shared else { return };
        let mut listeners = shared.lock().unwrap_or_else(PoisonError::into_inner);
        for listener in listeners.iter_mut() {
            listener.micro_step(MicroStep { host, agent, chart, record });
        }
    }
}
