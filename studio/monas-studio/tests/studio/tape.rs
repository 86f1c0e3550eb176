//! The studio of a tape: each moment is the same from whichever side it is reached.

use std::path::Path;
use std::sync::Arc;

use monas::records::{self, foxglove::Log};
use monas_studio::{Studio, StudioSettings, TapeChart, TapeRun};
use monas_tape::{Recording, Tape};
use narukom::{Hub, Timestamp};
use serde_json::{Value, json};

use crate::kit::{NOTE, Notes, Viewer, lamp};

/// The lamp is switched at each second from 1 to `steps`, with a note before each.
fn record(path: &Path, steps: u32) -> Recording {
    let tape = Tape::create(path).unwrap();
    let hub = Hub::with_linked_topics("robot").unwrap();
    hub.observe(Box::new(tape.clone()));
    let mut notes = hub.publisher(NOTE, "tester").unwrap();
    let mut charts = hub.publisher(records::CHART, "Lamp").unwrap();
    for number in 1..=steps {
        let time = Timestamp::from_nanos(u64::from(number) * 1_000_000_000);
        notes.publish(Log { message: format!("note {number}"), ..Log::default() }, time);
        let (exits, entries) = if number % 2 == 1 { (vec![2], vec![3]) } else { (vec![3], vec![2]) };
        charts.publish(records::Chart { exits, entries, ..records::Chart::default() }, time);
    }
    tape.finish().unwrap();
    Recording::open(path).unwrap()
}

/// A viewer of a tape that is held at its begin, with the facts of the tape.
fn open(steps: u32) -> (Studio, Viewer, Value) {
    let folder = tempfile::tempdir().unwrap();
    let recording = record(&folder.path().join("lamp.mcap"), steps);
    let (host, agent, model) = ("robot".into(), "Lamp".into(), "lamp".into());
    let charts = [TapeChart { host, agent, chart: 0, model, statechart: lamp() }];
    let listen = Some("127.0.0.1:0".parse().unwrap());
    let tape = TapeRun::new("lamp.mcap", recording, &charts, Some(Arc::new(Notes))).unwrap();
    let studio = Studio::of_tape(tape, StudioSettings { listen, ..StudioSettings::default() }).unwrap();
    let mut viewer = Viewer::open(&studio).unwrap();
    let facts = viewer.wait_for_link("tape");
    assert_eq!(facts["name"], "lamp.mcap");
    viewer.send(json!({"type": "pace", "factor": 0}));
    let tape = viewer.wait(|message| Some(message["tape"].clone()).filter(|tape| tape["factor"] == 0.0));
    (studio, viewer, tape)
}

/// What is seen at a time: the note, and the active states.
fn look(viewer: &mut Viewer, seconds: f64) -> (Value, Value) {
    viewer.send(json!({"type": "seek", "seconds": seconds}));
    let (mut note, mut active) = (Value::Null, Value::Null);
    viewer.wait(|message| {
        if let Some(body) = message["scene"]["bodies"].as_array() {
            note = body.first().map_or(Value::Null, |body| body["label"].clone());
        }
        if message["charts"].is_array() {
            active = message["charts"][0]["active"].clone();
        }
        (message["now"] == seconds).then_some(())
    });
    (note, active)
}

#[test]
fn a_moment_is_the_same_whether_it_is_reached_forwards_or_backwards() {
    let (_studio, mut viewer, tape) = open(6);
    assert_eq!((&tape["begin"], &tape["end"]), (&json!(1.0), &json!(6.0)));
    assert_eq!(tape["events"][2], json!({"t": 3.0, "text": "note 3"}));
    let forwards = look(&mut viewer, 3.5);
    assert_eq!(forwards, (json!("note 3"), json!([3])));
    assert_eq!(look(&mut viewer, 5.5), (json!("note 5"), json!([3])));
    assert_eq!(look(&mut viewer, 3.5), forwards);
    assert_eq!(look(&mut viewer, 2.0), (json!("note 2"), json!([2])));
}

#[test]
fn steps_of_a_chart_are_gone_through_on_and_back() {
    let (_studio, mut viewer, _) = open(6);
    look(&mut viewer, 3.5);
    let mut step = |back: bool| {
        viewer.send(json!({"type": "step", "key": "robot/Lamp/0", "back": back}));
        viewer.wait(|message| {
            let chart = message["charts"].get(0)?;
            Some((message["now"].clone(), chart["active"].clone()))
        })
    };
    assert_eq!(step(false), (json!(4.0), json!([2])));
    assert_eq!(step(false), (json!(5.0), json!([3])));
    assert_eq!(step(true), (json!(4.0), json!([2])));
    assert_eq!(step(true), (json!(3.0), json!([3])));
}

#[test]
fn a_tape_is_played_to_its_end_with_its_topics_and_agents() {
    let (_studio, mut viewer, _) = open(300);
    viewer.send(json!({"type": "watch", "host": "robot", "topic": "test/note"}));
    viewer.send(json!({"type": "pace", "factor": 500}));
    let mut last = Value::Null;
    let mut topics = Value::Null;
    viewer.wait(|message| {
        if let Some(sample) = message.get("sample") {
            last = sample.clone();
        }
        if let Some(table) = message.get("topics") {
            topics = table.clone();
        }
        (message["tape"]["factor"] == 0.0 && message["now"] == 300.0).then_some(())
    });
    assert_eq!((&last["message"]["message"], &last["sequence"]), (&json!("note 300"), &json!(300)));
    let notes = topics.as_array().unwrap().iter().find(|topic| topic["path"] == "test/note").unwrap();
    assert!(notes["count"].as_u64().unwrap() > 200, "{notes}");
}
