//! The field of a match from above.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use monas_robot::{Posture, Sensors};
use monas_sim::messages::Incident;
use monas_studio::{
    Banner, Belief, Body, Cameras, Ground, GroundMark, Scene, SceneAction, SceneEvent, SceneMessages,
    SceneObject, ScenePicture, SeenLine,
};
use prost::Message;
use serde_json::{Value, json};

use crate::robot_cameras::RobotCameras;

const TRUTH: &str = "sim/truth";
const SCORE: &str = "sim/score";
const REFEREE: &str = "sim/referee";
const INCIDENT: &str = "sim/incident";
const SENSORS: &str = "body/sensors";
const HOST: &str = "monas/host";
const GAME_STATE: &str = "soccer/game_state";
const POSE: &str = "soccer/pose";
const BALL: &str = "soccer/ball";
const FIELD_LINES: &str = "soccer/field_lines";

/// Carpet around the lines, and measures that messages do not have: those of the SPL of 2010.
const CARPET_BORDER: f64 = 0.7;
const CIRCLE_RADIUS: f64 = 0.6;
const BALL_RADIUS: f64 = 0.05;
const GOAL_DEPTH: f64 = 0.4;

/// Draws the ground truth of the simulated field if there is one, what each robot believes, and the
/// score.
#[derive(Clone, Copy, Debug, Default)]
pub struct SoccerField;

impl Scene for SoccerField {
    fn topics(&self) -> &[&'static str] {
        &[TRUTH, SCORE, HOST, GAME_STATE, POSE, BALL, FIELD_LINES]
    }

    fn event_topics(&self) -> &[&'static str] {
        &[INCIDENT, SENSORS]
    }

    fn event(&self, host: &str, topic: &str, bytes: &[u8]) -> Option<SceneEvent> {
        if topic == SENSORS {
            let has_fallen = Sensors::decode(bytes).ok()?.posture() == Posture::Fallen;
            let (kind, text) = ("fall".to_owned(), format!("{host} has fallen"));
            return has_fallen.then_some(SceneEvent { kind, text, lasts: true });
        }
        let text = Incident::decode(bytes).ok()?.text;
        let kind = text.split([' ', ':']).next().unwrap_or_default().to_owned();
        Some(SceneEvent { kind, text, lasts: false })
    }

    fn cameras(&self) -> Option<&dyn Cameras> {
        Some(&RobotCameras)
    }

    fn draw(&self, messages: &SceneMessages<'_>) -> ScenePicture {
        let truth = messages.all(TRUTH).next().map(|(_, truth)| truth);
        ScenePicture {
            ground: ground(messages),
            bodies: truth.map(|truth| bodies(truth, messages)).unwrap_or_default(),
            objects: truth.and_then(ball).into_iter().collect(),
            beliefs: messages.all(POSE).flat_map(|(host, pose)| beliefs(host, pose, messages)).collect(),
            seen_lines: messages
                .all(FIELD_LINES)
                .flat_map(|(host, seen)| seen_lines(host, seen, messages))
                .collect(),
            banner: messages.all(SCORE).next().map(|(_, score)| banner(score, messages)),
            actions: messages
                .all(SCORE)
                .next()
                .map(|(host, score)| calls(host, score, messages))
                .unwrap_or_default(),
        }
    }
}

fn number(message: &Value, field: &str) -> Option<f64> {
    message[field].as_f64().filter(|number| number.is_finite())
}

/// The field with the measures of the first robot that knows them.
fn ground(messages: &SceneMessages<'_>) -> Ground {
    let known = messages.all(GAME_STATE).map(|(_, game)| game);
    let mut known = known.filter(|game| number(game, "field_length").is_some_and(|length| length > 0.0));
    let game = known.next().unwrap_or(&Value::Null);
    let measure = |field, default| number(game, field).filter(|size| *size > 0.0).unwrap_or(default);
    let (length, width) = (measure("field_length", 6.0), measure("field_width", 4.0));
    let goal = measure("goal_width", 1.4);
    let (depth, area) = (measure("area_depth", 0.6), measure("area_width", 2.2));
    let rectangle = |x, y, width, height, group| GroundMark::Rectangle { x, y, width, height, group };
    let (half_length, half_width) = (length / 2.0, width / 2.0);
    let marks = vec![
        rectangle(-half_length - GOAL_DEPTH, -goal / 2.0, GOAL_DEPTH, goal, Some(0)),
        rectangle(half_length, -goal / 2.0, GOAL_DEPTH, goal, Some(1)),
        rectangle(-half_length, -half_width, length, width, None),
        rectangle(-half_length, -area / 2.0, depth, area, None),
        rectangle(half_length - depth, -area / 2.0, depth, area, None),
        GroundMark::Line { ends: [0.0, -half_width, 0.0, half_width] },
        GroundMark::Circle { x: 0.0, y: 0.0, radius: CIRCLE_RADIUS },
    ];
    Ground { width: length + 2.0 * CARPET_BORDER, height: width + 2.0 * CARPET_BORDER, marks }
}

fn bodies(truth: &Value, messages: &SceneMessages<'_>) -> Vec<Body> {
    let hosts: BTreeMap<(u64, u64), &str> = messages
        .all(HOST)
        .filter_map(|(host, message)| Some(((message["team"].as_u64()?, message["number"].as_u64()?), host)))
        .collect();
    let mut teams: Vec<u64> = robots(truth).filter_map(|robot| robot["team"].as_u64()).collect();
    teams.sort_unstable();
    teams.dedup();
    let body = |robot: &Value| {
        let (team, player) = (robot["team"].as_u64()?, robot["number"].as_u64()?);
        Some(Body {
            host: hosts.get(&(team, player)).copied().unwrap_or_default().to_owned(),
            label: player.to_string(),
            group: teams.iter().position(|known| *known == team)?,
            x: number(robot, "x")?,
            y: number(robot, "y")?,
            heading: number(robot, "heading")?,
            upright: robot["upright"].as_bool()?,
            active: robot["on_field"].as_bool()?,
        })
    };
    robots(truth).filter_map(body).collect()
}

fn robots(truth: &Value) -> impl Iterator<Item = &Value> {
    truth["robots"].as_array().into_iter().flatten()
}

fn ball(truth: &Value) -> Option<SceneObject> {
    let [x, y, vx, vy] = ["ball_x", "ball_y", "ball_vx", "ball_vy"].map(|field| number(truth, field));
    Some(SceneObject { kind: "ball".into(), x: x?, y: y?, vx: vx?, vy: vy?, radius: BALL_RADIUS })
}

/// Whether a robot attacks the goal on the left. Its frame is the field's if it attacks the yellow
/// goal, on the right, and turned by half a turn otherwise.
fn attacks_left(host: &str, messages: &SceneMessages<'_>) -> bool {
    messages.of(host, GAME_STATE).is_some_and(|game| game["goal_to_attack"] == "BLUE")
}

/// The lines that a robot sees, on the field, from its believed pose. It publishes the pose with
/// the lines, at most one cycle after their images.
fn seen_lines(host: &str, seen: &Value, messages: &SceneMessages<'_>) -> Vec<SeenLine> {
    let pose = messages.of(host, POSE).unwrap_or(&Value::Null);
    let [Some(x), Some(y), Some(heading)] = ["x", "y", "heading"].map(|field| number(pose, field)) else {
        return Vec::new();
    };
    let sign = if attacks_left(host, messages) { -1.0 } else { 1.0 };
    let (sine, cosine) = (libm::sin(heading), libm::cos(heading));
    let position = |ahead: f64, left: f64| {
        [sign * (x + cosine * ahead - sine * left), sign * (y + sine * ahead + cosine * left)]
    };
    let line = |line: &Value| {
        let [x1, y1, x2, y2] = ["x1", "y1", "x2", "y2"].map(|field| number(line, field));
        let ([x1, y1], [x2, y2]) = (position(x1?, y1?), position(x2?, y2?));
        Some(SeenLine { host: host.to_owned(), ends: [x1, y1, x2, y2] })
    };
    seen["lines"].as_array().into_iter().flatten().filter_map(line).collect()
}

/// The believed positions of a robot and of the ball.
fn beliefs(host: &str, pose: &Value, messages: &SceneMessages<'_>) -> Vec<Belief> {
    let fields = ["x", "y", "heading", "confidence"].map(|field| number(pose, field));
    let [Some(x), Some(y), Some(heading), Some(confidence)] = fields else { return Vec::new() };
    let attacks_left = attacks_left(host, messages);
    let sign = if attacks_left { -1.0 } else { 1.0 };
    let belief = |kind: &str, x: f64, y: f64, heading: Option<f64>| Belief {
        host: host.to_owned(),
        kind: kind.to_owned(),
        x: sign * x,
        y: sign * y,
        heading: heading.map(|heading| if attacks_left { heading + PI } else { heading }),
        confidence,
    };
    let mut beliefs = vec![belief("self", x, y, Some(heading))];
    let ball = messages.of(host, BALL).filter(|ball| ball["found"] == true);
    if let Some((ahead, left)) = ball.and_then(|ball| Some((number(ball, "x")?, number(ball, "y")?))) {
        let (sine, cosine) = (libm::sin(heading), libm::cos(heading));
        let (dx, dy) = (cosine * ahead - sine * left, sine * ahead + cosine * left);
        beliefs.push(belief("ball", x + dx, y + dy, None));
    }
    beliefs
}

fn banner(score: &Value, messages: &SceneMessages<'_>) -> Banner {
    let teams = score["teams"].as_array().into_iter().flatten();
    let group = |team: &Value| {
        (
            team["name"].as_str().unwrap_or_default().to_owned(),
            team["goals"].as_u64().unwrap_or(0).to_string(),
        )
    };
    let half = if score["half"] == 2 { "second half" } else { "first half" };
    let state = score["state"].as_str().unwrap_or_default().to_lowercase();
    let left = messages.all(GAME_STATE).find_map(|(_, game)| number(game, "secs_remaining"));
    let left = left.map(|left| format!(" · {}:{:02} left", left as u64 / 60, left as u64 % 60));
    let text = format!("{half} · {state}{}", left.unwrap_or_default());
    Banner { groups: teams.map(group).collect(), text }
}

/// The decisions of the referee that a person can make, on the host that has the field.
fn calls(host: &str, score: &Value, messages: &SceneMessages<'_>) -> Vec<SceneAction> {
    let call = |label: &str, about: Option<&str>, message: Value| SceneAction {
        label: label.to_owned(),
        about: about.map(str::to_owned),
        host: host.to_owned(),
        topic: REFEREE.to_owned(),
        message,
    };
    let state = score["state"].as_str().unwrap_or_default();
    let all: &[(&str, &str)] = match state {
        "INITIAL" => &[("Ready", "READY")],
        "READY" => &[("Set", "SET"), ("End half", "END_HALF")],
        "SET" => &[("Play", "PLAY"), ("End half", "END_HALF")],
        "PLAYING" => &[("Kick-off", "READY"), ("Drop ball", "DROP_BALL"), ("End half", "END_HALF")],
        _ => return Vec::new(),
    };
    let stop = if score["stopped"] == true { ("Resume", "RESUME") } else { ("Stop", "STOP") };
    let mut actions: Vec<SceneAction> =
        [stop].iter().chain(all).map(|(label, kind)| call(label, None, json!({"kind": kind}))).collect();
    for (robot_host, robot) in messages.all(HOST) {
        let (Some(team), Some(number)) = (robot["team"].as_u64(), robot["number"].as_u64()) else { continue };
        let truth = messages.all(TRUTH).next().map(|(_, truth)| truth);
        let is_it =
            |robot: &&Value| robot["team"].as_u64() == Some(team) && robot["number"].as_u64() == Some(number);
        let Some(body) = truth.and_then(|truth| robots(truth).find(is_it)) else { continue };
        let (label, kind) =
            if body["on_field"] == true { ("Penalize", "PENALIZE") } else { ("Return", "RETURN") };
        let label = format!("{label} {robot_host}");
        actions.push(call(&label, Some(robot_host), json!({"kind": kind, "team": team, "number": number})));
    }
    actions
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draw(messages: &[(&str, &str, Value)]) -> ScenePicture {
        let messages = messages.iter().map(|(host, topic, message)| ((*host, *topic), message));
        SoccerField.draw(&messages.collect())
    }

    #[test]
    fn beliefs_of_a_robot_that_attacks_the_left_goal_are_turned() {
        let pose = json!({"x": 1.0, "y": 0.5, "heading": 0.0, "confidence": 0.5});
        let ball = json!({"found": true, "x": 1.0, "y": 0.25});
        let at = |goal: &str, found: bool| {
            let ball = if found { ball.clone() } else { json!({"found": false, "x": 9.0, "y": 9.0}) };
            let game = json!({"goal_to_attack": goal});
            let beliefs =
                draw(&[("b", POSE, pose.clone()), ("b", GAME_STATE, game), ("b", BALL, ball)]).beliefs;
            beliefs.iter().map(|one| (one.kind.clone(), one.x, one.y, one.heading)).collect::<Vec<_>>()
        };
        let own = |x: f64, y: f64, heading: f64| ("self".to_owned(), x, y, Some(heading));
        let ball_at = |x: f64, y: f64| ("ball".to_owned(), x, y, None);
        assert_eq!(at("YELLOW", true), [own(1.0, 0.5, 0.0), ball_at(2.0, 0.75)]);
        assert_eq!(at("BLUE", true), [own(-1.0, -0.5, PI), ball_at(-2.0, -0.75)]);
        assert_eq!(at("BLUE", false), [own(-1.0, -0.5, PI)]);
    }

    #[test]
    fn lines_are_where_a_robot_that_believes_its_pose_sees_them() {
        let pose = json!({"x": 1.0, "y": 0.5, "heading": 0.5 * PI, "confidence": 0.5});
        let seen =
            json!({"taken_at": 1, "lines": [{"x1": 1.0, "y1": 0.25, "x2": 2.0, "y2": 0.0}, {"x1": 1.0}]});
        let at = |goal: &str| {
            let game = json!({"goal_to_attack": goal});
            let messages =
                [("b", POSE, pose.clone()), ("b", GAME_STATE, game), ("b", FIELD_LINES, seen.clone())];
            let lines = draw(&messages).seen_lines;
            assert!(lines.iter().all(|line| line.host == "b"));
            lines.iter().map(|line| line.ends.map(|end| (end * 1e6).round() / 1e6)).collect::<Vec<_>>()
        };
        assert_eq!(at("YELLOW"), [[0.75, 1.5, 1.0, 2.5]]);
        assert_eq!(at("BLUE"), [[-0.75, -1.5, -1.0, -2.5]]);
        assert!(draw(&[("b", FIELD_LINES, seen.clone())]).seen_lines.is_empty(), "the pose is not known");
    }

    #[test]
    fn robots_are_drawn_with_their_hosts_and_the_field_has_the_known_measures() {
        let robot = |team: u32, number: u32| {
            json!({"team": team, "number": number, "x": 1.0, "y": -1.0, "heading": 0.5,
            "on_field": true, "upright": false})
        };
        let truth = json!({"robots": [robot(7, 1), robot(3, 2)], "ball_x": 0.1, "ball_y": 0.2, "ball_vx": 0.0, "ball_vy": 0.0});
        let picture = draw(&[
            ("field", TRUTH, truth),
            ("red-2", HOST, json!({"team": 3, "number": 2})),
            ("red-2", GAME_STATE, json!({"field_length": 9.0, "field_width": 6.0})),
        ]);
        let bodies: Vec<_> =
            picture.bodies.iter().map(|body| (body.host.as_str(), body.group, body.upright)).collect();
        assert_eq!(bodies, [("", 1, false), ("red-2", 0, false)]);
        assert_eq!(
            (picture.ground.width, picture.ground.height),
            (9.0 + 2.0 * CARPET_BORDER, 6.0 + 2.0 * CARPET_BORDER)
        );
        assert_eq!(picture.objects.len(), 1);
    }
}
