//! The skill that a body performs for its agents, from the command to its end.

use monas_robot::{Actuators, Skill, SkillProgress, SkillResult};

use crate::{BodyPhase, Motion, Side};

/// Readings within which a body has to begin a skill; afterwards it counts as refused (the body
/// lies, or is off the field).
const BEGIN_READINGS: u32 = 3;

/// The active skill and the last that ended.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SkillTrack {
    active: Option<ActiveSkill>,
    progress: SkillProgress,
}

#[derive(Clone, Copy, Debug)]
struct ActiveSkill {
    motion: Motion,
    ball_speed: f64,
    begun: bool,
    readings: u32,
}

impl SkillTrack {
    /// Processes a command; a skill begins if its number is new and no other is active.
    pub(super) fn command(&mut self, actuators: &Actuators) {
        if !self.progress.command(actuators.skill_number) {
            return;
        }
        match motion_of(actuators.skill()) {
            Some(motion) => {
                let ball_speed = if actuators.ball_speed.is_finite() { actuators.ball_speed } else { 0.0 };
                self.active = Some(ActiveSkill { motion, ball_speed, begun: false, readings: 0 });
            }
            None => self.end(SkillResult::Refused),
        }
    }

    /// Updates from the body's phase; the skill ends when the body has begun it and then changes
    /// its phase.
    pub(super) fn observe(&mut self, phase: BodyPhase) {
        let Some(active) = &mut self.active else { return };
        active.readings += 1;
        let performing = performs(active.motion, phase);
        active.begun |= performing;
        let (motion, begun) = (active.motion, active.begun);
        if !begun && active.readings > BEGIN_READINGS {
            self.end(SkillResult::Refused);
        } else if begun && !performing {
            self.end(if completes(motion, phase) {
                SkillResult::Performed
            } else {
                SkillResult::Interrupted
            });
        }
    }

    fn end(&mut self, result: SkillResult) {
        self.active = None;
        self.progress.end(result);
    }

    /// The motion of the legs for the active skill, if any.
    pub(super) fn motion(&self) -> Option<Motion> {
        self.active.map(|active| active.motion)
    }

    /// Desired speed of the ball after the active kick, m/s; zero: as fast as the body kicks it.
    pub(super) fn ball_speed(&self) -> f64 {
        self.active.map_or(0.0, |active| active.ball_speed)
    }

    /// The number of the last skill that has ended, and how.
    pub(super) fn done(&self) -> (u64, SkillResult) {
        self.progress.done()
    }
}

fn motion_of(skill: Skill) -> Option<Motion> {
    match skill {
        Skill::NoSkill => None,
        Skill::KickLeft => Some(Motion::Kick(Side::Left)),
        Skill::KickRight => Some(Motion::Kick(Side::Right)),
        Skill::FallLeft => Some(Motion::Fall(Side::Left)),
        Skill::FallRight => Some(Motion::Fall(Side::Right)),
        Skill::DiveLeft => Some(Motion::Dive(Side::Left)),
        Skill::DiveRight => Some(Motion::Dive(Side::Right)),
        Skill::StandUp => Some(Motion::StandUp),
    }
}

fn performs(motion: Motion, phase: BodyPhase) -> bool {
    matches!(
        (motion, phase),
        (Motion::Kick(_), BodyPhase::Kicking(_))
            | (Motion::Fall(_), BodyPhase::SideFalling(_))
            | (Motion::Dive(_), BodyPhase::Diving(_))
            | (Motion::StandUp, BodyPhase::StandingUp)
    )
}

/// Whether a body that has begun a motion and is in this phase after it has performed all of it.
fn completes(motion: Motion, phase: BodyPhase) -> bool {
    match motion {
        Motion::Fall(_) | Motion::Dive(_) => phase.is_fallen(),
        _ => matches!(phase, BodyPhase::Standing | BodyPhase::Walking),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Direction;

    fn kick(number: u64) -> Actuators {
        Actuators { skill: Skill::KickLeft as i32, skill_number: number, ..Actuators::default() }
    }

    #[test]
    fn a_skill_ends_when_the_body_does_something_else() {
        let mut track = SkillTrack::default();
        track.command(&kick(1));
        track.observe(BodyPhase::Standing);
        assert_eq!(
            (track.motion(), track.done()),
            (Some(Motion::Kick(Side::Left)), (0, SkillResult::NoResult))
        );
        track.observe(BodyPhase::Kicking(Side::Left));
        track.command(&kick(1));
        track.observe(BodyPhase::Standing);
        assert_eq!((track.motion(), track.done()), (None, (1, SkillResult::Performed)));
    }

    #[test]
    fn a_skill_during_another_is_refused_and_the_other_is_reported_by_its_own_number() {
        let mut track = SkillTrack::default();
        track.command(&kick(1));
        track.observe(BodyPhase::Kicking(Side::Left));
        track.command(&Actuators { skill: Skill::KickRight as i32, ..kick(2) });
        assert_eq!(
            (track.motion(), track.done()),
            (Some(Motion::Kick(Side::Left)), (2, SkillResult::Refused))
        );
        track.observe(BodyPhase::Standing);
        assert_eq!((track.motion(), track.done()), (None, (1, SkillResult::Performed)));
        track.command(&kick(2));
        assert_eq!(track.motion(), None);
    }

    #[test]
    fn a_body_that_falls_in_a_skill_has_not_performed_it() {
        let result = |skill: Skill, during, after| {
            let mut track = SkillTrack::default();
            track.command(&Actuators { skill: skill as i32, skill_number: 4, ..Actuators::default() });
            track.observe(during);
            track.observe(after);
            track.done()
        };
        let (kicking, falling) = (BodyPhase::Kicking(Side::Left), BodyPhase::Falling(Direction::Front));
        let lying = BodyPhase::Fallen(Direction::Left);
        assert_eq!(result(Skill::KickLeft, kicking, falling), (4, SkillResult::Interrupted));
        assert_eq!(result(Skill::StandUp, BodyPhase::StandingUp, lying), (4, SkillResult::Interrupted));
        assert_eq!(
            result(Skill::DiveLeft, BodyPhase::Diving(Side::Left), lying),
            (4, SkillResult::Performed)
        );
    }

    #[test]
    fn a_skill_that_never_begins_is_over_after_a_while() {
        let mut track = SkillTrack::default();
        track.command(&kick(1));
        for _ in 0..=BEGIN_READINGS {
            track.observe(BodyPhase::Fallen(Direction::Front));
        }
        assert_eq!((track.motion(), track.done()), (None, (1, SkillResult::Refused)));
    }
}
