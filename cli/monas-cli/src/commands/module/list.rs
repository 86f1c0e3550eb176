//! `monas module list`: the loaded modules of a run.

use monas::records::{Inquiry, ModuleEntry};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, table};
use serde_json::json;

use crate::remote::{RunSelector, request, unexpected_reply};

pub(crate) fn execute(run: &RunSelector, console: &mut CommandOutput<'_>) -> Result<Exit, CommandFailure> {
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

/// The loaded modules of a run.
pub(crate) fn loaded(run: &RunSelector) -> Result<Vec<ModuleEntry>, CommandFailure> {
    let reply = request(Inquiry { modules: true, ..Inquiry::default() }, run)?;
    Ok(reply.modules.ok_or_else(|| unexpected_reply(run))?.modules)
}

fn row(module: &ModuleEntry) -> [String; 6] {
    let ModuleEntry { host, name, package, activities, agents, file, .. } = module.clone();
    [host, name, package, activities.join(", "), agents.join(", "), file]
}

fn object(module: &ModuleEntry) -> serde_json::Value {
    json!({"host": module.host, "module": module.name, "file": module.file, "digest": module.digest,
        "package": module.package, "activities": module.activities, "agents": module.agents})
}
