//! The table of layers. An arrow goes only from a higher number to a lower one.

use std::path::Path;

use super::Finding;
use super::workspace::{Crate, Dependency, Workspace};

/// Every crate under `crates/` and its layer.
const LAYERS: [(&str, u8); 13] = [
    ("narukom", 0),
    ("narukom-build", 0),
    ("yase", 0),
    ("aseme", 1),
    ("monas-link", 1),
    ("monas-robot", 1),
    ("monas-tape", 1),
    ("monas", 2),
    ("monas-sim", 2),
    ("monas-soccer", 3),
    ("monas-match", 4),
    ("monas-studio", 5),
    ("monas-cli", 6),
];

/// Bodies: known to the binary only.
const ROBOTS: u8 = 5;

/// Generated statecharts: they name activities and messages, and programs link them.
const STATECHARTS: u8 = 4;

/// Examples, benches, whole-match tests and chores: nothing depends on them.
const TOP: u8 = 7;

pub(super) fn check(workspace: &Workspace) -> Vec<Finding> {
    workspace.crates.iter().flat_map(|member| check_crate(workspace, member)).collect()
}

fn check_crate(workspace: &Workspace, member: &Crate) -> Vec<Finding> {
    let manifest = member.folder.join("Cargo.toml");
    let Some(layer) = layer_of(member) else {
        return vec![Finding::new(
            manifest,
            1,
            format!("`{}` has no place in the table of layers", member.name),
        )];
    };
    let forbidden = member.dependencies.iter().filter_map(|dependency| {
        let target = workspace.crates.iter().find(|other| other.name == dependency.name)?;
        let message = arrow(member, layer, target, dependency)?;
        Some(Finding::new(&manifest, line_of(workspace, &manifest, &dependency.name), message))
    });
    forbidden.collect()
}

/// What is wrong with an arrow, if anything. Tests may look sideways, never up.
fn arrow(member: &Crate, layer: u8, target: &Crate, dependency: &Dependency) -> Option<String> {
    let target_layer = layer_of(target)?;
    if target.folder.starts_with("robots") && layer < TOP && member.name != "monas-cli" {
        return Some(format!("`{}` knows the body `{}`: only the binary may", member.name, target.name));
    }
    let allowed = target_layer < layer || (dependency.is_dev && target_layer == layer);
    (!allowed).then(|| {
        format!(
            "`{}` (layer {layer}) depends on `{}` (layer {target_layer}): arrows go from a higher layer to a lower one",
            member.name, target.name
        )
    })
}

fn layer_of(member: &Crate) -> Option<u8> {
    if member.folder.starts_with("statecharts") {
        return Some(STATECHARTS);
    }
    if !member.folder.starts_with("crates") {
        return Some(if member.folder.starts_with("robots") { ROBOTS } else { TOP });
    }
    LAYERS.iter().find(|(name, _)| *name == member.name).map(|&(_, layer)| layer)
}

fn line_of(workspace: &Workspace, manifest: &Path, dependency: &str) -> usize {
    let lines = workspace.file(manifest).map(|file| file.text.lines()).into_iter().flatten();
    let is_entry =
        |line: &str| line.strip_prefix(dependency).is_some_and(|rest| rest.starts_with(['.', ' ', '=']));
    lines.enumerate().find(|(_, line)| is_entry(line)).map_or(1, |(index, _)| index + 1)
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::tidy::workspace::TextFile;

    fn member(folder: &str, dependencies: &[(&str, bool)]) -> Crate {
        let dependency = |&(name, is_dev): &(&str, bool)| Dependency { name: name.into(), is_dev };
        Crate {
            name: folder.rsplit('/').next().unwrap_or(folder).to_string(),
            folder: folder.into(),
            library: None,
            dependencies: dependencies.iter().map(dependency).collect(),
        }
    }

    fn findings(crates: Vec<Crate>) -> Vec<String> {
        let manifest = TextFile {
            path: "crates/yase/Cargo.toml".into(),
            text: "[dependencies]\nnarukom.workspace = true\nmonas.workspace = true\n".into(),
        };
        let workspace = Workspace { root: PathBuf::new(), crates, files: vec![manifest] };
        check(&workspace).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn down_is_allowed() {
        assert!(
            findings(vec![member("crates/yase", &[]), member("crates/aseme", &[("yase", false)])]).is_empty()
        );
    }

    #[test]
    fn up_and_sideways_are_named_with_their_line() {
        let crates = vec![
            member("crates/monas", &[]),
            member("crates/narukom", &[]),
            member("crates/yase", &[("monas", true), ("narukom", false)]),
        ];
        let found = findings(crates);
        assert_eq!(found.len(), 2);
        assert!(
            found[0].starts_with("crates/yase/Cargo.toml:3: `yase` (layer 0) depends on `monas` (layer 2)")
        );
        assert!(
            found[1].starts_with("crates/yase/Cargo.toml:2: `yase` (layer 0) depends on `narukom` (layer 0)")
        );
    }

    #[test]
    fn tests_may_look_sideways() {
        assert!(
            findings(vec![member("crates/narukom", &[]), member("crates/yase", &[("narukom", true)])])
                .is_empty()
        );
    }

    #[test]
    fn a_new_crate_needs_a_place() {
        assert!(findings(vec![member("crates/novelty", &[])])[0].contains("no place in the table"));
    }

    #[test]
    fn statecharts_know_the_team_and_only_programs_know_them() {
        let charts = || member("statecharts/goalie", &[("monas-soccer", false)]);
        let soccer = || member("crates/monas-soccer", &[]);
        let program = member("crates/monas-cli", &[("goalie", false)]);
        assert!(findings(vec![charts(), soccer(), program]).is_empty());
        let engine = member("crates/monas", &[("goalie", false)]);
        assert_eq!(findings(vec![charts(), soccer(), engine]).len(), 1);
    }

    #[test]
    fn bodies_are_known_to_the_binary_only() {
        let nao = || member("robots/nao", &[]);
        assert!(findings(vec![nao(), member("crates/monas-cli", &[("nao", false)])]).is_empty());
        assert_eq!(findings(vec![nao(), member("crates/monas-studio", &[("nao", false)])]).len(), 1);
    }

    #[test]
    fn the_arrows_of_this_house_go_down() {
        let workspace = Workspace::read(&crate::root()).expect("the workspace can be read");
        assert!(workspace.crates.len() >= 12, "every crate is looked at");
        let found: Vec<String> = check(&workspace).iter().map(ToString::to_string).collect();
        assert!(found.is_empty(), "{}", found.join("\n"));
    }
}
