//! The symbols of this program: messages, functions and activities.

use aseme_verify::ProgramSymbols;
use monas::Registry;
use monas_terminal::{CommandFailure, Format};

/// Prefixes of the topics that the runtime, bodies and the simulator publish and read.
const RUNTIME_PREFIXES: [&str; 3] = ["monas/", BODY_PREFIX, "sim/"];

/// The prefix of the topics of bodies.
const BODY_PREFIX: &str = "body/";

/// The functionality behind an activity of this program: the hardware abstraction layer if it uses
/// topics of the body, Narukom if it uses others; and its technology, the path of its Rust module.
/// None if the program does not have the activity.
pub(crate) fn functionality(registry: &Registry, activity: &str) -> Option<(String, String)> {
    let module = registry.activity_module(activity)?;
    let topics = registry.activity(activity).ok()?.topics();
    let paths = || topics.read_paths().iter().chain(topics.published_paths());
    let of_body = paths().any(|path| path.starts_with(BODY_PREFIX));
    let of_others = paths().any(|path| !path.starts_with(BODY_PREFIX));
    let functionality = match (of_body, of_others) {
        (true, true) => "hardware abstraction layer, Narukom",
        (true, false) => "hardware abstraction layer",
        (false, true) => "Narukom",
        (false, false) => "code without topics",
    };
    Some((functionality.to_owned(), module.to_owned()))
}

/// The messages and functions of this program, and its activities with their declared topics.
pub(crate) fn linked() -> Result<ProgramSymbols, CommandFailure> {
    let registry = Registry::linked();
    let vocabulary = registry.vocabulary().map_err(|error| CommandFailure::failed(Format::Text, error))?;
    let mut world = ProgramSymbols { vocabulary, ..ProgramSymbols::default() };
    for name in registry.activity_names() {
        let activity =
            registry.activity(name).map_err(|error| CommandFailure::failed(Format::Text, error))?;
        let topics = activity.topics();
        let named = |paths: &[&str]| {
            topics.is_declared().then(|| paths.iter().map(|&path| path.to_owned()).collect())
        };
        world.activities.insert(name.to_owned(), named(topics.published_paths()));
        world.readers.insert(name.to_owned(), named(topics.read_paths()));
        let ends = topics.ending_paths().iter().map(|&path| path.to_owned());
        world.ended_by.insert(name.to_owned(), ends.collect());
    }
    let paths = world.vocabulary.topics.iter().map(|topic| topic.path.clone());
    let is_elsewhere = |path: &String| RUNTIME_PREFIXES.iter().any(|begin| path.starts_with(begin));
    world.elsewhere = paths.filter(is_elsewhere).collect();
    Ok(world)
}
