//! Measures the walks: what is commanded and what the robot does, as a table.
//!
//! ```text
//! cargo run -p monas-rcsssmj --example walk_table [-- POLICY]
//! ```
//!
//! The program `rcssservermj` has to be in PATH. With a file of weights the policy walks, without
//! one the own walk. Each row is one trial of twelve seconds, of which two are for the start. True
//! speeds are those that the server says, felt ones those of the odometry.

use std::collections::BTreeMap;

use monas_rcsssmj::T1;
use monas_robot::{Actuators, BodySite, Percepts, Robot};
use narukom::Timestamp;

/// Speeds ahead, to the left, and rates of turning.
const POLICY: [[f64; 3]; 11] = [
    [0.0, 0.0, 0.0],
    [0.25, 0.0, 0.0],
    [0.5, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [-0.4, 0.0, 0.0],
    [0.0, 0.0, 0.5],
    [0.0, 0.0, -1.0],
    [0.5, 0.0, 0.5],
    [0.8, 0.0, -0.8],
    [0.3, 0.2, 0.0],
    [0.0, 0.2, -0.5],
];
const OWN: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [0.15, 0.0, 0.0],
    [0.25, 0.0, 0.0],
    [0.42, 0.0, 0.0],
    [0.0, 0.0, 0.45],
    [0.0, 0.0, -0.2],
    [0.2, 0.0, -0.45],
    [0.42, 0.0, 0.2],
];

/// Cycles of the start and of the measurement.
const START: u32 = 100;
const MEASURED: u32 = 500;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let policy = std::env::args().nth(1);
    let commands: &[[f64; 3]] = if policy.is_some() { &POLICY } else { &OWN };
    let mut options = BTreeMap::from([("kick_off".to_owned(), "0".to_owned())]);
    options.extend(policy.map(|file| ("policy".to_owned(), file)));
    let site = BodySite { options, ..BodySite::default() };
    let mut trial = Trial { body: monas_rcsssmj::open(&site)?, cycle: 0, percepts: Percepts::default() };
    println!("| commanded x, y, turn | true x, y, turn | felt x, y, turn | fell after |");
    println!("|---|---|---|---|");
    for command in commands {
        trial.run(*command)?;
    }
    Ok(())
}

struct Trial {
    body: T1,
    cycle: u64,
    percepts: Percepts,
}

impl Trial {
    fn cycle(&mut self, command: &Actuators) -> Result<[f64; 3], Box<dyn std::error::Error>> {
        self.cycle += 1;
        let now = Timestamp::from_nanos(self.cycle * 20_000_000);
        self.body.sense(now, &mut self.percepts)?;
        self.body.act(now, command)?;
        let sensors = &self.percepts.sensors;
        Ok([sensors.odometry_x, sensors.odometry_y, sensors.odometry_turn])
    }

    /// Puts the robot up, has it walk, and prints a row.
    fn run(&mut self, [x, y, turn]: [f64; 3]) -> Result<(), Box<dyn std::error::Error>> {
        let stand = Actuators::default();
        // Who is placed while walking has its joints moved by the commands of the walk.
        for _ in 0..START {
            self.cycle(&stand)?;
        }
        if let Some(monitor) = self.body.monitor() {
            monitor.place_robot("Monas", 2, [-12.0, 5.0, 0.68], 0.0)?;
        }
        for _ in 0..START {
            self.cycle(&stand)?;
        }
        let command = Actuators { walk_x: x, walk_y: y, walk_turn: turn, ..stand };
        for _ in 0..START {
            self.cycle(&command)?;
        }
        let (mut real, mut felt, mut cycles) = ([0.0; 3], [0.0; 3], 0);
        while cycles < MEASURED && !self.body.is_fallen() {
            let ([x, y, _], heading) = (self.body.true_position(), self.body.true_heading());
            let step = self.cycle(&command)?;
            let ([to_x, to_y, _], to_heading) = (self.body.true_position(), self.body.true_heading());
            let (sin, cos) = libm::sincos(heading);
            let (dx, dy) = (to_x - x, to_y - y);
            real[0] += cos * dx + sin * dy;
            real[1] += cos * dy - sin * dx;
            real[2] += libm::remainder(to_heading - heading, std::f64::consts::TAU);
            (0..3).for_each(|axis| felt[axis] += step[axis]);
            cycles += 1;
        }
        let seconds = f64::from(cycles.max(1)) * 0.02;
        let rates = |sums: [f64; 3]| sums.map(|sum| format!("{:+.2}", sum / seconds)).join(" ");
        let fell = if self.body.is_fallen() { format!("{seconds:.1} s") } else { "-".to_owned() };
        println!("| {x} {y} {turn} | {} | {} | {fell} |", rates(real), rates(felt));
        Ok(())
    }
}
