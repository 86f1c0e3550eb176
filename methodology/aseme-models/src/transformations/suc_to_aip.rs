//! SUC to AIP: use cases of several roles to protocols.

use yase::Diagnostic;

use super::{joined, system_participants};
use crate::aip::{Aip, Participant, Protocol};
use crate::suc::{Suc, UseCase};

/// A protocol for each use case that includes others and has several participants of the system; a
/// role of unspecified kind counts as one.
///
/// A model without such a use case is reported (E0831).
pub fn suc_to_aip(suc: &Suc) -> (Aip, Vec<Diagnostic>) {
    let mut aip = Aip::default();
    for usecase in &suc.usecases {
        let roles: Vec<usize> = system_participants(suc, usecase).collect();
        if roles.len() > 1 && !usecase.includes.is_empty() {
            let first = aip.participants.len();
            aip.participants.extend(roles.iter().map(|&role| participant(suc, usecase, role)));
            let participants = (first..aip.participants.len()).collect();
            aip.protocols.push(Protocol { participants, name: usecase.name.clone(), ..Protocol::default() });
        }
    }
    let message = "no use case becomes a protocol";
    let hint = "a protocol is a use case that includes others and has two participants of the system";
    let nothing = aip
        .protocols
        .is_empty()
        .then(|| Diagnostic::warning("E0831", yase::Span::default(), message).with_hint(hint));
    (aip, nothing.into_iter().collect())
}

fn participant(suc: &Suc, usecase: &UseCase, role: usize) -> Participant {
    let included = usecase.includes.iter().filter_map(|&index| suc.usecases.get(index));
    let own = included.filter(|included| included.participants.contains(&role));
    let liveness = joined(own.map(|included| included.name.as_str()));
    let name = suc.roles.get(role).map_or("", |role| role.name.as_str());
    Participant { name: format!("{}_{name}", usecase.name), liveness, ..Participant::default() }
}
