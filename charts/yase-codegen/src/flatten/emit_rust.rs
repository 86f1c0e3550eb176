//! A flattened chart as Rust.

use std::fmt::Write as _;

use super::names::UniqueNames;
use super::{FlatEvent, FlatMachine, FlatOp, FlatPath};

impl FlatMachine {
    /// A Rust module: an `enum` of its events, a trait of its conditions and actions, and an `enum`
    /// of its states that handles events.
    pub fn to_rust(&self) -> String {
        let mut code = RustEmitter { flat: self, names: GeneratedNames::of(self), text: String::new() };
        code.head();
        code.events();
        code.host();
        code.states();
        code.text
    }
}

/// Identifiers of the parts of a chart.
struct GeneratedNames {
    states: Vec<String>,
    events: Vec<String>,
    conditions: Vec<String>,
    actions: Vec<String>,
}

impl GeneratedNames {
    fn of(flat: &FlatMachine) -> GeneratedNames {
        let (mut states, mut events, mut methods) =
            (UniqueNames::default(), UniqueNames::default(), UniqueNames::default());
        let last = |path: &String| path.rsplit('/').next().unwrap_or_default().to_owned();
        let state = |state: &super::FlatState| match state.is_over {
            true => String::from("Over"),
            false => state.leaves.iter().map(last).collect::<Vec<_>>().join(" "),
        };
        let event = |event: &FlatEvent| match event {
            FlatEvent::Named(name) => name.clone(),
            FlatEvent::Other => String::from("Other"),
            FlatEvent::Nothing => String::from("Nothing"),
        };
        GeneratedNames {
            states: flat.states.iter().map(|it| states.variant(&state(it))).collect(),
            events: flat.events.iter().map(|it| events.variant(&event(it))).collect(),
            conditions: flat.conditions.iter().map(|text| methods.method(text)).collect(),
            actions: flat.actions.iter().map(|text| methods.method(text)).collect(),
        }
    }
}

struct RustEmitter<'f> {
    flat: &'f FlatMachine,
    names: GeneratedNames,
    text: String,
}

impl RustEmitter<'_> {
    fn line(&mut self, depth: usize, text: &str) {
        if !text.is_empty() {
            _ = write!(self.text, "{:1$}", "", 4 * depth);
        }
        self.text.push_str(text);
        self.text.push('\n');
    }

    fn lines(&mut self, text: &str) {
        self.text.push_str(text);
    }

    fn head(&mut self) {
        let chart = match in_words(&self.flat.name) {
            name if name.is_empty() => String::from("A statechart"),
            name => format!("The statechart `{name}`"),
        };
        self.lines(&format!(
            "\
//! {chart}, flattened. Generated: changes here are lost.
//!
//! `State::start` returns the initial state, `State::handle` reacts to an event.
//! Conditions and actions are methods of `Host`.
#![allow(dead_code, clippy::all)] // unused items are allowed, and generated code has one style

"
        ));
    }

    fn events(&mut self) {
        self.lines("/// The external events.\n#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]\npub enum Event {\n");
        for (event, name) in self.flat.events.iter().zip(&self.names.events.clone()) {
            let about = match event {
                FlatEvent::Named(text) => format!("/// `{}`", in_words(text)),
                FlatEvent::Other => String::from("/// Any event that the chart does not name."),
                FlatEvent::Nothing => String::from("/// None, but conditions may hold now that did not."),
            };
            self.line(1, &about);
            self.line(1, &format!("{name},"));
        }
        self.end();
    }

    fn host(&mut self) {
        self.lines("/// The conditions and actions of the chart.\npub trait Host {\n");
        for (text, name) in self.flat.conditions.iter().zip(&self.names.conditions.clone()) {
            self.line(1, &format!("/// The condition `{}`", in_words(text)));
            self.line(1, &format!("fn {name}(&self) -> bool;"));
        }
        for (text, name) in self.flat.actions.iter().zip(&self.names.actions.clone()) {
            self.line(1, &format!("/// The action `{}`", in_words(text)));
            self.line(1, &format!("fn {name}(&mut self);"));
        }
        self.end();
    }

    /// The end of an item; an empty item is written on one line.
    fn end(&mut self) {
        if self.text.ends_with("{\n") {
            self.text.pop();
        }
        self.lines("}\n\n");
    }

    fn states(&mut self) {
        self.lines(
            "/// The configurations.\n#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]\npub enum State {\n",
        );
        let states = self.flat.states.iter().zip(self.names.states.clone());
        for (state, name) in states.clone() {
            self.line(1, &about(&state.leaves));
            self.line(1, &format!("{name},"));
        }
        self.lines("}\n\nimpl State {\n    /// The initial state.\n");
        self.start();
        self.lines("\n    /// Reacts to an event.\n");
        self.handle();
        self.lines("\n    /// The paths of the innermost active states; none after the end.\n");
        self.line(1, "pub const fn active(self) -> &'static [&'static str] {");
        self.line(2, "match self {");
        for (state, name) in states {
            let paths: Vec<String> = state.leaves.iter().map(|leaf| format!("{leaf:?}")).collect();
            self.line(3, &format!("State::{name} => &[{}],", paths.join(", ")));
        }
        self.line(2, "}");
        self.line(1, "}");
        self.lines("}\n");
    }

    fn start(&mut self) {
        let flat = self.flat;
        let host = if flat.start.pieces.is_empty() { "_host" } else { "host" };
        self.line(1, &format!("pub fn start({host}: &mut impl Host) -> State {{"));
        self.path(&flat.start, 2, ArmEnd::Is { is_last: true });
        self.line(1, "}");
    }

    fn handle(&mut self) {
        let flat = self.flat;
        let is_quiet = flat.paths.iter().flatten().all(|path| path.pieces.is_empty());
        let host = if is_quiet { "_host" } else { "host" };
        self.line(1, "#[inline]");
        self.line(1, &format!("pub fn handle(&mut self, event: Event, {host}: &mut impl Host) {{"));
        self.line(2, "match (*self, event) {");
        let mut has_all = !flat.events.is_empty();
        for (state, paths) in flat.paths.iter().enumerate() {
            for (event, path) in paths.iter().enumerate() {
                has_all &= self.arm(state, event, path);
            }
        }
        if !has_all {
            self.line(3, "_ => {}");
        }
        self.line(2, "}");
        self.line(1, "}");
    }

    /// The match arm of an event in a state; false if the event has no effect.
    fn arm(&mut self, state: usize, event: usize, path: &FlatPath) -> bool {
        let head = format!("(State::{}, Event::{}) =>", self.names.states[state], self.names.events[event]);
        match (path.pieces.is_empty(), path.to == state) {
            (true, true) => return false,
            (true, false) => {
                self.line(3, &format!("{head} *self = State::{},", self.names.states[path.to].clone()))
            }
            _ => {
                self.line(3, &format!("{head} {{"));
                self.path(path, 4, ArmEnd::Becomes { from: state, is_last: true });
                self.line(3, "}");
            }
        }
        true
    }

    fn path(&mut self, path: &FlatPath, depth: usize, ending: ArmEnd) {
        for (index, piece) in path.pieces.iter().enumerate() {
            match piece {
                FlatOp::Do(action) => {
                    self.line(depth, &format!("host.{}();", self.names.actions[*action].clone()))
                }
                FlatOp::If(condition, other) => {
                    self.line(depth, &format!("if host.{}() {{", self.names.conditions[*condition].clone()));
                    let nothing_follows = index + 1 == path.pieces.len() && ending.is_done_at(path.to);
                    let early = if nothing_follows { ending } else { ending.early() };
                    self.path(other, depth + 1, early);
                    self.line(depth, "}");
                }
            }
        }
        let to = format!("State::{}", self.names.states[path.to]);
        match ending {
            ArmEnd::Is { is_last: true } => self.line(depth, &to),
            ArmEnd::Is { is_last: false } => self.line(depth, &format!("return {to};")),
            ArmEnd::Becomes { from, is_last } => {
                if path.to != from {
                    self.line(depth, &format!("*self = {to};"));
                }
                if !is_last {
                    self.line(depth, "return;");
                }
            }
        }
    }
}

/// The end of a path in generated code.
#[derive(Clone, Copy)]
enum ArmEnd {
    /// The state is the result.
    Is { is_last: bool },
    /// The state is assigned if it differs from the current one.
    Becomes { from: usize, is_last: bool },
}

impl ArmEnd {
    /// The same before the end of a function.
    fn early(self) -> ArmEnd {
        match self {
            ArmEnd::Is { .. } => ArmEnd::Is { is_last: false },
            ArmEnd::Becomes { from, .. } => ArmEnd::Becomes { from, is_last: false },
        }
    }

    /// Whether nothing is written if this is the state.
    fn is_done_at(self, to: usize) -> bool {
        matches!(self, ArmEnd::Becomes { from, is_last: true } if from == to)
    }
}

fn about(leaves: &[String]) -> String {
    match leaves {
        [] => String::from("/// It is over."),
        leaves => format!(
            "/// In {}.",
            leaves.iter().map(|leaf| format!("`{}`", in_words(leaf))).collect::<Vec<_>>().join(", ")
        ),
    }
}

/// A text on one line, without characters that end a comment or change the direction of text.
fn in_words(text: &str) -> String {
    let shown = |letter: char| match letter {
        '`' => '\'',
        '"' | '\'' | '\\' => letter,
        _ if letter.escape_debug().len() > 1 => '?',
        _ => letter,
    };
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").chars().map(shown).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_items_are_on_one_line() {
        let mut chart = yase::Statechart::new("");
        let start = chart.add(yase::Statechart::ROOT, yase::Node::new(yase::NodeKind::Start, ""));
        let only = chart.add(yase::Statechart::ROOT, yase::Node::new(yase::NodeKind::Basic, "only"));
        chart.connect(yase::Transition::new(start, only));
        let code = crate::flatten::flatten(&chart, yase::Semantics::yase(), 1).unwrap().to_rust();
        assert!(code.starts_with("//! A statechart, flattened. "), "{code}");
        assert!(code.contains("pub enum Event {}\n\n") && code.contains("pub trait Host {}\n\n"), "{code}");
    }

    #[test]
    fn remarks_stay_remarks() {
        assert_eq!(in_words("a\n  `b`\u{202e}c \"d\" \\ e'f ü"), "a 'b'?c \"d\" \\ e'f ü");
    }
}
