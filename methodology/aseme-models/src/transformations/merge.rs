//! EAC into IAC: merges a protocol's chart into the charts of its participants.

use std::collections::BTreeMap;

use yase::{Diagnostic, Span};

use crate::iac::{Iac, IacTransition};

/// Merges a protocol's chart into the chart of a role: each composite with the name of a
/// participant gets the variables and refinements of the participant's states and transitions.
///
/// Returns the labels of the composites that were found. A composite with another structure than
/// the participant stays unchanged and is an error (E0835), because the role would violate the
/// protocol. Where the role contradicts the protocol, the protocol takes precedence (E0836). A
/// protocol without any matching composite is reported (E0837).
pub fn merge_eac(iac: &mut Iac, eac: &Iac) -> (Vec<String>, Vec<Diagnostic>) {
    let mut merging = ChartMerge {
        variables: shared_variables(iac, eac),
        iac,
        eac,
        merged: Vec::new(),
        diagnostics: Vec::new(),
    };
    merging.constants();
    let participants = participants(eac);
    for &participant in &participants {
        let name = &eac.nodes[participant].name;
        let places: Vec<usize> = (0..merging.iac.nodes.len())
            .filter(|&node| merging.iac.nodes[node].kind == "OR" && merging.iac.nodes[node].name == *name)
            .collect();
        places.into_iter().for_each(|place| merging.composite(participant, place));
    }
    let (merged, mut diagnostics) = (merging.merged, merging.diagnostics);
    if merged.is_empty() && diagnostics.is_empty() {
        let names = participants
            .iter()
            .map(|&index| format!("`{}`", eac.nodes[index].name))
            .collect::<Vec<_>>()
            .join(", ");
        let message = format!("`{}` has none of the parts of `{}`: {names}", iac.name, eac.name);
        let hint = "a part is found by its name, which the role's formulas must refine";
        diagnostics.push(Diagnostic::warning("E0837", Span::default(), message).with_hint(hint));
    }
    (merged, diagnostics)
}

/// The composites in the regions of the protocol's AND; of a protocol with a single participant,
/// the one beside START and END.
pub fn participants(eac: &Iac) -> Vec<usize> {
    let children = eac.children();
    let of_kind = |nodes: &[usize], kind: &str| -> Vec<usize> {
        nodes.iter().copied().filter(|&node| eac.nodes[node].kind == kind).collect()
    };
    let top = children.first().map(Vec::as_slice).unwrap_or_default();
    let regions = of_kind(top, "AND").into_iter().flat_map(|and| children[and].clone());
    let inside: Vec<usize> = regions.flat_map(|region| of_kind(&children[region], "OR")).collect();
    if inside.is_empty() { of_kind(top, "OR") } else { inside }
}

/// The variable of the role for each variable of the protocol, added if it is missing.
fn shared_variables(iac: &mut Iac, eac: &Iac) -> Vec<usize> {
    eac.variables.iter().map(|variable| iac.variable(variable)).collect()
}

struct ChartMerge<'a> {
    iac: &'a mut Iac,
    eac: &'a Iac,
    variables: Vec<usize>,
    merged: Vec<String>,
    diagnostics: Vec<Diagnostic>,
}

impl ChartMerge<'_> {
    fn constants(&mut self) {
        for constant in &self.eac.constants {
            match self.iac.constants.iter().find(|own| own.name == constant.name) {
                None => self.iac.constants.push(constant.clone()),
                Some(own) if own.value == constant.value => {}
                Some(_) => {
                    let message =
                        format!("the constant `{}` has another value in the protocol", constant.name);
                    self.diagnostics.push(
                        Diagnostic::error("E0836", Span::default(), message)
                            .with_hint("give one of the two another name"),
                    );
                }
            }
        }
    }

    fn composite(&mut self, participant: usize, place: usize) {
        let pairs = match same_shape(self.eac, participant, self.iac, place, ShapeMatch::Refined) {
            Ok(pairs) => pairs,
            Err((wanted, found)) => return self.mismatch(participant, place, &wanted, &found),
        };
        for (&theirs, &own) in pairs.iter().skip(1) {
            let theirs = &self.eac.nodes[theirs];
            let variables = theirs.variables.iter().filter_map(|&index| self.variables.get(index).copied());
            let node = &mut self.iac.nodes[own];
            for variable in variables {
                if !node.variables.contains(&variable) {
                    node.variables.push(variable);
                }
            }
            if theirs.refinement != crate::iac::StateRefinement::default() {
                node.refinement = theirs.refinement.clone();
            }
        }
        self.transitions(&pairs);
        self.ways_in(participant, place);
        self.ways_out(participant, place);
        self.merged.push(self.iac.nodes[place].label.clone());
    }

    fn mismatch(&mut self, participant: usize, place: usize, wanted: &str, found: &str) {
        let name = &self.eac.nodes[participant].name;
        let message = format!(
            "`{name}` of `{}` differs from `{}`: {found} instead of {wanted}",
            self.iac.name, self.eac.name
        );
        let hint = "copy the formula of the participant";
        let span = self.iac.nodes[place].place.0;
        self.diagnostics.push(Diagnostic::error("E0835", span, message).with_hint(hint));
    }

    /// Copies the engaging rule of a part to all transitions of the role into it.
    fn ways_in(&mut self, participant: usize, place: usize) {
        let rule = |it: &&IacTransition| it.target == participant && it.source != participant;
        let Some(theirs) = self.eac.transitions.iter().find(rule) else { return };
        let own = self.iac.transitions.iter_mut().filter(|it| it.target == place && it.source != place);
        for own in own {
            // the role keeps its own selection order and weights
            let refinement = std::mem::take(&mut own.refinement);
            self.diagnostics.extend(copy_refinement(theirs, own));
            own.refinement = refinement;
        }
    }

    /// Adds the exits of a part, which lead to where the role continues after it.
    fn ways_out(&mut self, participant: usize, place: usize) {
        let theirs: Vec<&IacTransition> = self
            .eac
            .transitions
            .iter()
            .filter(|it| it.source == participant && it.target != participant)
            .collect();
        let own: Vec<usize> = (0..self.iac.transitions.len())
            .filter(|&index| {
                self.iac.transitions[index].source == place && self.iac.transitions[index].target != place
            })
            .collect();
        for (number, theirs) in theirs.into_iter().enumerate() {
            match own.get(number) {
                Some(&own) => {
                    self.diagnostics.extend(copy_refinement(theirs, &mut self.iac.transitions[own]))
                }
                None => {
                    let Some(&first) = own.first() else { return };
                    let target = self.iac.transitions[first].target;
                    let name = self.iac.usual_name(place, target);
                    self.iac.transitions.push(IacTransition {
                        source: place,
                        target,
                        name,
                        ..theirs.clone()
                    });
                }
            }
        }
    }

    /// Merges transitions with both ends inside; several between the same two ends are matched in
    /// order.
    fn transitions(&mut self, pairs: &BTreeMap<usize, usize>) {
        let mut seen: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        for theirs in &self.eac.transitions {
            let ends = (pairs.get(&theirs.source), pairs.get(&theirs.target));
            let (Some(&source), Some(&target)) = ends else { continue };
            let number = seen.entry((source, target)).or_default();
            let mut alike =
                self.iac.transitions.iter_mut().filter(|own| (own.source, own.target) == (source, target));
            match alike.nth(*number) {
                Some(own) => self.diagnostics.extend(copy_refinement(theirs, own)),
                None => {
                    let name = self.iac.usual_name(source, target);
                    self.iac.transitions.push(IacTransition { source, target, name, ..theirs.clone() });
                }
            }
            *number += 1;
        }
    }
}

/// Refinements of the protocol take precedence.
fn copy_refinement(theirs: &IacTransition, own: &mut IacTransition) -> Option<Diagnostic> {
    let says = |transition: &IacTransition| {
        !transition.te.is_empty() || transition.refinement != crate::iac::TransitionRefinement::default()
    };
    if !says(theirs) {
        return None;
    }
    let differs = says(own) && (&own.te, &own.refinement) != (&theirs.te, &theirs.refinement);
    let found = differs.then(|| {
        let message =
            format!("`{}` was on `{}` of the role; the protocol has `{}`", own.te, own.name, theirs.te);
        Diagnostic::warning("E0836", own.place.0, message)
    });
    (own.te, own.refinement) = (theirs.te.clone(), theirs.refinement.clone());
    found
}

/// How similar two composites must be.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ShapeMatch {
    /// The same.
    Same,
    /// The second may refine activities of the first into several steps.
    Refined,
}

/// The corresponding node for each node of a composite, starting with the composites themselves, or
/// the first two nodes that differ.
pub fn same_shape(
    eac: &Iac,
    participant: usize,
    iac: &Iac,
    place: usize,
    wanted: ShapeMatch,
) -> Result<BTreeMap<usize, usize>, (String, String)> {
    let (theirs, own) = (eac.children(), iac.children());
    let mut pairs = BTreeMap::new();
    let mut open = vec![(participant, place)];
    while let Some((a, b)) = open.pop() {
        pairs.insert(a, b);
        let longest = theirs[a].len().max(own[b].len());
        for index in 0..longest {
            match (theirs[a].get(index), own[b].get(index)) {
                (Some(&a), Some(&b)) if node_content(eac, a) == node_content(iac, b) => open.push((a, b)),
                (Some(&a), Some(&b)) if wanted == ShapeMatch::Refined && is_refined(eac, a, iac, b) => {
                    pairs.insert(a, b);
                }
                (a, b) => {
                    let shown = |chart: &Iac, node: Option<&usize>| {
                        node.map_or("nothing".into(), |&node| node_content(chart, node))
                    };
                    return Err((shown(eac, a), shown(iac, b)));
                }
            }
        }
    }
    Ok(pairs)
}

/// Whether an activity of one chart is a composite of that name in another.
fn is_refined(eac: &Iac, a: usize, iac: &Iac, b: usize) -> bool {
    let (theirs, own) = (&eac.nodes[a], &iac.nodes[b]);
    theirs.name == own.name && theirs.kind == "BASIC" && matches!(own.kind.as_str(), "OR" | "AND")
}

/// The content of a node except its label.
fn node_content(chart: &Iac, node: usize) -> String {
    let node = &chart.nodes[node];
    if node.name == node.label { node.kind.clone() } else { format!("{} {}", node.written(), node.kind) }
}
