//! Runs in real time: a thread for each list, each chart and each body, and a pool for the activities of each agent's charts.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;

use narukom::Narukom;

use super::Talws;
use super::body::Body;
use super::clock::Clock;
use super::crew::Crew;
use super::links::{RunningLink, time_of_other};
use super::overview::Overview;
use super::setup::{Environment, Stage, Station, first_tick, tick};
use super::stopper::Stopper;
use super::supervisor::{Event, Supervisor, SupervisorLine, ring};
use super::workforce::{Site, Wake, Workforce, spawn};
use crate::error::{Error, ErrorKind};
use crate::link::LinkStatistics;
use crate::logger::Hosting;
use crate::statistics::{AgentStatistics, Statistics};

/// A run in real time. It ends when it is [stopped](Running::stop) or dropped, or when its [stopper](Running::stopper) says so.
pub struct Running {
    stopper: Stopper,
    clock: Clock,
    line: Sender<Event>,
    supervisor: Option<JoinHandle<Vec<AgentStatistics>>>,
    others: Vec<JoinHandle<()>>,
    links: Vec<RunningLink>,
    hubs: Vec<Narukom>,
}

impl Running {
    /// Sets everything up, then starts the threads.
    pub(super) fn start(talws: Talws, seed: u64) -> Result<Running, Error> {
        let Stage { world, stations, crew } = Stage::new(talws, seed)?;
        let (line, events) = channel();
        let mut running = Running {
            stopper: Stopper::new(),
            clock: run_clock(&stations)?,
            line,
            supervisor: None,
            others: Vec::new(),
            links: Vec::new(),
            hubs: world.iter().map(|world| world.hub().clone()).collect(),
        };
        let mut hosts = Vec::new();
        let mut launched = world.map_or(Ok(()), |world| running.launch_world(world));
        for station in stations {
            launched = launched.and_then(|()| running.launch_station(station, &crew, &mut hosts));
        }
        ring(&running.line, &running.stopper);
        let supervisor = Supervisor { hosts, events, stopper: running.stopper.clone(), clock: running.clock };
        if launched.is_err() {
            // Those who have begun are ended.
            running.stopper.stop();
        }
        let hosting = Hosting::real(&running.hubs, running.clock);
        running.supervisor = Some(spawn("supervisor", move || hosting.during(|| supervisor.run()))?);
        launched.map(|()| running)
    }

    /// What ends the run, from any thread.
    pub fn stopper(&self) -> Stopper {
        self.stopper.clone()
    }

    /// The run, for those who look on and publish from outside.
    pub fn overview(&self) -> Overview {
        Overview::real(self.hubs.clone(), self.clock, SupervisorLine(self.line.clone()))
    }

    /// The hub of a host or of the world, for those who look on or take part with a blackboard of their own.
    pub fn hub(&self, host: &str) -> Option<&Narukom> {
        self.hubs.iter().find(|hub| hub.host() == host)
    }

    /// What its links know and have counted so far.
    pub fn links(&self) -> Vec<LinkStatistics> {
        self.links.iter().map(RunningLink::statistics).collect()
    }

    /// Whether the run has been stopped, or every agent has ended.
    pub fn has_ended(&self) -> bool {
        self.stopper.is_stopped()
    }

    /// Waits until the run is stopped or every agent has ended, and tells what agents have done.
    pub fn wait(self) -> Statistics {
        self.stopper.wait();
        self.stop()
    }

    /// Ends the run: agents finish the cycle they are in. Tells what they have done.
    pub fn stop(mut self) -> Statistics {
        self.end()
    }

    fn end(&mut self) -> Statistics {
        self.stopper.stop();
        let agents = self.supervisor.take().map(JoinHandle::join);
        let agents = agents.map(|agents| {
            agents.unwrap_or_else(|_| {
                tracing::error!("the thread of the supervisor has panicked");
                Vec::new()
            })
        });
        for thread in self.others.drain(..) {
            if thread.join().is_err() {
                tracing::error!("the thread of a body or the world has panicked");
            }
        }
        let links = self.links.drain(..).map(RunningLink::stop).collect();
        Statistics { agents: agents.unwrap_or_default(), links }
    }

    fn launch_world(&mut self, mut world: Environment) -> Result<(), Error> {
        let (stopper, clock) = (self.stopper.clone(), self.clock);
        let hosting = Hosting::real([world.hub()], clock);
        let thread = spawn("world", move || {
            let _hosted = hosting.begin();
            while stopper.wait_until(world.due(), &clock) {
                if let Err(error) = world.advance(world.due()) {
                    tracing::error!("{error}");
                    return stopper.stop();
                }
            }
        })?;
        self.others.push(thread);
        Ok(())
    }

    fn launch_station(
        &mut self,
        station: Station,
        crew: &Arc<Crew>,
        hosts: &mut Vec<Workforce>,
    ) -> Result<(), Error> {
        let Station { hub, body, members, links, ground, profiles, configuration } = station;
        self.hubs.push(hub.clone());
        let clock = self.clock;
        let links = links.into_iter().map(|link| RunningLink::start(&hub, link, move || clock.now()));
        let links = links.collect::<Result<Vec<_>, Error>>()?;
        let rests = Arc::new(AtomicBool::new(false));
        let linked = links.iter().map(|link| Arc::new(link.waker()) as Wake).collect();
        self.links.extend(links);
        let (place, line) = (hosts.len(), self.line.clone());
        let site = Site { hub: hub.clone(), place, clock, rests: rests.clone(), linked, line };
        hosts.push(Workforce::new(site, crew.clone(), ground, profiles, configuration)?);
        hosts[place].launch(members)?;
        body.map_or(Ok(()), |body| self.launch_body(body, &hub, rests))
    }

    /// Hands the newest commands to a body and publishes what it senses, in each of its cycles.
    fn launch_body(&mut self, mut body: Body, hub: &Narukom, rests: Arc<AtomicBool>) -> Result<(), Error> {
        let (stopper, clock, host) = (self.stopper.clone(), self.clock, hub.host().to_owned());
        let hosting = Hosting::real([hub], clock);
        let thread = spawn(&format!("{host} body"), move || {
            let _hosted = hosting.begin();
            let mut next = first_tick(body.period(), clock.begin());
            while stopper.wait_until(tick(body.period(), next), &clock) {
                next += 1;
                let now = clock.now();
                let acted = if rests.load(Ordering::SeqCst) { body.rest(now) } else { body.act(now) };
                if let Err(error) = acted.and_then(|()| body.sense(now)) {
                    tracing::error!(%host, "{error}");
                }
            }
            // A run that ends because nobody does anything any more leaves a body that stands still.
            if rests.load(Ordering::SeqCst)
                && let Err(error) = body.rest(clock.now())
            {
                tracing::error!(%host, "{error}");
            }
        })?;
        self.others.push(thread);
        Ok(())
    }
}

/// The clock of the run: its own, or that of the other end of a link that says so.
fn run_clock(stations: &[Station]) -> Result<Clock, Error> {
    let links = stations.iter().flat_map(|station| station.links.iter().map(|link| (&station.hub, link)));
    let mut followed = links.filter_map(|(hub, link)| Some((hub, link, link.clock.as_deref()?)));
    match (followed.next(), followed.next()) {
        (None, _) => Ok(Clock::start()),
        (Some((hub, link, other)), None) => time_of_other(hub, link, other),
        (Some((.., one)), Some((.., other))) => {
            let message = format!("links say that the time is that of `{one}`, and that of `{other}`");
            Err(Error::new(ErrorKind::Link, message))
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.end();
    }
}

impl fmt::Debug for Running {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Running").field("stopper", &self.stopper).finish_non_exhaustive()
    }
}
