//! Checks of models of roles (S01 to S03, S05) and of protocols (S04; M17 for what their rules and
//! outcomes read).

use std::collections::BTreeSet;

use yase::diagnostic::Suggestions;
use yase::expression::{EventInterner, NameScope, ScriptInterner, TransitionExpression};
use yase::{Diagnostic, Span};

use crate::program_symbols::ProgramSymbols;
use aseme::liveness;
use aseme_models::aip::{Aip, Participant};
use aseme_models::convert::Model;
use aseme_models::roles::{Role, SystemRoles};
use aseme_models::transformations::{aip_to_eac, conditions};

/// The findings about a model that is not a chart.
pub(crate) fn check(model: &Model, world: Option<&ProgramSymbols>) -> Vec<Diagnostic> {
    match model {
        Model::Srm(system) => system_roles(system),
        Model::Aip(protocols) => {
            let mut found = participants(protocols);
            found.extend(unreadable_conditions(protocols));
            let names = |world| protocols.participants.iter().flat_map(move |it| unknown_fields(it, world));
            found.extend(world.into_iter().flat_map(names));
            found
        }
        _ => Vec::new(),
    }
}

/// E0838: rules and outcomes that are not conditions.
fn unreadable_conditions(protocols: &Aip) -> impl Iterator<Item = Diagnostic> {
    let (_, found) = aip_to_eac(protocols);
    found.into_iter().filter(|found| found.code == "E0838")
}

/// M17: what the rules and outcomes of a participant read and the program does not have.
fn unknown_fields(participant: &Participant, world: &ProgramSymbols) -> Vec<Diagnostic> {
    let texts = [&participant.engaging_rules, &participant.outcomes];
    let conditions = texts.into_iter().filter_map(|text| conditions(text)).flatten();
    let mut found = Vec::new();
    for condition in conditions {
        let expression =
            TransitionExpression { guard: Some(condition.clone()), ..TransitionExpression::default() };
        let compiled = expression.compile(&mut NameScope {
            vocabulary: &world.vocabulary,
            constants: &[],
            timers: &[],
            events: &mut EventInterner::new(),
            scripts: &mut ScriptInterner::new(),
            states: &|_| None,
            suggestions: &Suggestions::default(),
        });
        for wrong in compiled.err().unwrap_or_default() {
            let message = format!("in `[{condition}]` of `{}`: {}", participant.name, wrong.message);
            found.push(Diagnostic { code: "M17", span: participant.position.0, message, ..wrong });
        }
    }
    found
}

fn system_roles(system: &SystemRoles) -> Vec<Diagnostic> {
    let mut found = without_functionality(system);
    found.extend(unused_functionalities(system));
    let suggestions = Suggestions::default();
    found.extend(in_no_formula(system, &suggestions));
    let activities: BTreeSet<&str> =
        system.activities.iter().map(|activity| activity.name.as_str()).collect();
    let unknown = system.roles.iter().flat_map(|role| unknown_names(system, &activities, role, &suggestions));
    found.extend(unknown);
    found
}

fn warning(code: &'static str, span: Span, message: String, hint: &str) -> Diagnostic {
    Diagnostic::warning(code, span, message).with_hint(hint)
}

fn without_functionality(system: &SystemRoles) -> Vec<Diagnostic> {
    let without = system.activities.iter().filter(|activity| activity.functionality.is_none());
    without
        .map(|activity| {
            let message = format!("the activity `{}` has no functionality", activity.name);
            warning("S01", activity.position.0, message, "name the functionality that it uses")
        })
        .collect()
}

fn unused_functionalities(system: &SystemRoles) -> Vec<Diagnostic> {
    let used: BTreeSet<usize> =
        system.activities.iter().filter_map(|activity| activity.functionality).collect();
    let unused = system.functionalities.iter().enumerate().filter(|(index, _)| !used.contains(index));
    unused
        .map(|(_, functionality)| {
            let message = format!("no activity uses the functionality `{}`", functionality.description);
            warning(
                "S02",
                functionality.position.0,
                message,
                "name it in the activities that use it, or remove it",
            )
        })
        .collect()
}

/// The names in the formulas of a role, without the names of the formulas themselves.
fn names(role: &Role) -> BTreeSet<String> {
    let (liveness, _) = liveness::parse(&role.liveness);
    let formulas: BTreeSet<&str> = liveness.formulas().iter().map(|formula| formula.name.as_str()).collect();
    let names = liveness.formulas().iter().flat_map(|formula| liveness.names(formula)).map(|(name, _)| name);
    names.filter(|name| !formulas.contains(name)).map(String::from).collect()
}

fn in_no_formula(system: &SystemRoles, suggestions: &Suggestions) -> Vec<Diagnostic> {
    let named: BTreeSet<String> = system.roles.iter().flat_map(names).collect();
    let unnamed = system.activities.iter().filter(|activity| !named.contains(&activity.name));
    unnamed
        .map(|activity| {
            let message = format!("the activity `{}` occurs in no formula", activity.name);
            let found = warning(
                "S03",
                activity.position.0,
                message,
                "add it to the formula of the role that executes it",
            );
            found.with_suggestion(suggestions, &activity.name, named.iter().map(String::as_str))
        })
        .collect()
}

fn unknown_names(
    system: &SystemRoles,
    activities: &BTreeSet<&str>,
    role: &Role,
    suggestions: &Suggestions,
) -> Vec<Diagnostic> {
    let known = || system.activities.iter().map(|activity| activity.name.as_str());
    let unknown = names(role).into_iter().filter(|name| !activities.contains(name.as_str()));
    unknown
        .map(|name| {
            let message =
                format!("`{name}` in the formulas of `{}` is not an activity of the model", role.name);
            let found = warning("S05", role.liveness_position.0, message, "add an activity of that name");
            found.with_suggestion(suggestions, &name, known())
        })
        .collect()
}

fn participants(aip: &Aip) -> Vec<Diagnostic> {
    let taking_part: BTreeSet<usize> =
        aip.protocols.iter().flat_map(|protocol| protocol.participants.iter().copied()).collect();
    let alone = aip.participants.iter().enumerate().filter(|(index, _)| !taking_part.contains(index));
    alone
        .map(|(_, participant)| {
            let message = format!("`{}` takes part in no protocol", participant.name);
            warning("S04", participant.position.0, message, "name it among the participants of a protocol")
        })
        .collect()
}
