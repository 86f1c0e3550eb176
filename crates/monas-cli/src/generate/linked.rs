//! Whether a project's folder of statecharts and the program that runs hold the same charts.
//!
//! They differ after a crate was put into the folder, or taken out of it, and the program was not built since. What would run then is
//! not what lies there, so nothing is run. And a model may have been edited, or generated anew, since the program was built: that is a warning, since whoever
//! edits a model may well run it interpreted meanwhile.

use std::collections::BTreeSet;
use std::path::Path;

use aseme::diff::diff;
use monas::generated::is_generated_crate;
use monas::{Registry, config};
use yase::{Diagnostic, Statechart};

use super::project::Project;

/// Where the folder beside a configuration and this program differ; nothing outside of a project.
pub(crate) fn differences(config: &Path) -> Vec<Diagnostic> {
    let Ok(project) = Project::around(config) else { return Vec::new() };
    let Ok(there) = project.generated() else { return Vec::new() };
    let registry = Registry::linked();
    let linked: BTreeSet<String> =
        registry.chart_names().filter(|name| is_generated_crate(name)).map(str::to_owned).collect();
    let there: BTreeSet<String> = there.into_iter().collect();
    let mut found = compared(&there, &linked, &project.relative(&project.statecharts()));
    found.extend(there.intersection(&linked).filter_map(|name| outdated(&project, &registry, name)));
    found
}

/// What the model of a chart says and the program does not. Where there is no model beside the program, nothing is expected of it.
fn outdated(project: &Project, registry: &Registry, name: &str) -> Option<Diagnostic> {
    let model = project.model_of(name)?;
    let source = config::read_file(&model).ok()?;
    let (chart, findings) = aseme::statechart_of(&source);
    let linked = registry.chart(name)?.ok()?;
    let told = project.relative(&model);
    let says = match findings.iter().any(Diagnostic::is_error) {
        true => Some("it has errors".to_owned()),
        false => first_difference(linked.statechart(), &chart),
    }?;
    let message = format!("`{told}` is not what the statechart `{name}` of this program was made of: {says}");
    let hint = format!("`monas generate {told}` and build the program again");
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
        let message = format!("this program holds the statechart `{name}`, and `{folder}/{name}` is gone");
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
    fn the_first_of_several_differences_is_told() {
        let chart = |text: &str| aseme::statechart_of(&yase::Source::new("r.srm", text)).0;
        let plain = chart("r = a . b");
        assert_eq!(first_difference(&plain, &plain), None);
        let told = first_difference(&plain, &chart("r = a . c . b")).expect("they differ");
        assert!(told.starts_with("+ state `c`") && told.ends_with(" more"), "{told}");
    }

    #[test]
    fn what_is_on_one_side_only_is_named() {
        let said = |there: &[&str], linked: &[&str]| -> Vec<String> {
            compared(&set(there), &set(linked), "statecharts")
                .into_iter()
                .map(|found| found.message)
                .collect()
        };
        assert_eq!(said(&["goalie", "scout"], &["goalie", "scout"]), [""; 0]);
        assert_eq!(said(&["goalie", "scout"], &["goalie"]), ["`statecharts/scout` is not in this program"]);
        let gone = "this program holds the statechart `goalie`, and `statecharts/goalie` is gone";
        assert_eq!(said(&[], &["goalie"]), [gone]);
    }
}
