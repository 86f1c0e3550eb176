//! An agent with several statecharts and a list: changes of one chart do not affect the others.

use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use monas::records::{Action, AgentEntry, Change};
use monas::{Progress, Registry, Simulation, Talws};
use tempfile::TempDir;

use crate::kit::{Recorder, at, recorder};
use crate::management::{change, made, refused, settings};
use crate::taped::{Tape, replay_simulated};

const TIMEOUT: Duration = Duration::from_secs(20);

/// Both charts call their activity every 100 ms; the list does every 200 ms.
const AGENT: &str = r#"<agent ThreadFrequency="5">
  <name>player</name>
  <activity>List</activity>
  <statechart Priority="3" Threads="1">legs.srm<activity speed="2">Legs</activity></statechart>
  <statechart ThreadFrequency="20" OnFailure="skip">head.srm</statechart>
</agent>
"#;

/// Records its name and speed at each call.
struct WorkingActivity<N> {
    word: &'static str,
    speed: f64,
    note: N,
}

impl<N: Fn(String) + Send> monas::Activity for WorkingActivity<N> {
    fn configure(&mut self, parameters: &monas::Parameters) {
        self.speed = parameters.number("speed").unwrap_or(1.0);
    }

    fn execute(&mut self, _: &mut monas::Blackboard) -> Result<Progress, monas::BoxError> {
        let WorkingActivity { word, speed, note } = self;
        note(format!("{word} {speed}"));
        Ok(Progress::after(Duration::from_millis(100)))
    }
}

fn registry(note: impl Fn(String) + Clone + Send + Sync + 'static) -> Registry {
    ["List", "Legs", "Head"].into_iter().fold(Registry::empty(), |registry, word| {
        let note = note.clone();
        registry.with(word, move || WorkingActivity { word, speed: 1.0, note: note.clone() })
    })
}

/// An agent of a text, beside the files of its charts.
fn player(text: &str, note: impl Fn(String) + Clone + Send + Sync + 'static) -> (Talws, TempDir) {
    let folder = TempDir::new().unwrap();
    for (file, model) in [("legs.srm", "moves = Legs"), ("head.srm", "looks = Head"), ("agents.xml", text)] {
        std::fs::write(folder.path().join(file), model).unwrap();
    }
    let registry = registry(note);
    let (setup, diagnostics) = monas::config::load(folder.path().join("agents.xml"), &registry);
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
    (Talws::new().registry(registry).setup(setup), folder)
}

fn simulated() -> (Simulation, Recorder<String>, TempDir) {
    let (notes, note) = recorder();
    let note = std::sync::Mutex::new(note);
    let note = std::sync::Arc::new(note);
    let (talws, folder) = player(AGENT, move |word| note.lock().unwrap()(word));
    (talws.simulate(1).unwrap(), notes, folder)
}

fn of_chart(action: Action, chart: &str) -> Change {
    Change { chart: chart.into(), ..change(action, "player") }
}

/// Occurrences of each word, in order.
fn counted(words: &[String]) -> Vec<(&str, usize)> {
    let mut known: Vec<&str> = words.iter().map(String::as_str).collect();
    known.sort_unstable();
    known.dedup();
    known.iter().map(|word| (*word, words.iter().filter(|name| name == word).count())).collect()
}

/// The entry of the agent. The simulation must advance for the reply to arrive.
#[expect(clippy::disallowed_methods, reason = "the request comes from another thread than the run")]
fn entry(simulation: &mut Simulation) -> AgentEntry {
    let overview = simulation.run_handle();
    let asking = std::thread::spawn(move || overview.agents(None).unwrap().remove(0));
    while !asking.is_finished() {
        simulation.run_until(simulation.now()).unwrap();
        std::thread::yield_now();
    }
    asking.join().unwrap()
}

fn states(entry: &AgentEntry) -> Vec<&str> {
    entry.charts.iter().map(|chart| chart.state.as_str()).collect()
}

#[test]
fn an_idle_chart_does_not_stop_the_list_and_the_other() {
    let (mut simulation, notes, _folder) = simulated();
    simulation.run_until(at(950)).unwrap();
    assert_eq!(counted(&notes.taken()), [("Head 1", 10), ("Legs 2", 10), ("List 1", 5)]);
    made(&simulation.change("local", of_chart(Action::StopAgent, "head.srm")).unwrap());
    simulation.run_until(at(1950)).unwrap();
    assert_eq!(counted(&notes.taken()), [("Legs 2", 10), ("List 1", 5)]);
    let shown = entry(&mut simulation);
    assert_eq!((shown.state.as_str(), states(&shown)), ("runs", vec!["runs", "stopped"]));
    let again = simulation.change("local", of_chart(Action::StopAgent, "2")).unwrap();
    let already = "statechart `head.srm` of `player` has stopped already";
    assert_eq!(refused(&again), ("E0352".into(), already.into()));
    made(&simulation.change("local", of_chart(Action::StartAgent, "head.srm")).unwrap());
    simulation.run_until(at(2950)).unwrap();
    assert_eq!(counted(&notes.taken()), [("Head 1", 10), ("Legs 2", 10), ("List 1", 5)]);
    assert_eq!(states(&entry(&mut simulation)), ["runs", "runs"]);
}

#[test]
fn changes_beyond_one_chart_are_rejected() {
    let (mut simulation, _, _folder) = simulated();
    for (asked, code, says) in [
        (
            of_chart(Action::PauseAgent, "head.srm"),
            "E0352",
            "this action is not available for a single statechart",
        ),
        (of_chart(Action::StartAgent, "head.srm"), "E0352", "`head.srm` of `player` has not stopped"),
        (
            of_chart(Action::StopAgent, "heat.srm"),
            "E0355",
            "has no statechart `heat.srm`; did you mean `head.srm`?",
        ),
        (of_chart(Action::StopAgent, "3"), "E0355", "has no statechart `3`"),
        (
            Change { settings: settings(&[("Legs.speed", "3")]), ..of_chart(Action::Set, "2") },
            "E0353",
            "the statechart `head.srm` has no activity `Legs`",
        ),
        (
            Change { settings: settings(&[("Head.sped", "3")]), ..of_chart(Action::Set, "2") },
            "E0314",
            "did you mean `speed`?",
        ),
        (
            Change { settings: settings(&[("workers", "3")]), ..of_chart(Action::Set, "2") },
            "E0304",
            "`workers` of a statechart applies only at its start",
        ),
    ] {
        let changed = simulation.change("local", asked.clone()).unwrap();
        let (found, message) = refused(&changed);
        assert!(found == code && message.contains(says), "{asked:?}: {found} {message}");
    }
    made(&simulation.change("local", change(Action::StopAgent, "player")).unwrap());
    let (_, message) = refused(&simulation.change("local", of_chart(Action::StopAgent, "2")).unwrap());
    assert!(message.starts_with("`player` has stopped; start it first"), "{message}");
}

#[test]
fn a_changed_chart_is_saved_and_restarts_with_its_settings() {
    let (mut simulation, notes, folder) = simulated();
    simulation.run_until(at(50)).unwrap();
    let set = |chart: &str, given: &[(&str, &str)]| Change {
        settings: settings(given),
        ..of_chart(Action::Set, chart)
    };
    made(
        &simulation
            .change(
                "local",
                set("2", &[("frequency", "50"), ("Head.speed", "4"), ("Head.on_failure", "restart")]),
            )
            .unwrap(),
    );
    // The list has no activity of that name, and one chart has.
    made(&simulation.change("local", set("", &[("Legs.speed", "5")])).unwrap());
    // Changes of the agent apply to the chart without its own settings.
    made(&simulation.change("local", set("", &[("frequency", "10"), ("on_failure", "stop-agent")])).unwrap());
    notes.taken();
    simulation.run_until(at(1050)).unwrap();
    assert_eq!(counted(&notes.taken()), [("Head 4", 10), ("Legs 5", 10), ("List 1", 10)]);
    let expected = AGENT
        .replace("<agent ThreadFrequency=\"5\"", "<agent ThreadFrequency=\"10\" OnFailure=\"stop-agent\"")
        .replace("speed=\"2\"", "speed=\"5\"")
        .replace("ThreadFrequency=\"20\"", "ThreadFrequency=\"50\"")
        .replace("head.srm<", "head.srm\n    <activity speed=\"4\" on_failure=\"restart\">Head</activity><");
    let overview = simulation.run_handle();
    #[expect(clippy::disallowed_methods, reason = "the request comes from another thread than the run")]
    let asking = std::thread::spawn(move || overview.configuration("local").unwrap().text);
    while !asking.is_finished() {
        simulation.run_until(simulation.now()).unwrap();
        std::thread::yield_now();
    }
    let saved = asking.join().unwrap();
    assert_eq!(saved, expected);
    // And the text is read as what it says.
    let (_, note) = recorder::<String>();
    let note = std::sync::Arc::new(std::sync::Mutex::new(note));
    drop(player(&saved, move |word| note.lock().unwrap()(word)));
    drop(folder);
    made(&simulation.change("local", of_chart(Action::StopAgent, "2")).unwrap());
    made(&simulation.change("local", of_chart(Action::StartAgent, "2")).unwrap());
    simulation.run_until(at(1100)).unwrap();
    assert!(notes.taken().contains(&"Head 4".to_owned()), "it begins anew with what was set of it");
}

#[test]
fn a_run_with_an_idle_chart_is_replayed() {
    let tape = Tape::default();
    let none = |_: String| {};
    let (mut talws, _folder) = player(AGENT, none);
    talws.observe(Box::new(tape.clone()));
    let mut simulation = talws.simulate(7).unwrap();
    for (moment, asked) in [
        (150, of_chart(Action::StopAgent, "1")),
        (350, Change { settings: settings(&[("frequency", "40")]), ..of_chart(Action::Set, "2") }),
        (550, of_chart(Action::StartAgent, "1")),
    ] {
        simulation.change_at(at(moment), "local", asked).unwrap();
    }
    simulation.run_until(at(1000)).unwrap();
    let messages = tape.kept();
    let again = |messages| replay_simulated(player(AGENT, none).0, 7, messages).unwrap();
    let outcome = again(&messages);
    assert_eq!(outcome.differences, []);
    assert!(outcome.compared("player", "monas/cycle") > 40);
    // Without the changes it is another run.
    let others: Vec<_> = messages.iter().filter(|kept| kept.topic != "monas/change").cloned().collect();
    assert_ne!(again(&others).differences, []);
}

fn until(notes: &Receiver<String>, word: &str) {
    while notes.recv_timeout(TIMEOUT).unwrap() != word {}
}

#[test]
fn in_real_time_one_chart_is_idle_and_the_list_and_the_other_go_on() {
    let (sender, notes) = channel();
    let sender = std::sync::Arc::new(std::sync::Mutex::new(sender));
    let note = move |word: String| {
        let _ = sender.lock().unwrap().send(word);
    };
    let (talws, _folder) = player(AGENT, note);
    let running = talws.start().unwrap();
    let run = running.run_handle();
    let ask = |asked: Change| made(&run.change("local", asked).unwrap());
    for word in ["Head 1", "Legs 2", "List 1"] {
        until(&notes, word);
    }
    ask(of_chart(Action::StopAgent, "legs.srm"));
    notes.try_iter().for_each(drop);
    let after: Vec<String> = (0..12).map(|_| notes.recv_timeout(TIMEOUT).unwrap()).collect();
    assert!(!after.contains(&"Legs 2".to_owned()), "{after:?}");
    assert!(after.contains(&"Head 1".to_owned()) && after.contains(&"List 1".to_owned()), "{after:?}");
    let shown = run.agents(None).unwrap().remove(0);
    assert_eq!((shown.state.as_str(), states(&shown)), ("runs", vec!["stopped", "runs"]));
    assert!(!running.has_ended());
    // Both are idle, and so is the agent's list alone what runs.
    ask(of_chart(Action::StopAgent, "2"));
    notes.try_iter().for_each(drop);
    assert_eq!([0; 3].map(|_| notes.recv_timeout(TIMEOUT).unwrap()), ["List 1"; 3]);
    ask(Change { settings: settings(&[("Head.speed", "7")]), ..of_chart(Action::Set, "2") });
    ask(of_chart(Action::StartAgent, "2"));
    until(&notes, "Head 7");
    ask(of_chart(Action::StartAgent, "legs.srm"));
    until(&notes, "Legs 2");
    running.stop();
}

#[test]
fn an_activity_of_a_chart_has_its_own_policy_or_that_of_its_chart() {
    let failing = |chart: &str, of_agent: &str| {
        let registry = Registry::empty().with("Fails", || {
            |_: &mut monas::Blackboard| -> Result<Progress, monas::BoxError> { Err("no".into()) }
        });
        let folder = TempDir::new().unwrap();
        std::fs::write(folder.path().join("m.srm"), "m = Fails").unwrap();
        let text = format!("<agent OnFailure='{of_agent}'><name>a</name>{chart}</agent>");
        std::fs::write(folder.path().join("agents.xml"), text).unwrap();
        let (setup, diagnostics) = monas::config::load(folder.path().join("agents.xml"), &registry);
        assert!(diagnostics.is_empty(), "{diagnostics:?}");
        let mut simulation = Talws::new().registry(registry).setup(setup).simulate(1).unwrap();
        simulation.run_until(at(100)).unwrap();
        let agent = simulation.statistics().agents.remove(0);
        (agent.stopped.is_some(), agent.activities[0].failures)
    };
    let plain = "<statechart>m.srm</statechart>";
    let says = "<statechart OnFailure='stop-agent'>m.srm</statechart>";
    let itself =
        "<statechart OnFailure='stop-agent'>m.srm<activity on_failure='skip'>Fails</activity></statechart>";
    assert_eq!(failing(plain, "restart"), (false, 4), "at once, and after 10, 30 and 70 ms");
    assert_eq!(failing(plain, "stop-agent"), (true, 1));
    assert_eq!(failing(says, "restart"), (true, 1));
    assert_eq!(
        failing(itself, "restart"),
        (false, 1),
        "one that is skipped is not called again in its state"
    );
}
