//! Compositions: a folder per case, with a model per robot and `expected.txt`, which
//! `MONAS_BLESS=1` rewrites.

use std::path::Path;
use std::sync::Arc;

use aseme_verify::composition::{Channels, Composition, TeamTrace, compose};
use aseme_verify::{CheckSettings, explorable};
use yase::Source;

type Models = Vec<(String, Arc<Source>)>;

fn models(case: &str) -> Models {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/verify/composed").join(case);
    let mut files: Vec<_> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|it| it == "srm"));
    files.sort();
    let model = |file: &std::path::PathBuf| {
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let source = Source::new(format!("{name}.srm"), std::fs::read_to_string(file).unwrap());
        (name, source)
    };
    files.iter().map(model).collect()
}

fn composed(case: &str, channels: Channels, states: usize) -> Composition {
    let mut settings = CheckSettings::default();
    settings.states = states;
    compose(&models(case), channels, &settings).unwrap_or_else(|wrong| panic!("{case}: {wrong:?}"))
}

/// All findings with their traces.
fn text(found: &Composition) -> String {
    let mut text = String::new();
    for (from, to, message) in &found.passing {
        text += &format!("{from} -> {to}: {message}\n");
    }
    let robots: Vec<String> = found.robots.iter().map(|(name, states)| format!("{name} {states}")).collect();
    text += &format!("states: {}, together {}\n", robots.join(", "), found.states);
    for finding in &found.findings {
        text += &format!("{}\n", finding.diagnostic);
        let trace = finding.trace.iter().flat_map(|trace| trace.lines());
        trace.for_each(|line| text += &format!("    {line}\n"));
    }
    text
}

fn codes(found: &Composition) -> Vec<&'static str> {
    found.findings.iter().map(|finding| finding.diagnostic.code).collect()
}

#[test]
fn robots_that_wait_for_each_other_are_found_and_those_that_nearly_do_are_not() {
    let cases: [(&str, &[&str]); 8] = [
        ("deadlock", &["E0930"]),
        ("near", &[]),
        ("early", &["E0930", "E0931"]),
        ("guards", &["E0930"]),
        ("guards_near", &[]),
        ("crowded", &["E0932"]),
        ("three", &["E0930"]),
        ("twice", &[]),
    ];
    for (case, expected) in cases {
        let mut channels = Channels::default();
        channels.capacity = if case == "twice" { 3 } else { channels.capacity };
        let found = composed(case, channels, 10_000);
        let golden = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("tests/verify/composed")
            .join(case)
            .join("expected.txt");
        let actual = text(&found);
        if std::env::var_os("MONAS_BLESS").is_some() {
            std::fs::write(&golden, &actual).unwrap();
        }
        assert_eq!(codes(&found), expected, "{case}:\n{actual}");
        let known = std::fs::read_to_string(&golden).unwrap_or_default();
        assert!(actual == known, "{} differs; MONAS_BLESS=1 accepts it:\n{actual}", golden.display());
        assert!(found.is_finished);
    }
}

#[test]
fn a_trace_to_a_deadlock_is_replayed_by_the_charts() {
    let models = models("deadlock");
    let found = composed("deadlock", Channels::default(), 10_000);
    let trace = found.findings[0].trace.as_deref().unwrap();
    assert!(TeamTrace::is_one(trace) && !TeamTrace::is_one("start\nreturn Aim\n"));
    let charts: Vec<_> = models.iter().map(|(name, source)| (name, explorable(source).unwrap())).collect();
    let robots: Vec<_> = charts.iter().map(|(name, chart)| (name.as_str(), chart)).collect();
    let (played, wrong) = TeamTrace::parse(&robots, trace).unwrap().play();
    assert!(wrong.is_none());
    let last = |robot: usize| played.iter().rfind(|it| it.robot == robot).unwrap().active.clone();
    assert_eq!(
        (last(0), last(1)),
        (vec!["passer".into(), "Wait".into()], vec!["receiver".into(), "Listen".into()])
    );
    let refused = |text: &str| TeamTrace::parse(&robots, text).unwrap_err().to_string();
    assert_eq!(
        refused("passer: start\nkeeper: start\n"),
        "line 2: `keeper: start` belongs to no robot: a step starts with `passer:` or `receiver:`"
    );
    assert!(
        refused("passer: start\nreceiver: start\nreceiver: return Aim\n").starts_with("line 3: no state")
    );
}

/// Two regions that send the same message are both explored.
#[test]
fn messages_sent_in_two_regions_arrive_from_both() {
    let mut models = models("deadlock");
    let passer = "Role: passer\nLiveness:\npasser = (Aim . Pass) || (Stand . Shout)\nTransitions:\n\
        Pass -> END : receiver.ready.Signal.Ready / publish.passed.Signal.Passed\n\
        Shout -> END : / publish.passed.Signal.Passed\n";
    models[0].1 = Source::new("passer.srm", passer);
    let found = compose(&models, Channels::default(), &CheckSettings::default()).unwrap();
    assert_eq!(codes(&found), ["E0930", "E0931", "E0931"], "{}", text(&found));
    let shouted = "passer: return (Aim.Pass)||(Stand.Shout)/2/(Stand.Shout)/Shout\n      # says `Passed`\n";
    assert!(text(&found).contains(shouted), "{}", text(&found));
}

/// Of robots without routes only the start is explored.
#[test]
fn messages_without_a_receiver_are_not_explored() {
    let role =
        "Role: a\nLiveness:\na = b~ || c~ || d~\nTransitions:\nb -> b : / publish.noise.Signal.Noise\n";
    let models: Models = ["one", "two"].map(|name| (name.to_owned(), Source::new("a.srm", role))).into();
    let found = compose(&models, Channels::default(), &CheckSettings::default()).unwrap();
    assert_eq!((codes(&found), found.robots[0].1 <= 3), (Vec::new(), true), "{}", text(&found));
}

/// A robot that waits for an answer is deadlocked if the answer may be lost.
#[test]
fn a_handshake_without_a_timer_does_not_survive_a_loss() {
    let mut channels = Channels::default();
    channels.may_lose = true;
    assert_eq!(codes(&composed("near", channels, 10_000)), ["E0930"]);
}

#[test]
fn an_incomplete_composition_is_undecided() {
    let found = composed("near", Channels::default(), 8);
    assert_eq!((codes(&found), found.is_finished), (vec!["E0933"], false));
}

#[test]
fn messages_without_a_sender_arrive_at_any_time() {
    let mut models = models("deadlock");
    models[1].1 = Source::new("receiver.srm", "Role: receiver\nLiveness:\nreceiver = Stand\n");
    let found = compose(&models, Channels::default(), &CheckSettings::default()).unwrap();
    assert_eq!(codes(&found), ["E0934"], "{}", text(&found));
}

#[test]
fn indistinguishable_messages_are_rejected() {
    let mut models = models("deadlock");
    let text =
        "Role: receiver\nLiveness:\nreceiver = Listen . Take\nTransitions:\nListen -> Take : not other\n";
    models[1].1 = Source::new("receiver.srm", text);
    let found = compose(&models, Channels::default(), &CheckSettings::default()).unwrap();
    assert_eq!(codes(&found), ["E0935", "E0934"]);
}

fn of_texts(texts: &[(&str, &str)]) -> Models {
    let model = |&(name, text): &(&str, &str)| (name.to_owned(), Source::new(name, text));
    texts.iter().map(model).collect()
}

/// A message that a robot sends to itself passes through a channel like any other.
#[test]
fn a_message_to_itself_arrives_after_it_was_sent() {
    let speaks = "Role: echo\nLiveness:\necho = Call . Listen . Act\nTransitions:\n\
        Call -> Listen : / publish.word.Signal.Word\nListen -> Act : echo.word.Signal.Word\n";
    let found =
        compose(&of_texts(&[("echo", speaks)]), Channels::default(), &CheckSettings::default()).unwrap();
    assert_eq!(found.passing, [("echo".into(), "echo".into(), "Word".into())]);
    assert!(found.findings.is_empty() && found.is_finished, "{}", text(&found));
    let plain = speaks.replace("echo.word", "word");
    let found =
        compose(&of_texts(&[("echo", &plain)]), Channels::default(), &CheckSettings::default()).unwrap();
    assert_eq!(found.passing, [("echo".into(), "echo".into(), "Word".into())], "its own needs no name");
    assert!(found.findings.is_empty() && found.is_finished, "{}", text(&found));
    let waits = "Role: echo\nLiveness:\necho = Listen . Call . Act\nTransitions:\n\
        Listen -> Call : echo.word.Signal.Word\nCall -> Act : / publish.word.Signal.Word\n";
    let found =
        compose(&of_texts(&[("echo", waits)]), Channels::default(), &CheckSettings::default()).unwrap();
    assert_eq!(codes(&found), ["E0930"], "{}", text(&found));
    let plain = waits.replace("echo.word", "word");
    let again =
        compose(&of_texts(&[("echo", &plain)]), Channels::default(), &CheckSettings::default()).unwrap();
    assert_eq!(codes(&again), ["E0930"], "{}", text(&again));
    let said = found.findings[0].diagnostic.message.clone();
    assert!(said.contains("waits in `Listen` for `Word` of `echo`"), "{said}");
}

/// A robot that TERMINATE has stopped neither sends nor waits.
#[test]
fn waiting_for_a_terminated_robot_is_a_deadlock() {
    let receiver = |end: &str| {
        format!(
            "IAC: receiver\n\nStates:\n  receiver OR\n    START\n    Walk BASIC\n    Ready BASIC\n    halt {end}\n\n\
             Transitions:\n  START -> Walk\n  Walk -> Ready : [tired]\n  Walk -> halt : [!tired]\n  \
             Ready -> Ready : passer.more.Signal.More / publish.ready.Signal.Ready\n"
        )
        .replace("tired", "passer.more.State.Tired.yes")
        .replace("Walk -> Ready :", "Walk -> Ready !1 :")
    };
    let passer = "Role: passer\nLiveness:\npasser = Call . Wait . Pass\nTransitions:\n\
        Call -> Wait : / publish.more.Signal.More\nWait -> Pass : receiver.ready.Signal.Ready\n";
    let stopped = receiver("TERMINATE");
    let models = of_texts(&[("passer", passer), ("receiver", &stopped)]);
    let found = compose(&models, Channels::default(), &CheckSettings::default()).unwrap();
    let waits = found.findings.iter().find(|it| it.diagnostic.code == "E0930");
    let waits = waits.unwrap_or_else(|| panic!("{}", text(&found)));
    let said = &waits.diagnostic.message;
    assert!(said.contains("`passer` waits in `Wait` for `Ready` of `receiver`"), "{said}");
    assert!(!said.contains("`receiver` waits"), "it has stopped: {said}");
    assert!(found.is_finished);
}

const ASKER: &str = "Role: asker\nLiveness:\nasker = Ask . Wait . Use\nTransitions:\n\
    Ask -> Wait : / publish.question.Signal.Question\nWait -> Use : answer.Signal.Answer\n";

/// Agents of one process read each other's messages without a name: those that wait for each other
/// stand still as robots do.
#[test]
fn agents_of_one_process_are_composed_like_robots() {
    let answerer =
        |text: &str| format!("Role: answerer\nLiveness:\nanswerer = Listen . Say\nTransitions:\n{text}");
    let good = answerer("Listen -> Say : question.Signal.Question / publish.answer.Signal.Answer\n");
    let bad = answerer("Listen -> Say : hint.Signal.Hint / publish.answer.Signal.Answer\n");
    let asker = ASKER.replace("answer.Signal.Answer\n", "answer.Signal.Answer / publish.hint.Signal.Hint\n");
    let both = |other: &str| of_texts(&[("asker", &asker), ("answerer", other)]);
    let found = compose(&both(&good), Channels::default(), &CheckSettings::default()).unwrap();
    assert!(found.is_one_process && !found.has_errors() && found.is_finished, "{}", text(&found));
    assert_eq!(found.passing.len(), 2, "{}", text(&found));
    let found = compose(&both(&bad), Channels::default(), &CheckSettings::default()).unwrap();
    assert!(codes(&found).contains(&"E0930"), "{}", text(&found));
    let said = &found.findings[0].diagnostic.message;
    assert!(
        said.contains("`asker` waits in `Wait` for `Answer`")
            && said.contains("`answerer` waits in `Listen` for `Hint`"),
        "{said}"
    );
    // the same with their robot named: what is said of one robot is not heard on another
    let on = |hosts: [&str; 2]| {
        let models = [(hosts[0], asker.as_str()), (hosts[1], bad.as_str())];
        compose(&of_texts(&models), Channels::default(), &CheckSettings::default()).unwrap()
    };
    let found = on(["nao/asker", "nao/answerer"]);
    assert!(!found.is_one_process && codes(&found).contains(&"E0930"), "{}", text(&found));
    let mut channels = Channels::default();
    channels.may_lose = true;
    let found = compose(&both(&good), channels, &CheckSettings::default()).unwrap();
    assert!(!found.has_errors(), "nothing is lost within a process: {}", text(&found));
}

/// A way to a deadlock that the data of a robot do not allow is not called one.
#[test]
fn a_deadlock_is_confirmed_by_the_machines() {
    let receiver = "Role: receiver\nLiveness:\nreceiver = Listen . Take\nTransitions:\n\
        Listen -> Take : passer.passed.Signal.Passed\n";
    let passer = |value: &str| {
        format!(
            "Role: passer\nLiveness:\npasser = Aim . Turn . (Pass | Hold)\nTransitions:\n\
            Aim -> Turn : / Ball.found = {value}\nCONDITION -> Pass : [Ball.found]\nCONDITION -> Hold : [!Ball.found]\n\
            Pass -> END : / publish.passed.Signal.Passed\n"
        )
    };
    let composed = |value: &str| {
        let models = of_texts(&[("passer", &passer(value)), ("receiver", receiver)]);
        compose(&models, Channels::default(), &CheckSettings::default()).unwrap()
    };
    let found = composed("false");
    assert!(codes(&found).contains(&"E0930"), "{}", text(&found));
    let found = composed("true");
    assert!(codes(&found).contains(&"E0937") && !codes(&found).contains(&"E0930"), "{}", text(&found));
    let said = found.findings.iter().find(|it| it.diagnostic.code == "E0937").unwrap();
    assert!(said.diagnostic.message.contains("`Ball.found` cannot be false"), "{}", said.diagnostic.message);
}
