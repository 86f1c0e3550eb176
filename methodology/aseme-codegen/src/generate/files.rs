//! The root file of a generated crate, and the modules of its activities.

use std::collections::{BTreeMap, BTreeSet};

use yase::{Diagnostic, Statechart};

use super::chart::import;
use super::code::{RustCode, literal, quoted};
use super::names::identifier;
use super::states::GeneratedStates;
use super::{CrateFiles, RustActivity, RustBindings, SKELETONS, refusal};

/// The root of the crate.
pub(crate) fn library(chart: &Statechart, words: &RustBindings) -> String {
    let origin = match words.origin.as_str() {
        "" => String::new(),
        origin => format!(
            "\n//!\n//! Generated from {}: changes here are lost when it is generated again.",
            quoted(origin)
        ),
    };
    let name = if words.name.is_empty() { &chart.name } else { &words.name };
    let transitions = if chart.transitions().len() > 0 { "mod transitions;\n" } else { "" };
    let activities = if words.registers { "pub mod activities;\n" } else { "" };
    let registration = match words.registers {
        true => format!("\n::monas::statechart!({} = chart, activities::instances);\n", literal(name)),
        false => String::new(),
    };
    format!(
        "//! The statechart {}.{origin}\n//!\n\
         //! [`State`] lists its states; the modules `chart` and `transitions` define its structure,\n\
         //! `guards` its guards and assigned values, `words` the names that they use.\n\n\
         {activities}mod chart;\nmod guards;\nmod states;\n{transitions}mod words;\n\n\
         pub use chart::chart;\npub use states::State;\n{registration}",
        quoted(&chart.name)
    )
}

/// The module that creates the activities, with skeletons for those without implementation.
pub(crate) fn activities(
    chart: &Statechart,
    states: &GeneratedStates,
    words: &RustBindings,
) -> Result<CrateFiles, Vec<Diagnostic>> {
    let names: BTreeSet<&str> = chart.nodes().filter_map(|(_, node)| node.activity.as_deref()).collect();
    let mut made = ActivityFiles::default();
    for name in names {
        match words.activities.get(name) {
            Some(known) => made.known(name, known),
            None => made.skeleton(name, words),
        }
    }
    if !made.found.is_empty() {
        return Err(made.found);
    }
    made.imported.entry("::monas::generated".into()).or_default().push("Instance".into());
    let instances = chart.nodes().filter_map(|(id, node)| {
        let activity = made.called.get(node.activity.as_deref()?)?;
        let state = RustCode::Plain(format!("State::{}", states.variant(id)));
        Some(match activity.is_function {
            true => RustCode::call("Instance::new", vec![state, RustCode::Plain(activity.path.clone())]),
            false => RustCode::call(format!("Instance::of::<{}>", activity.path), vec![state]),
        })
    });
    let lines: Vec<String> = instances.map(|code| format!("        {},\n", code.laid_out(8, 8, 1))).collect();
    let text = format!(
        "//! The activities of the states. A missing one is a compile error here.\n\n{}{}\n{}\
         /// A new instance for each state that has an activity.\npub(crate) fn instances() -> Vec<Instance> {{\n{}}}\n",
        made.modules(),
        made.imports(),
        if lines.is_empty() { "" } else { "use super::states::State;\n\n" },
        match lines.is_empty() {
            true => "    Vec::new()\n".to_owned(),
            false => format!("    vec![\n{}    ]\n", lines.concat()),
        },
    );
    let mut files = made.files;
    files.insert("src/activities.rs".into(), text);
    Ok(files)
}

#[derive(Default)]
struct ActivityFiles {
    /// The name of each activity in the module, by its name in the chart.
    called: BTreeMap<String, RustActivity>,
    /// Imported names by module.
    imported: BTreeMap<String, Vec<String>>,
    own: BTreeSet<String>,
    files: CrateFiles,
    found: Vec<Diagnostic>,
}

impl ActivityFiles {
    /// Imports an activity, or uses its full path if another has the same Rust name.
    fn known(&mut self, name: &str, activity: &RustActivity) {
        let (module, rust) = activity.path.rsplit_once("::").unwrap_or(("", &activity.path));
        let is_taken = USED_NAMES.contains(&rust) || self.called.values().any(|other| other.path == rust);
        let path = if is_taken || module.is_empty() { activity.path.clone() } else { rust.to_owned() };
        if path == rust && !module.is_empty() {
            self.imported.entry(module.to_owned()).or_default().push(rust.to_owned());
        }
        self.called.insert(name.to_owned(), RustActivity { path, is_function: activity.is_function });
    }

    fn skeleton(&mut self, name: &str, words: &RustBindings) {
        let (rust, module) = (camel(name), snake(name));
        if self.own.contains(&module) {
            let message = format!("the activity `{name}` and another would have one name in Rust: `{rust}`");
            self.found.push(refusal("E0922", message, "rename one of them"));
            return;
        }
        let is_taken = self.called.values().any(|other| other.path == rust);
        let path = if is_taken { format!("{module}::{rust}") } else { rust.clone() };
        if !is_taken {
            self.imported.entry(module.clone()).or_default().push(rust.clone());
        }
        // `mod r#move;` loads `move.rs`
        let file = module.strip_prefix("r#").unwrap_or(&module);
        self.files.insert(format!("{SKELETONS}{file}.rs"), skeleton_text(name, &rust, words));
        self.own.insert(module);
        self.called.insert(name.to_owned(), RustActivity { path, is_function: false });
    }

    fn modules(&self) -> String {
        let modules: String = self.own.iter().map(|module| format!("mod {module};\n")).collect();
        if modules.is_empty() { modules } else { format!("{modules}\n") }
    }

    /// Other generated crates may use the skeletons.
    fn imports(&self) -> String {
        let import = |(module, names): (&String, &Vec<String>)| {
            let mut names: Vec<&str> = names.iter().map(String::as_str).collect();
            names.sort_unstable();
            let visibility = if self.own.contains(module) { "pub " } else { "" };
            format!("{visibility}{}", import(module, &names))
        };
        self.imported.iter().map(import).collect()
    }
}

fn skeleton_text(name: &str, rust: &str, words: &RustBindings) -> String {
    let subjects = words.subjects.get(name).map_or(&[][..], Vec::as_slice);
    let subject = |(name, kind): &(String, String)| format!("//! - {}: {}\n", quoted(name), quoted(kind));
    let about = match subjects {
        [] => String::new(),
        subjects => format!(
            "//!\n//! Its variables in the model:\n//!\n{}",
            subjects.iter().map(subject).collect::<String>()
        ),
    };
    let registered = if name == rust { rust.to_owned() } else { format!("{rust} as {}", literal(name)) };
    let topics: BTreeSet<&str> = subjects.iter().filter_map(|(_, kind)| topic_of(kind, words)).collect();
    let (word, uses, declared) = match topics.is_empty() {
        true => ("", String::new(), String::new()),
        false => (", Topics", uses(&topics), declared(&topics)),
    };
    format!(
        "//! The activity {}.\n{about}\nuse monas::{{Activity, Blackboard, BoxError, Progress{word}}};\n{uses}\n\
         /// To be implemented.\n#[derive(Clone, Copy, Debug, Default)]\npub struct {rust};\n\n\
         impl Activity for {rust} {{\n\
         \x20   fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {{\n\
         \x20       Ok(Progress::Done)\n    }}\n{declared}}}\n\nmonas::activity!({registered});\n",
        quoted(name)
    )
}

/// The constant of the topic in a variable's type `topic.Kind.Message`.
fn topic_of<'a>(kind: &str, words: &'a RustBindings) -> Option<&'a str> {
    let (topic, message) = (kind.split('.').next()?, kind.rsplit('.').next()?);
    let fits = |path: &str| path.rsplit('/').next() == Some(topic);
    let mut known =
        words.vocabulary.topics.iter().filter(|known| known.message == message && fits(&known.path));
    words.topics.get(&known.next()?.path).map(String::as_str)
}

fn uses(topics: &BTreeSet<&str>) -> String {
    let mut modules: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (module, constant) in topics.iter().filter_map(|topic| topic.rsplit_once("::")) {
        modules.entry(module).or_default().push(constant);
    }
    modules.iter().map(|(module, constants)| import(module, constants)).collect()
}

/// The declaration of the topics that an activity reads; the developer adds those that it
/// publishes.
fn declared(topics: &BTreeSet<&str>) -> String {
    let last = |topic: &&str| topic.rsplit("::").next().unwrap_or_default().to_owned();
    let calls = topics.iter().map(|topic| format!(".reads({})", last(topic)));
    format!(
        "\n    fn topics(&self) -> Topics {{\n        Topics::declared(){}\n    }}\n",
        calls.collect::<String>()
    )
}

/// The types that the module of the activities uses itself.
const USED_NAMES: [&str; 3] = ["Instance", "State", "Vec"];

/// The types and constructors that a skeleton uses itself.
const SKELETON_NAMES: [&str; 7] =
    ["Activity", "Blackboard", "BoxError", "Ok", "Progress", "Result", "Topics"];

/// `UpperCamelCase`, with an underscore behind a name that the generated code uses.
fn camel(name: &str) -> String {
    let capital = |word: &str| {
        let mut letters = word.chars();
        letters
            .next()
            .map_or_else(String::new, |first| first.to_ascii_uppercase().to_string() + letters.as_str())
    };
    let text: String = identifier(&[name]).split('_').map(capital).collect();
    match USED_NAMES.contains(&text.as_str()) || SKELETON_NAMES.contains(&text.as_str()) {
        true => format!("{text}_"),
        false => text,
    }
}

/// `snake_case`.
fn snake(name: &str) -> String {
    let mut text = String::new();
    for letter in camel(name).chars() {
        if letter.is_ascii_uppercase() && !text.is_empty() && !text.ends_with('_') {
            text.push('_');
        }
        text.push(letter.to_ascii_lowercase());
    }
    super::names::field(&text)
}
