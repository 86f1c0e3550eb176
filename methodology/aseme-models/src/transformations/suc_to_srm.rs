//! SUC to SRM: use cases to activities and capabilities of roles.

use yase::Diagnostic;
use yase::expression::TextPosition;

use super::{activity_names, joined, participant_formula, system_participants};
use crate::aip::{Aip, Participant};
use crate::roles::{Capability, Functionality, Role, RoleActivity, SystemRoles};
use crate::suc::{RoleKind, Suc, UseCase};
use aseme::liveness;

/// The roles of the system with their capabilities and activities. Formulas of protocols come from
/// an AIP if there is one.
///
/// A use case that includes others becomes a capability of each participating role, named
/// `usecase_role` if several roles of the system take part; its formula has the included use cases
/// of which the role is the first participant. Any other use case becomes an activity with the
/// functionality in `specified_by`. The first formula of a role has its capabilities, followed by
/// the activities that belong to none.
///
/// The participant of an AIP that is named after a role, or whose name contains `_role`, provides
/// the formula of that name; of several roles that of its whole name or end, and the longest. A
/// participant without a role becomes a capability with its formulas as description. A capability
/// in which a role is never the first participant is reported (E0832).
pub fn suc_to_srm(suc: &Suc, aip: Option<&Aip>) -> (SystemRoles, Vec<Diagnostic>) {
    let mut making = SrmBuilder { suc, srm: SystemRoles::default(), diagnostics: Vec::new() };
    let system = suc.roles.iter().enumerate().filter(|(_, role)| role.kind == RoleKind::System);
    let roles: Vec<usize> = system.map(|(index, _)| index).collect();
    for role in roles {
        making.role(role);
    }
    for participant in aip.iter().flat_map(|aip| &aip.participants) {
        making.participant(participant);
    }
    (making.srm, making.diagnostics)
}

struct SrmBuilder<'a> {
    suc: &'a Suc,
    srm: SystemRoles,
    diagnostics: Vec<Diagnostic>,
}

impl<'a> SrmBuilder<'a> {
    fn role(&mut self, role: usize) {
        let suc = self.suc;
        let own: Vec<(usize, &UseCase)> = suc
            .usecases
            .iter()
            .enumerate()
            .filter(|(_, usecase)| usecase.participants.contains(&role))
            .collect();
        let name = suc.roles[role].name.as_str();
        let mut made = Role { name: name.into(), ..Role::default() };
        for (_, usecase) in own.iter().filter(|(_, usecase)| usecase.includes.is_empty()) {
            let activity = self.activity(&usecase.name, Some(&usecase.specified_by));
            if !made.activities.contains(&activity) {
                made.activities.push(activity);
            }
        }
        let mut lines = Vec::new();
        for (_, usecase) in own.iter().filter(|(_, usecase)| !usecase.includes.is_empty()) {
            let capability = self.capability(role, usecase);
            made.capabilities.push(capability);
            lines.extend(self.capability_formula(role, usecase));
        }
        let included = |index: &usize| own.iter().any(|(_, usecase)| usecase.includes.contains(index));
        let top = own.iter().filter(|(index, _)| !included(index));
        let (composed, plain): (Vec<_>, Vec<_>) = top.partition(|(_, usecase)| !usecase.includes.is_empty());
        let names: Vec<String> =
            composed.into_iter().chain(plain).map(|(_, usecase)| self.name_for(role, usecase)).collect();
        made.liveness = format!("{name}={}\n{}", joined(names.iter().map(String::as_str)), lines.concat());
        self.srm.roles.push(made);
    }

    /// The name of a use case among a role's capabilities and activities.
    fn name_for(&self, role: usize, usecase: &UseCase) -> String {
        let is_capability = !usecase.includes.is_empty() && usecase.participants.contains(&role);
        match is_capability && system_participants(self.suc, usecase).count() > 1 {
            true => format!("{}_{}", usecase.name, self.suc.roles[role].name),
            false => usecase.name.clone(),
        }
    }

    fn capability(&mut self, role: usize, usecase: &UseCase) -> usize {
        let name = self.name_for(role, usecase);
        let included = usecase.includes.iter().filter_map(|&index| self.suc.usecases.get(index));
        let own: Vec<&UseCase> = included
            .filter(|included| included.includes.is_empty() && included.participants.contains(&role))
            .collect();
        let activities: Vec<usize> =
            own.iter().map(|included| self.activity(&included.name, Some(&included.specified_by))).collect();
        let known = self.srm.capabilities.iter().position(|capability| capability.name == name);
        let index = known.unwrap_or_else(|| {
            self.srm.capabilities.push(Capability { name, ..Capability::default() });
            self.srm.capabilities.len() - 1
        });
        let capability = &mut self.srm.capabilities[index];
        for activity in activities {
            if !capability.activities.contains(&activity) {
                capability.activities.push(activity);
            }
        }
        index
    }

    fn capability_formula(&mut self, role: usize, usecase: &UseCase) -> Option<String> {
        let suc = self.suc;
        let included = || usecase.includes.iter().filter_map(|&index| suc.usecases.get(index));
        let role_name = suc.roles[role].name.to_lowercase();
        let begins = |it: &&UseCase| {
            let first = it.participants.first().and_then(|&first| suc.roles.get(first));
            first.is_some_and(|first| first.name.to_lowercase() == role_name)
        };
        let names: Vec<String> =
            included().filter(begins).map(|included| self.name_for(role, included)).collect();
        let capability = self.name_for(role, usecase);
        if names.is_empty() {
            let message = format!(
                "`{}` is the first participant of nothing that `{}` includes, so `{capability}` has no formula",
                suc.roles[role].name, usecase.name
            );
            let hint = "the first participant of a use case performs it";
            self.diagnostics.push(Diagnostic::warning("E0832", usecase.position.0, message).with_hint(hint));
            return None;
        }
        Some(format!("{capability}={}\n", joined(names.iter().map(String::as_str))))
    }

    /// The activity of a name, ignoring case. A new one gets the functionality with this
    /// description, or a new functionality without one.
    fn activity(&mut self, name: &str, described: Option<&str>) -> usize {
        let known = self.srm.activities.iter().position(|activity| activity.name.eq_ignore_ascii_case(name));
        known.unwrap_or_else(|| {
            let functionality = Some(self.functionality(described.unwrap_or_default()));
            self.srm.activities.push(RoleActivity {
                name: name.into(),
                functionality,
                position: TextPosition::default(),
            });
            self.srm.activities.len() - 1
        })
    }

    fn functionality(&mut self, description: &str) -> usize {
        let same =
            |it: &Functionality| !description.is_empty() && it.description.eq_ignore_ascii_case(description);
        self.srm.functionalities.iter().position(same).unwrap_or_else(|| {
            self.srm
                .functionalities
                .push(Functionality { description: description.into(), ..Functionality::default() });
            self.srm.functionalities.len() - 1
        })
    }

    fn participant(&mut self, participant: &Participant) {
        match self.role_of(&participant.name) {
            Some(_) if participant.liveness.trim().is_empty() => {}
            Some(role) => {
                let activities = self.activities_of(participant);
                let liveness = &mut self.srm.roles[role].liveness;
                *liveness = with_formula(liveness, &participant.name, &participant.liveness);
                let capability = self.srm.capabilities.iter_mut().find(|it| it.name == participant.name);
                let indices = capability
                    .map_or(&mut self.srm.roles[role].activities, |capability| &mut capability.activities);
                indices.extend(
                    activities.into_iter().filter(|activity| !indices.contains(activity)).collect::<Vec<_>>(),
                );
            }
            None => self.free_participant(participant),
        }
    }

    /// The role that plays a participant. Of several the one of this name, else of those whose
    /// names are its end, else of all that it contains the one with the longest name.
    fn role_of(&self, participant: &str) -> Option<usize> {
        let fits = |(index, role): (usize, &Role)| {
            let part = format!("_{}", role.name);
            let is_same = participant == role.name;
            let fit = (is_same, participant.ends_with(&part), role.name.len());
            (is_same || participant.contains(&part)).then_some((fit, index))
        };
        // of equal ones the first
        let roles = self.srm.roles.iter().enumerate().rev();
        roles.filter_map(fits).max_by_key(|(fit, _)| *fit).map(|(_, index)| index)
    }

    /// The activities that the formulas of a participant name.
    fn activities_of(&mut self, participant: &Participant) -> Vec<usize> {
        let (formulas, _) = liveness::parse(&participant_formula(&participant.name, &participant.liveness));
        let names: Vec<String> = activity_names(&formulas).into_iter().map(String::from).collect();
        names.iter().map(|name| self.activity(name, None)).collect()
    }

    /// Adds a participant without a role as a capability, for roles that are added later.
    fn free_participant(&mut self, participant: &Participant) {
        let activities = self.activities_of(participant);
        let (name, description) = (participant.name.clone(), participant.liveness.clone());
        self.srm.capabilities.push(Capability { name, activities, description, ..Capability::default() });
    }
}

/// Formulas in which the formula of a name is replaced, or added if it is missing.
fn with_formula(liveness: &str, name: &str, expression: &str) -> String {
    let formula = format!("{name}={}\n", expression.trim_end());
    let is_it =
        |line: &str| line.split('=').next().is_some_and(|side| side.trim().eq_ignore_ascii_case(name));
    let mut lines: Vec<String> = liveness
        .lines()
        .map(|line| if is_it(line) { formula.clone() } else { format!("{line}\n") })
        .collect();
    if !liveness.lines().any(is_it) {
        lines.push(formula);
    }
    lines.concat()
}
