//! The agents of a host in real time: a thread for each list and each chart, and a pool for the activities of each agent's charts.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use narukom::{HostId, Moment, Narukom, TopicSlot};

use super::chart_thread::ChartThread;
use super::clock::Clock;
use super::crew::{Crew, Ground, Member};
use super::deadlines::Deadlines;
use super::entry;
use super::handover::Mailbox;
use super::list_thread::ListThread;
use super::management::{Roster, Staff};
use super::orders::{Asked, Directive, Orders, Standing, TOLD};
use super::overview::View;
use super::pool::{self, Called, Pool};
use super::scheduling::Scheduling;
use super::supervisor::{Event, asked};
use super::teller::Teller;
use super::turn::TurnNotes;
use super::unit::{Part, Unit};
use crate::agent::Profile;
use crate::chart::{OfAgent, Runner};
use crate::error::{Error, ErrorKind};
use crate::frequency::Frequency;
use crate::list::List;
use crate::logger::Hosting;
use crate::records::{AgentEntry, CHANGE, Change, Changed, ChartChoice};
use crate::statistics::{AgentStatistics, Timing};

/// A thread that is told something answers within this time, unless its cycle takes longer.
const PATIENCE: Duration = Duration::from_secs(1);

/// A cycle of a list is stuck after so many periods, and not before this time.
const PERIODS: u32 = 10;
const STUCK_LIST: Duration = Duration::from_secs(1);

/// A call of a chart's activity, which may work on for long, is reported after this time.
const STUCK_CALL: Duration = Duration::from_secs(10);

/// Whoever waits for threads to end looks again after this time.
const NAP: Duration = Duration::from_millis(2);

/// Waits a little.
#[expect(clippy::disallowed_methods, reason = "threads do not tell when they end")]
pub(super) fn nap() {
    thread::sleep(NAP);
}

/// The agents of a host.
pub(super) struct Workforce {
    roster: Roster,
    team: Team,
}

/// What wakes somebody when a message is published.
pub(super) type Wake = Arc<dyn Fn(TopicSlot, HostId) + Send + Sync>;

/// Their threads.
struct Team {
    hub: Narukom,
    place: usize,
    clock: Clock,
    /// Set when the body is to stand still.
    rests: Arc<AtomicBool>,
    linked: Vec<Wake>,
    line: Sender<Event>,
    workers: Vec<Worker>,
    /// What agents have done that were removed.
    gone: Vec<AgentStatistics>,
}

/// An agent and its threads.
struct Worker {
    unit: Arc<Unit>,
    threads: Vec<JoinHandle<AgentStatistics>>,
    frequency: Option<Frequency>,
    statistics_every: Option<u64>,
    scheduling: Scheduling,
    stuck_after: Option<Duration>,
    teller: Teller,
}

/// Where a workforce stands.
pub(super) struct Site {
    pub(super) hub: Narukom,
    /// Its number among the hosts.
    pub(super) place: usize,
    pub(super) clock: Clock,
    pub(super) rests: Arc<AtomicBool>,
    pub(super) linked: Vec<Wake>,
    pub(super) line: Sender<Event>,
}

impl Workforce {
    /// Nobody yet.
    pub(super) fn new(
        site: Site,
        crew: Arc<Crew>,
        ground: Ground,
        profiles: Vec<Profile>,
        configuration: Option<Arc<yase::Source>>,
    ) -> Result<Workforce, Error> {
        let Site { hub, place, clock, rests, linked, line } = site;
        let team = Team { hub, place, clock, rests, linked, line, workers: Vec::new(), gone: Vec::new() };
        Ok(Workforce { roster: Roster::new(ground, crew, profiles, configuration)?, team })
    }

    /// Starts agents. Nobody runs before all are known to the hub, so that nobody misses anything.
    pub(super) fn launch(&mut self, members: Vec<Member>) -> Result<(), Error> {
        self.team.launch_all(members)
    }

    pub(super) fn name(&self) -> &str {
        self.team.hub.host()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.team.workers.is_empty()
    }

    /// Whether no agent will ever do anything again by itself.
    pub(super) fn is_over(&self) -> bool {
        !self.is_empty() && self.team.workers.iter().all(|worker| worker.unit.is_over())
    }

    pub(super) fn rest_body(&self) {
        self.team.rests.store(true, Ordering::SeqCst);
    }

    /// Makes a change from outside.
    pub(super) fn change(&mut self, change: Change, now: Moment) -> Changed {
        self.roster.ask(change, &mut self.team, now)
    }

    /// Makes the changes that were published.
    pub(super) fn attend(&mut self, now: Moment) {
        self.roster.attend(&mut self.team, now);
    }

    pub(super) fn view(&mut self, chart: Option<&ChartChoice>) -> View {
        View {
            chart: chart.map(|chart| self.roster.chart(chart, &self.team)),
            host: self.name().into(),
            agents: self.roster.entries(&self.team),
            configuration: self.roster.configuration(),
            modules: self.roster.modules(),
        }
    }

    /// Looks whether everybody still does something. True if somebody is newly found to be stuck.
    pub(super) fn watch(&self, now: Moment) -> bool {
        let look = |worker: &Worker| {
            let (list, chart) = worker.limits();
            worker.unit.watch(now, list, chart)
        };
        // Everybody is looked at, also when an earlier one is stuck.
        self.team.workers.iter().filter(|worker| look(worker)).count() > 0
    }

    /// Whether nobody has to be waited for when the run ends.
    pub(super) fn is_finished(&self) -> bool {
        self.team.workers.iter().all(Worker::is_finished)
    }

    /// Tells every thread that the run ends.
    pub(super) fn end(&self) {
        self.team.workers.iter().for_each(Worker::end);
    }

    /// Waits for every thread, and tells what the agents have done.
    pub(super) fn join(self) -> Vec<AgentStatistics> {
        let mut all = self.team.gone;
        all.extend(self.team.workers.into_iter().filter_map(Worker::join));
        all
    }
}

impl Team {
    fn launch_all(&mut self, members: Vec<Member>) -> Result<(), Error> {
        let mut ready = Vec::new();
        for member in members {
            let part = || Arc::new(Part::new(self.hub.topics().len()));
            let list = member.list.as_ref().map(|_| part());
            let charts: Vec<Arc<Part>> = member.charts.iter().map(|_| part()).collect();
            let (rests, line) = (self.rests.clone(), self.line.clone());
            let unit = Arc::new(Unit::new(&member.name, list.clone(), charts.clone(), rests, line));
            let place = self.workers.partition_point(|known| known.unit.name < member.name);
            self.workers.insert(
                place,
                Worker {
                    unit: unit.clone(),
                    threads: Vec::new(),
                    frequency: member.frequency,
                    statistics_every: member.statistics_every,
                    scheduling: member.scheduling.clone(),
                    stuck_after: member.stuck_after,
                    teller: member.teller.of_part(0)?,
                },
            );
            ready.push((member, unit, list, charts));
        }
        self.set_waker();
        for (member, unit, list, charts) in ready {
            let threads = self.threads(member, &unit, list, charts)?;
            if let Some(worker) = self.workers.iter_mut().find(|worker| worker.unit.name == unit.name) {
                worker.threads = threads;
            }
        }
        Ok(())
    }

    /// Has every mailbox told of what is published, and the supervisor of changes.
    fn set_waker(&self) {
        let mut mailboxes: Vec<Arc<Mailbox<Called>>> = Vec::new();
        for worker in &self.workers {
            worker.unit.each_part(|part| mailboxes.push(part.mailbox.clone()));
        }
        let (linked, change) = (self.linked.clone(), self.hub.topic(CHANGE.path()));
        let asked = asked(&self.line, self.place);
        self.hub.set_waker(Arc::new(move |topic, host| {
            mailboxes.iter().for_each(|mailbox| mailbox.message(topic, host));
            linked.iter().for_each(|wake| wake(topic, host));
            if Some(topic) == change {
                asked();
            }
        }));
    }

    fn threads(
        &self,
        member: Member,
        unit: &Arc<Unit>,
        list_part: Option<Arc<Part>>,
        chart_parts: Vec<Arc<Part>>,
    ) -> Result<Vec<JoinHandle<AgentStatistics>>, Error> {
        let Member { name, policy, frequency, workers, list, charts, teller, .. } = member;
        let (statistics_every, scheduling) = (member.statistics_every, member.scheduling);
        let sharing = charts.iter().filter(|runner| runner.own().workers.is_none());
        let useful = sharing.map(Runner::max_activities).sum();
        let pool = Arc::new(Pool::new(&name, pool::workers(workers, useful), self.clock, &self.hub));
        let mut threads = Vec::new();
        let of_agent = OfAgent { frequency, policy, scheduling: scheduling.clone(), statistics_every };
        for (runner, part) in charts.into_iter().zip(chart_parts) {
            let own_pool = |workers| {
                let name = format!("{name} {}", runner.place() + 1);
                Arc::new(Pool::new(&name, workers, self.clock, &self.hub))
            };
            let own_pool = runner.own().workers.map(|workers| own_pool(workers.get()));
            let (unit, pool) = (unit.clone(), own_pool.unwrap_or_else(|| pool.clone()));
            let teller = teller.of_part(runner.part())?;
            threads.push(self.spawn_chart(unit, part, runner, of_agent.clone(), pool, teller)?);
        }
        if let (Some(list), Some(frequency), Some(part)) = (list, frequency, list_part) {
            let list = Listing { list, frequency, statistics_every, scheduling };
            threads.push(self.spawn_list(unit.clone(), part, list, &teller)?);
        }
        Ok(threads)
    }

    fn spawn_list(
        &self,
        unit: Arc<Unit>,
        part: Arc<Part>,
        list: Listing,
        teller: &Teller,
    ) -> Result<JoinHandle<AgentStatistics>, Error> {
        let Listing { list, frequency, statistics_every, scheduling } = list;
        let teller = teller.of_part(list.blackboard().part())?;
        let name = unit.name.clone();
        let thread = ListThread {
            host: self.hub.host().into(),
            unit,
            part,
            list,
            deadlines: Deadlines::new(frequency, self.clock.now().max(self.clock.begin())),
            statistics_every,
            scheduling,
            teller,
            clock: self.clock,
            cycles: 0,
            timing: Timing::default(),
            warned: None,
            unsaid: 0,
            was_late: false,
            has_ended: false,
        };
        let hosting = Hosting::real([&self.hub], self.clock);
        spawn(&name, move || hosting.during(|| thread.run()))
    }

    fn spawn_chart(
        &self,
        unit: Arc<Unit>,
        part: Arc<Part>,
        runner: Runner,
        of_agent: OfAgent,
        pool: Arc<Pool>,
        teller: Teller,
    ) -> Result<JoinHandle<AgentStatistics>, Error> {
        let (name, now) = (unit.name.clone(), self.clock.now());
        let frequency = runner.frequency(of_agent.frequency);
        let thread = ChartThread {
            unit,
            part,
            runner,
            of_agent,
            pool,
            teller,
            clock: self.clock,
            looked: now,
            ticks: frequency.map_or(0, |frequency| frequency.first_due(now)),
            steps: 0,
            timing: Timing::default(),
            out: 0,
            calls: Vec::new(),
            notes: TurnNotes::default(),
            run_ends: false,
            is_idle: false,
            has_ended: false,
            pauses: false,
        };
        let hosting = Hosting::real([&self.hub], self.clock);
        spawn(&name, move || hosting.during(|| thread.run()))
    }

    fn worker(&self, agent: &str) -> Option<&Worker> {
        self.workers.iter().find(|worker| worker.unit.name == agent)
    }

    /// Each thread of an agent that begins tells who asked for it.
    fn tell_asked(&self, member: &Member, asked: &Asked) -> Result<(), Error> {
        for runner in &member.charts {
            let mut teller = member.teller.of_part(runner.part())?;
            teller.tell_asked(self.clock.now(), asked, asked.ready_at, runner.place());
        }
        member.list.iter().try_for_each(|list| self.tell_list_asked(&member.teller, list, asked))
    }

    /// A list that begins tells who asked for it, and from when on there are signals for it.
    fn tell_list_asked(&self, teller: &Teller, list: &List, asked: &Asked) -> Result<(), Error> {
        let blackboard = list.blackboard();
        let mut teller = teller.of_part(blackboard.part())?;
        teller.tell_asked(self.clock.now(), asked, blackboard.position(), 0);
        Ok(())
    }

    /// An agent that had no list gets one.
    fn add_list(&mut self, agent: &str, list: List, asked: Option<&Asked>) -> Result<(), String> {
        let part = Arc::new(Part::new(0));
        let Some(worker) = self.worker(agent) else { return Err(format!("`{agent}` is not there")) };
        let Some(frequency) = worker.frequency else {
            return Err(format!("nothing says how often `{agent}` runs"));
        };
        if let Some(asked) = asked {
            self.tell_list_asked(&worker.teller, &list, asked).map_err(|error| error.to_string())?;
        }
        let (unit, statistics_every) = (worker.unit.clone(), worker.statistics_every);
        let list = Listing { list, frequency, statistics_every, scheduling: worker.scheduling.clone() };
        let thread = self.spawn_list(unit.clone(), part.clone(), list, &worker.teller);
        let thread = thread.map_err(|error| error.to_string())?;
        unit.set_list(part);
        self.set_waker();
        if let Some(worker) = self.workers.iter_mut().find(|worker| worker.unit.name == agent) {
            worker.threads.push(thread);
        }
        Ok(())
    }
}

/// A list with what it is run by.
struct Listing {
    list: List,
    frequency: Frequency,
    statistics_every: Option<u64>,
    scheduling: Scheduling,
}

impl Worker {
    fn end(&self) {
        self.unit.each_part(|part| part.mailbox.stop());
    }

    /// How long a cycle of its list and a call of its charts may take.
    fn limits(&self) -> (Duration, Duration) {
        let periods = self.frequency.map(|frequency| frequency.period().saturating_mul(PERIODS));
        let usual = periods.unwrap_or_default().max(STUCK_LIST);
        (self.stuck_after.unwrap_or(usual), self.stuck_after.unwrap_or(STUCK_CALL))
    }

    /// Whether nobody has to be waited for.
    fn is_finished(&self) -> bool {
        self.unit.is_stuck() || self.threads.iter().all(JoinHandle::is_finished)
    }

    /// What all its threads have done. One that is stuck is left to itself.
    fn join(self) -> Option<AgentStatistics> {
        if self.unit.is_stuck() {
            return Some(self.unit.shown().0);
        }
        let mut all: Option<AgentStatistics> = None;
        for thread in self.threads {
            match (thread.join(), &mut all) {
                (Ok(part), Some(all)) => all.add(part),
                (Ok(part), None) => all = Some(part),
                (Err(_), _) => tracing::error!(agent = %self.unit.name, "a thread of the agent has panicked"),
            }
        }
        all
    }
}

impl Staff for Team {
    fn standing(&self, agent: &str) -> Standing {
        self.worker(agent).map_or(Standing::Stopped, |worker| worker.unit.standing())
    }

    fn has_list(&self, agent: &str) -> bool {
        self.worker(agent).is_some_and(|worker| worker.unit.has_list())
    }

    fn standing_of_chart(&self, agent: &str, place: usize) -> Standing {
        let shown = self.worker(agent).map(|worker| worker.unit.shown().1);
        shown.and_then(|charts| charts.get(place).map(|chart| chart.standing)).unwrap_or(Standing::Stopped)
    }

    fn told(&self, agent: &str, place: usize) -> Result<Vec<String>, String> {
        let worker = self.worker(agent).ok_or_else(|| format!("`{agent}` is not there"))?;
        worker.unit.told(place, PATIENCE)
    }

    fn cycles(&self, agent: &str) -> u64 {
        self.worker(agent).map_or(0, |worker| worker.teller.number())
    }

    fn obey(&mut self, agent: &str, mut orders: Orders) -> Result<Vec<String>, Vec<String>> {
        if let Some(list) = orders.list.take() {
            self.add_list(agent, *list, orders.asked.as_ref()).map_err(|reason| vec![reason])?;
        }
        let Some(worker) = self.workers.iter_mut().find(|worker| worker.unit.name == agent) else {
            return Err(vec![format!("`{agent}` is not there")]);
        };
        let of_agent = orders.only.is_none();
        for directive in orders.directives.iter().filter(|_| of_agent) {
            match directive {
                Directive::Start => worker.unit.start(),
                Directive::Stop => drop(worker.unit.stop(TOLD)),
                Directive::Pause => worker.unit.set_pauses(true),
                Directive::Resume => worker.unit.set_pauses(false),
                Directive::Frequency(frequency) => worker.frequency = Some(*frequency),
                Directive::StatisticsEvery(cycles) => worker.statistics_every = *cycles,
                Directive::Scheduling(priority, real_time) => {
                    (worker.scheduling.priority, worker.scheduling.real_time) = (*priority, *real_time);
                }
                Directive::Step | Directive::Policy(_) => {}
            }
        }
        worker.unit.obey(orders, PATIENCE)
    }

    fn launch(&mut self, member: Member, asked: Option<&Asked>) -> Result<(), String> {
        let name = member.name.clone();
        if let Some(asked) = asked {
            self.tell_asked(&member, asked).map_err(|error| error.to_string())?;
        }
        self.launch_all(vec![member]).map_err(|error| {
            // the threads that there are end, and nobody is left without the others
            if let Some(place) = self.workers.iter().position(|worker| worker.unit.name == name) {
                self.workers.remove(place).end();
                self.set_waker();
            }
            error.to_string()
        })
    }

    fn dismiss(&mut self, agent: &str) -> Result<(), String> {
        let Some(place) = self.workers.iter().position(|worker| worker.unit.name == agent) else {
            return Ok(());
        };
        let worker = self.workers.remove(place);
        worker.unit.stop(TOLD);
        worker.end();
        let began = self.clock.now();
        while !worker.is_finished() && self.clock.now() < began + PATIENCE {
            nap();
        }
        if !worker.is_finished() {
            // It has stopped for good as soon as its cycle ends; until then it is known.
            self.workers.insert(place, worker);
            return Err(format!(
                "`{agent}` is in the middle of a cycle that does not end: it stops when that ends"
            ));
        }
        self.set_waker();
        self.gone.extend(worker.join());
        Ok(())
    }

    fn entry(&self, profile: &Profile) -> AgentEntry {
        let Some(worker) = self.worker(&profile.name) else { return AgentEntry::default() };
        let (mut statistics, charts) = worker.unit.shown();
        statistics.cycles = worker.teller.number();
        entry::of(profile, worker.unit.standing(), &statistics, charts)
    }
}

/// A thread.
///
/// # Errors
/// The system gives none.
pub(super) fn spawn<T: Send + 'static>(
    name: &str,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<JoinHandle<T>, Error> {
    thread::Builder::new().name(name.into()).spawn(work).map_err(|error| {
        Error::new(ErrorKind::Thread, format!("no thread for `{name}`: {error}")).caused_by(error)
    })
}
