//! One play of a scenario.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use aseme::path::shortest_path;
use aseme::scenario::{Cause, Expectation, ExpectationKind, Passage, Step, Timer, TimerLeft};
use narukom::{AnyMessage, AnyPublisher, Blackboard, HostId, Kind, Moment, Narukom, TopicSlot};
use yase::expression::Effect;
use yase::{Chart, NodeId, NodeKind, Outcome, RegionId, TopicId};

use super::newest::Newest;
use super::{Difference, Played};
use crate::activity::{Activity, BoxError, Progress};
use crate::agent::ChartSettings;
use crate::binder::BoundChart;
use crate::call::Failure;
use crate::chart::{Assignment, Home, Runner, values};
use crate::error::Error;
use crate::function::FunctionDeclaration;
use crate::listener::{Listeners, MicroStep};
use crate::records::{CHART, MODEL};

/// An activity that wants to be called again is, when the scenario says so.
const LATER: Duration = Duration::from_secs(1 << 30);

/// An activity of which only the scenario knows what it does.
struct Actor;

impl Activity for Actor {
    fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
        Ok(Progress::Done)
    }
}

/// A chart on its way through a scenario.
pub(super) struct Play<'a> {
    functions: &'a Arc<[FunctionDeclaration]>,
    hub: Narukom,
    runner: Runner,
    now: Moment,
    /// The topics on which something was published and of which the chart has not been told.
    news: Arc<Mutex<Vec<TopicSlot>>>,
    /// By which messages come.
    publishers: BTreeMap<TopicId, AnyPublisher>,
    /// The activities that run.
    running: Vec<Assignment>,
    /// What the chart did in the step, if it is to be told.
    lines: Arc<Mutex<Vec<String>>>,
    /// The states whose activities were started in the step.
    started: Vec<NodeId>,
    /// The topics on which the chart has published in the step.
    published: Vec<TopicId>,
}

/// What ends a play.
type Stepped = Result<(), Difference>;

impl<'a> Play<'a> {
    pub(super) fn new(
        chart: &Arc<Chart>,
        functions: &'a Arc<[FunctionDeclaration]>,
        tells: bool,
    ) -> Result<Play<'a>, Error> {
        let hub = Narukom::with_linked_topics("scenario").map_err(Error::hub)?;
        let lines = Arc::new(Mutex::new(Vec::new()));
        let listeners = if tells { listening(&lines) } else { Listeners::default() };
        let home =
            Home { hub: &hub, agent: "chart", number: 0, seed: 0, listeners: &listeners, now: Moment::ZERO };
        let activities = chart.activities().map(|_| Box::new(Actor) as Box<dyn Activity>).collect();
        let bound = BoundChart { chart: chart.clone(), functions: functions.clone(), activities };
        let runner = Runner::new(bound, ChartSettings::new(), home)?;
        let news: Arc<Mutex<Vec<TopicSlot>>> = Arc::default();
        let noted = news.clone();
        hub.set_waker(Arc::new(move |topic: TopicSlot, _: HostId| locked(&noted).push(topic)));
        Ok(Play {
            functions,
            hub,
            runner,
            now: Moment::ZERO,
            news,
            publishers: BTreeMap::new(),
            running: Vec::new(),
            lines,
            started: Vec::new(),
            published: Vec::new(),
        })
    }

    /// Plays all steps, as far as they can be.
    pub(super) fn all(
        mut self,
        steps: &[Step],
        mut told: impl FnMut(Played<'_>),
    ) -> Result<Vec<Difference>, Error> {
        let mut all = Vec::new();
        for step in steps {
            let stepped = self.step(step);
            let is_over = stepped.is_err();
            let differences: Vec<Difference> = match stepped {
                Ok(()) => step.expected.iter().filter_map(|expected| self.check(expected)).collect(),
                Err(difference) => vec![difference],
            };
            let records = std::mem::take(&mut *locked(&self.lines));
            told(Played { step, records: &records, active: self.active_names(), differences: &differences });
            all.extend(differences);
            if is_over {
                break;
            }
        }
        Ok(all)
    }

    /// Plays till something differs.
    pub(super) fn first(mut self, steps: &[Step]) -> Result<Option<Difference>, Error> {
        for step in steps {
            if let Err(difference) = self.step(step) {
                return Ok(Some(difference));
            }
            if let Some(difference) = step.expected.iter().find_map(|expected| self.check(expected)) {
                return Ok(Some(difference));
            }
        }
        Ok(None)
    }

    fn step(&mut self, step: &Step) -> Stepped {
        self.started.clear();
        self.published.clear();
        self.bring(&step.data)?;
        match &step.cause {
            Cause::Start => self.runner.start(self.now),
            Cause::Messages => {}
            Cause::Event(name) => _ = self.runner.raise(name),
            Cause::Return(node, outcome) => self.returns(*node, *outcome, step)?,
            Cause::Wait(length) => self.wait(*length, step)?,
            Cause::Timer(timer) => self.wait_for(timer, step)?,
        }
        self.settle(step)
    }

    /// Publishes messages, and tells the chart of them.
    fn bring(&mut self, data: &[(Effect, Passage)]) -> Stepped {
        let mut drafts: Vec<(TopicId, Box<dyn AnyMessage>)> = Vec::new();
        for (effect, passage) in data {
            self.draft(effect, &mut drafts).map_err(|reason| Difference {
                passage: passage.clone(),
                expected: String::from("a message to come"),
                seen: reason,
            })?;
        }
        for (topic, message) in drafts {
            if let Some(publisher) = self.publishers.get_mut(&topic) {
                // the draft was made of the topic's own type
                _ = publisher.publish(message, self.now);
            }
        }
        self.tell_news(false);
        Ok(())
    }

    /// Changes the message that is to come on a topic, which begins as the newest one.
    fn draft(
        &mut self,
        effect: &Effect,
        drafts: &mut Vec<(TopicId, Box<dyn AnyMessage>)>,
    ) -> Result<(), String> {
        let (topic, change) = match effect {
            Effect::Assign { topic, field, value } => (*topic, Some((field, value))),
            Effect::Publish { topic } => (*topic, None),
            _ => return Err(String::from("this is no message")),
        };
        let place = match drafts.iter().position(|(of, _)| *of == topic) {
            Some(place) => place,
            None => {
                drafts.push((topic, self.begun(topic)?));
                drafts.len() - 1
            }
        };
        let Some((field, value)) = change else { return Ok(()) };
        let newest = Newest::of(&self.hub, value.reads(), self.functions);
        let value = value.evaluate(&newest).map_err(|error| format!("the value has none: {error}"))?;
        if matches!(value, yase::Value::Missing) {
            return Err(String::from("the value depends on a message that has not come"));
        }
        values::set_field(&mut *drafts[place].1, field, value).map_err(|error| error.to_string())
    }

    /// A copy of the newest message of a topic; of a signal, which is gone by now, one with nothing set.
    fn begun(&mut self, topic: TopicId) -> Result<Box<dyn AnyMessage>, String> {
        let slot = TopicSlot::new(topic.0);
        let declaration = self.hub.declaration(slot).ok_or("there is no such topic")?;
        if !self.publishers.contains_key(&topic) {
            let publisher = self.hub.publisher_by_name(declaration.path(), "scenario");
            self.publishers.insert(topic, publisher.map_err(|error| error.to_string())?);
        }
        let newest = self.hub.latest(slot).filter(|_| declaration.kind() != Kind::Signal);
        Ok(match newest {
            Some(sample) => sample.message.clone_box(),
            None => declaration.default_message().clone_box(),
        })
    }

    /// Tells the chart what was published, and notes it if the chart did that itself.
    fn tell_news(&mut self, is_own: bool) {
        let news = std::mem::take(&mut *locked(&self.news));
        for topic in news {
            let path = self.hub.declaration(topic).map(|declaration| declaration.path());
            if path.is_none_or(|path| path == CHART.path() || path == MODEL.path()) {
                continue;
            }
            if is_own {
                self.published.push(TopicId(topic.number()));
            }
            self.runner.message_arrived(topic, HostId::LOCAL, None, self.now);
        }
    }

    fn returns(&mut self, node: NodeId, outcome: Outcome, step: &Step) -> Stepped {
        let running = self.running.iter().position(|assignment| assignment.activation.node == node);
        let assignment = match running {
            Some(place) => Some(self.running.remove(place)),
            None => self.runner.call_now(node, self.now),
        };
        let Some(assignment) = assignment else {
            let seen = format!("it does not, and active are: {}", self.active());
            return Err(differs(step, String::from("the activity to run"), seen));
        };
        let returned = match outcome {
            Outcome::Done => Ok(Progress::Done),
            Outcome::Ongoing => Ok(Progress::Ongoing(LATER)),
            Outcome::Failed => Err(Failure::Error("the scenario says so".into())),
        };
        // that it fails is what the scenario says, and the chart has been told
        _ = self.runner.returned(assignment, returned, None, false, self.now);
        Ok(())
    }

    /// Lets time go by, stopping where something is due.
    fn wait(&mut self, length: Duration, step: &Step) -> Stepped {
        let end = self.now + length;
        self.settle(step)?;
        while !self.runner.is_over() {
            let due = self.runner.due(self.now);
            if due > end {
                break;
            }
            self.now = self.now.max(due);
            self.settle(step)?;
        }
        self.now = end;
        Ok(())
    }

    fn wait_for(&mut self, timer: &Timer, step: &Step) -> Stepped {
        match self.deadline(timer).filter(|deadline| *deadline > self.now) {
            Some(deadline) => self.wait(deadline.since(self.now), step),
            None => Err(differs(step, String::from("the timer to run"), self.timer_now(timer))),
        }
    }

    /// Has the chart do all it does at this moment.
    fn settle(&mut self, step: &Step) -> Stepped {
        while !self.runner.is_over() {
            if let Some(assignment) = self.runner.next_started() {
                self.started.push(assignment.activation.node);
                self.running.push(assignment);
            } else if self.runner.needs_step(self.now) {
                let stepped = self.runner.step(self.now);
                self.tell_news(true);
                stepped.map_err(|error| {
                    differs(step, String::from("the chart to come to rest"), error.to_string())
                })?;
            } else if let Some(assignment) = self.runner.next_waiting(self.now) {
                // a message woke it, and still it goes on
                _ = self.runner.returned(assignment, Ok(Progress::Ongoing(LATER)), None, false, self.now);
            } else {
                break;
            }
        }
        Ok(())
    }

    /// What is not as it is expected to be.
    fn check(&self, expected: &Expectation) -> Option<Difference> {
        let machine = self.runner.machine();
        let active = || format!("active are: {}", self.active());
        let seen = match &expected.kind {
            ExpectationKind::In(nodes) if nodes.iter().all(|&node| machine.is_active(node)) => None,
            ExpectationKind::NotIn(nodes) if !nodes.iter().any(|&node| machine.is_active(node)) => None,
            ExpectationKind::In(_) | ExpectationKind::NotIn(_) => Some(active()),
            ExpectationKind::Starts(nodes) => {
                let is_met = sorted(nodes) == sorted(&self.started);
                (!is_met).then(|| format!("started are: {}", self.names(&self.started)))
            }
            ExpectationKind::Publishes(topics) => {
                let is_met = sorted(topics) == sorted(&self.published);
                (!is_met).then(|| format!("published are: {}", self.topics()))
            }
            ExpectationKind::Holds(guard) => {
                let newest = Newest::of(&self.hub, guard.reads(), self.functions);
                match guard.evaluate(&newest) {
                    Ok(true) => None,
                    Ok(false) => Some(String::from("the newest messages do not say so")),
                    Err(error) => Some(format!("that has no value: {error}")),
                }
            }
            ExpectationKind::Timer(timer, left) => {
                let deadline = self.deadline(timer);
                let is_met = match left {
                    TimerLeft::Unset => deadline.is_none(),
                    TimerLeft::Over => deadline.is_some_and(|deadline| deadline <= self.now),
                    TimerLeft::Runs(left) => deadline == Some(self.now + *left) && !left.is_zero(),
                };
                (!is_met).then(|| self.timer_now(timer))
            }
            _ => Some(String::from("this cannot be looked at")),
        };
        let expectation = || format!("`{}`", expected.passage.text());
        seen.map(|seen| Difference { passage: expected.passage.clone(), expected: expectation(), seen })
    }

    fn deadline(&self, timer: &Timer) -> Option<Moment> {
        let machine = self.runner.machine();
        let is_its = |region: &RegionId| machine.chart().region_node(*region) == Some(timer.region);
        let region = machine.chart().regions().find(is_its)?;
        machine.deadline(region, &timer.name).map(|deadline| Moment::from_nanos(deadline.as_nanos()))
    }

    fn timer_now(&self, timer: &Timer) -> String {
        match self.deadline(timer) {
            None => String::from("it is not set"),
            Some(deadline) if deadline <= self.now => String::from("it is over"),
            Some(deadline) => format!("{:?} are left", deadline.since(self.now)),
        }
    }

    fn active(&self) -> String {
        self.active_names().join(", ")
    }

    /// The BASIC states that are active, as briefly as a scenario may name them.
    fn active_names(&self) -> Vec<String> {
        let machine = self.runner.machine();
        let is_basic = |node: &NodeId| machine.chart().statechart().node(*node).kind == NodeKind::Basic;
        machine.configuration().into_iter().filter(is_basic).map(|node| self.name(node)).collect()
    }

    fn name(&self, node: NodeId) -> String {
        shortest_path(self.runner.machine().chart().statechart(), node)
    }

    fn names(&self, nodes: &[NodeId]) -> String {
        let names: Vec<String> = nodes.iter().map(|&node| self.name(node)).collect();
        if names.is_empty() { String::from("nothing") } else { names.join(", ") }
    }

    fn topics(&self) -> String {
        let path = |topic: &TopicId| Some(self.hub.declaration(TopicSlot::new(topic.0))?.path());
        let paths: Vec<&str> = self.published.iter().filter_map(path).collect();
        if paths.is_empty() { String::from("nothing") } else { paths.join(", ") }
    }
}

fn differs(step: &Step, expected: String, seen: String) -> Difference {
    Difference { passage: step.passage.clone(), expected, seen }
}

/// What writes down each micro-step.
fn listening(lines: &Arc<Mutex<Vec<String>>>) -> Listeners {
    let written = lines.clone();
    Listeners::new(vec![Box::new(move |step: MicroStep<'_>| {
        locked(&written).push(step.record.display(step.chart).to_string());
    })])
}

fn locked<T>(shared: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

fn sorted<T: Ord + Copy>(values: &[T]) -> Vec<T> {
    let mut values = values.to_vec();
    values.sort_unstable();
    values
}
