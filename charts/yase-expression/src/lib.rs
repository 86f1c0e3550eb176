//! Transition expressions, the texts on the transitions of a chart: parsed, printed, checked and
//! evaluated.
//!
//! An expression is `trigger [guard] / actions`, each part optional:
//!
//! ```text
//! kick | Message.Whistle [Ball.found && Ball.distance < near] / StartTimeout(kicking, 500ms); raise(kicked)
//! ```
//!
//! It has three forms, each a separate type:
//!
//! - a [`TransitionExpression`] is the syntax tree, with the position of each part.
//!   [`parse_transition`] makes it from text and never fails: it returns the part that it
//!   understood and [diagnostics](crate::Diagnostic). Its `Display` is the canonical text, which
//!   parses to the same tree. Charts contain these trees; editors and checks read them.
//! - a [`CompiledTransition`] contains no names: [`TransitionExpression::compile`] has resolved
//!   each of them in a [`NameScope`] and checked all types. Misspelt names are reported before a
//!   chart starts, with the nearest known name.
//! - a [`Guard`] is evaluated in an [`EvalContext`], the current data, without allocation and
//!   without comparison of names.
//!
//! ```
//! use yase_expression::diagnostic::Suggestions;
//! use yase_expression::*;
//! use yase_expression::vocabulary::*;
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
//! let vocabulary = TypeEnvironment {
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
//!     ..TypeEnvironment::default()
//! };
//! let limit = Constant { name: "limit".into(), value: ConstantValue::Number(0.25) };
//! let timers: Vec<String> = transition.started_timers().collect();
//! let mut events = EventInterner::new();
//! let mut scripts = ScriptInterner::new();
//! let compiled = transition.compile(&mut NameScope {
//!     vocabulary: &vocabulary,
//!     constants: &[limit],
//!     timers: &timers,
//!     events: &mut events,
//!     scripts: &mut scripts,
//!     states: &|_| None,
//!     suggestions: &Suggestions::default(),
//! });
//! let guard = compiled.expect("every name is known").guard.expect("it has a guard");
//! assert_eq!(guard.reads(), [TopicId(0)]);
//!
//! // The data of a step: the distance of the ball, or no message about it.
//! struct Seen(Option<f64>);
//! impl EvalContext for Seen {
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
//! Newlines are blanks. An empty text, or the word `null`, is the empty expression.
//!
//! # What names mean
//!
//! With `M` a message type and `Kind` one of `Signal`, `State` and `Data`, a message is
//!
//! | written | is the latest |
//! |---|---|
//! | `M` | of the only topic that has messages of that type |
//! | `topic.Kind.M` or `topic` | of that topic, named by its last segment or, in backquotes, by its whole path |
//! | `publisher.M` | of this publisher: an activity, or the path of a state |
//! | `host.topic.Kind.M`, `host.publisher.M` | of another host |
//!
//! and a field is a message, a dot and the name of the field; nested messages have further dots. A
//! bare name is a timer of the chart, a value of the enumeration it is compared with, a constant of
//! the model, or a function without arguments. A name with two of these meanings is an error.
//!
//! A script is a condition or an action in the language of the host, for embeddings that have one
//! ([`TypeEnvironment::scripts`](crate::vocabulary::TypeEnvironment::scripts)): the chart keeps its
//! text, and the host executes it.
//!
//! In a trigger, `Message.M`, `M`, `topic.Kind.M`, the topic of a signal and a complete topic path
//! denote the arrival of a message; any other path is the name of an event.
//!
//! # Three values
//!
//! A condition that reads a message that has not arrived is *unknown*; `!`, `&&` and `||` follow
//! Kleene's logic; only true enables a transition. `M == NULL` is never unknown. A timer is true
//! from its deadline on; one that was never started is true by its bare name and false by
//! `TimeoutCheck`. Numbers compare by value, regardless of width; sums and products of integers are
//! exact, quotients are floating-point numbers.
//!
//! # Diagnostics
//!
//! | code | what is wrong |
//! |---|---|
//! | E0101 | invalid character |
//! | E0102 | a text or a name in backquotes is not closed |
//! | E0103 | unknown escape in a text |
//! | E0104 | empty name in backquotes |
//! | E0105 | a number is too large |
//! | E0106 | missing operand |
//! | E0107 | missing operator |
//! | E0108 | `=` instead of `==` |
//! | E0109 | unbalanced parenthesis |
//! | E0110 | a bracket is not closed |
//! | E0111 | comparisons are chained |
//! | E0112 | the nesting is too deep |
//! | E0113 | a member has arguments |
//! | E0114 | NULL is not compared with a message |
//! | E0115 | missing name |
//! | E0116 | invalid trigger |
//! | E0117 | the brackets are empty |
//! | E0118 | invalid action |
//! | E0119 | invalid delay |
//! | E0120 | unexpected text after a complete part |
//! | E0121 | invalid setter |
//! | E0122 | a single bar or ampersand instead of two |
//! | E0123 | the argument of `script` is not a text |
//! | E0130 | unknown bare name |
//! | E0131 | ambiguous name |
//! | E0132 | unknown message or topic |
//! | E0133 | no topic, or several, for a message or name |
//! | E0134 | unknown field |
//! | E0135 | a topic without messages of this type |
//! | E0136 | wrong arguments of a function |
//! | E0137 | wrong type |
//! | E0138 | a field is compared with NULL |
//! | E0139 | unknown function |
//! | E0140 | unknown state |
//! | E0141 | the timer belongs to another blackboard |
//! | E0142 | a message of another publisher or host is written |
//! | E0143 | a delay is too short |
//! | E0144 | a message is raised |
//! | E0145 | a whole message is assigned, or a field published |
//! | E0146 | a trigger names a field or one publisher's messages |
//! | E0147 | a script in a host without scripts |

pub mod arithmetic;
mod compile;
mod constant;
pub mod diagnostic;
mod eval_context;
mod field;
mod guard_error;
mod ir;
mod lexer;
mod names;
pub mod native;
mod node_id;
mod parser;
mod print;
mod read_set;
mod syntax;
pub mod vocabulary;

pub use compile::{CompiledTransition, CompiledTrigger, Effect, compile_actions};
pub use constant::{Constant, ConstantValue};
pub use diagnostic::{Diagnostic, Severity, Source, Span};
pub use eval_context::{CallError, EvalContext, MessageSource, Origin, TimerId, TimerState};
pub use field::{Field, inside_mut, set};
pub use guard_error::GuardError;
pub use ir::{BooleanTerm, Guard, Literal, Operand, ValueTerm};
pub use names::{EventId, EventInterner, NameScope, ScriptId, ScriptInterner};
pub use node_id::NodeId;
pub use parser::{parse_actions, parse_actions_at, parse_condition, parse_transition, parse_transition_at};
pub use syntax::{
    Action, ActionKind, Additive, Comparison, Expression, ExpressionKind, Multiplicative, Name, Path,
    TextPosition, TimeoutForm, TransitionExpression, Trigger, started_timers,
};
pub use vocabulary::{FieldId, FunctionId, TopicId, TypeEnvironment, Value};

#[cfg(test)]
mod tests;
