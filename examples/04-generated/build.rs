//! Generates the patrol's chart as a Rust module.

use aseme_codegen::generate::{RustActivity, RustBindings};

fn main() -> Result<(), aseme_codegen::build::Error> {
    let activities = [("Walk", "walk"), ("Left", "left"), ("Right", "right")].map(|(name, function)| {
        (name.to_owned(), RustActivity { path: format!("crate::{function}"), is_function: true })
    });
    let words = RustBindings {
        activities: activities.into(),
        runtime: "monas::generated".into(),
        registers: true,
        ..RustBindings::default()
    };
    aseme_codegen::build::generate("../02-formula/patrol.srm").bindings(words).write()?;
    Ok(())
}
