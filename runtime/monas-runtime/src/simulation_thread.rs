//! A thread that advances and stops a simulation, so that its caller can abandon the simulation
//! when an activity does not return.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::thread::Builder;
use std::time::Duration;

use monas_core::error::{Error, ErrorKind};
use narukom::Timestamp;

use super::clock::RunClock;
use super::simulation::Simulation;
use super::stall_watchdog::WatchedRun;

/// Interval of the checks for a cancellation by the caller.
const CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// As much as the main thread of a process usually has.
const STACK_BYTES: usize = 8 << 20;

/// The thread, which ends when this value is dropped.
pub(crate) struct SimulationThread {
    jobs: Sender<SimulationJob>,
}

/// A command to the thread, with the simulation, and the destination of both afterwards.
struct SimulationJob {
    simulation: Simulation,
    work: SimulationWork,
    done: SyncSender<FinishedWork>,
}

type SimulationWork = Box<dyn FnOnce(&mut Simulation) -> Result<(), Error> + Send>;

/// The simulation after the work, and the result of the work.
type FinishedWork = (Simulation, Result<(), Error>);

/// A simulation while its thread works.
pub(crate) struct SimulationWait {
    done: Receiver<FinishedWork>,
    watched: Arc<WatchedRun>,
}

impl SimulationThread {
    pub(crate) fn start() -> Result<SimulationThread, Error> {
        let (jobs, next) = channel::<SimulationJob>();
        let run = move || {
            for SimulationJob { mut simulation, work, done } in next {
                let result = work(&mut simulation);
                // Without a receiver the caller has abandoned it.
                let _ = done.send((simulation, result));
            }
        };
        let spawned = Builder::new().name("simulation".into()).stack_size(STACK_BYTES).spawn(run);
        spawned.map_err(|error| {
            let message = format!("no thread for the simulation: {error}");
            Error::new(ErrorKind::Thread, message).caused_by(error)
        })?;
        Ok(SimulationThread { jobs })
    }

    /// Starts work on a simulation on its thread.
    ///
    /// # Errors
    /// The thread cannot be created or has ended.
    pub(crate) fn work(
        mut simulation: Simulation,
        work: impl FnOnce(&mut Simulation) -> Result<(), Error> + Send + 'static,
    ) -> Result<SimulationWait, Error> {
        let jobs = simulation.thread()?.jobs.clone();
        let (sender, done) = sync_channel(1);
        let wait = SimulationWait { done, watched: simulation.watched().clone() };
        // The simulation was not running, so it owns its thread.
        let _ = jobs.send(SimulationJob { simulation, work: Box::new(work), done: sender });
        Ok(wait)
    }
}

impl SimulationWait {
    /// Waits until the thread is done, but not longer than `limit` after `is_cancelled`.
    pub(crate) fn wait(self, is_cancelled: impl Fn() -> bool, limit: Duration) -> Result<Simulation, Error> {
        let clock = RunClock::start();
        let mut end = None;
        loop {
            if end.is_none() && is_cancelled() {
                end = Some(clock.now() + limit);
            }
            let timeout = end.map_or(CHECK_INTERVAL, |end: Timestamp| end.since(clock.now()));
            match self.done.recv_timeout(timeout) {
                Ok((simulation, result)) => return result.map(|()| simulation),
                Err(RecvTimeoutError::Timeout) if end.is_none() => {}
                Err(RecvTimeoutError::Timeout) => return Err(self.stuck(limit)),
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(Error::new(ErrorKind::Stuck, "a panic ended the simulation"));
                }
            }
        }
    }

    fn stuck(&self, limit: Duration) -> Error {
        let limit = limit.as_secs_f64();
        let message = match self.watched.open_call() {
            Some(call) => {
                let (name, function) = (call.name, call.function.name());
                format!(
                    "activity `{}` of agent `{}` on `{}` has not returned from `{function}` within {limit:.1} s",
                    name.activity, name.agent, name.robot
                )
            }
            None => format!("the run has not ended within {limit:.1} s"),
        };
        Error::new(ErrorKind::Stuck, message)
    }
}
