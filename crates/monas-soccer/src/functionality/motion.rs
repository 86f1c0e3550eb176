//! From what the behaviours want to what the body is told.
//!
//! A walk is repeated by whoever wants it; a request that is not repeated ends by itself, so that a robot whose behaviour has stopped
//! stands still. A skill, such as a kick, is requested once under a new number; its request is over when the body stands upright again,
//! which after a dive includes getting up. A robot that lies gets up whether anybody asks or not.

use std::time::Duration;

use narukom::Moment;

use super::walk::{Gait, Walk};

/// A motion that happens once.
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
    /// Throw oneself to the left.
    DiveLeft,
    /// Throw oneself to the right.
    DiveRight,
    /// Get up from the ground.
    StandUp,
}

/// What a behaviour wants.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Wish {
    /// Standing.
    Stand,
    /// Walking.
    Walk(Walk),
    /// A motion that happens once.
    Skill(Skill),
}

/// A wish, with the number of the last skill that was asked for and the time since it was uttered.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Request {
    /// What is wanted.
    pub wish: Wish,
    /// Counts the skills that were asked for.
    pub number: u64,
    /// How old the request is.
    pub age: Duration,
}

/// What the body is doing.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Posture {
    /// On its feet, standing or walking.
    Upright,
    /// In the middle of a motion, getting up included.
    Busy,
    /// On the ground.
    Fallen,
    /// In somebody's hands.
    Lifted,
}

/// What the body reports.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Report {
    /// What it is doing.
    pub posture: Posture,
    /// The number of the last skill that has ended.
    pub skill_done: u64,
}

/// What the body is told: the latest holds.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Order {
    /// The walk.
    pub walk: Walk,
    /// The last skill; it is performed once for each new number.
    pub skill: Option<Skill>,
    /// Its number.
    pub skill_number: u64,
}

/// A request older than this no longer counts.
const FRESH: Duration = Duration::from_millis(500);
/// A body that has not reported the end of a skill for this long has lost it.
const PATIENCE: Duration = Duration::from_secs(10);

/// The arbiter between behaviours and body. Asked once a cycle with [`Motion::step`].
#[derive(Clone, Debug)]
pub struct Motion {
    gait: Gait,
    order: Order,
    /// Since when the skill of the order is under way.
    under_way: Option<Moment>,
    /// The request whose skill is under way or whose end is waited for.
    pending: Option<u64>,
    done: u64,
}

impl Motion {
    /// An arbiter for a body with a gait.
    pub fn new(gait: Gait) -> Motion {
        let order = Order { walk: Walk::STILL, skill: None, skill_number: 0 };
        Motion { gait, order, under_way: None, pending: None, done: 0 }
    }

    /// Takes another gait from now on.
    pub fn set_gait(&mut self, gait: Gait) {
        self.gait = gait;
    }

    /// The number of the last request that is over: performed or refused.
    pub fn done(&self) -> u64 {
        self.done
    }

    /// Whether a skill is under way.
    pub fn is_busy(&self) -> bool {
        self.under_way.is_some()
    }

    /// What to tell the body, given its report, the newest request and whether the game allows motion.
    pub fn step(&mut self, now: Moment, report: Report, request: Option<Request>, allowed: bool) -> Order {
        self.order.walk = Walk::STILL;
        self.finish_skill(now, report);
        if self.under_way.is_none() && report.posture == Posture::Fallen {
            self.begin(now, Skill::StandUp, report);
        }
        if let Some(request) = request {
            self.serve(now, report, request, allowed);
        }
        self.order
    }

    fn finish_skill(&mut self, now: Moment, report: Report) {
        let ended = report.skill_done >= self.order.skill_number;
        let lost = self.under_way.is_some_and(|since| now.since(since) > PATIENCE);
        if ended || lost || report.posture == Posture::Lifted {
            self.under_way = None;
        }
        let rests = matches!(report.posture, Posture::Upright | Posture::Lifted);
        if self.under_way.is_none() && (rests || lost) {
            self.done = self.pending.take().unwrap_or(self.done);
        }
    }

    fn serve(&mut self, now: Moment, report: Report, request: Request, allowed: bool) {
        let ready = self.under_way.is_none() && report.posture == Posture::Upright;
        let heard = allowed && request.age <= FRESH;
        match request.wish {
            Wish::Skill(skill) if self.is_new(request.number) => match heard && ready {
                true => {
                    self.pending = Some(request.number);
                    self.begin(now, skill, report);
                }
                false => self.done = request.number,
            },
            Wish::Walk(walk) if heard && ready => self.order.walk = self.gait.limit(&walk),
            _ => {}
        }
    }

    fn is_new(&self, number: u64) -> bool {
        number > self.done && self.pending != Some(number)
    }

    /// The number is one that the body has not met, even if this arbiter began after others.
    fn begin(&mut self, now: Moment, skill: Skill, report: Report) {
        self.order.skill = Some(skill);
        self.order.skill_number = self.order.skill_number.max(report.skill_done) + 1;
        self.under_way = Some(now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAIT: Gait = Gait { forward: 0.3, backward: 0.1, sideways: 0.1, turn: 1.0 };
    const UPRIGHT: Report = Report { posture: Posture::Upright, skill_done: 0 };

    fn at(millis: u64) -> Moment {
        Moment::from_nanos(millis * 1_000_000)
    }

    fn request(wish: Wish, number: u64) -> Option<Request> {
        Some(Request { wish, number, age: Duration::from_millis(100) })
    }

    fn ahead() -> Wish {
        Wish::Walk(Walk { ahead: 0.2, ..Walk::STILL })
    }

    #[test]
    fn a_walk_is_passed_on_within_the_gait() {
        let mut motion = Motion::new(GAIT);
        assert_eq!(motion.step(at(0), UPRIGHT, request(ahead(), 0), true).walk.ahead, 0.2);
        let fast = Wish::Walk(Walk { ahead: 9.0, ..Walk::STILL });
        assert_eq!(motion.step(at(100), UPRIGHT, request(fast, 0), true).walk.ahead, 0.3);
        assert_eq!(motion.step(at(200), UPRIGHT, request(Wish::Stand, 0), true).walk, Walk::STILL);
    }

    #[test]
    fn without_leave_or_a_fresh_request_it_stands_still() {
        let mut motion = Motion::new(GAIT);
        assert_eq!(motion.step(at(0), UPRIGHT, request(ahead(), 0), false).walk, Walk::STILL);
        let old = Request { wish: ahead(), number: 0, age: Duration::from_millis(501) };
        assert_eq!(motion.step(at(100), UPRIGHT, Some(old), true).walk, Walk::STILL);
        assert_eq!(motion.step(at(200), UPRIGHT, None, true).walk, Walk::STILL);
    }

    #[test]
    fn a_skill_happens_once_and_is_done_when_the_body_stands_again() {
        let mut motion = Motion::new(GAIT);
        let kick = request(Wish::Skill(Skill::KickLeft), 1);
        let order = motion.step(at(0), UPRIGHT, kick, true);
        assert_eq!((order.skill, order.skill_number, order.walk), (Some(Skill::KickLeft), 1, Walk::STILL));
        let busy = Report { posture: Posture::Busy, skill_done: 0 };
        assert_eq!(motion.step(at(100), busy, kick, true).skill_number, 1);
        assert_eq!((motion.done(), motion.is_busy()), (0, true));
        let over = Report { posture: Posture::Upright, skill_done: 1 };
        assert_eq!(motion.step(at(1600), over, kick, true).skill_number, 1);
        assert_eq!((motion.done(), motion.is_busy()), (1, false));
        assert_eq!(motion.step(at(1700), over, request(ahead(), 1), true).walk.ahead, 0.2);
    }

    #[test]
    fn a_dive_is_done_after_getting_up() {
        let mut motion = Motion::new(GAIT);
        let dive = request(Wish::Skill(Skill::DiveRight), 7);
        motion.step(at(0), UPRIGHT, dive, true);
        let order = motion.step(at(500), Report { posture: Posture::Fallen, skill_done: 1 }, dive, true);
        assert_eq!((order.skill, order.skill_number), (Some(Skill::StandUp), 2));
        assert_eq!(motion.done(), 0);
        motion.step(at(600), Report { posture: Posture::Busy, skill_done: 1 }, None, true);
        assert_eq!(motion.done(), 0);
        motion.step(at(4000), Report { posture: Posture::Upright, skill_done: 2 }, None, true);
        assert_eq!(motion.done(), 7);
    }

    #[test]
    fn a_fallen_robot_gets_up_and_tries_again() {
        let mut motion = Motion::new(GAIT);
        let lies = |skill_done| Report { posture: Posture::Fallen, skill_done };
        assert_eq!(motion.step(at(0), lies(0), request(ahead(), 0), true).skill, Some(Skill::StandUp));
        assert_eq!(motion.step(at(100), lies(0), request(ahead(), 0), true).skill_number, 1);
        assert_eq!(motion.step(at(4000), lies(1), request(ahead(), 0), true).skill_number, 2);
        assert_eq!(motion.step(at(4100), lies(1), request(ahead(), 0), true).walk, Walk::STILL);
    }

    #[test]
    fn a_skill_that_cannot_be_is_refused() {
        let kick = request(Wish::Skill(Skill::KickLeft), 3);
        let mut motion = Motion::new(GAIT);
        assert_eq!(motion.step(at(0), UPRIGHT, kick, false).skill, None);
        assert_eq!(motion.done(), 3);
        let mut motion = Motion::new(GAIT);
        motion.step(at(0), Report { posture: Posture::Fallen, skill_done: 0 }, kick, true);
        assert_eq!(motion.done(), 3);
    }

    #[test]
    fn a_skill_ends_when_the_robot_is_lifted_or_the_body_forgets_it() {
        let kick = request(Wish::Skill(Skill::KickLeft), 1);
        let mut motion = Motion::new(GAIT);
        motion.step(at(0), UPRIGHT, kick, true);
        motion.step(at(100), Report { posture: Posture::Lifted, skill_done: 0 }, kick, false);
        assert_eq!((motion.done(), motion.is_busy()), (1, false));
        let mut motion = Motion::new(GAIT);
        motion.step(at(0), UPRIGHT, kick, true);
        motion.step(at(10_100), Report { posture: Posture::Busy, skill_done: 0 }, kick, true);
        assert_eq!((motion.done(), motion.is_busy()), (1, false));
    }

    #[test]
    fn the_body_gets_a_number_it_has_not_met() {
        let mut motion = Motion::new(GAIT);
        let report = Report { posture: Posture::Upright, skill_done: 41 };
        assert_eq!(
            motion.step(at(0), report, request(Wish::Skill(Skill::KickLeft), 1), true).skill_number,
            42
        );
    }
}
