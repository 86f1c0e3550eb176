//! Properties of the goalie, monitored during a match.

use std::fs;

use super::{changed, played};

/// The reason why blue's goalie has stopped after some seconds, if any, while the given properties
/// are monitored.
fn stopped(properties: Option<&str>) -> Option<String> {
    let folder = tempfile::tempdir().unwrap();
    let monitored = "<statechart>models/goalie.srm</statechart>\n    <monitor on_violation=\"policy\">models/goalie.properties</monitor>";
    let file = "config/roles/goalie.xml";
    changed(folder.path(), file, "<statechart>models/goalie.srm</statechart>", monitored);
    let role = folder.path().join(file);
    let text = fs::read_to_string(&role).unwrap();
    fs::write(&role, text.replacen("<agent ", "<agent on_failure=\"stop-agent\" ", 1)).unwrap();
    if let Some(properties) = properties {
        fs::write(folder.path().join("models/goalie.properties"), properties).unwrap();
    }
    let (_, statistics) = played(&folder.path().join("config/match.xml"), 7, 20);
    let goalie = statistics.agents.iter().find(|agent| agent.host == "blue-1" && agent.agent == "Goalie");
    goalie.unwrap().stopped.clone()
}

#[test]
fn explored_properties_hold_in_a_match() {
    assert_eq!(stopped(None), None);
}

#[test]
fn a_violated_property_stops_its_agent() {
    let strict = "property \"it does not track\": always not entering TrackBall\n";
    let reason = stopped(Some(strict)).expect("it tracks the ball");
    assert!(reason.starts_with("the property `it does not track` was violated in cycle "), "{reason}");
    let late = "property \"slow\": always eventually entering RobotController within 99 ms\n";
    assert!(stopped(Some(late)).is_some(), "the body is served every 100 ms");
}
