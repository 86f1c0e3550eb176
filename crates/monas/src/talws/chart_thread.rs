//! A chart in real time: a thread that steps it, while its activities run on the pool of its agent.

use std::sync::{Arc, Mutex, PoisonError};

use narukom::{Moment, TopicSlot};

use super::ENDED;
use super::clock::Clock;
use super::mailbox::{Mail, Mailbox};
use super::pool::Pool;
use super::real_time::Switch;
use super::teller::Teller;
use crate::agent::Policy;
use crate::chart::{Assignment, Returned, Runner};
use crate::frequency::Frequency;
use crate::statistics::AgentStatistics;

/// What the thread of a chart owns.
pub(super) struct ChartThread {
    pub(super) agent: String,
    pub(super) runner: Runner,
    pub(super) policy: Policy,
    pub(super) frequency: Option<Frequency>,
    pub(super) mailbox: Arc<Mailbox>,
    pub(super) pool: Arc<Mutex<Pool>>,
    pub(super) teller: Teller,
    pub(super) switch: Arc<Switch>,
    pub(super) clock: Clock,
    /// When it is woken beside what happens, counted from 0.
    pub(super) ticks: u64,
    pub(super) steps: u64,
    /// How many activities are being called, or wait for it on the pool.
    pub(super) out: usize,
}

impl ChartThread {
    /// Steps whenever something has happened, until the agent is stopped.
    pub(super) fn run(mut self) -> AgentStatistics {
        for topic in self.runner.topics_of_guards() {
            self.mailbox.follow(topic);
        }
        self.runner.start(self.clock.now());
        let mut mail = Mail::default();
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

    /// Lets the activities that are being called finish, and ends the chart.
    fn wind_up(&mut self, mail: &mut Mail) {
        loop {
            let now = self.clock.now();
            for (assignment, returned) in mail.returned.drain(..) {
                self.out -= 1;
                self.runner.take_back(assignment);
                if let Err(failure) = self.runner.returned(returned, false, now) {
                    tracing::error!(agent = %self.agent, "activity failed: {failure}");
                }
            }
            if self.out == 0 {
                return self.runner.stop(now);
            }
            self.mailbox.wait(Moment::MAX, &self.clock, mail);
        }
    }

    /// Takes the mail, and steps until the chart rests.
    ///
    /// # Errors
    /// Why the agent is to stop.
    fn turn(&mut self, mail: &mut Mail) -> Result<(), String> {
        let until = self.runner.due(self.clock.now()).min(self.tick());
        self.mailbox.wait(until, &self.clock, mail);
        if mail.stop {
            return Err(ENDED.into());
        }
        let now = self.clock.now();
        mail.messages.drain(..).for_each(|(topic, origin)| self.runner.message_arrived(topic, origin, now));
        while let Some((assignment, returned)) = mail.returned.pop_front() {
            self.out -= 1;
            self.runner.take_back(assignment);
            self.returned(returned, now)?;
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
        let stepped = self.runner.step(now);
        self.teller.tell(now, self.runner.delivered().to_vec());
        // A running activity cannot be hurried; what it returns is taken when it comes.
        self.runner.take_cancelled();
        stepped.map_err(|error| format!("chart `{}`: {error}", self.runner.name()))
    }

    fn submit(&mut self, assignment: Assignment) -> Result<(), String> {
        let mut pool = self.pool.lock().unwrap_or_else(PoisonError::into_inner);
        pool.submit(assignment, self.mailbox.clone()).map_err(|error| error.to_string())?;
        self.out += 1;
        Ok(())
    }

    fn returned(&mut self, returned: Returned, now: Moment) -> Result<(), String> {
        let activation = returned.activation;
        let result = self.runner.returned(returned, self.policy == Policy::Restart, now);
        // What came on a topic before it was followed has to be assumed.
        let news: Vec<TopicSlot> = self
            .runner
            .waits_for(activation)
            .iter()
            .filter(|topic| self.mailbox.follow(**topic))
            .copied()
            .collect();
        news.into_iter().for_each(|topic| self.runner.message_arrived(topic, None, now));
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
            stopped: stopped.filter(|reason| reason != ENDED),
            ..AgentStatistics::default()
        }
    }
}
