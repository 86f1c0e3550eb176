//! Modules that come into a run, go, and are exchanged.

use std::path::Path;

use monas::ModuleFile;
use monas::records::{Action, Change};

use super::list;
use crate::agent::change::{ask_for, tell};
use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::topic::arguments::RunChoice;

pub(super) fn load(
    path: &Path,
    agent: Option<&str>,
    run: &RunChoice,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let file = read(path, run.format.value)?;
    let name = file.note().module();
    let agent = agent.unwrap_or_default().to_owned();
    let change = Change { agent, ..meant(Action::LoadModule, name, Some((path, &file)), run)? };
    let changed = ask_for(change, run)?;
    let sentence = match changed.agent.as_str() {
        "" => format!("module `{name}` is loaded"),
        agent => format!(
            "module `{name}` is loaded, `{agent}` has its activities after its cycle {}",
            changed.cycle
        ),
    };
    tell(&changed, &sentence, run.format.value, console)
}

pub(super) fn unload(name: &str, run: &RunChoice, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let changed = ask_for(meant(Action::UnloadModule, name, None, run)?, run)?;
    let sentence = format!("no agent has activities of module `{name}` any more");
    tell(&changed, &sentence, run.format.value, console)
}

pub(super) fn reload(
    name: &str,
    path: Option<&Path>,
    run: &RunChoice,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    // Where it came from, unless another is named; the run says of one that is not loaded that it is not.
    let known = list::loaded(run)?.into_iter().find(|module| module.name == name);
    let path = path.map(Path::to_path_buf).or_else(|| known.map(|module| module.file.into()));
    let file = path.map(|path| Ok::<_, Failure>((read(&path, run.format.value)?, path))).transpose()?;
    let file = file.as_ref().map(|(file, path)| (path.as_path(), file));
    let changed = ask_for(meant(Action::ReloadModule, name, file, run)?, run)?;
    tell(&changed, &format!("module `{name}` is exchanged"), run.format.value, console)
}

fn read(path: &Path, format: Format) -> Result<ModuleFile, Failure> {
    ModuleFile::read(path).map_err(|diagnostics| Failure::Invalid(format, diagnostics))
}

/// A change about a module. The run may have been started in another folder, so it is told the whole path of a file.
fn meant(
    action: Action,
    name: &str,
    file: Option<(&Path, &ModuleFile)>,
    run: &RunChoice,
) -> Result<Change, Failure> {
    let mut change = Change { action: action.into(), module: name.to_owned(), ..Change::default() };
    if let Some((path, file)) = file {
        let path = std::path::absolute(path).map_err(|error| Failure::failed(run.format.value, error))?;
        (change.file, change.digest) = (path.display().to_string(), file.digest());
    }
    Ok(change)
}
