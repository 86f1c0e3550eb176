//! Transition expressions: findings are valid, the canonical text parses to itself, and compiling
//! terminates.

use std::collections::BTreeSet;

use yase::diagnostic::Suggestions;
use yase::expression::{
    EventInterner, NameScope, ScriptInterner, parse_actions, parse_condition, parse_transition,
};
use yase::statechart::{Constant, ConstantValue};
use yase::vocabulary::{
    Enumeration, FieldEntry, FieldId, FunctionEntry, FunctionId, MessageEntry, TopicEntry, TopicId,
    TopicKind, TypeEnvironment, ValueType,
};

use crate::{assert_findings_fit, text_of};

/// Checks the documented guarantees for one input.
pub fn transition(data: &[u8]) {
    let text = text_of(data);
    assert_findings_fit(text, &parse_condition(text).1);
    assert_findings_fit(text, &parse_actions(text).1);
    let (transition, findings) = parse_transition(text);
    assert_findings_fit(text, &findings);
    if findings.is_empty() {
        let canonical = transition.to_string();
        let (again, findings) = parse_transition(&canonical);
        assert_eq!(findings, [], "{canonical}");
        assert_eq!(again.to_string(), canonical);
    }
    let timers: BTreeSet<String> = transition.started_timers().collect();
    let timers: Vec<String> = timers.into_iter().collect();
    let mut events = EventInterner::new();
    let compiled = transition.compile(&mut NameScope {
        vocabulary: &vocabulary(),
        constants: &[Constant { name: "near".into(), value: ConstantValue::Number(0.25) }],
        timers: &timers,
        events: &mut events,
        scripts: &mut ScriptInterner::new(),
        states: &|_| None,
        suggestions: &Suggestions::default(),
    });
    if let Err(findings) = compiled {
        assert!(!findings.is_empty());
        assert_findings_fit(text, &findings);
    }
}

/// A vocabulary of ball and game, so that some expressions can be compiled.
fn vocabulary() -> TypeEnvironment {
    let field = |id, name: &str, kind| FieldEntry { id: FieldId(id), name: name.into(), kind };
    let topic = |id, path: &str, kind, message: &str| TopicEntry {
        id: TopicId(id),
        path: path.into(),
        kind,
        message: message.into(),
    };
    let ball = vec![
        field(0, "found", ValueType::Bool),
        field(1, "x", ValueType::Number),
        field(2, "name", ValueType::Text),
        field(3, "owner", ValueType::Message("Game".into())),
    ];
    let game = vec![field(0, "phase", ValueType::Enumeration("Phase".into()))];
    TypeEnvironment {
        scripts: true,
        topics: vec![
            topic(0, "soccer/ball", TopicKind::State, "Ball"),
            topic(1, "soccer/game", TopicKind::Signal, "Game"),
            topic(2, "soccer/old_game", TopicKind::Data, "Game"),
        ],
        messages: vec![
            MessageEntry { name: "Ball".into(), fields: ball },
            MessageEntry { name: "Game".into(), fields: game },
        ],
        enumerations: vec![Enumeration {
            name: "Phase".into(),
            values: vec![("READY".into(), 0), ("PLAYING".into(), 1)],
        }],
        functions: vec![FunctionEntry {
            id: FunctionId(0),
            name: "abs".into(),
            parameters: vec![ValueType::Number],
            result: ValueType::Number,
        }],
    }
}
