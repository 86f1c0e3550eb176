//! No activity knows its player: what it does depends neither on the number nor on the role of the
//! robot, so that every chart plays the same under any number.

#![allow(clippy::unwrap_used)] // tests may panic

use std::collections::BTreeMap;

use monas::{Blackboard, Registry};
use monas_soccer::{
    Attack, AttackPart, Ball, GameState, MotionState, PlayerState, Pose, Robots, Team, topics,
};
use narukom::{Hub, Timestamp};

/// Everything but the number, in a play in the middle of the field.
fn publish_scene(others: &mut Blackboard, number: u32) {
    let game = GameState {
        player_state: PlayerState::Playing.into(),
        number,
        field_length: 6.0,
        field_width: 4.0,
        goal_width: 1.4,
        area_depth: 0.6,
        area_width: 2.2,
        ..GameState::default()
    };
    let ball = Ball { found: true, x: 1.0, y: 0.3, distance: 1.04, bearing: 0.29, ..Ball::default() };
    let attack = Attack { part: AttackPart::CenterFor.into(), mate_x: 1.0, ..Attack::default() };
    others.publish(topics::GAME_STATE, game).unwrap();
    others.publish(topics::BALL, ball).unwrap();
    others.publish(topics::POSE, Pose { x: -1.0, confidence: 0.5, ..Pose::default() }).unwrap();
    others.publish(topics::ROBOTS, Robots::default()).unwrap();
    others.publish(topics::TEAM, Team::default()).unwrap();
    others.publish(topics::ATTACK, attack).unwrap();
    others.publish(topics::MOTION_STATE, MotionState::default()).unwrap();
}

/// The hash of each topic after an activity has been called three times.
fn published(activity: &str, number: u32) -> BTreeMap<String, String> {
    let hub = Hub::with_linked_topics("robot").unwrap();
    let (mut actor, mut others) = (hub.blackboard("actor"), hub.blackboard("others"));
    let mut activity = Registry::linked().activity(activity).unwrap();
    let mut said = BTreeMap::new();
    for cycle in 1..=3 {
        let now = Timestamp::from_secs_f64(2.0 + 0.1 * f64::from(cycle));
        others.process_messages(now);
        publish_scene(&mut others, number);
        others.publish_all(now);
        actor.process_messages(now);
        let result = activity.execute(&mut actor).map_err(|error| error.to_string());
        said.insert(format!("progress {cycle}"), format!("{result:?}"));
        said.insert(format!("motion {cycle}"), format!("{:?}", actor.read(topics::MOTION)));
        said.insert(format!("head {cycle}"), format!("{:?}", actor.read(topics::HEAD)));
        said.insert(format!("attack {cycle}"), format!("{:?}", actor.read(topics::ATTACK)));
        said.insert(format!("team {cycle}"), format!("{:?}", actor.read(topics::TEAM)));
        said.insert(format!("leds {cycle}"), format!("{:?}", actor.read(topics::LEDS)));
        actor.publish_all(now);
    }
    said
}

#[test]
fn every_activity_does_the_same_under_any_number() {
    let registry = Registry::linked();
    let mut moving = 0;
    for name in registry.activity_names() {
        let (one, other) = (published(name, 1), published(name, 4));
        assert_eq!(one, other, "{name}");
        moving += usize::from(one.values().any(|said| said.contains("MotionRequest")));
    }
    assert!(moving >= 10, "only {moving} activities moved the body: the scene is too dull");
}
