//! Measures the kick on the server: how fast and how far the ball rolls, and where to.
//!
//! ```text
//! cargo run --release -p monas-rcsssmj --example kick_table [-- [--robot K1] [POLICY]]
//! ```
//!
//! The program `rcssservermj` has to be in PATH. A T1 kicks, or a K1. The ball lies at the place
//! for the kick, or beside it by chance. With a file of weights the robot stands by the policy
//! before the kick.

use std::collections::BTreeMap;

use monas_rcsssmj::monitor::Command;
use monas_rcsssmj::{Booster, KickParameters};
use monas_robot::{Actuators, BodySite, ObjectKind, Percepts, Robot, Skill};
use narukom::Timestamp;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Kicks of each row, by each foot the half of them.
const KICKS: u32 = 10;
/// By how much the ball lies beside the place for the kick, m, one row for each.
const LATERAL_OFFSETS: [f64; 4] = [0.0, 0.02, 0.04, 0.06];
/// The position of the robot, m.
const ROBOT_POSITION: [f64; 2] = [-12.0, 0.0];
/// Cycles before a kick, and those in which the ball rolls after it.
const STAND_CYCLES: u32 = 100;
const ROLLING_CYCLES: u32 = 250;
/// Between two places of the ball for its speed, s.
const SPEED_INTERVAL: f64 = 0.2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).peekable();
    let robot = arguments.next_if_eq("--robot").and_then(|_| arguments.next());
    let policy = arguments.next().map(|file| ("policy".to_owned(), file));
    let options = robot.map(|name| ("robot".to_owned(), name)).into_iter().chain(policy);
    let site = BodySite { options: options.collect::<BTreeMap<_, _>>(), ..BodySite::default() };
    let body = monas_rcsssmj::open(&site)?;
    let mut table = Table { body, cycle: 0, skill: 0, percepts: Percepts::default() };
    let mut chance = Pcg32::seed_from_u64(1);
    println!("| ball beside its place, m | hit | distance, m | fastest, m/s | direction, deg | falls |");
    println!("|---|---|---|---|---|---|");
    for beside in LATERAL_OFFSETS {
        let mut kicks = Vec::new();
        for kick in 0..KICKS {
            let mut spread = || beside * (2.0 * f64::from(chance.next_u32()) / f64::from(u32::MAX) - 1.0);
            let skill = if kick % 2 == 0 { Skill::KickLeft } else { Skill::KickRight };
            kicks.push(table.kick(skill, [spread(), spread()])?);
        }
        let falls = kicks.iter().filter(|kick| kick.fell).count();
        let hits: Vec<&Kicked> = kicks.iter().filter(|kick| kick.distance > 0.5).collect();
        let range = |of: fn(&Kicked) -> f64| {
            let (mut min, mut max, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
            for value in hits.iter().map(|kick| of(kick)) {
                (min, max, sum) = (min.min(value), max.max(value), sum + value);
            }
            format!("{:.1} ({min:.1} to {max:.1})", sum / hits.len().max(1) as f64)
        };
        let (distance, speed) = (range(|kick| kick.distance), range(|kick| kick.speed));
        let direction = range(|kick| kick.direction.to_degrees());
        println!("| {beside} | {} of {KICKS} | {distance} | {speed} | {direction} | {falls} |", hits.len());
    }
    Ok(())
}

/// The result of a kick.
struct Kicked {
    /// The distance of the ball after the kick, m, and its direction relative to the robot's, rad.
    distance: f64,
    direction: f64,
    speed: f64,
    fell: bool,
}

struct Table {
    body: Booster,
    cycle: u64,
    skill: u64,
    percepts: Percepts,
}

impl Table {
    fn cycle(&mut self, command: &Actuators) -> Result<(), Box<dyn std::error::Error>> {
        self.cycle += 1;
        let now = Timestamp::from_nanos(self.cycle * 20_000_000);
        self.percepts.clear_news();
        self.body.sense(now, &mut self.percepts)?;
        Ok(self.body.act(now, command)?)
    }

    /// The position of the ball on the field, if the robot sees it.
    fn ball(&self) -> Option<[f64; 2]> {
        let seen = self.percepts.sightings.as_ref()?;
        let ball = seen.objects.iter().find(|object| object.kind() == ObjectKind::Ball)?;
        let ([x, y, _], heading) = (self.body.true_position(), self.body.true_heading());
        let (sin, cos) = libm::sincos(heading + ball.bearing);
        let (ahead_y, ahead_x) = libm::sincos(heading);
        let hips = self.body.robot().hips().x;
        Some([x + hips * ahead_x + ball.distance * cos, y + hips * ahead_y + ball.distance * sin])
    }

    fn kick(&mut self, skill: Skill, beside: [f64; 2]) -> Result<Kicked, Box<dyn std::error::Error>> {
        let robot = self.body.robot();
        let kick = KickParameters::own(robot)?;
        let side = if skill == Skill::KickLeft { 1.0 } else { -1.0 };
        // Far from where it stood before, so that the body notices that it was placed.
        let height = (robot.straight_height() * 100.0).ceil() / 100.0;
        let position = [ROBOT_POSITION[0], ROBOT_POSITION[1] + side, height];
        let ball = [
            position[0] + robot.hips().x + kick.ball_x + beside[0],
            position[1] + side * kick.ball_y + beside[1],
        ];
        let mut command = Actuators { skill_number: self.skill, ..Actuators::default() };
        for _ in 0..STAND_CYCLES {
            self.cycle(&command)?;
        }
        let team = "Monas".to_owned();
        self.body.instruct(Command::PlaceRobot { team, number: 2, at: position, heading: 0.0 });
        self.body.instruct(Command::PlaceBall { at: [ball[0], ball[1], 0.11], velocity: [0.0; 3] });
        for _ in 0..STAND_CYCLES {
            self.cycle(&command)?;
        }
        self.skill += 1;
        (command.skill, command.skill_number) = (skill as i32, self.skill);
        let (mut positions, mut fell, mut rolling) = (vec![(0.0, ball)], false, 0);
        while rolling < ROLLING_CYCLES {
            self.cycle(&command)?;
            fell |= self.body.is_fallen();
            rolling += u32::from(fell || self.percepts.sensors.skill_done == self.skill);
            positions.extend(self.ball().map(|ball| (self.cycle as f64 * 0.02, ball)));
        }
        let distance = |from: [f64; 2], to: [f64; 2]| libm::hypot(to[0] - from[0], to[1] - from[1]);
        let speed = |(at, (time, position)): (usize, &(f64, [f64; 2]))| {
            let later = positions[at..].iter().find(|(later, _)| *later >= time + SPEED_INTERVAL)?;
            Some(distance(*position, later.1) / (later.0 - time))
        };
        let speed = positions.iter().enumerate().skip(1).filter_map(speed).fold(0.0, f64::max);
        let last = positions.last().map_or(ball, |last| last.1);
        let direction = libm::atan2(last[1] - ball[1], last[0] - ball[0]);
        Ok(Kicked { distance: distance(ball, last), direction, speed, fell })
    }
}
