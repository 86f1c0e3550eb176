//! Replay of changes made while agents were recorded.

use std::sync::mpsc::{Sender, channel};
use std::time::Duration;

use monas::records::{Action, CHANGE, CHANGED, CYCLE, Change, Cycle, Turn};
use monas::{Activity, Agent, Blackboard, BoxError, Hz, Parameters, Progress, Registry, Talws};
use narukom::prost::Message as _;
use yase::{Source, Statechart};

use crate::kit::{BALL, Ball, GAME, Game, NEWS, Phase, at};
use crate::management::{change, made, settings};
use crate::taped::{Kept, Outcome, Tape, replay, replay_simulated};

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

/// A real-time run of a thrower with changes.
fn live(asked: &[Change]) -> Vec<Kept> {
    let (sender, thrown) = channel();
    let tape = Tape::default();
    let mut talws = thrower(sender);
    talws.observe(Box::new(tape.clone()));
    let running = talws.start().unwrap();
    let more = || (0..5).for_each(|_| thrown.recv_timeout(Duration::from_secs(20)).unwrap());
    more();
    for change in asked {
        let changed = running.run_handle().change("local", change.clone()).unwrap();
        made(&changed);
        // Some messages in the channel are from before the change.
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
        // No receiver exists in a replay.
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

/// A real-time run with changes whose activities report each call. Between two changes, activities
/// of the changed agent are called unless it is paused or stopped.
fn live_run(talws: impl Fn(Sender<()>) -> Talws, asked: &[Change]) -> Vec<Kept> {
    live_run_until(talws, asked, &[])
}

/// The same run, until a number of messages of agents on topics has been recorded.
fn live_run_until(
    talws: impl Fn(Sender<()>) -> Talws,
    asked: &[Change],
    expected: &[(&str, &str, usize)],
) -> Vec<Kept> {
    let (sender, calls) = channel();
    let tape = Tape::default();
    let mut talws = talws(sender);
    talws.observe(Box::new(tape.clone()));
    let running = talws.start().unwrap();
    let more = || (0..5).for_each(|_| calls.recv_timeout(Duration::from_secs(20)).unwrap());
    more();
    let mut rests = false;
    for change in asked {
        made(&running.run_handle().change("local", change.clone()).unwrap());
        rests = match change.action() {
            Action::PauseAgent | Action::StopAgent | Action::RemoveAgent => true,
            Action::StartAgent | Action::ResumeAgent | Action::AddAgents => false,
            _ => rests,
        };
        if !rests {
            calls.try_iter().for_each(drop);
            more();
        }
    }
    let is_there =
        |(agent, topic, least): &(&str, &str, usize)| recorded(&tape.kept(), agent, topic) >= *least;
    while !expected.iter().all(is_there) {
        calls.recv_timeout(Duration::from_secs(20)).unwrap();
    }
    running.stop();
    tape.kept()
}

/// The number of compared messages of an agent on a topic.
fn recorded(messages: &[Kept], agent: &str, topic: &str) -> usize {
    let of_agent = messages.iter().filter(|kept| kept.publisher == agent && kept.topic == topic);
    of_agent.filter(|kept| is_compared(kept)).count()
}

/// A registry of activities that report each call.
fn reporting(calls: Sender<()>) -> Registry {
    let sender = calls.clone();
    let report = move || {
        let sender = sender.clone();
        move |_: &mut Blackboard| {
            // No receiver exists in a replay.
            let _ = sender.send(());
        }
    };
    let watch = move || {
        let (calls, mut times) = (calls.clone(), 0.0);
        move |blackboard: &mut Blackboard| -> Result<Progress, BoxError> {
            times += 1.0;
            let chance = blackboard.random().uniform();
            blackboard
                .publish(NEWS, Ball { x: times, y: chance + blackboard.now().as_secs_f64(), found: true })?;
            let _ = calls.send(());
            Ok(Progress::after(Duration::from_millis(1)))
        }
    };
    registry().with("Report", report).with("Watch", watch)
}

fn chart(text: &str) -> Statechart {
    aseme_models::statechart_of(&Source::new("m.srm", text)).0
}

/// A list with an activity that throws balls; others may be added.
fn list(calls: Sender<()>) -> Talws {
    let registry = reporting(calls);
    let text = "<agent frequency='1000'><name>thrower</name><activity>Throw</activity><activity>Report</activity></agent>";
    let (setup, diagnostics) = monas::config::read(&Source::new("a.xml", text), "a.xml".as_ref(), &registry);
    assert_eq!(diagnostics, []);
    Talws::new().registry(registry).setup(setup)
}

/// A chart with an activity that is called repeatedly.
fn mind(calls: Sender<()>) -> Talws {
    let agent = Agent::statechart("mind", chart("m = Play . Watch")).every(Hz(200));
    Talws::new().registry(reporting(calls)).agent(agent)
}

/// A list and two charts, whose activities publish on the same topics.
fn player(calls: Sender<()>) -> Talws {
    let agent = Agent::new("player", Hz(500)).named_activity("Throw", Box::new(Throw::default()));
    let agent = agent.chart(chart("m = Play . Watch")).chart(chart("n = Watch"));
    Talws::new().registry(reporting(calls)).agent(agent)
}

fn of_list() -> Vec<Change> {
    let throw = |action| Change { activity: "Throw".into(), ..change(action, "thrower") };
    let set = |given: &[(&str, &str)]| Change { settings: settings(given), ..change(Action::Set, "thrower") };
    vec![
        Change { activity: "Say".into(), place: 1, ..change(Action::AddActivity, "thrower") },
        set(&[("frequency", "500"), ("Throw.speed", "3"), ("on_failure", "skip")]),
        Change { place: 3, ..throw(Action::MoveActivity) },
        change(Action::PauseAgent, "thrower"),
        change(Action::StepAgent, "thrower"),
        change(Action::ResumeAgent, "thrower"),
        change(Action::StopAgent, "thrower"),
        change(Action::StartAgent, "thrower"),
        Change { replacement: "Play".into(), ..throw(Action::ReplaceActivity) },
        Change { activity: "Say".into(), ..change(Action::RemoveActivity, "thrower") },
        Change { activity: "Play".into(), place: 1, ..change(Action::RemoveActivity, "thrower") },
        Change { activity: "Say".into(), ..change(Action::AddActivity, "thrower") },
    ]
}

fn of_chart() -> Vec<Change> {
    let swap =
        |text: &str| Change { file: "n.srm".into(), text: text.into(), ..change(Action::SwapModel, "mind") };
    vec![
        change(Action::PauseAgent, "mind"),
        change(Action::StepAgent, "mind"),
        change(Action::StepAgent, "mind"),
        change(Action::ResumeAgent, "mind"),
        swap("m = Play . (Watch | Play)"),
        Change {
            settings: settings(&[("frequency", "50"), ("on_failure", "restart")]),
            ..change(Action::Set, "mind")
        },
        change(Action::StopAgent, "mind"),
        change(Action::StartAgent, "mind"),
        swap("m = Play . (Watch | Play)"),
    ]
}

/// Asserts that at least these numbers of messages were recorded on topics, and that all were
/// compared.
fn assert_compared(messages: &[Kept], outcome: &Outcome, expected: &[(&str, &str, usize)]) {
    for (agent, topic, least) in expected {
        let recorded = recorded(messages, agent, topic);
        assert_eq!(outcome.compared(agent, topic), recorded as u64, "{agent} {topic}");
        assert!(recorded >= *least, "{agent} {topic}: {recorded}");
    }
}

fn of_player() -> Vec<Change> {
    let all = |action| change(action, "player");
    let of = |chart: &str, action| Change { chart: chart.into(), ..all(action) };
    let set = |given: &[(&str, &str)], of: Change| Change { settings: settings(given), ..of };
    let swap = Change { file: "n.srm".into(), text: "n = Watch . Play".into(), ..of("n", Action::SwapModel) };
    vec![
        Change { activity: "Say".into(), place: 1, ..all(Action::AddActivity) },
        of("n", Action::StopAgent),
        set(&[("frequency", "250"), ("Throw.speed", "3")], all(Action::Set)),
        of("n", Action::StartAgent),
        set(&[("frequency", "50")], of("m", Action::Set)),
        swap,
        all(Action::PauseAgent),
        all(Action::StepAgent),
        all(Action::ResumeAgent),
        Change { activity: "Throw".into(), ..all(Action::RemoveActivity) },
        all(Action::StopAgent),
        all(Action::StartAgent),
        Change { activity: "Throw".into(), ..all(Action::AddActivity) },
    ]
}

/// Whether a message is compared: not the records of a chart's turns beside its cycles, nor those
/// of changes.
fn is_compared(kept: &Kept) -> bool {
    kept.topic != CYCLE.path() || Cycle::decode(&kept.bytes[..]).unwrap().number > 0
}

#[test]
fn in_real_time_changes_are_made_again_between_the_turns_between_which_they_were() {
    for (agent, asked, talws) in [
        ("thrower", of_list(), list as fn(Sender<()>) -> Talws),
        ("mind", of_chart(), mind),
        ("player", of_player(), player),
    ] {
        let messages = live_run(talws, &asked);
        let outcome = replay(talws(channel().0), &messages).unwrap();
        assert_eq!(outcome.differences, []);
        let topics: &[(&str, usize)] = match agent {
            "mind" => &[("test/news", 20), ("monas/model", 4), ("monas/chart", 5), ("monas/cycle", 8)],
            "player" => &[("test/news", 20), ("test/ball", 5), ("monas/model", 6), ("monas/cycle", 20)],
            _ => &[("test/ball", 20), ("test/news", 20), ("test/game", 5), ("monas/cycle", 40)],
        };
        let expected: Vec<_> = topics.iter().map(|(topic, least)| (agent, *topic, *least)).collect();
        assert_compared(&messages, &outcome, &expected);
    }
}

#[test]
fn in_real_time_another_change_in_the_place_of_the_recorded_one_is_another_run() {
    let asked = Change { settings: settings(&[("Throw.speed", "3")]), ..change(Action::Set, "thrower") };
    let mut messages = live_run(list, &[asked]);
    let kept = messages.iter_mut().find(|kept| kept.topic == CHANGE.path()).unwrap();
    let mut other = Change::decode(&kept.bytes[..]).unwrap();
    other.settings = settings(&[("Throw.speed", "4")]);
    kept.bytes = other.encode_to_vec();
    let outcome = replay(list(channel().0), &messages).unwrap();
    assert!(!outcome.differences.is_empty());
    assert!(outcome.differences.iter().all(|difference| difference.topic == BALL.path()));
    other.activity = "Nothing".into();
    other.action = Action::RemoveActivity.into();
    let kept = messages.iter_mut().find(|kept| kept.topic == CHANGE.path()).unwrap();
    kept.bytes = other.encode_to_vec();
    let error = replay(list(channel().0), &messages).err().unwrap().to_string();
    assert!(error.starts_with("the change of agent `thrower` "), "{error}");
    assert!(
        error.ends_with("cannot be repeated: the list of `thrower` has no activity `Nothing`"),
        "{error}"
    );
}

#[test]
fn in_real_time_missing_records_are_rejected_with_the_reason() {
    let is_ordered = |kept: &Kept| {
        kept.topic == CYCLE.path() && Cycle::decode(&kept.bytes[..]).unwrap().turn() == Turn::Ordered
    };
    for (asked, talws, was) in [
        (&of_list()[1], list as fn(Sender<()>) -> Talws, "agent `thrower` was set otherwise "),
        (&of_chart()[4], mind, "agent `mind` was given another model "),
    ] {
        let messages = live_run(talws, std::slice::from_ref(asked));
        // Under another publisher, so that only records of an earlier version remain.
        let by_another = |is_such: &dyn Fn(&Kept) -> bool| {
            let mut messages = messages.clone();
            let such: Vec<&mut Kept> = messages.iter_mut().filter(|kept| is_such(kept)).collect();
            assert_eq!(such.len(), 1);
            such.into_iter().for_each(|kept| kept.publisher = "another".into());
            replay(talws(channel().0), &messages).err().unwrap()
        };
        let error = by_another(&is_ordered);
        assert!(error.to_string().starts_with(was), "{error}");
        let reason = "the recording, of an earlier version, lacks the turn";
        assert!(error.to_string().ends_with(reason), "{error}");
        assert_eq!(error.hint(), Some("replay other agents, or the time before"));
        let error = by_another(&|kept| kept.topic == CHANGE.path());
        let reason = "the recording lacks change 1 of `outside`, which an agent applied";
        assert_eq!(error.to_string(), reason);
    }
}

#[test]
fn in_real_time_agents_that_left_come_back() {
    let thrower = "<agent frequency='500'><name>thrower</name><activity>Report</activity><activity>Throw</activity><activity>Say</activity></agent>";
    let asked = [
        change(Action::RemoveAgent, "thrower"),
        adding(thrower),
        Change { activity: "Play".into(), ..change(Action::AddActivity, "thrower") },
        change(Action::RemoveAgent, "thrower"),
        adding(thrower),
    ];
    let messages = live_run(list, &asked);
    let outcome = replay(list(channel().0), &messages).unwrap();
    assert_eq!(outcome.differences, []);
    let expected = [
        ("thrower", "test/ball", 20),
        ("thrower", "test/news", 10),
        ("thrower", "test/game", 5),
        ("thrower", "monas/cycle", 20),
    ];
    assert_compared(&messages, &outcome, &expected);
    // A recording of an earlier version does not contain the restart of the agent.
    let is_ordered = |kept: &Kept| {
        kept.topic == CYCLE.path() && Cycle::decode(&kept.bytes[..]).unwrap().turn() == Turn::Ordered
    };
    let mut others = messages.clone();
    others.iter_mut().filter(|kept| is_ordered(kept)).for_each(|kept| kept.publisher = "another".into());
    let error = replay(list(channel().0), &others).err().unwrap();
    let reason =
        "agent `thrower` was removed and added again: the recording, of an earlier version, lacks the change";
    assert_eq!(error.to_string(), reason);
}

#[test]
fn in_real_time_a_removed_chart_restarts_from_its_start() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("m.srm");
    std::fs::write(&model, "m = Play . Play . Watch").unwrap();
    let model = model.display();
    let text = format!("<agent frequency='100'><name>mind</name><statechart>{model}</statechart></agent>");
    let messages = live_run(mind, &[change(Action::RemoveAgent, "mind"), adding(&text)]);
    let outcome = replay(mind(channel().0), &messages).unwrap();
    assert_eq!(outcome.differences, []);
    let expected = [
        ("mind", "test/news", 10),
        ("mind", "test/game", 3),
        ("mind", "monas/model", 2),
        ("mind", "monas/cycle", 4),
    ];
    assert_compared(&messages, &outcome, &expected);
}

#[test]
fn in_real_time_an_agent_is_restored_thread_by_thread() {
    let folder = tempfile::tempdir().unwrap();
    for (file, model) in [("m.srm", "m = Play . Watch"), ("n.srm", "n = Watch")] {
        std::fs::write(folder.path().join(file), model).unwrap();
    }
    let of = |elements: &str| {
        let text = format!("<agent frequency='100'><name>player</name>{elements}</agent>");
        let text = text.replace("F/", &format!("{}/", folder.path().display()));
        [change(Action::RemoveAgent, "player"), adding(&text)]
    };
    let same = "<activity>Throw</activity><activity>Say</activity><statechart>F/m.srm</statechart><statechart>F/n.srm</statechart>";
    let expected = [
        ("player", "test/news", 10),
        ("player", "test/ball", 1),
        ("player", "monas/model", 4),
        ("player", "monas/cycle", 4),
    ];
    let messages = live_run_until(player, &of(same), &expected);
    let outcome = replay(player(channel().0), &messages).unwrap();
    assert_eq!(outcome.differences, []);
    assert_compared(&messages, &outcome, &expected);
    let messages = live_run(player, &of("<statechart>F/n.srm</statechart>"));
    let error = replay(player(channel().0), &messages).err().unwrap().to_string();
    assert!(error.starts_with("agent `player` returned "), "{error}");
}

/// A chart agent to which activities are added.
fn with_a_list() -> [Change; 4] {
    let add = |activity: &str| Change { activity: activity.into(), ..change(Action::AddActivity, "mind") };
    [add("Say"), add("Play"), change(Action::PauseAgent, "mind"), change(Action::ResumeAgent, "mind")]
}

#[test]
fn in_real_time_a_list_begins_again_where_it_began() {
    // Only the list publishes balls.
    let expected = [("mind", "test/news", 20), ("mind", "test/game", 5), ("mind", "monas/cycle", 8)];
    let messages = live_run_until(mind, &with_a_list(), &expected);
    let outcome = replay(mind(channel().0), &messages).unwrap();
    assert_eq!(outcome.differences, []);
    assert_compared(&messages, &outcome, &expected);
    // An agent that is removed, restored without its list, gets one, and is restored with it.
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("m.srm");
    std::fs::write(&model, "m = Play . Watch").unwrap();
    let chart = format!("<statechart>{}</statechart>", model.display());
    let mind_of = |elements: &str| {
        adding(&format!("<agent frequency='100'><name>mind</name>{elements}{chart}</agent>"))
    };
    let [first, second, ..] = with_a_list();
    let leaves = || change(Action::RemoveAgent, "mind");
    let asked =
        [first.clone(), leaves(), mind_of(""), first, second, leaves(), mind_of("<activity>Say</activity>")];
    let expected = [("mind", "test/news", 30), ("mind", "monas/model", 3), ("mind", "monas/cycle", 8)];
    let messages = live_run_until(mind, &asked, &expected);
    let outcome = replay(mind(channel().0), &messages).unwrap();
    assert_eq!(outcome.differences, []);
    assert_compared(&messages, &outcome, &expected);
}

#[test]
fn in_real_time_a_list_without_a_recorded_start_is_rejected() {
    let [first, ..] = with_a_list();
    let mut messages = live_run(mind, &[first]);
    let is_ordered = |kept: &Kept| {
        kept.topic == CYCLE.path() && Cycle::decode(&kept.bytes[..]).unwrap().turn() == Turn::Ordered
    };
    messages.iter_mut().filter(|kept| is_ordered(kept)).for_each(|kept| kept.publisher = "another".into());
    let error = replay(mind(channel().0), &messages).err().unwrap().to_string();
    let reasons =
        ["agent `mind` got its first activity ", "the recording lacks the inputs of the turns of `mind`"];
    assert!(reasons.iter().any(|reason| error.starts_with(reason)), "{error}");
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
