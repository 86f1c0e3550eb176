//! Runs against a property are executed before it is called violated: what a chart assigns is
//! followed.

use aseme_verify::properties::{PropertyOutcome, check};
use aseme_verify::{CheckSettings, Finding, ProgramSymbols};
use yase::Source;
use yase::vocabulary::{FieldEntry, FieldId, MessageEntry, TopicEntry, TopicId, TopicKind, ValueType};

fn judged(model: &str, formula: &str, settings: &CheckSettings) -> (PropertyOutcome, Vec<Finding>) {
    let properties = Source::new("r.properties", format!("property \"p\": {formula}\n"));
    let (results, findings) = check(&Source::new("r.srm", model), &properties, settings).unwrap();
    assert_eq!(results.len(), 1, "{findings:?}");
    (results[0].outcome, findings)
}

fn outcome(model: &str, formula: &str) -> PropertyOutcome {
    judged(model, formula, &CheckSettings::default()).0
}

fn role(formula: &str, transitions: &str) -> String {
    format!("Role: r\nLiveness:\nr = {formula}\nTransitions:\n{transitions}\n")
}

/// A guard reads the value that an earlier action of the same step wrote.
#[test]
fn what_a_step_assigns_its_guards_read() {
    let model = |value: &str| {
        let assign = format!("A -> (B|C) : / Ball.found = {value}\n");
        role("A . (B | C)", &(assign + "CONDITION -> B : [Ball.found]\nCONDITION -> C : [!Ball.found]"))
    };
    assert_eq!(outcome(&model("true"), "always not in C"), PropertyOutcome::Holds);
    assert_eq!(outcome(&model("true"), "always not in B"), PropertyOutcome::Violated);
    assert_eq!(outcome(&model("false"), "always not in B"), PropertyOutcome::Holds);
    assert_eq!(outcome(&model("false"), "always not in C"), PropertyOutcome::Violated);
    assert_eq!(
        outcome(&model("Eyes.open"), "always not in C"),
        PropertyOutcome::Violated,
        "it may be either"
    );
}

/// A later assignment to the same field replaces the first, one to another field does not.
#[test]
fn the_last_assignment_counts() {
    let model = |actions: &str| {
        let guards = "CONDITION -> B : [Ball.x == 1]\nCONDITION -> C : [Ball.x != 1]";
        role("A . (B | C)", &format!("A -> (B|C) : / {actions}\n{guards}"))
    };
    assert_eq!(outcome(&model("Ball.x = 1; Ball.y = 2"), "always not in C"), PropertyOutcome::Holds);
    assert_eq!(outcome(&model("Ball.x = 1; Ball.x = 2"), "always not in B"), PropertyOutcome::Holds);
    assert_eq!(outcome(&model("Ball.x = 2; Ball.x = 1"), "always not in C"), PropertyOutcome::Holds);
    assert_eq!(outcome(&model("Ball.y = 1"), "always not in C"), PropertyOutcome::Violated);
}

/// Regions that are entered read what was written on the blackboard around them.
#[test]
fn a_region_takes_over_what_was_assigned() {
    let guards = "A -> (B~||C~) : / Ball.found = true\nSTART -> B : [Ball.found]\nSTART -> C : [!Ball.found]";
    let model = role("A . (B~ || C~)", guards);
    let until = "not in C until leaving B";
    assert_ne!(outcome(&model, until), PropertyOutcome::Violated);
    assert_eq!(outcome(&model, "always not in B"), PropertyOutcome::Violated);
}

/// Two regions read the same message in a step.
#[test]
fn regions_that_get_a_message_together_read_the_same() {
    let guards = "START -> A : [Ball.x > 1]\nSTART -> B : [Ball.x < 1]";
    let model = role("(A || B)", guards);
    let together = "always not (entering A and entering B)";
    assert_eq!(outcome(&model, together), PropertyOutcome::Holds);
    let model = model.replace("[Ball.x < 1]", "[Ball.x < 2]");
    assert_eq!(outcome(&model, together), PropertyOutcome::Violated);
}

const LATER: &str = "A -> B : / Ball.found = true\nB -> (C|D) : done\nCONDITION -> C : [!Ball.found]\nCONDITION -> D : [Ball.found]";

/// A program that has messages of a ball: which its activity publishes, or which nothing does.
fn program(is_published: bool) -> CheckSettings {
    let mut world = ProgramSymbols::default();
    let field = FieldEntry { id: FieldId(0), name: "found".into(), kind: ValueType::Bool };
    let (path, message) = ("soccer/ball".to_owned(), "Ball".to_owned());
    world.vocabulary.topics.push(TopicEntry {
        id: TopicId(0),
        path: path.clone(),
        kind: TopicKind::State,
        message: message.clone(),
    });
    world.vocabulary.messages.push(MessageEntry { name: message, fields: vec![field] });
    world.activities.insert("See".into(), Some(is_published.then_some(path).into_iter().collect()));
    let mut settings = CheckSettings::default();
    settings.world = Some(world);
    settings
}

/// An assignment of an earlier step stays, unless another one publishes the message too.
#[test]
fn what_was_assigned_stays_until_another_publishes() {
    let model = role("A . B . (C | D)", LATER);
    let (verdict, findings) = judged(&model, "always not in C", &CheckSettings::default());
    assert_eq!(verdict, PropertyOutcome::NotConfirmed, "{findings:?}");
    let said = &findings[0].diagnostic;
    assert_eq!(said.code, "E0872");
    assert!(
        said.message.contains("is not confirmed: at step 4, `!Ball.found` cannot be true"),
        "{}",
        said.message
    );
    assert_eq!(judged(&model, "always not in C", &program(false)).0, PropertyOutcome::NotConfirmed);
    let (verdict, findings) = judged(&model, "always not in C", &program(true));
    assert_eq!((verdict, findings[0].diagnostic.code), (PropertyOutcome::Violated, "E0870"));
    assert_eq!(outcome(&model, "always not in D"), PropertyOutcome::Violated);
}

/// A counter is followed through the steps, although no single fact says what it is.
#[test]
fn a_counter_is_followed() {
    let model = |last: &str| {
        let count = "A -> B : / Count.n = 0\nB -> C : / Count.n = Count.n + 1\n";
        role("A . B . C . D", &format!("{count}C -> D : [{last}]"))
    };
    assert_eq!(outcome(&model("Count.n == 1"), "always not in D"), PropertyOutcome::Violated);
    let (verdict, findings) = judged(&model("Count.n == 2"), "always not in D", &CheckSettings::default());
    assert_eq!(verdict, PropertyOutcome::NotConfirmed, "{findings:?}");
    assert_eq!(outcome(&model("Count.n < 2 && Count.n > 0"), "always not in D"), PropertyOutcome::Violated);
}

/// Values of enumerations are what was assigned, and no others.
#[test]
fn values_of_enumerations_are_followed() {
    let model = |last: &str| role("A . B . C", &format!("A -> B : / Game.phase = SET\nB -> C : [{last}]"));
    assert_eq!(outcome(&model("Game.phase == SET"), "always not in C"), PropertyOutcome::Violated);
    assert_eq!(outcome(&model("Game.phase != SET"), "always not in C"), PropertyOutcome::NotConfirmed);
    assert_eq!(outcome(&model("Game.phase == READY"), "always not in C"), PropertyOutcome::NotConfirmed);
}

/// A message that has come does not vanish again.
#[test]
fn messages_do_not_vanish() {
    let gone = "A -> B : [Ball != NULL]\nB -> C : [Ball == NULL]";
    let (verdict, findings) = judged(&role("A . B . C", gone), "always not in C", &CheckSettings::default());
    assert_eq!(verdict, PropertyOutcome::NotConfirmed, "{findings:?}");
    let signal = gone.replace("Ball", "ball.Signal.Ball");
    let (verdict, findings) =
        judged(&role("A . B . C", &signal), "always not in C", &CheckSettings::default());
    assert_eq!(verdict, PropertyOutcome::Violated, "{findings:?}");
}

/// A function of the program returns the value that the run needs, but always the same for the same
/// arguments.
#[test]
fn functions_return_one_value_of_the_same_arguments() {
    let model = role("A . (B | C)", "CONDITION -> B : [near(Ball.x)]\nCONDITION -> C : [!near(Ball.x)]");
    assert_eq!(outcome(&model, "always not in B"), PropertyOutcome::Violated);
    let constant = role("A . B . C", "A -> B : [near(1)]\nB -> C : [!near(1)]");
    assert_eq!(outcome(&constant, "always not in C"), PropertyOutcome::NotConfirmed);
}
