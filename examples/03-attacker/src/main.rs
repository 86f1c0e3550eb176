//! The attacker's decisions, without a field and without a robot: given the position of the ball,
//! which activity is called.
//!
//! Run it with `cargo run -p example-attacker`. The role is `models/attacker.srm`, as it plays in a
//! match, with the activities of `monas-soccer`. There are no sensors and no motion: the program
//! publishes the posture of the robot, the state of the game and the position of the ball, advances
//! simulated time by a second, and queries which activity was called.
//!
//! The guards of the chart choose activities, not other activities. The decision of a role can
//! therefore be tested like a function (in `tests.rs`, next to this file): without threads, without
//! sleeping, message in and activity out.

use monas::{Agent, BoxError, Talws, Timestamp};
use monas_robot::{Announcement, GamePhase, topics::ANNOUNCEMENT};
use monas_soccer::{Ball, MotionPhase, MotionState, topics};
use yase::Source;

const CHOICES: [&str; 5] = ["SearchBall", "WalkTowardsBall", "AlignWithBall", "LeftKick", "RightKick"];

/// A ball seen at `x` metres ahead and `y` metres to the left.
fn seen(x: f64, y: f64) -> Ball {
    Ball { found: true, x, y, distance: (x * x + y * y).sqrt(), ..Ball::default() }
}

/// The activities that the attacker chooses for a phase of the game and a ball.
fn choices(phase: GamePhase, ball: Ball) -> Result<Vec<&'static str>, BoxError> {
    let model = Source::new("attacker.srm", include_str!("../../../models/attacker.srm"));
    let (attacker, findings) = aseme::statechart_of_role(&model);
    if let Some(finding) = findings.first() {
        return Err(finding.to_string().into());
    }
    let mut simulation = Talws::new().agent(Agent::statechart("attacker", attacker)).simulate(7)?;
    let hub = simulation.hub(Talws::LOCAL).ok_or("no hub")?;
    let stands = MotionState { phase: MotionPhase::Standing.into(), ..MotionState::default() };
    hub.publisher(topics::MOTION_STATE, "body")?.publish(stands, Timestamp::ZERO);
    let announcement = Announcement { phase: phase.into(), ..Announcement::default() };
    hub.publisher(ANNOUNCEMENT, "referee")?.publish(announcement, Timestamp::ZERO);
    hub.publisher(topics::BALL, "eyes")?.publish(ball, Timestamp::ZERO);
    simulation.run_until(Timestamp::from_secs_f64(1.0))?;
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
