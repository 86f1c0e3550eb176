//! Layers: default, file, robot, command line.

use monas::config::{self, Element, Grammar, Layer, Layers, Resolved};
use yase::Source;

const FILE: &str = "<agents>\n<agent thread_frequency=10 priority=1><name>Motion</name>\n<activity gait=slow>Walk</activity></agent>\n\
                    <provider thread_frequency=5>Sensors</provider></agents>";

fn robot(text: &str) -> Vec<Element> {
    Grammar::agents().parse(&Source::new("robots/one.xml", text)).0
}

fn set(layers: Layers, settings: &[&str]) -> Layers {
    settings.iter().fold(layers, |layers, setting| layers.set(setting, &Grammar::agents()).unwrap())
}

fn resolve(layers: &Layers) -> Resolved {
    config::resolve_text(&Source::new("agents.xml", FILE), &Grammar::agents(), layers)
}

/// The value at a path, and its origin.
fn value(resolved: &Resolved, path: &str) -> (String, Layer, String) {
    let entries = config::entries(&resolved.elements, &Grammar::agents());
    let entry =
        entries.iter().find(|entry| entry.path == path).unwrap_or_else(|| panic!("{path} in {entries:#?}"));
    (entry.value.clone().unwrap(), entry.layer, entry.origin())
}

fn expected(value: &str, layer: Layer, origin: &str) -> (String, Layer, String) {
    (value.to_owned(), layer, origin.to_owned())
}

#[test]
fn each_layer_goes_over_those_below_it() {
    let frequency = "agent.Motion.thread_frequency";
    let plain = resolve(&Layers::new());
    assert_eq!(value(&plain, frequency), expected("10", Layer::File, "agents.xml:2:25"));
    assert_eq!(value(&plain, "agent.Motion.enable"), expected("1", Layer::Default, "default"));

    let over = robot(
        "<agent ThreadFrequency='20' workers=2><name>Motion</name><activity gait=quick/></agent>"
            .replace("<activity gait=quick/>", "<activity gait=quick>Walk</activity>")
            .as_str(),
    );
    let layers = Layers::new().robot(over);
    let of_robot = resolve(&layers);
    assert_eq!(of_robot.diagnostics, []);
    assert_eq!(value(&of_robot, frequency), expected("20", Layer::Robot, "robots/one.xml:1:25 (robot)"));
    assert_eq!(value(&of_robot, "agent.Motion.workers").1, Layer::Robot);
    assert_eq!(value(&of_robot, "agent.Motion.activity.Walk.gait").0, "quick");
    assert_eq!(value(&of_robot, "agent.Motion.priority").1, Layer::File);

    let set =
        resolve(&set(layers, &["agent.Motion.frequency=50", "agent.Motion.activity.Walk.gait=odd = yes"]));
    let origin = "--set agent.Motion.frequency=50";
    assert_eq!(value(&set, frequency), expected("50", Layer::CommandLine, origin));
    assert_eq!(value(&set, "agent.Motion.activity.Walk.gait").0, "odd = yes");
    assert!(set.diagnostics.is_empty() && set.unmatched.is_empty());
}

#[test]
fn a_robot_may_have_more_agents_and_leave_some_out() {
    let over = robot(
        "<agent thread_frequency=1><name>More</name><activity>Vision</activity></agent><provider enable=0>Sensors</provider>",
    );
    let resolved = resolve(&Layers::new().robot(over));
    assert_eq!(value(&resolved, "agent.More.thread_frequency").1, Layer::Robot);
    assert_eq!(value(&resolved, "provider.Sensors.enable").0, "0");
    assert_eq!(value(&resolved, "provider.Sensors.thread_frequency").1, Layer::File);
}

#[test]
fn the_last_setting_of_a_value_holds() {
    let resolved = resolve(&set(Layers::new(), &["agent.Motion.priority=2", "agent.Motion.priority=3"]));
    assert_eq!(value(&resolved, "agent.Motion.priority").0, "3");
}

#[test]
fn a_setting_of_a_missing_element_is_reported() {
    let findings = |setting: &str| {
        let resolved = resolve(&set(Layers::new(), &[setting]));
        resolved.into_diagnostics().iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(
        findings("agent.Moton.priority=2"),
        ["--set:1:7: error[E0341]: there is no `agent` `Moton` (did you mean `Motion`?)"]
    );
    assert_eq!(
        findings("agent.Motion.activity.Wlk.gait=x"),
        ["--set:1:23: error[E0341]: there is no `activity` `Wlk` (did you mean `Walk`?)"]
    );
    assert_eq!(
        findings("link.blue.beat=1s"),
        ["--set:1:6: error[E0341]: there is no `link` `blue` (there is no `link` at all)"]
    );
    assert_eq!(findings("agent.Motion.prio=2").len(), 1);
    assert_eq!(
        findings("agent.Motion.priority=high"),
        ["--set:1:23: error[E0306]: `priority` is `high`, expected a whole number"]
    );
}

#[test]
fn a_setting_without_a_path_is_reported() {
    let findings = |setting: &str| Layers::new().set(setting, &Grammar::agents()).unwrap_err().to_string();
    let how = "write `agent.NAME.priority=2`: a path, `=` and a value";
    for (setting, expected) in [
        ("agent.Motion.priority", format!("--set:1:1: error[E0340]: `agent.Motion.priority` is not a path with a value ({how})")),
        ("", format!("--set:1:1: error[E0340]: `` is not a path with a value ({how})")),
        ("agnt.Motion.priority=2", "--set:1:1: error[E0340]: there is no setting `agnt` (did you mean `agent`?)".into()),
        ("agent=2", "--set:1:1: error[E0340]: the setting does not name the `agent` (write `agent.NAME.thread_frequency=VALUE`)".into()),
        ("agent.Motion=2", "--set:1:1: error[E0340]: the setting does not name an attribute of `agent` (write `agent.NAME.thread_frequency=VALUE`)".into()),
        ("agent.Motion.activty.Walk.gait=2", "--set:1:14: error[E0340]: `agent` holds no `activty` (did you mean `activity`?)".into()),
        ("agent.Motion.name=Other", "--set:1:14: error[E0340]: the `name` of `agent` identifies it and cannot be set (change it in the file)".into()),
    ] {
        assert_eq!(findings(setting), expected);
    }
}

#[test]
fn names_with_dots_stand_in_quotes() {
    let text = "<agent><name>a</name><statechart>models/goalie.srm</statechart></agent>";
    let layers = set(Layers::new(), &["agent.a.statechart.\"models/goalie.srm\".enable=0"]);
    let resolved = config::resolve_text(&Source::new("a.xml", text), &Grammar::agents(), &layers);
    assert!(resolved.unmatched.is_empty() && resolved.diagnostics.is_empty(), "{resolved:#?}");
    // A shown value can be set.
    assert_eq!(value(&resolved, "agent.a.statechart.\"models/goalie.srm\".enable").0, "0");
}

/// Every listed value of a valid configuration can be set to itself without effect.
#[test]
fn every_value_that_is_shown_can_be_set() {
    let grammar = Grammar::agents();
    let plain = resolve(&Layers::new());
    for entry in config::entries(&plain.elements, &grammar) {
        let Some(value) = entry.value else { continue };
        let resolved = resolve(&set(Layers::new(), &[&format!("{}={value}", entry.path)]));
        assert!(
            resolved.unmatched.is_empty() && resolved.diagnostics.is_empty(),
            "{}: {resolved:?}",
            entry.path
        );
        let all = |resolved: &Resolved| {
            let mut all: Vec<_> = config::entries(&resolved.elements, &grammar)
                .into_iter()
                .map(|one| (one.path, one.value))
                .collect();
            all.sort();
            all
        };
        assert_eq!(all(&resolved), all(&plain), "{}", entry.path);
    }
}
