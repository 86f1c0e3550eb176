//! Measures the walks: what is commanded and what the robot does, as a table.
//!
//! ```text
//! cargo run --release -p monas-rcsssmj --example walk_table [-- [--robot K1] [POLICY]]
//! ```
//!
//! The program `rcssservermj` has to be in PATH. A T1 walks, or a K1. With a file of weights the
//! policy walks, without one the own walk. Each row is of several trials of twelve seconds, of
//! which the first two are for the start; they begin after stands of different lengths. In the last
//! row the velocity changes every two seconds, with stops between. True speeds are those that the
//! server says, felt ones those of the odometry.

use std::collections::BTreeMap;

use monas_rcsssmj::Booster;
use monas_rcsssmj::monitor::Command;
use monas_robot::{Actuators, BodySite, Percepts, Robot};
use narukom::Timestamp;

/// Speeds ahead, to the left, and rates of turning.
const POLICY_VELOCITIES: [[f64; 3]; 12] = [
    [0.0, 0.0, 0.0],
    [0.25, 0.0, 0.0],
    [0.5, 0.0, 0.0],
    [0.8, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [-0.4, 0.0, 0.0],
    [0.0, 0.0, 0.5],
    [0.0, 0.0, -1.0],
    [0.5, 0.0, 0.5],
    [0.8, 0.0, -0.8],
    [0.3, 0.2, 0.0],
    [0.0, 0.2, -0.5],
];
const SINE_WALK_VELOCITIES: [[f64; 3]; 12] = [
    [0.0, 0.0, 0.0],
    [0.15, 0.0, 0.0],
    [0.3, 0.0, 0.0],
    [0.45, 0.0, 0.0],
    [0.6, 0.0, 0.0],
    [-0.2, 0.0, 0.0],
    [0.0, 0.12, 0.0],
    [0.0, -0.12, 0.0],
    [0.0, 0.0, 0.8],
    [0.0, 0.0, -0.4],
    [0.3, 0.0, 0.5],
    [0.6, 0.0, -0.3],
];

/// Trials of each row, and the cycles by which their stands differ.
const TRIALS: u32 = 4;
const TRIAL_OFFSET: u32 = 7;
/// Cycles of the stand, of the start and of the measurement.
const STAND_CYCLES: u32 = 100;
const START_CYCLES: u32 = 100;
const MEASURED_CYCLES: u32 = 500;
/// Cycles between two changes of the last row, and their number.
const CYCLES_PER_CHANGE: u32 = 107;
const CHANGES: u32 = 36;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).peekable();
    let robot = arguments.next_if_eq("--robot").and_then(|_| arguments.next());
    let policy = arguments.next();
    let (name, commands): (_, &[_]) =
        if policy.is_some() { ("policy", &POLICY_VELOCITIES) } else { ("own", &SINE_WALK_VELOCITIES) };
    let mut options = BTreeMap::from([("kick_off".to_owned(), "0".to_owned())]);
    options.extend(robot.map(|name| ("robot".to_owned(), name)));
    options.extend(policy.map(|file| ("policy".to_owned(), file)));
    let site = BodySite { options, ..BodySite::default() };
    let mut table = Table { body: monas_rcsssmj::open(&site)?, cycle: 0, percepts: Percepts::default() };
    println!("| walk | commanded x, y, turn | true x, y, turn | felt x, y, turn | falls |");
    println!("|---|---|---|---|---|");
    let (mut falls, mut cycles) = (0, 0);
    for command in commands {
        let mut row = Row::default();
        for trial in 0..TRIALS {
            table.stand(trial)?;
            table.walk(*command, START_CYCLES, &mut Row::default(), &mut row)?;
            table.walk(*command, MEASURED_CYCLES, &mut row, &mut Row::default())?;
        }
        println!("| {name} | {} | {row} |", rates(*command));
        (falls, cycles) = (falls + row.falls, cycles + row.walked);
    }
    let mut changes = Row::default();
    table.stand(0)?;
    for change in 0..CHANGES {
        // Every second one is a stop; the cycles differ, so that it begins in any phase of a step.
        let command =
            if change % 2 == 1 { [0.0; 3] } else { commands[(change * 5 / 2) as usize % commands.len()] };
        let falls = changes.falls;
        table.walk(command, CYCLES_PER_CHANGE - change % 30, &mut Row::default(), &mut changes)?;
        if changes.falls > falls {
            table.stand(0)?;
        }
    }
    println!("| {name} | {CHANGES} changes | | | {} |", changes.falls);
    (falls, cycles) = (falls + changes.falls, cycles + changes.walked);
    let minutes = f64::from(cycles) * 0.02 / 60.0;
    println!("\n{falls} falls in {minutes:.1} min: {:.2} per minute", f64::from(falls) / minutes);
    Ok(())
}

/// The measurements for a command.
#[derive(Default)]
struct Row {
    real: [f64; 3],
    felt: [f64; 3],
    cycles: u32,
    falls: u32,
    /// Cycles with those of the starts.
    walked: u32,
}

impl std::fmt::Display for Row {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let seconds = f64::from(self.cycles.max(1)) * 0.02;
        let mean = |sums: [f64; 3]| rates(sums.map(|sum| sum / seconds));
        write!(f, "{} | {} | {} of {TRIALS}", mean(self.real), mean(self.felt), self.falls)
    }
}

fn rates(rates: [f64; 3]) -> String {
    rates.map(|rate| format!("{rate:+.2}")).join(" ")
}

struct Table {
    body: Booster,
    cycle: u64,
    percepts: Percepts,
}

impl Table {
    fn cycle(&mut self, command: &Actuators) -> Result<[f64; 3], Box<dyn std::error::Error>> {
        self.cycle += 1;
        let now = Timestamp::from_nanos(self.cycle * 20_000_000);
        self.body.sense(now, &mut self.percepts)?;
        self.body.act(now, command)?;
        let sensors = &self.percepts.sensors;
        Ok([sensors.odometry_x, sensors.odometry_y, sensors.odometry_turn])
    }

    /// Puts the robot up and has it stand.
    fn stand(&mut self, trial: u32) -> Result<(), Box<dyn std::error::Error>> {
        let height = (self.body.robot().straight_height() * 100.0).ceil() / 100.0;
        let (team, at) = ("Monas".to_owned(), [-12.0, 5.0, height]);
        // The walk commands the joints of a robot that is placed while walking.
        for _ in 0..STAND_CYCLES {
            self.cycle(&Actuators::default())?;
        }
        self.body.instruct(Command::PlaceRobot { team, number: 2, at, heading: 0.0 });
        for _ in 0..STAND_CYCLES + trial * TRIAL_OFFSET {
            self.cycle(&Actuators::default())?;
        }
        Ok(())
    }

    /// Walks until the robot falls; speeds are added to one row, time and falls to both.
    fn walk(
        &mut self,
        [x, y, turn]: [f64; 3],
        cycles: u32,
        speeds: &mut Row,
        falls: &mut Row,
    ) -> Result<(), Box<dyn std::error::Error>> {
        let command = Actuators { walk_x: x, walk_y: y, walk_turn: turn, ..Actuators::default() };
        if self.body.is_fallen() {
            return Ok(());
        }
        for _ in 0..cycles {
            let ([x, y, _], heading) = (self.body.true_position(), self.body.true_heading());
            let step = self.cycle(&command)?;
            for row in [&mut *speeds, &mut *falls] {
                row.walked += 1;
                row.falls += u32::from(self.body.is_fallen());
            }
            if self.body.is_fallen() {
                break;
            }
            let ([to_x, to_y, _], to_heading) = (self.body.true_position(), self.body.true_heading());
            let (sin, cos) = libm::sincos(heading);
            let (dx, dy) = (to_x - x, to_y - y);
            speeds.real[0] += cos * dx + sin * dy;
            speeds.real[1] += cos * dy - sin * dx;
            speeds.real[2] += libm::remainder(to_heading - heading, std::f64::consts::TAU);
            (0..3).for_each(|axis| speeds.felt[axis] += step[axis]);
            speeds.cycles += 1;
        }
        Ok(())
    }
}
