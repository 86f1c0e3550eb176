//! Changes that were made while agents were recorded, in a replay.

use std::sync::mpsc::{Sender, channel};
use std::time::Duration;

use monas::records::{Action, CHANGE, CHANGED, Change};
use monas::{Activity, Agent, Blackboard, BoxError, Hz, Parameters, Progress, Registry, Talws};
use narukom::prost::Message as _;
use yase::Source;

use crate::kit::{BALL, Ball, GAME, Game, NEWS, Phase, at};
use crate::taped::{Kept, Tape, replay, replay_simulated};
use crate::{change, made, settings};

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

/// Agents that are changed: two with lists, and one with a chart.
fn agents() -> Talws {
    let text = "<agent frequency='10'><name>thrower</name><activity>Throw</activity></agent>
        <agent frequency='20'><name>sayer</name><activity>Say</activity></agent>";
    let (setup, diagnostics) =
        monas::config::read(&Source::new("a.xml", text), "a.xml".as_ref(), &registry());
    assert_eq!(diagnostics, []);
    let chart = aseme::statechart_of(&Source::new("m.srm", "m = Play . Look")).0;
    Talws::new().registry(registry()).setup(setup).agent(Agent::statechart("mind", chart).every(Hz(5)))
}

/// And one that asks for changes of others, and then has one made of itself.
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

/// A run of two simulated seconds in which agents are changed in every way.
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
    for (agent, topic, least) in [
        ("thrower", "test/ball", 15),
        ("thrower", "test/news", 10),
        ("thrower", "test/game", 15),
        ("sayer", "test/news", 25),
        ("mind", "test/game", 2),
        ("mind", "test/news", 20),
        ("mind", "monas/model", 2),
        ("asker", "monas/change", 3),
    ] {
        let recorded = messages.iter().filter(|kept| kept.publisher == agent && kept.topic == topic).count();
        assert_eq!(outcome.compared(agent, topic), recorded as u64, "{agent} {topic}");
        assert!(recorded >= least, "{agent} {topic}: {recorded}");
    }
    // Some of them alone, on the changes that the others asked for.
    let some = agents();
    assert_eq!(replay_simulated(some, 7, &messages).unwrap().differences, []);
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

#[test]
fn an_agent_that_was_removed_and_came_back_is_refused() {
    let tape = Tape::default();
    let mut talws = agents();
    talws.observe(Box::new(tape.clone()));
    let mut simulation = talws.simulate(7).unwrap();
    simulation.run_until(at(100)).unwrap();
    made(&simulation.change("local", change(Action::RemoveAgent, "sayer")).unwrap());
    let text = "<agent frequency='10'><name>sayer</name><activity>Say</activity></agent>".to_owned();
    made(&simulation.change("local", Change { text, ..change(Action::AddAgents, "") }).unwrap());
    simulation.run_until(at(300)).unwrap();
    let error = replay_simulated(agents(), 7, &tape.kept()).err().unwrap();
    let reason = "agent `sayer` was removed and added anew while it was recorded, which cannot be replayed";
    assert_eq!(error.to_string(), reason);
}

/// A run in real time of a thrower, in which something is changed.
fn live(asked: &[Change]) -> Vec<Kept> {
    let (sender, thrown) = channel();
    let tape = Tape::default();
    let mut talws = thrower(sender);
    talws.observe(Box::new(tape.clone()));
    let running = talws.start().unwrap();
    let more = || (0..5).for_each(|_| thrown.recv_timeout(Duration::from_secs(20)).unwrap());
    more();
    for change in asked {
        let changed = running.overview().change("local", change.clone()).unwrap();
        made(&changed);
        // Of those in the channel some are from before.
        if ![Action::PauseAgent, Action::StopAgent].contains(&change.action()) {
            thrown.try_iter().for_each(drop);
            more();
        }
    }
    running.stop();
    tape.kept()
}

fn thrower(calls: Sender<()>) -> Talws {
    let mut thrown = 0.0;
    let throws = move |blackboard: &mut Blackboard| -> Result<(), BoxError> {
        thrown += 1.0;
        // Nobody listens in a replay.
        let _ = calls.send(());
        Ok(blackboard.publish(BALL, Ball { x: thrown, y: blackboard.now().as_secs_f64(), found: true })?)
    };
    Talws::new().agent(Agent::new("thrower", Hz(1000)).activity(throws))
}

#[test]
fn in_real_time_pauses_and_ends_are_those_of_the_recorded_turns() {
    let messages = live(&[
        change(Action::PauseAgent, "thrower"),
        change(Action::ResumeAgent, "thrower"),
        change(Action::StopAgent, "thrower"),
    ]);
    let outcome = replay(thrower(channel().0), &messages).unwrap();
    assert_eq!(outcome.differences, []);
    let recorded = messages.iter().filter(|kept| kept.topic == BALL.path()).count();
    assert!(recorded >= 10 && outcome.compared("thrower", "test/ball") == recorded as u64, "{recorded}");
}

#[test]
fn in_real_time_a_chart_that_was_paused_is_refused_with_the_reason() {
    let chart = aseme::statechart_of(&Source::new("m.srm", "m = Look")).0;
    let mind = || Talws::new().registry(registry()).agent(Agent::statechart("mind", chart.clone()));
    let (tape, mut talws) = (Tape::default(), mind());
    talws.observe(Box::new(tape.clone()));
    let running = talws.start().unwrap();
    made(&running.overview().change("local", change(Action::PauseAgent, "mind")).unwrap());
    running.stop();
    let error = replay(mind(), &tape.kept()).err().unwrap();
    assert!(error.to_string().starts_with("agent `mind` was paused "), "{error}");
}

#[test]
fn in_real_time_an_agent_that_was_made_of_something_else_is_refused_with_the_reason() {
    let other = Change { settings: settings(&[("frequency", "500")]), ..change(Action::Set, "thrower") };
    let messages = live(&[other]);
    let error = replay(thrower(channel().0), &messages).err().unwrap();
    assert!(error.to_string().starts_with("agent `thrower` was set otherwise "), "{error}");
    assert!(error.to_string().ends_with("a recording does not tell after which turn"), "{error}");
    assert_eq!(error.hint(), Some("replay other agents, or the time before"));
}
