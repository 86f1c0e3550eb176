//! The interface for programs that draw on the plane: the field of a match, the rooms of a robot.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::Value;

use crate::cameras::Cameras;

/// A view from above, provided by the program: the studio does not depend on a sport.
///
/// The plane has x to the right and y up, in metres; headings are in radians.
pub trait Scene: Send + Sync {
    /// The topics that it reads, on all hosts.
    fn topics(&self) -> &[&'static str];

    /// The topics with events that are marked on the timeline of a tape.
    fn event_topics(&self) -> &[&'static str] {
        &[]
    }

    /// The event that a message on such a topic represents, if any, from its protobuf encoding.
    fn event(&self, host: &str, topic: &str, bytes: &[u8]) -> Option<SceneEvent> {
        let _ = (host, topic, bytes);
        None
    }

    /// The images of the robots' cameras, if the program has such robots.
    fn cameras(&self) -> Option<&dyn Cameras> {
        None
    }

    /// Draws the present messages.
    fn draw(&self, messages: &SceneMessages<'_>) -> ScenePicture;
}

/// An event on a timeline.
#[derive(Clone, PartialEq, Eq, Default, Debug, Serialize)]
pub struct SceneEvent {
    /// Its kind, in one word: one steps through the events of a kind together.
    pub kind: String,
    /// The text.
    pub text: String,
    /// Whether it lasts: consecutive equal events of one publisher are one event.
    #[serde(skip)]
    pub lasts: bool,
}

/// The newest message of each topic that a scene reads, as JSON with the fields' names.
#[derive(Debug)]
pub struct SceneMessages<'a> {
    latest: BTreeMap<(&'a str, &'a str), &'a Value>,
}

/// From messages by host and topic, for tests of scenes.
impl<'a> FromIterator<((&'a str, &'a str), &'a Value)> for SceneMessages<'a> {
    fn from_iter<Items: IntoIterator<Item = ((&'a str, &'a str), &'a Value)>>(messages: Items) -> Self {
        SceneMessages { latest: messages.into_iter().collect() }
    }
}

impl<'a> SceneMessages<'a> {
    /// The newest message of a topic from a host.
    pub fn of(&self, host: &str, topic: &str) -> Option<&'a Value> {
        self.latest.get(&(host, topic)).copied()
    }

    /// The newest messages of a topic, with their hosts.
    pub fn all<'t>(&'t self, topic: &'t str) -> impl Iterator<Item = (&'a str, &'a Value)> + 't {
        let of_topic = self.latest.iter().filter(move |((_, known), _)| *known == topic);
        of_topic.map(|((host, _), value)| (*host, *value))
    }
}

/// The contents of the plane at one time.
#[derive(Clone, PartialEq, Default, Debug, Serialize)]
pub struct ScenePicture {
    /// Static contents.
    pub ground: Ground,
    /// Robots at their true positions.
    pub bodies: Vec<Body>,
    /// Other objects at their true positions.
    pub objects: Vec<SceneObject>,
    /// Positions as hosts believe them.
    pub beliefs: Vec<Belief>,
    /// Lines on the ground as hosts see them.
    pub seen_lines: Vec<SeenLine>,
    /// The text above the plane.
    pub banner: Option<Banner>,
    /// Actions of viewers that may change the run.
    pub actions: Vec<SceneAction>,
}

/// A message that a viewer publishes at the press of a button.
#[derive(Clone, PartialEq, Default, Debug, Serialize)]
pub struct SceneAction {
    /// The text of the button.
    pub label: String,
    /// The host whose body the action is about; none for one about all.
    pub about: Option<String>,
    /// The host on which the message is published.
    pub host: String,
    /// Its topic.
    pub topic: String,
    /// The message as JSON.
    pub message: Value,
}

/// The plane.
#[derive(Clone, PartialEq, Default, Debug, Serialize)]
pub struct Ground {
    /// Its size in metres; the origin is in the middle.
    pub width: f64,
    /// See `width`.
    pub height: f64,
    /// Lines and areas on it.
    pub marks: Vec<GroundMark>,
}

/// A line or an area on the plane, in metres.
#[derive(Clone, PartialEq, Debug, Serialize)]
#[serde(tag = "shape", rename_all = "lowercase")]
pub enum GroundMark {
    /// A rectangle by its lowest corner.
    Rectangle {
        /// The corner.
        x: f64,
        /// The corner.
        y: f64,
        /// The size.
        width: f64,
        /// The size.
        height: f64,
        /// The group whose colour it has; none for a line.
        group: Option<usize>,
    },
    /// A line.
    Line {
        /// Begin and end: x, y, x, y.
        ends: [f64; 4],
    },
    /// A circle.
    Circle {
        /// The middle.
        x: f64,
        /// The middle.
        y: f64,
        /// The radius.
        radius: f64,
    },
}

/// A robot.
#[derive(Clone, PartialEq, Default, Debug, Serialize)]
pub struct Body {
    /// Its host; empty if it is not known.
    pub host: String,
    /// A short text on it, such as its number.
    pub label: String,
    /// The group whose colour it has: 0 or 1.
    pub group: usize,
    /// Its position, m.
    pub x: f64,
    /// Its position, m.
    pub y: f64,
    /// Its heading, rad.
    pub heading: f64,
    /// Whether it stands; a fallen one is drawn as such.
    pub upright: bool,
    /// Whether it takes part; others are drawn faint.
    pub active: bool,
}

/// A ball or another thing.
#[derive(Clone, PartialEq, Default, Debug, Serialize)]
pub struct SceneObject {
    /// Its kind: `ball`.
    pub kind: String,
    /// Its position, m.
    pub x: f64,
    /// Its position, m.
    pub y: f64,
    /// Its velocity, m/s.
    pub vx: f64,
    /// Its velocity, m/s.
    pub vy: f64,
    /// Its radius, m.
    pub radius: f64,
}

/// The believed position of a host or of an object.
#[derive(Clone, PartialEq, Default, Debug, Serialize)]
pub struct Belief {
    /// The host.
    pub host: String,
    /// The subject: `self` or the kind of an object.
    pub kind: String,
    /// Its position, m.
    pub x: f64,
    /// Its position, m.
    pub y: f64,
    /// Its heading, rad, if it has one.
    pub heading: Option<f64>,
    /// The confidence of the host, from 0 to 1.
    pub confidence: f64,
}

/// A straight part of a line on the ground, where a host sees it.
#[derive(Clone, PartialEq, Default, Debug, Serialize)]
pub struct SeenLine {
    /// The host.
    pub host: String,
    /// Begin and end: x, y, x, y, m.
    pub ends: [f64; 4],
}

/// A score or another summary.
#[derive(Clone, PartialEq, Default, Debug, Serialize)]
pub struct Banner {
    /// The name and the score of each group.
    pub groups: Vec<(String, String)>,
    /// The rest, such as half and phase.
    pub text: String,
}
