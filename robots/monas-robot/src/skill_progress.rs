//! The numbers of the commanded skills of a body.

use crate::SkillResult;

/// The skill that a body performs, by its number, and how the last one ended.
///
/// A skill may begin if its number is new and no other is active. A new number during another skill
/// is refused at once; the other goes on and ends with its own number. Zero is the number of no
/// skill.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct SkillProgress {
    commanded: u64,
    active: Option<u64>,
    done: u64,
    result: SkillResult,
}

impl SkillProgress {
    /// Takes the number of a command. Returns whether its skill begins now; a body that cannot
    /// begin it ends it as refused.
    pub fn command(&mut self, number: u64) -> bool {
        let is_new = number != self.commanded && number != 0;
        self.commanded = number;
        if is_new && self.active.is_some() {
            (self.done, self.result) = (number, SkillResult::Refused);
            return false;
        }
        self.active = self.active.or(is_new.then_some(number));
        is_new
    }

    /// Ends the active skill, if there is one.
    pub fn end(&mut self, result: SkillResult) {
        if let Some(number) = self.active.take() {
            (self.done, self.result) = (number, result);
        }
    }

    /// The number of the skill that ended or was refused last, and how; zero before the first.
    pub fn done(&self) -> (u64, SkillResult) {
        (self.done, self.result)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_skill_begins_once_for_each_number() {
        let mut skills = SkillProgress::default();
        assert!(!skills.command(0) && skills.command(3) && !skills.command(3));
        assert_eq!(skills.done(), (0, SkillResult::NoResult));
        skills.end(SkillResult::Performed);
        assert!(!skills.command(3) && !skills.command(0));
        assert_eq!(skills.done(), (3, SkillResult::Performed));
        assert!(skills.command(2));
        skills.end(SkillResult::Refused);
        skills.end(SkillResult::Performed);
        assert_eq!(skills.done(), (2, SkillResult::Refused));
    }

    #[test]
    fn a_number_during_another_skill_is_refused_and_the_other_keeps_its_own() {
        let mut skills = SkillProgress::default();
        assert!(skills.command(1) && !skills.command(2));
        assert_eq!(skills.done(), (2, SkillResult::Refused));
        assert!(!skills.command(0));
        assert_eq!(skills.done(), (2, SkillResult::Refused), "zero is not a skill that could be refused");
        skills.end(SkillResult::Interrupted);
        assert_eq!(skills.done(), (1, SkillResult::Interrupted));
        assert!(skills.command(3));
    }
}
