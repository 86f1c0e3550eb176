//! Command-line settings for the roles of a match.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use monas::config::{Layers, UnmatchedSetting};
use yase::Diagnostic;

use crate::grammar::ROLE;

/// Command-line settings for all roles. Each has to match at least one role.
pub(crate) struct MatchSettings {
    layers: Layers,
    /// The diagnostics of each setting, role by role.
    reported: BTreeMap<usize, Vec<Diagnostic>>,
    roles: usize,
}

impl MatchSettings {
    pub(crate) fn new(layers: &Layers) -> MatchSettings {
        MatchSettings { layers: layers.of(&ROLE), reported: BTreeMap::new(), roles: 0 }
    }

    /// The layers that override the role of a robot, including its own.
    pub(crate) fn over(&mut self, own: &Layers) -> Layers {
        self.roles += 1;
        own.clone().and(&self.layers)
    }

    /// Diagnostics for settings that do not match a role. Those of the robot are returned at once;
    /// those for all roles are kept until all roles have been seen.
    pub(crate) fn unmatched(&mut self, own: &Layers, unmatched: Vec<UnmatchedSetting>) -> Vec<Diagnostic> {
        let (of_robot, of_all): (Vec<_>, Vec<_>) =
            unmatched.into_iter().partition(|unmatched| unmatched.index < own.len());
        for UnmatchedSetting { index, diagnostic } in of_all {
            self.reported.entry(index - own.len()).or_default().push(diagnostic);
        }
        of_robot.into_iter().map(|unmatched| unmatched.diagnostic).collect()
    }

    /// Diagnostics for settings that match no role. Of several roles, the one counts that matches
    /// the longest part of the path: other roles lack the agent.
    pub(crate) fn unused_settings(self) -> Vec<Diagnostic> {
        let roles = self.roles;
        self.reported
            .into_values()
            .filter(|said| said.len() == roles)
            .filter_map(|said| said.into_iter().min_by_key(|it| Reverse(it.span.start)))
            .collect()
    }
}
