//! Rates of the errors of finished sightings. Bounds are four standard deviations of a binomial
//! distribution.
#![allow(clippy::unwrap_used)] // tests may panic

use monas_sim::{
    GoalColour, Percept, Physics, Pose, RobotSetup, Senses, Setup, Side, Sighting, SimulatedWorld,
    TeamColour, Vector,
};

const PICTURES: usize = 4000;

/// Cameras that miss nothing and take a picture in each step, without any error.
fn clear() -> Physics {
    Physics {
        camera_rate: 100.0,
        sight_miss: 0.0,
        light_change: 0.0,
        false_ball: 0.0,
        false_post: 0.0,
        false_robot: 0.0,
        wrong_goal: 0.0,
        wrong_side: 0.0,
        wrong_team: 0.0,
        ..Physics::default()
    }
}

/// Pictures of a blue robot at the centre of the field that looks at the yellow goal, with the ball
/// 1 m before it, a team mate on the left and an opponent on the right. Without the lines, which
/// have none of these errors.
fn pictures(physics: Physics, count: usize) -> Vec<Vec<Sighting>> {
    let robots = [(1, 2), (1, 3), (2, 2)].map(|(team, number)| RobotSetup { team, number });
    let setup = Setup { physics, robots: robots.to_vec(), ..Setup::three_against_three(4) };
    let mut world = SimulatedWorld::new(setup).unwrap();
    let positions = [Pose::default(), Pose::new(1.5, 0.5, 0.0), Pose::new(1.5, -0.5, 0.0)];
    let mut senses = Senses::default();
    let picture = |_| {
        world.step();
        positions
            .iter()
            .enumerate()
            .for_each(|(robot, position)| world.place_robot(robot, *position).unwrap());
        world.place_ball(Vector::new(1.0, 0.0), Vector::zeros()).unwrap();
        world.sense(0, &mut senses).unwrap();
        assert!(senses.new_picture);
        let is_line = |sighting: &&Sighting| matches!(sighting, Sighting::Line { .. });
        senses.sightings.iter().filter(|sighting| !is_line(sighting)).copied().collect()
    };
    (0..count).map(picture).collect()
}

/// Asserts that `count` of `draws` is a probability of `rate`.
fn assert_rate(count: usize, draws: usize, rate: f64) {
    let (expected, deviation) = (rate * draws as f64, (rate * (1.0 - rate) * draws as f64).sqrt());
    assert!((count as f64 - expected).abs() <= 4.0 * deviation, "{count} of {draws}, not {rate}");
}

fn number(pictures: &[Vec<Sighting>], which: impl Fn(&Sighting) -> bool) -> usize {
    pictures.iter().flatten().filter(|sighting| which(sighting)).count()
}

fn is_ball(sighting: &Sighting) -> bool {
    matches!(sighting, Sighting::Ball(_))
}

fn is_post(sighting: &Sighting) -> bool {
    matches!(sighting, Sighting::Post { .. })
}

fn is_robot(sighting: &Sighting) -> bool {
    matches!(sighting, Sighting::Robot { .. })
}

fn percept(sighting: &Sighting) -> &Percept {
    match sighting {
        Sighting::Ball(percept)
        | Sighting::Post { percept, .. }
        | Sighting::Line { percept, .. }
        | Sighting::Robot { percept, .. } => percept,
    }
}

#[test]
fn without_errors_every_object_is_seen_as_it_is() {
    for picture in pictures(clear(), 200) {
        assert_eq!(picture.len(), 5, "a ball, two posts, two robots: {picture:?}");
        for sighting in &picture {
            let left = percept(sighting).bearing > 0.0;
            match sighting {
                Sighting::Ball(_) | Sighting::Line { .. } => {}
                Sighting::Post { goal, side, .. } => {
                    assert_eq!(*goal, GoalColour::Yellow);
                    assert_eq!(*side, Some(if left { Side::Left } else { Side::Right }));
                }
                Sighting::Robot { colour, .. } => {
                    assert_eq!(*colour, if left { TeamColour::Blue } else { TeamColour::Red });
                }
            }
        }
    }
}

#[test]
fn false_objects_have_their_rate_and_lie_in_view() {
    let all = [0.02, 0.03, 0.05];
    let [false_ball, false_post, false_robot] = all;
    let physics = Physics { false_ball, false_post, false_robot, ..clear() };
    let seen = pictures(physics.clone(), PICTURES);
    let counts = [number(&seen, is_ball), number(&seen, is_post), number(&seen, is_robot)];
    for ((count, true_ones), rate) in counts.into_iter().zip([1, 2, 2]).zip(all) {
        assert_rate(count - true_ones * PICTURES, PICTURES, rate);
    }
    let (wide, high) = (physics.camera_view_horizontal / 2.0, physics.camera_view_vertical / 2.0);
    let lowest = high + physics.camera_tilt;
    // The false objects follow the five true ones.
    for sighting in seen.iter().flat_map(|picture| &picture[5..]) {
        let Percept { bearing, elevation, distance } = *percept(sighting);
        assert!(bearing.abs() <= wide && (-lowest..0.0).contains(&elevation), "{sighting:?}");
        let range = if is_post(sighting) { physics.post_range } else { physics.ball_range };
        assert!((0.0..=range).contains(&distance), "{sighting:?}");
    }
    let both = |colour: TeamColour| {
        number(&seen, |s| matches!(s, Sighting::Robot { colour: c, .. } if *c == colour))
    };
    assert!(both(TeamColour::Blue) > PICTURES && both(TeamColour::Red) > PICTURES, "of either team");
}

#[test]
fn a_post_is_taken_for_one_of_the_other_goal_at_its_rate() {
    let seen = pictures(Physics { wrong_goal: 0.1, ..clear() }, PICTURES);
    let wrong = |s: &Sighting| matches!(s, Sighting::Post { goal: GoalColour::Blue, .. });
    assert_rate(number(&seen, wrong), 2 * PICTURES, 0.1);
}

#[test]
fn the_posts_of_a_goal_are_confused_at_their_rate() {
    let seen = pictures(Physics { wrong_side: 0.1, ..clear() }, PICTURES);
    let wrong = |s: &Sighting| matches!(s, Sighting::Post { side: Some(side), percept, .. } if *side != Side::of(percept.bearing));
    assert_rate(number(&seen, wrong), 2 * PICTURES, 0.1);
}

#[test]
fn a_robot_is_taken_for_one_of_the_other_team_at_its_rate() {
    let seen = pictures(Physics { wrong_team: 0.1, ..clear() }, PICTURES);
    let wrong = |s: &Sighting| matches!(s, Sighting::Robot { colour, percept } if (*colour == TeamColour::Blue) != (percept.bearing > 0.0));
    assert_rate(number(&seen, wrong), 2 * PICTURES, 0.1);
}

#[test]
fn the_light_raises_misses_for_a_while() {
    // Windows of four seconds, in which the light hardly changes, during two minutes.
    let (seconds, window) = (120, 400);
    let physics = Physics { sight_miss: 0.1, light_change: 4.0, ..clear() };
    let seen = pictures(physics, 100 * seconds);
    let misses: Vec<usize> = seen.chunks(window).map(|seen| 5 * window - number(seen, |_| true)).collect();
    let (best, worst) = (misses.iter().min().unwrap(), misses.iter().max().unwrap());
    assert_rate(*best, 5 * window, 0.1);
    assert!(*worst > 5 * window / 4, "a quarter at least in the worst light: {misses:?}");
    let neighbours = misses.windows(2).map(|pair| pair[0].abs_diff(pair[1]));
    assert!(neighbours.max().unwrap() < 5 * window / 4, "it changes slowly: {misses:?}");
}

#[test]
fn errors_change_no_other_random_number() {
    let errors = Physics { false_ball: 0.5, false_post: 0.5, false_robot: 0.5, wrong_team: 0.5, ..clear() };
    let (seen, expected) = (pictures(errors, 100), pictures(clear(), 100));
    let percepts = |picture: &[Sighting]| picture[..5].iter().map(percept).copied().collect::<Vec<_>>();
    for (seen, expected) in seen.iter().zip(&expected) {
        assert_eq!(percepts(seen), percepts(expected));
    }
}

#[test]
fn a_lying_robot_sees_no_false_objects() {
    use monas_sim::{BodyPhase, Command, GameState, Motion};
    let physics = Physics { false_ball: 1.0, false_post: 1.0, false_robot: 1.0, ..clear() };
    let mut world = SimulatedWorld::new(Setup { physics, ..Setup::three_against_three(4) }).unwrap();
    let mut senses = Senses::default();
    let fallen = |world: &SimulatedWorld| matches!(world.robots()[1].phase, BodyPhase::Fallen(_));
    while !fallen(&world) {
        assert!(world.time() < 20.0, "it does not fall");
        if world.referee().state() == GameState::Playing {
            world.command(1, Command::new(Motion::Fall(Side::Left))).unwrap();
        }
        world.step();
        world.sense(1, &mut senses).unwrap();
    }
    assert!(senses.new_picture && senses.sightings.is_empty(), "{:?}", senses.sightings);
}
