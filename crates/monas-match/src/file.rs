//! Reads a match file and everything it names.
//!
//! ```xml
//! <match field="config/fields/thesis.xml" simulator="config/simulator.xml" half="300s">
//!   <team number="1" name="Blue" colour="blue" side="left">
//!     <robot number="1" role="config/roles/goalie.xml"/>
//!   </team>
//!   ...
//! </match>
//! ```
//!
//! Paths are relative to the folder that holds the folder `config` in which the match file lies, so that a match runs from
//! wherever it is started; a match file that lies elsewhere counts from its own folder.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use monas::config::xml::{self, Attributes, Element};
use monas_sim::{FieldGeometry, FieldSide, Physics, Rules, TeamColour, TeamSetup};
use yase::{Diagnostic, Source, Span};

use crate::parameters;

/// What a match file says, with the files it names; roles are still paths.
#[derive(Clone, Debug)]
pub(crate) struct MatchFile {
    pub(crate) geometry: FieldGeometry,
    pub(crate) physics: Physics,
    pub(crate) rules: Rules,
    pub(crate) teams: Vec<TeamFile>,
}

/// A team of a match file.
#[derive(Clone, Debug)]
pub(crate) struct TeamFile {
    pub(crate) setup: TeamSetup,
    pub(crate) robots: Vec<RobotFile>,
}

/// A robot of a match file.
#[derive(Clone, Debug)]
pub(crate) struct RobotFile {
    pub(crate) number: u8,
    /// The file of its role.
    pub(crate) role: PathBuf,
    /// Where the match file names it.
    pub(crate) place: (Arc<Source>, Span),
}

/// Reads a match file; everything that is wrong with it is added to `diagnostics`.
pub(crate) fn read(path: &Path, diagnostics: &mut Vec<Diagnostic>) -> Option<MatchFile> {
    let source = read_source(path, None, diagnostics)?;
    let root = root(&source, "match", diagnostics)?;
    let base = base_of(path);
    let mut attributes = Attributes::new(&root, diagnostics);
    let field = attributes.get("field").cloned();
    let simulator = attributes.get("simulator").cloned();
    let half = attributes.duration("half");
    attributes.finish();
    let named = |attribute: &xml::Attribute| (base.join(&attribute.value), (source.clone(), attribute.value_span));
    let geometry = field.map(|attribute| named(&attribute)).map(|(path, place)| read_field(&path, place, diagnostics));
    let numbers = simulator.map(|attribute| named(&attribute)).map(|(path, place)| read_simulator(&path, place, diagnostics));
    let (physics, mut rules) = numbers.unwrap_or_default();
    set_half(&mut rules, half, &root, diagnostics);
    root.expect_children(&["team"], diagnostics);
    let teams = root.children_named("team").filter_map(|team| read_team(team, &base, diagnostics)).collect();
    let file = MatchFile { geometry: geometry.unwrap_or_default(), physics, rules, teams };
    check(&file, &root, diagnostics);
    Some(file)
}

/// The folder that the paths in a file count from.
pub(crate) fn base_of(path: &Path) -> PathBuf {
    let folder = path.parent().unwrap_or(Path::new(""));
    let config = folder.ancestors().find(|ancestor| ancestor.file_name().is_some_and(|name| name == "config"));
    config.and_then(Path::parent).unwrap_or(folder).to_path_buf()
}

fn read_source(path: &Path, place: Option<(Arc<Source>, Span)>, diagnostics: &mut Vec<Diagnostic>) -> Option<Arc<Source>> {
    match std::fs::read_to_string(path) {
        Ok(text) => Some(Source::new(path.display().to_string(), text)),
        Err(error) => {
            let (source, span) = place.unwrap_or_else(|| (Source::new(path.display().to_string(), ""), Span::default()));
            let message = format!("cannot read `{}`: {error}", path.display());
            let diagnostic = Diagnostic::error("E0403", span, message).in_source(&source);
            diagnostics.push(diagnostic.with_nearest(&file_name(path), neighbours(path).iter().map(String::as_str)));
            None
        }
    }
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The names of the files beside a path, in order.
fn neighbours(path: &Path) -> Vec<String> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// The one root element of a file.
fn root(source: &Arc<Source>, name: &str, diagnostics: &mut Vec<Diagnostic>) -> Option<Element> {
    let (elements, found) = xml::parse(source);
    let broken = found.iter().any(Diagnostic::is_error);
    diagnostics.extend(found);
    let mut elements = elements.into_iter();
    match (elements.next(), elements.next()) {
        (Some(root), None) if root.is(name) => Some(root),
        (Some(root), None) => {
            diagnostics.push(root.unknown(&[name]));
            None
        }
        (Some(_), Some(second)) => {
            diagnostics.push(second.error("E0404", second.name_span(), format!("expected one `<{name}>` and no more")));
            None
        }
        (None, _) => {
            if !broken {
                let message = format!("expected a `<{name}>`, the file holds none");
                diagnostics.push(Diagnostic::error("E0404", Span::default(), message).in_source(source));
            }
            None
        }
    }
}

fn read_field(path: &Path, place: (Arc<Source>, Span), diagnostics: &mut Vec<Diagnostic>) -> FieldGeometry {
    let mut geometry = FieldGeometry::default();
    let source = read_source(path, Some(place), diagnostics);
    if let Some(root) = source.and_then(|source| root(&source, "field", diagnostics)) {
        root.expect_children(&[], diagnostics);
        parameters::from_attributes(&root, FieldGeometry::keys(), diagnostics, |key, value| {
            // The key and the range have been checked against the same table.
            let _ = geometry.set(key, value);
        });
        if let Err(error) = geometry.validate() {
            diagnostics.push(root.error("E0405", root.name_span(), error.to_string()));
        }
    }
    geometry
}

fn read_simulator(path: &Path, place: (Arc<Source>, Span), diagnostics: &mut Vec<Diagnostic>) -> (Physics, Rules) {
    let (mut physics, mut rules) = (Physics::default(), Rules::default());
    let source = read_source(path, Some(place), diagnostics);
    if let Some(root) = source.and_then(|source| root(&source, "simulator", diagnostics)) {
        Attributes::new(&root, diagnostics).finish();
        root.expect_children(&["physics", "rules"], diagnostics);
        for part in root.children_named("physics") {
            parameters::from_children(part, Physics::keys(), diagnostics, |key, value| {
                let _ = physics.set(key, value);
            });
        }
        for part in root.children_named("rules") {
            parameters::from_children(part, Rules::keys(), diagnostics, |key, value| {
                let _ = rules.set(key, value);
            });
        }
    }
    (physics, rules)
}

fn set_half(rules: &mut Rules, half: Option<Duration>, root: &Element, diagnostics: &mut Vec<Diagnostic>) {
    if let Some(half) = half
        && let Err(error) = rules.set("half_duration", half.as_secs_f64())
    {
        diagnostics.push(root.error("E0402", root.name_span(), error.to_string()));
    }
    if let Err(error) = rules.validate() {
        diagnostics.push(root.error("E0405", root.name_span(), error.to_string()));
    }
}

const COLOURS: [(&str, TeamColour); 2] = [("blue", TeamColour::Blue), ("red", TeamColour::Red)];
const SIDES: [(&str, FieldSide); 2] = [("left", FieldSide::Left), ("right", FieldSide::Right)];

fn read_team(team: &Element, base: &Path, diagnostics: &mut Vec<Diagnostic>) -> Option<TeamFile> {
    let mut attributes = Attributes::new(team, diagnostics);
    for key in ["number", "name", "colour", "side"] {
        attributes.required(key);
    }
    let number = attributes.integer("number");
    let name = attributes.text("name").map(str::to_owned);
    let colour = attributes.one_of("colour", &COLOURS);
    let plays = attributes.one_of("side", &SIDES);
    attributes.finish();
    team.expect_children(&["robot"], diagnostics);
    let robots = team.children_named("robot").filter_map(|robot| read_robot(robot, base, diagnostics)).collect();
    let setup = TeamSetup { number: number?, name: name?, colour: colour?, plays: plays? };
    Some(TeamFile { setup, robots })
}

fn read_robot(robot: &Element, base: &Path, diagnostics: &mut Vec<Diagnostic>) -> Option<RobotFile> {
    let mut attributes = Attributes::new(robot, diagnostics);
    attributes.required("number");
    attributes.required("role");
    let number = attributes.integer("number");
    let role = attributes.get("role").map(|attribute| (base.join(&attribute.value), attribute.value_span));
    attributes.finish();
    robot.expect_children(&[], diagnostics);
    let (role, span) = role?;
    Some(RobotFile { number: number?, role, place: (robot.source().clone(), span) })
}

/// What only the teams together can have wrong.
fn check(file: &MatchFile, root: &Element, diagnostics: &mut Vec<Diagnostic>) {
    if diagnostics.iter().any(Diagnostic::is_error) {
        return;
    }
    let setups: Vec<TeamSetup> = file.teams.iter().map(|team| team.setup.clone()).collect();
    if let Err(error) = monas_sim::check_lineup(&setups, &file.lineup()) {
        diagnostics.push(root.error("E0406", root.name_span(), error.to_string()));
    }
}

impl MatchFile {
    /// Team and number of each robot, in the order of the file.
    pub(crate) fn lineup(&self) -> Vec<monas_sim::RobotSetup> {
        let robots = |team: &TeamFile| -> Vec<monas_sim::RobotSetup> {
            let team_number = team.setup.number;
            let setup = |robot: &RobotFile| monas_sim::RobotSetup { team: team_number, number: robot.number };
            team.robots.iter().map(setup).collect()
        };
        self.teams.iter().flat_map(robots).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_count_from_the_folder_that_holds_config() {
        assert_eq!(base_of(Path::new("config/match.xml")), Path::new(""));
        assert_eq!(base_of(Path::new("/home/x/team/config/roles/goalie.xml")), Path::new("/home/x/team"));
        assert_eq!(base_of(Path::new("elsewhere/match.xml")), Path::new("elsewhere"));
    }

    fn diagnostics_of(text: &str) -> Vec<String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("match.xml");
        std::fs::write(&path, text).unwrap();
        let mut diagnostics = Vec::new();
        read(&path, &mut diagnostics);
        let prefix = format!("{}/", folder.path().display());
        diagnostics.iter().map(|diagnostic| diagnostic.to_string().replace(&prefix, "")).collect()
    }

    #[test]
    fn every_mistake_is_reported_with_its_place() {
        let found = diagnostics_of(
            "<match haf='300s'>\n <team number='1' name='A' colour='bleu' side='left'>\n  <robot number='1'/>\n </team>\n</match>",
        );
        assert_eq!(found.len(), 3, "{found:#?}");
        assert!(found[0].starts_with("match.xml:1:8: error[E0304]") && found[0].contains("did you mean `half`?"));
        assert!(found[1].starts_with("match.xml:2:38: error") && found[1].contains("did you mean `blue`?"));
        assert!(found[2].starts_with("match.xml:3:4: error[E0305]") && found[2].contains("`role`"));
    }

    #[test]
    fn a_missing_file_is_reported_where_it_is_named() {
        let found = diagnostics_of("<match field='felds.xml'/>");
        assert!(found[0].starts_with("match.xml:1:15: error[E0403]"), "{found:#?}");
    }

    #[test]
    fn two_teams_have_to_play() {
        let found = diagnostics_of("<match><team number='1' name='A' colour='blue' side='left'/></match>");
        assert_eq!(found, ["match.xml:1:2: error[E0406]: a match needs two teams, not 1"]);
    }
}
