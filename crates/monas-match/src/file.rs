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
//! A file that the match file names is looked for as [`monas::config::locate`] says: beside it, then in each folder above.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use monas::config;
use monas::config::xml::{self, Attribute, Attributes, Element};
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
}

/// Reads a match file; everything that is wrong with it is added to `diagnostics`.
pub(crate) fn read(path: &Path, diagnostics: &mut Vec<Diagnostic>) -> Option<MatchFile> {
    let root = read_root(path, "match", diagnostics)?;
    let mut attributes = Attributes::new(&root, diagnostics);
    let field = attributes.get("field").cloned();
    let simulator = attributes.get("simulator").cloned();
    let half = attributes.duration("half");
    attributes.finish();
    let field = field.and_then(|attribute| named(path, &root, &attribute, diagnostics));
    let simulator = simulator.and_then(|attribute| named(path, &root, &attribute, diagnostics));
    let geometry = field.map(|path| read_field(&path, diagnostics)).unwrap_or_default();
    let (physics, mut rules) = simulator.map(|path| read_simulator(&path, diagnostics)).unwrap_or_default();
    set_half(&mut rules, half, &root, diagnostics);
    root.expect_children(&["team"], diagnostics);
    let teams = root.children_named("team").filter_map(|team| read_team(team, path, diagnostics)).collect();
    let file = MatchFile { geometry, physics, rules, teams };
    check(&file, &root, diagnostics);
    Some(file)
}

/// The file that an attribute names; none, and why, if there is no such file.
fn named(
    path: &Path,
    element: &Element,
    attribute: &Attribute,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<PathBuf> {
    match config::locate(path, &attribute.value) {
        Ok(found) => Some(found),
        Err(near) => {
            let diagnostic =
                element.error("E0403", attribute.value_span, format!("no file `{}`", attribute.value));
            diagnostics.push(match near {
                Some(near) => diagnostic.with_hint(format!("did you mean `{near}`?")),
                None => diagnostic,
            });
            None
        }
    }
}

/// The root of the file at a path, which has to be an element of that name.
fn read_root(path: &Path, name: &str, diagnostics: &mut Vec<Diagnostic>) -> Option<Element> {
    match config::read_file(path) {
        Ok(source) => root(&source, name, diagnostics),
        Err(diagnostic) => {
            diagnostics.push(*diagnostic);
            None
        }
    }
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
            diagnostics.push(second.error(
                "E0404",
                second.name_span(),
                format!("expected one `<{name}>` and no more"),
            ));
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

fn read_field(path: &Path, diagnostics: &mut Vec<Diagnostic>) -> FieldGeometry {
    let mut geometry = FieldGeometry::default();
    if let Some(root) = read_root(path, "field", diagnostics) {
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

fn read_simulator(path: &Path, diagnostics: &mut Vec<Diagnostic>) -> (Physics, Rules) {
    let (mut physics, mut rules) = (Physics::default(), Rules::default());
    if let Some(root) = read_root(path, "simulator", diagnostics) {
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

fn read_team(team: &Element, path: &Path, diagnostics: &mut Vec<Diagnostic>) -> Option<TeamFile> {
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
    let robots =
        team.children_named("robot").filter_map(|robot| read_robot(robot, path, diagnostics)).collect();
    let setup = TeamSetup { number: number?, name: name?, colour: colour?, plays: plays? };
    Some(TeamFile { setup, robots })
}

fn read_robot(robot: &Element, path: &Path, diagnostics: &mut Vec<Diagnostic>) -> Option<RobotFile> {
    let mut attributes = Attributes::new(robot, diagnostics);
    attributes.required("number");
    attributes.required("role");
    let number = attributes.integer("number");
    let role = attributes.get("role").cloned();
    attributes.finish();
    robot.expect_children(&[], diagnostics);
    let role = role.and_then(|attribute| named(path, robot, &attribute, diagnostics));
    Some(RobotFile { number: number?, role: role? })
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
    if let [first, second] = &setups[..]
        && host_name(&first.name) == host_name(&second.name)
    {
        let message =
            format!("`{}` and `{}` are too alike: their robots would have one name", first.name, second.name);
        diagnostics.push(root.error("E0407", root.name_span(), message));
    }
}

/// What the hosts of a team are named after: its name in lower case, with hyphens for all but letters and digits.
pub(crate) fn host_name(team: &str) -> String {
    let letters = team.trim().chars().map(|c| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '-' });
    letters.collect()
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
        assert!(
            found[0].starts_with("match.xml:1:8: error[E0304]") && found[0].contains("did you mean `half`?")
        );
        assert!(found[1].starts_with("match.xml:2:36: error") && found[1].contains("did you mean `blue`?"));
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

    #[test]
    fn teams_have_names_that_differ() {
        let found = diagnostics_of(
            "<match><team number='1' name='A b' colour='blue' side='left'/>\n<team number='2' name='a-B' colour='red' side='right'/></match>",
        );
        assert_eq!(found.len(), 1, "{found:#?}");
        assert!(
            found[0].starts_with("match.xml:1:2: error[E0407]: `A b` and `a-B` are too alike"),
            "{found:#?}"
        );
    }
}
