//! `monas module load`, `unload` and `reload`.

use std::path::Path;

use monas::ModuleFile;
use monas::records::{Action, Change};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format};

use super::list;
use crate::remote::{RunSelector, print_outcome, request_change};

pub(crate) fn load(
    path: &Path,
    agent: Option<&str>,
    run: &RunSelector,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let file = read(path, run.format.value)?;
    let name = file.note().module();
    let agent = agent.unwrap_or_default().to_owned();
    let change = Change { agent, ..module_change(Action::LoadModule, name, Some((path, &file)), run)? };
    let changed = request_change(change, run)?;
    let sentence = match changed.agent.as_str() {
        "" => format!("module `{name}` is loaded"),
        agent => format!(
            "module `{name}` is loaded, `{agent}` has its activities after its cycle {}",
            changed.cycle
        ),
    };
    print_outcome(&changed, &sentence, run.format.value, console)
}

pub(crate) fn unload(
    name: &str,
    run: &RunSelector,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let changed = request_change(module_change(Action::UnloadModule, name, None, run)?, run)?;
    let sentence = format!("no agent has activities of module `{name}` any more");
    print_outcome(&changed, &sentence, run.format.value, console)
}

pub(crate) fn reload(
    name: &str,
    path: Option<&Path>,
    run: &RunSelector,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    // The file the module was loaded from, unless another is given. If the module is not loaded,
    // the run reports that.
    let known = list::loaded(run)?.into_iter().find(|module| module.name == name);
    let path = path.map(Path::to_path_buf).or_else(|| known.map(|module| module.file.into()));
    let file =
        path.map(|path| Ok::<_, CommandFailure>((read(&path, run.format.value)?, path))).transpose()?;
    let file = file.as_ref().map(|(file, path)| (path.as_path(), file));
    let changed = request_change(module_change(Action::ReloadModule, name, file, run)?, run)?;
    print_outcome(&changed, &format!("module `{name}` is reloaded"), run.format.value, console)
}

fn read(path: &Path, format: Format) -> Result<ModuleFile, CommandFailure> {
    ModuleFile::read(path).map_err(|diagnostics| CommandFailure::Invalid(format, diagnostics))
}

/// A change of a module. The path is absolute, since the run may have another working directory.
fn module_change(
    action: Action,
    name: &str,
    file: Option<(&Path, &ModuleFile)>,
    run: &RunSelector,
) -> Result<Change, CommandFailure> {
    let mut change = Change { action: action.into(), module: name.to_owned(), ..Change::default() };
    if let Some((path, file)) = file {
        let path =
            std::path::absolute(path).map_err(|error| CommandFailure::failed(run.format.value, error))?;
        (change.file, change.digest) = (path.display().to_string(), file.digest());
    }
    Ok(change)
}
