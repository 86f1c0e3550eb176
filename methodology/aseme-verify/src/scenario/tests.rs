use std::sync::Arc;

use proptest::prelude::*;
use yase::vocabulary::{MessageEntry, TopicEntry, TopicKind};
use yase::{CompiledChart, Diagnostic, Source, TopicId, TypeEnvironment};

use super::*;

const ROLE: &str = "Role: lamp
Liveness:
lamp = (Look . Shine) ~
Transitions:
Look -> Shine : [late] / StartTimeout(late, 100ms)
Shine -> END : off
";

fn chart() -> CompiledChart {
    let (chart, found) = aseme_models::statechart_of(&Source::new("lamp.srm", ROLE));
    assert_eq!(found, []);
    chart.compile(&TypeEnvironment::default()).expect("the chart is in order")
}

fn read(text: &str) -> Result<Vec<ScenarioStep>, Vec<Diagnostic>> {
    let (script, found) = ScenarioText::parse(&Source::new("a.scenario", text));
    if found.is_empty() { script.bind(&chart(), &TypeEnvironment::default()) } else { Err(found) }
}

fn wrong(text: &str) -> Vec<String> {
    let found = read(text).expect_err("something is wrong with it");
    found.iter().map(ToString::to_string).collect()
}

#[test]
fn steps_know_what_they_say_and_where() {
    let steps = read("model lamp.srm # the lamp\n\nstart\n  starts Look # and nothing else\nwait 1.5 s\n  not in Shine\nevent off\n").unwrap();
    let off = chart().events().find("off").unwrap();
    let causes: Vec<&StepStimulus> = steps.iter().map(|step| &step.cause).collect();
    assert_eq!(
        causes,
        [&StepStimulus::Start, &StepStimulus::Wait(Duration::from_millis(1500)), &StepStimulus::Event(off)]
    );
    let expected = &steps[0].expected[0];
    assert_eq!((expected.passage.text(), expected.passage.line()), ("starts Look", 4));
    assert!(matches!(&expected.kind, ExpectationKind::Starts(nodes) if nodes.len() == 1));
    assert!(matches!(&steps[1].expected[0].kind, ExpectationKind::NotIn(nodes) if nodes.len() == 1));
}

#[test]
fn a_timer_is_named_and_read() {
    let steps = read("model m\nstart\n  timer late: 80ms\ntimer late\n  timer late: over\n").unwrap();
    let timers: Vec<ExpectedTimer> = steps
        .iter()
        .flat_map(|step| &step.expected)
        .map(|expected| match &expected.kind {
            ExpectationKind::Timer(timer, left) if timer.name == "late" => *left,
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(timers, [ExpectedTimer::Runs(Duration::from_millis(80)), ExpectedTimer::Over]);
}

/// Two topics end in the same segment, so that only their paths tell them apart.
#[test]
fn a_published_topic_is_named_by_its_path() {
    let topic = |id, path: &str| TopicEntry {
        id: TopicId(id),
        path: path.into(),
        kind: TopicKind::Signal,
        message: "Kick".into(),
    };
    let vocabulary = TypeEnvironment {
        topics: vec![topic(0, "arm/ball"), topic(1, "soccer/ball")],
        messages: vec![MessageEntry { name: "Kick".into(), fields: Vec::new() }],
        ..TypeEnvironment::default()
    };
    let text = "model m\nstart\n  publishes `soccer.ball`.Signal.Kick, `arm.ball`.Signal.Kick\n";
    let (script, found) = ScenarioText::parse(&Source::new("a.scenario", text));
    assert_eq!(found, []);
    let steps = script.bind(&chart(), &vocabulary).unwrap();
    let kind = &steps[0].expected[0].kind;
    let expected = [TopicId(1), TopicId(0)];
    assert!(matches!(kind, ExpectationKind::Publishes(topics) if *topics == expected), "{kind:?}");
}

#[test]
fn all_errors_are_reported_at_their_positions() {
    let text = "model m\nstart\n  in Shin\nreturn lamp\nevent of\nwait long\njump\n  timer lat: over\n  raise(off)\n";
    let expected = [
        "a.scenario:3:6: error[E0845]: the chart `lamp` has no state `Shin` (did you mean `Shine`?)",
        "a.scenario:4:8: error[E0893]: the state `lamp` has no activity",
        "a.scenario:5:7: error[E0846]: the chart `lamp` has no event `of` (did you mean `off`?)",
        "a.scenario:6:6: error[E0896]: `long` is not a duration (write it as `100ms` or `2s`)",
        "a.scenario:7:1: error[E0890]: `jump` is not a step",
        "a.scenario:8:9: error[E0895]: no action of the chart starts a timer `lat` (did you mean `late`?)",
        "a.scenario:9:3: error[E0894]: `raise(off)` is not a message",
    ];
    let wrong = wrong(text);
    assert_eq!(wrong.len(), expected.len(), "{wrong:#?}");
    for (wrong, expected) in wrong.iter().zip(expected) {
        assert!(wrong.starts_with(expected), "{wrong}");
    }
}

#[test]
fn a_scenario_names_its_model_and_starts_once() {
    let first = |text: &str| wrong(text).remove(0);
    assert!(first("start\n").contains("E0891]: the scenario names no model"));
    assert!(first("model a\nmodel b\nstart\n").contains("a.scenario:2:1: error[E0891]: a second `model`"));
    assert!(first("model a\nwait 1s\n").contains("a.scenario:2:1: error[E0892]: the chart was not started"));
    assert!(
        first("model a\nstart\nstart\n")
            .contains("a.scenario:3:1: error[E0892]: the chart was started already")
    );
    assert!(first("model a\nafter b\nstart\n").contains("a.scenario:3:1: error[E0892]"));
    assert!(first("model a\n").contains("E0892]: the scenario has no step"));
    assert!(
        first("model a\n  in b\nstart\n")
            .contains("a.scenario:2:3: error[E0890]: this line belongs to no step")
    );
    let (script, found) = ScenarioText::parse(&Source::new("a", "model a.srm\nafter b.scenario\nwait 1s\n"));
    assert_eq!(found, []);
    assert_eq!(script.after.map(|link: ScenarioLink| link.path).as_deref(), Some("b.scenario"));
    let _: Arc<Source> = script.source;
}

/// Every text yields a scenario or findings with positions in it.
fn exercise(text: &str) {
    let found = match read(text) {
        Ok(steps) => return assert!(matches!(steps[0].cause, StepStimulus::Start), "{text:?}"),
        Err(found) => found,
    };
    assert!(!found.is_empty());
    for finding in found {
        assert!(text.get(finding.span.start..finding.span.end).is_some(), "{finding:?}");
    }
}

const WORDS: [&str; 24] = [
    "start\n",
    "\n",
    "  ",
    "model m\n",
    "after b\n",
    "return ",
    "wait ",
    "timer ",
    "event ",
    "messages\n",
    "in ",
    "not ",
    "starts ",
    "publishes ",
    "nothing",
    "Look",
    "late",
    "off\n",
    "1s\n",
    ", ",
    ": over\n",
    "[In(Look)]\n",
    "a.b = 2; ",
    "ω# \u{e9}\r\n",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_heap_of_words(words in prop::collection::vec(prop::sample::select(WORDS.to_vec()), 0..40)) {
        exercise(&format!("model m\nstart\n{}", words.concat()));
    }

    #[test]
    fn any_text(text in any::<String>()) {
        exercise(&text);
    }
}
