//! Statistics of a match.
//!
//! Possession: the robot nearest to the ball has it, if it is upright and within 0.3 m. A shot is a
//! kick whose line crosses the goal's mouth; a save is a shot that the goalie touched and that is
//! no goal. A pass is a kick after which a team mate is the next to touch the ball, wanted or not.
//! Robots crowd while the middles of any two are closer than 0.35 m. A goal counts for the robot
//! that shot, even if the ball was deflected. A fall is the loss of balance of an upright robot;
//! intentional dives and falls are actions, counted separately.

use crate::state::{RobotState, WorldView};
use crate::{EventKind, STEP};

/// A robot that is farther from the ball than this does not possess it, m.
pub const POSSESSION_DISTANCE: f64 = 0.3;

/// Two robots that are closer than this crowd, m.
const CROWDING_DISTANCE: f64 = 0.35;

/// A ball that is slower than this lies still, m/s.
const ROLLING_SPEED: f64 = 0.05;

/// Counts of a robot, or the sums of a team.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlayCounts {
    /// Goals; own goals count for the other team, not for a robot.
    pub goals: u32,
    /// Own goals.
    pub own_goals: u32,
    /// Kicks, including those that missed the ball.
    pub kicks: u32,
    /// Kicks that hit the ball.
    pub strikes: u32,
    /// Shots on the goal.
    pub shots: u32,
    /// Kicks after which a team mate was the next to touch the ball.
    pub passes: u32,
    /// Shots of a robot that had received a pass.
    pub shots_after_pass: u32,
    /// Shots saved by the goalie.
    pub saves: u32,
    /// Unintentional falls.
    pub falls: u32,
    /// Penalties.
    pub penalties: u32,
    /// Time of possession, s.
    pub possession: f64,
    /// Intentional dives and falls to a side.
    pub actions: u32,
    /// Of these, those to the side of the ball.
    pub actions_to_ball: u32,
    /// Returns of a goalie between its posts after an action.
    pub returns: u32,
    /// Sum of the times of these returns, s.
    pub return_time: f64,
}

/// Counts of a match so far.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Statistics {
    robots: Vec<PlayCounts>,
    team_of: Vec<usize>,
    /// Goals of each team, own goals of the other included.
    goals: [u32; 2],
    first_touches: u32,
    first_touch_time: f64,
    playing_time: f64,
    rolling_time: f64,
    crowded_time: f64,
}

impl Statistics {
    pub(crate) fn new(team_of: &[usize]) -> Self {
        Self {
            robots: vec![PlayCounts::default(); team_of.len()],
            team_of: team_of.to_vec(),
            ..Self::default()
        }
    }

    /// The counts of a robot; none for a robot that does not exist.
    pub fn robot(&self, robot: usize) -> Option<&PlayCounts> {
        self.robots.get(robot)
    }

    /// The sums of a team, by index. Its goals include own goals of the other team.
    pub fn team(&self, team: usize) -> PlayCounts {
        let own = self.robots.iter().zip(&self.team_of).filter(|(_, of)| **of == team);
        let sum = own.fold(PlayCounts::default(), |sum, (tally, _)| sum.plus(tally));
        PlayCounts { goals: self.goals.get(team).copied().unwrap_or(0), ..sum }
    }

    /// Mean time from kick-offs to the first touch, s; none before the first.
    pub fn time_to_first_touch(&self) -> Option<f64> {
        (self.first_touches > 0).then(|| self.first_touch_time / f64::from(self.first_touches))
    }

    /// Time in PLAYING, s.
    pub fn playing_time(&self) -> f64 {
        self.playing_time
    }

    /// Time in PLAYING in which the ball moved, s.
    pub fn rolling_time(&self) -> f64 {
        self.rolling_time
    }

    /// Time in PLAYING in which two robots crowded, s.
    pub fn crowded_time(&self) -> f64 {
        self.crowded_time
    }

    pub(crate) fn record(&mut self, event: &EventKind) {
        match *event {
            EventKind::FirstTouch { after, .. } => {
                self.first_touches += 1;
                self.first_touch_time += after;
            }
            EventKind::Kick { robot, struck, .. } => {
                self.robots[robot].kicks += 1;
                self.robots[robot].strikes += u32::from(struck);
            }
            EventKind::Shot { robot } => self.robots[robot].shots += 1,
            EventKind::Pass { from, .. } => self.robots[from].passes += 1,
            EventKind::ShotAfterPass { robot } => self.robots[robot].shots_after_pass += 1,
            EventKind::Save { robot } => self.robots[robot].saves += 1,
            EventKind::Goal { team, robot, own_goal } => self.record_goal(team, robot, own_goal),
            EventKind::Fall { robot } => self.robots[robot].falls += 1,
            EventKind::Penalty { robot, .. } => self.robots[robot].penalties += 1,
            EventKind::Act { robot, to_ball, .. } => {
                self.robots[robot].actions += 1;
                self.robots[robot].actions_to_ball += u32::from(to_ball);
            }
            EventKind::GoalieBack { robot, after } => {
                self.robots[robot].returns += 1;
                self.robots[robot].return_time += after;
            }
            EventKind::StateChanged { .. }
            | EventKind::HalfTime
            | EventKind::KickOff { .. }
            | EventKind::Return { .. }
            | EventKind::ThrowIn { .. }
            | EventKind::DropBall { .. } => {}
        }
    }

    /// Counts one step of play.
    pub(crate) fn observe(&mut self, scene: &WorldView<'_>) {
        self.playing_time += STEP;
        if scene.ball.velocity.norm() > ROLLING_SPEED {
            self.rolling_time += STEP;
        }
        if is_crowded(scene) {
            self.crowded_time += STEP;
        }
        let mut holder = None;
        let mut min = POSSESSION_DISTANCE;
        for (index, robot) in scene.on_field().filter(|(_, robot)| robot.phase.is_upright()) {
            let distance = (robot.pose.position - scene.ball.position).norm();
            if distance <= min {
                (holder, min) = (Some(index), distance);
            }
        }
        if let Some(robot) = holder {
            self.robots[robot].possession += STEP;
        }
    }

    fn record_goal(&mut self, team: usize, robot: Option<usize>, own_goal: bool) {
        self.goals[team] += 1;
        let Some(robot) = robot else { return };
        let tally = &mut self.robots[robot];
        if own_goal {
            tally.own_goals += 1;
        } else {
            tally.goals += 1;
        }
    }
}

/// Whether the middles of two robots on the field are closer than [`CROWDING_DISTANCE`].
fn is_crowded(scene: &WorldView<'_>) -> bool {
    let mut robots = scene.on_field();
    std::iter::from_fn(|| {
        let (_, one) = robots.next()?;
        let near = |other: &RobotState| (one.pose.position - other.pose.position).norm() < CROWDING_DISTANCE;
        Some(robots.clone().any(|(_, other)| near(other)))
    })
    .any(|crowds| crowds)
}

impl PlayCounts {
    fn plus(self, other: &PlayCounts) -> PlayCounts {
        PlayCounts {
            goals: self.goals + other.goals,
            own_goals: self.own_goals + other.own_goals,
            kicks: self.kicks + other.kicks,
            strikes: self.strikes + other.strikes,
            shots: self.shots + other.shots,
            passes: self.passes + other.passes,
            shots_after_pass: self.shots_after_pass + other.shots_after_pass,
            saves: self.saves + other.saves,
            falls: self.falls + other.falls,
            penalties: self.penalties + other.penalties,
            possession: self.possession + other.possession,
            actions: self.actions + other.actions,
            actions_to_ball: self.actions_to_ball + other.actions_to_ball,
            returns: self.returns + other.returns,
            return_time: self.return_time + other.return_time,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_are_counted_for_robots_and_teams() {
        let mut statistics = Statistics::new(&[0, 0, 1]);
        let events = [
            EventKind::Shot { robot: 0 },
            EventKind::Shot { robot: 1 },
            EventKind::Goal { team: 0, robot: Some(1), own_goal: false },
            EventKind::Goal { team: 0, robot: Some(2), own_goal: true },
            EventKind::Goal { team: 1, robot: None, own_goal: false },
            EventKind::Save { robot: 2 },
            EventKind::Fall { robot: 2 },
            EventKind::GoalieBack { robot: 2, after: 4.0 },
            EventKind::FirstTouch { robot: 0, after: 1.0 },
            EventKind::FirstTouch { robot: 0, after: 3.0 },
        ];
        events.iter().for_each(|event| statistics.record(event));
        let (first, second) = (statistics.team(0), statistics.team(1));
        assert_eq!((first.goals, first.own_goals, first.shots), (2, 0, 2));
        assert_eq!((second.goals, second.own_goals, second.saves, second.falls), (1, 1, 1, 1));
        assert_eq!((second.returns, second.return_time), (1, 4.0));
        assert_eq!(statistics.robot(1).map(|tally| tally.goals), Some(1));
        assert_eq!(statistics.time_to_first_touch(), Some(2.0));
        assert_eq!(statistics.robot(3), None);
    }
}
