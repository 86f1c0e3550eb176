//! Changes in simulated time: at a defined time, in a defined order, with equal bytes in each run.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use monas::records::{Action, CHANGE, CHANGED, Change, Changed};
use monas::{Agent, Blackboard, Hz, Progress, Registry, RunHash, Simulation, Talws};
use narukom::{Observer, Publication};
use yase::Source;

use crate::kit::{BALL, Ball, NEWS, Recorder, at, recorder};
use crate::management::{change, made, refused, reporting, settings};

/// An agent `a` with the activities A and B at 10 Hz, and their records.
fn simulation() -> (Simulation, Recorder<String>) {
    let (notes, note) = recorder();
    let registry = reporting(&["A", "B", "C"], note);
    let text = "<agent frequency='10'><name>a</name><activity>A</activity><activity>B</activity></agent>";
    let source = Source::new("agents.xml", text);
    let (setup, diagnostics) = monas::config::read(&source, "agents.xml".as_ref(), &registry);
    assert_eq!(diagnostics, []);
    let mut simulation = Talws::new().registry(registry).setup(setup).simulate(7).unwrap();
    simulation.run_until(at(100)).unwrap();
    assert_eq!(notes.taken(), ["A start", "A", "B start", "B"]);
    (simulation, notes)
}

fn ask(simulation: &mut Simulation, change: Change) -> Changed {
    simulation.change("local", change).unwrap()
}

#[test]
fn the_time_does_not_go_back_when_an_agent_resumes() {
    let (times, note) = recorder();
    let registry = Registry::empty().with("A", move || {
        let note = note.clone();
        move |blackboard: &mut Blackboard| {
            note(blackboard.now());
            Progress::after(Duration::from_millis(100))
        }
    });
    let chart = aseme_models::statechart_of(&Source::new("m.srm", "m = A")).0;
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart));
    let mut simulation = talws.simulate(1).unwrap();
    simulation.run_until(at(50)).unwrap();
    made(&simulation.change("local", change(Action::PauseAgent, "m")).unwrap());
    simulation.run_until(at(450)).unwrap();
    made(&simulation.change("local", change(Action::ResumeAgent, "m")).unwrap());
    simulation.run_until(at(600)).unwrap();
    assert_eq!(times.taken(), [at(0), at(450), at(550)]);
}

#[test]
fn activities_come_go_and_change_places_between_two_cycles() {
    let (mut simulation, notes) = simulation();
    let mut then = |change: Change, expected: &[&str]| {
        made(&ask(&mut simulation, change));
        let until = simulation.now() + Duration::from_millis(100);
        simulation.run_until(until).unwrap();
        assert_eq!(notes.taken(), expected);
    };
    let add = Change { activity: "C".into(), place: 1, ..change(Action::AddActivity, "a") };
    then(add, &["C start", "C", "A", "B"]);
    then(Change { activity: "1".into(), place: 3, ..change(Action::MoveActivity, "a") }, &["A", "B", "C"]);
    then(Change { activity: "A".into(), ..change(Action::RemoveActivity, "a") }, &["A stop", "B", "C"]);
    let replace =
        Change { activity: "C".into(), replacement: "A".into(), ..change(Action::ReplaceActivity, "a") };
    then(replace, &["C stop", "B", "A start", "A"]);
    then(Change { activity: "C".into(), ..change(Action::AddActivity, "a") }, &["B", "A", "C start", "C"]);
    let speed = settings(&[("A.speed", "0.5"), ("frequency", "20")]);
    // Another instance tries the value first.
    then(
        Change { settings: speed, ..change(Action::Set, "a") },
        &["A 0.5", "A 0.5", "B", "A", "C", "B", "A", "C"],
    );
}

#[test]
fn an_agent_pauses_steps_resumes_stops_and_starts() {
    let (mut simulation, notes) = simulation();
    made(&ask(&mut simulation, change(Action::PauseAgent, "a")));
    simulation.run_until(at(1000)).unwrap();
    assert_eq!(notes.taken(), [""; 0]);
    let stepped = ask(&mut simulation, change(Action::StepAgent, "a"));
    assert_eq!((stepped.done, stepped.cycle), (true, 2));
    assert_eq!(notes.taken(), ["A", "B"]);
    made(&ask(&mut simulation, change(Action::ResumeAgent, "a")));
    simulation.run_until(at(1101)).unwrap();
    // It was stepped at 1000 ms, where its next cycle would have been; what it missed is not made
    // up for.
    assert_eq!(notes.taken(), ["A", "B"]);
    made(&ask(&mut simulation, change(Action::StopAgent, "a")));
    assert_eq!(notes.taken(), ["A stop", "B stop"]);
    simulation.run_until(at(2000)).unwrap();
    assert_eq!(notes.taken(), [""; 0]);
    made(&ask(&mut simulation, change(Action::StartAgent, "a")));
    simulation.run_until(at(2100)).unwrap();
    assert_eq!(notes.taken(), ["A start", "A", "B start", "B"]);
    assert_eq!(simulation.statistics().agents[0].stopped, None, "it was requested, which is not a failure");
}

#[test]
fn impossible_changes_are_rejected_with_a_reason() {
    let (mut simulation, notes) = simulation();
    let of = |action, activity: &str| Change { activity: activity.into(), ..change(action, "a") };
    let set = |given: &[(&str, &str)]| Change { settings: settings(given), ..change(Action::Set, "a") };
    let cases = [
        (Change::default(), "E0350", "the change has no action"),
        (change(Action::StopAgent, "b"), "E0351", "no agent of `local` is named `b`; did you mean `a`?"),
        (change(Action::StartAgent, "a"), "E0352", "`a` has not stopped"),
        (change(Action::ResumeAgent, "a"), "E0352", "`a` runs already"),
        (
            change(Action::StepAgent, "a"),
            "E0352",
            "`a` runs; only a paused agent can be stepped: pause it first",
        ),
        (of(Action::AddActivity, "D"), "E0312", "unknown activity `D`; did you mean `A`?"),
        (of(Action::RemoveActivity, "C"), "E0353", "the list of `a` has no activity `C`; did you mean `A`?"),
        (
            Change { place: 4, ..of(Action::MoveActivity, "A") },
            "E0353",
            "there is no place 4: places are 1 to 2",
        ),
        (
            set(&[]),
            "E0353",
            "no setting is given; name an attribute, or a parameter of an activity: `frequency=50`, `Vision.speed=0.5`",
        ),
        (
            set(&[("frequency", "0.5"), ("priority", "high")]),
            "E0306",
            "`priority` is `high`, expected a whole number",
        ),
        (
            set(&[("frequncy", "50")]),
            "E0304",
            "an agent has no attribute `frequncy`; did you mean `frequency`?",
        ),
        (
            set(&[("A.speed", "quick")]),
            "E0315",
            "activity `A`: parameter `speed` is `quick`, expected a number",
        ),
        (set(&[("A.sped", "1")]), "E0314", "activity `A`: unknown parameter `sped`; did you mean `speed`?"),
        (change(Action::SwapModel, "a"), "E0355", "`a` has no statechart"),
    ];
    for (change, code, reason) in cases {
        let (found_code, found) = refused(&ask(&mut simulation, change.clone()));
        assert_eq!((found_code.as_str(), found.as_str()), (code, reason), "{change:?}");
    }
    assert_eq!(notes.taken(), [""; 0]);
    simulation.run_until(at(300)).unwrap();
    assert_eq!(notes.taken(), ["A", "B", "A", "B"]);
}

#[test]
fn agents_are_added_from_xml_and_toml_and_removed() {
    let (mut simulation, notes) = simulation();
    let add = |file: &str, text: &str| Change {
        file: file.into(),
        text: text.into(),
        ..change(Action::AddAgents, "")
    };
    let xml = "<agent frequency='10'>\n<name>b</name>\n<activity speed='2'>C</activity></agent>";
    made(&ask(&mut simulation, add("b.xml", xml)));
    made(&ask(&mut simulation, add("c.toml", "[[agent]]\nname = 'c'\nfrequency = 10\nactivity = ['C']")));
    assert_eq!(notes.taken(), ["C 2"]);
    simulation.run_until(at(200)).unwrap();
    assert_eq!(notes.taken(), ["A", "B", "C start", "C", "C start", "C"]);
    made(&ask(&mut simulation, change(Action::RemoveAgent, "b")));
    simulation.run_until(at(300)).unwrap();
    assert_eq!(notes.taken(), ["C stop", "A", "B", "C"]);

    let changed = ask(
        &mut simulation,
        add("d.xml", "<agent frequency='10'>\n<name>d</name>\n<activity>E</activity></agent>"),
    );
    let finding = &changed.findings[0];
    assert_eq!((changed.done, finding.file.as_str(), finding.line, finding.column), (false, "d.xml", 3, 11));
    assert_eq!(refused(&ask(&mut simulation, add("a.xml", &xml.replace(">b<", ">a<")))).0, "E0311");
    assert_eq!(
        refused(&ask(&mut simulation, add("", "<link name='x'><send topics='test/ball'/></link>"))).0,
        "E0358"
    );
}

#[test]
fn a_module_that_the_run_lacks_is_refused_before_its_file_is_read() {
    let (mut simulation, _) = simulation();
    // Not a module, which reading it would find out.
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    let text = format!("<agents><module>{file}</module></agents>");
    let changed = ask(&mut simulation, Change { text, ..change(Action::AddAgents, "") });
    let reason =
        "the text names a module that the run has not loaded; load it first: `monas module load FILE`";
    assert_eq!(refused(&changed), ("E0358".into(), reason.into()));
}

#[test]
fn changes_scheduled_between_two_advances_are_all_applied() {
    let (mut simulation, _) = simulation();
    let mut pause = |moment, agent: &str| {
        simulation.change_at(at(moment), "local", change(Action::PauseAgent, agent)).unwrap();
    };
    pause(150, "one");
    pause(250, "two");
    pause(250, "three");
    let mut asked = simulation.hub("local").unwrap().subscriber(CHANGE.path()).unwrap();
    simulation.run_until(at(200)).unwrap();
    simulation.change_at(at(250), "local", change(Action::PauseAgent, "four")).unwrap();
    simulation.run_until(at(300)).unwrap();
    let mut agents = Vec::new();
    while let Some(sample) = asked.next_sample() {
        agents.extend(sample.downcast::<Change>().map(|change| change.message.agent.clone()));
    }
    assert_eq!(agents, ["one", "two", "three", "four"]);
}

#[test]
fn an_agent_that_is_added_has_missed_the_signals_before_and_none_after() {
    let (notes, note) = recorder();
    let registry = Registry::empty().with("Note", move || {
        let note = note.clone();
        move |b: &mut Blackboard| {
            let state = b.read(BALL).map(|ball| ball.x);
            note((state, b.signals(NEWS).map(|news| news.x).collect::<Vec<f64>>()));
        }
    });
    let other = Agent::new("other", Hz(1)).activity(|_: &mut Blackboard| {});
    let mut simulation = Talws::new().registry(registry).agent(other).simulate(1).unwrap();
    let hub = simulation.hub("local").unwrap().clone();
    let (mut balls, mut news) =
        (hub.publisher(BALL, "outside").unwrap(), hub.publisher(NEWS, "outside").unwrap());
    let mut publish = |x: f64, millis| {
        balls.publish(Ball { x, ..Ball::default() }, at(millis));
        news.publish(Ball { x, ..Ball::default() }, at(millis));
    };
    publish(1.0, 0);
    simulation.run_until(at(25)).unwrap();
    publish(2.0, 25);
    let text = "<agent frequency='10'><name>late</name><activity>Note</activity></agent>".into();
    made(&ask(&mut simulation, Change { text, ..change(Action::AddAgents, "") }));
    publish(3.0, 25);
    simulation.run_until(at(150)).unwrap();
    publish(4.0, 150);
    simulation.run_until(at(201)).unwrap();
    assert_eq!(notes.taken(), [(Some(3.0), vec![3.0]), (Some(4.0), vec![4.0])]);
}

/// The changes and answers that are published.
#[derive(Clone, Default)]
struct PublicationLog(Arc<Mutex<Vec<String>>>);

impl Observer for PublicationLog {
    fn observe(&mut self, publication: Publication<'_>) {
        if [CHANGE.path(), CHANGED.path()].contains(&publication.topic.path()) {
            self.0.lock().unwrap().push(format!("{} {}", publication.publisher, publication.topic.path()));
        }
    }
}

/// The hash of a run with the same changes at the same times, or with none.
fn hash_of(with_changes: bool) -> (String, Vec<String>) {
    let (_, note) = recorder();
    let registry = reporting(&["A", "B"], note);
    let text = "<agent frequency='10'><name>a</name><activity>A</activity></agent>";
    let (setup, _) = monas::config::read(&Source::new("a.xml", text), "a.xml".as_ref(), &registry);
    let (hash, published) = (RunHash::new(), PublicationLog::default());
    let mut talws = Talws::new().registry(registry).setup(setup);
    talws.observe(Box::new(hash.clone())).observe(Box::new(published.clone()));
    let mut simulation = talws.simulate(7).unwrap();
    if with_changes {
        let add = Change { number: 1, activity: "B".into(), ..change(Action::AddActivity, "a") };
        simulation.change_at(at(250), "local", add).unwrap();
        simulation.change_at(at(700), "local", change(Action::StopAgent, "a")).unwrap();
        simulation.change_at(at(300), "local", change(Action::StopAgent, "unknown")).unwrap();
        assert!(simulation.change_at(at(1), "elsewhere", Change::default()).is_err());
    }
    simulation.run_until(at(1000)).unwrap();
    let published = published.0.lock().unwrap().clone();
    (hash.finish().0, published)
}

#[test]
fn the_same_script_gives_the_same_bytes_and_a_tape_has_changes_and_answers() {
    let (hash, published) = hash_of(true);
    assert_eq!(hash_of(true).0, hash);
    assert_ne!(hash_of(false).0, hash);
    assert_eq!(published, ["outside monas/change", "monas monas/changed"].repeat(3));
}

#[test]
fn an_activity_may_ask_for_a_change_too() {
    let asks = |blackboard: &mut Blackboard| {
        if blackboard.now() == at(200) {
            blackboard.publish(CHANGE, change(Action::StopAgent, "b")).unwrap();
        }
    };
    let (notes, note) = recorder();
    let b = move |blackboard: &mut Blackboard| note(blackboard.now());
    let agents = [("a", 10.0)].map(|(name, hertz)| Agent::new(name, Hz(hertz)).activity(asks));
    let talws = agents.into_iter().fold(Talws::new(), Talws::agent);
    let talws = talws.agent(Agent::new("b", Hz(10)).activity(b));
    talws.simulate(1).unwrap().run_until(at(1000)).unwrap();
    assert_eq!(notes.taken(), [at(0), at(100), at(200)]);
}
