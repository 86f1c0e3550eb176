//! What happens in a world, and when; and playing it to whatever interprets a chart.

use std::sync::Arc;
use std::time::Duration;

use yase::{
    Activation, Chart, Machine, MicroStep, Moment, Outcome, RegionId, Semantics, Statechart, TopicId,
};

use super::world::{TOPICS, World, vocabulary};

/// Something that interprets a chart: the machine, or the reference.
pub trait Interpreter {
    fn start(&mut self, now: Moment, world: &mut World);
    fn event(&mut self, name: &str);
    fn message(&mut self, topic: TopicId);
    /// False if it is not one of this run any more.
    fn returned(&mut self, activation: Activation, outcome: Outcome) -> bool;
    fn resumed(&mut self, activation: Activation) -> bool;
    /// `Err` with a text when it gives up.
    fn step(&mut self, now: Moment, world: &mut World) -> Result<(), String>;
    fn needs_step(&self, now: Moment) -> bool;
    fn next_deadline(&self) -> Option<Moment>;
    fn regions(&self) -> usize;
}

impl Interpreter for Machine {
    fn start(&mut self, now: Moment, world: &mut World) {
        Machine::start(self, now, world);
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

    fn step(&mut self, now: Moment, world: &mut World) -> Result<(), String> {
        self.run_to_completion(now, world).map(|_| ()).map_err(|error| error.to_string())
    }

    fn needs_step(&self, now: Moment) -> bool {
        Machine::needs_step(self, now)
    }

    fn next_deadline(&self) -> Option<Moment> {
        Machine::next_deadline(self)
    }

    fn regions(&self) -> usize {
        self.chart().regions().len()
    }
}

/// A machine that is stepped one micro-step at a time. So it never goes the short way, and each step must come to the same as a whole one.
pub struct ByMicroSteps(pub Machine);

impl Interpreter for ByMicroSteps {
    fn start(&mut self, now: Moment, world: &mut World) {
        self.0.start(now, world);
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

    fn step(&mut self, now: Moment, world: &mut World) -> Result<(), String> {
        loop {
            match self.0.micro_step(now, world) {
                Ok(MicroStep::Made) => {}
                Ok(MicroStep::AtRest(_)) => return Ok(()),
                Err(error) => return Err(error.to_string()),
            }
        }
    }

    fn needs_step(&self, now: Moment) -> bool {
        self.0.needs_step(now)
    }

    fn next_deadline(&self) -> Option<Moment> {
        self.0.next_deadline()
    }

    fn regions(&self) -> usize {
        self.0.chart().regions().len()
    }
}

/// A machine that is handed events instead of noting them first, where one comes alone.
pub struct ByHandling {
    pub machine: Machine,
    /// Noted, but not yet to the machine.
    waiting: Vec<String>,
}

impl ByHandling {
    pub fn new(machine: Machine) -> ByHandling {
        ByHandling { machine, waiting: Vec::new() }
    }

    fn note(&mut self) {
        self.waiting.drain(..).for_each(|name| _ = self.machine.dispatch_name(&name));
    }
}

impl Interpreter for ByHandling {
    fn start(&mut self, now: Moment, world: &mut World) {
        self.machine.start(now, world);
    }

    fn event(&mut self, name: &str) {
        self.waiting.push(name.to_owned());
    }

    fn message(&mut self, topic: TopicId) {
        self.note();
        self.machine.message_arrived(topic, 1);
    }

    fn returned(&mut self, activation: Activation, outcome: Outcome) -> bool {
        self.note();
        self.machine.activity_returned(activation, outcome)
    }

    fn resumed(&mut self, activation: Activation) -> bool {
        self.note();
        self.machine.activity_resumed(activation)
    }

    fn step(&mut self, now: Moment, world: &mut World) -> Result<(), String> {
        let made = match self.waiting.as_slice() {
            [name] if self.machine.chart().event(name).1 => {
                let (event, _) = self.machine.chart().event(name);
                self.waiting.clear();
                self.machine.handle(event, now, world)
            }
            _ => {
                self.note();
                self.machine.run_to_completion(now, world)
            }
        };
        made.map(|_| ()).map_err(|error| error.to_string())
    }

    fn needs_step(&self, now: Moment) -> bool {
        !self.waiting.is_empty() || self.machine.needs_step(now)
    }

    fn next_deadline(&self) -> Option<Moment> {
        self.machine.next_deadline()
    }

    fn regions(&self) -> usize {
        self.machine.chart().regions().len()
    }
}

/// What happens at a time.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    Event(String),
    Message(TopicId, i64),
}

/// Inputs in order of time, in milliseconds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    pub inputs: Vec<(u64, Input)>,
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

/// Compiles a chart with the words of the tests.
pub fn compile(chart: &Statechart) -> Arc<Chart> {
    compile_with(chart, Semantics::yase())
}

pub fn compile_with(chart: &Statechart, semantics: Semantics) -> Arc<Chart> {
    match chart.compile_with(&vocabulary(), semantics) {
        Ok(chart) => Arc::new(chart),
        Err(found) => panic!("{}", found.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")),
    }
}

/// Plays a script to a machine, and gives the lines that the world wrote down.
pub fn play(chart: &Statechart, script: &str) -> Vec<String> {
    play_with(chart, script, Semantics::yase())
}

pub fn play_with(chart: &Statechart, script: &str, semantics: Semantics) -> Vec<String> {
    let (mut world, script) = (World::new(chart), Script::parse(script));
    let chart = compile_with(chart, semantics);
    let mut machine = Machine::new(chart.clone());
    let (silent, mut again) = (World { silent: true, ..world.clone() }, world.clone());
    run(&mut machine, &script, &mut world);
    let mut by_micro_steps = ByMicroSteps(Machine::new(chart.clone()));
    run(&mut by_micro_steps, &script, &mut again);
    assert_eq!(world.log, again.log, "one micro-step at a time");
    assert_eq!(machine.configuration(), by_micro_steps.0.configuration());
    assert_silent_alike(&machine, &world, silent, chart, &script);
    world.log
}

/// Plays a script again to a machine whose micro-steps nobody looks at, and asserts that whatever else can be seen is the same.
pub fn assert_silent_alike(
    traced: &Machine,
    seen: &World,
    mut silent: World,
    chart: Arc<Chart>,
    script: &Script,
) {
    let told: Vec<&String> =
        seen.log.iter().filter(|line| line.starts_with("  ") || line.starts_with("error")).collect();
    let alike = |machine: &Machine, log: &[String]| {
        assert_eq!(told, log.iter().collect::<Vec<_>>());
        assert_eq!(traced.configuration(), machine.configuration());
        assert_eq!((traced.status(), traced.next_deadline()), (machine.status(), machine.next_deadline()));
    };
    let mut handed = silent.clone();
    let mut machine = Machine::new(chart.clone());
    run(&mut machine, script, &mut silent);
    alike(&machine, &silent.log);
    let mut by_handling = ByHandling::new(Machine::new(chart));
    run(&mut by_handling, script, &mut handed);
    alike(&by_handling.machine, &handed.log);
    assert_eq!(machine.snapshot(), by_handling.machine.snapshot(), "handed over or noted first");
}

/// Plays a script, from time 0, in simulated time: whatever is due at a time happens in the order inputs, activities, step.
pub fn run(interpreter: &mut impl Interpreter, script: &Script, world: &mut World) {
    let mut inputs = script.inputs.iter().peekable();
    interpreter.start(Moment::ZERO, world);
    let mut now = Moment::ZERO;
    loop {
        world.now = now;
        while let Some((_, input)) = inputs.next_if(|(time, _)| Moment::from_millis(*time) <= now) {
            apply(interpreter, world, input);
        }
        if !settle(interpreter, now, world) {
            return;
        }
        let next = [
            inputs.peek().map(|(time, _)| Moment::from_millis(*time)),
            world.jobs.iter().map(|job| job.due).min(),
            interpreter.next_deadline(),
        ];
        let Some(next) = next.into_iter().flatten().min() else { return };
        if next > Moment::from_millis(script.until) {
            return;
        }
        now = next.max(now);
    }
}

fn apply(interpreter: &mut impl Interpreter, world: &mut World, input: &Input) {
    match input {
        Input::Event(name) => interpreter.event(name),
        Input::Message(topic, value) => {
            world.send(*topic, *value, (0..interpreter.regions() as u32).map(RegionId));
            tell_arrivals(interpreter, world);
        }
    }
}

fn tell_arrivals(interpreter: &mut impl Interpreter, world: &mut World) {
    for topic in std::mem::take(&mut world.arrivals) {
        interpreter.message(topic);
    }
}

/// Lets activities return and steps happen until nothing is due; false when the interpreter gave up.
fn settle(interpreter: &mut impl Interpreter, now: Moment, world: &mut World) -> bool {
    loop {
        while let Some(index) = (0..world.jobs.len()).find(|&index| world.jobs[index].due <= now) {
            advance(interpreter, now, world, index);
        }
        if !interpreter.needs_step(now) {
            return true;
        }
        if let Err(error) = interpreter.step(now, world) {
            world.say(format!("error: {error}"));
            return false;
        }
        tell_arrivals(interpreter, world);
    }
}

/// An activity returns or, if it waits, is called again.
fn advance(interpreter: &mut impl Interpreter, now: Moment, world: &mut World, index: usize) {
    let job = &mut world.jobs[index];
    let activation = job.activation;
    if job.waits {
        match interpreter.resumed(activation) {
            true => (job.waits, job.due, job.calls) = (false, now + job.duration, job.calls + 1),
            false => job.due = Moment::from_nanos(u64::MAX), // its state is about to be left
        }
        return;
    }
    let outcome = World::outcome(job);
    let text = format!("  {} returns {outcome:?}", job.name);
    (job.waits, job.due) = (true, now + Duration::from_millis(10));
    world.say(text);
    if !interpreter.returned(activation, outcome) || outcome != Outcome::Ongoing {
        world.jobs.remove(index);
    }
}
