//! The attacker's decision, without a field and without a robot: the ball lies here, so the attacker does that.
//!
//! Run it with `cargo run -p example-attacker`. The role is `models/attacker.srm`, as it plays in a match, with the activities of
//! `monas-soccer`. Nobody senses and nothing moves: the program publishes on the hub that the robot stands, what the referee says
//! and where the ball is seen, lets a second pass in simulated time, and asks which activity was called.
//!
//! No activity chooses another one; the guards of the chart do. That is why the decision of a role can be tested like a function
//! (in `tests.rs`, next to this file): without threads, without sleeping, message in and activity out.

use monas::{Agent, BoxError, Moment, Talws};
use monas_robot::{Announcement, GamePhase, topics::ANNOUNCEMENT};
use monas_soccer::{Ball, MotionPhase, MotionState, topics};
use yase::Source;

const CHOICES: [&str; 5] = ["SearchBall", "WalkTowardsBall", "AlignWithBall", "LeftKick", "RightKick"];

/// A ball that the robot sees so many metres ahead and to the left.
fn seen(x: f64, y: f64) -> Ball {
    Ball { found: true, x, y, distance: (x * x + y * y).sqrt(), ..Ball::default() }
}

/// What the attacker does in such a phase of the game when it learns of such a ball.
fn choices(phase: GamePhase, ball: Ball) -> Result<Vec<&'static str>, BoxError> {
    let model = Source::new("attacker.srm", include_str!("../../../models/attacker.srm"));
    let (attacker, findings) = aseme::statechart_of(&model);
    if let Some(finding) = findings.first() {
        return Err(finding.to_string().into());
    }
    let mut simulation = Talws::new().agent(Agent::statechart("attacker", attacker)).simulate(7)?;
    let hub = simulation.hub(Talws::LOCAL).ok_or("no hub")?;
    let stands = MotionState { phase: MotionPhase::Standing.into(), ..MotionState::default() };
    hub.publisher(topics::MOTION_STATE, "body")?.publish(stands, Moment::ZERO);
    let announcement = Announcement { phase: phase.into(), ..Announcement::default() };
    hub.publisher(ANNOUNCEMENT, "referee")?.publish(announcement, Moment::ZERO);
    hub.publisher(topics::BALL, "eyes")?.publish(ball, Moment::ZERO);
    simulation.run_until(Moment::from_secs_f64(1.0))?;
    let statistics = simulation.statistics();
    Ok(CHOICES.into_iter().filter(|activity| statistics.calls(Talws::LOCAL, activity) > 0).collect())
}

fn main() -> Result<(), BoxError> {
    println!("ahead   to the left   so the attacker does");
    println!("   nowhere in sight   {}", choices(GamePhase::Playing, Ball::default())?.join(", "));
    for (x, y) in [(2.0, 0.5), (0.24, 0.0), (0.15, 0.05), (0.15, -0.05)] {
        println!("{x:>5.2} {y:>13.2}   {}", choices(GamePhase::Playing, seen(x, y))?.join(", "));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
