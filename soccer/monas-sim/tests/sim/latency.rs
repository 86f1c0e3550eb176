//! The time from the exposure of a picture to its delivery.
#![allow(clippy::unwrap_used)] // tests may panic

use monas_robot::{Actuators, Images, ObjectKind, Percepts, Robot, Sensors, Sightings};
use monas_sim::{FieldBody, Physics, Setup, SharedField, SimulatedWorld, Vector};
use narukom::Timestamp;

const LATENCY: f64 = 0.06;
const CYCLE: u64 = 20_000_000;

fn field(camera_latency: f64) -> SharedField {
    let physics = Physics { camera_latency, sight_miss: 0.0, ..Physics::default() };
    SharedField::new(SimulatedWorld::new(Setup { physics, ..Setup::three_against_three(2) }).unwrap())
}

/// Two seconds of a body that turns its head: what it feels in each cycle, and what it sees then.
fn turn_head(field: &SharedField, mut body: FieldBody) -> Vec<(Sensors, Option<Sightings>, Option<Images>)> {
    let cycle = |cycle| {
        let now = Timestamp::from_nanos(cycle * CYCLE);
        let mut percepts = Percepts::default();
        (0..2).for_each(|_| field.step());
        body.sense(now, &mut percepts).unwrap();
        let aim = if cycle % 50 < 25 { 1.0 } else { -1.0 };
        body.act(now, &Actuators { head_yaw: aim, ..Actuators::default() }).unwrap();
        (percepts.sensors, percepts.sightings, percepts.images)
    };
    (1..=100).map(cycle).collect()
}

#[test]
fn sightings_have_time_head_and_objects_of_their_exposure() {
    let (late, prompt) = (field(LATENCY), field(0.0));
    let seen = turn_head(&late, late.body(1).unwrap());
    let expected = turn_head(&prompt, prompt.body(1).unwrap());
    // Three cycles of 20 ms; the last pictures are still in transit.
    for (delivered, exposed) in seen[3..].iter().zip(&expected) {
        assert_eq!(delivered.1, exposed.1, "the same pictures, later");
        if let Some(sightings) = &delivered.1 {
            assert_eq!(sightings.taken_at, delivered.0.measured_at - 3 * CYCLE);
            assert_eq!(sightings.head_yaw, exposed.0.head_yaw);
        }
    }
    assert!(seen[..3].iter().all(|(_, sightings, _)| sightings.is_none()));
    assert!(seen.iter().filter(|(_, sightings, _)| sightings.is_some()).count() > 50);
    let moved = seen.iter().filter_map(|(felt, it, _)| it.as_ref().map(|it| felt.head_yaw - it.head_yaw));
    assert!(moved.fold(0.0, |max: f64, it| max.max(it.abs())) > 0.1, "the head has turned since");
}

#[test]
fn images_are_those_of_their_exposure() {
    let (late, prompt) = (field(LATENCY), field(0.0));
    let [seen, expected] = [&late, &prompt].map(|field| {
        let mut body = field.body(1).unwrap();
        body.deliver_images(Some(160)).unwrap();
        turn_head(field, body)
    });
    for (delivered, exposed) in seen[3..].iter().zip(&expected) {
        assert!(delivered.2 == exposed.2, "the same images, later");
        if let Some(images) = &delivered.2 {
            assert_eq!(images.taken_at, delivered.0.measured_at - 3 * CYCLE);
        }
    }
    assert!(seen.iter().filter(|(_, _, images)| images.is_some()).count() > 50);
}

#[test]
fn a_latency_between_cycles_is_at_most_a_cycle_longer() {
    let field = field(0.05);
    let seen = turn_head(&field, field.body(1).unwrap());
    let ages = seen.iter().filter_map(|(felt, it, _)| it.as_ref().map(|it| felt.measured_at - it.taken_at));
    assert!(ages.clone().count() > 50 && ages.clone().all(|age| age == 60_000_000), "{:?}", ages.max());
}

#[test]
fn a_moved_ball_is_seen_where_it_was() {
    let field = field(LATENCY);
    let mut body = field.body(1).unwrap();
    let mut percepts = Percepts::default();
    let pose = field.with_world(|world| world.robots()[1].pose);
    let [near, far] = [0.8, 1.6].map(|ahead| pose.to_outer(Vector::new(ahead, 0.0)));
    let mut distances = Vec::new();
    for cycle in 1..=20 {
        let position = if cycle <= 10 { near } else { far };
        field.change(|world| world.place_ball(position, Vector::zeros())).unwrap();
        (0..2).for_each(|_| field.step());
        percepts.clear_news();
        body.sense(Timestamp::from_nanos(cycle * CYCLE), &mut percepts).unwrap();
        let seen = percepts.sightings.iter().flat_map(|it| &it.objects);
        distances
            .extend(seen.filter(|it| it.kind() == ObjectKind::Ball).map(|it| (cycle, it.distance > 1.2)));
    }
    assert!(distances.iter().any(|(cycle, _)| (11..14).contains(cycle)), "{distances:?}");
    assert!(distances.iter().all(|(cycle, is_far)| *is_far == (*cycle >= 14)), "{distances:?}");
}
