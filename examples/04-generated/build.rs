//! Writes the patrol's chart as a module of Rust.

use aseme::generate::{RustActivity, Words};

fn main() -> Result<(), aseme::build::Error> {
    let activities = [("Walk", "walk"), ("Left", "left"), ("Right", "right")].map(|(name, function)| {
        (name.to_owned(), RustActivity { path: format!("crate::{function}"), is_function: true })
    });
    let words = Words {
        activities: activities.into(),
        runtime: "monas::generated".into(),
        registers: true,
        ..Words::default()
    };
    aseme::build::generate("../02-formula/patrol.srm").words(words).write()?;
    Ok(())
}
