//! Resolution of names.

use std::time::Duration;

use super::test_context::{
    BALL, BEHAVIOR_FALL, COLOUR, DISTANCE, GAME, LEFT_ARM, MOTION, POSITION, TestContext, X, compile_with,
    compiled, constants, guard, state_of, timers, vocabulary,
};
use crate::diagnostic::Suggestions;
use crate::vocabulary::{FieldId, Value};
use crate::{
    CompiledTransition, CompiledTrigger, Effect, EventId, EventInterner, NameScope, Origin, ScriptInterner,
    TimerId, compile_actions, parse_actions, parse_condition,
};

fn effects(text: &str) -> Box<[Effect]> {
    compiled(&format!("/ {text}")).effects
}

#[test]
fn nothing_compiles_to_nothing() {
    assert_eq!(compiled(""), CompiledTransition::default());
}

#[test]
fn a_value_knows_what_it_reads() {
    let effects = effects("GameState.score = Ball.distance + 1");
    let [Effect::Assign { value, .. }] = &*effects else { panic!("{effects:?}") };
    let sources: Vec<_> = value.sources().iter().map(|source| source.topic).collect();
    assert_eq!((value.reads(), sources.as_slice()), ([BALL].as_slice(), [BALL].as_slice()));
}

#[test]
fn a_topic_is_named_in_every_way() {
    let context = TestContext::new().with(BALL, &[DISTANCE], Value::Float(2.0));
    for variable in [
        "Ball.distance",
        "ball.distance",
        "`soccer.ball`.distance",
        "`soccer/ball`.distance",
        "ball.State.Ball.distance",
        "`soccer.ball`.State.Ball.distance()",
    ] {
        assert_eq!(context.holds(&format!("{variable} == 2")), Ok(true), "{variable}");
    }
    assert_eq!(guard("`left.arm`.State.Arm.angle > 1").reads(), [LEFT_ARM]);
    assert_eq!(guard("behavior.Signal.Fall.fall > 0").reads(), [BEHAVIOR_FALL]);
}

#[test]
fn the_prefix_of_a_message_is_its_origin() {
    let host = || "striker".into();
    let publisher = || "Vision".into();
    for (variable, origin) in [
        ("Ball.distance", Origin::Own),
        ("Vision.Ball.distance", Origin::Publisher(publisher())),
        ("`Vision`.Ball.distance", Origin::Publisher(publisher())),
        ("striker.ball.State.Ball.distance", Origin::Host(host())),
        ("`blue-2`.ball.State.Ball.distance", Origin::Host("blue-2".into())),
        ("striker.Vision.Ball.distance", Origin::HostPublisher { host: host(), publisher: publisher() }),
    ] {
        let context = TestContext::new().with_from(origin.clone(), BALL, &[DISTANCE], Value::Int(1));
        assert_eq!(context.holds(&format!("{variable} == 1")), Ok(true), "{variable}");
        let elsewhere =
            TestContext::new().with_from(Origin::Host("keeper".into()), BALL, &[DISTANCE], Value::Int(1));
        assert_eq!(elsewhere.holds(&format!("{variable} == 1")), Ok(false), "{variable}");
    }
}

#[test]
fn fields_of_fields_are_read_in_one_path() {
    let context = TestContext::new().with(BALL, &[POSITION, X], Value::Float(-1.0));
    assert_eq!(context.holds("Ball.position.x < 0"), Ok(true));
    assert_eq!(context.holds("ball.State.Ball.position().x() < 0"), Ok(true));
}

#[test]
fn a_bare_name_is_a_value_of_the_enumeration_beside_it() {
    let context = TestContext::new().with(GAME, &[FieldId(0)], Value::Enum(3)).with(
        GAME,
        &[FieldId(1)],
        Value::Enum(0),
    );
    assert_eq!(context.holds("GameState.player_state == PLAYING"), Ok(true));
    assert_eq!(context.holds("PLAYING == GameState.player_state"), Ok(true));
    assert_eq!(context.holds("GameState.phase == PLAYING"), Ok(false));
    assert_eq!(context.holds("GameState.phase == FIRST"), Ok(true));
}

#[test]
fn a_bare_name_is_a_constant_or_a_function_without_arguments() {
    let context = TestContext::new().with(BALL, &[COLOUR], Value::Text("blue"));
    assert_eq!(context.holds("limit == 0.25"), Ok(true));
    assert_eq!(context.holds("Ball.colour == own"), Ok(true));
    assert_eq!(context.holds("!debug && kick_off"), Ok(true));
    assert_eq!(context.holds("kick_off()"), Ok(true));
}

#[test]
fn a_timer_may_have_dots() {
    assert_eq!(guard("motion_timeout && robot.period").timers(), [TimerId(0), TimerId(1)]);
    assert_eq!(guard("TimeoutCheck(robot.period)").timers(), [TimerId(1)]);
}

#[test]
fn triggers_name_events_and_arrivals_of_messages() {
    let mut events = EventInterner::new();
    let trigger =
        |text: &str, events: &mut EventInterner| compile_with(text, events).unwrap().trigger.unwrap();
    let kick = events.intern("kick");
    assert_eq!(trigger("*", &mut events), CompiledTrigger::Any);
    assert_eq!(trigger("kick", &mut events), CompiledTrigger::OneOf([kick].into()));
    assert_eq!(trigger("not kick", &mut events), CompiledTrigger::Not(kick));
    let both = trigger("kick | error.activity", &mut events);
    assert_eq!(both, CompiledTrigger::OneOf([kick, events.find("error.activity").unwrap()].into()));

    for (text, topic) in [
        ("Message.Ball", BALL),
        ("Ball", BALL),
        ("ball.State.Ball", BALL),
        ("`soccer.ball`", BALL),
        ("motion", MOTION),
        ("Motion", MOTION),
        ("`body.motion`.Signal.Motion", MOTION),
    ] {
        let CompiledTrigger::OneOf(alternatives) = trigger(text, &mut events) else { panic!("{text}") };
        assert_eq!(events.message(topic), Some(alternatives[0]), "{text}");
        assert_eq!(events.topic(alternatives[0]), Some(topic), "{text}");
    }
    assert_eq!(events.message(GAME), None);
    assert_eq!(events.name(events.message(BALL).unwrap()), "soccer/ball");
    assert_eq!(events.len(), 4);
}

#[test]
fn triggers_name_arrivals_from_other_hosts_which_are_other_events() {
    let mut events = EventInterner::new();
    let text = "ball.State.Ball | striker.ball.State.Ball | goalie.ball.State.Ball | striker.ball.State.Ball";
    let trigger = compile_with(text, &mut events).unwrap().trigger.unwrap();
    let own = events.message(BALL).unwrap();
    let [striker, goalie] = ["striker", "goalie"].map(|host| events.message_of(host, BALL).unwrap());
    assert_eq!(trigger, CompiledTrigger::OneOf([own, striker, goalie, striker].into()));
    assert_eq!(
        [own, striker, goalie].map(|event| events.host(event)),
        [None, Some("striker"), Some("goalie")]
    );
    assert_eq!(events.topic(goalie), Some(BALL));
    assert_eq!(events.name(goalie), "soccer/ball of goalie");
    assert_eq!((events.len(), events.message_of("striker", GAME)), (3, None));
}

/// A topic that retains messages is an event only if written as one; the name of a timer is no
/// topic.
#[test]
fn names_of_events_are_not_taken_for_topics() {
    let mut events = EventInterner::new();
    compile_with("ball | motion_timeout | state.x", &mut events).unwrap();
    for name in ["ball", "motion_timeout", "state.x"] {
        let event = events.find(name).expect(name);
        assert_eq!((events.name(event), events.topic(event)), (name, None));
    }
    assert_eq!((events.name(EventId(99)), events.topic(EventId(99))), ("", None));
}

#[test]
fn triggers_match_their_events() {
    let (a, b, c) = (EventId(0), EventId(1), EventId(2));
    let one_of = CompiledTrigger::OneOf([a, b].into());
    assert_eq!([a, b, c].map(|event| one_of.matches(event)), [true, true, false]);
    assert_eq!([a, b].map(|event| CompiledTrigger::Not(a).matches(event)), [false, true]);
    assert!(CompiledTrigger::Any.matches(c));
}

#[test]
fn assignments_know_topic_field_and_value() {
    let effects =
        effects("Ball.position.x = Motion.speed * 2; Motion.command = \"Init\"; Motion.state = PLAYING");
    let [Effect::Assign { topic, field, value }, command, state] = &effects[..] else {
        panic!("{effects:?}")
    };
    assert_eq!((*topic, &field[..], value.reads()), (BALL, &[POSITION, X][..], &[MOTION][..]));
    let context = TestContext::new().with(MOTION, &[FieldId(1)], Value::Int(-3));
    assert!(matches!(value.evaluate(&context), Ok(Value::Int(-6))));
    assert!(matches!(value.evaluate(&TestContext::new()), Ok(Value::Missing)));
    let Effect::Assign { value, .. } = command else { panic!("{command:?}") };
    assert!(matches!(value.evaluate(&context), Ok(Value::Text("Init"))));
    let Effect::Assign { value, .. } = state else { panic!("{state:?}") };
    assert!(matches!(value.evaluate(&context), Ok(Value::Enum(3))));
}

#[test]
fn a_condition_can_be_assigned() {
    let effects = effects("Ball.found = Ball.distance < limit || debug");
    let [Effect::Assign { value, .. }] = &effects[..] else { panic!("{effects:?}") };
    let context = TestContext::new().with(BALL, &[DISTANCE], Value::Float(0.1));
    assert!(matches!(value.evaluate(&context), Ok(Value::Bool(true))));
    assert!(matches!(value.evaluate(&TestContext::new()), Ok(Value::Missing)));
}

#[test]
fn other_effects() {
    let mut events = EventInterner::new();
    let text = "/ process_messages; publish.Ball; publish_all; StartTimeout(robot.period, 1ms); \
                TimeoutAction.motion_timeout.250; raise(done)";
    let effects = compile_with(text, &mut events).unwrap().effects;
    let expected = [
        Effect::ProcessMessages,
        Effect::Publish { topic: BALL },
        Effect::PublishAll,
        Effect::StartTimeout { timer: TimerId(1), delay: Duration::from_millis(1) },
        Effect::StartTimeout { timer: TimerId(0), delay: Duration::from_millis(250) },
        Effect::Raise { event: events.find("done").unwrap() },
    ];
    assert_eq!(effects[..], expected);
}

#[test]
fn actions_compile_without_a_transition() {
    let (vocabulary, constants, timers) = (vocabulary(), constants(), timers());
    let mut events = EventInterner::new();
    let (vocabulary, states) = (&vocabulary, &state_of);
    let mut scripts = ScriptInterner::new();
    let (constants, timers) = (&constants, &timers);
    let mut names = NameScope {
        vocabulary,
        constants,
        timers,
        events: &mut events,
        scripts: &mut scripts,
        states,
        suggestions: &Suggestions::default(),
    };
    let (actions, _) = parse_actions("raise(entered)");
    assert_eq!(compile_actions(&actions, &mut names), Ok([Effect::Raise { event: EventId(0) }].into()));
    let (actions, _) = parse_actions("Ball.x = 1; Ball.y = 2");
    assert_eq!(compile_actions(&actions, &mut names).map_err(|wrong| wrong.len()), Err(2));
    assert!(!events.is_empty());
}

#[test]
fn reads_are_found_wherever_they_stand() {
    let text = "near(ball.State.Ball, -GameState.score) || !(Motion == NULL) && 1 + `left.arm`.State.Arm.angle * 2 > 0 \
                || Ball.found && TimeoutCheck(robot.period) && motion_timeout";
    let guard = guard(text);
    assert_eq!(guard.reads(), [BALL, GAME, MOTION, LEFT_ARM]);
    assert_eq!(guard.timers(), [TimerId(0), TimerId(1)]);
}

#[test]
fn only_the_literal_is_literally_false() {
    assert!(guard("false").is_literally_false());
    assert!(!guard("debug").is_literally_false());
    assert!(!guard("TimeoutCheck(never)").is_literally_false());
    assert!(!guard("true").is_literally_false());
}

/// The deepest tree that parses can be compiled, evaluated, cloned, printed and dropped.
#[test]
fn the_deepest_tree_is_handled() {
    let opening = "!(false || true && 1 < 2 + 3 * abs(1.0) && ".repeat(127);
    let text = format!("{opening}true{}", ")".repeat(127));
    assert_eq!(guard(&text).clone().evaluate(&TestContext::new()), Ok(false));
    let tree = parse_condition(&text).0.unwrap();
    assert_eq!(tree.clone().to_string(), text);
}
