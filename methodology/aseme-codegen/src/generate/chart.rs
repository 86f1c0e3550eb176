//! Writes the structure of a chart as statements: one file for states, one for transitions.

use std::time::Duration;

use yase::{ActionLocation, NodeId, Statechart, Transition, TransitionId};

use super::body::GeneratedFunctions;
use super::code::{MAX_LINE_LENGTH, RustCode, literal};
use super::name_table::NameTable;
use super::states::GeneratedStates;

pub(crate) fn file(
    chart: &Statechart,
    states: &GeneratedStates,
    glossary: &NameTable<'_>,
    functions: &GeneratedFunctions,
) -> String {
    let writer = ChartCodeWriter { chart, states, functions };
    let declarations: String = glossary.declarations().iter().map(RustCode::statement).collect();
    let nodes: String =
        chart.nodes().flat_map(|(id, _)| writer.node(id)).map(|code| code.statement()).collect();
    let parts = [
        ("words", "The names that guards and actions use.", declarations),
        ("states", "The states and connectors, in the order of the document.", nodes),
    ];
    let mut calls = String::new();
    let mut text = String::new();
    for (name, about, statements) in parts.iter().filter(|(.., statements)| !statements.is_empty()) {
        calls += &format!("    {name}(&mut chart);\n");
        text += &format!("\n/// {about}\nfn {name}(chart: &mut TypedChartBuilder) {{\n{statements}}}\n");
    }
    if chart.transitions().len() > 0 {
        calls += "    transitions(&mut chart);\n";
    }
    let is_mutated =
        if calls.is_empty() && chart.node(Statechart::ROOT).name == chart.name { "" } else { "mut " };
    let root = match &chart.node(Statechart::ROOT).name {
        same if *same == chart.name => String::new(),
        other => RustCode::call("chart.call_root", vec![RustCode::Plain(literal(other))]).statement(),
    };
    format!(
        "//! The structure of the chart.\n\n{}\n\
         /// The chart, with a function for each of its guards and values.\n///\n/// # Errors\n\
         /// Only if it was edited and is inconsistent.\n\
         pub fn chart() -> Result<TypedChart, Vec<Diagnostic>> {{\n\
         \x20   let {is_mutated}chart = TypedChartBuilder::new({});\n{root}{calls}    chart.finish()\n}}\n{text}",
        imports(glossary, &text, &["Diagnostic", "TypedChart"], chart.transitions().len() > 0),
        literal(&chart.name),
    )
}

/// The file of transitions; none if there are none.
pub(crate) fn transitions(
    chart: &Statechart,
    states: &GeneratedStates,
    glossary: &NameTable<'_>,
    functions: &GeneratedFunctions,
) -> Option<String> {
    let writer = ChartCodeWriter { chart, states, functions };
    let of = |(id, transition)| writer.transition(id, transition);
    let statements: String = chart.transitions().flat_map(of).map(|code| code.statement()).collect();
    (!statements.is_empty()).then(|| {
        format!(
            "//! The transitions of the chart.\n\n{}\n\
             /// The transitions, in the order of the document, each with its guard.\n\
             pub(crate) fn transitions(chart: &mut TypedChartBuilder) {{\n{statements}}}\n",
            imports(glossary, &statements, &[], false)
        )
    })
}

/// The imports of a file: the states, transitions and runtime names that its text uses.
fn imports(glossary: &NameTable<'_>, text: &str, beside: &[&'static str], has_transitions: bool) -> String {
    let mut imports = String::new();
    if text.contains("Duration::") {
        imports += "use std::time::Duration;\n\n";
    }
    let known = [("NodeKind", "NodeKind::"), ("SourceDeclaration", "SourceDeclaration::")];
    let used = known.iter().filter(|(_, used)| text.contains(used)).map(|(name, _)| *name);
    let mut runtime: Vec<&str> = used.chain(beside.iter().copied()).chain(["TypedChartBuilder"]).collect();
    runtime.sort_unstable();
    imports += &import(&glossary.words.runtime, &runtime);
    let mut own = String::new();
    if text.contains("guards::") {
        own += "use super::guards;\n";
    }
    if text.contains("State::") {
        own += "use super::states::State;\n";
    }
    if has_transitions {
        own += "use super::transitions::transitions;\n";
    }
    let modules: Vec<&str> =
        glossary.modules().into_iter().filter(|name| text.contains(&format!("{name}::"))).collect();
    if !modules.is_empty() {
        own += &import("super::words", &modules);
    }
    if own.is_empty() { imports } else { format!("{imports}\n{own}") }
}

/// `use module::{names};`, with as many names in a line as fit.
pub(crate) fn import(module: &str, names: &[&str]) -> String {
    if let [name] = names {
        return format!("use {module}::{name};\n");
    }
    let line = format!("use {module}::{{{}}};\n", names.join(", "));
    if line.chars().count() <= MAX_LINE_LENGTH + 1 {
        return line;
    }
    let mut lines = vec![String::from("   ")];
    for name in names {
        let is_full = lines.last().is_some_and(|line| line.len() + name.len() + 2 > MAX_LINE_LENGTH);
        if is_full {
            lines.push(String::from("   "));
        }
        if let Some(line) = lines.last_mut() {
            *line += &format!(" {name},");
        }
    }
    format!("use {module}::{{\n{}\n}};\n", lines.join("\n"))
}

struct ChartCodeWriter<'a> {
    chart: &'a Statechart,
    states: &'a GeneratedStates,
    functions: &'a GeneratedFunctions,
}

impl ChartCodeWriter<'_> {
    fn state(&self, node: NodeId) -> RustCode {
        RustCode::Plain(format!("State::{}", self.states.variant(node)))
    }

    /// The statements that declare a node.
    fn node(&self, id: NodeId) -> Vec<RustCode> {
        let node = self.chart.node(id);
        let about = |method: &str, value: String| {
            RustCode::call(format!("chart.{method}"), vec![self.state(id), RustCode::Plain(value)])
        };
        let mut code = Vec::new();
        if let Some(parent) = node.parent {
            let kind = RustCode::Plain(format!("NodeKind::{:?}", node.kind));
            let arguments =
                vec![self.state(id), self.state(parent), kind, RustCode::Plain(literal(&node.name))];
            code.push(RustCode::call("chart.add", arguments));
        }
        code.extend(node.activity.as_ref().map(|name| about("activity", literal(name))));
        if node.priority != 0 {
            code.push(about("priority", node.priority.to_string()));
        }
        code.extend(node.duration.map(|duration| about("duration", duration_text(duration))));
        if !node.defer.is_empty() {
            let events = node.defer.iter().map(|event| RustCode::Plain(literal(event))).collect();
            code.push(RustCode::call("chart.defer", vec![self.state(id), RustCode::List(events)]));
        }
        for (method, actions, location) in [
            ("entry", &node.entry, ActionLocation::Entry(id)),
            ("exit", &node.exit, ActionLocation::Exit(id)),
        ] {
            if !actions.is_empty() {
                let text = actions.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ");
                code.push(about(method, literal(&text)));
                code.extend(self.values(location));
            }
        }
        code
    }

    /// The statements that declare a transition.
    fn transition(&self, id: TransitionId, transition: &Transition) -> Vec<RustCode> {
        let text = match transition.expression.is_empty() {
            true => String::new(),
            false => transition.expression.to_string(),
        };
        let ends = [transition.source, transition.target].map(|node| self.state(node));
        let [source, target] = ends;
        let mut code =
            vec![RustCode::call("chart.connect", vec![source, target, RustCode::Plain(literal(&text))])];
        let mut say = |method: &str, value: Option<String>| {
            code.push(RustCode::call(
                format!("chart.{method}"),
                value.map(RustCode::Plain).into_iter().collect(),
            ));
        };
        if let Some(guard) = self.functions.guard_of(id) {
            say("guard", Some(guard.to_owned()));
        }
        if transition.priority != 0 {
            say("prefer", Some(transition.priority.to_string()));
        }
        if let Some(weight) = transition.weight {
            say("weight", Some(format!("{weight:?}")));
        }
        if transition.interrupts {
            say("interrupts", None);
        }
        if transition.internal {
            say("internal", None);
        }
        code.extend(self.values(ActionLocation::Transition(id)));
        code
    }

    fn values(&self, location: ActionLocation) -> Vec<RustCode> {
        let value = |(index, names): (usize, &[String; 3])| {
            let names = names.iter().cloned().map(RustCode::Plain);
            RustCode::call(
                "chart.value",
                std::iter::once(RustCode::Plain(index.to_string())).chain(names).collect(),
            )
        };
        self.functions.values_at(location).map(value).collect()
    }
}

fn duration_text(duration: Duration) -> String {
    let nanos = duration.as_nanos();
    match (nanos % 1_000_000_000, nanos % 1_000_000) {
        (0, _) => format!("Duration::from_secs({})", duration.as_secs()),
        (_, 0) => format!("Duration::from_millis({})", duration.as_millis()),
        _ => format!("Duration::new({}, {})", duration.as_secs(), duration.subsec_nanos()),
    }
}
