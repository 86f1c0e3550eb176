//! The studio of a tape: each moment is the same from whichever side it is reached.

use std::path::Path;
use std::sync::Arc;

use monas::records::{self, foxglove::Log};
use monas_studio::{
    SceneEvent, Studio, StudioSettings, TapeChart, TapeRun, TransitionQuestion, Verdict, WhyQuestion,
};
use monas_tape::{Recording, Tape};
use narukom::{Hub, Timestamp};
use serde_json::{Value, json};

use crate::kit::{NOTE, Notes, Viewer, chart, lamp};

/// The lamp is switched at each second from 1 to `steps`, with a note before each.
fn record(path: &Path, steps: u32) -> Recording {
    record_from(path, steps, steps + 1)
}

/// The same with other notes from a number on.
fn record_from(path: &Path, steps: u32, others: u32) -> Recording {
    let tape = Tape::create(path).unwrap();
    let hub = Hub::with_linked_topics("robot").unwrap();
    hub.observe(Box::new(tape.clone()));
    let mut notes = hub.publisher(NOTE, "tester").unwrap();
    let mut charts = hub.publisher(records::CHART, "Lamp").unwrap();
    for number in 1..=steps {
        let time = Timestamp::from_nanos(u64::from(number) * 1_000_000_000);
        notes.publish(
            Log {
                message: format!("{} {number}", if number < others { "note" } else { "other" }),
                ..Log::default()
            },
            time,
        );
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

#[test]
fn a_tape_without_charts_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let tape = TapeRun::new("lamp", record(&folder.path().join("lamp.mcap"), 1), &[], None).unwrap();
    let why = tape.explain(&WhyQuestion { host: "robot", agent: None, state: "off", seconds: 1.0 });
    assert_eq!(why.unwrap_err(), "no statecharts are recorded in this tape");
}

#[test]
fn moments_after_a_chart_was_replaced_are_not_explained() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swapped.mcap");
    let tape = Tape::create(&path).unwrap();
    let hub = Hub::with_linked_topics("robot").unwrap();
    hub.observe(Box::new(tape.clone()));
    let mut models = hub.publisher(records::MODEL, "Lamp").unwrap();
    let mut charts = hub.publisher(records::CHART, "Lamp").unwrap();
    for (number, nodes) in [(1, 4), (2, 4), (3, 5)] {
        let time = Timestamp::from_nanos(number * 1_000_000_000);
        models
            .publish(records::Model { nodes: vec![String::new(); nodes], ..records::Model::default() }, time);
        charts.publish(records::Chart { entries: vec![2], ..records::Chart::default() }, time);
    }
    tape.finish().unwrap();
    let (host, agent, model) = ("robot".into(), "Lamp".into(), "lamp".into());
    let charts = [TapeChart { host, agent, chart: 0, model, statechart: lamp() }];
    let tape = TapeRun::new("swapped", Recording::open(&path).unwrap(), &charts, None).unwrap();
    let state = lamp().node(yase::NodeId(2)).name.clone();
    let explain = |seconds| tape.explain(&WhyQuestion { host: "robot", agent: None, state: &state, seconds });
    assert!(explain(2.5).unwrap().is_active);
    let refused = explain(3.5).map(|why| why.state);
    assert_eq!(
        refused,
        Err("the chart of `Lamp` was replaced at 3.000 s: moments before are explained".into())
    );
}

#[test]
fn later_steps_show_what_was_active_where_a_cut_tape_begins() {
    let folder = tempfile::tempdir().unwrap();
    let (path, part) = (folder.path().join("whole.mcap"), folder.path().join("part.mcap"));
    let tape = Tape::create(&path).unwrap();
    let hub = Hub::with_linked_topics("robot").unwrap();
    hub.observe(Box::new(tape.clone()));
    let mut steps = hub.publisher(records::CHART, "Lamp").unwrap();
    for (number, exits, entries) in [(1, vec![2], vec![3]), (2, vec![], vec![]), (3, vec![3], vec![2])] {
        let step = records::Chart { exits, entries, ..records::Chart::default() };
        let time = number * 1_000_000_000;
        steps.publish(records::Chart { time, ..step }, Timestamp::from_nanos(time));
    }
    tape.finish().unwrap();
    let from = Some(Timestamp::from_nanos(1_500_000_000));
    let filter = monas_tape::TapeFilter { from, ..monas_tape::TapeFilter::default() };
    monas_tape::cut(&Recording::open(&path).unwrap(), &filter, &part).unwrap();
    let (host, agent, model) = ("robot".into(), "Lamp".into(), "lamp".into());
    let charts = [TapeChart { host, agent, chart: 0, model, statechart: lamp() }];
    let tape = TapeRun::new("part", Recording::open(&part).unwrap(), &charts, None).unwrap();
    let explain = |state, seconds| {
        let why = tape.explain(&WhyQuestion { host: "robot", agent: None, state, seconds }).unwrap();
        (why.is_active, why.entered, why.begins, why.left)
    };
    assert_eq!(explain("on", 1.7), (false, None, Some(2.0), None), "before its first step");
    assert_eq!(explain("on", 2.5), (true, None, Some(2.0), None));
    assert_eq!(explain("on", 3.5), (false, None, Some(2.0), Some(3.0)));
    assert_eq!(explain("off", 2.5), (false, None, Some(2.0), None));
    assert_eq!(explain("off", 3.5), (true, Some(3.0), None, None));
    let question = TransitionQuestion { host: "robot", agent: None, transition: "on -> off", seconds: 2.5 };
    assert_eq!(tape.explain_transition(&question).unwrap().verdict, Verdict::Waits);
    let listen = Some("127.0.0.1:0".parse().unwrap());
    let studio = Studio::of_tape(tape, StudioSettings { listen, ..StudioSettings::default() }).unwrap();
    let mut viewer = Viewer::open(&studio).unwrap();
    let active = viewer.wait(|message| message["charts"][0].get("active").cloned());
    assert_eq!(active, json!([0, 3]), "the picture of the beginning");
}

#[test]
fn two_tapes_share_a_timeline_with_their_first_difference() {
    let folder = tempfile::tempdir().unwrap();
    let (host, agent, model) = ("robot".into(), "Lamp".into(), "lamp".into());
    let charts = [TapeChart { host, agent, chart: 0, model, statechart: lamp() }];
    let open = |name: &str, steps: u32| {
        let recording = record(&folder.path().join(name), steps);
        TapeRun::new(name, recording, &charts, Some(Arc::new(Notes))).unwrap()
    };
    // the second has no note at 4 s and later
    let (tape, other) = (open("a.mcap", 6), open("b.mcap", 3));
    let listen = Some("127.0.0.1:0".parse().unwrap());
    let settings = StudioSettings { listen, ..StudioSettings::default() };
    let same = Studio::of_tapes(tape.clone(), tape.clone(), settings.clone()).unwrap();
    let mut viewer = Viewer::open(&same).unwrap();
    let kinds = |facts: &Value| -> Vec<String> {
        let events = facts["events"].as_array().unwrap().iter();
        events.map(|event| event["kind"].as_str().unwrap().to_owned()).collect()
    };
    let facts = viewer.wait(|message| message.get("tape").cloned());
    assert!(!kinds(&facts).contains(&"first difference".to_owned()), "{facts}");

    let shorter = open("c.mcap", 2);
    let parted = TapeRun::new(
        "d.mcap",
        record_from(&folder.path().join("d.mcap"), 6, 4),
        &charts,
        Some(Arc::new(Notes)),
    );
    let studio = Studio::of_tapes(tape, parted.unwrap(), settings.clone()).unwrap();
    let mut viewer = Viewer::open(&studio).unwrap();
    viewer.send(json!({"type": "pace", "factor": 0}));
    let facts = viewer.wait(|message| Some(message["tape"].clone()).filter(|tape| tape["factor"] == 0.0));
    let difference =
        facts["events"].as_array().unwrap().iter().find(|event| event["kind"] == "first difference");
    assert_eq!(difference.unwrap()["t"], 4.0);
    for (time, note, beside) in
        [(5.5, "note 5", "other 5"), (3.5, "note 3", "note 3"), (4.5, "note 4", "other 4")]
    {
        viewer.send(json!({"type": "seek", "seconds": time}));
        let label = |message: &Value| message["scene"]["bodies"][0]["label"].as_str().map(str::to_owned);
        let (mut seen, mut seen_beside) = (None, None);
        viewer.wait(|message| {
            seen = label(message).or(seen.take());
            seen_beside = label(&message["beside"]).or(seen_beside.take());
            (message["now"] == time).then_some(())
        });
        assert_eq!((seen.as_deref(), seen_beside.as_deref()), (Some(note), Some(beside)), "at {time} s");
    }
    viewer.send(json!({"type": "picture", "key": "robot/Lamp/0", "beside": true}));
    let picture = viewer.wait(|message| (message["type"] == "picture").then(|| message.clone()));
    assert_eq!((&picture["beside"], &picture["picture"]["name"]), (&json!(true), &json!("lamp")));
    // one that ends earlier stays at its end
    let studio = Studio::of_tapes(other, shorter, settings).unwrap();
    let mut viewer = Viewer::open(&studio).unwrap();
    viewer.send(json!({"type": "seek", "seconds": 3.0}));
    viewer.wait(|message| (message["beside"]["now"] == 3.0).then_some(()));
}

/// The view at a time: the note, and the active states.
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
fn the_images_of_a_moment_are_those_of_the_tape() {
    let (_studio, mut viewer, _) = open(6);
    viewer.send(json!({"type": "camera", "host": "robot"}));
    for (time, url) in [(5.5, "bm90ZSA1"), (2.5, "bm90ZSAy")] {
        viewer.send(json!({"type": "seek", "seconds": time}));
        let url = json!(format!("data:image/png;base64,{url}"));
        viewer.wait(|message| (message["camera"]["images"][0]["url"] == url).then_some(()));
    }
}

#[test]
fn a_moment_is_the_same_whether_it_is_reached_forwards_or_backwards() {
    let (_studio, mut viewer, tape) = open(6);
    assert_eq!((&tape["begin"], &tape["end"]), (&json!(1.0), &json!(6.0)));
    assert_eq!(tape["events"][2], json!({"t": 3.0, "kind": "note", "text": "note 3"}));
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

#[test]
fn a_topic_of_several_publishers_is_one_row_with_all_their_messages() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("agents.mcap");
    let tape = Tape::create(&path).unwrap();
    let hub = Hub::with_linked_topics("robot").unwrap();
    hub.observe(Box::new(tape.clone()));
    let mut vision = hub.publisher(records::CYCLE, "Vision").unwrap();
    let mut notes = hub.publisher(NOTE, "tester").unwrap();
    let mut motion = hub.publisher(records::CYCLE, "Motion").unwrap();
    let second = |number: u64| Timestamp::from_nanos(number * 1_000_000_000);
    for time in 1..=3 {
        vision.publish(records::Cycle::default(), second(time));
        notes.publish(Log::default(), second(time));
    }
    motion.publish(records::Cycle::default(), second(4));
    motion.publish(records::Cycle::default(), second(5));
    tape.finish().unwrap();
    let run = TapeRun::new("agents", Recording::open(&path).unwrap(), &[], None).unwrap();
    let listen = Some("127.0.0.1:0".parse().unwrap());
    let studio = Studio::of_tape(run, StudioSettings { listen, ..StudioSettings::default() }).unwrap();
    let mut viewer = Viewer::open(&studio).unwrap();
    viewer.send(json!({"type": "seek", "seconds": 5.0}));
    let (mut topics, mut agents) = (Value::Null, Value::Null);
    viewer.wait(|message| {
        for (table, name) in [(&mut topics, "topics"), (&mut agents, "agents")] {
            if let Some(new) = message.get(name) {
                *table = new.clone();
            }
        }
        let is_at_end = topics.as_array()?.iter().any(|topic| topic["t"] == 5.0);
        is_at_end.then_some(())
    });
    let cycles: Vec<&Value> =
        topics.as_array().unwrap().iter().filter(|topic| topic["path"] == "monas/cycle").collect();
    let [row] = cycles.as_slice() else { panic!("{cycles:?}") };
    assert_eq!((&row["count"], &row["publisher"], &row["t"]), (&json!(5), &json!("Motion"), &json!(5.0)));
    let agents = agents.as_array().unwrap().iter();
    let agents: Vec<_> = agents.map(|agent| (agent["name"].as_str(), agent["cycles"].as_u64())).collect();
    assert_eq!(agents, [(Some("Vision"), Some(3)), (Some("Motion"), Some(2))]);
}

#[test]
fn lasting_events_are_marked_where_they_begin() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("events.mcap");
    let tape = Tape::create(&path).unwrap();
    let hub = Hub::with_linked_topics("robot").unwrap();
    hub.observe(Box::new(tape.clone()));
    let mut notes = hub.publisher(NOTE, "tester").unwrap();
    for (time, text) in (1_u64..).zip(["lasting", "lasting", "other", "other", "lasting"]) {
        notes.publish(
            Log { message: text.into(), ..Log::default() },
            Timestamp::from_nanos(time * 1_000_000_000),
        );
    }
    tape.finish().unwrap();
    let mut run =
        TapeRun::new("events", Recording::open(&path).unwrap(), &[], Some(Arc::new(Notes))).unwrap();
    let kind = "difference".to_owned();
    run.mark([(
        Timestamp::from_nanos(2_500_000_000),
        SceneEvent { kind, text: "marked".into(), lasts: false },
    )]);
    let listen = Some("127.0.0.1:0".parse().unwrap());
    let studio = Studio::of_tape(run, StudioSettings { listen, ..StudioSettings::default() }).unwrap();
    let events = Viewer::open(&studio)
        .unwrap()
        .wait(|message| Some(message["tape"]["events"].clone()).filter(Value::is_array));
    let times: Vec<f64> = events.as_array().unwrap().iter().filter_map(|event| event["t"].as_f64()).collect();
    assert_eq!(times, [1.0, 2.5, 3.0, 4.0, 5.0]);
    assert_eq!(events[1], json!({"t": 2.5, "kind": "difference", "text": "marked"}));
}

/// The number of the transition from off to on, whose guard reads a note and a timer.
const SWITCH: u32 = 1;

/// A lamp that a note switches on once its timer has expired. The notes are `wait` at 1 s and `go`
/// at 4 s; the lamp is switched on at 5 s, and off again at 6 s.
fn guarded() -> TapeRun {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("guarded.mcap");
    let tape = Tape::create(&path).unwrap();
    let hub = Hub::with_linked_topics("robot").unwrap();
    hub.observe(Box::new(tape.clone()));
    let second = |number: u64| Timestamp::from_nanos(number * 1_000_000_000);
    let mut notes = hub.publisher(NOTE, "tester").unwrap();
    let mut steps = hub.publisher(records::CHART, "Lamp").unwrap();
    let mut cycles = hub.publisher(records::CYCLE, "Lamp").unwrap();
    let mut step = |time: u64, selected: u32, exit: u32, entry: u32, note: u64| {
        let (exits, entries, selected) = (vec![exit], vec![entry], vec![selected]);
        let time_of = second(time).as_nanos();
        steps.publish(
            records::Chart { time: time_of, selected, exits, entries, ..Default::default() },
            second(time),
        );
        let delivery = records::Delivery {
            topic: narukom::topic_hash("test/note"),
            sequence: note,
            ..Default::default()
        };
        let delivered = if note > 0 { vec![delivery] } else { Vec::new() };
        cycles.publish(records::Cycle { delivered, ..Default::default() }, second(time));
    };
    let mut note =
        |time: u64, text: &str| notes.publish(Log { message: text.into(), ..Log::default() }, second(time));
    step(0, 0, 1, 2, 0);
    note(1, "wait");
    step(2, 3, 2, 2, 1);
    note(4, "go");
    step(5, SWITCH, 2, 3, 2);
    step(6, 2, 3, 2, 0);
    tape.finish().unwrap();
    let texts = [
        "/ StartTimeout(patience, 3s)",
        "[Log.message == \"go\" && (patience || abs(near - 2) < 1)]",
        "enough",
        "[false]",
    ];
    let mut statechart = chart(texts[0], texts[1], texts[2]);
    statechart.connect(yase::Transition {
        expression: yase::expression::parse_transition(texts[3]).0,
        ..yase::Transition::new(yase::NodeId(2), yase::NodeId(2))
    });
    let (host, agent, model) = ("robot".into(), "Lamp".into(), "lamp".into());
    let charts = [TapeChart { host, agent, chart: 0, model, statechart }];
    TapeRun::new("guarded", Recording::open(&path).unwrap(), &charts, None).unwrap()
}

#[test]
fn a_transition_that_does_not_fire_names_the_parts_of_its_guard_with_their_values() {
    let tape = guarded();
    let ask = |transition: &str, seconds: f64| {
        tape.explain_transition(&TransitionQuestion { host: "robot", agent: None, transition, seconds })
    };
    let early = ask("off -> on", 2.5).unwrap();
    assert_eq!(
        (early.verdict, early.guard, early.fired, early.next),
        (Verdict::Waits, Some(false), None, Some(5.0))
    );
    let values = |why: &monas_studio::TransitionExplanation| -> Vec<(String, Option<bool>)> {
        why.atoms.iter().map(|atom| (atom.text.clone(), atom.value)).collect()
    };
    let texts = ["Log.message == \"go\"", "patience", "abs(near - 2) < 1"].map(str::to_owned);
    let [note, patience, distance] = texts;
    let expected = [(note.clone(), Some(false)), (patience.clone(), Some(false)), (distance.clone(), None)];
    assert_eq!(values(&early), expected);
    let read = &early.atoms[0].reads[0];
    assert_eq!((&read.value, read.sequence, read.published), (&json!("wait"), Some(1), Some(1.0)));
    assert_eq!(early.atoms[1].reads[0].due, Some(3.0));
    assert!(early.reason.contains("its guard was false: `Log.message == \"go\"`"), "{}", early.reason);
    let link = &early.chains[0].links[0];
    assert_eq!((link.publisher.as_str(), link.topic.as_str()), ("tester", "test/note"));
    assert!(link.end.as_ref().unwrap().contains("`tester` is not an agent"), "{link:?}");

    let fired = ask("1", 5.0).unwrap();
    assert_eq!((fired.verdict, fired.guard, fired.judged), (Verdict::Fired, Some(true), Some(5.0)));
    assert_eq!(values(&fired), [(note, Some(true)), (patience, Some(true)), (distance, None)]);
    // where the lamp is on, the other transition of `off` was left out
    let other = ask("off -> off", 5.5).unwrap();
    assert_eq!((other.verdict, &other.instead[..]), (Verdict::Instead, &["off -> on".to_owned()][..]));
    let waiting = ask("on -> off", 5.5).unwrap();
    assert_eq!((waiting.verdict, waiting.reason.as_str()), (Verdict::Waits, "it waits for `enough`"));
    assert!(ask("on -> nowhere", 1.0).unwrap_err().contains("there is no transition"));
    assert!(ask("9", 1.0).unwrap_err().contains("the last is 3"));
}

#[test]
fn firings_of_a_transition_are_gone_through() {
    let listen = Some("127.0.0.1:0".parse().unwrap());
    let studio = Studio::of_tape(guarded(), StudioSettings { listen, ..StudioSettings::default() }).unwrap();
    let mut viewer = Viewer::open(&studio).unwrap();
    viewer.wait_for_link("tape");
    viewer.send(json!({"type": "pace", "factor": 0}));
    viewer.send(json!({"type": "seek", "seconds": 2.5}));
    viewer.wait(|message| (message["now"] == 2.5).then_some(()));
    let jump = |transition: u32, back: bool| json!({"type": "jump", "key": "robot/Lamp/0", "transition": transition, "back": back});
    for (transition, back, time) in
        [(SWITCH, false, 5.0), (2, false, 6.0), (SWITCH, true, 5.0), (3, true, 2.0)]
    {
        viewer.send(jump(transition, back));
        viewer.wait(|message| (message["now"] == time).then_some(()));
    }
    viewer.send(json!({"type": "why transition", "key": "robot/Lamp/0", "transition": SWITCH}));
    let why = viewer.wait(|message| (message["type"] == "why transition").then(|| message["why"].clone()));
    assert_eq!((&why["verdict"], &why["atoms"][0]["value"]), (&json!("waits"), &json!(false)));
}
