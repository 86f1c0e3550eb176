//! The table of layers. Dependencies go only from a higher number to a lower one.

use std::path::Path;

use super::TidyFinding;
use super::workspace::{Crate, Dependency, Workspace};

/// Every crate of the product and its layer.
const LAYERS: [(&str, u8); 38] = [
    ("monas-diagnostics", 0),
    ("monas-files", 0),
    ("narukom", 0),
    ("narukom-build", 0),
    ("yase-expression", 0),
    ("monas-vision", 1),
    ("yase", 1),
    ("monas-link", 1),
    ("monas-robot", 1),
    ("monas-tape", 1),
    ("yase-codegen", 3),
    ("monas-gamecontroller", 2),
    ("monas-kinematics", 2),
    ("yase-explore", 2),
    ("yase-export", 2),
    ("yase-reference", 2),
    ("yase-scxml", 2),
    ("aseme", 4),
    ("aseme-models", 5),
    ("aseme-verify", 6),
    ("aseme-codegen", 6),
    ("monas-core", 7),
    ("monas-module", 8),
    ("monas-config", 9),
    ("monas-log", 10),
    ("monas-runtime", 11),
    ("monas", 12),
    ("monas-sim", 12),
    ("monas-recording", 13),
    ("monas-soccer", 13),
    ("monas-match", 14),
    ("monas-eval", 15),
    ("monas-studio", 15),
    ("monas-project", 15),
    ("monas-deploy", 16),
    ("monas-scene", 16),
    ("monas-terminal", 16),
    ("monas-cli", 17),
];

/// The folders of the product's crates.
const FOLDERS: [&str; 8] =
    ["charts", "methodology", "messages", "runtime", "robots", "soccer", "studio", "cli"];

/// Bodies: only the binary depends on them.
const ROBOTS_LAYER: u8 = 15;

/// Generated statecharts: they depend on activities and messages, and programs link them.
const STATECHARTS_LAYER: u8 = 14;

/// Examples, benches, whole-match tests and xtask: nothing depends on them.
const TOP_LAYER: u8 = 18;

pub(crate) fn check(workspace: &Workspace) -> Vec<TidyFinding> {
    workspace.crates.iter().flat_map(|member| check_crate(workspace, member)).collect()
}

fn check_crate(workspace: &Workspace, member: &Crate) -> Vec<TidyFinding> {
    let manifest = member.folder.join("Cargo.toml");
    let Some(layer) = layer_of(member) else {
        return vec![TidyFinding::new(
            manifest,
            1,
            format!("`{}` has no place in the table of layers", member.name),
        )];
    };
    let forbidden = member.dependencies.iter().filter_map(|dependency| {
        let target = workspace.crates.iter().find(|other| other.name == dependency.name)?;
        let message = arrow(member, layer, target, dependency)?;
        Some(TidyFinding::new(&manifest, line_of(workspace, &manifest, &dependency.name), message))
    });
    forbidden.collect()
}

/// A violation by a dependency, if any. Tests may depend on crates of the same layer, never of a
/// higher one.
fn arrow(member: &Crate, layer: u8, target: &Crate, dependency: &Dependency) -> Option<String> {
    let target_layer = layer_of(target)?;
    if is_body(target) && layer < TOP_LAYER && member.name != "monas-cli" {
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

/// Whether a crate is part of the product.
pub(crate) fn is_product(member: &Crate) -> bool {
    FOLDERS.iter().any(|folder| member.folder.starts_with(folder))
}

fn is_body(member: &Crate) -> bool {
    member.folder.starts_with("robots") && !LAYERS.iter().any(|(name, _)| *name == member.name)
}

fn layer_of(member: &Crate) -> Option<u8> {
    if let Some(&(_, layer)) = LAYERS.iter().find(|(name, _)| *name == member.name) {
        return Some(layer);
    }
    if member.folder.starts_with("statecharts") {
        return Some(STATECHARTS_LAYER);
    }
    if member.folder.starts_with("robots") {
        return Some(ROBOTS_LAYER);
    }
    (!is_product(member)).then_some(TOP_LAYER)
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
            path: "charts/yase/Cargo.toml".into(),
            text: "[dependencies]\nnarukom.workspace = true\nmonas.workspace = true\n".into(),
        };
        let workspace = Workspace { root: PathBuf::new(), crates, files: vec![manifest] };
        check(&workspace).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn down_is_allowed() {
        assert!(
            findings(vec![member("charts/yase", &[]), member("methodology/aseme", &[("yase", false)])])
                .is_empty()
        );
    }

    #[test]
    fn up_and_sideways_are_named_with_their_line() {
        let crates = vec![
            member("runtime/monas", &[]),
            member("messages/monas-link", &[]),
            member("charts/yase", &[("monas", true), ("monas-link", false)]),
        ];
        let found = findings(crates);
        assert_eq!(found.len(), 2);
        assert!(
            found[0].starts_with("charts/yase/Cargo.toml:3: `yase` (layer 1) depends on `monas` (layer 12)")
        );
        assert!(
            found[1]
                .starts_with("charts/yase/Cargo.toml:1: `yase` (layer 1) depends on `monas-link` (layer 1)")
        );
    }

    #[test]
    fn tests_may_look_sideways() {
        assert!(
            findings(vec![
                member("messages/monas-link", &[]),
                member("charts/yase", &[("monas-link", true)])
            ])
            .is_empty()
        );
    }

    #[test]
    fn a_new_crate_needs_a_place() {
        assert!(findings(vec![member("runtime/novelty", &[])])[0].contains("no place in the table"));
    }

    #[test]
    fn statecharts_know_the_team_and_only_programs_know_them() {
        let charts = || member("statecharts/goalie", &[("monas-soccer", false)]);
        let soccer = || member("soccer/monas-soccer", &[]);
        let program = member("cli/monas-cli", &[("goalie", false)]);
        assert!(findings(vec![charts(), soccer(), program]).is_empty());
        let engine = member("runtime/monas", &[("goalie", false)]);
        assert_eq!(findings(vec![charts(), soccer(), engine]).len(), 1);
    }

    #[test]
    fn bodies_are_known_to_the_binary_only() {
        let nao = || member("robots/nao", &[]);
        assert!(findings(vec![nao(), member("cli/monas-cli", &[("nao", false)])]).is_empty());
        assert_eq!(findings(vec![nao(), member("runtime/monas-studio", &[("nao", false)])]).len(), 1);
    }

    #[test]
    fn the_arrows_of_this_house_go_down() {
        let workspace = Workspace::read(&crate::root()).expect("the workspace can be read");
        assert!(workspace.crates.len() >= 12, "every crate is looked at");
        let found: Vec<String> = check(&workspace).iter().map(ToString::to_string).collect();
        assert!(found.is_empty(), "{}", found.join("\n"));
    }
}
