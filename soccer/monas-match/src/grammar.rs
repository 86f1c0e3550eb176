//! The grammar of match files.

use std::time::Duration;

use monas::config::{AttributeRule, ElementRule, Grammar, Identity, Kind};
use monas_robot::ObjectSet;
use monas_sim::{FieldGeometry, MatchRules, Parameter, Physics, Radio};

/// The roots of a robot's role.
pub(crate) const ROLE: [&str; 4] = ["agent", "provider", "link", "body"];

/// The words for how ball and goals look.
pub(crate) const OBJECTS: [(&str, ObjectSet); 2] =
    [("2010", ObjectSet::Of2010), ("today", ObjectSet::OfToday)];

/// The grammar of matches, fields, simulators and roles.
pub fn of_matches() -> Grammar {
    let simulator =
        ElementRule::new("simulator", "every number of the simulator that is not to keep its default")
            .child("physics")
            .child("rules")
            .child("radio");
    let parts = [
        ("physics", "how bodies, ball and cameras behave", Physics::keys()),
        ("rules", "the referee's rules", MatchRules::keys()),
        ("radio", "how the radio carries the messages of a team", Radio::keys()),
    ];
    let grammar = Grammar::agents().root(game()).with(team()).with(robot()).root(field()).root(simulator);
    parts.into_iter().fold(grammar, |grammar, (name, doc, keys)| part(grammar, name, doc, keys))
}

fn game() -> ElementRule {
    let half = Kind::Duration { min: Duration::ZERO };
    ElementRule::new("match", "two teams on a field")
        .attribute(AttributeRule::new("field", Kind::File, "the file of the field"))
        .attribute(AttributeRule::new("simulator", Kind::File, "the file of the simulator's numbers"))
        .attribute(AttributeRule::new(
            "half",
            half,
            "how long a half is; by default as in the simulator's rules",
        ))
        .attribute(
            AttributeRule::new(
                "objects",
                Kind::Word(OBJECTS.map(|(name, _)| name).to_vec()),
                "how ball and goals look: orange, yellow and blue as in 2010, or black and white as today",
            )
            .or("2010"),
        )
        .children("team")
}

fn team() -> ElementRule {
    ElementRule::new("team", "a team of robots")
        // In packets of the league's GameController the number 255 stands for no team.
        .attribute(AttributeRule::new("number", Kind::whole_in(0, 254), "its number").required())
        .attribute(AttributeRule::new("name", Kind::Text, "its name").required())
        .attribute(AttributeRule::new("colour", Kind::Word(vec!["blue", "red"]), "its colour").required())
        .attribute(
            AttributeRule::new("side", Kind::Word(vec!["left", "right"]), "the side it defends first")
                .required(),
        )
        .children("robot")
        .identified_by(Identity::Attribute("number"))
}

fn robot() -> ElementRule {
    let robot = ElementRule::new("robot", "a robot with its role; what stands in it goes over the role")
        .attribute(AttributeRule::new("number", Kind::whole_in(0, 255), "its number in the team").required())
        .attribute(AttributeRule::new("role", Kind::File, "the file of the agents it runs").required())
        .attribute(AttributeRule::new(
            "process",
            Kind::Flag,
            "whether its agents run in a process of their own, in real time; its body then needs a kind such as nao",
        ))
        .identified_by(Identity::Attribute("number"))
        .layer();
    ROLE.into_iter().fold(robot, ElementRule::children)
}

fn field() -> ElementRule {
    let attribute = |parameter: &Parameter| {
        AttributeRule::new(parameter.key, kind(parameter), parameter.doc).or(parameter.default.to_string())
    };
    ElementRule::new("field", "lengths of the field, m")
        .attributes(FieldGeometry::keys().iter().map(attribute))
}

/// Adds an element whose children are parameters, each with a number.
fn part(grammar: Grammar, name: &'static str, doc: &'static str, keys: &'static [Parameter]) -> Grammar {
    let part = keys.iter().fold(ElementRule::new(name, doc), |part, parameter| part.child(parameter.key));
    keys.iter().fold(grammar.with(part), |grammar, parameter| {
        let number = ElementRule::new(parameter.key, parameter.doc).text("value", kind(parameter));
        grammar.with(number.or(parameter.default.to_string()))
    })
}

fn kind(parameter: &Parameter) -> Kind {
    if parameter.unit == "0 or 1" {
        return Kind::whole_in(0, 1);
    }
    Kind::number_in(parameter.min, parameter.max)
}
