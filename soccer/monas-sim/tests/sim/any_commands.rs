//! Arbitrary commands keep the world in valid states.
#![allow(clippy::unwrap_used)] // tests may panic

use monas_sim::{
    Command, EventKind, FieldGeometry, GameState, MatchRules, Motion, Parameter, Physics, Senses, Setup,
    Side, SimulatedWorld, Velocity,
};
use proptest::prelude::*;

fn side() -> impl Strategy<Value = Side> {
    prop_oneof![Just(Side::Left), Just(Side::Right)]
}

fn motion() -> impl Strategy<Value = Motion> {
    let walk = (-1e3..1e3, -1e3..1e3, -1e3..1e3);
    let slow = (-0.3..0.3, -0.2..0.2, -1.0..1.0);
    let walk = prop_oneof![walk, slow].prop_map(|(x, y, turn)| Motion::Walk(Velocity::new(x, y, turn)));
    prop_oneof![
        6 => walk,
        1 => Just(Motion::Stand),
        3 => Just(Motion::StandUp),
        1 => Just(Motion::Sit),
        1 => Just(Motion::Freeze),
        1 => side().prop_map(Motion::Kick),
        1 => side().prop_map(Motion::Fall),
        1 => side().prop_map(Motion::Dive),
    ]
}

fn command() -> impl Strategy<Value = Command> {
    (-1e6..1e6, -1e6..1e6, motion(), -1e6..1e6).prop_map(|(head_yaw, head_pitch, motion, ball_speed)| {
        Command { head_yaw, head_pitch, motion, ball_speed }
    })
}

/// The distance that the ball rolls after the hardest kick, m.
fn longest_roll() -> f64 {
    let physics = Physics::default();
    let speed = physics.kick_speed + 5.0 * physics.kick_speed_noise;
    speed * speed / (2.0 * physics.ball_deceleration)
}

fn check(world: &SimulatedWorld, senses: &Senses) -> Result<(), TestCaseError> {
    let ball = world.ball();
    let field = world.field();
    let state = world.referee().state();
    let beyond = match state {
        GameState::Set | GameState::Playing => 0.5,
        // A ball that is kicked, or squeezed out between robots, while it is not in play stays
        // where it stops, until SET.
        _ => field.border + longest_roll(),
    };
    prop_assert!(
        ball.position.x.abs() < field.half_length() + beyond,
        "the ball is lost: {ball:?}, {state:?}"
    );
    prop_assert!(
        ball.position.y.abs() < field.half_width() + beyond,
        "the ball is lost: {ball:?}, {state:?}"
    );
    prop_assert!(ball.velocity.norm() < 10.0, "{ball:?}");
    for robot in world.robots() {
        let position = robot.pose.position;
        prop_assert!(position.x.abs() < field.half_length() + field.border + 0.2, "{robot:?}");
        prop_assert!(position.y.abs() < field.half_width() + field.border + 0.2, "{robot:?}");
        prop_assert!(robot.pose.heading.is_finite() && robot.velocity.norm() < 10.0, "{robot:?}");
    }
    let numbers = [senses.torso_roll, senses.torso_pitch, senses.odometry.position.norm(), senses.gyro[2]];
    prop_assert!(numbers.iter().all(|number| number.is_finite()), "{senses:?}");
    Ok(())
}

/// A setup with some of its parameters anywhere in their ranges.
fn any_setup() -> impl Strategy<Value = Setup> {
    let parts = prop::collection::vec((any::<prop::sample::Index>(), 0.0..=1.0), 0..12);
    (any::<u64>(), parts).prop_map(|(seed, parts)| {
        let mut setup = Setup::three_against_three(seed);
        setup.rules.half_duration = 30.0;
        let keys: Vec<&Parameter> =
            FieldGeometry::keys().iter().chain(Physics::keys()).chain(MatchRules::keys()).collect();
        for (index, part) in parts {
            let parameter = index.get(&keys);
            let value = parameter.min + part * (parameter.max - parameter.min);
            let set = setup.field.set(parameter.key, value);
            let set = set.or_else(|_| setup.physics.set(parameter.key, value));
            set.or_else(|_| setup.rules.set(parameter.key, value)).unwrap();
        }
        setup
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn any_numbers_are_refused_or_leave_finite_numbers(
        setup in any_setup(),
        commands in prop::collection::vec((0usize..6, command()), 1..12),
    ) {
        let Ok(mut world) = SimulatedWorld::new(setup) else { return Ok(()) };
        let mut senses = Senses::default();
        for (robot, command) in commands {
            world.command(robot, command).unwrap();
            for _ in 0..100 {
                world.step();
                world.sense(robot, &mut senses).unwrap();
            }
            let ball = world.ball();
            prop_assert!(ball.position.norm().is_finite() && ball.velocity.norm().is_finite());
            prop_assert!(world.robots().iter().all(|robot| robot.pose.position.norm().is_finite()));
        }
        prop_assert!(!monas_sim::render_svg(&world).contains("NaN"));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn any_commands_leave_a_sane_world(
        seed in any::<u64>(),
        walls in any::<bool>(),
        commands in prop::collection::vec((0usize..6, command(), 1u32..60), 10..60),
    ) {
        let mut setup = Setup::three_against_three(seed);
        setup.rules.half_duration = 12.0;
        setup.field.walls = f64::from(u8::from(walls));
        let mut world = SimulatedWorld::new(setup).unwrap();
        let mut senses = Senses::default();
        for (robot, command, steps) in commands {
            world.command(robot, command).unwrap();
            for _ in 0..steps {
                world.step();
                world.sense(robot, &mut senses).unwrap();
                check(&world, &senses)?;
            }
        }
        let mut state = GameState::Initial;
        for event in world.events() {
            if let EventKind::StateChanged { from, to } = event.kind {
                prop_assert_eq!(from, state);
                prop_assert!(from.may_become(to), "{:?} to {:?}", from, to);
                state = to;
            }
        }
        prop_assert_eq!(state, world.referee().state());
    }
}
