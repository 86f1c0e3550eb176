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

/// What the names of a chart mean, in expressions and in Rust.
#[derive(Clone, Debug)]
pub struct RustBindings {
    /// What expressions may name.
    pub vocabulary: TypeEnvironment,
    /// The Rust type of each message, by its name in the vocabulary: `monas_soccer::Ball`.
    pub messages: BTreeMap<String, String>,
    /// The constant that stands for each topic in Rust, by its path: `monas_soccer::topics::BALL`
    /// for `soccer/ball`.
    pub topics: BTreeMap<String, String>,
    /// Where each activity is in Rust, by its name in charts. One that is not here gets a skeleton.
    pub activities: BTreeMap<String, RustActivity>,
    /// What activities are about, by their names: variables of the model with their types.
    /// Skeletons say it, and declare the topics among them.
    pub subjects: BTreeMap<String, Vec<(String, String)>>,
    /// The module that has [`yase_codegen::typed`]'s names.
    pub runtime: String,
    /// Whether the crate registers itself and makes its activities: whether the runtime is that of
    /// Monas.
    pub registers: bool,
    /// What the first lines of the crate say it was made from.
    pub origin: String,
    /// The name that configurations know the chart by; its own if it is empty.
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
    /// Whether it is a function; else it is a type made by `Default`.
    pub is_function: bool,
}

/// The files of a crate, by their paths within it.
pub type CrateFiles = BTreeMap<String, String>;

/// The skeletons among the files of a crate; existing files of this folder are not overwritten.
pub const SKELETONS: &str = "src/activities/";

/// Writes a chart as the sources of a crate. Equal charts and words give equal files, laid out as
/// rustfmt does with this project's settings where their lines are not too long for it.
///
/// # Errors
/// Everything that is wrong with the chart, as [`Statechart::compile`] finds it, and what cannot be
/// said in Rust.
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

/// Something that Rust has no word for.
fn refusal(code: &'static str, message: impl Into<String>, hint: &str) -> Diagnostic {
    Diagnostic::error(code, Span::default(), message).with_hint(hint)
}
