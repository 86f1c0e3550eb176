//! A robot whose agent fails comes to rest, and the match continues.

use std::fs;
use std::time::Duration;

use monas_match::{MatchOptions, MatchSource};
use monas_robot::topics::SENSORS;
use monas_robot::{Posture, Sensors};

use super::changed;

/// The sensor readings of a robot after some seconds.
fn felt(running: &mut monas_match::RunningMatch, host: &str, seconds: u64) -> Sensors {
    running.advance(Duration::from_secs(seconds)).unwrap();
    let now = running.simulation().unwrap().now();
    let mut looking = running.simulation().unwrap().hub(host).unwrap().blackboard("looking on");
    looking.process_messages(now);
    *looking.sample(SENSORS).unwrap().message
}

#[test]
fn a_robot_in_the_safe_state_sits_down_and_takes_its_stiffness_off() {
    let folder = tempfile::tempdir().unwrap();
    let monitored = "<statechart>models/goalie.srm</statechart>\n    <monitor on_violation=\"policy\">models/goalie.properties</monitor>";
    let file = "config/roles/goalie.xml";
    let path = changed(folder.path(), file, "<statechart>models/goalie.srm</statechart>", monitored);
    let role = folder.path().join(file);
    let text = fs::read_to_string(&role).unwrap();
    fs::write(&role, text.replacen("<agent ", "<agent on_failure=\"safe-state\" ", 1)).unwrap();
    let strict = "property \"it does not track\": always not entering TrackBall\n";
    fs::write(folder.path().join("models/goalie.properties"), strict).unwrap();
    let plan = MatchSource::load(&path, &monas::Registry::linked()).unwrap();
    let mut running = plan.start(MatchOptions { seed: 7, record: None }).unwrap();
    let before = felt(&mut running, "blue-1", 1);
    assert!(!before.relaxed, "{before:?}");
    let after = felt(&mut running, "blue-1", 24);
    assert_eq!((after.posture(), after.relaxed), (Posture::Sitting, true), "{after:?}");
    let other = felt(&mut running, "blue-2", 0);
    assert!(!other.relaxed, "{other:?}");
}
