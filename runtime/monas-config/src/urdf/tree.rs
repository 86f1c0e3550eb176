//! The joints of a description and the order of its links.

use monas_robot::Limits;
use yase::Diagnostic;

use super::description::name_of;
use super::{numbers, placement};
use crate::{Attribute, Element, Grammar, Values};

/// The type of motion of a joint.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum JointType {
    Revolute,
    Continuous,
    Prismatic,
    Fixed,
}

pub(super) const TYPES: [(&str, JointType); 4] = [
    ("revolute", JointType::Revolute),
    ("continuous", JointType::Continuous),
    ("prismatic", JointType::Prismatic),
    ("fixed", JointType::Fixed),
];

/// A joint as the file describes it.
pub(super) struct JointElement<'a> {
    pub(super) element: &'a Element,
    pub(super) name: &'a str,
    pub(super) kind: JointType,
    /// The indices of the links.
    pub(super) parent: usize,
    pub(super) child: usize,
    /// Place and rotation of the child.
    pub(super) placement: [[f64; 3]; 2],
    pub(super) axis: [f64; 3],
    pub(super) limits: Limits,
    pub(super) speed: Option<f64>,
    pub(super) mimic: Option<Mimic<'a>>,
}

/// With which joint another one moves.
pub(super) struct Mimic<'a> {
    pub(super) joint: &'a Attribute,
    pub(super) factor: f64,
    pub(super) offset: f64,
}

impl<'a> JointElement<'a> {
    /// A joint between two of the named links; none if there is no such link.
    pub(super) fn of(
        element: &'a Element,
        grammar: &'a Grammar,
        links: &[&str],
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<JointElement<'a>> {
        let values = Values::of(element, grammar);
        let child = |name| element.children_named(name).next();
        let link = |name, diagnostics: &mut Vec<Diagnostic>| {
            let given = Values::of(child(name)?, grammar).given("link")?;
            index_of(given, links, "link", diagnostics)
        };
        let (parent, carried) = (link("parent", diagnostics), link("child", diagnostics));
        let kind = values.word("type", &TYPES)?;
        let (limits, speed) = limits(element, kind, grammar, diagnostics);
        Some(JointElement {
            element,
            name: values.text("name")?,
            kind,
            parent: parent?,
            child: carried?,
            placement: child("origin")
                .map_or([[0.0; 3]; 2], |origin| placement(origin, grammar, diagnostics)),
            axis: child("axis")
                .filter(|_| kind != JointType::Fixed)
                .map_or(DEFAULT_AXIS, |axis| direction(axis, grammar, diagnostics)),
            limits,
            speed,
            mimic: child("mimic").and_then(|mimic| {
                let values = Values::of(mimic, grammar);
                let (factor, offset) = (values.number("multiplier")?, values.number("offset")?);
                Some(Mimic { joint: values.given("joint")?, factor, offset })
            }),
        })
    }

    /// Whether it is a joint of the anatomy: one with a motor.
    pub(super) fn is_driven(&self) -> bool {
        self.kind != JointType::Fixed && self.mimic.is_none()
    }
}

/// The index of what an attribute names; an error at the attribute if it is none of the names.
pub(super) fn index_of(
    given: &Attribute,
    names: &[&str],
    what: &str,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<usize> {
    let found = names.iter().position(|name| *name == given.value.trim());
    if found.is_none() {
        let error = given.error("E0372", format!("there is no {what} `{}`", given.value));
        diagnostics.push(error.with_nearest(&given.value, names.iter().copied()));
    }
    found
}

/// The range and the greatest speed of a joint.
fn limits(
    joint: &Element,
    kind: JointType,
    grammar: &Grammar,
    diagnostics: &mut Vec<Diagnostic>,
) -> (Limits, Option<f64>) {
    let unlimited = Limits::new(f64::MIN, f64::MAX);
    let Some(limit) = joint.children_named("limit").next() else {
        let is_needed = matches!(kind, JointType::Revolute | JointType::Prismatic);
        if is_needed && joint.children_named("mimic").next().is_none() {
            let message = "a joint of this type needs a `limit`";
            let error = joint.error("E0372", joint.name_span(), message);
            diagnostics.push(error.with_hint("one that turns without end is `continuous`"));
        }
        return (unlimited, None);
    };
    let values = Values::of(limit, grammar);
    let number = |key| values.number(key).unwrap_or_default();
    let range = Limits::new(number("lower"), number("upper"));
    if range.low > range.high {
        let message = format!("`lower` is {}, above `upper`, {}", range.low, range.high);
        diagnostics.push(limit.error("E0372", limit.name_span(), message));
    }
    let speed = Some(number("velocity")).filter(|&speed| speed > 0.0);
    (if kind == JointType::Continuous { unlimited } else { range }, speed)
}

/// The axis of a joint that gives none.
const DEFAULT_AXIS: [f64; 3] = [1.0, 0.0, 0.0];

/// The unit vector of an axis.
fn direction(axis: &Element, grammar: &Grammar, diagnostics: &mut Vec<Diagnostic>) -> [f64; 3] {
    let Some(vector) = numbers::<3>(axis, "xyz", grammar, diagnostics) else { return DEFAULT_AXIS };
    let length = vector.iter().map(|part| part * part).sum::<f64>().sqrt();
    if length < 1e-9 || !length.is_finite() {
        diagnostics.push(axis.error("E0372", axis.name_span(), "the axis has no direction"));
        return DEFAULT_AXIS;
    }
    vector.map(|part| part / length)
}

/// The links in an order in which each one comes after the one that carries it, as indices, with
/// the joints that hold them: the root, then the links of the joints in the order of the file.
pub(super) fn order<'a, 'b>(
    robot: &Element,
    links: &[&Element],
    joints: &'b [JointElement<'a>],
    diagnostics: &mut Vec<Diagnostic>,
) -> Vec<(usize, Option<&'b JointElement<'a>>)> {
    let carriers = |link| joints.iter().filter(move |joint| joint.child == link);
    let mut report = |element: &Element, message: String| {
        let error = element.error("E0372", element.name_span(), message);
        diagnostics.push(error.with_hint("each link but one, the torso, is the child of one joint"));
    };
    let mut roots = (0..links.len()).filter(|&link| carriers(link).next().is_none());
    let Some(root) = roots.next() else {
        report(robot, "the robot has no link that no joint carries".to_owned());
        return Vec::new();
    };
    for other in roots {
        let names = [other, root].map(|link| name_of(links[link]));
        report(links[other], format!("no joint connects `{}` with `{}`", names[0], names[1]));
    }
    for (link, element) in links.iter().enumerate() {
        for second in carriers(link).skip(1) {
            report(second.element, format!("`{}` is the child of two joints", name_of(element)));
        }
    }
    let mut order = vec![(root, None)];
    let mut is_placed: Vec<bool> = (0..links.len()).map(|link| link == root).collect();
    loop {
        let before = order.len();
        for joint in joints {
            if is_placed[joint.parent] && !std::mem::replace(&mut is_placed[joint.child], true) {
                order.push((joint.child, Some(joint)));
            }
        }
        if order.len() == before {
            break;
        }
    }
    if let Some(link) = (0..links.len()).find(|&link| !is_placed[link] && carriers(link).next().is_some()) {
        report(links[link], format!("no joints lead from the torso to `{}`", name_of(links[link])));
    }
    order
}
