//! A chart in real time: a thread that steps it, while its activities run on the pool of its agent.

use std::sync::Arc;

use narukom::{HostId, Moment, TopicSlot};

use super::ENDED;
use super::clock::Clock;
use super::handover::{Mail, Mailbox};
use super::pool::{Called, Pool};
use super::real_time::Switch;
use super::teller::{self, Teller};
use super::turn::{Told, TurnNotes};
use crate::agent::Policy;
use crate::call::Failure;
use crate::chart::{Assignment, Runner};
use crate::frequency::Frequency;
use crate::records::Turn;
use crate::statistics::{AgentStatistics, Average};

/// What the thread of a chart owns.
pub(super) struct ChartThread {
    pub(super) agent: String,
    pub(super) runner: Runner,
    pub(super) policy: Policy,
    pub(super) frequency: Option<Frequency>,
    pub(super) statistics_every: Option<u64>,
    pub(super) mailbox: Arc<Mailbox<Called>>,
    pub(super) pool: Arc<Pool>,
    pub(super) teller: Teller,
    pub(super) switch: Arc<Switch>,
    pub(super) clock: Clock,
    /// When it is woken beside what happens, counted from 0.
    pub(super) ticks: u64,
    pub(super) steps: u64,
    pub(super) step_time: Average,
    /// How many activities are being called, or wait for it on the pool.
    pub(super) out: usize,
    pub(super) notes: TurnNotes,
}

impl ChartThread {
    /// Steps whenever something has happened, until the agent is stopped.
    pub(super) fn run(mut self) -> AgentStatistics {
        for topic in self.runner.topics_of_guards() {
            self.mailbox.follow(topic);
        }
        let now = self.clock.now();
        self.runner.note_fetches();
        self.runner.start(now);
        self.tell_turn(Turn::Start, now);
        let mut mail = Mail::<Called>::default();
        let mut stopped = None;
        while stopped.is_none() && !self.runner.is_over() {
            stopped = self.turn(&mut mail).err();
        }
        if let Some(reason) = &stopped {
            self.switch.stop(reason);
        }
        self.wind_up(&mut mail);
        self.statistics(stopped)
    }

    /// Asks the activities that are being called to return, waits for them, and ends the chart.
    fn wind_up(&mut self, mail: &mut Mail<Called>) {
        self.runner.cancel_all();
        loop {
            let now = self.clock.now();
            self.notes.begin_stop(&mut self.runner, &mail.returned);
            while let Some(called) = mail.returned.pop_front() {
                let activity = self.runner.activity_name(called.assignment.activation);
                if let Err(failure) = self.take_back(called, false, now) {
                    tracing::error!(agent = %self.agent, %activity, "activity failed: {failure}");
                }
            }
            if self.out == 0 {
                self.runner.stop(now);
                return self.tell_turn(Turn::Stop, now);
            }
            self.tell_turn(Turn::Stop, now);
            self.wait(Moment::MAX, mail);
        }
    }

    fn wait(&self, until: Moment, mail: &mut Mail<Called>) {
        let clock = self.clock;
        let patience = || {
            let now = clock.now();
            (now < until).then(|| until.since(now))
        };
        self.mailbox.wait(patience, mail);
    }

    /// Takes the mail, and steps until the chart rests.
    ///
    /// # Errors
    /// Why the agent is to stop.
    fn turn(&mut self, mail: &mut Mail<Called>) -> Result<(), String> {
        let until = self.runner.due(self.clock.now()).min(self.tick());
        self.wait(until, mail);
        if mail.stop {
            return Err(ENDED.into());
        }
        let now = self.clock.now();
        self.notes.begin(&mut self.runner, mail);
        let result = self.live(now, mail);
        self.tell_turn(Turn::Round, now);
        result
    }

    fn tell_turn(&mut self, turn: Turn, now: Moment) {
        let due = self.runner.due(now).min(self.tick());
        let first_tick = if turn == Turn::Start { self.ticks } else { 0 };
        self.notes.tell(Told { turn, now, due, first_tick }, &self.runner, &mut self.teller);
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
        loop {
            if let Some(assignment) = self.runner.next_started() {
                self.submit(assignment)?;
            } else if self.runner.needs_step(now) || self.tick() <= now {
                self.step(now)?;
            } else if let Some(assignment) = self.runner.next_waiting(now) {
                self.submit(assignment)?;
            } else {
                return Ok(());
            }
        }
    }

    fn step(&mut self, now: Moment) -> Result<(), String> {
        while self.tick() <= now {
            self.ticks += 1;
        }
        self.steps += 1;
        let began = self.clock.now();
        let stepped = self.runner.step(now);
        self.teller.tell(now, self.runner.delivered().to_vec());
        self.step_time.add(self.clock.now().since(began));
        self.tell_times();
        stepped.map_err(|error| format!("chart `{}`: {error}", self.runner.name()))
    }

    fn submit(&mut self, assignment: Assignment) -> Result<(), String> {
        self.pool.submit(assignment, &self.mailbox).map_err(|error| error.to_string())?;
        self.out += 1;
        Ok(())
    }

    fn take_back(&mut self, called: Called, restart: bool, now: Moment) -> Result<(), Failure> {
        let Called { assignment, returned, took } = called;
        self.out -= 1;
        self.runner.returned(assignment, returned, Some(took), restart, now)
    }

    fn returned(&mut self, called: Called, now: Moment) -> Result<(), String> {
        let activation = called.assignment.activation;
        let result = self.take_back(called, self.policy == Policy::Restart, now);
        // What came on a topic before it was followed has to be assumed.
        let news: Vec<TopicSlot> = self
            .runner
            .waits_for(activation)
            .iter()
            .filter(|topic| self.mailbox.follow(**topic))
            .copied()
            .collect();
        news.into_iter().for_each(|topic| self.runner.message_arrived(topic, HostId::LOCAL, None, now));
        let Err(failure) = result else { return Ok(()) };
        let activity = self.runner.activity_name(activation);
        let cycle = self.teller.number();
        tracing::error!(agent = %self.agent, %activity, cycle, "activity failed: {failure}");
        match self.policy {
            Policy::Restart | Policy::Skip => Ok(()),
            Policy::StopAgent | Policy::SafeState => {
                if self.policy == Policy::SafeState {
                    self.switch.rest_body();
                }
                Err(format!("activity `{activity}` failed in cycle {cycle}: {failure}"))
            }
        }
    }

    /// Writes to the log what steps and calls take, as often as that is wanted.
    fn tell_times(&self) {
        if self.statistics_every.is_some_and(|every| self.steps.is_multiple_of(every)) {
            teller::log_times(&self.agent, self.steps, self.step_time, self.runner.activity_statistics());
        }
    }

    fn tick(&self) -> Moment {
        self.frequency.map_or(Moment::MAX, |frequency| frequency.due(self.ticks))
    }

    fn statistics(&self, stopped: Option<String>) -> AgentStatistics {
        AgentStatistics {
            host: self.runner.host().into(),
            agent: self.agent.clone(),
            cycles: self.steps,
            micro_steps: self.runner.micro_steps(),
            activities: self.runner.activity_statistics().collect(),
            cycle_time: (self.step_time.count() > 0).then_some(self.step_time),
            stopped: stopped.filter(|reason| reason != ENDED),
            ..AgentStatistics::default()
        }
    }
}
