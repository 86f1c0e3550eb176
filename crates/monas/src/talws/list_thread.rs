//! A list in real time: a thread that runs a cycle whenever one is due.

use std::sync::Arc;
use std::time::Duration;

use narukom::Moment;

use super::ENDED;
use super::clock::{CPU_EVERY, Clock, cpu_time};
use super::deadlines::Deadlines;
use super::handover::Mail;
use super::orders::{Directive, Orders, ShownChart, TOLD};
use super::pool::Called;
use super::scheduling::Scheduling;
use super::teller::{self, Teller};
use super::unit::{Batch, Part, Unit};
use crate::list::{List, Outcome, Watch};
use crate::records::Delivery;
use crate::statistics::{AgentStatistics, Timing};

/// It is said once in this time that cycles take too long.
const WARN: Duration = Duration::from_secs(1);

/// What the thread of a list owns.
pub(super) struct ListThread {
    pub(super) host: String,
    pub(super) unit: Arc<Unit>,
    pub(super) part: Arc<Part>,
    pub(super) list: List,
    pub(super) deadlines: Deadlines,
    pub(super) statistics_every: Option<u64>,
    pub(super) scheduling: Scheduling,
    pub(super) teller: Teller,
    pub(super) clock: Clock,
    pub(super) cycles: u64,
    pub(super) timing: Timing,
    /// When a cycle was last said to have taken too long, and how many have since.
    pub(super) warned: Option<Moment>,
    pub(super) unsaid: u64,
    /// Whether the last cycle took too long.
    pub(super) was_late: bool,
    /// Whether its activities have been told to stop.
    pub(super) has_ended: bool,
}

impl ListThread {
    /// Runs cycles until the run ends.
    pub(super) fn run(mut self) -> AgentStatistics {
        let mut mail = Mail::<Called>::default();
        self.unit.schedule(&self.scheduling, &Scheduling::default());
        self.show(true);
        loop {
            self.wait(&mut mail);
            if mail.stop {
                break;
            }
            self.look_up();
            if !self.rests() && self.deadlines.next() <= self.clock.now() {
                self.cycle();
            }
        }
        self.list.stop(ENDED);
        self.statistics()
    }

    /// Waits for the next cycle, or for somebody to say something.
    fn wait(&self, mail: &mut Mail<Called>) {
        let (clock, rests) = (self.clock, self.rests());
        let until = if rests { Moment::MAX } else { self.deadlines.next() };
        let patience = || {
            let now = clock.now();
            (now < until).then(|| until.since(now))
        };
        self.part.mailbox.wait(patience, mail);
    }

    /// Whether no cycle is due whatever the time is.
    fn rests(&self) -> bool {
        self.has_ended || self.unit.pauses() || self.unit.has_stopped()
    }

    /// Does what it has been told.
    fn look_up(&mut self) {
        if self.unit.has_stopped() {
            self.end();
        }
        while let Some(batch) = self.part.next_batch() {
            let (orders, answer) = batch.open();
            let said = self.obey(orders);
            self.show(true);
            Batch::answer(&answer, Ok(said));
        }
    }

    fn end(&mut self) {
        if !self.has_ended {
            self.has_ended = true;
            self.list.stop(&self.unit.reason().unwrap_or_else(|| TOLD.into()));
            self.unit.is_over_for(&self.part, false);
            self.show(true);
        }
    }

    fn obey(&mut self, orders: Orders) -> Vec<String> {
        let mut said = Vec::new();
        let now = self.clock.now();
        self.teller.tell_ordered(now, &orders, 0);
        orders.edits.into_iter().for_each(|edit| self.list.edit(edit));
        for directive in orders.directives {
            match directive {
                Directive::Start => {
                    self.list.restart();
                    self.has_ended = false;
                    self.deadlines.skip_to(now);
                }
                Directive::Stop => self.end(),
                Directive::Resume => self.deadlines.skip_to(now),
                Directive::Step => self.cycle(),
                Directive::Frequency(frequency) => self.deadlines.set_frequency(frequency, now),
                Directive::Policy(policy) => self.list.set_policy(policy),
                Directive::StatisticsEvery(cycles) => self.statistics_every = cycles,
                Directive::Scheduling(priority, real_time) => {
                    let wanted = Scheduling { priority, real_time, ..self.scheduling.clone() };
                    let was = std::mem::replace(&mut self.scheduling, wanted);
                    said.extend(self.unit.schedule(&self.scheduling, &was));
                }
                Directive::Pause => {}
            }
        }
        said
    }

    fn cycle(&mut self) {
        let began = self.clock.now();
        self.list.begin(began);
        let blackboard = self.list.blackboard();
        self.teller.tell_noted(began, Delivery::all(blackboard, 0), &[blackboard.position()]);
        let cpu = if self.was_late || self.cycles.is_multiple_of(CPU_EVERY) { cpu_time() } else { None };
        self.part.pulse.begins(began, self.list.number());
        let watch = Watch { clock: &self.clock, since: began, cpu, pulse: &self.part.pulse };
        let outcome = self.list.cycle(began, Some(watch));
        self.part.pulse.ends();
        let ended = self.clock.now();
        let cpu = cpu.and_then(|before| Some(cpu_time()?.saturating_sub(before)));
        self.timing.add(ended.since(began), cpu);
        self.account(ended);
        if outcome != Outcome::Continues {
            self.has_ended = true;
            self.unit.fail(self.list.stopped().unwrap_or_default(), outcome == Outcome::SafeState);
            self.unit.is_over_for(&self.part, false);
        }
        self.show(outcome != Outcome::Continues);
    }

    fn account(&mut self, ended: Moment) {
        self.cycles += 1;
        let late = self.deadlines.ended(ended);
        self.was_late = late.is_some();
        late.into_iter().for_each(|late| self.warn(late, ended));
        if self.statistics_every.is_some_and(|every| self.cycles.is_multiple_of(every)) {
            let statistics = self.statistics();
            teller::log_times(&statistics);
            self.teller.tell_statistics(&statistics, ended);
        }
    }

    /// Says that a cycle took too long; once a second at most, with how many there were besides.
    fn warn(&mut self, late: Duration, now: Moment) {
        if self.warned.is_some_and(|warned| now < warned + WARN) {
            self.unsaid += 1;
            return;
        }
        let (agent, cycle, unsaid) = (&self.unit.name, self.cycles, self.unsaid);
        tracing::warn!(%agent, cycle, unsaid, "cycle ended {late:?} after the next was due");
        (self.warned, self.unsaid) = (Some(now), 0);
    }

    fn show(&self, always: bool) {
        self.part.show(self.clock.now(), always, || (self.statistics(), ShownChart::default()));
    }

    fn statistics(&self) -> AgentStatistics {
        AgentStatistics {
            host: self.host.clone(),
            agent: self.unit.name.clone(),
            cycles: self.cycles,
            overruns: self.deadlines.overruns(),
            activities: self.list.activity_statistics().collect(),
            missed: self.deadlines.missed(),
            cycle_time: self.timing.wall(),
            cycle_cpu: self.timing.cpu(),
            cycle_percentiles: self.timing.percentiles(),
            stopped: self
                .list
                .stopped()
                .filter(|reason| *reason != ENDED && *reason != TOLD)
                .map(str::to_owned),
            ..AgentStatistics::default()
        }
    }
}
