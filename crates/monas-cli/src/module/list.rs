//! `monas module list`.

use monas::records::{Inquiry, ModuleEntry};
use serde_json::json;

use crate::agent::{ask, odd};
use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::run::table;
use crate::topic::arguments::RunChoice;

pub(super) fn execute(run: &RunChoice, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let modules = loaded(run)?;
    match run.format.value {
        Format::Json => modules.iter().try_for_each(|module| writeln!(console.out, "{}", object(module)))?,
        Format::Text if modules.is_empty() => writeln!(console.err, "no module is loaded")?,
        Format::Text => {
            let header = ["host", "module", "package", "activities", "agents", "file"];
            writeln!(console.out, "{}", table::of_numbers(header, header.len(), modules.iter().map(row)))?;
        }
    }
    Ok(Exit::Success)
}

/// The modules that a run has loaded.
pub(super) fn loaded(run: &RunChoice) -> Result<Vec<ModuleEntry>, Failure> {
    let reply = ask(Inquiry { modules: true, ..Inquiry::default() }, run)?;
    Ok(reply.modules.ok_or_else(|| odd(run))?.modules)
}

fn row(module: &ModuleEntry) -> [String; 6] {
    let ModuleEntry { host, name, package, activities, agents, file, .. } = module.clone();
    [host, name, package, activities.join(", "), agents.join(", "), file]
}

fn object(module: &ModuleEntry) -> serde_json::Value {
    json!({"host": module.host, "module": module.name, "file": module.file, "digest": module.digest,
        "package": module.package, "activities": module.activities, "agents": module.agents})
}
