//! Anatomies of robots, in files of the Unified Robot Description Format.
//!
//! [URDF](https://wiki.ros.org/urdf/XML) describes joints and links; most manufacturers publish a
//! file. An [`Anatomy`] has from it:
//!
//! | element | gives |
//! |---|---|
//! | `robot` | the model, its `name` |
//! | `joint` of type `revolute`, `continuous` or `prismatic` | a joint, in the order of the file, with `limit` |
//! | `joint` of any type, with `origin`, `parent`, `child`, `axis` | where a link is, and how it moves |
//! | `mimic` | a link that moves with another joint |
//! | `inertial` of a `link` | `mass`, and its centre |
//!
//! Shapes, inertias, transmissions and elements of other programs have no effect. Facts that
//! URDF cannot express are in an element `monas`, which other programs ignore:
//!
//! | in `monas` | gives |
//! |---|---|
//! | `cycle`, `radio`, `leds` | the period of the body, the longest message, whether it has LEDs |
//! | `head`: `yaw`, `pitch` | the joints of the head; without it the head does not move |
//! | `walk`: `x`, `y`, `turn` | least and greatest velocities, m/s and rad/s |
//! | `camera`: `name`, `link`, `horizontal`, `vertical` | a camera that looks along the x axis of a link; angles of view, rad |
//! | `skill` | a named skill, such as `KickLeft` |
//!
//! `monas_kinematics` computes where the links are.
//!
//! ```
//! use monas_config::urdf;
//!
//! let text = r#"<robot name="lamp">
//!   <link name="base"/>
//!   <link name="arm"><inertial><origin xyz="0 0 0.2"/><mass value="0.5"/></inertial></link>
//!   <joint name="Tilt" type="revolute">
//!     <parent link="base"/><child link="arm"/>
//!     <origin xyz="0 0 0.1"/><axis xyz="0 1 0"/>
//!     <limit lower="-1" upper="1.5" effort="1" velocity="3"/>
//!   </joint>
//!   <monas cycle="10ms"/>
//! </robot>"#;
//! let (lamp, diagnostics) = urdf::read(&yase::Source::new("lamp.urdf", text));
//! let lamp = lamp.ok_or("there are errors")?;
//! assert_eq!((lamp.joints[0].limits.high, diagnostics.len()), (1.5, 0));
//! assert_eq!((lamp.links[1].offset, lamp.links[1].centre), ([0.0, 0.0, 0.1], [0.0, 0.0, 0.2]));
//! # Ok::<(), &str>(())
//! ```

mod description;
mod tree;
mod variant;

use std::path::Path;
use std::sync::Arc;

use monas_robot::{Anatomy, Limits, Skill};
use yase::{Diagnostic, Source};

use crate::{AttributeRule, Element, ElementRule, Grammar, Kind, Values, paths, xml};

use description::Description;

/// The skills that a file can name.
const SKILLS: [(&str, Skill); 7] = [
    ("KickLeft", Skill::KickLeft),
    ("KickRight", Skill::KickRight),
    ("FallLeft", Skill::FallLeft),
    ("FallRight", Skill::FallRight),
    ("DiveLeft", Skill::DiveLeft),
    ("DiveRight", Skill::DiveRight),
    ("StandUp", Skill::StandUp),
];

/// Reads a file, with its diagnostics. There is no anatomy if one of these is an error.
pub fn load(path: &Path) -> (Option<Anatomy>, Vec<Diagnostic>) {
    match paths::read(path) {
        Ok(source) => read(&source),
        Err(diagnostic) => (None, vec![*diagnostic]),
    }
}

/// As [`load`], from a text in memory.
pub fn read(source: &Arc<Source>) -> (Option<Anatomy>, Vec<Diagnostic>) {
    let (description, diagnostics) = described(source);
    (description.map(|description| description.anatomy), diagnostics)
}

/// Reads the file of a robot that is built like `model`, with its own limits, speeds, masses and
/// ranges of the walk. Other joints, lengths, cameras and skills than those of `model` are errors,
/// joints that may move further or faster than those of `model` are warnings.
pub fn load_variant(path: &Path, model: &Anatomy) -> (Option<Anatomy>, Vec<Diagnostic>) {
    match paths::read(path) {
        Ok(source) => read_variant(&source, model),
        Err(diagnostic) => (None, vec![*diagnostic]),
    }
}

/// As [`load_variant`], from a text in memory.
pub fn read_variant(source: &Arc<Source>, model: &Anatomy) -> (Option<Anatomy>, Vec<Diagnostic>) {
    let (description, mut diagnostics) = described(source);
    let Some(description) = description else { return (None, diagnostics) };
    let differences = variant::differences(&description, model);
    let is_variant = differences.is_empty();
    if is_variant {
        diagnostics.extend(variant::excesses(&description, model));
    }
    diagnostics.extend(differences);
    (is_variant.then_some(description.anatomy), diagnostics)
}

fn described(source: &Arc<Source>) -> (Option<Description>, Vec<Diagnostic>) {
    let robot = match xml::parse_strict(source) {
        Ok(root) => root,
        Err(error) if error.message.contains("xacro") => {
            return (None, vec![error.with_hint("expand the file with the program `xacro` first")]);
        }
        Err(error) => return (None, vec![error]),
    };
    let (grammar, mut diagnostics) = (grammar(), Vec::new());
    let robot = without_others(robot, &grammar);
    grammar.check(std::slice::from_ref(&robot), &mut diagnostics);
    if diagnostics.iter().any(Diagnostic::is_error) {
        return (None, diagnostics);
    }
    (Description::of(&robot, &grammar, &mut diagnostics), diagnostics)
}

/// The elements that have an effect.
fn grammar() -> Grammar {
    let name = || AttributeRule::new("name", Kind::Text, "its name").required();
    let text = |key: &'static str, doc| AttributeRule::new(key, Kind::Text, doc);
    let number = |key: &'static str, doc| AttributeRule::new(key, Kind::number_in(f64::MIN, f64::MAX), doc);
    let size = |key: &'static str, doc| AttributeRule::new(key, Kind::number_from(0.0), doc);
    let link = || text("link", "the name of a link").required();
    let angle = |key: &'static str| {
        let kind = Kind::number_in(1e-3, std::f64::consts::PI);
        AttributeRule::new(key, kind, "the angle of view, rad").required()
    };
    let types = Kind::Word(tree::TYPES.map(|(word, _)| word).to_vec());
    let skills = Kind::Word(SKILLS.map(|(word, _)| word).to_vec());
    let cycle = Kind::Duration { min: std::time::Duration::from_micros(100) };
    Grammar::default()
        .root(
            ElementRule::new("robot", "a robot")
                .attribute(name())
                .with_parameters()
                .children("link")
                .children("joint")
                .required_child("monas"),
        )
        .with(ElementRule::new("link", "a rigid part").attribute(name()).with_parameters().child("inertial"))
        .with(ElementRule::new("inertial", "the mass of a link").child("origin").required_child("mass"))
        .with(ElementRule::new("mass", "kg").attribute(size("value", "kg").required()))
        .with(
            ElementRule::new("joint", "what holds one link at another")
                .attribute(name())
                .attribute(AttributeRule::new("type", types, "how it moves").required())
                .with_parameters()
                .required_child("parent")
                .required_child("child")
                .child("origin")
                .child("axis")
                .child("limit")
                .child("mimic"),
        )
        .with(ElementRule::new("parent", "the link that carries the other").attribute(link()))
        .with(ElementRule::new("child", "the link that is carried").attribute(link()))
        .with(
            ElementRule::new("origin", "a pose")
                .attribute(text("xyz", "its place, m").or("0 0 0"))
                .attribute(text("rpy", "roll, pitch and yaw, rad").or("0 0 0")),
        )
        .with(ElementRule::new("axis", "of a joint").attribute(text("xyz", "a direction").or("1 0 0")))
        .with(
            ElementRule::new("limit", "the range of a joint")
                .attribute(number("lower", "rad or m").or("0"))
                .attribute(number("upper", "rad or m").or("0"))
                .attribute(size("effort", "Nm or N"))
                .attribute(size("velocity", "rad/s or m/s; not known if it is 0").or("0")),
        )
        .with(
            ElementRule::new("mimic", "a joint that moves with another")
                .attribute(text("joint", "the name of the other joint").required())
                .attribute(number("multiplier", "of its angle").or("1"))
                .attribute(number("offset", "rad or m").or("0")),
        )
        .with(
            ElementRule::new("monas", "what URDF has no words for")
                .attribute(AttributeRule::new("cycle", cycle, "the period of the body").required())
                .attribute(AttributeRule::new("radio", Kind::whole_from(0), "bytes of a message").or("0"))
                .attribute(AttributeRule::new("leds", Kind::Flag, "whether it has LEDs").or("0"))
                .child("head")
                .child("walk")
                .children("camera")
                .children("skill"),
        )
        .with(
            ElementRule::new("head", "the joints of the head")
                .attribute(text("yaw", "the name of a joint"))
                .attribute(text("pitch", "the name of a joint")),
        )
        .with(
            ElementRule::new("walk", "the ranges of the walk")
                .attribute(text("x", "least and greatest velocity ahead, m/s").or("0 0"))
                .attribute(text("y", "the same to the left").or("0 0"))
                .attribute(text("turn", "least and greatest angular velocity, rad/s").or("0 0")),
        )
        .with(
            ElementRule::new("camera", "a camera")
                .attribute(name())
                .attribute(link())
                .attribute(angle("horizontal"))
                .attribute(angle("vertical")),
        )
        .with(ElementRule::new("skill", "the name of a skill").text("name", skills))
}

/// An element without the elements that the grammar does not know at their places: shapes, colours,
/// and what is meant for other programs. Within `monas` all are kept, so that they are reported.
fn without_others(element: Element, grammar: &Grammar) -> Element {
    if element.is("monas") {
        return element;
    }
    let children = element.children().iter().filter(|child| {
        grammar.element(element.name()).is_some_and(|rule| rule.child_named(child.name()).is_some())
    });
    let children: Vec<Element> = children.map(|child| without_others(child.clone(), grammar)).collect();
    element.without_children().with_children(children)
}

/// The place of an `origin`, and how it is turned about the fixed axes x, y and z.
fn placement(origin: &Element, grammar: &Grammar, diagnostics: &mut Vec<Diagnostic>) -> [[f64; 3]; 2] {
    ["xyz", "rpy"].map(|key| numbers(origin, key, grammar, diagnostics).unwrap_or_default())
}

/// The numbers of an attribute, separated by blanks; otherwise an error.
fn numbers<const N: usize>(
    element: &Element,
    key: &str,
    grammar: &Grammar,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<[f64; N]> {
    let values = Values::of(element, grammar);
    let text = values.text(key)?;
    let found: Option<Vec<f64>> = text.split_whitespace().map(|number| number.parse().ok()).collect();
    let finite = found.filter(|numbers| numbers.iter().all(|number| number.is_finite()));
    let numbers = finite.and_then(|numbers| numbers.try_into().ok());
    if let (None, Some(given)) = (numbers, values.given(key)) {
        let message = format!("`{key}` is `{text}`, expected {N} numbers separated by blanks");
        diagnostics.push(given.error("E0306", message));
    }
    numbers
}

/// A range of an attribute: two numbers.
fn range(element: &Element, key: &str, grammar: &Grammar, diagnostics: &mut Vec<Diagnostic>) -> Limits {
    let [low, high] = numbers(element, key, grammar, diagnostics).unwrap_or_default();
    if low > high
        && let Some(given) = Values::of(element, grammar).given(key)
    {
        let message = format!("`{key}` is `{}`, the least number comes first", given.value);
        diagnostics.push(given.error("E0306", message));
    }
    Limits::new(low, high)
}
