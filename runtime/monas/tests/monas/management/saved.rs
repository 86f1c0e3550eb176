//! Saving the configuration of a run: the text contains the changes and is otherwise unchanged.

use monas::records::{Action, Change};
use monas::{Registry, Simulation, Talws};
use yase::Source;

use crate::kit::{at, recorder};
use crate::management::{change, made, reporting, settings};

fn registry() -> Registry {
    reporting(&["A", "B", "C", "P"], recorder().1)
}

const TEXT: &str = r#"<?xml version="1.0" ?>
<!-- who plays -->
<agents>
  <agent ThreadFrequency=10 StatsCycle=15> <!-- as the thesis prints it -->
    <name>a</name>
    <activity>A</activity> <!-- first of all -->
    <!-- then -->
    <activity speed='1'>B</activity>
    <activity Enable="0">C</activity>
  </agent>
  <provider frequency="20">P</provider>
  <agent frequency="5"><name>gone</name><activity>A</activity></agent>
  <link name="x" enable="0"><send topics="test/ball"/></link>
</agents>
"#;

fn simulation(text: &str) -> Simulation {
    let registry = registry();
    let (setup, diagnostics) = monas::config::read(&Source::new("a.xml", text), "a.xml".as_ref(), &registry);
    assert_eq!(diagnostics, []);
    Talws::new().registry(registry).setup(setup).simulate(1).unwrap()
}

/// The saved configuration. The simulation must advance for the reply to arrive.
#[expect(clippy::disallowed_methods, reason = "the request comes from another thread than the run")]
fn saved(simulation: &mut Simulation) -> String {
    let overview = simulation.run_handle();
    let asking = std::thread::spawn(move || overview.configuration("local").unwrap().text);
    while !asking.is_finished() {
        simulation.run_until(simulation.now()).unwrap();
        std::thread::yield_now();
    }
    asking.join().unwrap()
}

#[test]
fn unchanged_parts_are_saved_byte_by_byte() {
    assert_eq!(saved(&mut simulation(TEXT)), TEXT);
    let camel = "<agent IsRealTime=1 Priority=1 ThreadFrequency=10 StatsCycle=15>\n  <name>M</name>\n  <activity>A</activity>\n</agent>\n<agent frequency=1e1><name>N</name>\n</agent>";
    let camel = camel.replace("\n</agent>\n<agent frequency=1e1><name>N</name>\n</agent>", "\n</agent>");
    assert_eq!(saved(&mut simulation(&camel)), camel);
}

#[test]
fn changes_are_written_in_the_style_of_their_neighbours() {
    let mut simulation = simulation(TEXT);
    let mut ask = |change: Change| made(&simulation.change("local", change).unwrap());
    let given =
        settings(&[("frequency", "50"), ("priority", "2"), ("B.speed", "0.5"), ("B.on_failure", "skip")]);
    ask(Change { settings: given, ..change(Action::Set, "a") });
    ask(Change { activity: "A".into(), place: 2, ..change(Action::MoveActivity, "a") });
    let parameters = settings(&[("speed", "3")]);
    ask(Change { activity: "C".into(), settings: parameters, ..change(Action::AddActivity, "a") });
    ask(Change { settings: settings(&[("on_failure", "skip")]), ..change(Action::Set, "P") });
    ask(change(Action::RemoveAgent, "gone"));
    let text = "<agent frequency='1' workers='2'><name>new</name><activity>A</activity></agent>";
    ask(Change { text: text.into(), ..change(Action::AddAgents, "") });
    let expected = r#"<?xml version="1.0" ?>
<!-- who plays -->
<agents>
  <agent ThreadFrequency="50" StatsCycle=15 Priority="2"> <!-- as the thesis prints it -->
    <name>a</name>
     <!-- first of all -->
    <!-- then -->
    <activity speed='0.5' on_failure="skip">B</activity>
    <activity>A</activity>
    <activity speed="3">C</activity>
    <activity Enable="0">C</activity>
  </agent>
  <provider frequency="20" on_failure="skip">P</provider>
  <link name="x" enable="0"><send topics="test/ball"/></link>
  <agent thread_frequency="1" workers="2">
    <name>new</name>
    <activity>A</activity>
  </agent>
</agents>
"#;
    simulation.run_until(at(10)).unwrap();
    let text = saved(&mut simulation);
    assert_eq!(text, expected);
    // The saved text describes the running agents.
    assert_eq!(saved(&mut self::simulation(&text)), text);
}

#[test]
fn a_provider_that_has_become_more_is_saved_as_an_agent() {
    let mut simulation = simulation("<provider frequency=\"20\">P</provider>\n");
    made(
        &simulation
            .change("local", Change { activity: "A".into(), ..change(Action::AddActivity, "P") })
            .unwrap(),
    );
    let expected = "<agent thread_frequency=\"20\">\n  <name>P</name>\n  <activity>P</activity>\n  <activity>A</activity>\n</agent>\n";
    assert_eq!(saved(&mut simulation), expected);
}

#[test]
fn values_not_read_from_xml_are_written_from_scratch() {
    let registry = registry();
    let text = "[[agent]]\nname = 'a<b'\nfrequency = 10\nactivity = [{ name = 'A', speed = 2 }]\n";
    let (setup, diagnostics) =
        monas::config::read(&Source::new("a.toml", text), "a.toml".as_ref(), &registry);
    assert_eq!(diagnostics, []);
    let mut simulation = Talws::new().registry(registry).setup(setup).simulate(1).unwrap();
    let expected = "<?xml version=\"1.0\" ?>\n<agents>\n  <agent thread_frequency=\"10\">\n    <name>a&lt;b</name>\n    <activity speed=\"2\">A</activity>\n  </agent>\n</agents>\n";
    assert_eq!(saved(&mut simulation), expected);
}
