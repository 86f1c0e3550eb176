//! SAG to SUC: goals to use cases, actors to roles.

use yase::Diagnostic;

use crate::sag::{ActorGoal, Sag};
use crate::suc::{Suc, SystemRole, UseCase};

/// A role for each actor and a use case for each goal, in order. The participants of a use case are
/// the owner of the goal and the actors it depends on. The kinds of roles remain open.
///
/// A goal without an actor is an error (E0830).
pub fn sag_to_suc(sag: &Sag) -> (Suc, Vec<Diagnostic>) {
    let roles = sag
        .actors
        .iter()
        .map(|actor| SystemRole { name: actor.name.clone(), ..SystemRole::default() })
        .collect();
    let usecase = |goal: &ActorGoal| UseCase {
        name: goal.name.clone(),
        specified_by: goal.requirements.clone(),
        participants: participants(sag, goal),
        ..UseCase::default()
    };
    let usecases = sag.goals.iter().map(usecase).collect();
    let nobodys = sag.goals.iter().filter(|goal| goal.depender.is_none());
    let faults = nobodys.map(|goal| {
        let message = format!("the goal `{}` has no actor", goal.name);
        Diagnostic::error("E0830", goal.position.0, message).with_hint("name it by `depender = actor`")
    });
    (Suc { roles, usecases }, faults.collect())
}

fn participants(sag: &Sag, goal: &ActorGoal) -> Vec<usize> {
    let name = |actor: usize| sag.actors.get(actor).map(|actor| actor.name.to_lowercase());
    let mut participants: Vec<usize> = goal.depender.into_iter().collect();
    for &dependee in &goal.dependees {
        if goal.depender.is_none_or(|depender| name(depender) != name(dependee))
            && !participants.contains(&dependee)
        {
            participants.push(dependee);
        }
    }
    participants
}
