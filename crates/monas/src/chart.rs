//! A statechart of an agent while it runs: the machine, its blackboards, and the activities of its states.
//!
//! The runner decides nothing about time: whoever drives it hands in the moment, calls activities where and when it likes (inline
//! in simulated time, on a pool in real time), and brings back what they returned.

mod desk;
mod fetching;
mod following;
mod lending;
mod own;
mod post;
mod swap;
mod told;
mod urgency;
pub(crate) mod values;

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use narukom::{HostId, Moment, Narukom, TopicSlot};
use yase::{Activation, Chooser, Machine, MachineError, NodeId, Outcome, Status, TopicId};

use crate::activity::{Activity, Progress};
use crate::agent::ChartSettings;
use crate::binder::BoundChart;
use crate::call::{self, Failure};
use crate::coverage::ChartCoverage;
use crate::error::Error;
use crate::listener::Listeners;
use crate::monitors::{Broken, Monitors, Seen};
use crate::origin::{self, Origin};
use crate::records;
use crate::statistics::ActivityStatistics;
use crate::talws::component_seed;

pub(crate) use desk::transition_name;
use desk::{Desk, Root};
use fetching::Fetching;
pub(crate) use fetching::Lead;
pub(crate) use own::OfAgent;
pub(crate) use post::{Assignment, Posts, Returned, Took};
pub(crate) use swap::Swap;

/// How long the first pause is of an activity that is restarted; each further one in a row is twice as long, up to 64 times.
const FIRST_PAUSE: Duration = Duration::from_millis(10);
/// An activity that goes on is not called again earlier than this, but for messages.
const SHORTEST_DELAY: Duration = Duration::from_millis(1);
/// How many runners there have been.
static RUNNERS: AtomicU64 = AtomicU64::new(0);
/// How often the pause doubles at most.
const DOUBLINGS: u32 = 6;

/// One statechart of an agent.
pub(crate) struct Runner {
    /// Unlike every other runner's in this program.
    number: u64,
    hub: Narukom,
    machine: Machine,
    desk: Desk,
    posts: Posts,
    monitors: Option<Monitors>,
    own: ChartSettings,
    /// Whether the body is to rest since an activity has failed, if one has.
    rests_body: Option<bool>,
    micro_steps: u64,
}

/// Where a runner belongs.
#[derive(Clone, Copy)]
pub(crate) struct Home<'a> {
    pub(crate) hub: &'a Narukom,
    pub(crate) agent: &'a str,
    /// The chart's place among the charts of the agent.
    pub(crate) number: u32,
    pub(crate) seed: u64,
    pub(crate) listeners: &'a Listeners,
    /// When it is set up.
    pub(crate) now: Moment,
}

impl Home<'_> {
    /// The path of the chart, of which those of its random numbers begin.
    fn path(&self) -> String {
        format!("{}/{}/{}", self.hub.host(), self.agent, self.number)
    }

    /// As which part of its agent it publishes.
    fn part(&self) -> u16 {
        u16::try_from(self.number).unwrap_or(u16::MAX)
    }

    /// The seed of what the chart leaves open.
    fn chance(&self) -> u64 {
        let seed = component_seed(self.seed, &format!("{}#chooser", self.path()));
        seed.iter().take(8).fold(0, |number, byte| number << 8 | u64::from(*byte))
    }
}

impl Runner {
    pub(crate) fn new(bound: BoundChart, own: ChartSettings, home: Home<'_>) -> Result<Runner, Error> {
        let BoundChart { chart, functions, activities } = bound;
        let desk = Desk::new(&chart, home, functions)?;
        let posts = Posts::new(&chart, activities, home.hub, home.agent);
        let mut machine = Machine::new(chart);
        machine.set_chooser(Chooser::seeded(home.chance()));
        let number = RUNNERS.fetch_add(1, Ordering::Relaxed);
        Ok(Runner {
            number,
            hub: home.hub.clone(),
            machine,
            desk,
            posts,
            monitors: None,
            own,
            rests_body: None,
            micro_steps: 0,
        })
    }

    /// Follows properties of the chart from its start on.
    pub(crate) fn follow(&mut self, monitors: Monitors) {
        self.desk.lending.read_too(monitors.topics());
        self.desk.seen = Some(Seen::default());
        self.monitors = Some(monitors);
    }

    /// The properties that were found violated since it was last asked.
    pub(crate) fn broken(&mut self) -> Vec<Broken> {
        self.monitors.as_mut().map(Monitors::broken).unwrap_or_default()
    }

    /// Whether something that had to come in time has not.
    pub(crate) fn lapse(&mut self, now: Moment) -> bool {
        self.monitors.as_mut().is_some_and(|monitors| monitors.lapse(now))
    }

    fn watch(&mut self, now: Moment) {
        if let (Some(monitors), Some(seen)) = (&mut self.monitors, &self.desk.seen) {
            monitors.step(&self.machine, seen, &Root(&self.desk), now);
        }
        if let Some(seen) = &mut self.desk.seen {
            seen.clear();
        }
    }

    /// Enters the root. The first transitions are those of the first step.
    pub(crate) fn start(&mut self, now: Moment) {
        self.desk.now = now;
        self.machine.start(yase_moment(now), &mut self.desk);
    }

    /// Takes note of a message, and of the activity that published it, if one of a chart did.
    pub(crate) fn message_arrived(
        &mut self,
        topic: TopicSlot,
        host: HostId,
        origin: Option<Origin>,
        now: Moment,
    ) {
        let id = TopicId(topic.number());
        if self.machine.reads_topic(id) {
            self.tell(id, host);
        }
        let own = origin.filter(|origin| origin.runner == self.number).map(|origin| origin.activation);
        self.posts.message_arrived(topic, own, now);
    }

    fn tell(&mut self, topic: TopicId, host: HostId) {
        if host == HostId::LOCAL {
            self.machine.message_arrived(topic, 1);
        } else if let Some(host) = self.hub.host_name(host) {
            self.machine.message_arrived_from(&host, topic, 1);
        }
    }

    /// Takes note of an event from outside. False if no expression names it.
    pub(crate) fn raise(&mut self, event: &str) -> bool {
        self.machine.dispatch_name(event)
    }

    /// When it has something to do by itself: a step, or a call of an activity that waits for one.
    pub(crate) fn due(&self, now: Moment) -> Moment {
        if self.machine.needs_step(yase_moment(now)) {
            return now;
        }
        let deadline =
            self.machine.next_deadline().map_or(Moment::MAX, |at| Moment::from_nanos(at.as_nanos()));
        let missed = self.monitors.as_ref().map_or(Moment::MAX, Monitors::due);
        deadline.min(self.posts.next_call()).min(missed)
    }

    pub(crate) fn needs_step(&self, now: Moment) -> bool {
        self.machine.needs_step(yase_moment(now))
    }

    /// Makes one run-to-completion step. Then [`Runner::next_started`] gives the activities that it started.
    ///
    /// # Errors
    /// The chart never comes to rest; it has stopped.
    pub(crate) fn step(&mut self, now: Moment) -> Result<(), MachineError> {
        self.desk.begin_step(now);
        let known = self.desk.started.len();
        let summary = self.machine.run_to_completion(yase_moment(now), &mut self.desk);
        let summary = summary?;
        self.micro_steps += u64::from(summary.micro_steps);
        self.watch(now);
        self.desk.started.iter().skip(known).for_each(|activation| self.posts.begin(*activation));
        self.leave(now);
        Ok(())
    }

    /// The activities whose state was left while they waited to be called again end.
    fn leave(&mut self, now: Moment) {
        while let Some(activation) = self.desk.left.pop() {
            let blackboard = self.desk.lending.free_mut(activation.region, now);
            let (Some(blackboard), Some(activity)) = (blackboard, self.posts.leave(activation)) else {
                continue;
            };
            if let Err(failure) = call::stop(activity, blackboard) {
                tracing::error!(robot = %self.desk.host, agent = %self.desk.agent, "activity failed to stop: {failure}");
            }
            self.desk.lending.publish_all(activation.region, now);
        }
    }

    /// The next activity that the last step started, with its blackboard. One whose state is active again before the last call of the
    /// state's activity has returned has to wait for that: there is one instance.
    pub(crate) fn next_started(&mut self) -> Option<Assignment> {
        let (machine, posts) = (&self.machine, &self.posts);
        self.desk.started.retain(|activation| is_current(machine, posts, *activation));
        let ready = self.desk.started.iter().position(|activation| posts.is_free(*activation))?;
        let activation = self.desk.started.remove(ready)?;
        self.assign(activation)
    }

    /// The next activity that waited for another call and is due, with its blackboard, to which what arrived is delivered.
    pub(crate) fn next_waiting(&mut self, now: Moment) -> Option<Assignment> {
        loop {
            let activation = self.posts.due(now)?;
            if self.machine.activity_resumed(activation) {
                self.desk.now = now;
                self.desk.lending.refresh(activation.region, now)?;
                return self.assign(activation);
            }
        }
    }

    /// An activity that waits for another call, called now, with its blackboard, to which what arrived is delivered.
    pub(crate) fn call_now(&mut self, node: NodeId, now: Moment) -> Option<Assignment> {
        let activation = self.posts.hurry(node)?;
        if !self.machine.activity_resumed(activation) {
            return None;
        }
        self.desk.now = now;
        self.desk.lending.refresh(activation.region, now)?;
        self.assign(activation)
    }

    fn assign(&mut self, activation: Activation) -> Option<Assignment> {
        let priority = self.desk.urgency.of(activation.node);
        let blackboard = self.desk.lending.lend(activation, self.desk.now)?;
        self.posts.assign(activation, priority, blackboard)
    }

    /// Goes on with other instances of the activities of states. One that waits for its next call, or comes back from one, is told to stop;
    /// the other is started before it is called.
    pub(crate) fn renew(&mut self, instances: Vec<(NodeId, Box<dyn Activity>)>, now: Moment) {
        for (node, activity) in instances {
            let Some((mut old, activation)) = self.posts.renew(node, activity, &self.hub) else { continue };
            let Some(blackboard) = self.desk.lending.free_mut(activation.region, now) else { continue };
            if let Err(failure) = call::stop(old.as_mut(), blackboard) {
                tracing::error!(robot = %self.desk.host, agent = %self.desk.agent, "activity failed to stop: {failure}");
            }
            self.desk.lending.publish_all(activation.region, now);
        }
    }

    /// Takes back an activity that was not called.
    pub(crate) fn put_back(&mut self, assignment: Assignment) {
        let (activation, blackboard) = self.posts.take_back(assignment, None);
        self.desk.lending.take_back(activation, blackboard, true);
    }

    /// An activity has returned from its call: what it wrote is published, what it raised is noted, and its state may be complete.
    ///
    /// If its state was left meanwhile, nothing of what it did matters any more.
    ///
    /// # Errors
    /// It failed, and somebody should do something about it.
    pub(crate) fn returned(
        &mut self,
        assignment: Assignment,
        returned: Returned,
        took: Option<Took>,
        restart: bool,
        now: Moment,
    ) -> Result<(), Failure> {
        let (activation, blackboard) = self.posts.take_back(assignment, took);
        let current = is_current(&self.machine, &self.posts, activation);
        let here = self.desk.lending.take_back(activation, blackboard, current);
        match here.filter(|_| current).map(|blackboard| blackboard.take_events()) {
            Some(events) => {
                let origin = Origin { runner: self.number, activation };
                origin::publish_as(origin, || self.desk.lending.publish_all(activation.region, now));
                for event in events {
                    self.machine.dispatch_name(&event);
                }
                self.conclude(activation, returned, restart, now)
            }
            None => {
                self.say_late(activation, returned);
                Ok(())
            }
        }
    }

    fn conclude(
        &mut self,
        activation: Activation,
        returned: Returned,
        restart: bool,
        now: Moment,
    ) -> Result<(), Failure> {
        let outcome = match &returned {
            Ok(Progress::Done) => Outcome::Done,
            Ok(Progress::Ongoing(_)) => Outcome::Ongoing,
            Err(_) => Outcome::Failed,
        };
        self.machine.activity_returned(activation, outcome);
        match returned {
            Ok(Progress::Done) => self.posts.finished(activation),
            Ok(Progress::Ongoing(delay)) => {
                if let Some(blackboard) = self.desk.lending.here(activation.region) {
                    self.posts.wait(activation, now, delay.max(SHORTEST_DELAY), blackboard);
                }
            }
            Err(failure) => {
                let pause = self.posts.failed(activation, FIRST_PAUSE, DOUBLINGS);
                if restart {
                    self.posts.pause(activation, now + pause);
                }
                return Err(failure);
            }
        }
        Ok(())
    }

    fn say_late(&mut self, activation: Activation, returned: Returned) {
        if let Err(failure) = returned {
            self.posts.failed(activation, FIRST_PAUSE, DOUBLINGS);
            let activity = self.posts.name(activation);
            tracing::error!(robot = %self.desk.host, agent = %self.desk.agent, %activity, "activity failed after its state was left: {failure}");
        }
    }

    /// Notes from now on at which points of the hub's history messages are fetched.
    pub(crate) fn note_fetches(&mut self) {
        self.desk.lending.fetching = Fetching::Noted(Vec::new());
    }

    /// What was noted since the last [`forget_fetches`](Runner::forget_fetches): how many publications the hub had taken at each fetch.
    pub(crate) fn fetches(&self) -> &[u64] {
        self.desk.lending.fetching.noted()
    }

    /// Begins a new turn of notes.
    pub(crate) fn forget_fetches(&mut self) {
        self.desk.lending.fetching.forget();
    }

    /// Is led from now on through what was recorded.
    pub(crate) fn be_led(&mut self, lead: Box<dyn Lead>) {
        self.desk.lending.fetching = Fetching::Led(lead);
    }

    /// What says that an activity of this chart publishes; none if the state has no activity.
    pub(crate) fn origin(&self, node: u32, number: u64) -> Option<Origin> {
        let entry = self.machine.chart().activity(NodeId(node))?;
        let activation = Activation { node: entry.node, region: entry.region, number };
        Some(Origin { runner: self.number, activation })
    }

    /// The activity by which the chart is told of a message, as records name it: none if it is not one of this chart.
    pub(crate) fn call_of(&self, origin: Option<Origin>) -> Option<records::Call> {
        let Origin { activation, .. } = origin.filter(|origin| origin.runner == self.number)?;
        Some(call_record(activation))
    }

    /// The hub on which its agent publishes.
    pub(crate) fn hub(&self) -> &Narukom {
        &self.hub
    }

    /// The chart's place among the charts of the agent.
    pub(crate) fn place(&self) -> u32 {
        self.desk.number
    }

    /// As which part of its agent it publishes.
    pub(crate) fn part(&self) -> u16 {
        self.desk.lending.part()
    }

    /// An activation that was asked to return since the last step began.
    pub(crate) fn next_cancelled(&mut self) -> Option<Activation> {
        self.desk.cancelled.pop()
    }

    /// Asks every activity that is being called to return soon.
    pub(crate) fn cancel_all(&self) {
        self.desk.lending.cancel_all();
    }

    /// Ends everything; activities that wait are told so.
    pub(crate) fn stop(&mut self, now: Moment) {
        self.machine.stop(&mut self.desk);
        self.leave(now);
        self.desk.started.clear();
    }

    pub(crate) fn is_over(&self) -> bool {
        matches!(self.machine.status(), Status::Finished | Status::Stopped)
    }

    pub(crate) fn micro_steps(&self) -> u64 {
        self.micro_steps
    }

    /// The topics whose messages call a waiting activation early.
    pub(crate) fn waits_for(&self, activation: Activation) -> &[TopicSlot] {
        self.posts.waits_for(activation)
    }

    /// The topics whose messages wake the chart.
    pub(crate) fn topics_of_guards(&self) -> Vec<TopicSlot> {
        self.machine.chart().reads().iter().map(|topic| TopicSlot::new(topic.0)).collect()
    }

    /// What steps.
    pub(crate) fn machine(&self) -> &Machine {
        &self.machine
    }

    /// The agent it is a chart of.
    pub(crate) fn agent(&self) -> &str {
        &self.desk.agent
    }

    pub(crate) fn host(&self) -> &str {
        &self.desk.host
    }

    pub(crate) fn activity_name(&self, activation: Activation) -> String {
        self.posts.name(activation).to_owned()
    }

    /// The activation of an activity that is being called: the chart may be another one than when the call began.
    pub(crate) fn known_as(&self, assignment: &Assignment) -> Activation {
        self.posts.known_as(assignment)
    }

    /// The paths of the BASIC states that are active.
    pub(crate) fn active(&self) -> Vec<String> {
        let chart = self.machine.chart();
        let is_basic = |node: &NodeId| chart.statechart().node(*node).kind == yase::NodeKind::Basic;
        let active = self.machine.configuration();
        active.into_iter().filter(is_basic).map(|node| chart.short_path(node)).collect()
    }

    pub(crate) fn name(&self) -> &str {
        &self.machine.chart().statechart().name
    }

    /// What each blackboard received at the beginning of the last step.
    pub(crate) fn delivered(&self) -> &[records::Delivery] {
        &self.desk.delivered
    }

    pub(crate) fn activity_statistics(&self) -> impl Iterator<Item = ActivityStatistics> {
        self.posts.statistics(self.machine.chart())
    }

    pub(crate) fn coverage(&self) -> ChartCoverage {
        self.desk.coverage.table(self.machine.chart(), &self.desk.host, &self.desk.agent)
    }

    /// How many threads can be of use to its activities.
    pub(crate) fn max_activities(&self) -> usize {
        self.machine.chart().max_activities()
    }
}

/// An activity as records name it.
pub(crate) fn call_record(activation: Activation) -> records::Call {
    records::Call { node: activation.node.0, number: activation.number }
}

/// Whether an activation is still that of its state, so that its return matters.
fn is_current(machine: &Machine, posts: &Posts, activation: Activation) -> bool {
    machine.status() == Status::Running && machine.is_active(activation.node) && posts.is_newest(activation)
}

fn yase_moment(moment: Moment) -> yase::Moment {
    yase::Moment::from_nanos(moment.as_nanos())
}
