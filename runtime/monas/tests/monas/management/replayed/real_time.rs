//! Replay of changes made in real time, between the recorded turns of each agent.

use std::sync::mpsc::{Sender, channel};
use std::time::Duration;

use monas::records::{Action, CHANGE, CYCLE, Change, Cycle, Turn};
use monas::{Agent, Blackboard, BoxError, Hz, MicroStep, Progress, Registry, Talws};
use narukom::prost::Message as _;
use yase::{Source, Statechart};

use super::{Throw, adding, assert_compared, recorded, registry, with_a_list};
use crate::kit::{BALL, Ball, NEWS};
use crate::management::{change, made, settings};
use crate::taped::{Kept, Tape, replay};

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
    let is_there = |(agent, topic, min): &(&str, &str, usize)| recorded(&tape.kept(), agent, topic) >= *min;
    while !expected.iter().all(is_there) {
        calls.recv_timeout(Duration::from_secs(20)).unwrap();
    }
    running.stop();
    tape.kept()
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
        let expected: Vec<_> = topics.iter().map(|(topic, min)| (agent, *topic, *min)).collect();
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
    let [first, second, ..] = with_a_list();
    // The chart plays once: more is published by the list.
    let mut messages = live_run_until(mind, &[first, second], &[("mind", "test/game", 3)]);
    let is_ordered = |kept: &Kept| {
        kept.topic == CYCLE.path() && Cycle::decode(&kept.bytes[..]).unwrap().turn() == Turn::Ordered
    };
    messages.iter_mut().filter(|kept| is_ordered(kept)).for_each(|kept| kept.publisher = "another".into());
    let error = replay(mind(channel().0), &messages).err().unwrap().to_string();
    let reasons =
        ["agent `mind` got its first activity ", "the recording lacks the inputs of the turns of `mind`"];
    assert!(reasons.iter().any(|reason| error.starts_with(reason)), "{error}");
}

/// A chart whose activity `Wait` is called every 6 ms, while `Count` returns after 2 ms.
fn waiting(calls: Sender<()>) -> Talws {
    let wait = move || {
        let (calls, mut times) = (calls.clone(), 0.0);
        move |blackboard: &mut Blackboard| -> Result<Progress, BoxError> {
            times += 1.0;
            blackboard.publish(NEWS, Ball { x: times, y: blackboard.now().as_secs_f64(), found: true })?;
            // No receiver exists in a replay.
            let _ = calls.send(());
            Ok(Progress::after(Duration::from_millis(6)))
        }
    };
    let count = || {
        let mut times = 0;
        move |_: &mut Blackboard| {
            times += 1;
            if times < 3 { Progress::after(Duration::from_millis(1)) } else { Progress::Done }
        }
    };
    let rest = || |_: &mut Blackboard| Progress::after(Duration::from_secs(1));
    let registry = Registry::empty().with("Wait", wait).with("Count", count).with("Rest", rest);
    let agent = Agent::statechart("mind", chart("m = Wait || (Count . Rest)")).every(Hz(1000));
    Talws::new().registry(registry).agent(agent)
}

/// The thread of a chart is late: when it applies the change, both the next periodic step and the
/// next call are overdue, and only the step is no longer due after the change.
#[test]
fn in_real_time_a_late_thread_acts_after_the_change_also_in_the_replay() {
    let (sender, calls) = channel();
    let (begun, is_begun) = channel();
    let (_open, nothing) = channel::<()>();
    let tape = Tape::default();
    let blocks = move |step: MicroStep<'_>| {
        let statechart = step.chart.statechart();
        if step.record.entries.iter().any(|node| statechart.node(*node).name == "Rest") {
            begun.send(()).unwrap();
            // The change is requested meanwhile, and applied after this turn.
            let _ = nothing.recv_timeout(Duration::from_millis(15));
        }
    };
    let mut talws = waiting(sender);
    talws.listen(Box::new(blocks));
    talws.observe(Box::new(tape.clone()));
    let running = talws.start().unwrap();
    is_begun.recv_timeout(Duration::from_secs(20)).unwrap();
    let slower = Change { settings: settings(&[("frequency", "50")]), ..change(Action::Set, "mind") };
    made(&running.run_handle().change("local", slower).unwrap());
    calls.try_iter().for_each(drop);
    (0..3).for_each(|_| calls.recv_timeout(Duration::from_secs(20)).unwrap());
    running.stop();
    let messages = tape.kept();
    let outcome = replay(waiting(channel().0), &messages).unwrap();
    assert_eq!(outcome.differences, []);
    assert_compared(&messages, &outcome, &[("mind", "test/news", 4), ("mind", "monas/cycle", 3)]);
}
