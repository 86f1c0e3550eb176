//! TOML and XML with the same content give the same configuration and the same diagnostics, with
//! their own locations.

use std::path::Path;

use monas::config::{self, Grammar, Layers};
use yase::{Diagnostic, Source};

use crate::configuration::agents::registry;

const XML: &str = r#"<agents>
  <agent IsRealTime="1" Priority="1" ThreadFrequency="10" StatsCycle="15">
    <name>Motion</name>
    <activity>Vision</activity>
    <activity speed="0.5" careful="1">Walk</activity>
    <activity enable="0">Behavior</activity>
  </agent>
  <provider thread_frequency="100.5">Sensors</provider>
  <link name="blue-2" beat="50ms">
    <send topics="test/ball" priority="2"/>
    <receive topics="monas/host"/>
    <budget profile="spl" robots="5"/>
  </link>
</agents>"#;

const TOML: &str = r#"# the same
[[agent]]
name = "Motion"
is_real_time = true
priority = 1
ThreadFrequency = 10
stats_cycle = 0xF
activity = ["Vision", { name = "Walk", speed = 0.5, careful = 1 }]

[[agent.activity]]
name = "Behavior"
enable = false
"#;

/// A table after an array in brackets cannot be added to it, so that the rest has one form.
const REST: &str = r#"
[[provider]]
name = "Sensors"
thread_frequency = 100.5

[[link]]
name = "blue-2"
beat = "50ms"
send = { topics = "test/ball", priority = 2 }
receive = [{ topics = "monas/host" }]
budget = { profile = "spl", robots = 5 }
"#;

fn toml() -> String {
    TOML.replace(
        "careful = 1 }]\n\n[[agent.activity]]\nname = \"Behavior\"\nenable = false\n",
        "careful = 1 }, { name = \"Behavior\", enable = false }]\n",
    ) + REST
}

/// Every value with its path; booleans in one spelling.
fn values(name: &str, text: &str) -> Vec<(String, Option<String>)> {
    let resolved = config::resolve_text(&Source::new(name, text), &Grammar::agents(), &Layers::new());
    assert_eq!(resolved.diagnostics, []);
    let spelled = |value: String| match value.as_str() {
        "true" => "1".to_owned(),
        "false" => "0".to_owned(),
        _ => value,
    };
    config::entries(&resolved.elements, &Grammar::agents())
        .into_iter()
        .map(|entry| (entry.path, entry.value.map(spelled)))
        .collect()
}

#[test]
fn it_reaches_the_same_configuration() {
    assert_eq!(values("a.toml", &toml()), values("a.xml", XML));
    let agents = |name: &str, text: &str| {
        let (setup, diagnostics) = config::read(&Source::new(name, text), Path::new(name), &registry());
        assert_eq!(diagnostics, []);
        format!(
            "{:?}",
            (
                setup
                    .agents
                    .iter()
                    .map(|agent| (
                        agent.name().to_owned(),
                        agent.frequency(),
                        agent.scheduling(),
                        agent.activity_names().map(str::to_owned).collect::<Vec<_>>()
                    ))
                    .collect::<Vec<_>>(),
                &setup.links
            )
        )
    };
    assert_eq!(agents("a.toml", &toml()), agents("a.xml", XML));
}

/// Code, message and line of each diagnostic.
fn findings(name: &str, text: &str) -> Vec<(&'static str, String, String)> {
    let (_, diagnostics) = config::read(&Source::new(name, text), Path::new(name), &registry());
    let marked = |found: &Diagnostic| text[found.span.start..found.span.end].to_owned();
    diagnostics.iter().map(|found| (found.code, found.message.clone(), marked(found))).collect()
}

#[test]
fn every_error_has_the_same_text_at_its_own_position() {
    let xml = "<agent thread_frequency='fast' prority='1' on_failure='restrt'>\n<name>a</name>\n\
               <activity>Vsion</activity>\n<activity sped='1'>Walk</activity>\n<actvity>x</actvity></agent>\n<agnet/>\n\
               <provider thread_frequency='1'>Sensor</provider>";
    let toml = "[[agent]]\nthread_frequency = \"fast\"\nprority = 1\non_failure = \"restrt\"\nname = \"a\"\n\
                activity = [\"Vsion\", { name = \"Walk\", sped = 1 }]\nactvity = { name = \"x\" }\n[agnet]\n\
                [[provider]]\nname = \"Sensor\"\nthread_frequency = 1\n";
    let (xml, toml) = (findings("a.xml", xml), findings("a.toml", toml));
    assert_eq!(xml.len(), 8, "{xml:#?}");
    let mut sorted = [xml, toml];
    sorted.iter_mut().for_each(|list| list.sort());
    assert_eq!(sorted[0], sorted[1]);
}

#[test]
fn line_and_column_are_those_of_the_file() {
    let (_, diagnostics) = config::read(
        &Source::new(
            "a.toml",
            "[[agent]]\nname = \"a\"\npriority = \"high\"\nthread_frequency = 5\nactivity = \"Vision\"\n",
        ),
        Path::new("a.toml"),
        &registry(),
    );
    let findings: Vec<String> = diagnostics.iter().map(ToString::to_string).collect();
    assert_eq!(findings, ["a.toml:3:13: error[E0306]: `priority` is `high`, expected a whole number"]);
}

#[test]
fn invalid_toml_is_reported_and_the_rest_is_read() {
    let (setup, diagnostics) = config::read(
        &Source::new(
            "a.toml",
            "[[agent]]\nname = \"a\"\npriority = \nthread_frequency = 5\nactivity = \"Vision\"\n",
        ),
        Path::new("a.toml"),
        &registry(),
    );
    assert_eq!(diagnostics.iter().map(|found| found.code).collect::<Vec<_>>(), ["E0342"]);
    assert_eq!(diagnostics[0].position(), Some((3, 12)));
    assert_eq!(setup.agents[0].name(), "a");
    let text = "[[agent]]\nname = \"a\"\npriority = [1, 2]\nthread_frequency = 5\nactivity = \"Vision\"\n";
    let (_, diagnostics) = config::read(&Source::new("a.toml", text), Path::new("a.toml"), &registry());
    assert_eq!(
        diagnostics[0].to_string(),
        "a.toml:3:12: error[E0343]: `priority` is an array, expected one value (keep one of them, without brackets)"
    );
}

proptest::proptest! {
    #[test]
    fn any_text_is_read_without_failing(text in "[\\[\\]{}=\"'.,a-c0-9é \n#-]{0,60}") {
        let source = Source::new("a.toml", text.clone());
        let (_, diagnostics) = Grammar::agents().read(&source);
        for found in diagnostics {
            proptest::prop_assert!(text.get(found.span.start..found.span.end).is_some(), "{found:?}");
        }
    }
}
