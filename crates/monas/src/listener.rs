//! Those who look on while charts step.

use std::sync::{Arc, Mutex, PoisonError};

use yase::{Chart, TraceRecord};

/// Sees every micro-step of every chart, on the thread that makes it; a recorder of traces, a debugger.
///
/// Every function of a [`MicroStep`] is one:
///
/// ```
/// use std::sync::{Arc, Mutex};
/// use monas::{MicroStep, Talws};
///
/// let lines = Arc::new(Mutex::new(Vec::new()));
/// let written = lines.clone();
/// let mut talws = Talws::new();
/// talws.listen(Box::new(move |step: MicroStep<'_>| {
///     if let Ok(mut lines) = written.lock() {
///         lines.push(step.record.display(step.chart).to_string());
///     }
/// }));
/// ```
pub trait ChartListener: Send {
    /// A micro-step has happened.
    fn micro_step(&mut self, step: MicroStep<'_>);
}

impl<F: FnMut(MicroStep<'_>) + Send> ChartListener for F {
    fn micro_step(&mut self, step: MicroStep<'_>) {
        self(step);
    }
}

/// One micro-step of a chart, and where it happened.
#[derive(Clone, Copy, Debug)]
pub struct MicroStep<'a> {
    /// The host.
    pub host: &'a str,
    /// The agent.
    pub agent: &'a str,
    /// The chart.
    pub chart: &'a Chart,
    /// What happened.
    pub record: &'a TraceRecord<'a>,
}

/// The listeners of all charts, called one at a time.
#[derive(Clone, Default)]
pub(crate) struct Listeners {
    /// None if nobody listens, so that nobody waits for a lock.
    shared: Option<Shared>,
}

type Shared = Arc<Mutex<Vec<Box<dyn ChartListener>>>>;

impl Listeners {
    pub(crate) fn new(listeners: Vec<Box<dyn ChartListener>>) -> Listeners {
        Listeners { shared: (!listeners.is_empty()).then(|| Arc::new(Mutex::new(listeners))) }
    }

    pub(crate) fn tell(&self, host: &str, agent: &str, chart: &Chart, record: &TraceRecord<'_>) {
        let Some(shared) = &self.shared else { return };
        let mut listeners = shared.lock().unwrap_or_else(PoisonError::into_inner);
        for listener in listeners.iter_mut() {
            listener.micro_step(MicroStep { host, agent, chart, record });
        }
    }
}
