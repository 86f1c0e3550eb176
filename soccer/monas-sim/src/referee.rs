//! The referee: states of the game, clock, score, penalties, and the decisions of each step.
//!
//! The referee decides on the ground truth and emits events; the world carries them out. Every half
//! begins in INITIAL, for which all robots are placed by hand, and its clock runs until the half
//! ends. A goal leads from PLAYING to READY, in which robots walk to their places until none moves
//! any more; SET places those by hand that stand in an illegal position.
//!
//! The referee does not judge robots that enter the centre circle before the ball is touched, goals
//! straight from a kick-off, and robots that leave the field, which do not affect play.

mod game_order;
mod referee_call;

use crate::fouls::FoulDetector;
use crate::rng::RandomStream;
use crate::state::WorldView;
use crate::{
    BallState, BodyPhase, EventKind, FieldSide, GoalColour, MatchRules, Offence, RobotSetup, STEP,
    TeamColour, TeamSetup, restart,
};

pub use game_order::GameOrder;
pub use referee_call::RefereeCall;

/// The state of the game. PENALIZED is a state of a single robot: see [`Referee::penalty`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum GameState {
    /// Robots are switched on and wait.
    #[default]
    Initial,
    /// Robots walk to their places for a kick-off.
    Ready,
    /// Everything is in place; robots must not move.
    Set,
    /// The ball is in play.
    Playing,
    /// The match is over.
    Finished,
}

impl GameState {
    /// Whether the game may go from this state to `next`: forward through a half, from play to
    /// READY after a goal, and from anywhere to INITIAL or FINISHED when a half is over.
    pub fn may_become(self, next: GameState) -> bool {
        use GameState::{Finished, Initial, Playing, Ready, Set};
        let forward = [(Initial, Ready), (Ready, Set), (Set, Playing), (Playing, Ready)];
        let half_over = self != Finished && self != Initial && matches!(next, Initial | Finished);
        forward.contains(&(self, next)) || half_over
    }
}

/// A penalty that a robot serves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Penalty {
    /// Its offence.
    pub offence: Offence,
    /// Time until it may come back, s.
    pub remaining: f64,
}

/// The referee's announcement to a robot, like that of the league's game controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Announcement {
    /// The state of the game.
    pub state: GameState,
    /// The half, 1 or 2.
    pub half: u8,
    /// Time left in this half, s.
    pub seconds_remaining: f64,
    /// The number of the robot's team.
    pub team: u8,
    /// The robot's own number.
    pub robot: u8,
    /// The current colour of its team.
    pub colour: TeamColour,
    /// The number of the team that has the kick-off, or had the last one.
    pub kick_off_team: u8,
    /// Goals of the own team.
    pub own_score: u32,
    /// Goals of the opponents.
    pub opponent_score: u32,
    /// The colour of the goal to attack.
    pub attacks: GoalColour,
    /// The penalty that the robot serves.
    pub penalty: Option<Penalty>,
    /// Whether robots must stand still, whatever the state.
    pub halted: bool,
}

/// The referee of a match.
pub struct Referee {
    rules: MatchRules,
    teams: [u8; 2],
    robots: Vec<RobotSetup>,
    /// For each robot, the index of its team.
    team_of: Vec<usize>,
    state: GameState,
    half: u8,
    /// Steps since the state and the half began, and since a robot last touched the ball.
    state_steps: u64,
    half_steps: u64,
    untouched_steps: u64,
    /// Steps since a robot last moved.
    still_steps: u64,
    kick_off: usize,
    first_kick_off: usize,
    defends: [FieldSide; 2],
    colours: [TeamColour; 2],
    score: [u32; 2],
    penalties: Vec<Option<Penalty>>,
    last_touch: Option<usize>,
    /// The robot that struck the ball in this step.
    striker: Option<usize>,
    touched_since_kick_off: bool,
    fouls: FoulDetector,
    coin: RandomStream,
    /// The decisions of a referee outside the simulation, if there is one.
    order: Option<GameOrder>,
    /// A person's decisions since the last step.
    called: Vec<EventKind>,
    is_stopped: bool,
}

impl Referee {
    pub(crate) fn new(
        rules: MatchRules,
        teams: &[TeamSetup; 2],
        robots: &[RobotSetup],
        team_of: &[usize],
        seed: u64,
    ) -> Self {
        let mut coin = RandomStream::new(seed, "referee");
        let first_kick_off = usize::from(coin.chance(0.5));
        Self {
            rules,
            teams: [teams[0].number, teams[1].number],
            robots: robots.to_vec(),
            team_of: team_of.to_vec(),
            state: GameState::Initial,
            half: 1,
            state_steps: 0,
            half_steps: 0,
            untouched_steps: 0,
            still_steps: 0,
            kick_off: first_kick_off,
            first_kick_off,
            defends: [teams[0].plays, teams[1].plays],
            colours: [teams[0].colour, teams[1].colour],
            score: [0, 0],
            penalties: vec![None; robots.len()],
            last_touch: None,
            striker: None,
            touched_since_kick_off: false,
            fouls: FoulDetector::new(robots.len()),
            coin,
            order: None,
            called: Vec::new(),
            is_stopped: false,
        }
    }

    /// The state of the game.
    pub fn state(&self) -> GameState {
        self.state
    }

    /// The half, 1 or 2.
    pub fn half(&self) -> u8 {
        self.half
    }

    /// Time left in this half, s.
    pub fn seconds_remaining(&self) -> f64 {
        if let Some(order) = &self.order {
            return order.seconds_remaining;
        }
        (self.rules.half_duration - self.half_steps as f64 * STEP).max(0.0)
    }

    /// Goals of each team, by index.
    pub fn score(&self) -> [u32; 2] {
        self.score
    }

    /// The index of the team that has the kick-off, or had the last one.
    pub fn kick_off_team(&self) -> usize {
        self.kick_off
    }

    /// The end that each team defends now, by index.
    pub fn defends(&self) -> [FieldSide; 2] {
        self.defends
    }

    /// The present colours of the teams, by index.
    pub fn colours(&self) -> [TeamColour; 2] {
        self.colours
    }

    /// The penalty that a robot serves; also none for a robot that does not exist.
    pub fn penalty(&self, robot: usize) -> Option<Penalty> {
        self.penalties.get(robot).copied().flatten()
    }

    /// The robot that touched the ball last since the ball was placed for the last kick-off.
    pub fn last_touch(&self) -> Option<usize> {
        self.last_touch
    }

    /// The announcement to a robot.
    pub(crate) fn announcement(&self, robot: usize) -> Announcement {
        let team = self.team_of[robot];
        Announcement {
            state: self.state,
            half: self.half,
            seconds_remaining: self.seconds_remaining(),
            team: self.teams[team],
            robot: self.robots[robot].number,
            colour: self.colours[team],
            kick_off_team: self.teams[self.kick_off],
            own_score: self.score[team],
            opponent_score: self.score[1 - team],
            attacks: self.defends[team].opposite().goal_colour(),
            penalty: self.penalties[robot],
            halted: self.is_stopped,
        }
    }

    /// Whether robots must not move their legs.
    pub(crate) fn holds_robots(&self) -> bool {
        !matches!(self.state, GameState::Ready | GameState::Playing)
            || self.is_stopped
            || self.order.as_ref().is_some_and(|order| order.is_halted)
    }

    /// Decides nothing by itself any more: a referee outside the simulation decides.
    pub(crate) fn follow(&mut self, order: GameOrder) {
        self.order = Some(order);
    }

    /// Judges one step while the shot of `shooter`, if any, is in progress; appends its decisions
    /// to `events`.
    pub(crate) fn update(
        &mut self,
        scene: &WorldView<'_>,
        shooter: Option<usize>,
        events: &mut Vec<EventKind>,
    ) {
        if let Some(order) = self.order.take() {
            self.state_steps += 1;
            self.apply(&order, scene, events);
            self.order = Some(order);
            return;
        }
        events.append(&mut self.called);
        if self.is_stopped {
            return;
        }
        if self.state == GameState::Finished {
            return;
        }
        self.state_steps += 1;
        self.half_steps += 1;
        self.serve_penalties(events);
        if self.half_steps >= steps(self.rules.half_duration) {
            self.end_half(events);
            return;
        }
        match self.state {
            GameState::Initial => self.leave_after(self.rules.initial_duration, GameState::Ready, events),
            GameState::Ready => self.update_ready(scene, events),
            GameState::Set => self.leave_after(self.rules.set_duration, GameState::Playing, events),
            GameState::Playing => self.update_playing(scene, shooter, events),
            GameState::Finished => {}
        }
    }

    fn leave_after(&mut self, duration: f64, next: GameState, events: &mut Vec<EventKind>) {
        if self.state_steps < steps(duration) {
            return;
        }
        self.change_state(next, events);
        if next == GameState::Playing {
            events.push(EventKind::KickOff { team: self.kick_off });
        }
    }

    /// READY ends when its time is over, or when no robot makes progress.
    fn update_ready(&mut self, scene: &WorldView<'_>, events: &mut Vec<EventKind>) {
        let is_still = scene.on_field().all(|(_, robot)| robot.phase == BodyPhase::Standing);
        self.still_steps = if is_still { self.still_steps + 1 } else { 0 };
        let is_over = self.still_steps >= steps(self.rules.ready_still);
        let duration = if is_over { 0.0 } else { self.rules.ready_duration };
        self.leave_after(duration, GameState::Set, events);
    }

    fn change_state(&mut self, to: GameState, events: &mut Vec<EventKind>) {
        events.push(EventKind::StateChanged { from: self.state, to });
        self.state = to;
        self.state_steps = 0;
        self.still_steps = 0;
        if to == GameState::Ready {
            self.last_touch = None;
            self.touched_since_kick_off = false;
            self.untouched_steps = 0;
            self.fouls.clear();
        }
    }

    fn end_half(&mut self, events: &mut Vec<EventKind>) {
        if self.half == 2 {
            self.change_state(GameState::Finished, events);
            return;
        }
        self.half = 2;
        self.half_steps = 0;
        self.kick_off = 1 - self.first_kick_off;
        self.defends.swap(0, 1);
        if self.rules.switches_colours() {
            self.colours.swap(0, 1);
        }
        for robot in 0..self.penalties.len() {
            self.lift_penalty(robot, events);
        }
        events.push(EventKind::HalfTime);
        self.change_state(GameState::Initial, events);
    }

    fn serve_penalties(&mut self, events: &mut Vec<EventKind>) {
        for robot in 0..self.penalties.len() {
            let Some(penalty) = &mut self.penalties[robot] else { continue };
            penalty.remaining -= STEP;
            if penalty.remaining <= 0.0 {
                self.lift_penalty(robot, events);
            }
        }
    }

    fn lift_penalty(&mut self, robot: usize, events: &mut Vec<EventKind>) {
        if self.penalties[robot].take().is_some() {
            events.push(EventKind::Return { robot });
        }
    }

    fn update_playing(&mut self, scene: &WorldView<'_>, shooter: Option<usize>, events: &mut Vec<EventKind>) {
        self.watch_touches(scene, events);
        if let Some(goal) = goal_side(scene) {
            self.give_goal(goal, shooter, events);
            return;
        }
        if self.is_out(scene) {
            self.throw_in(scene, events);
        } else if self.untouched_steps >= steps(self.rules.stuck_time) {
            self.drop_ball(scene, events);
        }
        self.watch_fouls(scene, events);
    }

    fn watch_touches(&mut self, scene: &WorldView<'_>, events: &mut Vec<EventKind>) {
        self.untouched_steps += 1;
        for robot in self.striker.take().into_iter().chain(scene.touchers()) {
            if !self.touched_since_kick_off {
                self.touched_since_kick_off = true;
                events.push(EventKind::FirstTouch { robot, after: self.state_steps as f64 * STEP });
            }
            self.last_touch = Some(robot);
            self.untouched_steps = 0;
        }
    }

    /// Records a kick, which counts as a touch although the ball is no longer at the foot when the
    /// step ends.
    pub(crate) fn note_kick(&mut self, robot: usize) {
        self.striker = Some(robot);
    }

    /// Awards a goal. A deflected shot counts for the robot that shot.
    fn give_goal(&mut self, side: FieldSide, shooter: Option<usize>, events: &mut Vec<EventKind>) {
        let conceding = usize::from(self.defends[1] == side);
        let team = 1 - conceding;
        self.score[team] += 1;
        let shooter = shooter.filter(|robot| self.team_of[*robot] == team);
        let robot = shooter.or(self.last_touch);
        let own_goal = robot.is_some_and(|robot| self.team_of[robot] == conceding);
        events.push(EventKind::Goal { team, robot, own_goal });
        self.kick_off = conceding;
        self.change_state(GameState::Ready, events);
    }

    fn is_out(&self, scene: &WorldView<'_>) -> bool {
        let margin = scene.physics.ball_radius;
        let BallState { position, .. } = scene.ball;
        position.x.abs() > scene.field.half_length() + margin
            || position.y.abs() > scene.field.half_width() + margin
    }

    fn throw_in(&mut self, scene: &WorldView<'_>, events: &mut Vec<EventKind>) {
        let against = self.last_touch.map(|robot| self.team_of[robot]);
        let side = against.map(|team| self.defends[team]);
        let wanted = restart::throw_in(scene.field, self.rules.throw_in_setback, scene.ball.position, side);
        self.untouched_steps = 0;
        events.push(EventKind::ThrowIn { against, position: restart::free_for_ball(scene, wanted) });
    }

    fn drop_ball(&mut self, scene: &WorldView<'_>, events: &mut Vec<EventKind>) {
        let mark = if self.coin.chance(0.5) { FieldSide::Left } else { FieldSide::Right };
        let wanted = restart::drop_position(scene.field, scene.ball.position, mark);
        self.untouched_steps = 0;
        events.push(EventKind::DropBall { position: restart::free_for_ball(scene, wanted) });
    }

    fn watch_fouls(&mut self, scene: &WorldView<'_>, events: &mut Vec<EventKind>) {
        for robot in 0..scene.robots.len() {
            let defends = self.defends[self.team_of[robot]];
            if let Some(offence) = self.fouls.watch(robot, defends, &self.rules, scene) {
                self.penalties[robot] = Some(Penalty { offence, remaining: self.rules.penalty_duration });
                events.push(EventKind::Penalty { robot, offence });
            }
        }
    }
}

/// The goal that the ball is in: wholly over the line and between the posts.
fn goal_side(scene: &WorldView<'_>) -> Option<FieldSide> {
    let ball = scene.ball.position;
    let over = ball.x.abs() > scene.field.half_length() + scene.physics.ball_radius;
    let between = ball.y.abs() < scene.field.goal_width / 2.0;
    let side = if ball.x < 0.0 { FieldSide::Left } else { FieldSide::Right };
    (over && between).then_some(side)
}

fn steps(seconds: f64) -> u64 {
    (seconds / STEP).round() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_these_changes_of_state_are_legal() {
        use GameState::{Finished, Initial, Playing, Ready, Set};
        let legal = [
            (Initial, Ready),
            (Ready, Set),
            (Ready, Initial),
            (Ready, Finished),
            (Set, Playing),
            (Set, Initial),
            (Set, Finished),
            (Playing, Ready),
            (Playing, Initial),
            (Playing, Finished),
        ];
        let all = [Initial, Ready, Set, Playing, Finished];
        for from in all {
            for to in all {
                assert_eq!(from.may_become(to), legal.contains(&(from, to)), "{from:?} to {to:?}");
            }
        }
    }
}
