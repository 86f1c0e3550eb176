//! Tests of modules in simulated time; the test program loads them.

use std::fs;
use std::path::Path;

use monas::records::{Action, Change, Changed};
use monas::{Agent, Hz, ModuleFile, Registry, Simulation, Talws, config};
use monas_soccer::Ball;
use monas_soccer::topics::BALL;

use crate::built::{blind_eyes, eyes, sharp_eyes};

/// The latest message about the ball.
fn ball(simulation: &Simulation) -> Ball {
    let mut board = simulation.hub(Talws::LOCAL).expect("the host").blackboard("test");
    board.process_messages(simulation.now());
    *board.read(BALL).expect("it was published")
}

fn run_for(simulation: &mut Simulation, seconds: f64) {
    let end = simulation.now() + std::time::Duration::from_secs_f64(seconds);
    simulation.run_until(end).expect("it runs");
}

fn change(simulation: &mut Simulation, action: Action, change: Change) -> Changed {
    let change = Change { action: action.into(), ..change };
    simulation.change(Talws::LOCAL, change).expect("the host is there")
}

fn of_file(file: &Path) -> Change {
    Change { file: file.display().to_string(), module: "eyes".into(), ..Change::default() }
}

/// The reasons for a rejected change.
fn reasons(changed: &Changed) -> String {
    assert!(!changed.done, "{changed:?}");
    changed.findings.iter().map(|one| format!("{}: {} ({})\n", one.code, one.message, one.hint)).collect()
}

/// An agent without the module.
fn blind_robot() -> Simulation {
    let agent = Agent::new("Head", Hz(10)).activity(|_: &mut monas::Blackboard| {});
    Talws::new().agent(agent).simulate(7).expect("it starts")
}

#[test]
fn messages_of_a_module_are_read_with_their_types() {
    let module = ModuleFile::read(eyes()).and_then(|file| file.load()).expect("it fits");
    assert_eq!((module.name(), module.activity_names().collect::<Vec<_>>()), ("eyes", vec!["Eyes"]));
    let registry = Registry::linked().with_module(module).expect("no name is taken");
    let eyes = registry.activity("Eyes").expect("it is made");
    let talws = Talws::new().agent(Agent::new("Head", Hz(10)).named_activity("Eyes", eyes));
    let mut simulation = talws.simulate(7).expect("it starts");
    run_for(&mut simulation, 1.0);
    assert_eq!((ball(&simulation).found, ball(&simulation).distance), (true, 2.0));
}

#[test]
fn a_constructor_that_panics_is_reported_without_effect() {
    let module = ModuleFile::read(blind_eyes()).and_then(|file| file.load()).expect("it fits");
    let registry = Registry::linked().with_module(module).expect("no name is taken");
    let error = registry.activity("Eyes").err().expect("it cannot be made");
    assert!(error.to_string().ends_with("cannot be made: panicked: no lens"), "{error}");
}

#[test]
fn a_file_that_was_built_otherwise_is_refused_before_it_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut bytes = fs::read(eyes()).expect("it was built");
    // Corrupts the fields of the note in place.
    for (there, instead) in [("opt-level", "opt-lavel"), ("\nlock ", "\nl0ck ")] {
        let at = note_at(&bytes, there);
        bytes[at..at + instead.len()].copy_from_slice(instead.as_bytes());
    }
    let file = folder.path().join("eyes.so");
    fs::write(&file, bytes).expect("the folder takes files");
    let mut simulation = blind_robot();
    let said = reasons(&change(&mut simulation, Action::LoadModule, of_file(&file)));
    for part in [
        "E0361: module `eyes` does not fit this program: profile is `",
        "opt-lavel",
        "expected `",
        "opt-level",
    ] {
        assert!(said.contains(part), "{said}");
    }
    assert!(said.contains("lock is ``, expected `") && said.contains("`monas module build`"), "{said}");
    fs::write(&file, "no module").expect("the folder takes files");
    assert!(reasons(&change(&mut simulation, Action::LoadModule, of_file(&file))).contains("E0360: "));
    let gone = of_file(&folder.path().join("gone.so"));
    assert!(reasons(&change(&mut simulation, Action::LoadModule, gone)).contains("gone.so: No such file"));
}

/// The position of a text in the note of a file.
fn note_at(bytes: &[u8], text: &str) -> usize {
    let begin = b"format 1\ncompiler rustc";
    let notes = (0..bytes.len() - begin.len()).filter(|at| bytes[*at..].starts_with(begin));
    let mut found = notes
        .map(|at| (at, &bytes[at..bytes.len().min(at + 600)]))
        .filter(|(_, note)| note.windows(12).any(|part| part == b"\nmodule eyes"));
    let (at, note) = found.next_back().expect("it has a note");
    at + note.windows(text.len()).position(|part| part == text.as_bytes()).expect("the note says so")
}

#[test]
fn lists_and_charts_go_on_with_the_new_instances() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("looker.srm");
    fs::write(&model, "Role: looker\nLiveness:\nlooker = Eyes~\n").expect("the folder takes files");
    let mut simulation = blind_robot();
    let loaded =
        change(&mut simulation, Action::LoadModule, Change { agent: "Head".into(), ..of_file(&eyes()) });
    assert!(loaded.done, "{loaded:?}");
    let again = change(&mut simulation, Action::LoadModule, of_file(&eyes()));
    assert!(reasons(&again).contains("E0365: module `eyes` is loaded already"));
    let settings = vec![monas::records::Setting { key: "Eyes.range".into(), value: "1.5".into() }];
    let set = Change { agent: "Head".into(), settings, ..Change::default() };
    assert!(change(&mut simulation, Action::Set, set).done);
    run_for(&mut simulation, 1.0);
    assert_eq!((ball(&simulation).found, ball(&simulation).distance), (false, 2.0), "it is too far away");

    let text = format!("<agent><name>Mind</name><statechart>{}</statechart></agent>", model.display());
    let added = change(&mut simulation, Action::AddAgents, Change { text, ..Change::default() });
    assert!(added.done, "{added:?}");
    run_for(&mut simulation, 1.0);
    assert!(
        change(&mut simulation, Action::PauseAgent, Change { agent: "Head".into(), ..Change::default() })
            .done
    );
    run_for(&mut simulation, 0.1);
    assert!(ball(&simulation).found, "the chart's own instance sees further");

    let blind = change(&mut simulation, Action::ReloadModule, of_file(&blind_eyes()));
    assert!(
        reasons(&blind).contains("E0364: activity `Eyes` of blind_eyes cannot be made: panicked: no lens")
    );
    run_for(&mut simulation, 0.1);
    assert_eq!(ball(&simulation).distance, 2.0, "the old ones go on");
    let sharp = change(&mut simulation, Action::ReloadModule, of_file(&sharp_eyes()));
    assert!(sharp.done, "{sharp:?}");
    run_for(&mut simulation, 0.1);
    assert_eq!((ball(&simulation).found, ball(&simulation).distance), (true, 1.0), "the chart has new ones");

    let unload = || Change { module: "eyes".into(), ..Change::default() };
    let needed = change(&mut simulation, Action::UnloadModule, unload());
    assert!(reasons(&needed).contains("E0365: the statechart `"), "{needed:?}");
    assert!(
        change(&mut simulation, Action::RemoveAgent, Change { agent: "Mind".into(), ..Change::default() })
            .done
    );
    let gone = change(&mut simulation, Action::UnloadModule, unload());
    assert!(gone.done, "{gone:?}");
    let unknown = change(&mut simulation, Action::UnloadModule, unload());
    assert!(reasons(&unknown).contains("E0365: no module `eyes` is loaded"));
}

#[test]
fn the_file_that_is_loaded_is_the_one_that_was_meant() {
    let mut simulation = blind_robot();
    let digest = ModuleFile::read(sharp_eyes()).expect("it is one").digest();
    let other = change(&mut simulation, Action::LoadModule, Change { digest, ..of_file(&eyes()) });
    assert!(reasons(&other).contains("E0365: ") && reasons(&other).contains("is not the requested file"));
    let digest = ModuleFile::read(eyes()).expect("it is one").digest();
    assert!(change(&mut simulation, Action::LoadModule, Change { digest, ..of_file(&eyes()) }).done);
}

/// A configuration in its own folder.
fn configured(name: &str, text: &str) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::copy(eyes(), folder.path().join("eyes.so")).expect("it was built");
    let path = folder.path().join(name);
    fs::write(&path, text).expect("the folder takes files");
    (folder, path)
}

#[test]
fn a_configuration_names_modules_beside_itself() {
    let agent = "<agent frequency='10'><name>Head</name><activity range='1'>Eyes</activity></agent>";
    let toml = "module = [\"eyes.so\"]\n[[agent]]\nname = \"Head\"\nfrequency = 10\n[[agent.activity]]\nname = \"Eyes\"\nrange = 1\n";
    let xml = format!("<agents>{agent}<module>eyes.so</module></agents>");
    for (name, text) in [("robot.xml", xml.as_str()), ("robot.toml", toml)] {
        let (_folder, path) = configured(name, text);
        let talws = Talws::from_config(&path, Registry::linked());
        let mut simulation =
            talws.unwrap_or_else(|error| panic!("{name}: {error}")).simulate(7).expect("it starts");
        run_for(&mut simulation, 1.0);
        assert_eq!((ball(&simulation).found, ball(&simulation).distance), (false, 2.0), "{name}");
        // The run identifies it by its name.
        assert!(change(&mut simulation, Action::ReloadModule, of_file(&sharp_eyes())).done, "{name}");
        run_for(&mut simulation, 1.0);
        assert_eq!((ball(&simulation).found, ball(&simulation).distance), (true, 1.0), "{name}");
    }
}

#[test]
fn module_errors_are_reported_at_the_reference() {
    let text =
        "<module>eye.so</module>\n<module enable='0'>nowhere.so</module>\n<module>robot.xml</module>\n";
    let (_folder, path) = configured("robot.xml", text);
    let (setup, diagnostics) = config::load(&path, &Registry::linked());
    let said: Vec<String> = diagnostics.iter().map(ToString::to_string).collect();
    assert_eq!((setup.modules.len(), said.len()), (0, 2), "{said:?}");
    assert!(
        said[0].contains("robot.xml:1:9: error[E0316]: no module `eye.so` (did you mean `eyes.so`?)"),
        "{said:?}"
    );
    assert!(said[1].contains("robot.xml:3:9: error[E0360]: "), "{said:?}");
    let (_folder, path) = configured("robot.xml", "<module>eyes.so</module>\n<module>./eyes.so</module>\n");
    let (setup, diagnostics) = config::load(&path, &Registry::linked());
    assert_eq!((setup.modules.len(), diagnostics.len()), (2, 0), "one file is loaded once: {diagnostics:?}");
}
