//! Compares a project's folder of statecharts with the statecharts of the running program.
//!
//! They differ if a crate was added or removed and the program was not rebuilt. That is an error,
//! since the run would not use what the folder contains. A model may also have been edited, or
//! generated anew, since the build: that is only a warning, since an edited model can be run
//! interpreted.

use std::collections::BTreeSet;
use std::path::Path;

use aseme_models::diff::diff;
use monas::generated::is_generated_crate;
use monas::{Registry, config};
use yase::{Diagnostic, Statechart};

use crate::project::Project;

/// The differences between this program and the project of a configuration; none outside of
/// projects, and in packages of a project other than the team's, which have their own programs.
pub fn differences(config: &Path) -> Vec<Diagnostic> {
    let Ok(project) = Project::around(config) else { return Vec::new() };
    if !project.contains(config) {
        return Vec::new();
    }
    let Ok(there) = project.generated() else { return Vec::new() };
    let registry = Registry::linked();
    let linked: BTreeSet<String> =
        registry.chart_names().filter(|name| is_generated_crate(name)).map(str::to_owned).collect();
    let there: BTreeSet<String> = there.into_iter().collect();
    let mut found = compared(&there, &linked, &project.relative(&project.statecharts()));
    found.extend(there.intersection(&linked).filter_map(|name| outdated(&project, &registry, name)));
    found
}

/// The difference between a chart of the program and its model, if the model exists.
fn outdated(project: &Project, registry: &Registry, name: &str) -> Option<Diagnostic> {
    let model = project.model_of(name)?;
    let source = config::read_file(&model).ok()?;
    let (chart, findings) = aseme_models::statechart_of(&source);
    let linked = registry.chart(name)?.ok()?;
    let path = project.relative(&model);
    let says = match findings.iter().any(Diagnostic::is_error) {
        true => Some("it has errors".to_owned()),
        false => first_difference(linked.statechart(), &chart),
    }?;
    let message =
        format!("`{path}` differs from the model of the statechart `{name}` in this program: {says}");
    let hint = format!("`monas generate {path}` and build the program again");
    Some(Diagnostic::warning("E0928", 0..0, message).with_hint(hint))
}

fn first_difference(linked: &Statechart, model: &Statechart) -> Option<String> {
    let changes = diff(linked, model).changes;
    let first = changes.first()?;
    Some(match changes.len() {
        1 => first.to_string(),
        count => format!("{first}, and {} more", count - 1),
    })
}

fn compared(there: &BTreeSet<String>, linked: &BTreeSet<String>, folder: &str) -> Vec<Diagnostic> {
    let unlinked = there.difference(linked).map(|name| {
        let message = format!("`{folder}/{name}` is not in this program");
        let hint = "`monas generate` its model, which links it, and build the program again";
        Diagnostic::error("E0927", 0..0, message).with_hint(hint)
    });
    let gone = linked.difference(there).map(|name| {
        let message = format!("this program contains the statechart `{name}`, and `{folder}/{name}` is gone");
        let hint = "`monas generate` any model, which takes it out of the program's files, and build the program again";
        Diagnostic::error("E0927", 0..0, message).with_hint(hint)
    });
    unlinked.chain(gone).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(names: &[&str]) -> BTreeSet<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn the_first_of_several_differences_is_difference() {
        let chart = |text: &str| aseme_models::statechart_of(&yase::Source::new("r.srm", text)).0;
        let plain = chart("r = a . b");
        assert_eq!(first_difference(&plain, &plain), None);
        let difference = first_difference(&plain, &chart("r = a . c . b")).expect("they differ");
        assert!(difference.starts_with("+ state `c`") && difference.ends_with(" more"), "{difference}");
    }

    #[test]
    fn only_the_program_of_the_team_must_contain_the_statecharts() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |file: &str, text: &str| {
            let path = folder.path().join(file);
            std::fs::create_dir_all(path.parent().expect("it has a folder")).expect("folders");
            std::fs::write(path, text).expect("the folder takes files");
        };
        write("Cargo.toml", "[workspace]\n[workspace.metadata.monas]\nteam = \"team\"\n");
        write("team/Cargo.toml", "[package]\n");
        write("vehicle/Cargo.toml", "[package]\n");
        write(
            "statecharts/goalie/Cargo.toml",
            "[package]\n[package.metadata.monas]\nmodel = \"goalie.srm\"\n",
        );
        let found = |config: &str| differences(&folder.path().join(config)).len();
        assert_eq!([found("config/match.xml"), found("team/agents.xml")], [1, 1]);
        assert_eq!(found("vehicle/config/agents.xml"), 0);
    }

    #[test]
    fn messages_on_one_side_only_are_named() {
        let said = |there: &[&str], linked: &[&str]| -> Vec<String> {
            compared(&set(there), &set(linked), "statecharts")
                .into_iter()
                .map(|found| found.message)
                .collect()
        };
        assert_eq!(said(&["goalie", "scout"], &["goalie", "scout"]), [""; 0]);
        assert_eq!(said(&["goalie", "scout"], &["goalie"]), ["`statecharts/scout` is not in this program"]);
        let gone = "this program contains the statechart `goalie`, and `statecharts/goalie` is gone";
        assert_eq!(said(&[], &["goalie"]), [gone]);
    }
}
