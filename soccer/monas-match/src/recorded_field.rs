//! Pictures of the field from the recording of a match.

use std::path::Path;
use std::time::Duration;

use monas::Timestamp;
use monas::config::Layers;
use monas_sim::messages::topics::{SCORE, TRUTH};
use monas_sim::messages::{RefereeState, Score, Truth};
use monas_sim::{FieldGeometry, FieldMoment, FieldSide, PicturedRobot, Pose, TeamColour, Vector};
use monas_soccer::Ball;
use monas_soccer::topics::BALL;
use monas_tape::Recording;
use prost::Message;
use yase::Diagnostic;

use crate::error::Error;
use crate::file;

/// The longest time between two messages with the ground truth.
const TRUTH_PERIOD: Duration = Duration::from_millis(100);

/// The field of a recorded match and its teams, for pictures.
#[derive(Debug)]
pub struct RecordedField {
    geometry: FieldGeometry,
    /// In the order of their numbers.
    teams: [RecordedTeam; 2],
    switches_colours: bool,
}

#[derive(Debug)]
struct RecordedTeam {
    number: u32,
    name: String,
    /// The prefix of its hosts.
    host: String,
    colour: TeamColour,
    plays: FieldSide,
}

impl RecordedField {
    /// Reads the match file of a recording. Roles are not read.
    ///
    /// # Errors
    /// The diagnostics of the match file and the files with the field and the rules.
    pub fn load(path: &Path, layers: &Layers) -> Result<RecordedField, Vec<Diagnostic>> {
        let mut found = Vec::new();
        let read = file::read(path, layers, &mut found);
        let Some(file) = read.filter(|_| !found.iter().any(Diagnostic::is_error)) else { return Err(found) };
        let mut setups: Vec<_> = file.teams.into_iter().map(|team| team.setup).collect();
        setups.sort_by_key(|setup| setup.number);
        let team = |setup: monas_sim::TeamSetup| RecordedTeam {
            number: setup.number.into(),
            host: file::host_name(&setup.name),
            name: setup.name,
            colour: setup.colour,
            plays: setup.plays,
        };
        let teams: Vec<RecordedTeam> = setups.into_iter().map(team).collect();
        let switches_colours = file.rules.switches_colours();
        match teams.try_into() {
            Ok(teams) => Ok(RecordedField { geometry: file.geometry, teams, switches_colours }),
            Err(_) => Err(found),
        }
    }

    /// The field at these times of the run, in increasing order, as SVG; several times are an
    /// animation.
    ///
    /// # Errors
    /// The recording cannot be read, has no match, or does not cover a time.
    pub fn draw(&self, recording: &Recording, times: &[Duration]) -> Result<String, Error> {
        let mut state = FieldState { field: self, truth: None, score: None, balls: Vec::new(), left: None };
        let (mut moments, mut begin, mut end) = (Vec::new(), None, Duration::ZERO);
        let mut wanted = times.iter().copied().peekable();
        for message in recording.messages().map_err(Error::unreadable)? {
            let message = message.map_err(Error::unreadable)?;
            let now = message.published.since(Timestamp::ZERO);
            while let Some(time) = wanted.next_if(|time| *time < now) {
                moments.extend(state.moment(time));
            }
            let channel = &message.channel;
            if channel.topic == TRUTH.path() {
                state.truth = Truth::decode(message.bytes).ok();
                begin.get_or_insert(now);
                end = now;
            } else if channel.topic == SCORE.path() {
                state.score = Score::decode(message.bytes).ok();
            } else if channel.topic == BALL.path() && channel.received_by.is_none() {
                let ball = Ball::decode(message.bytes).unwrap_or_default();
                state.balls.retain(|(host, _)| *host != channel.host);
                state.balls.push((channel.host.clone(), ball));
            }
        }
        for time in wanted {
            // The last state stays until the next message would have come.
            moments.extend(state.moment(time).filter(|_| time <= end + TRUTH_PERIOD));
        }
        let seconds = |time: Duration| time.as_secs_f64();
        let Some(begin) = begin else {
            return Err(Error::picture(format!(
                "the field is drawn from the topic `{}`, of which the tape has no message: draw the tape of the \
                 whole run, or keep this topic when you cut it",
                TRUTH.path()
            )));
        };
        if moments.len() < times.len() {
            let known = |time: &&Duration| **time < begin || **time > end + TRUTH_PERIOD;
            let wrong = times.iter().find(known).copied().unwrap_or_default();
            let (begin, end) = (seconds(begin), seconds(end));
            let message = format!(
                "{} s is outside of the tape, which shows the field from {begin} s to {end} s",
                seconds(wrong)
            );
            return Err(Error::picture(message));
        }
        let left = state.left.unwrap_or_default();
        let names = [left, 1 - left].map(|team| self.teams[team].name.as_str());
        Ok(monas_sim::animate_svg(&self.geometry, names, &moments))
    }
}

/// The recorded state of the field at a time.
struct FieldState<'a> {
    field: &'a RecordedField,
    truth: Option<Truth>,
    score: Option<Score>,
    /// The ball as each host believes it to be.
    balls: Vec<(String, Ball)>,
    /// The index of the team that defends the left goal in the first picture.
    left: Option<usize>,
}

impl FieldState<'_> {
    /// The field at a time; none before the first message. The left team is the first.
    fn moment(&mut self, time: Duration) -> Option<FieldMoment> {
        let truth = self.truth.as_ref()?;
        let teams = &self.field.teams;
        let half = self.score.as_ref().map_or(1, |score| score.half);
        let is_left = (teams[0].plays == FieldSide::Left) == (half < 2);
        let left = *self.left.get_or_insert(usize::from(!is_left));
        let order = [left, 1 - left];
        let robots = truth.robots.iter().filter_map(|robot| {
            let team = order.iter().position(|&team| teams[team].number == robot.team)?;
            let host = format!("{}-{}", teams[order[team]].host, robot.number);
            let pose = Pose::new(robot.x, robot.y, robot.heading);
            let ball = self.balls.iter().find(|(of, ball)| *of == host && ball.found);
            Some(PicturedRobot {
                team,
                number: u8::try_from(robot.number).ok()?,
                pose,
                on_field: robot.on_field,
                upright: robot.upright,
                believed_ball: ball.map(|(_, ball)| pose.to_outer(Vector::new(ball.x, ball.y))),
            })
        });
        let robots = robots.collect();
        let goals = |team: usize| {
            let known = self.score.iter().flat_map(|score| &score.teams);
            known.filter(|score| score.team == teams[team].number).map(|score| score.goals).sum()
        };
        let colours = order.map(|team| teams[team].colour);
        let is_switched = self.field.switches_colours && half > 1;
        let state = self.score.as_ref().map_or(RefereeState::Initial, Score::state);
        Some(FieldMoment {
            time,
            ball: Vector::new(truth.ball_x, truth.ball_y),
            robots,
            goals: order.map(goals),
            colours: if is_switched { [colours[1], colours[0]] } else { colours },
            phase: format!("half {half}, {}", state.as_str_name().to_lowercase()),
        })
    }
}
