//! Settings of the command line for the roles of a match.

use std::collections::BTreeMap;

use monas::config::{Layers, Unmatched};
use yase::Diagnostic;

use crate::grammar::ROLE;

/// What the command line sets for every role. It has to fit one of them at least.
pub(crate) struct Settings {
    layers: Layers,
    /// What was said of each setting, role by role.
    said: BTreeMap<usize, Vec<Diagnostic>>,
    roles: usize,
}

impl Settings {
    pub(crate) fn new(layers: &Layers) -> Settings {
        Settings { layers: layers.of(&ROLE), said: BTreeMap::new(), roles: 0 }
    }

    /// What goes over the role of a robot that has layers of its own.
    pub(crate) fn over(&mut self, own: &Layers) -> Layers {
        self.roles += 1;
        own.clone().and(&self.layers)
    }

    /// What does not fit a role: the robot's own is said at once, what is for every role when all have been seen.
    pub(crate) fn unmatched(&mut self, own: &Layers, unmatched: Vec<Unmatched>) -> Vec<Diagnostic> {
        let (of_robot, of_all): (Vec<_>, Vec<_>) =
            unmatched.into_iter().partition(|unmatched| unmatched.index < own.len());
        for Unmatched { index, diagnostic } in of_all {
            self.said.entry(index - own.len()).or_default().push(diagnostic);
        }
        of_robot.into_iter().map(|unmatched| unmatched.diagnostic).collect()
    }

    /// What fits no role at all.
    pub(crate) fn of_nobody(self) -> Vec<Diagnostic> {
        let roles = self.roles;
        self.said
            .into_values()
            .filter(|said| said.len() == roles)
            .filter_map(|said| said.into_iter().next())
            .collect()
    }
}
