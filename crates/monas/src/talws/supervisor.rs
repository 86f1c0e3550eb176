//! Who looks after the agents of a run in real time: it makes the changes that are asked for, tells how agents are, and ends the run when
//! none of them does anything any more.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, sync_channel};
use std::time::Duration;

use super::clock::Clock;
use super::overview::View;
use super::stopper::Stopper;
use super::workforce::{Workforce, nap};
use crate::records::{Change, Changed, ChartChoice};
use crate::statistics::AgentStatistics;

/// How often it looks after everybody without being asked.
const ROUND: Duration = Duration::from_millis(100);

/// Whoever asks waits for so long at most.
const PATIENCE: Duration = Duration::from_secs(4);

/// What it is told.
pub(super) enum Event {
    /// Somebody has published a change on the host of that number.
    Asked(usize),
    /// Somebody from outside wants a change.
    Change { host: String, change: Box<Change>, answer: SyncSender<Result<Changed, String>> },
    /// Somebody wants to see the agents, and one of their charts.
    Look { chart: Option<ChartChoice>, answer: SyncSender<Vec<View>> },
    /// A thread of an agent has nothing to do any more.
    Rested,
    /// The run ends.
    End,
}

/// The way to the supervisor of a run.
#[derive(Clone)]
pub(super) struct SupervisorLine(pub(super) Sender<Event>);

impl SupervisorLine {
    pub(super) fn change(&self, host: &str, change: Change) -> Result<Changed, String> {
        self.ask(|answer| Event::Change { host: host.into(), change: Box::new(change), answer })?
    }

    pub(super) fn views(&self, chart: Option<ChartChoice>) -> Result<Vec<View>, String> {
        self.ask(|answer| Event::Look { chart, answer })
    }

    fn ask<T>(&self, what: impl FnOnce(SyncSender<T>) -> Event) -> Result<T, String> {
        let (answer, answered) = sync_channel(1);
        self.0.send(what(answer)).map_err(|_| "the run has ended".to_owned())?;
        answered.recv_timeout(PATIENCE).map_err(|error| match error {
            RecvTimeoutError::Timeout => "the run does not answer".to_owned(),
            RecvTimeoutError::Disconnected => "the run has ended".to_owned(),
        })
    }
}

/// The supervisor of a run.
pub(super) struct Supervisor {
    pub(super) hosts: Vec<Workforce>,
    pub(super) events: Receiver<Event>,
    pub(super) stopper: Stopper,
    pub(super) clock: Clock,
}

impl Supervisor {
    /// Looks after the agents until the run ends; then ends them, and tells what they have done.
    pub(super) fn run(mut self) -> Vec<AgentStatistics> {
        while !self.stopper.is_stopped() {
            match self.events.recv_timeout(ROUND) {
                Ok(event) => self.heed(event),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            self.watch();
        }
        self.hosts.iter().for_each(Workforce::end);
        while !self.hosts.iter().all(Workforce::is_finished) {
            nap();
            self.watch();
        }
        self.hosts.into_iter().flat_map(Workforce::join).collect()
    }

    /// Looks whether everybody still does something.
    fn watch(&mut self) {
        let now = self.clock.now();
        if self.hosts.iter().filter(|host| host.watch(now)).count() > 0 {
            self.somebody_rests();
        }
    }

    fn heed(&mut self, event: Event) {
        let now = self.clock.now();
        match event {
            Event::Asked(host) => {
                if let Some(host) = self.hosts.get_mut(host) {
                    host.attend(now);
                }
            }
            Event::Change { host, change, answer } => {
                let known = self.hosts.iter_mut().find(|known| known.name() == host);
                let changed = known.map(|known| known.change(*change, now));
                // Whoever has given up is not told.
                let _ = answer.try_send(changed.ok_or_else(|| format!("no host is named `{host}`")));
            }
            Event::Look { chart, answer } => {
                let views = self.hosts.iter_mut().map(|host| host.view(chart.as_ref()));
                let _ = answer.try_send(views.collect());
            }
            Event::Rested => self.somebody_rests(),
            Event::End => {}
        }
    }

    /// A body whose agents have all ended stands still; a run whose agents have all ended ends.
    fn somebody_rests(&mut self) {
        self.hosts.iter().filter(|host| host.is_over()).for_each(Workforce::rest_body);
        if self.hosts.iter().all(|host| host.is_over() || host.is_empty()) {
            tracing::info!("every agent has ended, and so does the run");
            self.stopper.stop();
        }
    }
}

/// Rings the supervisor when the run is to end.
pub(super) fn ring(line: &Sender<Event>, stopper: &Stopper) {
    let line = line.clone();
    stopper.on_stop(Box::new(move || {
        // One that has gone needs no ringing.
        let _ = line.send(Event::End);
    }));
}

/// A clone of the way to the supervisor for the waker of a host.
pub(super) fn asked(line: &Sender<Event>, host: usize) -> Arc<dyn Fn() + Send + Sync> {
    let line = line.clone();
    Arc::new(move || {
        let _ = line.send(Event::Asked(host));
    })
}
