//! Regions that are locked by running activities, in simulated time.

use std::time::Duration;

use crate::kit::{BALL, Ball, NEWS, Recorder, at, recorder};
use monas::{Activity, Agent, Blackboard, BoxError, Hz, Progress, Registry, Talws};
use yase::{Semantics, Source, Statechart};

fn chart(text: &str) -> Statechart {
    let (chart, diagnostics) = aseme_models::statechart_of(&Source::new("m.srm", text));
    assert_eq!(diagnostics, [], "{diagnostics:#?}");
    chart
}

/// Records its name, the time, the ball it reads and whether it is cancelled; then writes a ball.
fn speaker(name: &'static str, note: impl Fn(String) + Clone + Send + Sync + 'static) -> impl Activity {
    move |b: &mut Blackboard| -> Result<(), BoxError> {
        let ball = b.read(BALL).map_or(0.0, |ball| ball.x);
        let asked = if b.is_cancelled() { " asked" } else { "" };
        note(format!("{name} {} ball {ball}{asked}", b.now().as_nanos() / 1_000_000));
        Ok(b.publish(BALL, Ball { x: 9.0, found: true, ..Ball::default() })?)
    }
}

/// An agent that publishes a ball at 0 ms, and another one with news at 20 ms.
fn reporter() -> Agent {
    Agent::new("a", Hz(50)).activity(|b: &mut Blackboard| -> Result<(), BoxError> {
        let tick = b.now().as_nanos() / 20_000_000;
        if tick < 2 {
            b.publish(BALL, Ball { x: 1.0 + tick as f64, found: true, ..Ball::default() })?;
        }
        if tick == 1 {
            b.publish(NEWS, Ball::default())?;
        }
        Ok(())
    })
}

/// Records of a chart's activities in the first 200 ms.
fn records(agent: impl Fn(Agent) -> Agent, text: &str) -> Vec<String> {
    let (words, note): (Recorder<String>, _) = recorder();
    let registry = ["A", "B", "C"].into_iter().fold(Registry::linked(), |registry, name| {
        let note = note.clone();
        registry.with(name, move || speaker(name, note.clone()))
    });
    let agent = agent(Agent::statechart("m", chart(text)));
    let talws = Talws::new().registry(registry).agent(agent).agent(reporter());
    talws.simulate(1).unwrap().run_until(at(200)).unwrap();
    words.taken()
}

fn same(agent: Agent) -> Agent {
    agent
}

const SLOW: &str = "States:\nA : duration = 50ms";

#[test]
fn a_guard_does_not_see_what_the_running_activity_has_written() {
    // The ball that A writes is published when A returns at 50 ms. The news at 20 ms meet the ball
    // with which A started.
    let text =
        |ball: u8| format!("Liveness:\nm = A . B\nTransitions:\nA -> B : news [ball.x == {ball}]\n{SLOW}");
    assert_eq!(records(same, &text(9)), ["A 0 ball 1"]);
    assert_eq!(records(same, &text(2)), ["A 0 ball 1"]);
}

#[test]
fn an_event_whose_guard_held_when_the_activity_began_is_held() {
    let text = format!("Liveness:\nm = A . B\nTransitions:\nA -> B : news [ball.found]\n{SLOW}");
    assert_eq!(records(same, &text), ["A 0 ball 1", "B 50 ball 9"]);
}

#[test]
fn a_cancelled_activity_takes_no_more_time() {
    let text = format!("Liveness:\nm = A . B\nTransitions:\nA -> B interrupts : news\n{SLOW}");
    assert_eq!(records(same, &text), ["A 0 ball 1", "B 20 ball 9"]);
}

#[test]
fn an_activity_cancelled_before_its_start_sees_the_request_at_once() {
    // A -> B exits A in the step that enters it; the activity is cancelled right after its start.
    let text = "Liveness:\nm = C . A . B\nTransitions:\nC -> A : news / raise(go)\nA -> B interrupts : go";
    assert_eq!(records(same, text), ["C 0 ball 1", "A 20 ball 2 asked", "B 20 ball 9"]);
}

#[test]
fn a_message_that_arrives_during_a_call_begins_the_next_one_at_its_end() {
    let (calls, note) = recorder();
    let registry = Registry::empty().with("A", move || {
        let note = note.clone();
        move |b: &mut Blackboard| {
            note((b.now(), b.read(BALL).map(|ball| ball.x)));
            Progress::after(Duration::from_millis(100))
        }
    });
    // The ball of 20 ms arrives during the first call, which started with the ball of 0 ms.
    let agent = Agent::statechart("m", chart(&format!("Liveness:\nm = A\n{SLOW}")));
    let talws = Talws::new().registry(registry).agent(agent).agent(reporter());
    talws.simulate(1).unwrap().run_until(at(240)).unwrap();
    assert_eq!(calls.taken(), [(at(0), Some(1.0)), (at(50), Some(2.0)), (at(200), Some(2.0))]);
}

#[test]
fn an_interrupting_exit_does_not_wait_and_ignores_a_late_return() {
    // Entering the chart enters A, which locks the region before anything is delivered. It would
    // return at 50 ms. B, at 20 ms, sees the second ball on another blackboard, and never what A
    // has written.
    let text =
        format!("Liveness:\nm = A . B . C\nTransitions:\nA -> B : news\nB -> C : [ball.x == 9]\n{SLOW}");
    let text = format!("{text}\nB : duration = 100ms");
    let under = |semantics: Semantics| records(|agent| agent.semantics(semantics), &text);
    assert_eq!(under(Semantics::uml()), ["A 0 ball 0", "B 20 ball 2", "C 120 ball 9"]);
    // Here a transition without a trigger does not wait for its state to be complete, so C is left
    // before its activity begins.
    assert_eq!(under(Semantics::scxml()), ["A 0 ball 0", "B 20 ball 2"]);
}

#[test]
fn a_state_that_is_active_again_waits_for_the_late_return_of_its_activity() {
    // The news leave A and enter it again while its first call goes on. There is one instance, so
    // the second call follows the first.
    let text = format!("Liveness:\nm = A~\nTransitions:\nA -> A : news\n{SLOW}");
    let words = records(|agent| agent.semantics(Semantics::uml()), &text);
    assert_eq!(words, ["A 0 ball 0", "A 20 ball 2"]);
}
