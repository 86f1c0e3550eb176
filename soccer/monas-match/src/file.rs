//! Reads a match file and all files it refers to.
//!
//! ```xml
//! <match field="config/fields/thesis.xml" simulator="config/simulator.xml" half="300s">
//!   <team number="1" name="Blue" colour="blue" side="left">
//!     <robot number="1" role="config/roles/goalie.xml"/>
//!     <robot number="2" role="config/roles/attacker.xml">
//!       <agent priority="2"><name>Attacker</name></agent>
//!     </robot>
//!   </team>
//!   ...
//! </match>
//! ```
//!
//! Files that the match file refers to are located by [`monas::config::locate`]: in its folder,
//! then in each parent folder. The contents of `<robot>` override its role; the command line
//! overrides both.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use monas::config::{self, Attribute, Element, Grammar, Layers, Values};
use monas_robot::ObjectSet;
use monas_sim::{
    FieldGeometry, FieldSide, LineupError, LineupPart, MatchRules, Physics, Radio, TeamColour, TeamSetup,
};
use yase::{Diagnostic, Source, Span};

use crate::grammar;
use crate::parameters;
use crate::settings::MatchSettings;

/// The contents of a match file and of the files it refers to, except roles, which are paths.
#[derive(Clone, Debug)]
pub(crate) struct MatchFile {
    pub(crate) geometry: FieldGeometry,
    pub(crate) physics: Physics,
    pub(crate) rules: MatchRules,
    pub(crate) radio: Radio,
    pub(crate) objects: ObjectSet,
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
    /// Its agents run in a process of their own, in real time.
    pub(crate) has_process: bool,
    /// Overrides of the role for this robot.
    pub(crate) overrides: Layers,
}

/// Reads a match file with overriding layers; faults are appended to `diagnostics`.
pub(crate) fn read(path: &Path, layers: &Layers, diagnostics: &mut Vec<Diagnostic>) -> Option<MatchFile> {
    let files = FileReader { grammar: &grammar::of_matches(), layers };
    let root = files.root(path, "match", diagnostics)?;
    let (field, simulator) = files.environment(&root, path, diagnostics);
    let geometry = geometry(field, files.grammar, diagnostics);
    let (physics, mut rules, radio) =
        simulator.as_ref().map(|root| simulator_parts(root, files.grammar)).unwrap_or_default();
    let values = Values::of(&root, files.grammar);
    let objects = values.word("objects", &grammar::OBJECTS).unwrap_or_default();
    set_half(&mut rules, values.duration("half"), &root, diagnostics);
    let valid = [("physics", physics.validate()), ("rules", rules.validate()), ("radio", radio.validate())];
    for (part, valid) in valid {
        if let Err(error) = valid {
            let element = simulator.as_ref().and_then(|root| root.children_named(part).last());
            let element = element.unwrap_or(&root);
            diagnostics.push(element.error("E0405", element.name_span(), error.to_string()));
        }
    }
    let team = |team| read_team(team, path, files.grammar, diagnostics);
    let teams = root.children_named("team").filter_map(team).collect();
    let file = MatchFile { geometry, physics, rules, radio, objects, teams };
    check(&file, &root, diagnostics);
    Some(file)
}

/// The elements of a match: the match with its robots and their agents, its field and its
/// simulator.
pub(crate) fn elements(path: &Path, layers: &Layers, diagnostics: &mut Vec<Diagnostic>) -> Vec<Element> {
    let files = FileReader { grammar: &grammar::of_matches(), layers };
    let Some(root) = files.root(path, "match", diagnostics) else { return Vec::new() };
    let (field, simulator) = files.environment(&root, path, diagnostics);
    let nowhere = |name: &str| Element::new(name, root.source());
    let mut simulator = simulator.unwrap_or_else(|| nowhere("simulator"));
    for part in ["physics", "rules", "radio"] {
        if simulator.children_named(part).next().is_none() {
            simulator = simulator.with_children([nowhere(part)]);
        }
    }
    let field = field.unwrap_or_else(|| nowhere("field"));
    let mut settings = MatchSettings::new(layers);
    let root = root.map_children(&mut |team| {
        team.map_children(&mut |robot| with_role(robot, path, &mut settings, diagnostics))
    });
    diagnostics.extend(settings.unused_settings());
    vec![root, field, simulator]
}

/// A robot element merged with its role.
fn with_role(
    robot: Element,
    path: &Path,
    settings: &mut MatchSettings,
    diagnostics: &mut Vec<Diagnostic>,
) -> Element {
    let Some(role) = robot.attribute("role").and_then(|role| named(path, role, diagnostics)) else {
        return robot;
    };
    let own = Layers::new().robot(robot.children().iter().cloned());
    let resolved = config::resolve(&role, &Grammar::agents(), &settings.over(&own));
    diagnostics.extend(resolved.diagnostics);
    diagnostics.extend(settings.unmatched(&own, resolved.unmatched));
    robot.without_children().with_children(resolved.elements)
}

/// Reads elements from files and layers.
struct FileReader<'a> {
    grammar: &'a Grammar,
    layers: &'a Layers,
}

impl FileReader<'_> {
    /// The single root element of a file, which must have the given name, with overriding layers
    /// applied.
    fn root(&self, path: &Path, name: &str, diagnostics: &mut Vec<Diagnostic>) -> Option<Element> {
        match config::read_file(path) {
            Ok(source) => {
                let resolved = config::resolve_text(&source, self.grammar, &self.layers.of(&[name]));
                let elements = resolved.elements.clone();
                let found = resolved.into_diagnostics();
                let is_broken = found.iter().any(Diagnostic::is_error);
                diagnostics.extend(found);
                only(elements, name, &source, is_broken, diagnostics)
            }
            Err(diagnostic) => {
                diagnostics.push(*diagnostic);
                None
            }
        }
    }

    /// Field and simulator, each from the file that the match refers to; none if there is no file
    /// and no setting.
    fn environment(
        &self,
        root: &Element,
        path: &Path,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> (Option<Element>, Option<Element>) {
        let [field, simulator] = ["field", "simulator"].map(|name| match root.attribute(name) {
            Some(file) => {
                let file = named(path, file, diagnostics)?;
                self.root(&file, name, diagnostics)
            }
            None => {
                let mut elements = Vec::new();
                self.layers.of(&[name]).apply(&mut elements, self.grammar);
                self.grammar.check(&elements, diagnostics);
                elements.pop()
            }
        });
        (field, simulator)
    }
}

/// The file that an attribute refers to; none, with a diagnostic, if there is no such file.
fn named(path: &Path, attribute: &Attribute, diagnostics: &mut Vec<Diagnostic>) -> Option<PathBuf> {
    match config::locate(path, &attribute.value) {
        Ok(found) => Some(found),
        Err(near) => {
            let diagnostic = attribute.error("E0403", format!("no file `{}`", attribute.value));
            diagnostics.push(match near {
                Some(near) => diagnostic.with_hint(format!("did you mean `{near}`?")),
                None => diagnostic,
            });
            None
        }
    }
}

/// The single root element of a file.
fn only(
    elements: Vec<Element>,
    name: &str,
    source: &Arc<Source>,
    is_broken: bool,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<Element> {
    let mut elements = elements.into_iter();
    let first = elements.next();
    let hint = format!("a file of this kind holds one `{name}`");
    let diagnostic = match (&first, elements.next()) {
        (Some(root), None) if root.is(name) => return first,
        // The grammar has already reported the wrong name.
        _ if is_broken => return None,
        (Some(root), None) => {
            let message = format!("expected a `{name}`, not a `{}`", root.name());
            root.error("E0404", root.name_span(), message)
        }
        (_, Some(second)) => {
            let message = format!("expected one `{name}` and no more");
            second.error("E0404", second.name_span(), message)
        }
        (None, None) => {
            let message = format!("expected a `{name}`, the file holds none");
            Diagnostic::error("E0404", Span::default(), message).in_source(source)
        }
    };
    diagnostics.push(diagnostic.with_hint(hint));
    None
}

fn geometry(field: Option<Element>, grammar: &Grammar, diagnostics: &mut Vec<Diagnostic>) -> FieldGeometry {
    let mut geometry = FieldGeometry::default();
    if let Some(root) = field {
        parameters::from_attributes(&root, grammar, FieldGeometry::keys(), |key, value| {
            // The key and the range have been checked against the same table.
            let _ = geometry.set(key, value);
        });
        if let Err(error) = geometry.validate() {
            diagnostics.push(root.error("E0405", root.name_span(), error.to_string()));
        }
    }
    geometry
}

fn simulator_parts(root: &Element, grammar: &Grammar) -> (Physics, MatchRules, Radio) {
    let (mut physics, mut rules, mut radio) = (Physics::default(), MatchRules::default(), Radio::default());
    for part in root.children_named("physics") {
        parameters::from_children(part, grammar, |key, value| {
            let _ = physics.set(key, value);
        });
    }
    for part in root.children_named("rules") {
        parameters::from_children(part, grammar, |key, value| {
            let _ = rules.set(key, value);
        });
    }
    for part in root.children_named("radio") {
        parameters::from_children(part, grammar, |key, value| {
            let _ = radio.set(key, value);
        });
    }
    (physics, rules, radio)
}

fn set_half(
    rules: &mut MatchRules,
    half: Option<Duration>,
    root: &Element,
    diagnostics: &mut Vec<Diagnostic>,
) {
    if let Some(half) = half
        && let Err(error) = rules.set("half_duration", half.as_secs_f64())
    {
        diagnostics.push(at_value(None, root, "half", "E0402", error.to_string()));
    }
}

const COLOURS: [(&str, TeamColour); 2] = [("blue", TeamColour::Blue), ("red", TeamColour::Red)];
const SIDES: [(&str, FieldSide); 2] = [("left", FieldSide::Left), ("right", FieldSide::Right)];

fn read_team(
    team: &Element,
    path: &Path,
    grammar: &Grammar,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<TeamFile> {
    let robots = team.children_named("robot");
    let robots = robots.filter_map(|robot| read_robot(robot, path, grammar, diagnostics)).collect();
    let values = Values::of(team, grammar);
    let setup = TeamSetup {
        number: values.number("number")?,
        name: values.text("name")?.to_owned(),
        colour: values.word("colour", &COLOURS)?,
        plays: values.word("side", &SIDES)?,
    };
    Some(TeamFile { setup, robots })
}

fn read_robot(
    robot: &Element,
    path: &Path,
    grammar: &Grammar,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<RobotFile> {
    let values = Values::of(robot, grammar);
    let role = values.given("role").and_then(|role| named(path, role, diagnostics));
    let own = Layers::new().robot(robot.children().iter().cloned());
    let has_process = values.flag("process").unwrap_or_default();
    // As layers over the role they would be one body with the attributes of both. A body of the
    // command line is a layer over that of the file.
    let is_of_file = |body: &&Element| Arc::ptr_eq(body.source(), robot.source());
    for body in robot.children_named("body").filter(is_of_file).skip(1) {
        let found = body.error("E0329", body.name_span(), "a robot has one body");
        diagnostics.push(found.with_hint("remove one of the two `body`"));
    }
    Some(RobotFile { number: values.number("number")?, role: role?, has_process, overrides: own })
}

/// Checks that involve both teams.
fn check(file: &MatchFile, root: &Element, diagnostics: &mut Vec<Diagnostic>) {
    if diagnostics.iter().any(Diagnostic::is_error) {
        return;
    }
    let setups: Vec<TeamSetup> = file.teams.iter().map(|team| team.setup.clone()).collect();
    if let Err(error) = monas_sim::check_lineup(&setups, &file.lineup()) {
        diagnostics.push(lineup_diagnostic(root, &error));
    }
    for (index, setup) in setups.iter().enumerate() {
        if setup.name.trim().is_empty() {
            let message = "a team has no name: its robots are named after it".to_owned();
            let found = at_value(team(root, index), root, "name", "E0407", message);
            diagnostics.push(found.with_hint("write a name, as in `name=\"Blue\"`"));
        }
    }
    if let [first, second] = &setups[..]
        && host_name(&first.name) == host_name(&second.name)
    {
        let message =
            format!("`{}` and `{}` are too alike: their robots would have one name", first.name, second.name);
        diagnostics.push(at_value(team(root, 1), root, "name", "E0407", message));
    }
}

/// A fault of the line-up, at the value that is wrong.
fn lineup_diagnostic(root: &Element, error: &LineupError) -> Diagnostic {
    let (element, key) = match error.part {
        LineupPart::Match => (team(root, 2), ""),
        LineupPart::Team(index, key) => (team(root, index), key),
        LineupPart::Robot(index) => {
            let mut robots = root.children_named("team").flat_map(|team| team.children_named("robot"));
            (robots.nth(index), "number")
        }
    };
    at_value(element, root, key, "E0406", error.to_string())
}

fn team(root: &Element, index: usize) -> Option<&Element> {
    root.children_named("team").nth(index)
}

/// An error at a value of an element, or at the element or the root if there is none.
fn at_value(
    element: Option<&Element>,
    root: &Element,
    key: &str,
    code: &'static str,
    message: String,
) -> Diagnostic {
    let element = element.unwrap_or(root);
    match element.attribute(key) {
        Some(value) => value.error(code, message),
        None => element.error(code, element.name_span(), message),
    }
}

/// The prefix of a team's host names: its name in lower case, with hyphens for all characters
/// except letters and digits.
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
        read(&path, &Layers::new(), &mut diagnostics);
        config::sort_diagnostics(&mut diagnostics);
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
    fn objects_have_a_time_that_is_known() {
        let found = diagnostics_of("<match objects='2016'/>");
        assert!(found[0].starts_with("match.xml:1:17: error"), "{found:#?}");
        assert!(found[0].contains("2010") && found[0].contains("today"), "{found:#?}");
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
    fn faults_of_the_line_up_are_reported_at_their_values() {
        let found = |red: &str, more: &str| {
            let found = diagnostics_of(&format!(
                "<match><team number='1' name='A' colour='blue' side='left'/>\n<team {red}/>{more}</match>",
            ));
            found.first().cloned().unwrap_or_default()
        };
        let red = "name='B' number='1' colour='red' side='right'";
        assert_eq!(found(red, ""), "match.xml:2:24: error[E0406]: both teams have the number 1");
        let red = "name='B' number='2' colour='blue' side='right'";
        assert_eq!(found(red, ""), "match.xml:2:35: error[E0406]: both teams wear the same colour");
        let red = "name='B' number='2' colour='red' side='left'";
        assert_eq!(found(red, ""), "match.xml:2:46: error[E0406]: both teams play on the same side");
        let red = "name='B' number='2' colour='red' side='right'";
        let third = "\n<team name='C' number='3' colour='red' side='right'/>";
        assert_eq!(found(red, third), "match.xml:3:2: error[E0406]: a match needs two teams, not 3");
        let robot = |number| format!("<robot number='{number}' role='match.xml'/>");
        let [first, second] = [[1, 2], [3, 3]].map(|numbers| numbers.map(robot).concat());
        let found = diagnostics_of(&format!(
            "<match><team number='1' name='A' colour='blue' side='left'>{first}</team>\n<team {red}>\n{second}</team></match>",
        ));
        assert_eq!(found, ["match.xml:3:52: error[E0406]: team 2 has two robots 3"]);
    }

    #[test]
    fn teams_have_names_that_differ() {
        let found = diagnostics_of(
            "<match><team number='1' name='A b' colour='blue' side='left'/>\n<team number='2' name='a-B' colour='red' side='right'/></match>",
        );
        assert_eq!(found.len(), 1, "{found:#?}");
        assert!(
            found[0].starts_with("match.xml:2:24: error[E0407]: `A b` and `a-B` are too alike"),
            "{found:#?}"
        );
    }

    #[test]
    fn a_team_has_a_name() {
        for name in ["", " "] {
            let found = diagnostics_of(&format!(
                "<match><team number='1' name='A' colour='blue' side='left'/>\n<team number='2' name='{name}' colour='red' side='right'/></match>",
            ));
            assert_eq!(found.len(), 1, "{found:#?}");
            assert!(found[0].starts_with("match.xml:2:"), "{found:#?}");
            assert!(found[0].contains("error[E0407]: a team has no name"), "{found:#?}");
        }
    }

    #[test]
    fn a_robot_of_a_match_has_one_body() {
        let found = diagnostics_of(
            "<match><team number='1' name='A' colour='blue' side='left'>\n<robot number='1' role='match.xml'><body kind='nao'/><body/></robot></team>\n<team number='2' name='B' colour='red' side='right'/></match>",
        );
        assert_eq!(found.len(), 1, "{found:#?}");
        assert!(found[0].starts_with("match.xml:2:55: error[E0329]: a robot has one body"), "{found:#?}");
    }

    #[test]
    fn a_number_that_is_0_or_1_is_nothing_between() {
        for (file, position) in [
            ("<field walls='0.5'/>", "1:15"),
            ("<simulator><rules><switch_colours>0.5</switch_colours></rules></simulator>", "1:35"),
        ] {
            let folder = tempfile::tempdir().unwrap();
            let part = if file.starts_with("<field") { "field" } else { "simulator" };
            std::fs::write(folder.path().join("part.xml"), file).unwrap();
            let path = folder.path().join("match.xml");
            std::fs::write(&path, format!("<match {part}='part.xml'/>")).unwrap();
            let mut diagnostics = Vec::new();
            read(&path, &Layers::new(), &mut diagnostics);
            let found: Vec<String> = diagnostics.iter().map(ToString::to_string).collect();
            assert!(
                found.iter().any(|found| found.contains(&format!("part.xml:{position}: error[E0306]"))),
                "{found:#?}"
            );
        }
    }

    #[test]
    fn the_number_that_stands_for_no_team_is_no_team() {
        let found = |number: u8| {
            diagnostics_of(&format!(
                "<match><team number='1' name='A' colour='blue' side='left'/>\n<team number='{number}' name='B' colour='red' side='right'/></match>",
            ))
        };
        assert!(found(254).is_empty(), "{:#?}", found(254));
        assert!(found(255)[0].starts_with("match.xml:2:15: error"), "{:#?}", found(255));
    }
}
