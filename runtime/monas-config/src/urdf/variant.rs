//! Whether a robot is built like another one.

use monas_robot::{Anatomy, Link};
use nalgebra::Isometry3;
use yase::{Diagnostic, Span};

use super::description::Description;

/// How far, m and rad, a link may be from where that of the model is.
const SAME_PLACE: f64 = 1e-6;

/// What differs from a model and is not one robot's own: joints, lengths, axes, cameras, skills.
pub(super) fn differences(description: &Description, model: &Anatomy) -> Vec<Diagnostic> {
    let mut comparison = Comparison { description, model, found: Vec::new() };
    comparison.joints();
    if comparison.found.is_empty() {
        comparison.links();
        comparison.body();
    }
    comparison.found
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
        // What a displaced link carries is displaced with it.
        let mut is_displaced = vec![false; self.model.links.len()];
        for (index, expected) in self.model.links.iter().enumerate() {
            if expected.parent.is_some_and(|parent| is_displaced[parent]) {
                is_displaced[index] = true;
                continue;
            }
            let Some(own) = self.description.anatomy.link(&expected.name) else {
                let message = format!("the link `{}` of `{}` is missing", expected.name, self.model.model);
                self.report(self.description.robot, message);
                continue;
            };
            let span = self.description.links[own];
            let [here, there] = [(&self.description.anatomy, own), (self.model, index)].map(straight_pose);
            let apart = (here.translation.vector - there.translation.vector).norm();
            if apart.max(here.rotation.angle_to(&there.rotation)) > SAME_PLACE {
                let [here, there] = [here, there].map(shown);
                let model = &self.model.model;
                is_displaced[index] = true;
                let message = format!("`{}` is at {here}, in `{model}` at {there}", expected.name);
                self.report(span, message);
            } else if !moves_alike(&self.description.anatomy.links[own], expected) {
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
            ("cameras", own.cameras != model.cameras),
        ];
        for (what, _) in differs.into_iter().filter(|(_, differs)| *differs) {
            let message = format!("`monas` differs from that of `{}`: {what}", model.model);
            self.report(self.description.monas, message);
        }
    }
}

/// The pose of a link in the frame of the torso with all joints at zero.
fn straight_pose((anatomy, link): (&Anatomy, usize)) -> Isometry3<f64> {
    anatomy.pose_in_torso(link, Isometry3::identity(), &vec![0.0; anatomy.joints.len()])
}

fn shown(pose: Isometry3<f64>) -> String {
    // Adding zero makes a negative zero positive.
    let [x, y, z] = <[f64; 3]>::from(pose.translation.vector).map(|it| it + 0.0);
    let [roll, pitch, yaw] = <[f64; 3]>::from(pose.rotation.euler_angles()).map(|it| it + 0.0);
    format!("xyz {x:.4} {y:.4} {z:.4}, rpy {roll:.4} {pitch:.4} {yaw:.4}")
}

fn moves_alike(one: &Link, other: &Link) -> bool {
    match (one.motion, other.motion) {
        (None, None) => true,
        (Some(one), Some(other)) => {
            let way = one.axis.into_inner() * one.factor - other.axis.into_inner() * other.factor;
            let offset = (one.offset - other.offset).abs();
            (one.joint, one.is_shift) == (other.joint, other.is_shift) && way.norm().max(offset) < SAME_PLACE
        }
        _ => false,
    }
}
