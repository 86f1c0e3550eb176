//! Special actions: motions of the joints as sequences of poses, in files.
//!
//! A file is what the thesis stores with its configuration library (Listing 4.10): elements `pose`
//! with the angles of joints, rad, by the names of the body's [`Anatomy`]. All attributes are
//! numbers, so that [`XmlConfig::all_attributes`](crate::XmlConfig::all_attributes) reads them too.
//!
//! | attribute of `pose` | means |
//! |---|---|
//! | `duration` | the time of the way to the pose, s; default 1 |
//! | `stiffness` | stiffness of all joints on the way, 0 to 1; default that of the pose before, at first that of the body |
//! | a joint's name | its angle in the pose, rad |
//!
//! A joint that a pose does not name keeps the angle of the pose before. The poses may be in an
//! element `poses`, as XML requires of a file with several. In TOML they are tables `[[pose]]`.
//!
//! ```
//! use std::time::Duration;
//! use monas_config::poses::{self, JointPose};
//! use monas_robot::{Anatomy, Joint, Limits};
//!
//! let joint = |name: &str| Joint { name: name.into(), limits: Limits::symmetric(1.5), speed: None };
//! let joints = vec![joint("HeadYaw"), joint("HeadPitch")];
//! let head = Anatomy { joints, ..Anatomy::new("head", Duration::from_millis(10)) };
//! let listing = "<?xml version=\"1.0\" ?>\n<pose HeadYaw=0.876 HeadPitch=1.324 />\n<pose HeadYaw=0.227 HeadPitch=0.912 />\n";
//! let (found, diagnostics) = poses::read(&yase::Source::new("nod.xml", listing), &head);
//! let pose = |yaw, pitch| JointPose { seconds: 1.0, stiffness: None, angles: vec![(0, yaw), (1, pitch)] };
//! assert_eq!((found, diagnostics), (Some(vec![pose(0.876, 1.324), pose(0.227, 0.912)]), vec![]));
//! ```

use std::path::Path;
use std::sync::Arc;

use monas_robot::{Anatomy, Joint};
use yase::{Diagnostic, Source, Span};

use crate::{AttributeRule, Element, ElementRule, Grammar, Kind, Values, paths};

/// The longest way to a pose, s.
const MAX_DURATION: f64 = 60.0;

/// A pose of a sequence.
#[derive(Clone, PartialEq, Debug)]
pub struct JointPose {
    /// The duration of the motion to it, s.
    pub seconds: f64,
    /// The stiffness of all joints on the way, 0 to 1, if it is given.
    pub stiffness: Option<f64>,
    /// The joints that are given, as indices in the anatomy, with their angles, rad.
    pub angles: Vec<(usize, f64)>,
}

/// The grammar of a sequence of poses of a body.
pub fn grammar(anatomy: &Anatomy) -> Grammar {
    let seconds = Kind::number_in(anatomy.cycle.as_secs_f64(), MAX_DURATION);
    let pose = ElementRule::new("pose", "a pose of the joints")
        .attribute(AttributeRule::new("duration", seconds, "the time of the way to the pose, s").or("1"))
        .attribute(AttributeRule::new(
            "stiffness",
            Kind::number_in(0.0, 1.0),
            "that of all joints on the way",
        ))
        .attributes(anatomy.joints.iter().map(|joint| {
            let angle = Kind::number_in(joint.limits.low, joint.limits.high);
            AttributeRule::new(joint.name.clone(), angle, "the angle of the joint, rad")
        }));
    Grammar::default().root(pose).root(ElementRule::new("poses", "a sequence").group().children("pose"))
}

/// Reads a file, in XML or TOML, with its diagnostics. There are no poses if one of these is an
/// error.
pub fn load(path: &Path, anatomy: &Anatomy) -> (Option<Vec<JointPose>>, Vec<Diagnostic>) {
    match paths::read(path) {
        Ok(source) => read(&source, anatomy),
        Err(diagnostic) => (None, vec![*diagnostic]),
    }
}

/// As [`load`], from a text in memory.
pub fn read(source: &Arc<Source>, anatomy: &Anatomy) -> (Option<Vec<JointPose>>, Vec<Diagnostic>) {
    let grammar = grammar(anatomy);
    let (roots, found) = grammar.read(source);
    let elements: Vec<&Element> = roots
        .iter()
        .flat_map(|root| if root.is("poses") { root.children() } else { std::slice::from_ref(root) })
        .collect();
    let explained = |diagnostic| with_meaning(diagnostic, &elements, &grammar);
    let mut diagnostics: Vec<Diagnostic> = found.into_iter().map(explained).collect();
    if elements.is_empty() && diagnostics.is_empty() {
        let missing = Diagnostic::error("E0305", Span::default(), "expected `pose`, the file holds none");
        diagnostics.push(missing.with_hint("a sequence has at least one pose").in_source(source));
    }
    if diagnostics.iter().any(Diagnostic::is_error) {
        return (None, diagnostics);
    }
    let poses: Vec<JointPose> = elements.iter().map(|element| pose(element, &grammar, anatomy)).collect();
    diagnostics.extend(too_fast(&elements, &poses, &grammar, anatomy));
    (Some(poses), diagnostics)
}

/// A finding about a value says what the attribute means, with its unit: other tools write degrees
/// and milliseconds.
fn with_meaning(diagnostic: Diagnostic, poses: &[&Element], grammar: &Grammar) -> Diagnostic {
    if diagnostic.code != "E0306" || diagnostic.hint.is_some() {
        return diagnostic;
    }
    let mut attributes = poses.iter().flat_map(|pose| pose.attributes());
    let given = attributes.find(|given| given.value_span == diagnostic.span);
    let rule = given.and_then(|given| grammar.element("pose")?.attribute_named(&given.name));
    match rule {
        Some(rule) => diagnostic.with_hint(rule.doc),
        None => diagnostic,
    }
}

fn pose(element: &Element, grammar: &Grammar, anatomy: &Anatomy) -> JointPose {
    let values = Values::of(element, grammar);
    let joints = anatomy.joints.iter().enumerate();
    JointPose {
        seconds: values.number("duration").unwrap_or_default(),
        stiffness: values.number("stiffness"),
        angles: joints.filter_map(|(index, joint)| Some((index, values.number(&joint.name)?))).collect(),
    }
}

/// Warns of joints that have to turn faster than they can. The position of a joint before the
/// first pose that names it is not known.
fn too_fast(
    elements: &[&Element],
    poses: &[JointPose],
    grammar: &Grammar,
    anatomy: &Anatomy,
) -> Vec<Diagnostic> {
    let mut angles = vec![None; anatomy.joints.len()];
    let mut diagnostics = Vec::new();
    for (element, pose) in elements.iter().zip(poses) {
        for &(joint, angle) in &pose.angles {
            let Some(before) = angles[joint].replace(angle) else { continue };
            let Joint { name, speed: Some(speed), .. } = &anatomy.joints[joint] else { continue };
            let change = f64::abs(angle - before);
            if change <= speed * pose.seconds {
                continue;
            }
            let message = format!(
                "`{name}` turns by {change:.2} rad in {} s, its motor by {speed:.2} rad/s at most",
                pose.seconds
            );
            let hint = format!("it lags behind: it needs {:.2} s", change / speed);
            let span =
                Values::of(element, grammar).given(name).map_or(element.span(), |given| given.value_span);
            let diagnostic = Diagnostic::warning("E0371", span, message).with_hint(hint);
            diagnostics.push(diagnostic.in_source(element.source()));
        }
    }
    diagnostics
}
