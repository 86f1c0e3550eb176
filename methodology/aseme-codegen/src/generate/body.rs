//! Function bodies of a chart, with names and documentation.

use std::collections::{BTreeMap, BTreeSet};

use yase::{ActionLocation, CompiledChart, NodeId, TransitionId};

use super::code::{MAX_LINE_LENGTH, RustCode, quoted};
use super::name_table::NameTable;
use super::names::identifier;

/// An assignment: the functions that compute its value and set its field, and its message.
#[derive(PartialEq, Eq)]
pub(crate) struct AssignmentBody {
    pub(crate) value: RustCode,
    pub(crate) put: RustCode,
    /// The constant of the message, and its Rust type.
    pub(crate) target: String,
    pub(crate) rust: String,
    /// The names of its fields, joined by underscores.
    pub(crate) field: String,
}

/// The functions of a chart.
#[derive(Default)]
pub(crate) struct GeneratedFunctions {
    taken: BTreeSet<String>,
    guards: BTreeMap<TransitionId, String>,
    values: BTreeMap<(ActionLocation, usize), [String; 3]>,
    /// The names of functions that set fields, by their bodies.
    puts: BTreeMap<(String, String), String>,
    text: Vec<String>,
}

/// The longest part of a path that is used in names of functions.
const MAX_NAME_PART: usize = 24;

impl GeneratedFunctions {
    /// The function of a guard.
    pub(crate) fn guard_of(&self, id: TransitionId) -> Option<&str> {
        self.guards.get(&id).map(String::as_str)
    }

    /// The values of the actions at a location: the index of the action, the message, the function
    /// that computes the value, and the function that sets it.
    pub(crate) fn values_at(&self, location: ActionLocation) -> impl Iterator<Item = (usize, &[String; 3])> {
        let actions = self.values.range((location, 0)..=(location, usize::MAX));
        actions.map(|((_, index), names)| (*index, names))
    }

    pub(crate) fn guard(&mut self, chart: &CompiledChart, id: TransitionId, code: RustCode) {
        let transition = chart.statechart().transition(id);
        let [source, target] = [transition.source, transition.target].map(|node| short(chart, node));
        let name = self.name(match (source, target) {
            (Some(source), Some(target)) => format!("from_{source}_to_{target}"),
            _ => format!("transition_{}", id.0),
        });
        let guard = transition.expression.guard.as_ref().map(ToString::to_string).unwrap_or_default();
        let about = format!("{}: {}", transition_description(chart, id), quoted(&format!("[{guard}]")));
        let input = parameter(&code);
        let body = code.untried();
        self.text.push(format!(
            "/// {about}\npub(crate) fn {name}({input}: &GuardInput<'_>) -> GuardResult {{\n    {}\n}}\n",
            body.laid_out(4, 4, 0)
        ));
        self.guards.insert(id, format!("guards::{name}"));
    }

    pub(crate) fn value(&mut self, chart: &CompiledChart, at: (ActionLocation, usize), body: AssignmentBody) {
        if self.values.contains_key(&at) {
            return; // the same on another blackboard
        }
        let message = body.target.rsplit("::").next().unwrap_or_default().to_ascii_lowercase();
        let wanted = identifier(&[&format!("{message}_{}", body.field)]);
        let name = self.name(wanted.clone());
        let input = parameter(&body.value);
        self.text.push(format!(
            "/// {}\npub(crate) fn {name}<'a>({input}: &GuardInput<'a>) -> Computed<'a> {{\n    {}\n}}\n",
            action_description(chart, at),
            body.value.laid_out(4, 4, 0)
        ));
        let put = match self.puts.get(&(body.target.clone(), body.field.clone())) {
            Some(known) => known.clone(),
            None => self.put(&wanted, &body),
        };
        self.values.insert(at, [body.target, format!("guards::{name}"), format!("guards::{put}")]);
    }

    fn put(&mut self, wanted: &str, body: &AssignmentBody) -> String {
        let name = self.name(format!("set_{wanted}"));
        let parameters = [format!("message: &mut {}", body.rust), "value: Value<'_>".to_owned()];
        let line = format!("pub(crate) fn {name}({}) -> Result<(), CallError> {{", parameters.join(", "));
        let head = match line.chars().count() <= MAX_LINE_LENGTH {
            true => line,
            false => format!(
                "pub(crate) fn {name}(\n    {},\n) -> Result<(), CallError> {{",
                parameters.join(",\n    ")
            ),
        };
        self.text.push(format!(
            "/// Sets {}.\n{head}\n    {}\n}}\n",
            quoted(&format!("{}.{}", body.rust.trim_start_matches("::"), body.field)),
            body.put.laid_out(4, 4, 0)
        ));
        self.puts.insert((body.target.clone(), body.field.clone()), name.clone());
        name
    }

    /// A name that no other function has.
    fn name(&mut self, wanted: String) -> String {
        let numbered = (2..).map(|count| format!("{wanted}_{count}"));
        let free = std::iter::once(wanted.clone()).chain(numbered).find(|name| !self.taken.contains(name));
        let name = free.unwrap_or(wanted);
        self.taken.insert(name.clone());
        name
    }

    pub(crate) fn file(&self, glossary: &NameTable<'_>) -> String {
        let mut text = String::from("//! The guards of transitions and the values of assignments.\n");
        if self.text.is_empty() {
            return text;
        }
        text += "\n#![allow(non_snake_case)] // the names are those of states\n\n";
        let functions = self.text.join("\n");
        text += &super::chart::import(&glossary.words.runtime, &used(&functions, &RUNTIME_NAMES));
        if functions.contains("State::") {
            text += "\nuse super::states::State;\n";
        }
        let modules =
            used(&functions, &glossary.modules().iter().map(|name| (*name, *name)).collect::<Vec<_>>());
        if !modules.is_empty() {
            let gap = if functions.contains("State::") { "" } else { "\n" };
            text += &format!("{gap}{}", super::chart::import("super::words", &modules));
        }
        format!("{text}\n{functions}")
    }
}

/// The names that functions use from the runtime, with the text that reveals the use.
const RUNTIME_NAMES: [(&str, &str); 25] = [
    ("CallError", "CallError"),
    ("Computed", "Computed<"),
    ("GuardInput", "GuardInput<"),
    ("GuardResult", "GuardResult"),
    ("Value", "Value<"),
    ("all", "all!("),
    ("any", "any!("),
    ("at_least", "at_least("),
    ("at_most", "at_most("),
    ("attempt", "attempt("),
    ("differ", "differ("),
    ("equal", "equal("),
    ("given", "given("),
    ("holds", "holds("),
    ("inside", "inside("),
    ("inside_mut", "inside_mut("),
    ("less", "less("),
    ("minus", "minus("),
    ("more", "more("),
    ("negative", "negative("),
    ("over", "over("),
    ("plus", "plus("),
    ("set", "set("),
    ("times", "times("),
    ("whole", "whole("),
];

/// The known names whose text occurs in the code at a word boundary.
fn used<'a>(code: &str, known: &[(&'a str, &str)]) -> Vec<&'a str> {
    let code: String = code.lines().filter(|line| !line.starts_with("///")).collect::<Vec<_>>().join("\n");
    let begins = |at: usize| {
        let before = code[..at].chars().next_back();
        before.is_none_or(|c| !c.is_alphanumeric() && c != '_' && c != '.' && c != ':' && c != '"')
    };
    let is_used = |text: &str| code.match_indices(text).any(|(at, _)| begins(at));
    let mut names: Vec<&str> =
        known.iter().filter(|(_, text)| is_used(text)).map(|(name, _)| *name).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// The name of the parameter `input`: `_` if the function does not use it.
fn parameter(code: &RustCode) -> &'static str {
    if code.flat().contains("input.") { "input" } else { "_" }
}

/// The name of a node in function names; none if it would be too long.
fn short(chart: &CompiledChart, node: NodeId) -> Option<String> {
    let path = chart.short_path(node);
    let name = identifier(&[path.rsplit('/').next().unwrap_or_default()]);
    (name.len() <= MAX_NAME_PART && !name.contains("__")).then_some(name)
}

fn transition_description(chart: &CompiledChart, id: TransitionId) -> String {
    let transition = chart.statechart().transition(id);
    let [source, target] = [transition.source, transition.target].map(|node| node_description(chart, node));
    format!("From {source} to {target}")
}

/// The name of a node in documentation: its name, or its kind or number and the name of its parent.
fn node_description(chart: &CompiledChart, node: NodeId) -> String {
    let statechart = chart.statechart();
    let own = statechart.path(node);
    let own = quoted(own.rsplit('/').next().unwrap_or_default());
    let named = statechart.ancestors(node).find(|&around| !statechart.node(around).name.is_empty());
    match named.filter(|_| statechart.node(node).name.is_empty()) {
        Some(around) => format!("{own} in {}", quoted(&statechart.node(around).name)),
        None => own,
    }
}

fn action_description(chart: &CompiledChart, (location, index): (ActionLocation, usize)) -> String {
    let statechart = chart.statechart();
    let (actions, text) = match location {
        ActionLocation::Transition(id) => {
            (&statechart.transition(id).expression.actions, transition_description(chart, id))
        }
        ActionLocation::Entry(id) => {
            (&statechart.node(id).entry, format!("On the entry of {}", node_description(chart, id)))
        }
        ActionLocation::Exit(id) => {
            (&statechart.node(id).exit, format!("On the exit of {}", node_description(chart, id)))
        }
    };
    let action = actions.get(index).map(ToString::to_string).unwrap_or_default();
    format!("{text}: {}", quoted(&action))
}
