//! An attacker on the RoboCup MuJoCo soccer server, if the program `rcssservermj` is there.
//!
//! The attacker scores by the walking policy, whose weights `MONAS_T1_POLICY` names. How often:
//! `MONAS_T1_POLICY=t1.f32 MONAS_T1_RUNS=10 cargo test -p monas-tests --test rcsssmj -- --nocapture`
//! prints each run.

#![allow(clippy::unwrap_used)] // tests may panic

use std::path::PathBuf;
use std::process::{Command, Stdio};

use monas::{Registry, Talws};
use monas_rcsssmj as _; // the body registers itself at link time
use monas_robot::{Announcement, topics::ANNOUNCEMENT};
use monas_soccer as _; // and so do the activities
use narukom::Timestamp;

const CONFIGURATION: &str = "../config/rcsssmj.xml";
/// The longest run, s.
const LONGEST: u64 = 300;

/// Whether the server can be started; says so if it cannot.
fn has_server() -> bool {
    let help = Command::new("rcssservermj").arg("--help").stdout(Stdio::null()).stderr(Stdio::null());
    let has_server = { help }.status().is_ok_and(|status| status.success());
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

/// Plays until the attacker has scored or the time is over; when it scored, s, and the true game.
fn play(seed: u64, policy: &std::path::Path, longest: u64) -> (Option<f64>, Announcement) {
    let text = std::fs::read_to_string(CONFIGURATION).unwrap();
    let text = text.replace("<body ", &format!("<body policy=\"{}\" ", policy.display()));
    let source = std::sync::Arc::new(yase::Source::new("rcsssmj.xml", text));
    let path = std::path::Path::new(CONFIGURATION);
    let (setup, diagnostics) = monas_config::read(&source, path, &Registry::linked());
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    let talws = Talws::new().setup(setup);
    assert!(talws.has_own_time());
    let mut simulation = talws.simulate(seed).unwrap();
    let mut blackboard = simulation.hub(Talws::LOCAL).unwrap().blackboard("test");
    for second in 1..=longest {
        simulation.run_until(Timestamp::from_secs_f64(second as f64)).unwrap();
        blackboard.process_messages(simulation.now());
        let game = *blackboard.read(ANNOUNCEMENT).unwrap();
        if game.own_score > 0 || second == longest {
            return ((game.own_score > 0).then_some(second as f64), game);
        }
    }
    unreachable!("the last second returns")
}

#[test]
fn the_attacker_scores_on_the_soccer_server() {
    let Some(policy) = has_server().then(policy).flatten() else { return };
    let runs: u64 = std::env::var("MONAS_T1_RUNS").map_or(1, |runs| runs.parse().unwrap());
    let mut scored = 0;
    for seed in 1..=runs {
        let (at, game) = play(seed, &policy, LONGEST);
        println!("run {seed}: {} : {}, first goal after {at:?} s", game.own_score, game.opponent_score);
        scored += u64::from(at.is_some());
    }
    println!("{scored} of {runs} runs with a goal");
    assert!(2 * scored >= runs, "{scored} of {runs} runs with a goal");
}
