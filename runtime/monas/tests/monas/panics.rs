//! Panics in every function of an activity: each is a failure of that activity alone.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use crate::kit::{BALL, Ball, Recorder, at, recorder};
use crate::management::{change, made};
use monas::records::{Action, Change};
use monas::{
    Activity, Agent, Blackboard, BoxError, FailurePolicy, Hz, Parameters, Progress, Registry, Talws, Topics,
};
use narukom::{Observer, Publication};
use yase::Source;

/// Longer than any successful operation takes.
const TIMEOUT: Duration = Duration::from_secs(20);

/// All parts of an activity that run its code, except its constructor and `configure`.
const PARTS: [&str; 8] = ["name", "topics", "start", "execute", "stop", "drop", "display", "end of an error"];

/// Panics in one part.
#[derive(Clone, Copy)]
struct FaultyActivity(&'static str);

impl FaultyActivity {
    fn reach(self, part: &str) {
        assert!(self.0 != part, "{part} is spoiled");
    }
}

impl Activity for FaultyActivity {
    fn configure(&mut self, _: &Parameters) {}
    fn start(&mut self, _: &mut Blackboard) -> Result<(), BoxError> {
        self.reach("start");
        Ok(())
    }
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        self.reach("execute");
        blackboard.publish(BALL, Ball::default())?;
        match self.0 {
            "display" | "end of an error" => Err(FaultyError(*self).into()),
            _ => Ok(Progress::ongoing()),
        }
    }
    fn stop(&mut self, _: &mut Blackboard) {
        self.reach("stop");
    }
    fn name(&self) -> &str {
        self.reach("name");
        "FaultyActivity"
    }
    fn topics(&self) -> Topics {
        self.reach("topics");
        Topics::declared().publishes(BALL)
    }
}

/// `FaultyActivity` is copied, `DroppedActivity` is not.
struct DroppedActivity(FaultyActivity);

impl Activity for DroppedActivity {
    fn start(&mut self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        self.0.start(blackboard)
    }
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        self.0.execute(blackboard)
    }
    fn stop(&mut self, blackboard: &mut Blackboard) {
        self.0.stop(blackboard);
    }
    fn name(&self) -> &str {
        self.0.name()
    }
    fn topics(&self) -> Topics {
        self.0.topics()
    }
}

impl Drop for DroppedActivity {
    fn drop(&mut self) {
        self.0.reach("drop");
    }
}

struct FaultyError(FaultyActivity);

impl std::fmt::Display for FaultyError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.reach("display");
        f.write_str("it failed")
    }
}

impl std::fmt::Debug for FaultyError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

impl std::error::Error for FaultyError {}

impl Drop for FaultyError {
    fn drop(&mut self) {
        self.0.reach("end of an error");
    }
}

fn chart(text: &str) -> yase::Statechart {
    aseme_models::statechart_of(&Source::new("m.srm", text)).0
}

/// An agent that notes its calls beside another.
fn beside(agent: Agent, registry: Registry) -> (Talws, Recorder<()>) {
    let (calls, note) = recorder();
    let other = Agent::new("z", Hz(10)).activity(move |_: &mut Blackboard| note(()));
    (Talws::new().registry(registry).agent(agent).agent(other), calls)
}

#[test]
fn of_an_activity_of_a_list_harm_no_other_agent() {
    for part in PARTS {
        let agent = Agent::new("a", Hz(10)).activity(DroppedActivity(FaultyActivity(part)));
        let (talws, calls) = beside(agent, Registry::linked());
        let mut simulation = talws.simulate(1).unwrap();
        simulation.run_until(at(200)).unwrap();
        made(&simulation.change("local", change(Action::RemoveAgent, "a")).unwrap());
        simulation.run_until(at(400)).unwrap();
        assert_eq!(calls.taken().len(), 4, "{part}");
        let fails = ["start", "execute", "display", "end of an error"].contains(&part);
        let statistics = simulation.statistics();
        let failures = statistics.agents[0].activities[0].failures;
        assert_eq!(failures > 0, fails, "{part}: {failures}");
    }
}

#[test]
fn of_an_activity_of_a_chart_harm_no_other_agent() {
    for part in PARTS.into_iter().filter(|part| *part != "name") {
        let registry = Registry::linked().with("A", move || DroppedActivity(FaultyActivity(part)));
        let agent = Agent::statechart("a", chart("m = A . A"));
        let (talws, calls) = beside(agent, registry);
        let mut simulation = talws.simulate(1).unwrap();
        simulation.run_until(at(200)).unwrap();
        simulation.stop();
        drop(simulation);
        assert_eq!(calls.taken().len(), 2, "{part}");
    }
}

#[test]
fn of_a_name_are_the_reason_why_an_activity_cannot_be_made() {
    let registry = Registry::linked().with("A", || DroppedActivity(FaultyActivity("name")));
    let error = registry.activity("A").err().unwrap().to_string();
    assert!(error.ends_with("panicked: name is spoiled"), "{error}");
}

#[test]
fn of_a_function_in_a_guard_leave_the_guard_without_a_value() {
    fn spoiled(number: f64) -> f64 {
        assert!(number < 0.0, "the function is spoiled");
        number
    }
    monas::function!(spoiled(f64) -> f64);
    let (calls, note) = recorder();
    let registry = Registry::linked().with("B", move || {
        let note = note.clone();
        move |_: &mut Blackboard| note(())
    });
    let text = "Liveness:\nm = A . (B | C)\nTransitions:\nCONDITION -> C : [spoiled(1) > 0]";
    let registry = ["A", "C"].into_iter().fold(registry, |r, name| r.with(name, || |_: &mut Blackboard| {}));
    let (talws, others) = beside(Agent::statechart("a", chart(text)), registry);
    talws.simulate(1).unwrap().run_until(at(200)).unwrap();
    assert_eq!((calls.taken().len(), others.taken().len()), (1, 2));
}

/// The next word.
fn next(words: &Receiver<&'static str>) -> &'static str {
    words.recv_timeout(TIMEOUT).unwrap()
}

#[test]
fn of_a_description_stop_an_agent_in_real_time_which_starts_again() {
    for is_chart in [false, true] {
        let (sender, started) = channel();
        let registry = Registry::linked().with("A", move || {
            let sender = sender.clone();
            move |_: &mut Blackboard| -> Result<(), BoxError> {
                let _ = sender.send("called");
                Err(FaultyError(FaultyActivity("display")).into())
            }
        });
        let agent = match is_chart {
            true => Agent::statechart("a", chart("m = A . A")),
            false => Agent::new("a", Hz(1000)).named_activity("A", registry.activity("A").unwrap()),
        };
        let agent = agent.on_failure(FailurePolicy::StopAgent);
        // The run goes on with the other agent.
        let (talws, _calls) = beside(agent, registry);
        let running = talws.start().unwrap();
        restart_twice(&running.run_handle(), &started);
        let reason = running.stop().agents[0].stopped.clone().unwrap();
        assert!(reason.contains("description panicked: display is spoiled"), "{reason}");
    }
}

/// Starts agent `a` again after it has stopped, twice.
fn restart_twice(run: &monas::RunHandle, started: &Receiver<&'static str>) {
    for _ in 0..2 {
        assert_eq!(next(started), "called");
        let state = || run.agents(None).unwrap()[0].state.clone();
        while state() != "stopped" {
            std::thread::yield_now();
        }
        made(&run.change("local", change(Action::StartAgent, "a")).unwrap());
    }
    assert_eq!(next(started), "called");
    let state = || run.agents(None).unwrap()[0].state.clone();
    while state() != "stopped" {
        std::thread::yield_now();
    }
}

/// Panics at each ball.
struct FaultyObserver(Sender<&'static str>);

impl Observer for FaultyObserver {
    fn observe(&mut self, publication: Publication<'_>) {
        if publication.topic.path() == BALL.path() {
            let _ = self.0.send("called");
            panic!("the observer is spoiled");
        }
    }
}

#[test]
fn of_an_observer_stop_the_agent_that_publishes_which_starts_again() {
    for is_chart in [false, true] {
        let (sender, started) = channel();
        let registry = Registry::linked().with("A", || |b: &mut Blackboard| b.publish(BALL, Ball::default()));
        let agent = match is_chart {
            true => Agent::statechart("a", chart("m = A . A")),
            false => Agent::new("a", Hz(1000)).named_activity("A", registry.activity("A").unwrap()),
        };
        let (mut talws, _calls) = beside(agent, registry);
        talws.observe(Box::new(FaultyObserver(sender)));
        let running = talws.start().unwrap();
        restart_twice(&running.run_handle(), &started);
        let reason = running.stop().agents[0].stopped.clone().unwrap();
        assert_eq!(reason, "its thread panicked: the observer is spoiled");
    }
}

#[test]
fn of_a_change_are_no_end_of_a_run() {
    let (talws, calls) =
        beside(Agent::new("a", Hz(10)).activity(DroppedActivity(FaultyActivity("drop"))), Registry::linked());
    let mut simulation = talws.simulate(1).unwrap();
    simulation.run_until(at(100)).unwrap();
    let remove = Change { activity: "FaultyActivity".into(), ..change(Action::RemoveActivity, "a") };
    made(&simulation.change("local", remove).unwrap());
    simulation.run_until(at(200)).unwrap();
    assert_eq!(calls.taken().len(), 2);
}
