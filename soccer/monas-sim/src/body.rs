//! A robot's body: its skills, balance and head, as a state machine of phases.

use crate::arena::BallObstacle;
use crate::body_phase::{BodyPhase, Direction};
use crate::gait::{WalkModel, effort};
use crate::pose::{Pose, Vector, Velocity};
use crate::rng::RandomStream;
use crate::senses::torso_tilt;
use crate::{Command, Motion, Physics, STEP, Side};

/// The fastest turn that the gyrometers report, rad/s (Nao: 500 degrees per second).
const GYRO_LIMIT: f64 = 8.7266;

impl From<Side> for Direction {
    fn from(side: Side) -> Self {
        match side {
            Side::Left => Self::Left,
            Side::Right => Self::Right,
        }
    }
}

/// An event of a body in one step that affects the rest of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum BodyEvent {
    /// A kicking foot has reached the position at which it hits the ball.
    Strike(Side),
    /// A dive or sideways fall has begun.
    Act { side: Side, dive: bool },
    /// The shape that collides with the ball has changed.
    Rebase(BallObstacle),
}

/// A body without its pose, which the arena stores.
pub(crate) struct SimulatedBody {
    pub(crate) phase: BodyPhase,
    /// Time since the phase began, s.
    pub(crate) elapsed: f64,
    pub(crate) command: Command,
    /// Desired speed of the ball after the kick under way, m/s; zero: as fast as it can.
    pub(crate) ball_speed: f64,
    pub(crate) head_yaw: f64,
    pub(crate) head_pitch: f64,
    pub(crate) gait: WalkModel,
    pub(crate) chest_button: bool,
    /// Roll and pitch of the torso, rad, and their rates, rad/s.
    pub(crate) tilt: (f64, f64),
    pub(crate) tilt_rate: [f64; 2],
    /// Displacement measured by odometry since it was last read.
    odometry: Pose,
    gait_noise: RandomStream,
    balance: RandomStream,
}

impl SimulatedBody {
    /// Creates a standing body; `path` names its random streams.
    pub(crate) fn new(seed: u64, path: &str) -> Self {
        Self {
            phase: BodyPhase::Standing,
            elapsed: 0.0,
            command: Command::default(),
            ball_speed: 0.0,
            head_yaw: 0.0,
            head_pitch: 0.0,
            gait: WalkModel::default(),
            chest_button: false,
            tilt: (0.0, 0.0),
            tilt_rate: [0.0; 2],
            odometry: Pose::default(),
            gait_noise: RandomStream::new(seed, &format!("{path}/gait")),
            balance: RandomStream::new(seed, &format!("{path}/balance")),
        }
    }

    /// Advances by one step. A body that is `held` by the referee only turns its head, sits down
    /// and stands up.
    pub(crate) fn advance(&mut self, physics: &Physics, held: bool) -> Option<BodyEvent> {
        self.elapsed += STEP;
        self.turn_head(physics);
        self.forget_untimely_skill(held);
        let event = match self.phase {
            BodyPhase::Standing | BodyPhase::Walking => self.follow_command(physics, held),
            BodyPhase::Kicking(foot) => self.kick(foot, physics),
            BodyPhase::SideFalling(side) => self.go_down(side, physics.side_fall_reach, physics),
            BodyPhase::Diving(side) => self.go_down(side, physics.dive_reach, physics),
            BodyPhase::Falling(direction) => self.fall(direction, physics),
            BodyPhase::Fallen(_) => self.lie(),
            BodyPhase::StandingUp => self.stand_up(physics),
            BodyPhase::SittingDown => self.sit_down(physics),
            BodyPhase::Sitting => self.lie(),
        };
        let felt = self.gait.felt();
        let step = Pose { position: felt.linear() * STEP, heading: felt.turn * STEP };
        self.odometry = self.odometry.compose(&step);
        self.tilt_torso(physics);
        event
    }

    /// The velocity that the feet produce without obstacles.
    pub(crate) fn velocity(&self, physics: &Physics) -> Velocity {
        self.gait.produced(physics)
    }

    /// Samples a loss of balance, caused by a blow (a change of velocity, in the own frame), by
    /// pressing against another robot, or by walking. Returns whether a fall begins.
    pub(crate) fn keep_balance(&mut self, blow: Vector, pressed: bool, physics: &Physics) -> bool {
        if !self.phase.is_upright() {
            return false;
        }
        let effort = effort(self.gait.intended(), physics);
        let pressing = if pressed { physics.fall_rate_pushed } else { 0.0 };
        let rate = physics.fall_rate_walking * effort * effort + pressing;
        let stumbles = self.balance.chance(rate * STEP);
        if blow.norm() > physics.fall_impact {
            self.begin_fall(Direction::nearest(blow));
        } else if stumbles {
            let angle = std::f64::consts::TAU * self.balance.uniform();
            self.begin_fall(Direction::nearest(Vector::new(libm::cos(angle), libm::sin(angle))));
        }
        !self.phase.is_upright()
    }

    /// Starts an unintentional fall.
    pub(crate) fn begin_fall(&mut self, direction: Direction) {
        self.gait.stop();
        self.enter(BodyPhase::Falling(direction));
    }

    /// Puts the body on its feet, as when the referee places it.
    pub(crate) fn set_upright(&mut self) {
        self.gait.stop();
        self.enter(BodyPhase::Standing);
    }

    /// The displacement measured by odometry since the last call: the current pose in the frame of
    /// the previous one.
    pub(crate) fn take_odometry(&mut self) -> Pose {
        std::mem::take(&mut self.odometry)
    }

    /// Progress of the phase, from 0 to 1; while walking, of the stride.
    pub(crate) fn progress(&self, physics: &Physics) -> f64 {
        let duration = match self.phase {
            BodyPhase::Standing | BodyPhase::Fallen(_) | BodyPhase::Sitting => return 0.0,
            BodyPhase::Walking => return self.gait.stride(),
            BodyPhase::Kicking(_) => physics.kick_duration,
            BodyPhase::SideFalling(_) | BodyPhase::Diving(_) => physics.dive_duration,
            BodyPhase::Falling(_) => physics.fall_duration,
            BodyPhase::StandingUp => physics.stand_up_duration,
            BodyPhase::SittingDown => physics.sit_down_duration,
        };
        (self.elapsed / duration).min(1.0)
    }

    /// Drops a requested skill that cannot begin now, so that it does not begin later.
    fn forget_untimely_skill(&mut self, held: bool) {
        let possible = match self.command.motion {
            Motion::Stand | Motion::Walk(_) | Motion::Freeze => true,
            Motion::Kick(_) | Motion::Fall(_) | Motion::Dive(_) => {
                !held && matches!(self.phase, BodyPhase::Standing | BodyPhase::Walking)
            }
            Motion::Sit => matches!(self.phase, BodyPhase::Standing | BodyPhase::Walking),
            Motion::StandUp => self.phase.is_fallen() || self.phase == BodyPhase::Sitting,
        };
        if !possible {
            self.command.motion = Motion::Stand;
        }
    }

    fn enter(&mut self, phase: BodyPhase) {
        self.phase = phase;
        self.elapsed = 0.0;
    }

    fn tilt_torso(&mut self, physics: &Physics) {
        let (roll, pitch) = torso_tilt(self.phase, self.progress(physics), physics.walking_sway);
        let rate = |now: f64, before: f64| ((now - before) / STEP).clamp(-GYRO_LIMIT, GYRO_LIMIT);
        self.tilt_rate = [rate(roll, self.tilt.0), rate(pitch, self.tilt.1)];
        self.tilt = (roll, pitch);
    }

    fn turn_head(&mut self, physics: &Physics) {
        if self.command.motion == Motion::Freeze {
            return;
        }
        let max = physics.head_speed * STEP;
        let yaw = self.command.head_yaw.clamp(-physics.head_yaw_limit, physics.head_yaw_limit);
        let pitch = self.command.head_pitch.clamp(physics.head_pitch_least, physics.head_pitch_most);
        self.head_yaw += (yaw - self.head_yaw).clamp(-max, max);
        self.head_pitch += (pitch - self.head_pitch).clamp(-max, max);
    }

    fn follow_command(&mut self, physics: &Physics, held: bool) -> Option<BodyEvent> {
        let motion = match self.command.motion {
            Motion::Sit => Motion::Sit,
            _ if held => Motion::Stand,
            motion => motion,
        };
        match motion {
            Motion::Kick(foot) => {
                self.ball_speed = self.command.ball_speed;
                self.begin_skill(BodyPhase::Kicking(foot));
            }
            Motion::Fall(side) => return self.act(side, false),
            Motion::Dive(side) => return self.act(side, true),
            Motion::Sit => {
                self.gait.stop();
                self.begin_skill(BodyPhase::SittingDown);
            }
            Motion::Freeze => self.walk(None, physics),
            Motion::Walk(wanted) => self.walk(Some(wanted), physics),
            Motion::Stand | Motion::StandUp => self.walk(Some(Velocity::default()), physics),
        }
        None
    }

    /// Walks; without a velocity it stops at once.
    fn walk(&mut self, wanted: Option<Velocity>, physics: &Physics) {
        match wanted {
            Some(wanted) => self.gait.advance(wanted, physics, &mut self.gait_noise),
            None => self.gait.stop(),
        }
        let phase = if self.gait.is_moving() { BodyPhase::Walking } else { BodyPhase::Standing };
        if phase != self.phase {
            self.enter(phase);
        }
    }

    fn begin_skill(&mut self, phase: BodyPhase) {
        self.command.motion = Motion::Stand;
        self.enter(phase);
    }

    fn act(&mut self, side: Side, dive: bool) -> Option<BodyEvent> {
        self.gait.stop();
        self.begin_skill(if dive { BodyPhase::Diving(side) } else { BodyPhase::SideFalling(side) });
        Some(BodyEvent::Act { side, dive })
    }

    fn kick(&mut self, foot: Side, physics: &Physics) -> Option<BodyEvent> {
        self.gait.advance(Velocity::default(), physics, &mut self.gait_noise);
        if self.elapsed >= physics.kick_duration {
            self.enter(BodyPhase::Standing);
        }
        let strikes = self.elapsed >= physics.kick_strike && self.elapsed - STEP < physics.kick_strike;
        strikes.then_some(BodyEvent::Strike(foot))
    }

    fn go_down(&mut self, side: Side, reach: f64, physics: &Physics) -> Option<BodyEvent> {
        let part = self.progress(physics);
        let direction = Direction::from(side);
        if part >= 1.0 {
            self.enter(BodyPhase::Fallen(direction));
        }
        Some(BodyEvent::Rebase(BallObstacle::Lying { direction: direction.vector(), reach: reach * part }))
    }

    fn fall(&mut self, direction: Direction, physics: &Physics) -> Option<BodyEvent> {
        if self.elapsed < physics.fall_duration {
            return None;
        }
        self.enter(BodyPhase::Fallen(direction));
        Some(BodyEvent::Rebase(BallObstacle::Lying {
            direction: direction.vector(),
            reach: physics.lying_reach,
        }))
    }

    fn lie(&mut self) -> Option<BodyEvent> {
        if self.command.motion == Motion::StandUp {
            self.begin_skill(BodyPhase::StandingUp);
        }
        None
    }

    fn sit_down(&mut self, physics: &Physics) -> Option<BodyEvent> {
        if self.elapsed >= physics.sit_down_duration {
            self.enter(BodyPhase::Sitting);
        }
        None
    }

    fn stand_up(&mut self, physics: &Physics) -> Option<BodyEvent> {
        if self.elapsed < physics.stand_up_duration {
            return None;
        }
        if self.balance.chance(physics.stand_up_success) {
            self.enter(BodyPhase::Standing);
            return Some(BodyEvent::Rebase(BallObstacle::Feet));
        }
        self.enter(BodyPhase::Fallen(Direction::Back));
        Some(BodyEvent::Rebase(BallObstacle::Lying {
            direction: Direction::Back.vector(),
            reach: physics.lying_reach,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(motion: Motion) -> SimulatedBody {
        let mut body = SimulatedBody::new(1, "robot/1/2");
        body.command = Command::new(motion);
        body
    }

    fn run(body: &mut SimulatedBody, seconds: f64) -> Vec<BodyEvent> {
        let physics = Physics::default();
        (0..(seconds / STEP).round() as usize).filter_map(|_| body.advance(&physics, false)).collect()
    }

    #[test]
    fn a_kick_hits_once_and_ends_standing() {
        let mut body = body(Motion::Kick(Side::Left));
        assert_eq!(run(&mut body, 0.7), vec![]);
        assert_eq!(body.phase, BodyPhase::Kicking(Side::Left));
        assert_eq!(run(&mut body, 5.0), vec![BodyEvent::Strike(Side::Left)]);
        assert_eq!(body.phase, BodyPhase::Standing);
    }

    #[test]
    fn a_skill_requested_during_another_is_ignored() {
        let mut body = body(Motion::Kick(Side::Left));
        run(&mut body, 1.0);
        body.command.motion = Motion::Dive(Side::Left);
        run(&mut body, 2.0);
        assert_eq!(body.phase, BodyPhase::Standing);
    }

    #[test]
    fn a_dive_covers_its_reach_and_stays_down_until_commanded() {
        let physics = Physics::default();
        let mut body = body(Motion::Dive(Side::Right));
        let events = run(&mut body, 3.0);
        assert_eq!(events.first(), Some(&BodyEvent::Act { side: Side::Right, dive: true }));
        let down = BallObstacle::Lying { direction: Vector::new(0.0, -1.0), reach: physics.dive_reach };
        assert_eq!(events.last(), Some(&BodyEvent::Rebase(down)));
        assert_eq!(body.phase, BodyPhase::Fallen(Direction::Right));
        body.command.motion = Motion::Walk(Velocity::new(0.2, 0.0, 0.0));
        run(&mut body, 1.0);
        assert!(body.phase.is_fallen());
    }

    #[test]
    fn sitting_stops_a_walk_and_lasts_until_the_command_to_stand_up() {
        let physics = Physics::default();
        let mut body = body(Motion::Walk(Velocity::new(0.2, 0.0, 0.0)));
        run(&mut body, 2.0);
        body.command.motion = Motion::Sit;
        run(&mut body, 0.1);
        assert_eq!(body.phase, BodyPhase::SittingDown);
        body.take_odometry();
        run(&mut body, physics.sit_down_duration);
        assert_eq!((body.phase, body.take_odometry()), (BodyPhase::Sitting, Pose::default()));
        body.command.motion = Motion::Walk(Velocity::new(0.2, 0.0, 0.0));
        run(&mut body, 1.0);
        assert_eq!(body.phase, BodyPhase::Sitting);
        body.command.motion = Motion::StandUp;
        run(&mut body, 0.1);
        assert_eq!(body.phase, BodyPhase::StandingUp);
    }

    #[test]
    fn standing_up_takes_its_time_and_mostly_works() {
        let physics = Physics::default();
        let mut upright = 0;
        for seed in 0..200 {
            let mut body = SimulatedBody::new(seed, "robot/1/2");
            body.begin_fall(Direction::Front);
            run(&mut body, physics.fall_duration + 0.02);
            assert!(body.phase.is_fallen());
            body.command.motion = Motion::StandUp;
            run(&mut body, physics.stand_up_duration - 0.1);
            assert_eq!(body.phase, BodyPhase::StandingUp);
            run(&mut body, 0.2);
            upright += usize::from(body.phase.is_upright());
        }
        assert!((180..200).contains(&upright), "{upright}");
    }

    #[test]
    fn a_hard_blow_fells_and_a_soft_one_does_not() {
        let physics = Physics::default();
        let mut body = body(Motion::Stand);
        assert!(!body.keep_balance(Vector::new(0.1, 0.0), false, &physics));
        assert!(body.keep_balance(Vector::new(-0.3, 0.05), false, &physics));
        assert_eq!(body.phase, BodyPhase::Falling(Direction::Back));
        assert!(!body.keep_balance(Vector::new(-9.0, 0.0), true, &physics), "it falls already");
    }

    #[test]
    fn pressing_fells_at_its_rate() {
        let physics = Physics::default();
        let mut falls = 0;
        for seed in 0..500 {
            let mut body = SimulatedBody::new(seed, "robot/2/3");
            falls += usize::from((0..100).any(|_| body.keep_balance(Vector::zeros(), true, &physics)));
        }
        let expected = 500.0 * (1.0 - libm::exp(-physics.fall_rate_pushed));
        assert!((falls as f64 - expected).abs() < 25.0, "{falls} instead of {expected}");
    }

    #[test]
    fn the_head_is_slow_and_limited() {
        let physics = Physics::default();
        let mut body = body(Motion::Stand);
        body.command.head_yaw = 9.0;
        body.command.head_pitch = -9.0;
        run(&mut body, 0.1);
        assert!((body.head_yaw - physics.head_speed * 0.1).abs() < 1e-9);
        run(&mut body, 3.0);
        assert_eq!((body.head_yaw, body.head_pitch), (physics.head_yaw_limit, physics.head_pitch_least));
    }

    #[test]
    fn a_frozen_body_keeps_still() {
        let mut body = body(Motion::Walk(Velocity::new(0.2, 0.0, 0.0)));
        run(&mut body, 1.0);
        body.command = Command { head_yaw: 1.0, head_pitch: 0.0, motion: Motion::Freeze, ball_speed: 0.0 };
        run(&mut body, 0.01);
        assert_eq!((body.phase, body.head_yaw), (BodyPhase::Standing, 0.0));
    }

    #[test]
    fn a_held_body_does_not_walk_or_kick() {
        let physics = Physics::default();
        for motion in [Motion::Walk(Velocity::new(0.2, 0.0, 0.0)), Motion::Kick(Side::Left)] {
            let mut body = body(motion);
            (0..100).for_each(|_| assert_eq!(body.advance(&physics, true), None));
            assert_eq!(body.phase, BodyPhase::Standing);
            body.advance(&physics, false);
            assert!(
                !matches!(body.phase, BodyPhase::Kicking(_)),
                "what was asked for meanwhile is forgotten"
            );
        }
    }

    #[test]
    fn odometry_follows_the_walk_and_is_taken_once() {
        let mut body = body(Motion::Walk(Velocity::new(0.2, 0.0, 0.0)));
        run(&mut body, 10.0);
        let distance = body.take_odometry().position.x;
        assert!((1.8..2.1).contains(&distance), "{distance}");
        assert_eq!(body.take_odometry(), Pose::default());
    }
}
