//! The skill that a body performs for its agents, from the command to its end.

use monas_robot::{Actuators, Skill};

use crate::{Motion, Phase, Side};

/// How many readings a body is given to begin a skill before it counts as refused (it lies, or is off the field).
const PATIENCE: u32 = 3;

/// Which skill is under way, and which was the last to end.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SkillTrack {
    number: u64,
    active: Option<Active>,
    done: u64,
}

#[derive(Clone, Copy, Debug)]
struct Active {
    motion: Motion,
    begun: bool,
    readings: u32,
}

impl SkillTrack {
    /// Takes note of a command; a skill begins when its number is new and no other is under way.
    pub(super) fn command(&mut self, actuators: &Actuators) {
        if actuators.skill_number == self.number {
            return;
        }
        self.number = actuators.skill_number;
        match motion_of(actuators.skill()) {
            Some(motion) if self.active.is_none() => {
                self.active = Some(Active { motion, begun: false, readings: 0 });
            }
            // No skill, or one asked for while another runs: over before it began.
            _ if self.active.is_none() => self.done = self.number,
            _ => {}
        }
    }

    /// Follows the body's phase; the skill ends when the body has begun it and does something else.
    pub(super) fn observe(&mut self, phase: Phase) {
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

    /// What the legs are to do for the skill, if one is under way.
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

fn performs(motion: Motion, phase: Phase) -> bool {
    matches!(
        (motion, phase),
        (Motion::Kick(_), Phase::Kicking(_))
            | (Motion::Fall(_), Phase::SideFalling(_))
            | (Motion::Dive(_), Phase::Diving(_))
            | (Motion::StandUp, Phase::StandingUp)
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
        track.observe(Phase::Standing);
        assert_eq!((track.motion(), track.done()), (Some(Motion::Kick(Side::Left)), 0));
        track.observe(Phase::Kicking(Side::Left));
        track.command(&kick(1));
        track.observe(Phase::Standing);
        assert_eq!((track.motion(), track.done()), (None, 1));
    }

    #[test]
    fn a_skill_that_never_begins_is_over_after_a_while() {
        let mut track = SkillTrack::default();
        track.command(&kick(1));
        for _ in 0..=PATIENCE {
            track.observe(Phase::Fallen(crate::Direction::Front));
        }
        assert_eq!((track.motion(), track.done()), (None, 1));
    }
}
