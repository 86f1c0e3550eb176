//! The robots' end of the league's protocol: a GameController elsewhere decides.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use monas::{BoxError, Timestamp};
use monas_gamecontroller::{ControlReceiver, GameControlData, Peer, ReturnData};
use monas_robot::{Announcement, Posture, Sensors, topics as body};
use monas_sim::SharedField;
use monas_soccer::{Ball, Pose, topics};
use narukom::{Observer, Publication};

use crate::league::{LeagueEnd, LeagueJournal};

/// Time between two reports of a robot.
const REPORT_EVERY: Duration = Duration::from_secs(1);
/// Time without control data after which the GameController counts as silent.
const CONTROL_TIMEOUT: Duration = Duration::from_secs(4);
/// Metres to the packet's millimetres.
const MILLIMETRES_PER_METRE: f64 = 1000.0;

/// The robots of a match as players of the league.
pub(crate) struct LeaguePlayers {
    receiver: ControlReceiver,
    /// Team and number of each robot.
    robots: Vec<(u8, u8)>,
    beliefs: Beliefs,
    /// The GameController, and when it was heard last.
    referee: Option<(Peer, Timestamp)>,
    is_silent: bool,
    report_due: Timestamp,
}

/// The beliefs of each robot, by its host.
#[derive(Clone)]
struct Beliefs {
    hosts: Arc<[String]>,
    robots: Arc<Mutex<Vec<Belief>>>,
}

/// The belief of a robot.
#[derive(Clone, Copy, Default)]
struct Belief {
    pose: Pose,
    ball: Ball,
    is_fallen: bool,
}

impl LeaguePlayers {
    /// The robots of a field, with the names of their hosts.
    pub(crate) fn new(receiver: ControlReceiver, pitch: &SharedField, hosts: Vec<String>) -> LeaguePlayers {
        let robots = pitch.with_world(|world| {
            let identity = |robot: &monas_sim::RobotState| (world.teams()[robot.team].number, robot.number);
            world.robots().iter().map(identity).collect::<Vec<_>>()
        });
        let beliefs = Arc::new(Mutex::new(vec![Belief::default(); robots.len()]));
        LeaguePlayers {
            receiver,
            robots,
            beliefs: Beliefs { hosts: hosts.into(), robots: beliefs },
            referee: None,
            is_silent: false,
            report_due: Timestamp::ZERO,
        }
    }

    /// The observer that learns what the agents believe.
    pub(crate) fn beliefs(&self) -> Box<dyn Observer> {
        Box::new(self.beliefs.clone())
    }

    /// The announcements of control data to each robot; an error if a robot does not play.
    fn announcements(&self, control: &GameControlData) -> Result<Vec<Announcement>, String> {
        let [first, second] = control.teams.each_ref().map(|team| team.number);
        let announcement = |&(team, number): &(u8, u8)| {
            control.announcement(team, number).ok_or_else(|| {
                format!(
                    "a GameController announces teams {first} and {second}, not team {team} of this match"
                )
            })
        };
        self.robots.iter().map(announcement).collect()
    }

    fn report(&mut self, referee: Peer, now: Timestamp, journal: &mut LeagueJournal) {
        let beliefs = self.beliefs.robots.lock().unwrap_or_else(PoisonError::into_inner).clone();
        for (&(team, player), belief) in self.robots.iter().zip(&beliefs) {
            let report = belief.report(team, player, now);
            match self.receiver.report(&report, referee) {
                Ok(()) => journal.counts.reports += 1,
                Err(error) => journal.warn(format!("a robot cannot report to {referee}: {error}")),
            }
        }
    }
}

impl LeagueEnd for LeaguePlayers {
    fn exchange(
        &mut self,
        pitch: &SharedField,
        now: Timestamp,
        journal: &mut LeagueJournal,
    ) -> Result<(), BoxError> {
        for (from, control) in journal.read(|| self.receiver.receive()) {
            match self.announcements(&control) {
                Ok(announcements) => {
                    pitch.follow(announcements)?;
                    journal.counts.control += 1;
                    if self.is_silent || self.referee.is_none_or(|(referee, _)| referee != from) {
                        journal.note(format!("the GameController at {} decides", from));
                    }
                    self.referee = Some((from, now));
                    self.is_silent = false;
                }
                Err(problem) => {
                    journal.counts.refused += 1;
                    journal.warn(problem);
                }
            }
        }
        let Some((referee, heard)) = self.referee else { return Ok(()) };
        if now.since(heard) > CONTROL_TIMEOUT && !self.is_silent {
            self.is_silent = true;
            journal.note("the GameController is silent: its last decision holds");
        }
        if now >= self.report_due {
            self.report_due = now + REPORT_EVERY;
            self.report(referee, now, journal);
        }
        Ok(())
    }
}

impl Belief {
    fn report(&self, team: u8, player: u8, now: Timestamp) -> ReturnData {
        let millimetres = |metres: f64| (metres * MILLIMETRES_PER_METRE) as f32;
        let seen = (self.ball.seen_at > 0).then(|| now.since(Timestamp::from_nanos(self.ball.seen_at)));
        ReturnData {
            player,
            team,
            is_fallen: self.is_fallen,
            pose: [millimetres(self.pose.x), millimetres(self.pose.y), self.pose.heading as f32],
            ball_age: seen.map(|age| age.as_secs_f32()),
            ball: [millimetres(self.ball.x), millimetres(self.ball.y)],
        }
    }
}

impl Observer for Beliefs {
    fn observe(&mut self, publication: Publication<'_>) {
        let path = publication.topic.path();
        if path != topics::POSE.path() && path != topics::BALL.path() && path != body::SENSORS.path() {
            return;
        }
        let Some(robot) = self.hosts.iter().position(|host| host == publication.host) else { return };
        let mut robots = self.robots.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(belief) = robots.get_mut(robot) else { return };
        if let Some(pose) = publication.sample.downcast::<Pose>() {
            belief.pose = *pose.message;
        } else if let Some(ball) = publication.sample.downcast::<Ball>() {
            belief.ball = *ball.message;
        } else if let Some(sensors) = publication.sample.downcast::<Sensors>() {
            belief.is_fallen = sensors.message.posture() == Posture::Fallen;
        }
    }
}
