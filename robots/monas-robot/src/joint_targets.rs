//! Commands to joints, checked against an anatomy.

use crate::{Anatomy, Error, ErrorKind, JointCommands, Limits};

/// The range of a stiffness.
const STIFFNESS: Limits = Limits::new(0.0, 1.0);

/// The commands to the joints of a body within its limits: what the newest [`JointCommands`] say.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct JointTargets {
    /// Target and stiffness of each joint that is commanded.
    targets: Vec<Option<(f64, f64)>>,
    clamped: u64,
}

impl JointTargets {
    /// Replaces the targets by those of a message.
    ///
    /// # Errors
    /// [`ErrorKind::Command`] for a value that is not finite, an unknown joint, or lists of
    /// different lengths. The previous targets then remain.
    pub fn set(&mut self, commands: &JointCommands, anatomy: &Anatomy) -> Result<(), Error> {
        check(commands, anatomy)?;
        self.targets.clear();
        self.targets.resize(anatomy.joints.len(), None);
        for (index, &number) in commands.joints.iter().enumerate() {
            let joint = number as usize;
            let (target, stiffness) = (commands.targets[index], commands.stiffnesses[index]);
            let limits = anatomy.joints[joint].limits;
            self.clamped += u64::from(!limits.contains(target)) + u64::from(!STIFFNESS.contains(stiffness));
            self.targets[joint] = Some((limits.clamp(target), STIFFNESS.clamp(stiffness)));
        }
        Ok(())
    }

    /// The target, radians, and the stiffness of a joint; none if it is not commanded.
    pub fn of(&self, joint: usize) -> Option<(f64, f64)> {
        self.targets.get(joint).copied().flatten()
    }

    /// The number of values so far that were beyond a limit, and clamped.
    pub fn clamped(&self) -> u64 {
        self.clamped
    }
}

fn check(commands: &JointCommands, anatomy: &Anatomy) -> Result<(), Error> {
    let refused = |message: String| Err(Error::new(ErrorKind::Command, message));
    let JointCommands { joints, targets, stiffnesses } = commands;
    if targets.len() != joints.len() || stiffnesses.len() != joints.len() {
        return refused(format!(
            "{} joints are commanded with {} targets and {} stiffnesses",
            joints.len(),
            targets.len(),
            stiffnesses.len()
        ));
    }
    for (index, &joint) in joints.iter().enumerate() {
        let Some(known) = anatomy.joints.get(joint as usize) else {
            return refused(format!("the {} has no joint {joint}", anatomy.model));
        };
        if !(targets[index].is_finite() && stiffnesses[index].is_finite()) {
            return refused(format!("the command of `{}` is not finite", known.name));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::Joint;

    fn anatomy() -> Anatomy {
        let joint = |name: &str| Joint { name: name.to_owned(), limits: Limits::new(-0.5, 1.0), speed: None };
        let joints = vec![joint("first"), joint("second")];
        Anatomy { joints, ..Anatomy::new("two joints", Duration::from_millis(10)) }
    }

    fn command(joint: u32, target: f64, stiffness: f64) -> JointCommands {
        JointCommands { joints: vec![joint], targets: vec![target], stiffnesses: vec![stiffness] }
    }

    #[test]
    fn what_is_beyond_a_limit_is_clamped_and_counted() {
        let mut targets = JointTargets::default();
        targets.set(&command(1, 7.0, 2.0), &anatomy()).unwrap();
        assert_eq!((targets.of(0), targets.of(1), targets.clamped()), (None, Some((1.0, 1.0)), 2));
        targets.set(&JointCommands::default(), &anatomy()).unwrap();
        assert_eq!((targets.of(1), targets.clamped()), (None, 2));
    }

    #[test]
    fn what_is_not_finite_or_does_not_fit_is_refused_and_the_previous_targets_remain() {
        let mut targets = JointTargets::default();
        targets.set(&command(0, 0.25, 0.5), &anatomy()).unwrap();
        let longer = JointCommands { targets: vec![0.0, 0.0], ..command(0, 0.0, 0.0) };
        for bad in [command(0, f64::NAN, 1.0), command(0, 0.0, f64::INFINITY), command(2, 0.0, 1.0), longer] {
            let error = targets.set(&bad, &anatomy()).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Command);
            assert_eq!((targets.of(0), targets.clamped()), (Some((0.25, 0.5)), 0));
        }
    }
}
