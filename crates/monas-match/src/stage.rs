//! The field as the world of a simulation: it moves on, and publishes what is true.

use std::time::Duration;

use monas::{BoxError, World};
use monas_sim::messages::topics::{INCIDENT, SCORE, TRUTH};
use monas_sim::messages::{Incident, RefereeState, Score, TeamScore, TrueRobot, Truth};
use monas_sim::{GameState, Pitch, STEP};
use narukom::{Blackboard, Moment};

use crate::incidents;

/// Where everything is gets published every so many steps.
const TRUTH_EVERY: u64 = 10;

/// A pitch with a hub of its own.
pub(crate) struct Stage {
    pitch: Pitch,
    seen_events: usize,
    score: Score,
}

impl Stage {
    pub(crate) fn new(pitch: Pitch) -> Stage {
        Stage { pitch, seen_events: 0, score: Score::default() }
    }

    fn tell(&mut self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        let Stage { pitch, seen_events, score } = self;
        pitch.look(|world| {
            if world.steps() % TRUTH_EVERY == 0 {
                blackboard.publish(TRUTH, truth(world))?;
            }
            for event in incidents::since(world, *seen_events) {
                blackboard.publish(INCIDENT, Incident { text: event.text })?;
            }
            *seen_events = world.events().len();
            let board = board(world);
            if board != *score {
                *score = board.clone();
                blackboard.publish(SCORE, board)?;
            }
            Ok(())
        })
    }
}

impl World for Stage {
    fn name(&self) -> &str {
        "field"
    }

    fn period(&self) -> Duration {
        Duration::from_secs_f64(STEP)
    }

    fn start(&mut self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        self.tell(blackboard)
    }

    fn advance(&mut self, _now: Moment, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        self.pitch.step();
        self.tell(blackboard)
    }
}

fn truth(world: &monas_sim::World) -> Truth {
    let ball = world.ball();
    let robots = world.robots().iter().map(|robot| TrueRobot {
        team: world.teams()[robot.team].number.into(),
        number: robot.number.into(),
        x: robot.pose.position.x,
        y: robot.pose.position.y,
        heading: robot.pose.heading,
        on_field: robot.on_field,
        upright: robot.phase.is_upright(),
    });
    Truth {
        ball_x: ball.position.x,
        ball_y: ball.position.y,
        ball_vx: ball.velocity.x,
        ball_vy: ball.velocity.y,
        robots: robots.collect(),
    }
}

fn board(world: &monas_sim::World) -> Score {
    let referee = world.referee();
    let teams = world.teams().iter().enumerate().map(|(index, team)| TeamScore {
        team: team.number.into(),
        name: team.name.clone(),
        goals: referee.score()[index],
    });
    Score { state: state(referee.state()) as i32, half: referee.half().into(), teams: teams.collect() }
}

fn state(state: GameState) -> RefereeState {
    match state {
        GameState::Initial => RefereeState::Initial,
        GameState::Ready => RefereeState::Ready,
        GameState::Set => RefereeState::Set,
        GameState::Playing => RefereeState::Playing,
        GameState::Finished => RefereeState::Finished,
    }
}
