//! A chart in real time: a thread that steps it, while its activities run on the pool of its agent.

use std::sync::Arc;
use std::time::Duration;

use narukom::{HostId, Moment, TopicSlot};

use super::ENDED;
use super::clock::Clock;
use super::handover::Mail;
use super::orders::{Directive, Orders, ShownChart, Standing, TOLD};
use super::pool::{Called, Pool};
use super::scheduling::Scheduling;
use super::teller::{self, Teller};
use super::turn::{Told, TurnNotes};
use super::unit::{Batch, Part, Unit};
use crate::agent::Policy;
use crate::call::Failure;
use crate::chart::{Assignment, OfAgent, Runner};
use crate::frequency::Frequency;
use crate::monitors::{self, Broken};
use crate::records::Turn;
use crate::statistics::{AgentStatistics, Timing};

/// What the thread of a chart owns.
pub(super) struct ChartThread {
    pub(super) unit: Arc<Unit>,
    pub(super) part: Arc<Part>,
    pub(super) runner: Runner,
    /// What its agent says of all its charts.
    pub(super) of_agent: OfAgent,
    pub(super) pool: Arc<Pool>,
    pub(super) teller: Teller,
    pub(super) clock: Clock,
    /// When it looked at the clock last. Looking takes longer than much of what is done between two looks.
    pub(super) looked: Moment,
    /// When it is woken beside what happens, counted from 0.
    pub(super) ticks: u64,
    pub(super) steps: u64,
    pub(super) timing: Timing,
    /// How many activities are being called, or wait for it on the pool.
    pub(super) out: usize,
    /// The activations whose activities are being called or wait for it, with their places, in the order of the calls.
    pub(super) calls: Vec<(u64, usize, Moment)>,
    pub(super) notes: TurnNotes,
    /// Whether the run ends.
    pub(super) run_ends: bool,
    /// Whether it alone has been told to stop, and not its agent.
    pub(super) is_idle: bool,
    /// Whether the chart has been ended.
    pub(super) has_ended: bool,
    /// Whether it has been told to pause: between two turns, so that a record tells between which.
    pub(super) pauses: bool,
}

impl ChartThread {
    /// Steps whenever something has happened, until the run ends.
    pub(super) fn run(mut self) -> AgentStatistics {
        let mut mail = Mail::<Called>::default();
        self.unit.schedule(&self.scheduling(), &Scheduling::default());
        self.begin();
        while !self.run_ends {
            self.turn(&mut mail);
        }
        self.end(&mut mail);
        self.statistics()
    }

    /// Looks at the clock.
    fn look(&mut self) -> Moment {
        self.looked = self.clock.now();
        self.looked
    }

    fn begin(&mut self) {
        self.follow_guards();
        let now = self.look();
        self.runner.note_fetches();
        self.runner.start(now);
        self.tell_turn(Turn::Start, now);
        (self.has_ended, self.is_idle) = (false, false);
        self.part.begins();
        self.show(true);
    }

    fn follow_guards(&self) {
        for topic in self.runner.topics_of_guards() {
            self.part.mailbox.follow(topic);
        }
    }

    /// Asks the activities that are being called to return, waits for them, and ends the chart.
    fn end(&mut self, mail: &mut Mail<Called>) {
        if self.has_ended {
            return;
        }
        self.has_ended = true;
        self.runner.cancel_all();
        loop {
            let now = self.look();
            mail.messages.clear();
            self.notes.begin_stop(&mut self.runner, &mail.returned);
            while let Some(called) = mail.returned.pop_front() {
                let activation = self.runner.known_as(&called.assignment);
                let activity = self.runner.activity_name(activation);
                if let Err(failure) = self.take_back(called, false, now) {
                    tracing::error!(agent = %self.unit.name, %activity, "activity failed: {failure}");
                }
            }
            if self.out == 0 {
                self.runner.stop(now);
                self.tell_turn(Turn::Stop, now);
                break;
            }
            self.tell_turn(Turn::Stop, now);
            self.wait(Moment::MAX, mail);
        }
        self.unit.is_over_for(&self.part, self.is_idle);
        self.show(true);
    }

    fn wait(&mut self, until: Moment, mail: &mut Mail<Called>) {
        let clock = self.clock;
        let patience = || {
            if until == Moment::MAX {
                return Some(Duration::MAX);
            }
            let now = clock.now();
            (now < until).then(|| until.since(now))
        };
        self.part.mailbox.wait(patience, mail);
        self.run_ends |= mail.stop;
    }

    /// Takes the mail, does what it has been told, and steps until the chart rests.
    fn turn(&mut self, mail: &mut Mail<Called>) {
        let until = match self.rests() {
            true => Moment::MAX,
            false => self.runner.due(self.looked).min(self.tick()),
        };
        self.wait(until, mail);
        self.look();
        if self.run_ends {
            return;
        }
        if self.unit.has_stopped() {
            self.end(mail);
        }
        self.look_up(mail);
        if self.has_ended {
            mail.messages.clear();
        } else if let Err(reason) = self.go_on(mail) {
            let rests_body = self.runner.rests_body(self.of_agent.policy);
            self.unit.fail(&reason, rests_body);
            self.end(mail);
        }
        if self.runner.is_over() {
            self.end(mail);
        }
        self.show(false);
    }

    /// Whether it makes no steps, whatever happens.
    fn rests(&self) -> bool {
        self.has_ended || self.pauses || self.runner.is_over()
    }

    fn tell_turn(&mut self, turn: Turn, now: Moment) {
        // That is for recordings.
        if !self.runner.hub().is_observed() {
            return;
        }
        let due = self.runner.due(now).min(self.tick());
        let first_tick = if turn == Turn::Start { self.ticks } else { 0 };
        self.notes.tell(Told { turn, now, due, first_tick }, &self.runner, &mut self.teller);
    }

    fn go_on(&mut self, mail: &mut Mail<Called>) -> Result<(), String> {
        let now = self.looked;
        self.notes.begin(&mut self.runner, mail);
        let result = self.live(now, mail);
        self.tell_turn(Turn::Round, now);
        result
    }

    fn live(&mut self, now: Moment, mail: &mut Mail<Called>) -> Result<(), String> {
        mail.messages
            .drain(..)
            .for_each(|(topic, host, origin)| self.runner.message_arrived(topic, host, origin, now));
        while let Some(called) = mail.returned.pop_front() {
            self.returned(called, now)?;
            self.rest(now)?;
        }
        self.rest(now)
    }

    fn rest(&mut self, now: Moment) -> Result<(), String> {
        while !self.rests() {
            if let Some(assignment) = self.runner.next_started() {
                self.submit(assignment)?;
            } else if self.runner.needs_step(now) || self.tick() <= now {
                self.step(now)?;
            } else if let Some(assignment) = self.runner.next_waiting(now) {
                self.submit(assignment)?;
            } else {
                return self.lapse(now);
            }
        }
        Ok(())
    }

    fn step(&mut self, now: Moment) -> Result<(), String> {
        while self.tick() <= now {
            self.ticks += 1;
        }
        self.steps += 1;
        // What was done since the last look belongs to the step: taking back what an activity returned.
        let began = self.looked;
        let stepped = self.runner.step(now);
        let broken = self.runner.broken();
        self.teller.tell_step(now, self.runner.delivered().iter().cloned(), &broken);
        let answered = self.answer(&broken, now);
        let took = self.look().since(began);
        self.timing.add(took, None);
        self.tell_times(now);
        stepped.map_err(|error| format!("chart `{}`: {error}", self.runner.name())).and(answered)
    }

    /// Looks whether something that had to come in time has not.
    fn lapse(&mut self, now: Moment) -> Result<(), String> {
        if !self.runner.lapse(now) {
            return Ok(());
        }
        let broken = self.runner.broken();
        self.teller.tell_step(now, [], &broken);
        self.answer(&broken, now)
    }

    fn answer(&self, broken: &[Broken], now: Moment) -> Result<(), String> {
        let who = (self.runner.host(), self.unit.name.as_str());
        let policy = self.runner.policy(self.of_agent.policy);
        monitors::answer(broken, who, policy, self.teller.number(), now)
    }

    fn submit(&mut self, assignment: Assignment) -> Result<(), String> {
        self.calls.push((assignment.activation.number, assignment.place(), self.looked));
        let assignment = assignment.in_cycle(self.teller.number());
        self.pool.submit(assignment, &self.part.mailbox).map_err(|error| error.to_string())?;
        self.out += 1;
        self.beat();
        Ok(())
    }

    fn take_back(&mut self, called: Called, restart: bool, now: Moment) -> Result<(), Failure> {
        let Called { assignment, returned, took } = called;
        self.out -= 1;
        self.calls.retain(|(number, ..)| *number != assignment.activation.number);
        self.beat();
        self.runner.returned(assignment, returned, Some(took), restart, now)
    }

    /// Shows the call that has lasted longest.
    fn beat(&self) {
        match self.calls.first() {
            Some((_, place, since)) => {
                self.part.pulse.calls(*place);
                self.part.pulse.begins(*since, self.steps);
            }
            None => {
                self.part.pulse.ends();
            }
        }
    }

    fn returned(&mut self, called: Called, now: Moment) -> Result<(), String> {
        let activation = self.runner.known_as(&called.assignment);
        let policy = self.runner.policy_of(activation, self.of_agent.policy);
        let result = self.take_back(called, policy == Policy::Restart, now);
        // What came on a topic before it was followed has to be assumed.
        let news: Vec<TopicSlot> = self
            .runner
            .waits_for(activation)
            .iter()
            .filter(|topic| self.part.mailbox.follow(**topic))
            .copied()
            .collect();
        news.into_iter().for_each(|topic| self.runner.message_arrived(topic, HostId::LOCAL, None, now));
        let Err(failure) = result else { return Ok(()) };
        self.runner.has_failed(activation, &failure, self.of_agent.policy, self.teller.number())
    }

    fn look_up(&mut self, mail: &mut Mail<Called>) {
        while let Some(batch) = self.part.next_batch() {
            let (orders, answer) = batch.open();
            let said = self.obey(orders, mail);
            self.show(true);
            Batch::answer(&answer, said);
        }
    }

    fn obey(&mut self, orders: Orders, mail: &mut Mail<Called>) -> Result<Vec<String>, Vec<String>> {
        if orders.look {
            return Ok(self.runner.told());
        }
        let mut said = Vec::new();
        let now = self.look();
        self.teller.tell_ordered(now, &orders, self.runner.place());
        if let Some((_, swap)) = orders.swap {
            said = self.runner.swap(*swap, now)?;
            self.follow_guards();
        }
        orders.instances.into_iter().for_each(|(_, instances)| self.runner.renew(instances, now));
        for runner in orders.charts {
            self.end(mail);
            self.runner = runner;
            self.skip_ticks(now);
            self.begin();
        }
        if let Some((_, own)) = orders.own {
            said.extend(self.settle(|thread| thread.runner.settle(*own), now));
        }
        orders.events.iter().for_each(|event| _ = self.runner.raise(event));
        self.is_idle |= orders.only.is_some() && orders.directives.contains(&Directive::Stop);
        for directive in orders.directives {
            match directive {
                Directive::Stop => self.end(mail),
                Directive::Step => self.step_once(mail).map_err(|reason| vec![reason])?,
                Directive::Frequency(frequency) => {
                    said.extend(self.settle(|thread| thread.of_agent.frequency = Some(frequency), now));
                }
                Directive::Policy(policy) => self.of_agent.policy = policy,
                Directive::StatisticsEvery(cycles) => self.of_agent.statistics_every = cycles,
                Directive::Scheduling(priority, real_time) => {
                    let scheduling = &mut self.of_agent.scheduling;
                    let wanted = Scheduling { priority, real_time, ..scheduling.clone() };
                    said.extend(self.settle(|thread| thread.of_agent.scheduling = wanted, now));
                }
                Directive::Pause => self.pauses = true,
                Directive::Start | Directive::Resume => self.pauses = false,
            }
        }
        Ok(said)
    }

    /// Changes what its thread goes by. Says what the system does not grant.
    fn settle(&mut self, change: impl FnOnce(&mut ChartThread), now: Moment) -> Vec<String> {
        let (frequency, scheduling) = (self.frequency(), self.scheduling());
        change(self);
        if self.frequency() != frequency {
            self.skip_ticks(now);
        }
        match self.scheduling() {
            wanted if wanted != scheduling => self.unit.schedule(&wanted, &scheduling),
            _ => Vec::new(),
        }
    }

    fn frequency(&self) -> Option<Frequency> {
        self.runner.frequency(self.of_agent.frequency)
    }

    fn scheduling(&self) -> Scheduling {
        self.runner.own().scheduling(&self.of_agent.scheduling)
    }

    /// Does one step if there is one to be made, and has the activities called that it starts.
    fn step_once(&mut self, mail: &mut Mail<Called>) -> Result<(), String> {
        let now = self.look();
        self.notes.begin(&mut self.runner, mail);
        let result = self.live(now, mail).and_then(|()| self.one_step(now));
        self.tell_turn(Turn::Step, now);
        result
    }

    fn one_step(&mut self, now: Moment) -> Result<(), String> {
        while let Some(assignment) = self.runner.next_waiting(now) {
            self.submit(assignment)?;
        }
        if !self.runner.is_over() && (self.runner.needs_step(now) || self.tick() <= now) {
            self.step(now)?;
        }
        while let Some(assignment) = self.runner.next_started() {
            self.submit(assignment)?;
        }
        Ok(())
    }

    fn skip_ticks(&mut self, now: Moment) {
        self.ticks = self.frequency().map_or(0, |frequency| frequency.first_due(now));
    }

    /// Writes to the log what steps and calls take, as often as that is wanted.
    fn tell_times(&mut self, now: Moment) {
        let every = self.runner.statistics_every(self.of_agent.statistics_every);
        if every.is_some_and(|every| self.steps.is_multiple_of(every)) {
            let statistics = self.statistics();
            teller::log_times(&statistics);
            self.teller.tell_statistics(&statistics, now);
        }
    }

    fn tick(&self) -> Moment {
        self.frequency().map_or(Moment::MAX, |frequency| frequency.due(self.ticks))
    }

    fn show(&self, always: bool) {
        let standing = match (self.has_ended, self.pauses) {
            (true, _) => Standing::Stopped,
            (false, true) => Standing::Pauses,
            (false, false) => Standing::Runs,
        };
        self.part.show(self.looked, always, || {
            (self.statistics(), ShownChart { active: self.runner.active(), standing })
        });
    }

    fn statistics(&self) -> AgentStatistics {
        AgentStatistics {
            host: self.runner.host().into(),
            agent: self.unit.name.clone(),
            cycles: self.steps,
            micro_steps: self.runner.micro_steps(),
            activities: self.runner.activity_statistics().collect(),
            cycle_time: self.timing.wall(),
            cycle_percentiles: self.timing.percentiles(),
            stopped: self.unit.reason().filter(|reason| reason != ENDED && reason != TOLD),
            ..AgentStatistics::default()
        }
    }
}
