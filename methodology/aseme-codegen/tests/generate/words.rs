//! Bindings for the roles of the thesis, without the crates that declare the messages.

use aseme_codegen::generate::RustBindings;
use yase::vocabulary::{
    Enumeration, FieldEntry, FunctionEntry, MessageEntry, TopicEntry, TopicKind, TypeEnvironment, ValueType,
};
use yase::{FieldId, FunctionId, TopicId};

fn message(name: &str, fields: &[(&str, ValueType)]) -> MessageEntry {
    let field = |(id, (name, kind)): (usize, &(&str, ValueType))| FieldEntry {
        id: FieldId(id as u32),
        name: (*name).to_owned(),
        kind: kind.clone(),
    };
    MessageEntry { name: name.into(), fields: fields.iter().enumerate().map(field).collect() }
}

fn topic(id: u32, path: &str, message: &str) -> TopicEntry {
    TopicEntry { id: TopicId(id), path: path.into(), kind: TopicKind::State, message: message.into() }
}

/// Messages and functions of a game.
pub(crate) fn soccer() -> RustBindings {
    let state = ValueType::Enumeration("PlayerState".into());
    let numbers = ["time_to_cross", "crossing_bearing", "type"].map(|name| (name, ValueType::Number));
    let flags = ["found", "approaching"].map(|name| (name, ValueType::Bool));
    let rest = [("colour", ValueType::Text), ("place", ValueType::Message("Place".into()))];
    let ball: Vec<(&str, ValueType)> = numbers.into_iter().chain(flags).chain(rest).collect();
    let place = [("x", ValueType::Number), ("near", ValueType::Message("Place".into()))];
    let vocabulary = TypeEnvironment {
        topics: vec![topic(0, "soccer/ball", "Ball"), topic(1, "soccer/game_state", "GameState")],
        messages: vec![
            message("Ball", &ball),
            message("GameState", &[("player_state", state)]),
            message("Place", &place),
        ],
        enumerations: vec![Enumeration { name: "PlayerState".into(), values: vec![("PLAYING".into(), 3)] }],
        functions: vec![FunctionEntry {
            id: FunctionId(0),
            name: "abs".into(),
            parameters: vec![ValueType::Number],
            result: ValueType::Number,
        }],
        scripts: false,
    };
    let types = ["Ball", "GameState"].map(|name| (name.to_owned(), format!("soccer::{name}")));
    RustBindings {
        vocabulary,
        messages: types.into(),
        origin: "models/patrol.srm".into(),
        ..RustBindings::default()
    }
}
