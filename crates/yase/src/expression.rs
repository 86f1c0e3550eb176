//! Transition expressions: what is written on the transitions of a chart, read, printed, checked and
//! evaluated.
//!
//! An expression is `trigger [guard] / actions`, each part optional:
//!
//! ```text
//! kick | Message.Whistle [Ball.found && Ball.distance < near] / StartTimeout(kicking, 500ms); raise(kicked)
//! ```
//!
//! It lives three lives, each a type of its own:
//!
//! - a [`TransitionExpression`] is the tree of what was written, with the place of each part.
//!   [`parse_transition`] makes it from text and never fails: it returns what it understood and
//!   [diagnostics](crate::Diagnostic). Its `Display` is the canonical text, which reads back as the same tree.
//!   Charts hold these trees; editors and checks read them.
//! - a [`CompiledTransition`] knows no names any more: [`TransitionExpression::compile`] has looked up each in
//!   [`Names`] and has checked all types, so that whatever is misspelt is said before a chart starts, with the
//!   nearest right name.
//! - a [`Guard`] is evaluated against [`Facts`], the data of one moment, without allocation and without
//!   comparing names.
//!
//! ```
//! use yase::expression::*;
//! use yase::statechart::{Constant, ConstantValue, NodeId};
//! use yase::vocabulary::*;
//!
//! // Two spellings, one tree, one canonical text.
//! let text = "[not Ball.found or Ball.distance() gt limit]/StartTimeout(look,1s)";
//! let (transition, diagnostics) = parse_transition(text);
//! assert!(diagnostics.is_empty());
//! let canonical = "[!Ball.found || Ball.distance > limit] / StartTimeout(look, 1000ms)";
//! assert_eq!(transition.to_string(), canonical);
//!
//! // What the names mean.
//! let field = |id, name: &str, kind| FieldEntry { id: FieldId(id), name: name.into(), kind };
//! let vocabulary = Vocabulary {
//!     topics: vec![TopicEntry {
//!         id: TopicId(0),
//!         path: "soccer/ball".into(),
//!         kind: TopicKind::State,
//!         message: "Ball".into(),
//!     }],
//!     messages: vec![MessageEntry {
//!         name: "Ball".into(),
//!         fields: vec![field(0, "found", ValueType::Bool), field(1, "distance", ValueType::Number)],
//!     }],
//!     ..Vocabulary::default()
//! };
//! let limit = Constant { name: "limit".into(), value: ConstantValue::Number(0.25) };
//! let timers: Vec<String> = transition.started_timers().collect();
//! let mut events = EventTable::new();
//! let mut scripts = ScriptTable::new();
//! let compiled = transition.compile(&mut Names {
//!     vocabulary: &vocabulary,
//!     constants: &[limit],
//!     timers: &timers,
//!     events: &mut events,
//!     scripts: &mut scripts,
//!     states: &|_| None,
//! });
//! let guard = compiled.expect("every name is known").guard.expect("it has a guard");
//! assert_eq!(guard.reads(), [TopicId(0)]);
//!
//! // A world in which a ball was seen at some distance, or none has been heard of.
//! struct Seen(Option<f64>);
//! impl Facts for Seen {
//!     fn field(&self, _: &MessageSource, path: &[FieldId]) -> Value<'_> {
//!         match (self.0, path) {
//!             (Some(_), [FieldId(0)]) => Value::Bool(true),
//!             (Some(distance), [FieldId(1)]) => Value::Float(distance),
//!             _ => Value::Missing,
//!         }
//!     }
//!     fn message(&self, _: &MessageSource) -> Value<'_> {
//!         Value::Missing
//!     }
//!     fn call(&self, _: FunctionId, _: &[Value<'_>]) -> Result<Value<'_>, CallError> {
//!         Err(CallError::new("there are no functions"))
//!     }
//!     fn timer(&self, _: TimerId) -> TimerState {
//!         TimerState::Unset
//!     }
//!     fn is_active(&self, _: NodeId) -> bool {
//!         false
//!     }
//! }
//! assert_eq!(guard.evaluate(&Seen(Some(0.5))), Ok(true));
//! assert_eq!(guard.evaluate(&Seen(Some(0.1))), Ok(false));
//! assert_eq!(guard.evaluate(&Seen(None)), Ok(false)); // unknown does not fire
//! ```
//!
//! # The language
//!
//! ```text
//! expression = [ trigger ] [ "[" condition "]" ] [ "/" action { (";" | ",") action } ]
//! trigger    = "*" | event { "|" event } | "not" event
//! condition  = both { "||" both }                        also: or
//! both       = comparison { "&&" comparison }            also: and
//! comparison = sum [ ("==" | "!=" | "<" | "<=" | ">" | ">=") sum ]     also: eq ne lt le gt ge
//!            | path ("==" | "!=") "NULL"
//! sum        = product { ("+" | "-") product }
//! product    = signed { ("*" | "/") signed }
//! signed     = ("!" | "-") signed | operand              also: not
//! operand    = number | "text" | "true" | "false" | path | function "(" [ condition { "," condition } ] ")"
//!            | "TimeoutCheck(" path ")" | "In(" state ")" | "script(" "text" ")" | "(" condition ")"
//! action     = path "=" condition | path ".set_" field "(" condition ")"
//!            | "publish." path [ ".set_" field "(" condition ")" ] | "raise(" event ")"
//!            | "StartTimeout(" path "," delay ")" | "TimeoutAction." path "." milliseconds
//!            | "script(" "text" ")" | "process_messages" | "publish_all"
//! path       = name { "." name [ "()" ] }
//! name       = letters, digits and "_", or anything in backquotes
//! delay      = number ("ms" | "s")
//! ```
//!
//! Newlines are blanks. No text, or the word `null`, is the empty expression.
//!
//! # What names mean
//!
//! With `M` a type of messages and `Kind` one of `Signal`, `State` and `Data`, a message is
//!
//! | written | is the latest |
//! |---|---|
//! | `M` | of the one topic that has messages of that type |
//! | `topic.Kind.M` or `topic` | of that topic, named by its last segment or, in backquotes, by its whole path |
//! | `publisher.M` | that this publisher made: an activity, or a state's path |
//! | `host.topic.Kind.M`, `host.publisher.M` | of another host |
//!
//! and a field is one of these, a dot and its name, and so on into messages within messages. A bare name is a
//! timer of the chart, a value of the enumeration it is compared with, a constant of the model, or a function
//! without arguments; two of these at once are an error.
//!
//! A script is a condition or an action in a language of the host's own, for embeddings that have one
//! ([`Vocabulary::scripts`](crate::Vocabulary::scripts)): the chart keeps its text, the host gives it a meaning.
//!
//! In a trigger, `Message.M`, `M`, `topic.Kind.M`, a signal's topic and a whole path mean the arrival of a
//! message; any other path is the name of an event.
//!
//! # Three values
//!
//! A condition that reads a message that has not arrived is *unknown*; `!`, `&&` and `||` are Kleene's; only
//! true fires. `M == NULL` is never unknown. A timer is true from its deadline on; one that was never started
//! is true by its bare name and false by `TimeoutCheck`. Numbers compare by value, whatever their width; sums
//! and products of whole numbers are exact, quotients are floating point.
//!
//! # Diagnostics
//!
//! | code | what is wrong |
//! |---|---|
//! | E0101 | a character has no meaning here |
//! | E0102 | a text or a name in backquotes is not closed |
//! | E0103 | an escape in a text is not one |
//! | E0104 | there is no name in the backquotes |
//! | E0105 | a number is too large |
//! | E0106 | an operand is missing |
//! | E0107 | an operator is missing |
//! | E0108 | `=` stands for `==` |
//! | E0109 | a parenthesis is not closed, or closes nothing |
//! | E0110 | a bracket is not closed |
//! | E0111 | comparisons are chained |
//! | E0112 | the nesting is too deep |
//! | E0113 | a member has arguments |
//! | E0114 | NULL is not compared with a message |
//! | E0115 | a name is missing |
//! | E0116 | the trigger cannot be read |
//! | E0117 | there is no condition in the brackets |
//! | E0118 | the action cannot be read |
//! | E0119 | a delay cannot be read |
//! | E0120 | something follows a complete part |
//! | E0121 | a setter cannot be read |
//! | E0122 | a single bar or ampersand stands for two |
//! | E0123 | a script is no text |
//! | E0130 | a bare name is not known |
//! | E0131 | a name has several meanings |
//! | E0132 | a message or topic is not known |
//! | E0133 | no topic, or several, have the message or the name |
//! | E0134 | a field is not known |
//! | E0135 | a topic has no such messages |
//! | E0136 | a function takes other arguments |
//! | E0137 | a value has another type than is needed |
//! | E0138 | a field is compared with NULL |
//! | E0139 | a function is not known |
//! | E0140 | a state is not known |
//! | E0141 | a timer is not one of the blackboard |
//! | E0142 | another's message is written |
//! | E0143 | a delay is too short |
//! | E0144 | a message is raised |
//! | E0145 | a whole message is assigned, or a field published |
//! | E0146 | a trigger names a field or one publisher's messages |
//! | E0147 | a script stands where there are none |

mod arithmetic;
mod compile;
mod facts;
mod lexer;
mod names;
mod parser;
mod print;
mod program;
mod reads;
mod syntax;

pub(crate) use arithmetic::{arithmetic, compare, negative as negated};
pub use compile::{CompiledTransition, CompiledTrigger, Effect, compile_actions};
pub use facts::{CallError, Facts, MessageSource, Origin, TimerId, TimerState};
pub use names::{EventId, EventTable, Names, ScriptId, ScriptTable};
pub use parser::{parse_actions, parse_actions_at, parse_condition, parse_transition, parse_transition_at};
pub use program::{Guard, GuardError, Literal, Operand, Term, Test};
pub use syntax::{
    Action, ActionKind, Additive, Comparison, Expression, ExpressionKind, Multiplicative, Name, Path, Place,
    TimeoutForm, TransitionExpression, Trigger, started_timers,
};

#[cfg(test)]
mod tests;
