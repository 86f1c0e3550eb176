//! Players on the RoboCup MuJoCo soccer server, if the program `rcssservermj` is there.
//!
//! They walk by the project's own walk, or by the policy whose weights `MONAS_T1_POLICY` names. How
//! often the attacker scores is counted with `MONAS_T1_RUNS=10 cargo test -p monas-tests --test
//! play scores -- --nocapture`, and `MONAS_K1_RUNS=10` counts for a K1.

#![allow(clippy::unwrap_used)] // tests may panic

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;

use monas::{Registry, Simulation, Talws};
use monas_rcsssmj::Server; // the body registers itself at link time
use monas_rcsssmj::monitor::{Command as Instruction, Monitor};
use monas_robot::topics::ANNOUNCEMENT;
use monas_soccer::topics::{BALL, POSE};
use narukom::{Blackboard, Timestamp};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use yase::Source;

const ATTACKER: &str = "../config/rcsssmj.xml";
const K1_ATTACKER: &str = "../config/rcsssmj_k1.xml";
const GOALIE: &str = "../config/rcsssmj_goalie.xml";
/// The longest run, s.
const MAX_RUN: u64 = 300;

/// Whether the server can be started; says so if it cannot.
fn has_server() -> bool {
    let mut help = Command::new("rcssservermj");
    help.arg("--help").current_dir(std::env::temp_dir()).stdout(Stdio::null()).stderr(Stdio::null());
    let has_server = help.status().is_ok_and(|status| status.success());
    if !has_server {
        eprintln!("\n!! SKIPPED: no rcssservermj in PATH; `pip install rcsssmj==0.2.1` brings it\n");
    }
    has_server
}

/// A run of the configuration.
struct Run {
    simulation: Simulation,
    blackboard: Blackboard,
}

impl Run {
    /// With further attributes of the body.
    fn new(configuration: &str, seed: u64, attributes: &str) -> Run {
        let mut attributes = attributes.to_owned();
        if let Ok(policy) = std::env::var("MONAS_T1_POLICY") {
            attributes += &format!(" policy=\"{policy}\"");
        }
        let text = std::fs::read_to_string(configuration).unwrap();
        let source =
            Arc::new(Source::new("rcsssmj.xml", text.replace("<body ", &format!("<body {attributes} "))));
        let (setup, diagnostics) = monas_config::read(&source, Path::new(configuration), &Registry::linked());
        // The limits of the body are information.
        assert!(!diagnostics.iter().any(|found| found.is_error()), "{diagnostics:#?}");
        let talws = Talws::new().setup(setup);
        assert!(talws.has_own_time());
        let simulation = talws.simulate(seed).unwrap();
        let blackboard = simulation.hub(Talws::LOCAL).unwrap().blackboard("test");
        Run { simulation, blackboard }
    }

    fn run_until(&mut self, second: u64) {
        self.simulation.run_until(Timestamp::from_secs_f64(second as f64)).unwrap();
        self.blackboard.process_messages(self.simulation.now());
    }

    /// When the attacker has scored for the first time, s.
    fn first_goal(&mut self) -> Option<u64> {
        (1..=MAX_RUN).find(|second| {
            self.run_until(*second);
            self.blackboard.read(ANNOUNCEMENT).unwrap().own_score > 0
        })
    }

    /// The attacker's belief about itself and the ball on the field, which it attacks along x: x
    /// and y, m, heading, rad, and x and y of the ball.
    fn scene(&self) -> [f64; 5] {
        let (pose, ball) = (self.blackboard.read(POSE).unwrap(), self.blackboard.read(BALL).unwrap());
        let ball = pose.field_from_robot() * ball.position();
        [pose.x, pose.y, pose.heading, ball.x, ball.y]
    }
}

/// The half of the field with the goal that is attacked from above, as an animated SVG of scenes,
/// ten of them in each second. Lines show the whole ways.
fn film(scenes: &[[f64; 5]]) -> String {
    let line = |x: usize, y: usize| {
        let points = scenes.iter().map(|scene| format!("{:.2},{:.2}", scene[x], -scene[y]));
        points.collect::<Vec<_>>().join(" ")
    };
    let seconds = scenes.len() as f64 / 10.0;
    let motion = |kind: &str, values: Vec<String>| {
        format!(
            r#"<animateTransform attributeName="transform" type="{kind}" dur="{seconds}s" repeatCount="indefinite" values="{}"/>"#,
            values.join(";")
        )
    };
    let moves = |x: usize, y: usize| {
        motion("translate", scenes.iter().map(|scene| format!("{:.2} {:.2}", scene[x], -scene[y])).collect())
    };
    let turns = scenes.iter().map(|scene| format!("{:.0}", -scene[2].to_degrees())).collect();
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="-4 -10 35 20" width="1050" height="600">
<rect x="-4" y="-10" width="35" height="20" fill="#4a7c4a"/>
<g fill="none" stroke="#fff" stroke-width="0.1">
<path d="M0 -10V10M27.5 -10V10M27.5 -3.65H23.5V3.65H27.5M27.5 -8.25H18.5V8.25H27.5"/>
<circle r="5.5"/><path d="M27.5 -1.83H28.5V1.83H27.5" stroke="#ff0" stroke-width="0.16"/>
</g>
<polyline points="{}" fill="none" stroke="#f90" stroke-width="0.08"/>
<polyline points="{}" fill="none" stroke="#9cf" stroke-width="0.08"/>
<g>{}<g>{}<path d="M0.4 0L-0.3 0.3V-0.3Z" fill="#06c" stroke="#fff" stroke-width="0.06"/></g></g>
<circle r="0.2" fill="#f60" stroke="#fff" stroke-width="0.06">{}</circle>
</svg>
"##,
        line(3, 4),
        line(0, 1),
        moves(0, 1),
        motion("rotate", turns),
        moves(3, 4),
    )
}

/// Writes a film of a run until its first goal to the file that `MONAS_T1_FILM` names.
#[test]
fn a_film_of_a_goal_on_the_soccer_server() {
    let Some(file) = std::env::var_os("MONAS_T1_FILM") else { return };
    if !has_server() {
        return;
    }
    let mut run = Run::new(ATTACKER, 1, "");
    let mut scenes = Vec::new();
    let goal = (1..=MAX_RUN).find(|second| {
        run.run_until(*second);
        let scored = run.blackboard.read(ANNOUNCEMENT).unwrap().own_score > 0;
        if !scored && run.blackboard.read(BALL).is_some() {
            scenes.push(run.scene());
        }
        scored
    });
    println!("a goal after {goal:?} s");
    std::fs::write(file, film(&scenes)).unwrap();
    assert!(goal.is_some(), "no goal");
}

#[test]
fn the_attacker_brings_the_ball_towards_the_goal_on_the_soccer_server() {
    if !has_server() {
        return;
    }
    let mut run = Run::new(ATTACKER, 1, "");
    run.run_until(60);
    let x = run.scene()[3];
    println!("after a minute the ball is {x:.1} m towards the goal");
    assert!(x > 8.0, "the ball is at {x}");
}

#[test]
fn the_attacker_scores_on_the_soccer_server() {
    scores(ATTACKER, "MONAS_T1_RUNS");
}

#[test]
fn a_k1_scores_on_the_soccer_server() {
    scores(K1_ATTACKER, "MONAS_K1_RUNS");
}

/// Counts the runs with a goal, of as many as a variable of the environment says.
fn scores(configuration: &str, variable: &str) {
    let Ok(runs) = std::env::var(variable) else { return };
    if !has_server() {
        return;
    }
    let runs: u64 = runs.parse().unwrap();
    let first_goal = |seed| {
        // Runs with one start are equal: they differ by where the robot begins.
        let mut chance = Pcg32::seed_from_u64(seed);
        let mut share = || f64::from(chance.next_u32()) / f64::from(u32::MAX);
        let start = format!("start_x=\"{:.2}\" start_y=\"{:.2}\"", -1.5 - 2.0 * share(), 6.0 * share() - 3.0);
        let goal = Run::new(configuration, seed, &start).first_goal();
        println!("with {start}: {goal:?}");
        goal
    };
    let goals: Vec<Option<u64>> = (1..=runs).map(first_goal).collect();
    println!("the first goal of each run, s: {goals:?}");
    let scored = goals.iter().flatten().count() as u64;
    assert!(10 * scored >= 8 * runs, "{scored} of {runs} runs with a goal");
}

/// Shots, and how many of them a goalie has to save.
const SHOTS: u32 = 10;
const MIN_SAVES: u32 = 7;
/// The position of the ball before a shot, m: ahead, and at most to a side.
const SHOT_POSITION: (f64, f64) = (-20.5, 0.7);
/// The speed of a shot, m/s: it slows down to about 1 m/s at the goal line.
const SHOT_SPEED: f64 = 4.1;
/// The goal line, m, and how far from its middle shots cross it at most.
const GOAL_LINE: f64 = -27.5;
const MAX_LATERAL: f64 = 0.5;
/// The ball keeps its speed to the side longer than that ahead: the server's friction acts along
/// axes. It comes by so much farther to the side than a straight line.
const LATERAL_DRIFT: f64 = 1.75;
/// Seconds that the goalie has to take its place, and those in which a shot comes to its end.
const PLACING_SECONDS: u64 = 8;
const ROLLING_SECONDS: u64 = 6;

/// Lets the ball lie and then roll; returns whether the goal was hit.
fn shoot(run: &mut Run, server: &mut Monitor, second: &mut u64, y: f64, to: f64) -> bool {
    let at = [SHOT_POSITION.0, y, 0.11];
    server.send(&Instruction::DropBall).unwrap();
    server.send(&Instruction::PlaceBall { at, velocity: [0.0; 3] }).unwrap();
    let mut pass = |run: &mut Run, server: &mut Monitor, seconds: u64| {
        for _ in 0..seconds {
            *second += 1;
            run.run_until(*second);
            server.drain().unwrap();
        }
    };
    pass(run, server, PLACING_SECONDS);
    let before = run.blackboard.read(ANNOUNCEMENT).unwrap().opponent_score;
    let (x, y) = (GOAL_LINE - at[0], (to - at[1]) / LATERAL_DRIFT);
    let length = libm::hypot(x, y);
    let velocity = [SHOT_SPEED * x / length, SHOT_SPEED * y / length, 0.0];
    server.send(&Instruction::DropBall).unwrap();
    server.send(&Instruction::PlaceBall { at, velocity }).unwrap();
    pass(run, server, ROLLING_SECONDS);
    run.blackboard.read(ANNOUNCEMENT).unwrap().opponent_score > before
}

#[test]
fn a_goalie_stays_between_ball_and_goal_and_saves_slow_shots() {
    if !crate::is_long() {
        println!("skipped: the shots are played with MONAS_LONG_TESTS=1");
        return;
    }
    if !has_server() {
        return;
    }
    let mut server = Server::start(None, true).unwrap();
    let mut monitor = server.monitor().unwrap();
    let addresses = format!("address=\"{}\" monitor=\"{}\"", server.agents(), server.monitors());
    let mut run = Run::new(GOALIE, 1, &addresses);
    let (mut chance, mut second) = (Pcg32::seed_from_u64(1), 0);
    let mut saved = 0;
    for shot in 0..SHOTS {
        let mut share = || 2.0 * f64::from(chance.next_u32()) / f64::from(u32::MAX) - 1.0;
        let (from, to) = (SHOT_POSITION.1 * share(), MAX_LATERAL * share());
        let is_goal = shoot(&mut run, &mut monitor, &mut second, from, to);
        let pose = run.blackboard.read(POSE).unwrap();
        println!(
            "shot {shot} from {from:.2} to {to:.2}: goal {is_goal}; goalie at {:.2} {:.2}",
            pose.x, pose.y
        );
        saved += u32::from(!is_goal);
    }
    // Shots at the empty goal are goals, those that cross the line outermost, too.
    let (team, at) = ("Monas".to_owned(), [0.0, 10.0, 0.68]);
    monitor.send(&Instruction::PlaceRobot { team, number: 1, at, heading: 0.0 }).unwrap();
    for to in [-MAX_LATERAL, 0.0, MAX_LATERAL] {
        assert!(shoot(&mut run, &mut monitor, &mut second, SHOT_POSITION.1, to), "an empty goal, {to}");
    }
    println!("{saved} of {SHOTS} shots saved");
    assert!(saved >= MIN_SAVES, "{saved} of {SHOTS} saved");
}
