//! The text form of each kind of model, compared with its XMI.

use aseme_models::convert::Format;
use yase::Diagnostic;

use crate::kit::{clean, codes_and_texts, read, whole};

const SAG: &str = r#"SAG:

Goal: WinGame
  requirements = more goals than the others
  depender = Manager
  dependees = Player, Player[2]

Actor: Manager

Actor: Player

Actor: Player
"#;

const SUC: &str = "SUC:

Role: player
  type = System

Role: the goalie, at home
  type = Legacy_System

UseCase: Attack
  participants = player, \"the goalie, at home\"
  includes = PassBall

UseCase: PassBall
  participants = player
  specified_by = kick motion
";

const AIP: &str = "AIP:

Participant: center
  engaging_rules = closest to the ball
  outcomes = goal
  liveness:
    WalkTowardsBall . [passBall]
    passBall = Turn . Kick

Participant: center_for
  liveness:
    WalkTowardsGoal

Protocol: Attack
  participants = center, center_for
";

const SRM: &str = "SRM:

Activity: Stand
  functionality = motion

Activity: Scan
  functionality = motion

Capability: search
  activities = Scan

Role: player
  activities = Stand, Scan
  liveness:
    player=Stand.search
    search=Scan+
  capabilities = search

Functionality: motion
  technology = C++
";

const FT: &str = "FT:

Activity: Stand
  role = player
  functionality = motion

Activity: Scan
  role = player
  capability = search
  functionality = motion
  technology = C++
";

const IAC: &str = "IAC: tiny
  description = a chart, that is all

Variable: gsm
  type = worldstate.State.GameStateMessage

Constants:
  near = 0.25

States:
  r OR
    START
    (Scan|Kick)~ OR
      variables = gsm
      functionality = motion
      START
      Scan BASIC
        activity = LookAround
        priority = 5
        entry = raise(seen)
        defer = whistle
        duration = 250ms
      END
        label = 0.2.9
    Scan BASIC
      activity = \"\"

Transitions:
  r/START -> (Scan|Kick)~
  (Scan|Kick)~/START -> (Scan|Kick)~/Scan !2 %0.5 interrupts : [a == \"#\" && b]/raise(c)
    name = other
  r/Scan -> r/Scan internal : e
";

#[test]
fn each_kind_reads_and_prints_as_it_is_written() {
    for text in [SUC, AIP, SRM, FT] {
        assert_eq!(clean(text).to_text(), text);
    }
    let (model, _, findings) = read(IAC);
    assert_eq!(
        codes_and_texts(IAC, &findings),
        [("E0813", "END")],
        "its label is another than the usual one"
    );
    assert_eq!(model.to_text(), IAC);
    let (model, _, findings) = read(SAG);
    assert_eq!(
        codes_and_texts(SAG, &findings),
        [("E0263", "Actor: Player")],
        "the second of a name is said to be one"
    );
    assert_eq!(model.to_text(), SAG);
}

#[test]
fn each_kind_goes_to_xmi_and_back() {
    for text in [SAG, SUC, AIP, SRM] {
        let (model, ..) = read(text);
        let xmi = whole(&model, Format::Xmi);
        let (again, format, findings) = read(&xmi);
        assert_eq!((findings, format), (vec![], Format::Xmi), "{xmi}");
        assert_eq!(again, model, "{xmi}");
        assert_eq!(again.to_text(), text);
    }
}

#[test]
fn comments_stay_where_they_are() {
    let text =
        "# who\nSAG:  # what\n\n# one\nGoal: Win\n  # two\n  depender = M  # three\n\nActor: M\n# end\n";
    let (model, format, _) = read(text);
    assert_eq!(
        model.write(format, text).unwrap().text,
        "# who\nSAG:  # what\n\n# one\nGoal: Win\n  # two\n  depender = M  # three\n\nActor: M\n\n# end\n"
    );
    let lost = model.write(Format::Xmi, text).unwrap().lost;
    assert_eq!(
        codes_and_texts(text, &lost).iter().map(|(_, text)| *text).collect::<Vec<_>>(),
        ["# who", "# what", "# one", "# two", "# three", "# end"]
    );
}

#[test]
fn comments_of_what_is_gone_are_kept() {
    let old = "SAG:\nGoal: Win  # one\n  requirements = x  # two\nActor: M\n";
    let (changed, ..) = read("SAG:\nActor: M\n");
    assert_eq!(changed.write(Format::Text, old).unwrap().text, "SAG:\n\nActor: M\n\n# one\n# two\n");
}

#[test]
fn comments_of_a_chart_stay_with_states_and_transitions() {
    let text = IAC
        .replace("Scan BASIC\n        activity", "Scan BASIC  # look\n        activity")
        .replace("  r/START", "  # begin\n  r/START");
    let (model, format, _) = read(&text);
    assert_eq!(model.write(format, &text).unwrap().text, text);
}

#[test]
fn faults_of_texts_are_placed() {
    for (text, code, marked) in [
        ("SAG:\nGool: g\n", "E0261", "Gool"),
        ("SAG: team\n", "E0262", "team"),
        ("SAG:\nGoal: g\n  name = \"x\n", "E0266", "name"),
        ("SAG:\nGoal: g\n  requirements = \"x\n", "E0264", "\"x"),
        ("SAG:\nGoal: g\n  what\n", "E0265", "what"),
        ("SAG:\nGoal: g\n  dependees = a\n  dependees = a\nActor: a\n", "E0267", "dependees"),
        ("SUC:\nRole: r\n  type = Systm\n", "E0268", "Systm"),
        ("SAG:\nGoal: g\n  depender = Manger\nActor: Manager\n", "E0269", "Manger"),
        ("SAG:\nGoal: g\n  depender = a, b\nActor: a\nActor: b\n", "E0269", "a, b"),
        ("SAG:\nGoal: g\n  depender:\n    a\nActor: a\n", "E0265", "depender"),
        ("SAG:\nGoal: g\nx = y\n", "E0260", "x = y"),
        ("IAC: c\nStates:\n  r OR\n    START\n    a thing\n", "E0270", "a thing"),
        ("IAC: c\nStates:\n  r OR\n    START\nTransitions:\n  START -> a\n", "E0271", "a"),
        ("IAC: c\nStates:\n  r OR\n    START\nTransitions:\n  START to r\n", "E0240", "START to r"),
        ("IAC: c\nStates:\n  r OR\n    START\nTransitions:\n  START -> r !x\n", "E0242", "!x"),
        ("IAC: c\nStates:\n  r OR\n    a\u{a0}thing\n", "E0270", "a\u{a0}thing"),
        ("IAC: c\nStates:\n  r OR\n    START\nTransitions:\n  START -> r !1 \u{e9}\n", "E0242", "!1 \u{e9}"),
        ("IAC: c\nStates:\n  r OR\n    prority = 2\n    START\n", "E0266", "prority"),
        ("IAC: c\nStates:\n  r OR\n    priority = high\n    START\n", "E0245", "high"),
        ("IAC: c\nStates:\n  r OR\n    variables = x\n    START\n", "E0269", "x"),
        ("IAC: c\nConstants:\n  a = wide\nStates:\n  r OR\n    START\n", "E0239", "wide"),
    ] {
        let (.., findings) = read(text);
        assert!(codes_and_texts(text, &findings).contains(&(code, marked)), "{text}\n{findings:?}");
    }
}

#[test]
fn an_item_without_settings_is_not_answered_with_an_empty_list() {
    for (setting, code) in [("goals = b", "E0266"), ("goals", "E0265")] {
        let (.., findings) = read(&format!("SAG:\nActor: a\n  {setting}\n"));
        let hint = Some("an item `Actor:` has a name and no settings");
        assert_eq!((findings[0].code, findings[0].hint.as_deref()), (code, hint));
    }
    let (.., findings) = read("SAG:\nActor: a\n  goals = b\n");
    assert_eq!(findings[0].message, "`Actor:` has no `goals`");
    let (.., findings) = read("SAG:\nGoal: g\n  zzzzz = b\n");
    assert_eq!(findings[0].hint.as_deref(), Some("keys are requirements, depender, dependees"));
}

#[test]
fn a_path_that_names_several_states_is_answered_with_those_that_name_one() {
    let text = "IAC: c\nStates:\n  r OR\n    START\n    a OR\n      START\n      x BASIC\n    b OR\n      START\n      x BASIC\nTransitions:\n  x -> x\n";
    let (.., findings) = read(text);
    assert_eq!(findings[0].hint.as_deref(), Some("did you mean one of `a/x`, `b/x`?"));
}

#[test]
fn formulas_in_a_model_are_judged_where_they_stand() {
    let text = SRM.replace("search=Scan+", "search=Scan..Stand");
    let (.., findings) = read(&text);
    let at = text.find("..").unwrap();
    assert_eq!((findings[0].code, findings[0].span.start), ("E0205", at + 1), "{findings:?}");
    let open = SRM.replace("player=Stand.search", "player=Stand ?OP? search");
    let (.., findings) = read(&open);
    assert_eq!(findings.iter().map(|it| it.code).collect::<Vec<_>>(), ["E0219"]);
}

/// A chart that cannot run yet can be drawn.
#[test]
fn charts_with_unfinished_expressions_are_drawn() {
    let chart = "IAC: m\n\nStates:\n  m OR\n    START\n    A BASIC\n    END\n\nTransitions:\n  START -> A\n  A -> A : [y g 0`]/timeout\n  A -> END : [x]\n";
    let role = "Role: m\nLiveness:\nm = A+\nTransitions:\nA -> A : [y g 0`]/timeout\nA -> END : [x]\n";
    for text in [chart, role] {
        let source = yase::Source::new("m", text);
        assert!(aseme_models::statechart_of(&source).1.iter().any(Diagnostic::is_error));
        let (chart, found) = aseme_models::drawable_chart_of(&source, None);
        assert!(
            !found.is_empty() && found.iter().all(|it| it.severity == yase::Severity::Warning),
            "{found:?}"
        );
        let chart = chart.expect("a chart to be drawn");
        let labels: Vec<String> = chart.transitions().map(|(_, it)| it.expression.to_string()).collect();
        assert!(
            labels.contains(&"`[y g 0']/timeout`".into()) && labels.contains(&"[x]".into()),
            "{labels:?}"
        );
    }
    let wrong = yase::Source::new("m", "m = A . . B");
    assert_eq!(aseme_models::drawable_chart_of(&wrong, None).0, None);
}
