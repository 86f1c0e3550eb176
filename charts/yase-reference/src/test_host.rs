//! A host with blackboards and activities that logs its calls.

use std::any::Any;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use yase::expression::set;
use yase::expression::{CallError, MessageSource};
use yase::vocabulary::{FieldEntry, FunctionEntry, MessageEntry, TopicEntry, TopicKind, ValueType};
use yase::{
    Activation, CompiledChart, FieldId, FunctionId, Host, Notice, Outcome, ScopeId, Timestamp, TopicId,
    TraceRecord, TypeEnvironment, Value,
};

/// The topics, by number.
pub const TOPICS: [&str; 3] = ["A", "B", "C"];

/// Three topics `a`, `b`, `c` of messages `A`, `B`, `C`, each with a number `n`; functions
/// `double(x)` and `fail()`.
pub fn vocabulary() -> TypeEnvironment {
    let number = |name: &str| FieldEntry { id: FieldId(0), name: name.into(), kind: ValueType::Number };
    let function = |id, name: &str, parameters| FunctionEntry {
        id: FunctionId(id),
        name: name.into(),
        parameters,
        result: ValueType::Number,
    };
    TypeEnvironment {
        scripts: false,
        topics: TOPICS
            .iter()
            .zip(0..)
            .map(|(name, id)| TopicEntry {
                id: TopicId(id),
                path: name.to_lowercase(),
                kind: TopicKind::State,
                message: (*name).into(),
            })
            .collect(),
        messages: TOPICS
            .iter()
            .map(|name| MessageEntry { name: (*name).into(), fields: vec![number("n")] })
            .collect(),
        enumerations: vec![],
        functions: vec![function(0, "double", vec![ValueType::Number]), function(1, "fail", vec![])],
    }
}

/// A message of any of the three types.
#[derive(Clone, Copy, Default, Debug)]
pub struct Number {
    /// Its number.
    pub n: i64,
}

/// A blackboard: visible messages, arrived messages and messages to publish.
#[derive(Clone, Default, Debug)]
pub struct Board {
    /// The latest messages, as visible to guards.
    pub shown: BTreeMap<TopicId, Number>,
    /// Messages to be delivered.
    pub inbox: BTreeMap<TopicId, Number>,
    /// Topics to be published.
    pub outbox: BTreeSet<TopicId>,
}

/// An activity that runs or waits to be called again.
#[derive(Clone, Debug)]
pub struct Job {
    /// Its activation.
    pub activation: Activation,
    /// The activity.
    pub name: String,
    /// The duration of a call.
    pub duration: Duration,
    /// When it returns or, if it waits, is called again.
    pub due: Timestamp,
    /// Whether it waits to be called again.
    pub waits: bool,
    /// The number of calls.
    pub calls: u32,
}

/// The host of the tests.
#[derive(Clone, Default, Debug)]
pub struct TestHost {
    /// The time of the step.
    pub now: Timestamp,
    /// The blackboard of each scope.
    pub boards: BTreeMap<ScopeId, Board>,
    /// The activities that run or wait.
    pub jobs: Vec<Job>,
    /// Published topics whose arrival has not been reported.
    pub arrivals: Vec<TopicId>,
    /// The log, one line per entry.
    pub log: Vec<String>,
    /// Whether operations on blackboards are logged too.
    pub verbose: bool,
    /// Disables the logging of micro-steps.
    pub silent: bool,
    /// Whether the lines of micro-steps contain the reads of guards.
    pub reads: bool,
    /// Names and durations of activities.
    pub activities: BTreeMap<yase::NodeId, (String, Duration)>,
}

impl TestHost {
    /// The host of a chart, before anything has happened.
    pub fn new(chart: &yase::Statechart) -> TestHost {
        let activities = chart
            .nodes()
            .filter_map(|(id, node)| Some((id, (node.activity.clone()?, node.duration.unwrap_or_default()))))
            .collect();
        TestHost { activities, ..TestHost::default() }
    }

    /// Logs a line.
    pub fn say(&mut self, text: impl Into<String>) {
        self.log.push(text.into());
    }

    fn log_if_verbose(&mut self, text: String) {
        if self.verbose {
            self.log.push(text);
        }
    }

    /// The blackboard of a scope, created on first use.
    pub fn board(&mut self, region: ScopeId) -> &mut Board {
        self.boards.entry(region).or_default()
    }

    /// Queues a message for delivery on every blackboard.
    pub fn send(&mut self, topic: TopicId, value: i64, regions: impl Iterator<Item = ScopeId>) {
        for region in regions {
            self.board(region).inbox.insert(topic, Number { n: value });
        }
        self.arrivals.push(topic);
    }

    /// The number in a topic's message on a blackboard, if one has arrived.
    pub fn number(&self, region: ScopeId, topic: TopicId) -> Option<i64> {
        Some(self.shown(region, topic)?.n)
    }

    fn shown(&self, region: ScopeId, topic: TopicId) -> Option<&Number> {
        self.boards.get(&region)?.shown.get(&topic)
    }

    /// The outcome of a call of an activity: `ongoing…` ends after its third call, `failing…`
    /// always fails.
    pub fn outcome(job: &Job) -> Outcome {
        match job.name.as_str() {
            name if name.starts_with("ongoing") && job.calls < 3 => Outcome::Ongoing,
            name if name.starts_with("failing") => Outcome::Failed,
            _ => Outcome::Done,
        }
    }
}

impl Host for TestHost {
    fn field(&self, region: ScopeId, source: &MessageSource, path: &[FieldId]) -> Value<'_> {
        assert_eq!(path, [FieldId(0)]);
        self.number(region, source.topic).map_or(Value::Missing, Value::Int)
    }

    fn message(&self, region: ScopeId, source: &MessageSource) -> Value<'_> {
        self.shown(region, source.topic).map_or(Value::Missing, |number| Value::Message(number))
    }

    fn call(&self, function: FunctionId, arguments: &[Value<'_>]) -> Result<Value<'_>, CallError> {
        match (function, arguments) {
            (FunctionId(0), [Value::Int(value)]) => Ok(Value::Int(value * 2)),
            (FunctionId(0), [Value::Uint(value)]) => Ok(Value::Uint(value * 2)),
            _ => Err(CallError::new("it always fails")),
        }
    }

    fn deliver(&mut self, region: ScopeId) {
        let board = self.board(region);
        let inbox = std::mem::take(&mut board.inbox);
        board.shown.extend(inbox);
        self.log_if_verbose(format!("  deliver {}", region.0));
    }

    fn inherit(&mut self, region: ScopeId, from: ScopeId) {
        let around = self.board(from).clone();
        *self.board(region) = Board { outbox: BTreeSet::new(), ..around };
        self.log_if_verbose(format!("  inherit {} from {}", region.0, from.0));
    }

    fn assign(
        &mut self,
        region: ScopeId,
        topic: TopicId,
        path: &[FieldId],
        value: Value<'_>,
    ) -> Result<(), CallError> {
        assert_eq!(path, [FieldId(0)]);
        self.edit(region, topic, &mut |message| {
            let number = message.downcast_mut::<Number>().expect("all messages are numbers");
            set(&mut number.n, value, "n")
        })
    }

    fn edit(
        &mut self,
        region: ScopeId,
        topic: TopicId,
        change: &mut dyn FnMut(&mut dyn Any) -> Result<(), CallError>,
    ) -> Result<(), CallError> {
        let mut number = self.shown(region, topic).copied().unwrap_or_default();
        change(&mut number)?;
        if number.n > 1_000_000 {
            return Err(CallError::new("too large"));
        }
        let board = self.board(region);
        board.shown.insert(topic, number);
        board.outbox.insert(topic);
        self.log_if_verbose(format!("  {} on {} = {}", TOPICS[topic.0 as usize], region.0, number.n));
        Ok(())
    }

    fn publish(&mut self, region: ScopeId, topic: TopicId) {
        let board = self.board(region);
        board.shown.entry(topic).or_default();
        board.outbox.insert(topic);
    }

    fn publish_all(&mut self, region: ScopeId) {
        let board = self.board(region);
        let topics = std::mem::take(&mut board.outbox);
        let values: Vec<(TopicId, Number)> =
            topics.iter().filter_map(|topic| Some((*topic, *board.shown.get(topic)?))).collect();
        for (topic, value) in values {
            for (_, other) in self.boards.iter_mut().filter(|(other, _)| **other != region) {
                other.inbox.insert(topic, value);
            }
            self.arrivals.push(topic);
        }
        self.log_if_verbose(format!("  publish {}", region.0));
    }

    fn start(&mut self, activation: Activation) {
        let (name, duration) = self.activities[&activation.node].clone();
        self.say(format!("  start {name}"));
        let due = self.now + duration;
        self.jobs.push(Job { activation, name, duration, due, waits: false, calls: 1 });
    }

    fn cancel(&mut self, activation: Activation) {
        let soon = self.now + Duration::from_millis(1);
        let job = self.jobs.iter_mut().find(|job| job.activation == activation).expect("it runs");
        assert!(!job.waits);
        job.due = job.due.min(soon);
        let text = format!("  cancel {}", job.name);
        self.say(text);
    }

    fn stop(&mut self, activation: Activation) {
        let index = self.jobs.iter().position(|job| job.activation == activation).expect("it waits");
        let job = self.jobs.remove(index);
        assert!(job.waits);
        self.say(format!("  stop {}", job.name));
    }

    fn wants_trace(&self) -> bool {
        !self.silent
    }

    fn trace(&mut self, chart: &CompiledChart, record: &TraceRecord<'_>) {
        let record = if self.reads { *record } else { TraceRecord { guards: &[], ..*record } };
        self.say(record.display_with(chart, |node| chart.short_path(node)).to_string());
    }

    fn report(&mut self, chart: &CompiledChart, report: Notice<'_>) {
        let text = match report {
            Notice::GuardFailed { error, .. } => format!("  guard failed: {error}"),
            Notice::ActionFailed { error, .. } => format!("  action failed: {error}"),
            Notice::StartWaits { start } => format!("  waits at {}", chart.short_path(start)),
            _ => "  ?".to_owned(),
        };
        self.say(text);
    }
}
