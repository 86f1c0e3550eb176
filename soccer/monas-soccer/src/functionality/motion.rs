//! Converts requests of the behaviours to commands to the body.
//!
//! A behaviour repeats its request to walk; a request that is not repeated expires, so that a robot
//! whose behaviour has stopped stands still. A skill, such as a kick, is requested once under a new
//! number; it is done when the body stands upright again, which after a dive includes getting up. A
//! fallen robot gets up without a request.

use std::time::Duration;

use narukom::Timestamp;

use super::walk::{GaitLimits, Walk};

/// A one-time motion.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Skill {
    /// Kick with the left foot.
    KickLeft,
    /// Kick with the right foot.
    KickRight,
    /// Drop to the left.
    FallLeft,
    /// Drop to the right.
    FallRight,
    /// Dive to the left.
    DiveLeft,
    /// Dive to the right.
    DiveRight,
    /// Get up from the ground.
    StandUp,
}

/// The motion that a behaviour requests.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum DesiredMotion {
    /// Standing.
    Stand,
    /// Walking.
    Walk(Walk),
    /// A one-time motion.
    Skill(Skill),
}

/// A requested motion, with the number of the last requested skill and the age of the request.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PendingRequest {
    /// The requested motion.
    pub motion: DesiredMotion,
    /// Desired speed of the ball after a kick, m/s; zero: as fast as the body kicks it.
    pub ball_speed: f64,
    /// Counts the requested skills.
    pub number: u64,
    /// The age of the request.
    pub age: Duration,
}

/// The posture of the body.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Posture {
    /// On its feet, standing or walking.
    Upright,
    /// Executing a motion, including getting up.
    Busy,
    /// On the ground.
    Fallen,
    /// Lifted by a person.
    Lifted,
}

/// The outcome of a skill or of a request for one.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SkillEnd {
    /// The joints have gone through the whole motion.
    Performed,
    /// It did not begin: the game or the posture of the body did not allow it.
    Refused,
    /// The body fell during the motion, was lifted, or did not report the end.
    Interrupted,
}

/// The state that the body reports.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BodyReport {
    /// Its posture.
    pub posture: Posture,
    /// The number of the last skill that has ended.
    pub skill_done: u64,
    /// The outcome of that skill; none before the first.
    pub skill_end: Option<SkillEnd>,
}

/// The command to the body; it holds until the next.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MotionCommand {
    /// The walk.
    pub walk: Walk,
    /// The last skill; it is performed once for each new number.
    pub skill: Option<Skill>,
    /// Its number.
    pub skill_number: u64,
    /// Desired speed of the ball after a kick, m/s; zero: as fast as the body kicks it.
    pub ball_speed: f64,
}

/// Age at which a request expires.
const MAX_REQUEST_AGE: Duration = Duration::from_millis(500);
/// Time without a report of the end of a skill after which it counts as lost.
const SKILL_TIMEOUT: Duration = Duration::from_secs(10);

/// The arbiter between behaviours and body. [`MotionArbiter::step`] is called once per cycle.
#[derive(Clone, Debug)]
pub struct MotionArbiter {
    gait: GaitLimits,
    order: MotionCommand,
    /// Start time of the current skill.
    under_way: Option<Timestamp>,
    /// The request whose skill is in progress or was, until the body stands again; and how the
    /// skill ended.
    pending: Option<(u64, Option<SkillEnd>)>,
    done: u64,
    end: Option<SkillEnd>,
}

impl MotionArbiter {
    /// An arbiter for a body with a gait.
    pub fn new(gait: GaitLimits) -> MotionArbiter {
        let order = MotionCommand { walk: Walk::STILL, skill: None, skill_number: 0, ball_speed: 0.0 };
        MotionArbiter { gait, order, under_way: None, pending: None, done: 0, end: None }
    }

    /// Changes the gait.
    pub fn set_gait(&mut self, gait: GaitLimits) {
        self.gait = gait;
    }

    /// The number of the last request that is over: performed or rejected.
    pub fn done(&self) -> u64 {
        self.done
    }

    /// The outcome of that request; none before the first.
    pub fn end(&self) -> Option<SkillEnd> {
        self.end
    }

    /// Whether a skill is in progress.
    pub fn is_busy(&self) -> bool {
        self.under_way.is_some()
    }

    /// The command to the body, given its report, the newest request and whether the game allows
    /// motion.
    pub fn step(
        &mut self,
        now: Timestamp,
        report: BodyReport,
        request: Option<PendingRequest>,
        allowed: bool,
    ) -> MotionCommand {
        self.order.walk = Walk::STILL;
        self.finish_skill(now, report);
        if self.under_way.is_none() && report.posture == Posture::Fallen {
            self.begin(now, Skill::StandUp, 0.0, report);
        }
        if let Some(request) = request {
            self.serve(now, report, request, allowed);
        }
        self.order
    }

    fn finish_skill(&mut self, now: Timestamp, report: BodyReport) {
        let ended = report.skill_done >= self.order.skill_number;
        let lost = self.under_way.is_some_and(|since| now.since(since) > SKILL_TIMEOUT);
        if ended || lost || report.posture == Posture::Lifted {
            self.under_way = None;
            let end = report.skill_end.filter(|_| ended).unwrap_or(SkillEnd::Interrupted);
            if let Some((_, pending)) = &mut self.pending {
                // A dive ends before the robot gets up from it, which is another skill.
                pending.get_or_insert(end);
            }
        }
        let rests = matches!(report.posture, Posture::Upright | Posture::Lifted);
        if self.under_way.is_none()
            && (rests || lost)
            && let Some((number, end)) = self.pending.take()
        {
            (self.done, self.end) = (number, end);
        }
    }

    fn serve(&mut self, now: Timestamp, report: BodyReport, request: PendingRequest, allowed: bool) {
        let ready = self.under_way.is_none() && report.posture == Posture::Upright;
        let heard = allowed && request.age <= MAX_REQUEST_AGE;
        match request.motion {
            DesiredMotion::Skill(skill) if self.is_new(request.number) => match heard && ready {
                true => {
                    self.pending = Some((request.number, None));
                    self.begin(now, skill, request.ball_speed, report);
                }
                false => (self.done, self.end) = (request.number, Some(SkillEnd::Refused)),
            },
            DesiredMotion::Walk(walk) if heard && ready => self.order.walk = self.gait.limit(&walk),
            _ => {}
        }
    }

    fn is_new(&self, number: u64) -> bool {
        number > self.done && self.pending.is_none_or(|(pending, _)| pending != number)
    }

    /// Chooses a number that is new to the body, even if another arbiter commanded it before.
    fn begin(&mut self, now: Timestamp, skill: Skill, ball_speed: f64, report: BodyReport) {
        self.order.ball_speed = ball_speed;
        self.order.skill = Some(skill);
        self.order.skill_number = self.order.skill_number.max(report.skill_done) + 1;
        self.under_way = Some(now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAIT: GaitLimits = GaitLimits { forward: 0.3, backward: 0.1, sideways: 0.1, turn: 1.0 };
    const UPRIGHT_BODY: BodyReport = BodyReport { posture: Posture::Upright, skill_done: 0, skill_end: None };

    fn report(posture: Posture, skill_done: u64) -> BodyReport {
        BodyReport { posture, skill_done, skill_end: (skill_done > 0).then_some(SkillEnd::Performed) }
    }

    fn at(millis: u64) -> Timestamp {
        Timestamp::from_nanos(millis * 1_000_000)
    }

    fn request(motion: DesiredMotion, number: u64) -> Option<PendingRequest> {
        Some(PendingRequest { motion, ball_speed: 0.0, number, age: Duration::from_millis(100) })
    }

    fn ahead() -> DesiredMotion {
        DesiredMotion::Walk(Walk { ahead: 0.2, ..Walk::STILL })
    }

    #[test]
    fn a_walk_is_passed_on_within_the_gait() {
        let mut motion = MotionArbiter::new(GAIT);
        assert_eq!(motion.step(at(0), UPRIGHT_BODY, request(ahead(), 0), true).walk.ahead, 0.2);
        let fast = DesiredMotion::Walk(Walk { ahead: 9.0, ..Walk::STILL });
        assert_eq!(motion.step(at(100), UPRIGHT_BODY, request(fast, 0), true).walk.ahead, 0.3);
        assert_eq!(
            motion.step(at(200), UPRIGHT_BODY, request(DesiredMotion::Stand, 0), true).walk,
            Walk::STILL
        );
    }

    #[test]
    fn without_leave_or_a_fresh_request_it_stands_still() {
        let mut motion = MotionArbiter::new(GAIT);
        assert_eq!(motion.step(at(0), UPRIGHT_BODY, request(ahead(), 0), false).walk, Walk::STILL);
        let old = PendingRequest { age: Duration::from_millis(501), ..request(ahead(), 0).unwrap() };
        assert_eq!(motion.step(at(100), UPRIGHT_BODY, Some(old), true).walk, Walk::STILL);
        assert_eq!(motion.step(at(200), UPRIGHT_BODY, None, true).walk, Walk::STILL);
    }

    #[test]
    fn a_skill_happens_once_and_ends_when_the_body_stands() {
        let mut motion = MotionArbiter::new(GAIT);
        let kick = request(DesiredMotion::Skill(Skill::KickLeft), 1);
        let order = motion.step(at(0), UPRIGHT_BODY, kick, true);
        assert_eq!((order.skill, order.skill_number, order.walk), (Some(Skill::KickLeft), 1, Walk::STILL));
        let busy = report(Posture::Busy, 0);
        assert_eq!(motion.step(at(100), busy, kick, true).skill_number, 1);
        assert_eq!((motion.done(), motion.is_busy()), (0, true));
        let over = report(Posture::Upright, 1);
        assert_eq!(motion.step(at(1600), over, kick, true).skill_number, 1);
        assert_eq!((motion.done(), motion.is_busy()), (1, false));
        assert_eq!(motion.end(), Some(SkillEnd::Performed));
        assert_eq!(motion.step(at(1700), over, request(ahead(), 1), true).walk.ahead, 0.2);
    }

    #[test]
    fn a_kick_is_as_soft_as_it_is_requested() {
        let kick = request(DesiredMotion::Skill(Skill::KickLeft), 1).unwrap();
        let mut motion = MotionArbiter::new(GAIT);
        let order = motion.step(at(0), UPRIGHT_BODY, Some(PendingRequest { ball_speed: 0.8, ..kick }), true);
        assert_eq!((order.skill, order.ball_speed), (Some(Skill::KickLeft), 0.8));
        let next = PendingRequest { number: 2, ..kick };
        let order = motion.step(at(2000), report(Posture::Upright, 1), Some(next), true);
        assert_eq!((order.skill_number, order.ball_speed), (2, 0.0));
    }

    #[test]
    fn a_dive_is_done_after_getting_up() {
        let mut motion = MotionArbiter::new(GAIT);
        let dive = request(DesiredMotion::Skill(Skill::DiveRight), 7);
        motion.step(at(0), UPRIGHT_BODY, dive, true);
        let order = motion.step(at(500), report(Posture::Fallen, 1), dive, true);
        assert_eq!((order.skill, order.skill_number), (Some(Skill::StandUp), 2));
        assert_eq!(motion.done(), 0);
        motion.step(at(600), report(Posture::Busy, 1), None, true);
        assert_eq!(motion.done(), 0);
        motion.step(at(4000), report(Posture::Upright, 2), None, true);
        assert_eq!((motion.done(), motion.end()), (7, Some(SkillEnd::Performed)));
    }

    #[test]
    fn a_fallen_robot_gets_up_and_tries_again() {
        let mut motion = MotionArbiter::new(GAIT);
        let lies = |skill_done| report(Posture::Fallen, skill_done);
        assert_eq!(motion.step(at(0), lies(0), request(ahead(), 0), true).skill, Some(Skill::StandUp));
        assert_eq!(motion.step(at(100), lies(0), request(ahead(), 0), true).skill_number, 1);
        assert_eq!(motion.step(at(4000), lies(1), request(ahead(), 0), true).skill_number, 2);
        assert_eq!(motion.step(at(4100), lies(1), request(ahead(), 0), true).walk, Walk::STILL);
    }

    #[test]
    fn a_skill_that_cannot_be_is_refused() {
        let kick = request(DesiredMotion::Skill(Skill::KickLeft), 3);
        let mut motion = MotionArbiter::new(GAIT);
        assert_eq!(motion.step(at(0), UPRIGHT_BODY, kick, false).skill, None);
        assert_eq!(motion.done(), 3);
        let mut motion = MotionArbiter::new(GAIT);
        motion.step(at(0), report(Posture::Fallen, 0), kick, true);
        assert_eq!((motion.done(), motion.end()), (3, Some(SkillEnd::Refused)));
    }

    #[test]
    fn a_kick_in_which_the_robot_falls_is_interrupted() {
        let mut motion = MotionArbiter::new(GAIT);
        motion.step(at(0), UPRIGHT_BODY, request(DesiredMotion::Skill(Skill::KickLeft), 1), true);
        let fell = BodyReport { skill_end: Some(SkillEnd::Interrupted), ..report(Posture::Fallen, 1) };
        motion.step(at(500), fell, None, true);
        motion.step(at(4000), report(Posture::Upright, 2), None, true);
        assert_eq!((motion.done(), motion.end()), (1, Some(SkillEnd::Interrupted)));
    }

    #[test]
    fn a_skill_ends_when_the_robot_is_lifted_or_the_body_forgets_it() {
        let kick = request(DesiredMotion::Skill(Skill::KickLeft), 1);
        let mut motion = MotionArbiter::new(GAIT);
        motion.step(at(0), UPRIGHT_BODY, kick, true);
        motion.step(at(100), report(Posture::Lifted, 0), kick, false);
        assert_eq!((motion.done(), motion.is_busy()), (1, false));
        let mut motion = MotionArbiter::new(GAIT);
        motion.step(at(0), UPRIGHT_BODY, kick, true);
        motion.step(at(10_100), report(Posture::Busy, 0), kick, true);
        assert_eq!((motion.done(), motion.is_busy()), (1, false));
    }

    #[test]
    fn the_body_gets_a_number_it_has_not_met() {
        let mut motion = MotionArbiter::new(GAIT);
        let report = report(Posture::Upright, 41);
        assert_eq!(
            motion.step(at(0), report, request(DesiredMotion::Skill(Skill::KickLeft), 1), true).skill_number,
            42
        );
    }
}
