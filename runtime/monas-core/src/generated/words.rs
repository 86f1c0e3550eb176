//! Rust names of the topics, functions and activities that charts use.

use std::collections::BTreeMap;

use aseme_codegen::generate::{RustActivity, RustBindings};
use narukom::{TOPICS, TopicDeclaration};

use crate::error::Error;
use crate::registry::{ACTIVITIES, ActivityDeclaration, Registry};
use crate::vocabulary::{message_names, vocabulary};

/// Rust bindings for generated code: the topics, functions and activities of the crates of this
/// program.
///
/// An activity is named by the module it is registered in. Modules inside one called `activities`
/// are left out, since that one re-exports them.
///
/// # Errors
/// Two functions, or two activities, have the same name.
pub fn words(registry: &Registry) -> Result<RustBindings, Error> {
    let functions = registry.functions()?;
    let mut activities = BTreeMap::new();
    for declaration in ACTIVITIES {
        registry.activity(declaration.name)?;
        let path = format!("{}::{}", shown(declaration.module), code(declaration));
        let known = RustActivity { path, is_function: declaration.is_function };
        activities.insert(declaration.name.to_owned(), known);
    }
    let mut messages = BTreeMap::new();
    for (topic, name) in message_names(TOPICS) {
        messages.insert(name, public(topic.rust_type()));
    }
    let constant = |topic: &TopicDeclaration| {
        let is_shown = topic.module().ends_with("::topics"); // other modules may be private
        let path = format!("{}::{}", topic.module(), topic.constant()?);
        is_shown.then(|| (topic.path().to_owned(), path))
    };
    Ok(RustBindings {
        vocabulary: vocabulary(TOPICS, &functions),
        topics: TOPICS.iter().filter_map(constant).collect(),
        messages,
        activities,
        runtime: "monas::generated".to_owned(),
        registers: true,
        ..RustBindings::default()
    })
}

/// The public path of a struct: the modules into which `narukom_build` puts structs, `generated`
/// and one per package of a folder, are private and re-exported by their parent. Programs depend on
/// the crate `monas`, which re-exports `monas_core`.
fn public(path: &str) -> String {
    let is_private = |segment: &&str| {
        let number = segment.strip_prefix("package_").unwrap_or_default();
        *segment == "generated" || !number.is_empty() && number.bytes().all(|digit| digit.is_ascii_digit())
    };
    let segments = path.split("::").filter(|segment| !is_private(segment));
    let segments = segments.map(|segment| if segment == "monas_core" { "monas" } else { segment });
    segments.collect::<Vec<_>>().join("::")
}

fn shown(module: &str) -> String {
    let inner = module.find("::activities::").map(|at| at + "::activities".len());
    module[..inner.unwrap_or(module.len())].to_owned()
}

fn code(declaration: &ActivityDeclaration) -> String {
    declaration.code.replace(' ', "")
}

#[cfg(test)]
mod tests {
    use super::public;

    #[test]
    fn modules_that_only_hold_structs_are_not_named() {
        assert_eq!(public("monas_soccer::generated::Ball"), "monas_soccer::Ball");
        assert_eq!(public("messages::package_12::Pins"), "messages::Pins");
        assert_eq!(public("monas_core::records::generated::Change"), "monas::records::Change");
        assert_eq!(public("team::package_of_pins::package_::Pins"), "team::package_of_pins::package_::Pins");
    }
}
