//! The field as the world of a simulation: advances it and publishes the ground truth.

use std::time::Duration;

use monas::{BoxError, World};
use monas_sim::messages::referee_call::Kind;
use monas_sim::messages::topics::{INCIDENT, REFEREE, SCORE, TRUTH};
use monas_sim::messages::{Incident, RefereeCall, RefereeState, Score, TeamScore, TrueRobot, Truth};
use monas_sim::{GameState, STEP, SharedField, SimulatedWorld};
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

    /// Lets the referee decide what a person has called. A recording has the calls like all other
    /// messages, and refusals as incidents.
    fn take_calls(&self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        let calls: Vec<RefereeCall> = blackboard.signals(REFEREE).map(|call| *call.message).collect();
        for call in calls {
            if let Err(reason) = self.pitch.change(|world| carry_out(world, &call)) {
                let kind = call.kind().as_str_name();
                let text = format!("refused call {kind}: {reason}");
                blackboard.publish(INCIDENT, Incident { text })?;
            }
        }
        Ok(())
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
        self.take_calls(blackboard)?;
        self.pitch.step();
        if let Some(league) = &self.league {
            for text in league.exchange(&self.pitch, now)? {
                blackboard.publish(INCIDENT, Incident { text })?;
            }
        }
        self.publish_state(blackboard)
    }
}

fn carry_out(world: &mut SimulatedWorld, call: &RefereeCall) -> Result<(), String> {
    use monas_sim::RefereeCall as Call;
    let robot = || {
        let is_meant = |robot: &monas_sim::RobotState| {
            (u32::from(world.teams()[robot.team].number), u32::from(robot.number)) == (call.team, call.number)
        };
        let found = world.robots().iter().position(is_meant);
        found.ok_or_else(|| format!("no robot has the number {} of team {}", call.number, call.team))
    };
    let call = match call.kind() {
        Kind::None => return Err("nothing is called".into()),
        Kind::Ready => Call::Ready,
        Kind::Set => Call::Set,
        Kind::Play => Call::Play,
        Kind::EndHalf => Call::EndHalf,
        Kind::Stop => Call::Stop,
        Kind::Resume => Call::Resume,
        Kind::DropBall => Call::DropBall,
        Kind::Penalize => Call::Penalize(robot()?),
        Kind::Return => Call::Return(robot()?),
    };
    world.call(call).map_err(|error| error.to_string())
}

fn truth(world: &SimulatedWorld) -> Truth {
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

fn board(world: &SimulatedWorld) -> Score {
    let referee = world.referee();
    let teams = world.teams().iter().enumerate().map(|(index, team)| TeamScore {
        team: team.number.into(),
        name: team.name.clone(),
        goals: referee.score()[index],
    });
    Score {
        state: state(referee.state()) as i32,
        half: referee.half().into(),
        teams: teams.collect(),
        stopped: referee.is_stopped(),
    }
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
