//! An anatomy with the places of its parts in the file.

use std::sync::Arc;

use monas_robot::{Anatomy, Camera, Joint, Limits, Link, LinkMotion};
use yase::{Diagnostic, Source, Span};

use super::tree::{JointElement, JointType, index_of, order};
use super::{SKILLS, placement, range};
use crate::{Element, Grammar, Values};

/// An anatomy, and where its parts are in the file.
pub(super) struct Description {
    pub(super) anatomy: Anatomy,
    pub(super) source: Arc<Source>,
    pub(super) robot: Span,
    pub(super) monas: Span,
    pub(super) joints: Vec<Span>,
    /// The joints that hold the links, and the torso.
    pub(super) links: Vec<Span>,
}

impl Description {
    /// Of a robot that fits the grammar; none if there are errors.
    pub(super) fn of(
        robot: &Element,
        grammar: &Grammar,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<Description> {
        let monas = robot.children_named("monas").next()?;
        let links: Vec<&Element> = robot.children_named("link").collect();
        let names: Vec<&str> = links.iter().map(|link| name_of(link)).collect();
        let joints: Vec<JointElement> = robot
            .children_named("joint")
            .filter_map(|joint| JointElement::of(joint, grammar, &names, diagnostics))
            .collect();
        report_repeated(robot, "link", diagnostics);
        report_repeated(robot, "joint", diagnostics);
        if diagnostics.iter().any(Diagnostic::is_error) {
            return None;
        }
        let order = order(robot, &links, &joints, diagnostics);
        let driven: Vec<&JointElement> = joints.iter().filter(|joint| joint.is_driven()).collect();
        let mut parts = Parts { grammar, driven, diagnostics };
        let index_of_link = |link| order.iter().position(|(placed, _)| *placed == link);
        let link = |&(link, joint): &(usize, Option<&JointElement>)| Link {
            parent: joint.and_then(|joint| index_of_link(joint.parent)),
            ..parts.link(links[link], joint)
        };
        let built: Vec<Link> = order.iter().map(link).collect();
        let anatomy = parts.anatomy(name_of(robot), monas, built);
        let joints = parts.driven.iter().map(|joint| joint.element.name_span()).collect();
        (!diagnostics.iter().any(Diagnostic::is_error)).then(|| Description {
            anatomy,
            source: Arc::clone(robot.source()),
            robot: robot.name_span(),
            monas: monas.name_span(),
            joints,
            links: order
                .iter()
                .map(|&(link, joint)| joint.map_or(links[link], |joint| joint.element).name_span())
                .collect(),
        })
    }
}

/// The name of a link, a joint or a robot.
pub(super) fn name_of(element: &Element) -> &str {
    element.attribute("name").map_or("", |name| name.value.trim())
}

fn report_repeated(robot: &Element, kind: &'static str, diagnostics: &mut Vec<Diagnostic>) {
    let elements: Vec<&Element> = robot.children_named(kind).collect();
    for (index, element) in elements.iter().enumerate() {
        let name = name_of(element);
        if elements[..index].iter().any(|earlier| name_of(earlier) == name) {
            let message = format!("the {kind} `{name}` is there twice");
            diagnostics.push(element.error("E0372", element.name_span(), message));
        }
    }
}

/// Makes the parts of an anatomy of the elements.
struct Parts<'a, 'b> {
    grammar: &'a Grammar,
    /// The joints of the anatomy.
    driven: Vec<&'b JointElement<'a>>,
    diagnostics: &'b mut Vec<Diagnostic>,
}

impl Parts<'_, '_> {
    /// A link at the joint that holds it, without its parent.
    fn link(&mut self, element: &Element, joint: Option<&JointElement>) -> Link {
        let inertial = element.children_named("inertial").next();
        let child = |name| inertial.and_then(|inertial| inertial.children_named(name).next());
        let mass = child("mass").and_then(|mass| Values::of(mass, self.grammar).number("value"));
        let centre = child("origin").map(|origin| placement(origin, self.grammar, self.diagnostics)[0]);
        let [offset, rotation] = joint.map(|joint| joint.placement).unwrap_or_default();
        Link {
            name: name_of(element).to_owned(),
            parent: None,
            offset,
            rotation,
            motion: joint.and_then(|joint| self.motion(joint)),
            mass: mass.unwrap_or_default(),
            centre: centre.unwrap_or_default(),
        }
    }

    fn motion(&mut self, joint: &JointElement) -> Option<LinkMotion> {
        if joint.kind == JointType::Fixed {
            return None;
        }
        let names: Vec<&str> = self.driven.iter().map(|joint| joint.name).collect();
        let (index, factor, offset) = match &joint.mimic {
            None => (names.iter().position(|name| *name == joint.name)?, 1.0, 0.0),
            Some(mimic) => {
                let named = index_of(mimic.joint, &names, "joint that can be followed", self.diagnostics);
                (named?, mimic.factor, mimic.offset)
            }
        };
        let is_shift = joint.kind == JointType::Prismatic;
        Some(LinkMotion { is_shift, factor, offset, ..LinkMotion::turn(index, joint.axis) })
    }

    fn anatomy(&mut self, name: &str, monas: &Element, links: Vec<Link>) -> Anatomy {
        let values = Values::of(monas, self.grammar);
        let child = |name| monas.children_named(name).next();
        let (head, walk) = (child("head"), child("walk"));
        let still = Limits::symmetric(0.0);
        let mut velocity = |key| walk.map_or(still, |walk| range(walk, key, self.grammar, self.diagnostics));
        let (walk_x, walk_y, walk_turn) = (velocity("x"), velocity("y"), velocity("turn"));
        let mut joint = |key| head.map_or(still, |head| self.head_joint(head, key));
        let (head_yaw, head_pitch) = (joint("yaw"), joint("pitch"));
        let cameras = monas.children_named("camera").filter_map(|camera| self.camera(camera, &links));
        let cameras = cameras.collect();
        let skill = |element: &Element| SKILLS.iter().find(|(word, _)| *word == element.text());
        Anatomy {
            head_yaw,
            head_pitch,
            walk_x,
            walk_y,
            walk_turn,
            cameras,
            skills: monas.children_named("skill").filter_map(skill).map(|&(_, skill)| skill).collect(),
            radio: values.number("radio").unwrap_or_default(),
            joints: self.driven.iter().map(|joint| described(joint)).collect(),
            links,
            has_leds: values.flag("leds").unwrap_or_default(),
            ..Anatomy::new(name, values.duration("cycle").unwrap_or_default())
        }
    }

    /// The range of a joint of the head.
    fn head_joint(&mut self, head: &Element, key: &str) -> Limits {
        let names: Vec<&str> = self.driven.iter().map(|joint| joint.name).collect();
        let given = Values::of(head, self.grammar).given(key);
        let index = given.and_then(|given| index_of(given, &names, "joint", self.diagnostics));
        index.map_or(Limits::symmetric(0.0), |index| self.driven[index].limits)
    }

    fn camera(&mut self, element: &Element, links: &[Link]) -> Option<Camera> {
        let values = Values::of(element, self.grammar);
        let names: Vec<&str> = links.iter().map(|link| link.name.as_str()).collect();
        Some(Camera {
            name: name_of(element).to_owned(),
            link: Some(index_of(values.given("link")?, &names, "link", self.diagnostics)?),
            horizontal: values.number("horizontal")?,
            vertical: values.number("vertical")?,
        })
    }
}

fn described(joint: &JointElement) -> Joint {
    Joint { name: joint.name.to_owned(), limits: joint.limits, speed: joint.speed }
}
