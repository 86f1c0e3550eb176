//! Agents that repeat what they did in real time, turn by turn.

use narukom::{HostId, Moment, TopicSlot};

use super::feed::Feed;
use crate::agent::Policy;
use crate::chart::{Assignment, Lead, Runner, call_record};
use crate::error::Error;
use crate::frequency::Frequency;
use crate::list::List;
use crate::monitors::{self, Broken};
use crate::records::{Call, Cycle, Delivery, News, Turn};
use crate::talws::crew::Member;
use crate::talws::orders::{Directive, Orders, TOLD};
use crate::talws::teller::Teller;
use crate::talws::turn::due_record;

/// The list or the chart of an agent.
pub(super) enum Repeated {
    /// A list that has not begun.
    Waiting(Box<Waiting>),
    List(Box<RepeatedList>),
    Chart(Box<RepeatedChart>),
}

impl Repeated {
    /// What there is of the agent; none if that is not one of them.
    pub(super) fn new(member: Member, feed: &Feed) -> Result<Option<Repeated>, Error> {
        let Member { policy, frequency, list, mut charts, teller, .. } = member;
        Ok(match (list, charts.pop()) {
            (Some(list), None) => {
                let teller = teller.of_part(list.blackboard().part())?;
                let list = RepeatedList { list, teller, feed: feed.clone(), is_over: false };
                Some(Repeated::List(Box::new(list)))
            }
            (None, Some(runner)) if charts.is_empty() => {
                let teller = teller.of_part(runner.part())?;
                let chart = RepeatedChart::new(runner, policy, frequency, teller, feed);
                Some(Repeated::Chart(Box::new(chart)))
            }
            (None, None) => Some(Repeated::Waiting(Box::new(Waiting { teller, feed: feed.clone() }))),
            _ => None,
        })
    }

    /// The list begins, if it waits for that.
    ///
    /// # Errors
    /// It cannot tell of its cycles.
    pub(super) fn begin(&mut self, list: List) -> Result<(), Error> {
        if let Repeated::Waiting(waiting) = self {
            let Waiting { teller, feed } = &**waiting;
            let teller = teller.of_part(list.blackboard().part())?;
            let list = RepeatedList { list, teller, feed: feed.clone(), is_over: false };
            *self = Repeated::List(Box::new(list));
        }
        Ok(())
    }
}

impl Repeated {
    /// The next cycles had these numbers.
    pub(super) fn number_by(&mut self, given: impl Iterator<Item = u64>) {
        match self {
            Repeated::Waiting(_) => {}
            Repeated::List(list) => list.teller.number_by(given),
            Repeated::Chart(chart) => chart.teller.number_by(given),
        }
    }

    /// Follows a change between two turns.
    ///
    /// # Errors
    /// What stands against it: nothing has changed.
    pub(super) fn obey(&mut self, orders: Orders, now: Moment) -> Result<Vec<String>, Vec<String>> {
        match self {
            Repeated::Waiting(_) => Ok(Vec::new()),
            Repeated::List(list) => {
                list.obey(orders);
                Ok(Vec::new())
            }
            Repeated::Chart(chart) => chart.obey(orders, now),
        }
    }
}

/// What a list is to begin with.
pub(super) struct Waiting {
    teller: Teller,
    feed: Feed,
}

/// A list.
pub(super) struct RepeatedList {
    list: List,
    teller: Teller,
    feed: Feed,
    is_over: bool,
}

impl RepeatedList {
    /// A cycle that began at a moment.
    pub(super) fn cycle(&mut self, now: Moment) {
        if self.is_over {
            return;
        }
        self.feed.fetching();
        self.list.begin(now);
        self.feed.publishing();
        self.teller.tell(now, Delivery::all(self.list.blackboard(), 0));
        self.feed.publishing();
        self.list.cycle(now, None);
        self.is_over = self.list.stopped().is_some();
    }

    /// When its cycles were, and so how often, and that it paused, is in their records.
    fn obey(&mut self, orders: Orders) {
        orders.edits.into_iter().for_each(|edit| self.list.edit(edit));
        for directive in orders.directives {
            match directive {
                Directive::Start => self.list.restart(),
                Directive::Stop => self.list.stop(TOLD),
                Directive::Policy(policy) => self.list.set_policy(policy),
                _ => {}
            }
        }
        self.is_over = self.list.stopped().is_some();
    }
}

/// A chart. It does what its thread did, but for the pool: an activity is called when it is known to have come back. So one that looks
/// whether it is asked to return finds that it is, if it was.
pub(super) struct RepeatedChart {
    runner: Runner,
    policy: Policy,
    frequency: Option<Frequency>,
    ticks: u64,
    teller: Teller,
    feed: Feed,
    /// The activities that are with the pool, in the order in which they went there.
    out: Vec<Assignment>,
    /// By topic: whether the chart is told of its messages.
    followed: Vec<bool>,
    /// The moment of the last turn.
    now: Moment,
    /// When it was to do something by itself next, by the record of its last turn.
    was_due: u64,
    has_failed: bool,
    is_stopping: bool,
    pauses: bool,
    /// What it begins anew with.
    next: Option<Runner>,
}

impl RepeatedChart {
    fn new(
        mut runner: Runner,
        policy: Policy,
        frequency: Option<Frequency>,
        teller: Teller,
        feed: &Feed,
    ) -> RepeatedChart {
        runner.be_led(Box::new(feed.clone()));
        let followed = vec![false; runner.hub().topics().len()];
        RepeatedChart {
            runner,
            policy,
            frequency,
            ticks: 0,
            teller,
            feed: feed.clone(),
            out: Vec::new(),
            followed,
            now: Moment::ZERO,
            was_due: 0,
            has_failed: false,
            is_stopping: false,
            pauses: false,
            next: None,
        }
    }

    /// Whether it was told to begin anew, and has not yet.
    pub(super) fn begins_anew(&self) -> bool {
        self.next.is_some()
    }

    fn obey(&mut self, mut orders: Orders, now: Moment) -> Result<Vec<String>, Vec<String>> {
        let mut said = Vec::new();
        if let Some((_, swap)) = orders.swap {
            said = self.runner.swap(*swap, now)?;
            self.follow_guards();
        }
        orders.instances.into_iter().for_each(|(_, instances)| self.runner.renew(instances, now));
        if let Some((_, own)) = orders.own {
            self.settle(|chart| chart.runner.settle(*own), now);
        }
        orders.events.iter().for_each(|event| _ = self.runner.raise(event));
        if let Some(mut runner) = orders.charts.pop() {
            runner.be_led(Box::new(self.feed.clone()));
            self.next = Some(runner);
        }
        for directive in orders.directives {
            match directive {
                Directive::Pause => self.pauses = true,
                Directive::Start | Directive::Resume => self.pauses = false,
                Directive::Frequency(frequency) => {
                    self.settle(|chart| chart.frequency = Some(frequency), now);
                }
                Directive::Policy(policy) => self.policy = policy,
                // That it stopped, or made a step, is a turn of its own; the others change nothing of what it does.
                Directive::Stop
                | Directive::Step
                | Directive::StatisticsEvery(_)
                | Directive::Scheduling(..) => {}
            }
        }
        Ok(said)
    }

    /// Changes what it goes by.
    fn settle(&mut self, change: impl FnOnce(&mut RepeatedChart), now: Moment) {
        let before = self.runner.frequency(self.frequency);
        change(self);
        let frequency = self.runner.frequency(self.frequency);
        if frequency != before {
            self.ticks = frequency.map_or(0, |frequency| frequency.first_due(now));
        }
    }

    fn follow_guards(&mut self) {
        for topic in self.runner.topics_of_guards() {
            self.follow(topic);
        }
    }

    /// Repeats a turn. `has_diverged` says that the chart has done something else than it did before: the recording may not tell any more
    /// when activities come back, and those that it does not know come back in the next turn.
    pub(super) fn turn(&mut self, turn: Turn, record: &Cycle, has_diverged: bool) {
        let now = Moment::from_nanos(record.time);
        (self.now, self.was_due) = (now, record.due);
        let back = self.back(&record.returned, has_diverged);
        match turn {
            Turn::None | Turn::Ordered => {}
            Turn::Step => self.step_once(record, back, now),
            Turn::Start => self.start(record.first_tick, now),
            Turn::Round => self.round(record, back, now),
            Turn::Stop => self.stop(back, now),
        }
    }

    /// When the chart does something by itself before a moment, at which its next recorded turn was. It has no such turn if it waits for
    /// what it waited for then: threads wake late.
    pub(super) fn due_before(&self, next: Moment) -> Option<Moment> {
        let due = self.runner.due(self.now).min(self.tick());
        let is_over = self.has_failed || self.is_stopping || self.pauses || self.runner.is_over();
        let is_new = due > self.now && due < next && due_record(due) != self.was_due;
        (is_new && !is_over).then_some(due)
    }

    /// A turn that was not recorded.
    pub(super) fn turn_by_itself(&mut self, now: Moment) {
        self.now = now;
        let back = self.back(&[], true);
        self.round(&Cycle::default(), back, now);
    }

    fn start(&mut self, first_tick: u64, now: Moment) {
        self.ticks = first_tick;
        if let Some(runner) = self.next.take() {
            self.runner = runner;
            self.out.clear();
            (self.has_failed, self.is_stopping) = (false, false);
        }
        self.follow_guards();
        self.runner.start(now);
    }

    fn round(&mut self, record: &Cycle, back: Vec<Assignment>, now: Moment) {
        if self.has_failed || self.runner.is_over() {
            return;
        }
        record.news.iter().for_each(|news| self.hear(news, now));
        let mut back = back.into_iter();
        for assignment in back.by_ref() {
            self.has_failed |= !self.returned(assignment, now);
            if self.has_failed || !self.rest(now) {
                break;
            }
        }
        // What the chart does not come to any more waits for its end.
        self.out.extend(back);
        if !self.has_failed {
            self.rest(now);
        }
    }

    /// One step of a chart that pauses. If it fails, whoever asked for it is told, and the agent goes on.
    fn step_once(&mut self, record: &Cycle, back: Vec<Assignment>, now: Moment) {
        if self.has_failed {
            return;
        }
        self.round(record, back, now);
        if !self.has_failed {
            self.one_step(now);
        }
        self.has_failed = false;
    }

    fn one_step(&mut self, now: Moment) {
        while let Some(assignment) = self.runner.next_waiting(now) {
            self.out.push(assignment);
        }
        let is_due = self.runner.needs_step(now) || self.tick() <= now;
        if !self.runner.is_over() && is_due && !self.step(now) {
            return;
        }
        while let Some(assignment) = self.runner.next_started() {
            self.out.push(assignment);
        }
    }

    /// The activities that have come back, in the order in which they did.
    fn back(&mut self, calls: &[Call], has_diverged: bool) -> Vec<Assignment> {
        let mut back = Vec::new();
        for call in calls {
            let place = self.out.iter().position(|assignment| call_record(assignment.activation) == *call);
            back.extend(place.map(|place| self.out.remove(place)));
        }
        if has_diverged {
            self.out.iter().for_each(Assignment::ask_to_return);
            back.append(&mut self.out);
        }
        back
    }

    fn hear(&mut self, news: &News, now: Moment) {
        let host = match news.host.as_str() {
            "" => HostId::LOCAL,
            // A hub that has no number for it has no message of it either.
            name => match self.runner.hub().host_id(name) {
                Ok(host) => host,
                Err(_) => return,
            },
        };
        let origin = news.by.and_then(|call| self.runner.origin(call.node, call.number));
        self.runner.message_arrived(TopicSlot::new(news.topic), host, origin, now);
    }

    /// True if the chart goes on.
    fn rest(&mut self, now: Moment) -> bool {
        while !self.has_failed && !self.pauses {
            if let Some(assignment) = self.runner.next_started() {
                self.out.push(assignment);
            } else if self.runner.needs_step(now) || self.tick() <= now {
                self.has_failed = !self.step(now);
            } else if let Some(assignment) = self.runner.next_waiting(now) {
                self.out.push(assignment);
            } else {
                self.has_failed = !self.lapse(now);
                break;
            }
        }
        !self.has_failed
    }

    /// Looks whether something that had to come in time has not. False if the agent is to stop.
    fn lapse(&mut self, now: Moment) -> bool {
        if !self.runner.lapse(now) {
            return true;
        }
        let broken = self.runner.broken();
        self.feed.publishing();
        self.teller.tell_step(now, [], &broken);
        self.answer(&broken, now)
    }

    fn answer(&self, broken: &[Broken], now: Moment) -> bool {
        let who = (self.runner.host(), self.runner.agent());
        let policy = self.runner.policy(self.policy);
        monitors::answer(broken, who, policy, self.teller.number(), now).is_ok()
    }

    fn tick(&self) -> Moment {
        let frequency = self.runner.frequency(self.frequency);
        frequency.map_or(Moment::MAX, |frequency| frequency.due(self.ticks))
    }

    fn step(&mut self, now: Moment) -> bool {
        while self.tick() <= now {
            self.ticks += 1;
        }
        let stepped = self.runner.step(now);
        self.feed.publishing();
        let broken = self.runner.broken();
        self.teller.tell_step(now, self.runner.delivered().iter().cloned(), &broken);
        self.answer(&broken, now) && stepped.is_ok()
    }

    /// An activity has come back: it is called. False if the agent is to stop.
    fn returned(&mut self, assignment: Assignment, now: Moment) -> bool {
        let activation = self.runner.known_as(&assignment);
        let policy = self.runner.policy_of(activation, self.policy);
        let has_failed = self.take_back(assignment, policy == Policy::Restart, now);
        // What came on a topic before it was followed has to be assumed.
        for topic in self.runner.waits_for(activation).to_vec() {
            if self.follow(topic) {
                self.runner.message_arrived(topic, HostId::LOCAL, None, now);
            }
        }
        !has_failed || matches!(policy, Policy::Restart | Policy::Skip)
    }

    /// Whether the activity failed.
    fn take_back(&mut self, mut assignment: Assignment, restart: bool, now: Moment) -> bool {
        let returned = assignment.call();
        self.runner.returned(assignment, returned, None, restart, now).is_err()
    }

    /// Whether the topic was not followed before.
    fn follow(&mut self, topic: TopicSlot) -> bool {
        let followed = self.followed.get_mut(topic.number() as usize);
        followed.is_some_and(|followed| !std::mem::replace(followed, true))
    }

    fn stop(&mut self, back: Vec<Assignment>, now: Moment) {
        if !self.is_stopping {
            self.runner.cancel_all();
        }
        self.is_stopping = true;
        for assignment in back {
            self.take_back(assignment, false, now);
        }
        if self.out.is_empty() {
            self.runner.stop(now);
        }
    }
}
