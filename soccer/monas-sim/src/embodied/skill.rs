//! The skill that a body performs for its agents, from the command to its end.

use monas_robot::{Actuators, Skill};

use crate::{BodyPhase, Motion, Side};

/// Readings within which a body has to begin a skill; afterwards it counts as refused (the body
/// lies, or is off the field).
const PATIENCE: u32 = 3;

/// The active skill and the last that ended.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SkillTrack {
    number: u64,
    active: Option<ActiveSkill>,
    done: u64,
}

#[derive(Clone, Copy, Debug)]
struct ActiveSkill {
    motion: Motion,
    begun: bool,
    readings: u32,
}

impl SkillTrack {
    /// Processes a command; a skill begins if its number is new and no other is active.
    pub(super) fn command(&mut self, actuators: &Actuators) {
        if actuators.skill_number == self.number {
            return;
        }
        self.number = actuators.skill_number;
        match motion_of(actuators.skill()) {
            Some(motion) if self.active.is_none() => {
                self.active = Some(ActiveSkill { motion, begun: false, readings: 0 });
            }
            // No skill, or one requested while another is active: it ends at once.
            _ if self.active.is_none() => self.done = self.number,
            _ => {}
        }
    }

    /// Updates from the body's phase; the skill ends when the body has begun it and then changes
    /// its phase.
    pub(super) fn observe(&mut self, phase: BodyPhase) {
        let Some(active) = &mut self.active else { return };
        active.readings += 1;
        let performing = performs(active.motion, phase);
        active.begun |= performing;
        let refused = !active.begun && active.readings > PATIENCE;
        if refused || (active.begun && !performing) {
            self.active = None;
            self.done = self.number;
        }
    }

    /// The motion of the legs for the active skill, if any.
    pub(super) fn motion(&self) -> Option<Motion> {
        self.active.map(|active| active.motion)
    }

    /// The number of the last skill that has ended.
    pub(super) fn done(&self) -> u64 {
        self.done
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

#[cfg(test)]
mod tests {
    use super::*;

    fn kick(number: u64) -> Actuators {
        Actuators { skill: Skill::KickLeft as i32, skill_number: number, ..Actuators::default() }
    }

    #[test]
    fn a_skill_ends_when_the_body_does_something_else() {
        let mut track = SkillTrack::default();
        track.command(&kick(1));
        track.observe(BodyPhase::Standing);
        assert_eq!((track.motion(), track.done()), (Some(Motion::Kick(Side::Left)), 0));
        track.observe(BodyPhase::Kicking(Side::Left));
        track.command(&kick(1));
        track.observe(BodyPhase::Standing);
        assert_eq!((track.motion(), track.done()), (None, 1));
    }

    #[test]
    fn a_skill_that_never_begins_is_over_after_a_while() {
        let mut track = SkillTrack::default();
        track.command(&kick(1));
        for _ in 0..=PATIENCE {
            track.observe(BodyPhase::Fallen(crate::Direction::Front));
        }
        assert_eq!((track.motion(), track.done()), (None, 1));
    }
}
