//! The same seed and the same commands give the same bits.
#![allow(clippy::unwrap_used)] // tests may panic

use monas_sim::{Command, GameState, Motion, Senses, Setup, Side, SimulatedWorld, Vector};

/// A small random generator of commands, independent of the world's.
struct Commands(u64);

impl Commands {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn command(&mut self) -> Command {
        let side = if self.next() < 0.5 { Side::Left } else { Side::Right };
        let motion = match (self.next() * 12.0) as u32 {
            0 => Motion::Kick(side),
            1 => Motion::Dive(side),
            2 => Motion::Fall(side),
            3..=5 => Motion::StandUp,
            6 => Motion::Stand,
            _ => Command::walk(self.next() - 0.3, self.next() - 0.5, 2.0 * self.next() - 1.0).motion,
        };
        Command {
            head_yaw: 4.0 * self.next() - 2.0,
            head_pitch: self.next() - 0.5,
            motion,
            ..Command::default()
        }
    }
}

/// The hash of all state during a minute of random commands.
fn hash_of_a_minute(setup: Setup) -> blake3::Hash {
    let mut world = SimulatedWorld::new(setup).unwrap();
    let mut commands = Commands(1);
    let mut hasher = blake3::Hasher::new();
    let mut senses = Senses::default();
    for step in 0..6000u32 {
        for robot in 0..world.robots().len() {
            if step % 40 == robot as u32 {
                world.command(robot, commands.command()).unwrap();
            }
            world.sense(robot, &mut senses).unwrap();
            hasher.update(format!("{senses:?}").as_bytes());
        }
        if step % 300 == 0 && world.referee().state() == GameState::Playing {
            let velocity = Vector::new(3.0 * commands.next() - 1.5, 3.0 * commands.next() - 1.5);
            world.place_ball(Vector::zeros(), velocity).unwrap();
        }
        world.step();
        for value in [world.ball().position, world.ball().velocity] {
            hasher.update(&value.x.to_bits().to_le_bytes()).update(&value.y.to_bits().to_le_bytes());
        }
    }
    hasher.update(format!("{:?} {:?}", world.events(), world.statistics()).as_bytes());
    hasher.finalize()
}

#[test]
fn the_same_seed_gives_the_same_minute_and_another_another() {
    let hash = hash_of_a_minute(Setup::three_against_three(11));
    assert_eq!(hash, hash_of_a_minute(Setup::three_against_three(11)));
    assert_ne!(hash, hash_of_a_minute(Setup::three_against_three(12)));
}

#[test]
fn one_changed_number_changes_the_minute() {
    let mut setup = Setup::three_against_three(11);
    setup.physics.ball_deceleration += 0.01;
    assert_ne!(hash_of_a_minute(setup), hash_of_a_minute(Setup::three_against_three(11)));
}

#[test]
fn worlds_on_two_threads_agree() {
    let minute = || hash_of_a_minute(Setup::three_against_three(13));
    let (one, other) = std::thread::scope(|scope| {
        let one = scope.spawn(minute);
        let other = scope.spawn(minute);
        (one.join().unwrap(), other.join().unwrap())
    });
    assert_eq!(one, other);
}
