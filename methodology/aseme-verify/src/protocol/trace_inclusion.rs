//! Trace inclusion of a participant within the whole player: whenever the part is engaged, it
//! follows the protocol.
//!
//! The player's chart is explored as a whole, except regions that run beside the part forever
//! without influence on it. From the entry of the part to its exit the returning activities are
//! compared with the formulas of the participant; an exit by an outcome ends the comparison.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use yase::NodeId;
use yase_explore::{LabelledGraph, StepCause, StepLabeler, StepObservation, explore_labelled};

use super::{Conformance, MAX_STATES};
use crate::abstraction::Abstraction;
use crate::checked_model;
use crate::cone_of_influence;
use crate::conformance::derivatives::{Language, Residual, Symbol};
use crate::exploration_extent::ExplorationExtent;
use aseme::liveness::Liveness;
use aseme_models::iac::Iac;
use aseme_models::transformations::{ShapeMatch, same_shape};

/// Bits of the observation of a step; the bits above them hold one more than the symbol of the
/// returned activity.
const ENTERS: u64 = 1;
const LEAVES: u64 = 2;
const DONE: u32 = 2;

/// Compares a player's part with the formulas of the protocol wherever the player's whole chart
/// engages in it.
pub(crate) fn in_whole(
    player: &Iac,
    index: usize,
    (eac, part): (&Iac, usize),
    liveness: &Liveness,
    found: &mut Conformance,
) {
    let (Some((language, all)), Ok(pairs)) =
        (Language::new(liveness), same_shape(eac, part, player, index, ShapeMatch::Refined))
    else {
        return;
    };
    let (subject, _) = checked_model::of_chart(player);
    let abstraction = match Abstraction::new(&subject) {
        Ok(abstraction) => abstraction,
        Err(reasons) => return found.findings.extend(reasons),
    };
    let shown = ProtocolAlphabet::new(player, eac, index, &pairs, &language);
    let explored = shown.explored(&abstraction);
    let name = &player.nodes[index].name;
    let extent = ExplorationExtent::of_labelled(&explored);
    let states = extent.states;
    found.explored.push((format!("{name} within {}", player.name), extent));
    let message = match first_beyond(&explored, language, all) {
        TraceInclusion::Nothing if explored.is_finished() => return,
        TraceInclusion::Nothing | TraceInclusion::TooMuch => {
            let message = format!(
                "`{}` is too large: {states} states do not cover all its behaviour as `{name}`",
                player.name
            );
            return found.report(
                "E0869",
                player.nodes[index].position.0,
                message,
                "split it into several charts",
            );
        }
        TraceInclusion::Beyond(done) => {
            format!("`{}` executes `{done}` as `{name}` where the protocol does not allow it", player.name)
        }
    };
    found.report(
        "E0867",
        player.nodes[index].position.0,
        message,
        "a transition enters the middle of the part",
    );
}

/// Maps the steps of a player to symbols of the protocol.
struct ProtocolAlphabet {
    part: NodeId,
    /// The states whose activities the protocol names.
    activities: BTreeMap<NodeId, Symbol>,
    /// The composites that are activities in the protocol.
    composites: BTreeMap<NodeId, Symbol>,
}

impl ProtocolAlphabet {
    fn new(
        player: &Iac,
        eac: &Iac,
        position: usize,
        pairs: &BTreeMap<usize, usize>,
        language: &Language,
    ) -> ProtocolAlphabet {
        let node = |index: usize| NodeId(index as u32);
        let mut shown = ProtocolAlphabet {
            part: node(position),
            activities: BTreeMap::new(),
            composites: BTreeMap::new(),
        };
        for (&theirs, &own) in pairs {
            let letter = language.find(&eac.nodes[theirs].name);
            if let Some(letter) = letter.filter(|_| eac.nodes[theirs].kind == "BASIC") {
                let is_one = player.nodes[own].kind == "BASIC";
                let kind = if is_one { &mut shown.activities } else { &mut shown.composites };
                kind.insert(node(own), letter);
            }
        }
        shown
    }

    fn explored(&self, abstraction: &Abstraction) -> LabelledGraph {
        let statechart = abstraction.chart.statechart();
        let mut surroundings = abstraction.surroundings();
        surroundings.messages = true;
        let mut asked = StepLabeler {
            conditions: 0,
            idle: cone_of_influence::idle_but(statechart, &|region| {
                cone_of_influence::is_within(statechart, self.part, region)
            }),
            pace: None,
            letter: Box::new(|seen: &StepObservation<'_>| {
                let done = self.done(seen, |transition| {
                    let transition = statechart.transition(transition);
                    (
                        transition.source,
                        cone_of_influence::is_within(statechart, transition.target, self.part),
                    )
                });
                let bit = |nodes: &[NodeId], bit| if nodes.contains(&self.part) { bit } else { 0 };
                let letter = done.map_or(0, |letter| u64::from(letter) + 1);
                letter << DONE | bit(seen.entered, ENTERS) | bit(seen.left, LEAVES)
            }),
        };
        explore_labelled(&abstraction.chart, &mut surroundings, &mut asked, MAX_STATES)
    }

    /// The symbol of the activity that a step completed.
    fn done(
        &self,
        seen: &StepObservation<'_>,
        ends_of: impl Fn(yase::TransitionId) -> (NodeId, bool),
    ) -> Option<Symbol> {
        let returned = match seen.cause {
            StepCause::Return(node) => self.activities.get(node),
            _ => None,
        };
        let completed = || {
            seen.taken.iter().find_map(|&id| {
                let (source, stays) = ends_of(id);
                self.composites.get(&source).filter(|_| stays)
            })
        };
        returned.or_else(completed).copied()
    }
}

enum TraceInclusion {
    Nothing,
    /// An activity that is not allowed.
    Beyond(String),
    TooMuch,
}

/// A state of the player, and the residuals of the formulas while it is engaged.
type PartPosition = (usize, Option<BTreeSet<Residual>>);

fn first_beyond(found: &LabelledGraph, mut language: Language, all: Residual) -> TraceInclusion {
    let mut from = vec![Vec::new(); found.states().len()];
    let mut open: VecDeque<PartPosition> = VecDeque::new();
    let mut seen: BTreeSet<PartPosition> = BTreeSet::new();
    for (number, step) in found.steps().iter().enumerate() {
        match step.from {
            Some(state) => from[state].push(number),
            None => {
                let begun = (step.letter & ENTERS != 0).then(|| BTreeSet::from([all]));
                if seen.insert((step.to, begun.clone())) {
                    open.push_back((step.to, begun));
                }
            }
        }
    }
    while let Some((state, rests)) = open.pop_front() {
        if language.is_too_large() || seen.len() > MAX_STATES * 4 {
            return TraceInclusion::TooMuch;
        }
        for step in from[state].iter().map(|&number| &found.steps()[number]) {
            let done = (step.letter >> DONE).checked_sub(1).map(|letter| letter as Symbol);
            let mut rests = rests.clone();
            if let (Some(left), Some(letter)) = (&rests, done) {
                let after = language.derivative_of_any(left, letter);
                if after.is_empty() {
                    return TraceInclusion::Beyond(language.letters()[letter as usize].clone());
                }
                rests = Some(after);
            }
            if step.letter & LEAVES != 0 {
                rests = None;
            }
            if step.letter & ENTERS != 0 {
                rests = Some(BTreeSet::from([all]));
            }
            if seen.insert((step.to, rests.clone())) {
                open.push_back((step.to, rests));
            }
        }
    }
    TraceInclusion::Nothing
}
