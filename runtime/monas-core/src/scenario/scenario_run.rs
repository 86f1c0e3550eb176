//! One execution of a scenario.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use aseme::path::shortest_path;
use aseme_verify::scenario::{
    Expectation, ExpectationKind, ExpectedTimer, ScenarioPart, ScenarioStep, StepStimulus, TimerReference,
};
use narukom::{AnyMessage, AnyPublisher, Blackboard, HostId, Hub, RetentionKind, Timestamp, TopicSlot};
use yase::expression::Effect;
use yase::{CompiledChart, NodeId, NodeKind, Outcome, ScopeId, TopicId};

use super::latest_messages::LatestMessages;
use super::{ScenarioDifference, StepResult};
use crate::activity::{Activity, BoxError, Progress};
use crate::agent::ChartSettings;
use crate::binder::BoundChart;
use crate::call::CallFailure;
use crate::chart_runner::{
    ActivityCall, ChartContext, ChartDriver, ChartError, ChartRunner, Dispatch, set_message_field,
};
use crate::error::Error;
use crate::function::FunctionDeclaration;
use crate::listener::{ListenerSet, MicroStep};
use crate::monitors::PropertyViolation;
use crate::records::{CHART, Delivery, MODEL};

/// Delay of an activity that returned `Ongoing`: the scenario decides when it is called again.
const ONGOING_DELAY: Duration = Duration::from_secs(1 << 30);

/// An activity whose results come from the scenario.
struct StubActivity;

impl Activity for StubActivity {
    fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
        Ok(Progress::Done)
    }
}

/// A chart that executes a scenario.
pub(crate) struct ScenarioRun<'a> {
    functions: &'a Arc<[FunctionDeclaration]>,
    hub: Hub,
    runner: ChartRunner,
    driver: ScenarioDriver,
    now: Timestamp,
    /// Publishers of the messages of the scenario.
    publishers: BTreeMap<TopicId, AnyPublisher>,
    /// Reactions of the chart in this step, if they are reported.
    lines: Arc<Mutex<Vec<String>>>,
}

/// Leaves activities running until the scenario specifies their return.
struct ScenarioDriver {
    hub: Hub,
    /// The topics of messages that have not been delivered to the chart.
    publications: Arc<Mutex<Vec<TopicSlot>>>,
    /// The states whose activities were started in the step.
    started: Vec<NodeId>,
    /// The topics on which the chart has published in the step.
    published: Vec<TopicId>,
}

impl ChartDriver for ScenarioDriver {
    fn call(&mut self, call: ActivityCall, now: Timestamp) -> Dispatch {
        if call.is_resumed {
            // A message triggered the call; the activity remains ongoing.
            return Dispatch::Finished(call.returning(Ok(Progress::Ongoing(ONGOING_DELAY))), now);
        }
        self.started.push(call.activation.node);
        Dispatch::Held(call)
    }

    fn record_step(&mut self, _: Timestamp, _: &[Delivery], _: &[PropertyViolation]) {}

    fn step_ended(&mut self, runner: &mut ChartRunner, now: Timestamp) {
        let published = self.deliver_publications(runner, now);
        self.published.extend(published);
    }

    fn cycle(&self) -> u64 {
        0
    }
}

impl ScenarioDriver {
    /// Delivers the messages published since the last delivery. Returns their topics.
    fn deliver_publications(&mut self, runner: &mut ChartRunner, now: Timestamp) -> Vec<TopicId> {
        let mut topics = std::mem::take(&mut *locked(&self.publications));
        topics.retain(|topic| {
            let path = self.hub.declaration(*topic).map(|declaration| declaration.path());
            path.is_some_and(|path| path != CHART.path() && path != MODEL.path())
        });
        for topic in &topics {
            runner.message_arrived(*topic, HostId::LOCAL, None, now);
        }
        topics.into_iter().map(|topic| TopicId(topic.number())).collect()
    }
}

/// The error ends the execution of a scenario.
type StepOutcome = Result<(), ScenarioDifference>;

impl<'a> ScenarioRun<'a> {
    pub(crate) fn new(
        chart: &Arc<CompiledChart>,
        functions: &'a Arc<[FunctionDeclaration]>,
        reports: bool,
    ) -> Result<ScenarioRun<'a>, Error> {
        let hub = Hub::with_linked_topics("scenario").map_err(Error::hub)?;
        let lines = Arc::new(Mutex::new(Vec::new()));
        let listeners = if reports { recording_listener(&lines) } else { ListenerSet::default() };
        let home = ChartContext {
            hub: &hub,
            agent: "chart",
            number: 0,
            seed: 0,
            listeners: &listeners,
            now: Timestamp::ZERO,
        };
        let activities = chart.activities().map(|_| Box::new(StubActivity) as Box<dyn Activity>).collect();
        let bound = BoundChart { chart: chart.clone(), functions: functions.clone(), activities };
        let runner = ChartRunner::new(bound, ChartSettings::new(), home)?;
        let publications: Arc<Mutex<Vec<TopicSlot>>> = Arc::default();
        let noted = publications.clone();
        hub.set_waker(Arc::new(move |topic: TopicSlot, _: HostId| locked(&noted).push(topic)));
        let (started, published) = (Vec::new(), Vec::new());
        let driver = ScenarioDriver { hub: hub.clone(), publications, started, published };
        let (now, publishers) = (Timestamp::ZERO, BTreeMap::new());
        Ok(ScenarioRun { functions, hub, runner, driver, now, publishers, lines })
    }

    /// Executes all steps that are possible.
    pub(crate) fn all(
        mut self,
        steps: &[ScenarioStep],
        mut observe: impl FnMut(StepResult<'_>),
    ) -> Result<Vec<ScenarioDifference>, Error> {
        let mut all = Vec::new();
        for step in steps {
            let stepped = self.step(step);
            let is_over = stepped.is_err();
            let differences: Vec<ScenarioDifference> = match stepped {
                Ok(()) => step.expected.iter().filter_map(|expected| self.check(expected)).collect(),
                Err(difference) => vec![difference],
            };
            let records = std::mem::take(&mut *locked(&self.lines));
            observe(StepResult {
                step,
                records: &records,
                active: self.active_names(),
                differences: &differences,
            });
            all.extend(differences);
            if is_over {
                break;
            }
        }
        Ok(all)
    }

    /// Executes steps until the first deviation.
    pub(crate) fn first(mut self, steps: &[ScenarioStep]) -> Result<Option<ScenarioDifference>, Error> {
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

    fn step(&mut self, step: &ScenarioStep) -> StepOutcome {
        self.driver.started.clear();
        self.driver.published.clear();
        self.publish_inputs(&step.data)?;
        match &step.cause {
            StepStimulus::Start => self.runner.start(self.now),
            StepStimulus::Messages => {}
            StepStimulus::Event(event) => self.runner.raise_id(*event),
            StepStimulus::Return(node, outcome) => self.returns(*node, *outcome, step)?,
            StepStimulus::Wait(length) => self.advance_time(*length, step)?,
            StepStimulus::Timer(timer) => self.wait_for(timer, step)?,
        }
        self.run_until_stable(step)
    }

    /// Publishes messages and notifies the chart of them.
    fn publish_inputs(&mut self, data: &[(Effect, ScenarioPart)]) -> StepOutcome {
        let mut drafts: Vec<(TopicId, Box<dyn AnyMessage>)> = Vec::new();
        for (effect, passage) in data {
            self.draft(effect, &mut drafts).map_err(|reason| ScenarioDifference {
                passage: passage.clone(),
                expected: String::from("a message to arrive"),
                seen: reason,
            })?;
        }
        for (topic, message) in drafts {
            if let Some(publisher) = self.publishers.get_mut(&topic) {
                // The draft has the topic's own message type.
                _ = publisher.publish(message, self.now);
            }
        }
        self.driver.deliver_publications(&mut self.runner, self.now);
        Ok(())
    }

    /// Changes the next message of a topic, which starts as a copy of the newest one.
    fn draft(
        &mut self,
        effect: &Effect,
        drafts: &mut Vec<(TopicId, Box<dyn AnyMessage>)>,
    ) -> Result<(), String> {
        let (topic, change) = match effect {
            Effect::Assign { topic, field, value } => (*topic, Some((field, value))),
            Effect::Publish { topic } => (*topic, None),
            _ => return Err(String::from("this is not a message")),
        };
        let index = match drafts.iter().position(|(of, _)| *of == topic) {
            Some(position) => position,
            None => {
                drafts.push((topic, self.initial_message(topic)?));
                drafts.len() - 1
            }
        };
        let Some((field, value)) = change else { return Ok(()) };
        let newest = LatestMessages::of(&self.hub, value.reads(), self.functions);
        let value =
            value.evaluate(&newest).map_err(|error| format!("the value cannot be computed: {error}"))?;
        if matches!(value, yase::Value::Missing) {
            return Err(String::from("the value depends on a message that has not arrived"));
        }
        set_message_field(&mut *drafts[index].1, field, value).map_err(|error| error.to_string())
    }

    /// A copy of the newest message of a topic; for a signal, which is already consumed, an empty
    /// one.
    fn initial_message(&mut self, topic: TopicId) -> Result<Box<dyn AnyMessage>, String> {
        let slot = TopicSlot::new(topic.0);
        let declaration = self.hub.declaration(slot).ok_or("there is no such topic")?;
        if !self.publishers.contains_key(&topic) {
            let publisher = self.hub.publisher_by_name(declaration.path(), "scenario");
            self.publishers.insert(topic, publisher.map_err(|error| error.to_string())?);
        }
        let newest = self.hub.latest(slot).filter(|_| declaration.kind() != RetentionKind::Signal);
        Ok(match newest {
            Some(sample) => sample.message.clone_box(),
            None => declaration.default_message().clone_box(),
        })
    }

    fn returns(&mut self, node: NodeId, outcome: Outcome, step: &ScenarioStep) -> StepOutcome {
        let held = self.runner.take_held(|activation| activation.node == node);
        let Some(call) = held.or_else(|| self.runner.call_now(node, self.now)) else {
            let seen = format!("it does not; active are: {}", self.active());
            return Err(differs(step, String::from("the activity to run"), seen));
        };
        let result = match outcome {
            Outcome::Done => Ok(Progress::Done),
            Outcome::Ongoing => Ok(Progress::Ongoing(ONGOING_DELAY)),
            Outcome::Failed => Err(CallFailure::Error("as the scenario requires".into())),
        };
        // The scenario specifies this failure, and the chart has processed it.
        _ = self.runner.handle_return(call.returning(result), false, self.now);
        Ok(())
    }

    /// Advances the time, stopping at each due event.
    fn advance_time(&mut self, length: Duration, step: &ScenarioStep) -> StepOutcome {
        let end = self.now + length;
        self.run_until_stable(step)?;
        while !self.runner.is_over() {
            let due = self.runner.due(self.now);
            // The last moment is that of an event that is never due.
            if due > end || due == Timestamp::MAX {
                break;
            }
            self.now = self.now.max(due);
            self.run_until_stable(step)?;
        }
        self.now = end;
        Ok(())
    }

    fn wait_for(&mut self, timer: &TimerReference, step: &ScenarioStep) -> StepOutcome {
        match self.deadline(timer).filter(|deadline| *deadline > self.now) {
            Some(deadline) => self.advance_time(deadline.since(self.now), step),
            None => Err(differs(step, String::from("the timer to run"), self.timer_now(timer))),
        }
    }

    /// Runs until the chart is stable at this time.
    fn run_until_stable(&mut self, step: &ScenarioStep) -> StepOutcome {
        self.runner.run_until_stable(&mut self.driver, self.now).map_err(|error| {
            let seen = match error {
                ChartError::Step { error, .. } => error.to_string(),
                ChartError::Stop(reason) => reason,
            };
            differs(step, String::from("the chart to become stable"), seen)
        })
    }

    /// Checks an expectation; returns the deviation.
    fn check(&self, expected: &Expectation) -> Option<ScenarioDifference> {
        let machine = self.runner.machine();
        let active = || format!("active are: {}", self.active());
        let seen = match &expected.kind {
            ExpectationKind::In(nodes) if nodes.iter().all(|&node| machine.is_active(node)) => None,
            ExpectationKind::NotIn(nodes) if !nodes.iter().any(|&node| machine.is_active(node)) => None,
            ExpectationKind::In(_) | ExpectationKind::NotIn(_) => Some(active()),
            ExpectationKind::Starts(nodes) => {
                let is_met = sorted(nodes) == sorted(&self.driver.started);
                (!is_met).then(|| format!("started are: {}", self.names(&self.driver.started)))
            }
            ExpectationKind::Publishes(topics) => {
                let is_met = sorted(topics) == sorted(&self.driver.published);
                (!is_met).then(|| format!("published are: {}", self.topics()))
            }
            ExpectationKind::Holds(guard) => {
                let newest = LatestMessages::of(&self.hub, guard.reads(), self.functions);
                match guard.evaluate(&newest) {
                    Ok(true) => None,
                    Ok(false) => Some(String::from("it does not hold for the newest messages")),
                    Err(error) => Some(format!("that has no value: {error}")),
                }
            }
            ExpectationKind::Timer(timer, left) => {
                let deadline = self.deadline(timer);
                let is_met = match left {
                    ExpectedTimer::Unset => deadline.is_none(),
                    ExpectedTimer::Over => deadline.is_some_and(|deadline| deadline <= self.now),
                    ExpectedTimer::Runs(left) => deadline == Some(self.now + *left) && !left.is_zero(),
                };
                (!is_met).then(|| self.timer_now(timer))
            }
            _ => Some(String::from("this cannot be looked at")),
        };
        let expectation = || format!("`{}`", expected.passage.text());
        seen.map(|seen| ScenarioDifference {
            passage: expected.passage.clone(),
            expected: expectation(),
            seen,
        })
    }

    fn deadline(&self, timer: &TimerReference) -> Option<Timestamp> {
        let machine = self.runner.machine();
        let is_its = |region: &ScopeId| machine.chart().region_node(*region) == Some(timer.region);
        let region = machine.chart().regions().find(is_its)?;
        machine.deadline(region, &timer.name).map(|deadline| Timestamp::from_nanos(deadline.as_nanos()))
    }

    fn timer_now(&self, timer: &TimerReference) -> String {
        match self.deadline(timer) {
            None => String::from("it is not set"),
            Some(deadline) if deadline <= self.now => String::from("it is over"),
            Some(deadline) => format!("{:?} are left", deadline.since(self.now)),
        }
    }

    fn active(&self) -> String {
        self.active_names().join(", ")
    }

    /// The active BASIC states, with the shortest names that a scenario accepts.
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
        let paths: Vec<&str> = self.driver.published.iter().filter_map(path).collect();
        if paths.is_empty() { String::from("nothing") } else { paths.join(", ") }
    }
}

fn differs(step: &ScenarioStep, expected: String, seen: String) -> ScenarioDifference {
    ScenarioDifference { passage: step.passage.clone(), expected, seen }
}

/// A listener that writes a line for each micro-step.
fn recording_listener(lines: &Arc<Mutex<Vec<String>>>) -> ListenerSet {
    let written = lines.clone();
    ListenerSet::new(vec![Box::new(move |step: MicroStep<'_>| {
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
