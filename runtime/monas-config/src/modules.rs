//! Modules named by a configuration.

use std::path::Path;

use yase::Diagnostic;

use super::agents::{AgentReader, ModuleLoading, is_enabled};
use super::element::Element;
use super::grammar::Grammar;
use super::paths;
use super::values::Values;
use monas_core::error::Error;
use monas_core::module::Module;
use monas_module::ModuleFile;

/// Loads the modules named by elements, so that their activities are known.
pub(crate) fn read(reader: &mut AgentReader<'_>, elements: &[Element]) {
    for element in modules(elements) {
        if element.text().is_empty() || !is_enabled(&Values::of(element, reader.grammar)) {
            continue; // what is empty has been said
        }
        if let Some(module) = module(reader, element) {
            match reader.registry.with_module(module.clone()) {
                Ok(registry) => {
                    reader.registry = registry;
                    reader.setup.modules.push(module);
                }
                Err(error) => reader.diagnostics.push(taken(element, &error)),
            }
        }
    }
}

/// The elements that name modules, in order.
pub(crate) fn modules(elements: &[Element]) -> impl Iterator<Item = &Element> {
    elements.iter().flat_map(|element| {
        let inside: Vec<&Element> = match element.is("agents") {
            true => modules(element.children()).collect(),
            false => vec![element].into_iter().filter(|element| element.is("module")).collect(),
        };
        inside
    })
}

/// The module in the file named by an element, loaded once; none, with a diagnostic, on errors.
fn module(reader: &mut AgentReader<'_>, element: &Element) -> Option<Module> {
    let found = match paths::locate(reader.path, element.text()) {
        Ok(found) => found,
        Err(near) => {
            let diagnostic =
                element.error("E0316", element.text_span(), format!("no module `{}`", element.text()));
            reader.diagnostics.push(match near {
                Some(near) => diagnostic.with_hint(format!("did you mean `{near}`?")),
                None => diagnostic.with_hint("`monas module build` builds modules and prints their paths"),
            });
            return None;
        }
    };
    if let Some(known) = reader.registry.modules().find(|known| is_same(known.file(), &found)) {
        return Some(known.clone());
    }
    if reader.loading == ModuleLoading::Refused {
        let message = "the text names a module that the run has not loaded";
        let hint = "load it first: `monas module load FILE`";
        let diagnostic = element.error("E0358", element.text_span(), message.to_owned());
        reader.diagnostics.push(diagnostic.with_hint(hint));
        return None;
    }
    let placed = |wrong: Diagnostic| {
        let placed = element.error(wrong.code, element.text_span(), wrong.message);
        match wrong.hint {
            Some(hint) => placed.with_hint(hint),
            None => placed,
        }
    };
    match ModuleFile::read(&found).and_then(|file| file.load()) {
        Ok(module) => other_of_its_name(reader, element, module),
        Err(wrong) => {
            reader.diagnostics.extend(wrong.into_iter().map(placed));
            None
        }
    }
}

/// Rejects a second module of the same name.
fn other_of_its_name(reader: &mut AgentReader<'_>, element: &Element, module: Module) -> Option<Module> {
    let Some(other) = reader.registry.module(module.name()) else { return Some(module) };
    let message = format!("another module has the name `{}`: {}", module.name(), other.file().display());
    let hint = "change the name of a module by `monas::module!(name = other_eyes)`";
    reader.diagnostics.push(element.error("E0365", element.text_span(), message).with_hint(hint));
    None
}

/// Whether two paths name the same file.
fn is_same(one: &Path, other: &Path) -> bool {
    one == other || one.canonicalize().is_ok_and(|one| other.canonicalize().is_ok_and(|other| one == other))
}

fn taken(element: &Element, error: &Error) -> Diagnostic {
    let diagnostic = element.error("E0364", element.text_span(), error.to_string());
    match error.hint() {
        Some(hint) => diagnostic.with_hint(hint),
        None => diagnostic,
    }
}

/// The module files named by the elements of a text, resolved relative to the text, by element.
pub(crate) fn files<'a>(
    elements: &'a [Element],
    path: &Path,
    grammar: &Grammar,
) -> Vec<(&'a Element, Option<std::path::PathBuf>)> {
    let enabled = modules(elements).filter(|element| is_enabled(&Values::of(element, grammar)));
    enabled.map(|element| (element, paths::locate(path, element.text()).ok())).collect()
}

/// Whether a file is that of a module.
pub(crate) fn is_of(file: &Path, module: &Module) -> bool {
    is_same(file, module.file())
}
