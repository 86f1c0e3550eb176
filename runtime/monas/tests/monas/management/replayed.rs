//! Replay of changes made while agents were recorded.

mod real_time;

use std::time::Duration;

use monas::records::{Action, CHANGE, CHANGED, CYCLE, Change, Cycle};
use monas::{Activity, Agent, Blackboard, BoxError, Hz, Parameters, Progress, Registry, Talws};
use narukom::prost::Message as _;
use yase::Source;

use crate::kit::{BALL, Ball, GAME, Game, NEWS, Phase, at};
use crate::management::{change, made, settings};
use crate::taped::{Kept, Outcome, Tape, replay_simulated};

/// Throws balls, further with each.
#[derive(Default)]
struct Throw {
    speed: f64,
    thrown: f64,
}

impl Activity for Throw {
    fn configure(&mut self, parameters: &Parameters) {
        self.speed = parameters.number("speed").unwrap_or(1.0);
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        self.thrown += self.speed;
        let chance = blackboard.random().uniform();
        blackboard.publish(BALL, Ball { x: self.thrown, y: chance, found: true })?;
        Ok(Progress::Done)
    }

    fn stop(&mut self, blackboard: &mut Blackboard) {
        let _ = blackboard.publish(BALL, Ball { x: -self.thrown, y: 0.0, found: false });
    }
}

fn registry() -> Registry {
    Registry::empty()
        .with("Throw", Throw::default)
        .with("Say", || {
            |blackboard: &mut Blackboard| {
                let x = blackboard.read(BALL).map_or(0.0, |ball| ball.x);
                blackboard.publish(NEWS, Ball { x, y: blackboard.now().as_secs_f64(), found: true })
            }
        })
        .with("Look", || {
            |blackboard: &mut Blackboard| -> Result<Progress, BoxError> {
                let x = blackboard.read(BALL).map_or(0.0, |ball| ball.x);
                blackboard.publish(NEWS, Ball { x, ..Ball::default() })?;
                Ok(Progress::after(Duration::from_millis(50)))
            }
        })
        .with("Play", || {
            |blackboard: &mut Blackboard| blackboard.publish(GAME, Game { phase: Phase::Play.into() })
        })
}

/// Two agents with lists and one with a chart; all of them are changed.
fn agents() -> Talws {
    let text = "<agent frequency='10'><name>thrower</name><activity>Throw</activity></agent>
        <agent frequency='20'><name>sayer</name><activity>Say</activity></agent>";
    let (setup, diagnostics) =
        monas::config::read(&Source::new("a.xml", text), "a.xml".as_ref(), &registry());
    assert_eq!(diagnostics, []);
    let chart = aseme_models::statechart_of(&Source::new("m.srm", "m = Play . Look")).0;
    Talws::new().registry(registry()).setup(setup).agent(Agent::statechart("mind", chart).every(Hz(5)))
}

/// An agent that requests changes of others, and then of itself.
fn asking() -> Talws {
    let asks = |blackboard: &mut Blackboard| -> Result<(), BoxError> {
        let asked = match blackboard.now() {
            now if now == at(1100) => change(Action::PauseAgent, "sayer"),
            now if now == at(1300) => change(Action::ResumeAgent, "sayer"),
            now if now == at(1400) => change(Action::StopAgent, "asker"),
            _ => return Ok(()),
        };
        Ok(blackboard.publish(CHANGE, asked)?)
    };
    agents().agent(Agent::new("asker", Hz(10)).activity(asks))
}

/// A simulated run of two seconds with every kind of change.
fn changed_run() -> Vec<Kept> {
    let tape = Tape::default();
    let mut talws = asking();
    talws.observe(Box::new(tape.clone()));
    let mut simulation = talws.simulate(7).unwrap();
    let throw = |action| Change { activity: "Throw".into(), ..change(action, "thrower") };
    let guest = "<agent frequency='10'><name>guest</name><activity>Say</activity></agent>";
    let script = [
        (150, Change { activity: "Say".into(), place: 1, ..change(Action::AddActivity, "thrower") }),
        (200, Change { text: guest.into(), ..change(Action::AddAgents, "") }),
        (250, Change { place: 2, ..throw(Action::MoveActivity) }),
        (
            330,
            Change {
                settings: settings(&[("frequency", "25"), ("Throw.speed", "3")]),
                ..change(Action::Set, "thrower")
            },
        ),
        (
            450,
            Change {
                file: "n.srm".into(),
                text: "m = Play . (Look | Play)".into(),
                ..change(Action::SwapModel, "mind")
            },
        ),
        (500, change(Action::PauseAgent, "thrower")),
        (555, change(Action::StepAgent, "thrower")),
        (600, change(Action::ResumeAgent, "thrower")),
        (700, change(Action::StopAgent, "mind")),
        (755, change(Action::StopAgent, "thrower")),
        (800, change(Action::StartAgent, "mind")),
        (850, change(Action::StartAgent, "thrower")),
        (900, change(Action::StartAgent, "thrower")),
        (950, Change { activity: "Say".into(), ..change(Action::RemoveActivity, "thrower") }),
        (1000, Change { replacement: "Play".into(), ..throw(Action::ReplaceActivity) }),
        (1500, change(Action::RemoveAgent, "guest")),
        (1600, change(Action::RemoveAgent, "sayer")),
    ];
    let count = script.len();
    for (moment, asked) in script {
        simulation.change_at(at(moment), "local", asked).unwrap();
    }
    simulation.run_until(at(2000)).unwrap();
    let messages = tape.kept();
    let answers = messages.iter().filter(|kept| kept.topic == CHANGED.path());
    let answers = answers.map(|kept| monas::records::Changed::decode(&kept.bytes[..]).unwrap());
    let (done, refused): (Vec<_>, Vec<_>) = answers.partition(|answer| answer.done);
    assert_eq!((done.len(), refused.len()), (count + 3 - 1, 1), "{refused:?}");
    messages
}

#[test]
fn in_simulated_time_changes_are_made_again() {
    let messages = changed_run();
    let outcome = replay_simulated(asking(), 7, &messages).unwrap();
    assert_eq!(outcome.differences, []);
    let expected = [
        ("thrower", "test/ball", 15),
        ("thrower", "test/news", 10),
        ("thrower", "test/game", 15),
        ("sayer", "test/news", 25),
        ("mind", "test/game", 2),
        ("mind", "test/news", 20),
        ("mind", "monas/model", 2),
        ("asker", "monas/change", 3),
    ];
    assert_compared(&messages, &outcome, &expected);
    // Some agents alone, with the recorded change requests of the others.
    let some = agents();
    assert_eq!(replay_simulated(some, 7, &messages).unwrap().differences, []);
}

/// A chart that plays at each news, and an agent that publishes some each second and at the same
/// time has the paused chart make a step.
fn stepped() -> (Talws, Talws) {
    let text = "Liveness:\nm = Play~\nTransitions:\nPlay -> Play : news";
    let mind = || {
        let (chart, diagnostics) = aseme_models::statechart_of(&Source::new("m.srm", text));
        assert_eq!(diagnostics, []);
        Talws::new().registry(registry()).agent(Agent::statechart("mind", chart))
    };
    let asks = |blackboard: &mut Blackboard| -> Result<(), BoxError> {
        let asked = match blackboard.now().as_nanos() / 100_000_000 {
            20 => Action::PauseAgent,
            30 | 40 => Action::StepAgent,
            50 => Action::ResumeAgent,
            _ => Action::NoAction,
        };
        if blackboard.now().as_nanos().is_multiple_of(1_000_000_000) {
            blackboard.publish(NEWS, Ball::default())?;
        }
        match asked {
            Action::NoAction => Ok(()),
            asked => Ok(blackboard.publish(CHANGE, change(asked, "mind"))?),
        }
    };
    let asker = Agent::new("asker", Hz(10)).activity(asks);
    (mind().agent(asker), mind())
}

#[test]
fn in_simulated_time_a_step_sees_again_what_had_arrived() {
    let tape = Tape::default();
    let (mut talws, mind) = stepped();
    talws.observe(Box::new(tape.clone()));
    talws.simulate(7).unwrap().run_until(at(8000)).unwrap();
    let outcome = replay_simulated(mind, 7, &tape.kept()).unwrap();
    assert_eq!(outcome.differences, []);
    // The first comes from START; that of 0 s to 7 s follow, those of 3 s and 4 s by steps.
    assert_eq!(outcome.compared("mind", "test/game"), 9);
}

#[test]
fn without_the_changes_it_would_be_another_run() {
    let messages = changed_run();
    for action in [Action::AddActivity, Action::Set, Action::PauseAgent, Action::SwapModel, Action::StopAgent]
    {
        let is_such = |kept: &Kept| {
            kept.topic == CHANGE.path()
                && kept.publisher == "outside"
                && Change::decode(&kept.bytes[..]).unwrap().action() == action
        };
        let others: Vec<Kept> = messages.iter().filter(|kept| !is_such(kept)).cloned().collect();
        assert!(others.len() < messages.len(), "{action:?}");
        let outcome = replay_simulated(asking(), 7, &others).unwrap();
        assert_ne!(outcome.differences, [], "{action:?}");
    }
}

/// The addition of agents given as XML.
fn adding(text: &str) -> Change {
    Change { file: "more.xml".into(), text: text.into(), ..change(Action::AddAgents, "") }
}

/// A run in which agents are removed and added again with other content.
fn run_of_returns() -> Vec<Kept> {
    let tape = Tape::default();
    let mut talws = asking();
    talws.observe(Box::new(tape.clone()));
    let mut simulation = talws.simulate(7).unwrap();
    let sayer =
        "<agent frequency='50'><name>sayer</name><activity>Throw</activity><activity>Say</activity></agent>";
    let guest = "<agent frequency='10'><name>guest</name><activity>Say</activity></agent>";
    let script = [
        (100, change(Action::RemoveAgent, "sayer")),
        // With an agent that is new.
        (250, adding(&format!("{guest}{sayer}"))),
        (300, Change { activity: "Play".into(), ..change(Action::AddActivity, "sayer") }),
        (400, change(Action::RemoveAgent, "sayer")),
        (400, adding(sayer)),
        (1500, change(Action::RemoveAgent, "thrower")),
        (1550, adding("<agent frequency='20'><name>thrower</name><activity>Throw</activity></agent>")),
    ];
    for (moment, asked) in script {
        simulation.change_at(at(moment), "local", asked).unwrap();
    }
    simulation.run_until(at(2000)).unwrap();
    let messages = tape.kept();
    let mut answers = messages.iter().filter(|kept| kept.topic == CHANGED.path());
    assert!(answers.all(|kept| monas::records::Changed::decode(&kept.bytes[..]).unwrap().done));
    messages
}

#[test]
fn in_simulated_time_agents_that_left_come_back() {
    let messages = run_of_returns();
    let outcome = replay_simulated(asking(), 7, &messages).unwrap();
    assert_eq!(outcome.differences, []);
    let expected = [
        ("sayer", "test/ball", 60),
        ("sayer", "test/news", 60),
        ("sayer", "test/game", 5),
        ("sayer", "monas/cycle", 60),
        ("thrower", "test/ball", 20),
    ];
    assert_compared(&messages, &outcome, &expected);
}

#[test]
fn a_different_restart_is_another_run() {
    let mut messages = run_of_returns();
    let is_last = |kept: &&mut Kept| kept.topic == CHANGE.path() && kept.publisher == "outside";
    let kept = messages.iter_mut().rfind(is_last).unwrap();
    let mut other = Change::decode(&kept.bytes[..]).unwrap();
    other.text = other.text.replace("frequency='20'", "frequency='10'");
    kept.bytes = other.encode_to_vec();
    let outcome = replay_simulated(asking(), 7, &messages).unwrap();
    assert!(outcome.differences.iter().any(|difference| difference.agent == "thrower"));
    assert!(outcome.differences.iter().all(|difference| difference.time >= at(1550)));
}

#[test]
fn a_change_rejected_because_of_an_unreplayed_agent_is_not_repeated() {
    let tape = Tape::default();
    let mut talws = agents();
    talws.observe(Box::new(tape.clone()));
    let mut simulation = talws.simulate(7).unwrap();
    simulation.run_until(at(100)).unwrap();
    made(&simulation.change("local", change(Action::RemoveAgent, "sayer")).unwrap());
    let both = "<agent frequency='10'><name>sayer</name><activity>Say</activity></agent>
        <agent frequency='10'><name>thrower</name><activity>Throw</activity></agent>";
    assert!(!simulation.change("local", adding(both)).unwrap().done);
    simulation.run_until(at(300)).unwrap();
    assert_eq!(replay_simulated(agents(), 7, &tape.kept()).unwrap().differences, []);
    // An agent without the thrower cannot know the reason.
    let text = "<agent frequency='20'><name>sayer</name><activity>Say</activity></agent>";
    let (setup, _) = monas::config::read(&Source::new("a.xml", text), "a.xml".as_ref(), &registry());
    let sayer = Talws::new().registry(registry()).setup(setup);
    let error = replay_simulated(sayer, 7, &tape.kept()).err().unwrap();
    assert!(error.to_string().starts_with("removed agents were rejected "), "{error}");
    assert_eq!(error.hint(), Some("replay all agents of the host"));
}

/// A chart agent to which activities are added.
fn with_a_list() -> [Change; 4] {
    let add = |activity: &str| Change { activity: activity.into(), ..change(Action::AddActivity, "mind") };
    [add("Say"), add("Play"), change(Action::PauseAgent, "mind"), change(Action::ResumeAgent, "mind")]
}

/// Whether a message is compared: not the records of a chart's turns beside its cycles, nor those
/// of changes.
fn is_compared(kept: &Kept) -> bool {
    kept.topic != CYCLE.path() || Cycle::decode(&kept.bytes[..]).unwrap().number > 0
}

/// The number of compared messages of an agent on a topic.
fn recorded(messages: &[Kept], agent: &str, topic: &str) -> usize {
    let of_agent = messages.iter().filter(|kept| kept.publisher == agent && kept.topic == topic);
    of_agent.filter(|kept| is_compared(kept)).count()
}

/// Asserts that at least these numbers of messages were recorded on topics, and that all were
/// compared.
fn assert_compared(messages: &[Kept], outcome: &Outcome, expected: &[(&str, &str, usize)]) {
    for (agent, topic, min) in expected {
        let recorded = recorded(messages, agent, topic);
        assert_eq!(outcome.compared(agent, topic), recorded as u64, "{agent} {topic}");
        assert!(recorded >= *min, "{agent} {topic}: {recorded}");
    }
}

#[test]
fn in_simulated_time_a_list_begins_beside_a_chart() {
    let tape = Tape::default();
    let mut talws = agents();
    talws.observe(Box::new(tape.clone()));
    let mut simulation = talws.simulate(7).unwrap();
    for (moment, asked) in [200, 400, 600, 800].into_iter().zip(with_a_list()) {
        simulation.change_at(at(moment), "local", asked).unwrap();
    }
    simulation.run_until(at(1500)).unwrap();
    let messages = tape.kept();
    let outcome = replay_simulated(agents(), 7, &messages).unwrap();
    assert_eq!(outcome.differences, []);
    assert_compared(&messages, &outcome, &[("mind", "test/news", 10), ("mind", "test/game", 2)]);
}
