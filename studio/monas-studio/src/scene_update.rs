//! Converts a view from above to a three-dimensional scene in Foxglove's schema.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use prost_types::Timestamp;

use crate::scene::{Belief, Body, Ground, GroundMark, SceneObject, ScenePicture};

/// Messages by Foxglove's schema of scenes.
#[allow(missing_docs, unreachable_pub)]
pub(crate) mod messages {
    narukom::include_messages!("foxglove");
}

use messages::{
    ArrowPrimitive, Color, CylinderPrimitive, LinePrimitive, Point3, Pose, Quaternion, SceneEntity,
    SceneEntityDeletion, SceneUpdate, SpherePrimitive, TextPrimitive, Vector3, line_primitive,
    scene_entity_deletion,
};

/// The frame of the plane.
const FRAME_ID: &str = "world";

/// The shape of a body: it stands for any robot. Metres.
const BODY_RADIUS: f64 = 0.15;
const BODY_HEIGHT: f64 = 0.5;
const TEXT_SIZE: f64 = 0.25;

/// The thickness of lines on the ground, m, and how many parts a circle has.
const LINE_WIDTH: f64 = 0.05;
const CIRCLE_PARTS: u32 = 48;

/// Colours of the two groups as on the page, and others.
const GROUP_COLOURS: [Color; 2] = [colour(0.0, 0.447, 0.698), colour(0.835, 0.369, 0.0)];
const WHITE: Color = colour(1.0, 1.0, 1.0);
const OBJECT_COLOUR: Color = colour(0.902, 0.624, 0.0);

const fn colour(r: f64, g: f64, b: f64) -> Color {
    Color { r, g, b, a: 1.0 }
}

/// The scene as a client has it.
#[derive(Clone, Default, Debug)]
pub(crate) struct SceneHistory {
    entities: BTreeSet<String>,
    ground: Option<Ground>,
}

impl SceneHistory {
    /// The changes from the client's scene to a picture, at a time in nanoseconds.
    pub(crate) fn update(&mut self, picture: &ScenePicture, time: u64) -> SceneUpdate {
        let mut entities: Vec<SceneEntity> = Vec::new();
        entities.extend(picture.bodies.iter().map(body));
        entities.extend(picture.objects.iter().enumerate().map(|(index, object)| thing(index, object)));
        entities.extend(picture.beliefs.iter().map(|one| belief(one, &picture.bodies)));
        entities.extend(seen_lines(picture));
        let present: BTreeSet<String> = entities.iter().map(|entity| entity.id.clone()).collect();
        let timestamp = Some(timestamp(time));
        let deletion = |id: &String| SceneEntityDeletion {
            timestamp,
            r#type: scene_entity_deletion::Type::MatchingId.into(),
            id: id.clone(),
        };
        let deletions = self.entities.difference(&present).map(deletion).collect();
        self.entities = present;
        if self.ground.as_ref() != Some(&picture.ground) {
            self.ground = Some(picture.ground.clone());
            entities.push(ground(&picture.ground));
        }
        for entity in &mut entities {
            (entity.timestamp, entity.frame_id) = (timestamp, FRAME_ID.to_owned());
        }
        SceneUpdate { deletions, entities }
    }
}

pub(crate) fn timestamp(time: u64) -> Timestamp {
    Timestamp { seconds: (time / 1_000_000_000) as i64, nanos: (time % 1_000_000_000) as i32 }
}

fn entity(id: String) -> SceneEntity {
    SceneEntity { id, ..SceneEntity::default() }
}

fn vector(x: f64, y: f64, z: f64) -> Option<Vector3> {
    Some(Vector3 { x, y, z })
}

/// A pose that is turned about the vertical axis.
fn pose(x: f64, y: f64, z: f64, heading: f64) -> Option<Pose> {
    let orientation = Quaternion { x: 0.0, y: 0.0, z: libm::sin(heading / 2.0), w: libm::cos(heading / 2.0) };
    Some(Pose { position: vector(x, y, z), orientation: Some(orientation) })
}

fn group_colour(group: usize, opacity: f64) -> Option<Color> {
    GROUP_COLOURS.get(group).or(GROUP_COLOURS.first()).map(|colour| Color { a: opacity, ..*colour })
}

fn body(body: &Body) -> SceneEntity {
    let color = group_colour(body.group, if body.active { 1.0 } else { 0.35 });
    // A fallen one is flat.
    let height = if body.upright { BODY_HEIGHT } else { BODY_RADIUS };
    let id = format!("body {} {}", body.group, body.label);
    let trunk = CylinderPrimitive {
        pose: pose(body.x, body.y, height / 2.0, body.heading),
        size: vector(2.0 * BODY_RADIUS, 2.0 * BODY_RADIUS, height),
        bottom_scale: 1.0,
        top_scale: 1.0,
        color,
    };
    let nose = ArrowPrimitive {
        pose: pose(body.x, body.y, height, body.heading),
        shaft_length: BODY_RADIUS,
        shaft_diameter: 0.04,
        head_length: 0.1,
        head_diameter: 0.1,
        color,
    };
    let text = TextPrimitive {
        pose: pose(body.x, body.y, height + TEXT_SIZE, 0.0),
        billboard: true,
        font_size: TEXT_SIZE,
        scale_invariant: false,
        color: Some(WHITE),
        text: body.label.clone(),
    };
    SceneEntity { arrows: vec![nose], cylinders: vec![trunk], texts: vec![text], ..entity(id) }
}

fn thing(index: usize, object: &SceneObject) -> SceneEntity {
    let size = 2.0 * object.radius;
    let sphere = SpherePrimitive {
        pose: pose(object.x, object.y, object.radius, 0.0),
        size: vector(size, size, size),
        color: Some(OBJECT_COLOUR),
    };
    SceneEntity { spheres: vec![sphere], ..entity(format!("{} {index}", object.kind)) }
}

/// A ring on the ground, with a line in the direction of a heading.
fn belief(belief: &Belief, bodies: &[Body]) -> SceneEntity {
    let group = bodies.iter().find(|body| body.host == belief.host).map_or(0, |body| body.group);
    let color = group_colour(group, 0.35 + 0.65 * belief.confidence.clamp(0.0, 1.0));
    let radius = if belief.heading.is_some() { BODY_RADIUS } else { 0.08 };
    let mut lines =
        vec![LinePrimitive { color, thickness: LINE_WIDTH / 2.0, ..circle(belief.x, belief.y, radius) }];
    if let Some(heading) = belief.heading {
        let points = vec![point(0.0, 0.0), point(2.0 * radius, 0.0)];
        lines.push(LinePrimitive {
            r#type: line_primitive::Type::LineStrip.into(),
            pose: pose(belief.x, belief.y, 0.01, heading),
            thickness: LINE_WIDTH / 2.0,
            points,
            color,
            ..LinePrimitive::default()
        });
    }
    SceneEntity { lines, ..entity(format!("belief {} {}", belief.host, belief.kind)) }
}

/// The lines that each host sees, one entity for a host.
fn seen_lines(picture: &ScenePicture) -> impl Iterator<Item = SceneEntity> {
    let mut hosts: BTreeMap<&str, Vec<Point3>> = BTreeMap::new();
    for line in &picture.seen_lines {
        let [x1, y1, x2, y2] = line.ends;
        hosts.entry(&line.host).or_default().extend([point(x1, y1), point(x2, y2)]);
    }
    hosts.into_iter().map(|(host, points)| {
        let group = picture.bodies.iter().find(|body| body.host == host).map_or(0, |body| body.group);
        let lines = vec![LinePrimitive {
            r#type: line_primitive::Type::LineList.into(),
            pose: pose(0.0, 0.0, 0.01, 0.0),
            thickness: LINE_WIDTH / 2.0,
            points,
            color: group_colour(group, 1.0),
            ..LinePrimitive::default()
        }];
        SceneEntity { lines, ..entity(format!("lines {host}")) }
    })
}

fn point(x: f64, y: f64) -> Point3 {
    Point3 { x, y, z: 0.0 }
}

fn circle(x: f64, y: f64, radius: f64) -> LinePrimitive {
    let part = |part: u32| {
        let angle = 2.0 * PI * f64::from(part) / f64::from(CIRCLE_PARTS);
        point(radius * libm::cos(angle), radius * libm::sin(angle))
    };
    LinePrimitive {
        r#type: line_primitive::Type::LineLoop.into(),
        pose: pose(x, y, 0.01, 0.0),
        thickness: LINE_WIDTH,
        points: (0..CIRCLE_PARTS).map(part).collect(),
        color: Some(WHITE),
        ..LinePrimitive::default()
    }
}

fn ground(ground: &Ground) -> SceneEntity {
    let line = |mark: &GroundMark| match *mark {
        GroundMark::Rectangle { x, y, width, height, group } => LinePrimitive {
            r#type: line_primitive::Type::LineLoop.into(),
            pose: pose(x, y, 0.0, 0.0),
            thickness: LINE_WIDTH,
            points: vec![point(0.0, 0.0), point(width, 0.0), point(width, height), point(0.0, height)],
            color: group.map_or(Some(WHITE), |group| group_colour(group, 1.0)),
            ..LinePrimitive::default()
        },
        GroundMark::Line { ends: [x0, y0, x1, y1] } => LinePrimitive {
            r#type: line_primitive::Type::LineStrip.into(),
            pose: pose(0.0, 0.0, 0.0, 0.0),
            thickness: LINE_WIDTH,
            points: vec![point(x0, y0), point(x1, y1)],
            color: Some(WHITE),
            ..LinePrimitive::default()
        },
        GroundMark::Circle { x, y, radius } => circle(x, y, radius),
    };
    SceneEntity { lines: ground.marks.iter().map(line).collect(), ..entity("ground".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SeenLine;

    #[test]
    fn entities_are_replaced_and_those_that_vanish_are_deleted() {
        let robot = |label: &str, x: f64| Body { label: label.into(), x, upright: true, ..Body::default() };
        let ball = SceneObject { kind: "ball".into(), radius: 0.05, ..SceneObject::default() };
        let mark = GroundMark::Circle { x: 0.0, y: 0.0, radius: 0.6 };
        let ground = Ground { width: 6.0, height: 4.0, marks: vec![mark] };
        let picture = ScenePicture {
            ground,
            bodies: vec![robot("1", 1.0), robot("2", 2.0)],
            objects: vec![ball],
            seen_lines: [1.0, 2.0].map(|x| SeenLine { host: "a".into(), ends: [x, 0.0, x, 1.0] }).into(),
            ..ScenePicture::default()
        };
        let mut history = SceneHistory::default();
        let ids = |update: &SceneUpdate| update.entities.iter().map(|one| one.id.clone()).collect::<Vec<_>>();
        let first = history.update(&picture, 2_500_000_000);
        assert_eq!(ids(&first), ["body 0 1", "body 0 2", "ball 0", "lines a", "ground"]);
        let ends = [(1.0, 0.0), (1.0, 1.0), (2.0, 0.0), (2.0, 1.0)].map(|(x, y)| point(x, y));
        assert_eq!(first.entities[3].lines[0].points, ends);
        assert_eq!(first.entities[0].timestamp, Some(Timestamp { seconds: 2, nanos: 500_000_000 }));
        let position = |entity: &SceneEntity| entity.cylinders[0].pose.and_then(|pose| pose.position);
        assert_eq!(position(&first.entities[1]), vector(2.0, 0.0, BODY_HEIGHT / 2.0));
        let moved = ScenePicture { bodies: vec![robot("1", 1.5)], seen_lines: Vec::new(), ..picture };
        let second = history.update(&moved, 3_000_000_000);
        assert_eq!(ids(&second), ["body 0 1", "ball 0"], "the ground is known");
        assert_eq!(
            second.deletions.iter().map(|one| one.id.as_str()).collect::<Vec<_>>(),
            ["body 0 2", "lines a"]
        );
    }
}
