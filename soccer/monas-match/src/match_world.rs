//! The field as the world of a simulation: advances it and publishes the ground truth.

use std::time::Duration;

use monas::{BoxError, World};
use monas_sim::messages::topics::{INCIDENT, SCORE, TRUTH};
use monas_sim::messages::{Incident, RefereeState, Score, TeamScore, TrueRobot, Truth};
use monas_sim::{GameState, STEP, SharedField};
use narukom::{Blackboard, Timestamp};

use crate::league::League;
use crate::match_events;

/// Steps between two messages of ground truth.
const TRUTH_EVERY: u64 = 10;

/// A shared field with its own hub.
pub(crate) struct MatchWorld {
    pitch: SharedField,
    seen_events: usize,
    score: Score,
    league: Option<League>,
}

impl MatchWorld {
    pub(crate) fn new(pitch: SharedField, league: Option<League>) -> MatchWorld {
        MatchWorld { pitch, seen_events: 0, score: Score::default(), league }
    }

    fn publish_state(&mut self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        let MatchWorld { pitch, seen_events, score, .. } = self;
        pitch.with_world(|world| {
            if world.steps() % TRUTH_EVERY == 0 {
                blackboard.publish(TRUTH, truth(world))?;
            }
            for event in match_events::since(world, *seen_events) {
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

impl World for MatchWorld {
    fn name(&self) -> &str {
        "field"
    }

    fn period(&self) -> Duration {
        Duration::from_secs_f64(STEP)
    }

    fn start(&mut self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        self.publish_state(blackboard)
    }

    fn advance(&mut self, now: Timestamp, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        self.pitch.step();
        if let Some(league) = &self.league {
            for text in league.exchange(&self.pitch, now)? {
                blackboard.publish(INCIDENT, Incident { text })?;
            }
        }
        self.publish_state(blackboard)
    }
}

fn truth(world: &monas_sim::SimulatedWorld) -> Truth {
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

fn board(world: &monas_sim::SimulatedWorld) -> Score {
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
