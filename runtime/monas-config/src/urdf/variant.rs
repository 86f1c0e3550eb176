//! Comparison of a robot with the model from which it is derived.

use monas_robot::{Anatomy, Camera, Joint, Link, LinkMotion};
use yase::{Diagnostic, Span};

use super::description::Description;

/// Tolerance of the comparison with the model, m and rad.
const TOLERANCE: f64 = 1e-6;

/// Differences from a model that are not allowed to single robots: joints, lengths, axes, cameras,
/// skills.
pub(super) fn differences(description: &Description, model: &Anatomy) -> Vec<Diagnostic> {
    let mut comparison = Comparison { description, model, found: Vec::new() };
    comparison.joints();
    if comparison.found.is_empty() {
        comparison.links();
        comparison.body();
    }
    comparison.found
}

/// Warnings of joints, in the order of the model's, that may move further or faster than there.
pub(super) fn excesses(description: &Description, model: &Anatomy) -> Vec<Diagnostic> {
    let joints = description.anatomy.joints.iter().zip(&model.joints).zip(&description.joints);
    let exceeding = joints.filter(|((own, model), _)| exceeds(own, model));
    let warning = |((own, joint), span): ((&Joint, &Joint), &Span)| {
        let message = format!("`{}` may move further or faster than in `{}`", own.name, model.model);
        Diagnostic::warning("E0374", *span, message)
            .with_hint(format!("its range there is {}", range(joint)))
            .in_source(&description.source)
    };
    exceeding.map(warning).collect()
}

fn exceeds(own: &Joint, model: &Joint) -> bool {
    let further =
        own.limits.low < model.limits.low - TOLERANCE || own.limits.high > model.limits.high + TOLERANCE;
    let faster = model.speed.is_some_and(|speed| own.speed.is_none_or(|own| own > speed + TOLERANCE));
    further || faster
}

fn range(joint: &Joint) -> String {
    let speed = joint.speed.map_or(String::new(), |speed| format!(", its speed {speed}"));
    format!("{} to {}{speed}", joint.limits.low, joint.limits.high)
}

struct Comparison<'a> {
    description: &'a Description,
    model: &'a Anatomy,
    found: Vec<Diagnostic>,
}

impl Comparison<'_> {
    fn report(&mut self, span: Span, message: String) {
        let error = Diagnostic::error("E0373", span, message)
            .with_hint("limits, speeds, masses and the ranges of the walk are a robot's own");
        self.found.push(error.in_source(&self.description.source));
    }

    fn joints(&mut self) {
        let (own, model) = (&self.description.anatomy, self.model);
        for (index, joint) in own.joints.iter().enumerate() {
            let expected = model.joints.get(index).map(|joint| joint.name.as_str());
            if expected != Some(&joint.name) {
                let expected = expected.map_or("none".to_owned(), |name| format!("`{name}`"));
                let message =
                    format!("joint {index} is `{}`, in `{}` it is {expected}", joint.name, model.model);
                self.report(self.description.joints[index], message);
            }
        }
        if let Some(missing) = model.joints.get(own.joints.len()) {
            let message = format!("the joint `{}` of `{}` is missing", missing.name, model.model);
            self.report(self.description.robot, message);
        }
    }

    fn links(&mut self) {
        let own = &self.description.anatomy;
        for expected in &self.model.links {
            let Some(index) = own.link(&expected.name) else {
                let message = format!("the link `{}` of `{}` is missing", expected.name, self.model.model);
                self.report(self.description.robot, message);
                continue;
            };
            let (span, here) = (self.description.links[index], &own.links[index]);
            let carriers = [(own, here.parent), (self.model, expected.parent)].map(carrier);
            if carriers[0] != carriers[1] {
                let [here, there] = carriers;
                let message = format!(
                    "`{here}` carries `{}`, in `{}` it is `{there}`",
                    expected.name, self.model.model
                );
                self.report(span, message);
            } else if apart(here.offset, expected.offset).max(apart(here.rotation, expected.rotation))
                > TOLERANCE
            {
                let (name, model) = (&expected.name, &self.model.model);
                let message =
                    format!("`{name}` is at {}, in `{model}` at {}", origin(here), origin(expected));
                self.report(span, message);
            } else if !moves_alike(here, expected) {
                let message = format!("`{}` moves otherwise than in `{}`", expected.name, self.model.model);
                self.report(span, message);
            }
        }
    }

    fn body(&mut self) {
        let (own, model) = (&self.description.anatomy, self.model);
        let differs = [
            ("cycle", own.cycle != model.cycle),
            ("radio", own.radio != model.radio),
            ("leds", own.has_leds != model.has_leds),
            ("skills", own.skills != model.skills),
            ("cameras", cameras(own) != cameras(model)),
        ];
        for (what, _) in differs.into_iter().filter(|(_, differs)| *differs) {
            let message = format!("`monas` differs from that of `{}`: {what}", model.model);
            self.report(self.description.monas, message);
        }
    }
}

/// The cameras with the names of their links: a robot of its own may have further links.
fn cameras(anatomy: &Anatomy) -> Vec<(&str, &str, [f64; 2])> {
    let link = |camera: &Camera| camera.link.map_or("", |link| anatomy.links[link].name.as_str());
    let described = |camera| {
        let Camera { name, horizontal, vertical, .. }: &Camera = camera;
        (name.as_str(), link(camera), [*horizontal, *vertical])
    };
    anatomy.cameras.iter().map(described).collect()
}

/// The name of the link that carries another one.
fn carrier((anatomy, parent): (&Anatomy, Option<usize>)) -> &str {
    parent.map_or("nothing", |parent| &anatomy.links[parent].name)
}

/// The greatest difference of two components.
fn apart(one: [f64; 3], other: [f64; 3]) -> f64 {
    one.iter().zip(other).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

fn origin(link: &Link) -> String {
    let ([x, y, z], [roll, pitch, yaw]) = (link.offset, link.rotation);
    format!("xyz {x} {y} {z}, rpy {roll} {pitch} {yaw}")
}

fn moves_alike(one: &Link, other: &Link) -> bool {
    match (one.motion, other.motion) {
        (None, None) => true,
        (Some(one), Some(other)) => {
            let axis = |motion: LinkMotion| motion.axis.map(|part| part * motion.factor);
            let difference = apart(axis(one), axis(other)).max((one.offset - other.offset).abs());
            (one.joint, one.is_shift) == (other.joint, other.is_shift) && difference < TOLERANCE
        }
        _ => false,
    }
}
