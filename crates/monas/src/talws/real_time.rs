//! Runs in real time: a thread for each list, each chart and each body, and a pool for the activities of each agent's charts.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};

use narukom::Narukom;

use super::body::Body;
use super::chart_thread::ChartThread;
use super::clock::Clock;
use super::deadlines::Deadlines;
use super::handover::Mailbox;
use super::links::{RunningLink, time_of_other};
use super::list_thread::ListThread;
use super::overview::Overview;
use super::pool::{self, Called, Pool};
use super::setup::{Environment, Member, Stage, Station, first_tick, tick};
use super::stopper::Stopper;
use super::turn::TurnNotes;
use super::{ENDED, Talws};
use crate::error::{Error, ErrorKind};
use crate::statistics::{AgentStatistics, Average, Statistics};

/// A run in real time. It ends when it is [stopped](Running::stop) or dropped, or when its [stopper](Running::stopper) says so.
pub struct Running {
    stopper: Stopper,
    clock: Clock,
    mailboxes: Vec<Arc<Mailbox<Called>>>,
    /// The threads of agents, those of one agent next to each other.
    agents: Vec<JoinHandle<AgentStatistics>>,
    others: Vec<JoinHandle<()>>,
    links: Vec<RunningLink>,
    hubs: Vec<Narukom>,
}

/// What stops all that belongs to one agent.
pub(super) struct Switch {
    off: AtomicBool,
    mailboxes: Vec<Arc<Mailbox<Called>>>,
    /// Set when the body of the host is to stand still.
    rests: Arc<AtomicBool>,
}

impl Switch {
    pub(super) fn stop(&self, reason: &str) {
        if !self.off.swap(true, Ordering::SeqCst) && reason != ENDED {
            tracing::error!("an agent has stopped: {reason}");
        }
        self.mailboxes.iter().for_each(|mailbox| mailbox.stop());
    }

    pub(super) fn is_off(&self) -> bool {
        self.off.load(Ordering::SeqCst)
    }

    pub(super) fn rest_body(&self) {
        self.rests.store(true, Ordering::SeqCst);
    }
}

/// Real-time scheduling is not asked of the system yet; whoever wants it is told once and runs on.
fn say_what_is_not_granted(talws: &Talws) {
    let agents = talws.hosts.iter().flat_map(|host| &host.agents);
    for agent in agents.filter(|agent| agent.scheduling().1) {
        tracing::warn!(agent = %agent.name(), "real-time scheduling is not granted: its thread is scheduled like any other");
    }
}

impl Running {
    /// Sets everything up, then starts the threads.
    pub(super) fn start(talws: Talws, seed: u64) -> Result<Running, Error> {
        say_what_is_not_granted(&talws);
        let Stage { world, stations } = Stage::new(talws, seed)?;
        let mut running = Running {
            stopper: Stopper::new(),
            clock: run_clock(&stations)?,
            mailboxes: Vec::new(),
            agents: Vec::new(),
            others: Vec::new(),
            links: Vec::new(),
            hubs: world.iter().map(|world| world.hub().clone()).collect(),
        };
        let mut launched = world.map_or(Ok(()), |world| running.launch_world(world));
        for station in stations {
            launched = launched.and_then(|()| running.launch_station(station));
        }
        launched.map(|()| running)
    }

    /// What ends the run, from any thread.
    pub fn stopper(&self) -> Stopper {
        self.stopper.clone()
    }

    /// The run, for those who look on and publish from outside.
    pub fn overview(&self) -> Overview {
        Overview::real(self.hubs.clone(), self.clock)
    }

    /// Waits until the run is stopped, and tells what agents have done.
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
        self.mailboxes.iter().for_each(|mailbox| mailbox.stop());
        let mut agents: Vec<AgentStatistics> = Vec::new();
        for thread in self.agents.drain(..) {
            match (thread.join(), agents.last_mut()) {
                (Ok(part), Some(agent)) if (&agent.host, &agent.agent) == (&part.host, &part.agent) => {
                    agent.add(part)
                }
                (Ok(part), _) => agents.push(part),
                (Err(_), _) => tracing::error!("the thread of an agent has panicked"),
            }
        }
        for thread in self.others.drain(..) {
            if thread.join().is_err() {
                tracing::error!("the thread of a body or the world has panicked");
            }
        }
        let links = self.links.drain(..).map(RunningLink::stop).collect();
        Statistics { agents, links }
    }

    fn launch_world(&mut self, mut world: Environment) -> Result<(), Error> {
        let (stopper, clock) = (self.stopper.clone(), self.clock);
        let thread = spawn("world", move || {
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

    fn launch_station(&mut self, station: Station) -> Result<(), Error> {
        let Station { hub, body, members, links } = station;
        self.hubs.push(hub.clone());
        let clock = self.clock;
        let links = links.into_iter().map(|link| RunningLink::start(&hub, link, move || clock.now()));
        let links = links.collect::<Result<Vec<_>, Error>>()?;
        let rests = Arc::new(AtomicBool::new(false));
        let mailbox = || Arc::new(Mailbox::new(hub.topics().len()));
        let switch = |member: &Member| {
            let mailboxes = member.charts.iter().map(|_| mailbox()).collect();
            Arc::new(Switch { off: AtomicBool::new(false), mailboxes, rests: rests.clone() })
        };
        let switches: Vec<Arc<Switch>> = members.iter().map(switch).collect();
        let mailboxes: Vec<Arc<Mailbox<Called>>> =
            switches.iter().flat_map(|s| s.mailboxes.iter().cloned()).collect();
        self.mailboxes.extend(mailboxes.iter().cloned());
        // Before anybody publishes, so that nobody misses anything.
        let linked: Vec<_> = links.iter().map(RunningLink::waker).collect();
        self.links.extend(links);
        hub.set_waker(Arc::new(move |topic, host| {
            mailboxes.iter().for_each(|mailbox| mailbox.message(topic, host));
            linked.iter().for_each(|wake| wake(topic, host));
        }));
        for (member, switch) in members.into_iter().zip(switches) {
            self.launch_member(member, hub.host(), switch)?;
        }
        body.map_or(Ok(()), |body| self.launch_body(body, hub.host(), rests))
    }

    fn launch_member(&mut self, member: Member, host: &str, switch: Arc<Switch>) -> Result<(), Error> {
        let Member { name, policy, frequency, statistics_every, workers, list, charts, teller } = member;
        let useful = charts.iter().map(|runner| runner.max_activities()).sum();
        let pool = Arc::new(Pool::new(&name, pool::workers(workers, useful), self.clock));
        for (runner, mailbox) in charts.into_iter().zip(&switch.mailboxes) {
            let thread = ChartThread {
                agent: name.clone(),
                runner,
                policy,
                frequency,
                statistics_every,
                mailbox: mailbox.clone(),
                pool: pool.clone(),
                teller: teller.another()?,
                switch: switch.clone(),
                clock: self.clock,
                ticks: frequency.map_or(0, |frequency| frequency.first_due(self.clock.begin())),
                steps: 0,
                step_time: Average::default(),
                out: 0,
                notes: TurnNotes::default(),
            };
            self.agents.push(spawn(&name, move || thread.run())?);
        }
        if let (Some(list), Some(frequency)) = (list, frequency) {
            let thread = ListThread {
                host: host.into(),
                agent: name.clone(),
                list,
                deadlines: Deadlines::new(frequency, self.clock.begin()),
                statistics_every,
                teller,
                switch,
                stopper: self.stopper.clone(),
                clock: self.clock,
                cycles: 0,
                cycle_time: Average::default(),
            };
            self.agents.push(spawn(&name, move || thread.run())?);
        }
        Ok(())
    }

    /// Hands the newest commands to a body and publishes what it senses, in each of its cycles.
    fn launch_body(&mut self, mut body: Body, host: &str, rests: Arc<AtomicBool>) -> Result<(), Error> {
        let (stopper, clock, host) = (self.stopper.clone(), self.clock, host.to_owned());
        let thread = spawn(&format!("{host} body"), move || {
            let mut next = first_tick(body.period(), clock.begin());
            while stopper.wait_until(tick(body.period(), next), &clock) {
                next += 1;
                let now = clock.now();
                let acted = if rests.load(Ordering::SeqCst) { body.rest(now) } else { body.act(now) };
                if let Err(error) = acted.and_then(|()| body.sense(now)) {
                    tracing::error!(%host, "{error}");
                }
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

fn spawn<T: Send + 'static>(
    name: &str,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<JoinHandle<T>, Error> {
    thread::Builder::new().name(name.into()).spawn(work).map_err(|error| {
        Error::new(ErrorKind::Thread, format!("no thread for `{name}`: {error}")).caused_by(error)
    })
}
