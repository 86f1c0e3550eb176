//! Timed inputs of a host, and an interpreter that plays them.

use std::sync::Arc;
use std::time::Duration;

use yase::{
    Activation, CompiledChart, Machine, MicroStep, Outcome, ScopeId, Semantics, Statechart, Timestamp,
    TopicId,
};

use super::test_host::{TOPICS, TestHost, vocabulary};

/// An interpreter of charts: the machine, or the reference.
pub trait Interpreter {
    /// Starts the chart.
    fn start(&mut self, now: Timestamp, host: &mut TestHost);
    /// An event comes.
    fn event(&mut self, name: &str);
    /// A message has arrived on a topic.
    fn message(&mut self, topic: TopicId);
    /// Reports the return of an activity; false if its activation is outdated.
    fn returned(&mut self, activation: Activation, outcome: Outcome) -> bool;
    /// Reports a repeated call of an activity; false if its activation is outdated.
    fn resumed(&mut self, activation: Activation) -> bool;
    /// Executes a step; `Err` with a text if the chart fails.
    fn step(&mut self, now: Timestamp, host: &mut TestHost) -> Result<(), String>;
    /// Whether a step is due.
    fn needs_step(&self, now: Timestamp) -> bool;
    /// When the next timer expires.
    fn next_deadline(&self) -> Option<Timestamp>;
    /// The number of blackboards.
    fn regions(&self) -> usize;
}

impl Interpreter for Machine {
    fn start(&mut self, now: Timestamp, host: &mut TestHost) {
        Machine::start(self, now, host);
    }

    fn event(&mut self, name: &str) {
        self.dispatch_name(name);
    }

    fn message(&mut self, topic: TopicId) {
        self.message_arrived(topic, 1);
    }

    fn returned(&mut self, activation: Activation, outcome: Outcome) -> bool {
        self.activity_returned(activation, outcome)
    }

    fn resumed(&mut self, activation: Activation) -> bool {
        self.activity_resumed(activation)
    }

    fn step(&mut self, now: Timestamp, host: &mut TestHost) -> Result<(), String> {
        self.run_to_completion(now, host).map(|_| ()).map_err(|error| error.to_string())
    }

    fn needs_step(&self, now: Timestamp) -> bool {
        Machine::needs_step(self, now)
    }

    fn next_deadline(&self) -> Option<Timestamp> {
        Machine::next_deadline(self)
    }

    fn regions(&self) -> usize {
        self.chart().regions().len()
    }
}

/// A machine that executes single micro-steps, which must be equivalent to complete steps.
pub struct ByMicroSteps(pub Machine);

impl Interpreter for ByMicroSteps {
    fn start(&mut self, now: Timestamp, host: &mut TestHost) {
        self.0.start(now, host);
    }

    fn event(&mut self, name: &str) {
        self.0.dispatch_name(name);
    }

    fn message(&mut self, topic: TopicId) {
        self.0.message_arrived(topic, 1);
    }

    fn returned(&mut self, activation: Activation, outcome: Outcome) -> bool {
        self.0.activity_returned(activation, outcome)
    }

    fn resumed(&mut self, activation: Activation) -> bool {
        self.0.activity_resumed(activation)
    }

    fn step(&mut self, now: Timestamp, host: &mut TestHost) -> Result<(), String> {
        loop {
            match self.0.micro_step(now, host) {
                Ok(MicroStep::Progressed) => {}
                Ok(MicroStep::Stable(_)) => return Ok(()),
                Err(error) => return Err(error.to_string()),
            }
        }
    }

    fn needs_step(&self, now: Timestamp) -> bool {
        self.0.needs_step(now)
    }

    fn next_deadline(&self) -> Option<Timestamp> {
        self.0.next_deadline()
    }

    fn regions(&self) -> usize {
        self.0.chart().regions().len()
    }
}

/// An input.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// An event comes.
    Event(String),
    /// A message with a number arrives on a topic.
    Message(TopicId, i64),
}

/// Inputs in order of time, in milliseconds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    /// The inputs with their times in milliseconds.
    pub inputs: Vec<(u64, Input)>,
    /// The end of the script in milliseconds.
    pub until: u64,
}

impl Script {
    /// `10 e; 20 f; 30 A=3; 50`: events, messages, and the end.
    pub fn parse(text: &str) -> Script {
        let mut script = Script::default();
        for item in text.split(';').map(str::trim).filter(|item| !item.is_empty()) {
            let (time, what) = item.split_once(' ').unwrap_or((item, ""));
            let time = time.parse().unwrap();
            script.until = time;
            match what.split_once('=') {
                Some((message, value)) => {
                    let topic = TOPICS.iter().position(|name| *name == message).unwrap();
                    script.inputs.push((time, Input::Message(TopicId(topic as u32), value.parse().unwrap())));
                }
                None if what.is_empty() => {}
                None => script.inputs.push((time, Input::Event(what.to_owned()))),
            }
        }
        script
    }
}

/// Compiles a chart against the type environment of the tests.
pub fn compile(chart: &Statechart) -> Arc<CompiledChart> {
    compile_with(chart, Semantics::yase())
}

/// Compiles a chart against the type environment of the tests, for a semantics.
pub fn compile_with(chart: &Statechart, semantics: Semantics) -> Arc<CompiledChart> {
    match chart.compile_with(&vocabulary(), semantics) {
        Ok(chart) => Arc::new(chart),
        Err(found) => panic!("{}", found.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")),
    }
}

/// Plays a script on a machine and returns the log of the host.
pub fn play(chart: &Statechart, script: &str) -> Vec<String> {
    play_with(chart, script, Semantics::yase())
}

/// The same for a semantics.
pub fn play_with(chart: &Statechart, script: &str, semantics: Semantics) -> Vec<String> {
    let (mut host, script) = (TestHost::new(chart), Script::parse(script));
    let chart = compile_with(chart, semantics);
    let mut machine = Machine::new(chart.clone());
    let (silent, mut again) = (TestHost { silent: true, ..host.clone() }, host.clone());
    run(&mut machine, &script, &mut host);
    let mut by_micro_steps = ByMicroSteps(Machine::new(chart.clone()));
    run(&mut by_micro_steps, &script, &mut again);
    assert_eq!(host.log, again.log, "one micro-step at a time");
    assert_eq!(machine.configuration(), by_micro_steps.0.configuration());
    assert_silent_alike(&machine, &host, silent, chart, &script);
    host.log
}

/// Plays a script again on a machine without an observer, and asserts that everything else is
/// equal.
pub fn assert_silent_alike(
    traced: &Machine,
    seen: &TestHost,
    mut silent: TestHost,
    chart: Arc<CompiledChart>,
    script: &Script,
) {
    let reported: Vec<&String> =
        seen.log.iter().filter(|line| line.starts_with("  ") || line.starts_with("error")).collect();
    let alike = |machine: &Machine, log: &[String]| {
        assert_eq!(reported, log.iter().collect::<Vec<_>>());
        assert_eq!(traced.configuration(), machine.configuration());
        assert_eq!((traced.status(), traced.next_deadline()), (machine.status(), machine.next_deadline()));
    };
    let mut machine = Machine::new(chart);
    run(&mut machine, script, &mut silent);
    alike(&machine, &silent.log);
}

/// Plays a script from time 0 in simulated time: at each time inputs come first, then activities,
/// then the step.
pub fn run(interpreter: &mut impl Interpreter, script: &Script, host: &mut TestHost) {
    let mut inputs = script.inputs.iter().peekable();
    interpreter.start(Timestamp::ZERO, host);
    let mut now = Timestamp::ZERO;
    loop {
        host.now = now;
        while let Some((_, input)) = inputs.next_if(|(time, _)| Timestamp::from_millis(*time) <= now) {
            apply(interpreter, host, input);
        }
        if !settle(interpreter, now, host) {
            return;
        }
        let next = [
            inputs.peek().map(|(time, _)| Timestamp::from_millis(*time)),
            host.jobs.iter().map(|job| job.due).min(),
            interpreter.next_deadline(),
        ];
        let Some(next) = next.into_iter().flatten().min() else { return };
        if next > Timestamp::from_millis(script.until) {
            return;
        }
        now = next.max(now);
    }
}

fn apply(interpreter: &mut impl Interpreter, host: &mut TestHost, input: &Input) {
    match input {
        Input::Event(name) => interpreter.event(name),
        Input::Message(topic, value) => {
            host.send(*topic, *value, (0..interpreter.regions() as u32).map(ScopeId));
            report_arrivals(interpreter, host);
        }
    }
}

fn report_arrivals(interpreter: &mut impl Interpreter, host: &mut TestHost) {
    for topic in std::mem::take(&mut host.arrivals) {
        interpreter.message(topic);
    }
}

/// Processes activities and steps until nothing is due; false if the interpreter failed.
fn settle(interpreter: &mut impl Interpreter, now: Timestamp, host: &mut TestHost) -> bool {
    loop {
        while let Some(index) = (0..host.jobs.len()).find(|&index| host.jobs[index].due <= now) {
            advance(interpreter, now, host, index);
        }
        if !interpreter.needs_step(now) {
            return true;
        }
        if let Err(error) = interpreter.step(now, host) {
            host.say(format!("error: {error}"));
            return false;
        }
        report_arrivals(interpreter, host);
    }
}

/// An activity returns or, if it waits, is called again.
fn advance(interpreter: &mut impl Interpreter, now: Timestamp, host: &mut TestHost, index: usize) {
    let job = &mut host.jobs[index];
    let activation = job.activation;
    if job.waits {
        match interpreter.resumed(activation) {
            true => (job.waits, job.due, job.calls) = (false, now + job.duration, job.calls + 1),
            false => job.due = Timestamp::from_nanos(u64::MAX), // its state is about to be left
        }
        return;
    }
    let outcome = TestHost::outcome(job);
    let text = format!("  {} returns {outcome:?}", job.name);
    (job.waits, job.due) = (true, now + Duration::from_millis(10));
    host.say(text);
    if !interpreter.returned(activation, outcome) || outcome != Outcome::Ongoing {
        host.jobs.remove(index);
    }
}
