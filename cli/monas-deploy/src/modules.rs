//! Modules of a configuration. They must be built like the robot's program, so they are deployed
//! only if the file of robots lists them.

use std::path::Path;

use monas::config::{Element, Grammar, Layers, locate, resolve};
use yase::Diagnostic;

use crate::robot::Robot;

/// Reports the modules that a robot's configuration loads and the release would not contain.
/// `grammar` is that of the configuration.
pub fn missing_modules(robot: &Robot, grammar: &Grammar) -> Vec<Diagnostic> {
    let resolved = resolve(&robot.config, grammar, &Layers::new());
    let mut named = Vec::new();
    resolved.elements.iter().for_each(|element| collect(element, &mut named));
    let goes = |module: &&&Element| {
        let found = locate(&robot.config, module.text().trim()).ok();
        found.is_some_and(|found| robot.files.iter().any(|file| is_same(file, &found)))
    };
    let left = named.iter().filter(|module| !goes(module));
    left.map(|module| {
        let file = module.text().trim();
        let message = format!("the module `{file}` would not be deployed");
        let hint = format!(
            "link its crate into the program, or write `<file>{file}</file>` into the robot, built as its program is"
        );
        module.error("E0742", module.text_span(), message).with_hint(hint)
    })
    .collect()
}

fn collect<'e>(element: &'e Element, found: &mut Vec<&'e Element>) {
    if element.is("module") {
        found.push(element);
    }
    element.children().iter().for_each(|child| collect(child, found));
}

fn is_same(one: &Path, other: &Path) -> bool {
    one.canonicalize().is_ok_and(|one| other.canonicalize().is_ok_and(|other| one == other))
}
