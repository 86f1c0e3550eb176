//! Robots that see images: what they find is where it is, and they play.
#![allow(clippy::unwrap_used)] // tests may panic

use std::time::Duration;

use monas::config::Layers;
use monas_match::{MatchOptions, MatchSource};
use monas_nao::SimulatedNao; // the body registers itself at link time
use monas_robot::{Disturbances, ObjectKind, Percepts, Robot, Sighting, WrappedBody};
use monas_sim::{MatchRules, Physics, Pose, Setup, SharedField, SimulatedWorld, Vector};
use monas_soccer::image_interpreter::{ImageInterpreter, Interpretation};
use monas_tests::{BallKnowledge, TODAY};
use narukom::Timestamp;

/// A world in which play has begun and the robots stand in a corner, but for the one at index 1.
fn world(seed: u64) -> SimulatedWorld {
    let rules =
        MatchRules { initial_duration: 0.0, ready_duration: 0.0, set_duration: 0.0, ..MatchRules::default() };
    // The truth is that of the moment of the image.
    let physics = Physics { camera_latency: 0.0, ..Physics::default() };
    let setup = Setup { rules, physics, ..Setup::three_against_three(seed) };
    let mut world = SimulatedWorld::new(setup).unwrap();
    (0..20).for_each(|_| world.step());
    for robot in [0, 2, 3, 4, 5] {
        world.place_robot(robot, Pose::new(-2.8 + 0.4 * robot as f64, 2.4, 0.0)).unwrap();
    }
    world
}

fn of(objects: &[Sighting], kinds: &[ObjectKind]) -> Vec<Sighting> {
    objects.iter().filter(|object| kinds.contains(&object.kind())).copied().collect()
}

/// The mean distance of points between the ends from the nearest line of the field of the default
/// geometry.
fn away_from_lines(ends: [Vector; 2]) -> f64 {
    let (length, width, front, side) = (3.0, 2.0, 2.4, 1.1);
    let away = |point: Vector| {
        let (x, y) = (point.x.abs(), point.y.abs());
        // Distance from a stroke along y (at x, up to y) and from one along x.
        let across = |at: f64, until: f64| Vector::new(x - at, (y - until).max(0.0)).norm();
        let along =
            |at: f64, from: f64, until: f64| Vector::new(y - at, (x - until).max(from - x).max(0.0)).norm();
        let circle = (point.norm() - 0.6).abs();
        [across(length, width), along(width, 0.0, length), across(0.0, width), across(front, side)]
            .into_iter()
            .chain([along(side, front, length), circle])
            .fold(9.0, f64::min)
    };
    (0..=4).map(|part| away(ends[0] + (ends[1] - ends[0]) * (f64::from(part) / 4.0))).sum::<f64>() / 5.0
}

/// The distance of a point from the edge of the carpet.
fn away_from_border(point: Vector) -> f64 {
    let (x, y) = (3.7 - point.x.abs(), 2.7 - point.y.abs());
    if x.min(y) >= 0.0 { x.min(y) } else { Vector::new(x.min(0.0), y.min(0.0)).norm() }
}

#[test]
fn what_images_show_is_where_it_is() {
    let field = SharedField::new(world(3));
    let mut body = field.body(1).unwrap();
    body.deliver_images(None).unwrap();
    let (mut percepts, mut interpreter) = (Percepts::default(), ImageInterpreter::default());
    let (mut shown, mut errors, mut false_balls, mut posts, mut images) = (0, Vec::new(), 0, Vec::new(), 0);
    let (mut lines, mut border) = (Vec::new(), Vec::new());
    let mut now = 0;
    let rounds = if crate::is_long() { 60 } else { 20 };
    for round in 0..rounds {
        // From 0.6 to 2.6 m, up to 20 degrees aside, while the light changes.
        let (distance, bearing) = (0.6 + f64::from(round % 11) * 0.2, f64::from(round % 7 - 3) * 0.11);
        let (sin, cos) = libm::sincos(bearing);
        let pose = Pose::new(0.3, -0.2, 0.15 * f64::from(round % 3 - 1));
        let ball = pose.to_outer(Vector::new(distance * cos, distance * sin));
        field.change(|world| world.place_robot(1, pose)).unwrap();
        field.change(|world| world.place_ball(ball, Vector::zeros())).unwrap();
        for _ in 0..4 {
            (0..20).for_each(|_| field.step());
            now += 200_000_000;
            percepts.clear_news();
            body.sense(Timestamp::from_nanos(now), &mut percepts).unwrap();
            assert!(percepts.sightings.is_none(), "there are images in place of sightings");
            let Some(taken) = &percepts.images else { continue };
            images += 1;
            let pixels = taken.images.iter().map(|image| image.pixels.len());
            assert_eq!(pixels.collect::<Vec<_>>(), [153_600; 2], "two images of 320 by 240");
            let (ball, own) = field.with_world(|world| (world.ball().position, world.robots()[1].pose));
            let truth = own.to_own(ball);
            let Interpretation { sightings: seen, lines: found } =
                interpreter.interpret(taken, &percepts.sensors).unwrap();
            assert!(found.taken_at == taken.taken_at && found.lines.len() <= 32 && found.border.len() <= 32);
            lines.extend(found.lines.iter().map(|line| {
                let ends = [(line.x1, line.y1), (line.x2, line.y2)].map(|(x, y)| Vector::new(x, y));
                (ends[0].lerp(&ends[1], 0.5).norm(), away_from_lines(ends.map(|end| own.to_outer(end))))
            }));
            let ends = found.border.iter().map(|point| own.to_outer(Vector::new(point.x, point.y)));
            border.extend(ends.map(away_from_border));
            shown += 1;
            for found in of(&seen.objects, &[ObjectKind::Ball]) {
                let (sin, cos) = libm::sincos(found.bearing);
                let error = (Vector::new(cos, sin) * found.distance - truth).norm() / truth.norm();
                if error < 0.25 { errors.push(error) } else { false_balls += 1 }
            }
            let kinds = [ObjectKind::LeftPost, ObjectKind::RightPost, ObjectKind::SomePost];
            let found = of(&seen.objects, &kinds);
            for post in found {
                // The yellow goal is ahead, 2.7 m away.
                let (sin, cos) = libm::sincos(post.bearing);
                let at = own.to_outer(Vector::new(cos, sin) * post.distance);
                let away = [0.7, -0.7].map(|y| (at - Vector::new(3.0, y)).norm());
                posts.push(away.into_iter().fold(9.0, f64::min));
            }
        }
    }
    let mean = |errors: &[f64]| errors.iter().sum::<f64>() / errors.len() as f64;
    let (error, away) = (mean(&errors), mean(&posts));
    let wrong_posts = posts.iter().filter(|away| **away > 0.6).count();
    println!("{images} images: ball {} of {shown}, error {error:.3}, {false_balls} false", errors.len());
    println!("{} posts, on average {away:.2} m away from one, {wrong_posts} beyond 0.6 m", posts.len());
    assert!(
        shown * 6 > rounds as usize * 20 && errors.len() * 100 >= shown * 95,
        "{} of {shown} balls",
        errors.len()
    );
    // The inclination of the torso is measured with a deviation of 0.01 rad.
    assert!(error < 0.04 && false_balls * 30 <= rounds, "error {error}, {false_balls} false balls");
    assert!(posts.len() > images, "{} posts in {images} images", posts.len());
    let far = |all: &[f64], max: f64| all.iter().filter(|away| **away > max).count();
    let near: Vec<f64> = lines.iter().filter(|(at, _)| *at < 2.5).map(|(_, away)| *away).collect();
    let lines: Vec<f64> = lines.iter().map(|(_, away)| *away).collect();
    let (line, edge) = (mean(&near), mean(&border));
    println!("{} lines, {:.3} m off, {} beyond 0.3 m", lines.len(), mean(&lines), far(&lines, 0.3));
    println!("{} lines up to 2.5 m, {line:.3} m off", near.len());
    println!("{} points of the border, {edge:.3} m off, {} beyond 0.6 m", border.len(), far(&border, 0.6));
    assert!(near.len() > images && line < 0.09, "{} lines, {line} m", near.len());
    assert!(lines.len() > 3 * images && mean(&lines) < 0.12, "{} lines, {} m", lines.len(), mean(&lines));
    assert!(far(&lines, 0.3) * 50 <= lines.len(), "{} of {}", far(&lines, 0.3), lines.len());
    assert!(border.len() > 5 * images && edge < 0.2, "{} points, {edge} m", border.len());
    assert!(far(&border, 0.6) * 20 <= border.len(), "{} of {}", far(&border, 0.6), border.len());
    assert!(away < 0.25 && wrong_posts * 50 <= posts.len(), "{away} m, {wrong_posts} of {}", posts.len());
}

/// The perception of the only robot that plays.
#[derive(Clone, Copy, PartialEq)]
enum Eyes {
    Blind,
    Field,
    Nao,
}

#[test]
fn a_robot_that_sees_images_finds_and_moves_the_ball() {
    let blind = Disturbances { loss: 1.0, ..Disturbances::default() };
    let path = monas_tests::root().join("config/match.xml");
    let displaced = |eyes: Eyes| {
        let mut layers = Layers::new();
        for phase in ["initial", "ready", "set"] {
            let at_once = format!("simulator.rules.{phase}_duration=0");
            layers = layers.set(&at_once, &monas_match::grammar()).unwrap();
        }
        let plan = MatchSource::load_with(&path, &monas::Registry::linked(), &layers).unwrap();
        // One robot plays; it sees images or nothing, the others nothing.
        let plan = plan.without_agents(2).replace_bodies(move |team, number, mut body| {
            if (team, number) == (1, 2) && eyes != Eyes::Blind {
                if eyes == Eyes::Nao {
                    body = Box::new(SimulatedNao::new(body).unwrap());
                }
                body.deliver_images(None).unwrap();
                return body;
            }
            Box::new(WrappedBody::new(body, blind, 1))
        });
        let mut running = plan.start(MatchOptions { seed: 1, ..MatchOptions::default() }).unwrap();
        // After a goal the ball is back in the centre.
        let mut farthest = 0.0f64;
        for second in 0..30 {
            running.advance(Duration::from_secs(second)).unwrap();
            farthest = farthest.max(running.pitch().with_world(|world| world.ball().position.norm()));
            if farthest > 0.3 {
                println!("moved within {second} s");
                break;
            }
        }
        farthest
    };
    assert!(displaced(Eyes::Field) > 0.3, "the ball is where it was");
    assert!(displaced(Eyes::Nao) > 0.3, "the ball is where it was, with a Nao");
    assert!(displaced(Eyes::Blind) < 0.05, "blind robots do not find the ball");
}

#[test]
fn the_matches_with_images_start_and_repeat() {
    let hash = |file: &str| {
        let path = monas_tests::root().join(file);
        let plan = MatchSource::load(&path, &monas::Registry::linked()).unwrap();
        let mut running = plan.start(MatchOptions { seed: 1, ..MatchOptions::default() }).unwrap();
        running.advance(Duration::from_millis(300)).unwrap();
        running.finish().unwrap().hash
    };
    for file in ["config/match_images.xml", "config/match_today.xml"] {
        assert_eq!(hash(file), hash(file), "{file}");
    }
}

#[test]
fn a_robot_plays_with_todays_objects_from_images() {
    let (seeds, seconds): (&[u64], _) = if crate::is_long() { (&[1, 2], 20) } else { (&[1], 8) };
    let play =
        |images| BallKnowledge::of_matches(&TODAY, images, seeds, Duration::from_secs(seconds)).unwrap();
    let (sightings, images) = (play(None), play(Some(320)));
    println!("finished sightings: {sightings:?}\nimages: {images:?}");
    for known in [&sightings, &images] {
        assert!(
            known.in_view >= seconds as usize * seeds.len(),
            "the ball was in view {} times",
            known.in_view
        );
        assert!(known.known_share() > 0.85, "{} of {} balls", known.known, known.in_view);
        assert!(known.wrong * 20 <= known.in_view, "{} wrong of {}", known.wrong, known.in_view);
        assert!(known.error() < 0.1, "distance: {}", known.error());
        assert!(known.pose_error() < 0.1, "pose: {} m", known.pose_error());
        assert!(known.kicks >= 1, "{} kicks", known.kicks);
    }
}

#[test]
fn a_nao_delivers_the_images_of_the_field() {
    let settings = monas_robot::BodySettings {
        kind: "nao".into(),
        vision: monas_robot::CameraOutput::Images,
        image_width: Some(160),
        ..Default::default()
    };
    let (field, of_field) = [(); 2].map(|()| SharedField::new(world(3))).into();
    let mut nao = settings.open(field.body(1).map(|body| Box::new(body) as _), 1).unwrap();
    let mut disk = of_field.body(1).unwrap();
    disk.deliver_images(Some(160)).unwrap();
    let images = |body: &mut dyn Robot, field: &SharedField| {
        let mut percepts = Percepts::default();
        let cycles = (0..100).map(|cycle| {
            field.step();
            percepts.clear_news();
            body.sense(Timestamp::from_nanos(cycle * 10_000_000), &mut percepts).unwrap();
            assert!(percepts.sightings.is_none(), "there are images in place of sightings");
            percepts.images.take()
        });
        cycles.collect::<Vec<_>>()
    };
    let (seen, expected) = (images(&mut *nao, &field), images(&mut disk, &of_field));
    assert!(expected.iter().flatten().count() >= 4 && seen == expected, "other images than the field's");
}
