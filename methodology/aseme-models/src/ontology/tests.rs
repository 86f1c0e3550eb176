#![allow(clippy::unwrap_used, reason = "these are tests")]

use yase::expression::TextPosition;
use yase::vocabulary::{MessageEntry, TopicEntry, TopicId};
use yase::{Source, Span};

use super::*;

fn gathered(transitions: &str, variables: &[Variable]) -> (Ontology, Vec<String>) {
    let text = format!(
        "Role: r\nLiveness:\nr = A . B\nConstants:\nnear = 0.5\nTransitions:\nA -> B : {transitions}\n"
    );
    let (chart, read) = crate::statechart_of(&Source::new("r", text));
    assert_eq!(read, []);
    let (ontology, found) = of(&chart, variables);
    (ontology, found.iter().map(|found| found.message.clone()).collect())
}

fn variable(name: &str, kind: &str) -> Variable {
    Variable { name: name.into(), kind: kind.into(), position: TextPosition(Span::new(3, 7)) }
}

#[test]
fn fields_are_what_they_are_used_as() {
    let guard = "[Ball.found && Ball.distance < near && Game.name == \"final\" && Game.phase != READY && Game.phase != SET \
                 && Ball.x - Ball.y > 0 && Ball.owner == Game.owner] / Goal.count = Goal.count + 1, Goal.ours = true";
    let (ontology, found) = gathered(guard, &[]);
    assert_eq!(found, [""; 0]);
    let messages: Vec<String> = ontology
        .messages
        .iter()
        .flat_map(|message| {
            message.fields.iter().map(|field| format!("{}.{} {:?}", message.name, field.name, field.kind))
        })
        .collect();
    assert_eq!(
        messages,
        [
            "Ball.found Condition",
            "Ball.distance Number",
            "Ball.x Number",
            "Ball.y Number",
            "Ball.owner Unknown",
            "Game.name Text",
            "Game.phase OneOf([\"READY\", \"SET\"])",
            "Game.owner Unknown",
            "Goal.count Number",
            "Goal.ours Condition"
        ]
    );
}

#[test]
fn topics_come_from_paths_and_from_variables() {
    let variables = [variable("gsm", "worldstate.State.GameState"), variable("ok", "bool")];
    let (ontology, found) =
        gathered("[vision.Data.Ball.place.x > 1 && worldstate.State.GameState.over]", &variables);
    assert_eq!(found, ["the variable `ok` has the type `bool`, which is not a message"]);
    assert_eq!(
        ontology.to_proto("team"),
        "// The messages of statecharts: derived from expressions, to be completed by hand.\nsyntax = \"proto3\";\n\npackage team;\n\n\
         // On `worldstate`, kept as `State`.\nmessage GameState {\n  bool over = 1;\n}\n\n\
         // On `vision`, kept as `Data`.\nmessage Ball {\n  message Place {\n    double x = 1;\n  }\n  Place place = 1;\n}\n"
    );
}

/// The names of values belong to the message around their enumeration.
#[test]
fn fields_with_a_value_in_common_have_one_enumeration() {
    let (ontology, found) = gathered(
        "[Game.phase == READY && Game.side == LEFT && Game.other == SET && Game.last == READY && Game.last == SET]",
        &[],
    );
    assert_eq!(found, [""; 0]);
    let text = ontology.to_proto("team");
    assert_eq!(
        text.split_once("package team;\n\n").unwrap().1,
        "message Game {\n  \
           // The values of `phase` and `other` and `last`.\n  \
           enum Phase {\n    READY = 0;\n    SET = 1;\n  }\n  \
           // The values of `side`.\n  \
           enum Side {\n    LEFT = 0;\n  }\n  \
           Phase phase = 1;\n  Side side = 2;\n  Phase other = 3;\n  Phase last = 4;\n}\n"
    );
}

#[test]
fn a_field_has_the_kind_of_the_constant_that_it_is_compared_with() {
    let text = "Role: r\nLiveness:\nr = A . B\nConstants:\nNAME = \"rex\"\nTAME = true\nOLD = 9\nTransitions:\n\
        A -> B : [Cat.name == NAME && Cat.tame == TAME && Cat.age > OLD]\n";
    let (chart, read) = crate::statechart_of(&Source::new("r", text));
    assert_eq!(read, []);
    let (ontology, _) = of(&chart, &[]);
    let kinds: Vec<&OntologyFieldKind> =
        ontology.messages[0].fields.iter().map(|field| &field.kind).collect();
    let expected = [&OntologyFieldKind::Text, &OntologyFieldKind::Condition, &OntologyFieldKind::Number];
    assert_eq!(kinds, expected);
}

#[test]
fn a_topic_may_carry_several_messages_but_keeps_each_in_one_way() {
    let (ontology, found) = gathered("[a.State.Ball.x > 0 && a.Data.Ball.x > 1 && a.State.Game.over]", &[]);
    assert_eq!(found, ["`Ball` has the retention `Data` on `a` here, and `State` elsewhere"]);
    assert_eq!(ontology.messages.iter().map(|message| message.topics.len()).collect::<Vec<_>>(), [2, 1]);
}

#[test]
fn variables_are_held_against_what_a_program_knows() {
    let vocabulary = TypeEnvironment {
        topics: vec![TopicEntry {
            id: TopicId(0),
            path: "soccer/ball".into(),
            kind: TopicKind::State,
            message: "Ball".into(),
        }],
        messages: ["Ball", "GameState"].map(|name| MessageEntry { name: name.into(), fields: vec![] }).into(),
        enumerations: vec![],
        functions: vec![],
        scripts: false,
    };
    let messages = |kind: &str| {
        let found = check(&[variable("v", kind)], &vocabulary);
        found.iter().map(|found| format!("{} {}", found.code, found.message)).collect::<String>()
    };
    assert_eq!(messages("ball.State.Ball"), "");
    assert_eq!(messages("elsewhere.State.GameState"), "");
    assert_eq!(messages("ball.State.Bal"), "E0881 the variable `v` has the unknown message type `Bal`");
    assert_eq!(
        messages("ball.State.GameState"),
        "E0882 the variable `v` is of `GameState`, but `soccer/ball` carries `Ball`"
    );
    assert_eq!(
        messages("ball.Data.Ball"),
        "E0883 the variable `v` has the retention `Data`, but `soccer/ball` has `State`"
    );
}

#[test]
fn activities_are_about_the_variables_of_their_states() {
    let text = "IAC: r\n\nVariable: gsm\n  type = worldstate.State.GameState\n\nStates:\n  r OR\n    START\n    a BASIC\n      variables = gsm\n    \
                b BASIC\n      activity = a\n      variables = gsm\n    END\n\nTransitions:\n  START -> a\n  a -> b\n  b -> END\n";
    let (model, read) = crate::convert::read(&Source::new("r", text));
    assert_eq!(read, []);
    let Some((crate::convert::Model::Chart(chart), _)) = model else { panic!("it is a chart") };
    let subject = ("gsm".to_owned(), "worldstate.State.GameState".to_owned());
    assert_eq!(subjects(&chart), [("a".to_owned(), vec![subject])].into());
}
