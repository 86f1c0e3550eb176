//! Whatever robots are told, the world stays sane.

use monas_sim::{Command, EventKind, GameState, Motion, Senses, Setup, Side, Velocity, World};
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
        1 => Just(Motion::Freeze),
        1 => side().prop_map(Motion::Kick),
        1 => side().prop_map(Motion::Fall),
        1 => side().prop_map(Motion::Dive),
    ]
}

fn command() -> impl Strategy<Value = Command> {
    (-1e6..1e6, -1e6..1e6, motion()).prop_map(|(head_yaw, head_pitch, motion)| Command {
        head_yaw,
        head_pitch,
        motion,
    })
}

fn check(world: &World, senses: &Senses) -> Result<(), TestCaseError> {
    let ball = world.ball();
    let field = world.field();
    prop_assert!(ball.position.x.abs() < field.half_length() + 0.5, "the ball is lost: {ball:?}");
    prop_assert!(ball.position.y.abs() < field.half_width() + 0.5, "the ball is lost: {ball:?}");
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
        let mut world = World::new(setup).unwrap();
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
