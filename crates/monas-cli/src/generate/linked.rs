//! Whether a project's folder of statecharts and the program that runs hold the same charts.
//!
//! They differ after a crate was put into the folder, or taken out of it, and the program was not built since. What would run then is
//! not what lies there, so nothing is run.

use std::collections::BTreeSet;
use std::path::Path;

use monas::Registry;
use monas::generated::is_generated_crate;
use yase::Diagnostic;

use super::project::Project;

/// Where the folder beside a configuration and this program differ; nothing outside of a project.
pub(crate) fn differences(config: &Path) -> Vec<Diagnostic> {
    let Ok(project) = Project::around(config) else { return Vec::new() };
    let Ok(there) = project.generated() else { return Vec::new() };
    let registry = Registry::linked();
    let linked = registry.chart_names().filter(|name| is_generated_crate(name)).map(str::to_owned).collect();
    let there = there.into_iter().collect();
    compared(&there, &linked, &project.relative(&project.statecharts()))
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
