//! Activities that panic during construction or configuration: the requester receives an error, and
//! all agents continue.

use std::cell::Cell;

use monas::records::{Action, Change};
use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Registry, Simulation, Talws, config};
use yase::Source;

use crate::kit::{Recorder, at, recorder};
use crate::management::{change, made, refused, settings};

/// Panics at some speeds, and at any speed once it has started.
struct FragileActivity<N> {
    note: N,
    has_begun: Cell<bool>,
}

impl<N: FnMut(&'static str) + Send> Activity for FragileActivity<N> {
    fn configure(&mut self, parameters: &Parameters) {
        let speed = parameters.number("speed").unwrap_or(1.0);
        assert!(speed < 2.0, "it is too fast");
        assert!(!self.has_begun.get(), "it is too late");
    }

    fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
        self.has_begun.set(true);
        (self.note)("works");
        Ok(Progress::Done)
    }
}

fn registry(note: impl FnMut(&'static str) + Clone + Send + Sync + 'static) -> Registry {
    Registry::empty()
        .with("Fragile", move || FragileActivity { note: note.clone(), has_begun: Cell::new(false) })
        .with("Unmade", || -> fn(&mut Blackboard) { panic!("there is no camera") })
}

const AGENT: &str = "<agent frequency='10'><name>a</name><activity>Fragile</activity></agent>";

fn simulation() -> (Simulation, Recorder<&'static str>) {
    let (notes, note) = recorder();
    let note = std::sync::Arc::new(std::sync::Mutex::new(note));
    let registry = registry(move |word| note.lock().unwrap()(word));
    let (setup, wrong) = config::read(&Source::new("a.xml", AGENT), "a.xml".as_ref(), &registry);
    assert_eq!(wrong, []);
    (Talws::new().registry(registry).setup(setup).simulate(1).unwrap(), notes)
}

#[test]
fn in_a_configuration_it_is_a_diagnostic() {
    let text = "<agent frequency='10'>\n<name>a</name>\n<activity speed='3'>Fragile</activity>\n<activity>Unmade</activity>\n</agent>";
    let (_, wrong) = config::read(&Source::new("a.xml", text), "a.xml".as_ref(), &registry(|_| {}));
    let wrong: Vec<String> = wrong.iter().map(ToString::to_string).collect();
    assert_eq!(wrong.len(), 2, "{wrong:?}");
    assert_eq!(wrong[0], "a.xml:3:2: error[E0315]: activity `Fragile`: panicked: it is too fast");
    assert!(wrong[1].starts_with("a.xml:4:11: error[E0312]: activity `Unmade` of "), "{wrong:?}");
    assert!(wrong[1].ends_with("cannot be made: panicked: there is no camera"), "{wrong:?}");
}

#[test]
fn a_rejected_change_has_a_reason() {
    let (mut simulation, notes) = simulation();
    let set = Change { settings: settings(&[("Fragile.speed", "3")]), ..change(Action::Set, "a") };
    let add = Change { activity: "Unmade".into(), ..change(Action::AddActivity, "a") };
    let mut why = |change| refused(&simulation.change("local", change).unwrap());
    assert_eq!(why(set), ("E0315".into(), "activity `Fragile`: panicked: it is too fast".into()));
    let (code, reason) = why(add);
    assert!(code == "E0364" && reason.ends_with("panicked: there is no camera"), "{code} {reason}");
    simulation.run_until(at(200)).unwrap();
    assert_eq!(notes.taken(), ["works", "works"]);
}

#[test]
fn an_activity_that_panics_on_a_taken_value_continues() {
    let (mut simulation, notes) = simulation();
    simulation.run_until(at(100)).unwrap();
    let set = Change { settings: settings(&[("Fragile.speed", "1.5")]), ..change(Action::Set, "a") };
    made(&simulation.change("local", set).unwrap());
    simulation.run_until(at(200)).unwrap();
    assert_eq!(notes.taken(), ["works", "works"]);
}
