//! Conversion between one refined role and a system of roles.

use std::collections::BTreeMap;

use yase::expression::TextPosition;
use yase::{Diagnostic, Span};

use crate::roles::{Capability, Functionality, Role, RoleActivity, SystemRoles};
use aseme::liveness::{self, Liveness};
use aseme::srm::Srm;

impl SystemRoles {
    /// A system of one role: the names in its formulas are activities, its refining formulas are
    /// capabilities. All activities share one functionality without a description. Refinements
    /// cannot be represented and are listed (E0850).
    pub fn from_role(srm: &Srm) -> (SystemRoles, Vec<Diagnostic>) {
        let mut system =
            SystemRoles { functionalities: vec![Functionality::default()], ..SystemRoles::default() };
        let formulas = srm.liveness.formulas();
        let refined: Vec<&str> = formulas.iter().map(|formula| formula.name.as_str()).collect();
        let mut indices: BTreeMap<String, usize> = BTreeMap::new();
        let mut own = Vec::new();
        for (index, formula) in formulas.iter().enumerate() {
            let names = srm.liveness.names(formula).map(|(name, _)| name);
            let mut activities = Vec::new();
            for name in names.filter(|name| !refined.contains(name)) {
                let position = *indices.entry(name.to_owned()).or_insert_with(|| system.add_activity(name));
                if !activities.contains(&position) {
                    activities.push(position);
                }
            }
            match index {
                0 => own = activities,
                _ => system.capabilities.push(Capability {
                    name: formula.name.clone(),
                    activities,
                    ..Capability::default()
                }),
            }
        }
        let capabilities = (0..system.capabilities.len()).collect();
        let liveness = compact(&srm.liveness);
        system.roles.push(Role {
            activities: own,
            liveness,
            name: srm.role.clone(),
            capabilities,
            ..Role::default()
        });
        (system, lost_of_role(srm))
    }

    fn add_activity(&mut self, name: &str) -> usize {
        self.activities.push(RoleActivity {
            name: name.into(),
            functionality: Some(0),
            position: TextPosition::default(),
        });
        self.activities.len() - 1
    }

    /// The text of the system's only role, for refinement and execution, and what it cannot
    /// represent (E0850).
    ///
    /// # Errors
    /// There is no role, or more than one (E0247, E0248), or the formulas have errors.
    pub fn to_role(&self) -> Result<(String, Vec<Diagnostic>), Vec<Diagnostic>> {
        let [role] = self.roles.as_slice() else {
            let second = self.roles.get(1).map_or(Span::default(), |role| role.position.0);
            let found = match self.roles.len() {
                0 => Diagnostic::error("E0247", second, "the model has no role"),
                count => Diagnostic::error("E0248", second, format!("the model has {count} roles"))
                    .with_hint("put each role into its own file"),
            };
            return Err(vec![found]);
        };
        let (formulas, findings) = liveness::parse(&role.liveness);
        if findings.iter().any(Diagnostic::is_error) {
            let span = role.liveness_position.0;
            return Err(findings.into_iter().map(|finding| Diagnostic { span, ..finding }).collect());
        }
        let first = formulas.formulas().first().map_or("", |formula| formula.name.as_str());
        let name = if role.name.trim().is_empty() { first } else { role.name.as_str() };
        let text = format!("Role: {name}\nProtocols: N/A\nLiveness:\n{formulas}");
        let (again, _) = aseme::srm::SrmFile::parse(text.as_str());
        let (derived, _) = SystemRoles::from_role(again.srm());
        let mut lost = self.lost_to(&derived);
        if again.srm().role != role.name {
            let message =
                format!("the name of the role, `{}`: the text of a role cannot represent it", role.name);
            lost.push(Diagnostic::warning("E0850", role.position.0, message));
        }
        Ok((text, lost))
    }

    /// Parts of the role that a derived model lacks.
    fn lost_to(&self, derived: &SystemRoles) -> Vec<Diagnostic> {
        let mut lost = Vec::new();
        let mut add = |position: TextPosition, what: String| {
            let message = format!("{what}: the text of a role cannot represent it");
            lost.push(Diagnostic::warning("E0850", position.0, message));
        };
        for it in self
            .functionalities
            .iter()
            .filter(|it| **it != Functionality { position: it.position, ..Functionality::default() })
        {
            add(it.position, format!("the functionality `{}`", it.description));
        }
        for it in &self.activities {
            if !derived.activities.iter().any(|activity| activity.name == it.name) {
                add(it.position, format!("the activity `{}`, which no formula names", it.name));
            }
        }
        for it in &self.capabilities {
            match derived.capabilities.iter().find(|capability| capability.name == it.name) {
                None => add(it.position, format!("the capability `{}`, which no formula refines", it.name)),
                Some(_) if !it.description.is_empty() => {
                    add(it.position, format!("the description of `{}`", it.name))
                }
                Some(other) if self.names(&it.activities) != derived.names(&other.activities) => {
                    add(
                        it.position,
                        format!("the activities of `{}`, which differ from those of its formula", it.name),
                    );
                }
                Some(_) => {}
            }
        }
        lost
    }

    fn names(&self, activities: &[usize]) -> std::collections::BTreeSet<&str> {
        activities
            .iter()
            .filter_map(|&index| self.activities.get(index))
            .map(|activity| activity.name.as_str())
            .collect()
    }
}

/// Formulas in the format of files: no blanks, one per line.
pub(crate) fn compact(liveness: &Liveness) -> String {
    let line = |formula: &liveness::Formula| {
        let term = formula.expression.map_or(String::new(), |term| liveness.compact(term));
        format!("{}={term}\n", formula.name)
    };
    liveness.formulas().iter().map(line).collect()
}

fn lost_of_role(srm: &Srm) -> Vec<Diagnostic> {
    let lost = |span: Span, what: String| {
        let message = format!("{what}: a System Roles Model cannot represent it");
        Diagnostic::warning("E0850", span, message)
    };
    let protocols = srm
        .protocols
        .iter()
        .map(|it| lost(Span::default(), format!("the part `{}` in `{}`", it.participant, it.name)));
    let constants =
        srm.constants.iter().map(|it| lost(Span::default(), format!("the constant `{}`", it.name)));
    let transitions = srm.transitions.iter().map(|it| lost(it.span, format!("`{}`", it.text)));
    let states = srm.states.iter().map(|it| lost(it.span, format!("`{}`", it.text)));
    let layout = srm.layout.iter().map(|it| lost(it.span, format!("`{}`", it.text)));
    protocols.chain(constants).chain(transitions).chain(states).chain(layout).collect()
}
