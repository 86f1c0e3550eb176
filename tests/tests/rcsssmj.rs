//! An attacker on the RoboCup MuJoCo soccer server, if the program `rcssservermj` is there.
//!
//! The attacker walks by the policy whose weights `MONAS_T1_POLICY` names. How often it scores is
//! counted with `MONAS_T1_RUNS=10 cargo test -p monas-tests --test rcsssmj -- --nocapture`.

#![allow(clippy::unwrap_used)] // tests may panic

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;

use monas::{Registry, Simulation, Talws};
use monas_rcsssmj as _; // the body registers itself at link time
use monas_robot::topics::ANNOUNCEMENT;
use monas_soccer::topics::{BALL, POSE};
use narukom::{Blackboard, Timestamp};
use yase::Source;

const CONFIGURATION: &str = "../config/rcsssmj.xml";
/// The longest run, s.
const LONGEST: u64 = 300;

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

/// The file of weights; says so if there is none.
fn policy() -> Option<PathBuf> {
    let named = std::env::var_os("MONAS_T1_POLICY").map(PathBuf::from);
    if named.is_none() {
        eprintln!("\n!! SKIPPED: MONAS_T1_POLICY names no file of weights for the walk\n");
    }
    named
}

/// A run with the policy.
struct Run {
    simulation: Simulation,
    blackboard: Blackboard,
}

impl Run {
    fn new(policy: &Path, seed: u64) -> Run {
        let text = std::fs::read_to_string(CONFIGURATION).unwrap();
        let text = text.replace("<body ", &format!("<body policy=\"{}\" ", policy.display()));
        let source = Arc::new(Source::new("rcsssmj.xml", text));
        let (setup, diagnostics) = monas_config::read(&source, Path::new(CONFIGURATION), &Registry::linked());
        assert!(diagnostics.is_empty(), "{diagnostics:#?}");
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
        (1..=LONGEST).find(|second| {
            self.run_until(*second);
            self.blackboard.read(ANNOUNCEMENT).unwrap().own_score > 0
        })
    }

    /// Where the attacker believes the ball on the field, towards the goal to attack, m.
    fn ball_x(&self) -> f64 {
        let (pose, ball) = (self.blackboard.read(POSE).unwrap(), self.blackboard.read(BALL).unwrap());
        (pose.field_from_robot() * ball.position()).x
    }
}

#[test]
fn the_attacker_brings_the_ball_towards_the_goal_on_the_soccer_server() {
    let Some(policy) = has_server().then(policy).flatten() else { return };
    let mut run = Run::new(&policy, 1);
    run.run_until(60);
    let x = run.ball_x();
    println!("after a minute the ball is {x:.1} m towards the goal");
    assert!(x > 3.0, "the ball is at {x}");
}

#[test]
fn the_attacker_scores_on_the_soccer_server() {
    let Ok(runs) = std::env::var("MONAS_T1_RUNS") else { return };
    let Some(policy) = has_server().then(policy).flatten() else { return };
    let runs: u64 = runs.parse().unwrap();
    let goals: Vec<Option<u64>> = (1..=runs).map(|seed| Run::new(&policy, seed).first_goal()).collect();
    println!("the first goal of each run, s: {goals:?}");
    let scored = goals.iter().flatten().count() as u64;
    assert!(10 * scored >= 7 * runs, "{scored} of {runs} runs with a goal");
}
