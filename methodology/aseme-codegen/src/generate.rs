//! A statechart as a Rust crate (IAC2Monas; Tables 4.2 and 4.3 of the thesis): [`generate`].
//!
//! As in the thesis, each node and each transition becomes a statement that builds the chart, and
//! each expression becomes code: the states are an enumeration, the structure is a list of
//! statements, and each guard and each assigned value is a function. Functions read messages as
//! structs, so a missing message, field or activity is a compile error. The engine still interprets
//! the chart ([`yase_codegen::typed`] explains why), so the traces of a chart do not depend on how
//! it is run.
//!
//! [`RustBindings`] map the names of a model to Rust. The program provides them: `monas generate`,
//! a build script, or a test.
//!
//! ```
//! use aseme_codegen::generate::{RustBindings, generate};
//! use yase::Source;
//!
//! let (chart, found) = aseme_models::statechart_of(&Source::new("visitor.srm", "visitor = (look . greet)~"));
//! assert!(found.is_empty());
//! let files = generate(&chart, &RustBindings::default()).expect("the chart can be written as Rust");
//! let transitions = &files["src/transitions.rs"];
//! assert!(transitions.contains("chart.connect(State::look, State::greet, \"\");"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | code | error |
//! |---|---|
//! | E0920 | an expression has no counterpart in Rust |
//! | E0921 | a message has no Rust type |
//! | E0922 | two activities would have one name |
//! | E0923 | a build script would have to write a skeleton |

mod body;
mod chart;
mod code;
mod expressions;
mod files;
mod name_table;
mod names;
mod states;

use std::collections::BTreeMap;

use yase::{Diagnostic, Semantics, Span, Statechart, TypeEnvironment};

pub use names::{identifier, path_of};

/// Maps the names of a chart to expressions and to Rust.
#[derive(Clone, Debug)]
pub struct RustBindings {
    /// The names that expressions can use.
    pub vocabulary: TypeEnvironment,
    /// The Rust type of each message, by its name in the vocabulary: `monas_soccer::Ball`.
    pub messages: BTreeMap<String, String>,
    /// The Rust constant of each topic, by its path: `monas_soccer::topics::BALL` for
    /// `soccer/ball`.
    pub topics: BTreeMap<String, String>,
    /// The Rust path of each activity, by its name in charts. The others get skeletons.
    pub activities: BTreeMap<String, RustActivity>,
    /// The variables of each activity in the model, with their types. Skeletons document them and
    /// declare the topics among them.
    pub subjects: BTreeMap<String, Vec<(String, String)>>,
    /// The module that re-exports [`yase_codegen::typed`].
    pub runtime: String,
    /// Whether the crate registers its chart and activities, which requires the runtime of Monas.
    pub registers: bool,
    /// The source named in the first lines of the crate.
    pub origin: String,
    /// The name of the chart in configurations; if empty, its own name.
    pub name: String,
}

impl Default for RustBindings {
    /// Charts without messages, run by `yase` alone.
    fn default() -> RustBindings {
        RustBindings {
            vocabulary: TypeEnvironment::default(),
            messages: BTreeMap::new(),
            topics: BTreeMap::new(),
            activities: BTreeMap::new(),
            subjects: BTreeMap::new(),
            runtime: "yase_codegen::typed".to_owned(),
            registers: false,
            origin: String::new(),
            name: String::new(),
        }
    }
}

/// An activity in Rust.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RustActivity {
    /// Its path: `monas_soccer::activities::Vision`.
    pub path: String,
    /// Whether it is a function; otherwise it is a type that implements `Default`.
    pub is_function: bool,
}

/// The files of a crate, by their paths within it.
pub type CrateFiles = BTreeMap<String, String>;

/// The skeletons among the files of a crate; existing files of this folder are not overwritten.
pub const SKELETONS: &str = "src/activities/";

/// Writes a chart as the sources of a crate. Equal charts and bindings yield equal files, formatted
/// as rustfmt would with this project's settings, except lines that are too long for it.
///
/// # Errors
/// All errors of [`Statechart::compile`], and elements that cannot be represented in Rust.
pub fn generate(chart: &Statechart, words: &RustBindings) -> Result<CrateFiles, Vec<Diagnostic>> {
    let compiled = chart.compile_with(&words.vocabulary, Semantics::yase())?;
    let words = &with_absolute_paths(words);
    let states = states::GeneratedStates::new(chart);
    let mut glossary = name_table::NameTable::new(chart, words);
    let functions = expressions::functions(&compiled, &states, &mut glossary)?;
    let mut files = CrateFiles::new();
    files.insert("src/lib.rs".into(), files::library(chart, words));
    files.insert("src/states.rs".into(), states.file(words));
    files.insert("src/words.rs".into(), glossary.file());
    files.insert("src/guards.rs".into(), functions.file(&glossary));
    files.insert("src/chart.rs".into(), chart::file(chart, &states, &glossary, &functions));
    let transitions = chart::transitions(chart, &states, &glossary, &functions);
    files.extend(transitions.map(|text| ("src/transitions.rs".into(), text)));
    if words.registers {
        files.extend(files::activities(chart, &states, words)?);
    }
    Ok(files)
}

/// The bindings with absolute paths: a crate called `messages` is not the module of that name that
/// the generated crate has itself.
fn with_absolute_paths(words: &RustBindings) -> RustBindings {
    let mut words = words.clone();
    words.runtime = names::absolute(&words.runtime);
    for path in words.messages.values_mut() {
        *path = names::absolute(path);
    }
    for activity in words.activities.values_mut() {
        activity.path = names::absolute(&activity.path);
    }
    words
}

/// A construct that cannot be expressed in Rust.
fn refusal(code: &'static str, message: impl Into<String>, hint: &str) -> Diagnostic {
    Diagnostic::error(code, Span::default(), message).with_hint(hint)
}
