//! A type environment for compilation, and data for evaluation.

use std::collections::{BTreeMap, BTreeSet};

use crate::constant::{Constant, ConstantValue};
use crate::diagnostic::{Diagnostic, Suggestions};
use crate::node_id::NodeId;
use crate::vocabulary::{
    Enumeration, FieldEntry, FieldId, FunctionEntry, FunctionId, MessageEntry, TopicEntry, TopicId,
    TopicKind, TypeEnvironment, Value, ValueType,
};
use crate::{
    CallError, CompiledTransition, EvalContext, EventInterner, Guard, GuardError, MessageSource, NameScope,
    Origin, ScriptInterner, TimerId, TimerState, parse_transition,
};

pub(crate) const BALL: TopicId = TopicId(10);
pub(crate) const GAME: TopicId = TopicId(11);
pub(crate) const MOTION: TopicId = TopicId(12);
pub(crate) const LEFT_ARM: TopicId = TopicId(13);
pub(crate) const BEHAVIOR_FALL: TopicId = TopicId(16);

pub(crate) const ABS: FunctionId = FunctionId(0);
pub(crate) const NEAR: FunctionId = FunctionId(1);
pub(crate) const KICK_OFF: FunctionId = FunctionId(2);
pub(crate) const ROOT: FunctionId = FunctionId(3);

pub(crate) const DISTANCE: FieldId = FieldId(0);
pub(crate) const FOUND: FieldId = FieldId(1);
pub(crate) const COLOUR: FieldId = FieldId(2);
pub(crate) const POSITION: FieldId = FieldId(3);
pub(crate) const X: FieldId = FieldId(0);

fn topic(id: TopicId, path: &str, kind: TopicKind, message: &str) -> TopicEntry {
    TopicEntry { id, path: path.into(), kind, message: message.into() }
}

fn message(name: &str, fields: &[(&str, ValueType)]) -> MessageEntry {
    let fields = fields.iter().enumerate();
    let fields = fields.map(|(id, (name, kind))| FieldEntry {
        id: FieldId(id as u32),
        name: (*name).into(),
        kind: kind.clone(),
    });
    MessageEntry { name: name.into(), fields: fields.collect() }
}

fn function(id: FunctionId, name: &str, parameters: Vec<ValueType>, result: ValueType) -> FunctionEntry {
    FunctionEntry { id, name: name.into(), parameters, result }
}

pub(crate) fn vocabulary() -> TypeEnvironment {
    let of = |name: &str| ValueType::Message(name.into());
    let player_state = ValueType::Enumeration("PlayerState".into());
    let phase = ValueType::Enumeration("Phase".into());
    TypeEnvironment {
        scripts: false,
        topics: vec![
            topic(BALL, "soccer/ball", TopicKind::State, "Ball"),
            topic(GAME, "game/state", TopicKind::State, "GameState"),
            topic(MOTION, "body/motion", TopicKind::Signal, "Motion"),
            topic(LEFT_ARM, "left/arm", TopicKind::State, "Arm"),
            topic(TopicId(14), "right/arm", TopicKind::State, "Arm"),
            topic(TopicId(15), "behavior", TopicKind::State, "Position"),
            topic(BEHAVIOR_FALL, "behavior", TopicKind::Signal, "Fall"),
            topic(TopicId(17), "left/whistle", TopicKind::Signal, "Sound"),
            topic(TopicId(18), "right/whistle", TopicKind::Signal, "Sound"),
        ],
        messages: vec![
            message(
                "Ball",
                &[
                    ("distance", ValueType::Number),
                    ("found", ValueType::Bool),
                    ("colour", ValueType::Text),
                    ("position", of("Point")),
                ],
            ),
            message("Point", &[("x", ValueType::Number), ("y", ValueType::Number)]),
            message(
                "GameState",
                &[("player_state", player_state.clone()), ("phase", phase), ("score", ValueType::Number)],
            ),
            message(
                "Motion",
                &[("command", ValueType::Text), ("speed", ValueType::Number), ("state", player_state)],
            ),
            message("Arm", &[("angle", ValueType::Number)]),
            message("Position", &[("x", ValueType::Number)]),
            message("Fall", &[("fall", ValueType::Number)]),
            message("Sound", &[("loudness", ValueType::Number)]),
            message("Unheard", &[]),
        ],
        enumerations: vec![
            Enumeration {
                name: "PlayerState".into(),
                values: vec![("READY".into(), 1), ("PLAYING".into(), 3)],
            },
            Enumeration { name: "Phase".into(), values: vec![("FIRST".into(), 0), ("PLAYING".into(), 7)] },
        ],
        functions: vec![
            function(ABS, "abs", vec![ValueType::Number], ValueType::Number),
            function(NEAR, "near", vec![of("Ball"), ValueType::Number], ValueType::Bool),
            function(KICK_OFF, "kick_off", vec![], ValueType::Bool),
            function(ROOT, "soccer::root", vec![ValueType::Number], ValueType::Number),
            function(FunctionId(4), "crowded", vec![ValueType::Number; 9], ValueType::Bool),
            function(FunctionId(5), "both", vec![], ValueType::Number),
        ],
    }
}

pub(crate) fn constants() -> Vec<Constant> {
    let constant = |name: &str, value| Constant { name: name.into(), value };
    vec![
        constant("limit", ConstantValue::Number(0.25)),
        constant("own", ConstantValue::Text("blue".into())),
        constant("debug", ConstantValue::Bool(false)),
        constant("both", ConstantValue::Number(2.0)),
        constant("READY", ConstantValue::Number(5.0)),
    ]
}

/// The timers of the scope; their ids are 0 and 1.
pub(crate) fn timers() -> Vec<String> {
    vec!["motion_timeout".into(), "robot.period".into()]
}

pub(crate) fn state_of(path: &str) -> Option<NodeId> {
    match path {
        "play/(a|b)~" => Some(NodeId(7)),
        "stand" => Some(NodeId(8)),
        _ => None,
    }
}

/// Parses without diagnostics, and compiles.
pub(crate) fn compile_with(
    text: &str,
    events: &mut EventInterner,
) -> Result<CompiledTransition, Vec<Diagnostic>> {
    let (expression, diagnostics) = parse_transition(text);
    assert_eq!(diagnostics, [], "{text}");
    let (vocabulary, constants, timers) = (vocabulary(), constants(), timers());
    expression.compile(&mut NameScope {
        vocabulary: &vocabulary,
        constants: &constants,
        timers: &timers,
        events,
        scripts: &mut ScriptInterner::new(),
        states: &state_of,
        suggestions: &Suggestions::default(),
    })
}

pub(crate) fn compiled(text: &str) -> CompiledTransition {
    compile_with(text, &mut EventInterner::new()).unwrap_or_else(|wrong| panic!("{text}: {wrong:?}"))
}

pub(crate) fn guard(condition: &str) -> Guard {
    compiled(&format!("[{condition}]")).guard.expect("a guard")
}

/// `E0123 <text under the span>: message (hint)` of each diagnostic.
pub(crate) fn said(text: &str, diagnostics: &[Diagnostic]) -> Vec<String> {
    let one = |diagnostic: &Diagnostic| {
        assert!(diagnostic.is_error());
        let under = &text[diagnostic.span.start..diagnostic.span.end];
        let hint = diagnostic.hint.as_ref().map_or(String::new(), |hint| format!(" ({hint})"));
        format!("{} <{under}>: {}{hint}", diagnostic.code, diagnostic.message)
    };
    diagnostics.iter().map(one).collect()
}

/// Fields that have arrived, timers, and active states.
#[derive(Default)]
pub(crate) struct TestContext {
    fields: BTreeMap<(MessageSource, Vec<FieldId>), Value<'static>>,
    timers: BTreeMap<TimerId, TimerState>,
    active: BTreeSet<NodeId>,
    pub(crate) calls: std::cell::RefCell<Vec<(FunctionId, String)>>,
}

impl TestContext {
    pub(crate) fn new() -> TestContext {
        TestContext::default()
    }

    pub(crate) fn with(self, topic: TopicId, path: &[FieldId], value: Value<'static>) -> TestContext {
        self.with_from(Origin::Own, topic, path, value)
    }

    pub(crate) fn with_from(
        mut self,
        origin: Origin,
        topic: TopicId,
        path: &[FieldId],
        value: Value<'static>,
    ) -> TestContext {
        self.fields.insert((MessageSource { topic, origin }, path.to_vec()), value);
        self
    }

    pub(crate) fn with_timer(mut self, timer: u32, state: TimerState) -> TestContext {
        self.timers.insert(TimerId(timer), state);
        self
    }

    pub(crate) fn with_active(mut self, state: u32) -> TestContext {
        self.active.insert(NodeId(state));
        self
    }

    /// Evaluates a condition.
    pub(crate) fn holds(&self, condition: &str) -> Result<bool, GuardError> {
        guard(condition).evaluate(self)
    }
}

impl EvalContext for TestContext {
    fn field(&self, source: &MessageSource, path: &[FieldId]) -> Value<'_> {
        self.fields.get(&(source.clone(), path.to_vec())).copied().unwrap_or(Value::Missing)
    }

    fn message(&self, source: &MessageSource) -> Value<'_> {
        let arrived = self.fields.keys().any(|(other, _)| other == source);
        if arrived { Value::Message(&()) } else { Value::Missing }
    }

    fn call(&self, function: FunctionId, arguments: &[Value<'_>]) -> Result<Value<'_>, CallError> {
        self.calls.borrow_mut().push((function, format!("{arguments:?}")));
        match (function, arguments) {
            (ABS, [Value::Float(number)]) => Ok(Value::Float(number.abs())),
            (ABS, [Value::Int(number)]) => Ok(Value::Int(number.abs())),
            (NEAR, [Value::Message(_), Value::Float(limit)]) => Ok(Value::Bool(*limit > 0.5)),
            (KICK_OFF, []) => Ok(Value::Bool(true)),
            (ROOT, [Value::Float(number)]) if *number >= 0.0 => Ok(Value::Float(number.sqrt())),
            _ => Err(CallError::new("no root of a negative number")),
        }
    }

    fn timer(&self, timer: TimerId) -> TimerState {
        self.timers.get(&timer).copied().unwrap_or(TimerState::Unset)
    }

    fn is_active(&self, state: NodeId) -> bool {
        self.active.contains(&state)
    }
}
