//! Random charts, scripts and semantics, made from a sequence of random bytes; shorter sequences
//! give smaller cases.

mod expressions;
mod nodes;
mod transitions;
mod variation_points;

use yase::statechart::{NodeId, Statechart};
use yase::{CompletionTrigger, EventMatching, Firing, Semantics, StructureRules, TopicId};

use crate::chooser::ChoicePolicy;
use crate::script::{Input, Script};

pub(crate) use variation_points::{POINTS, Variant, differs_somewhere, has};

/// Random choices from bytes; after the last byte always the first option.
pub(crate) struct Choices<'a> {
    bytes: std::slice::Iter<'a, u8>,
}

impl<'a> Choices<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Choices<'a> {
        Choices { bytes: bytes.iter() }
    }

    /// A number below `count`.
    fn below(&mut self, count: usize) -> usize {
        usize::from(self.bytes.next().copied().unwrap_or(0)) % count
    }

    fn percent(&mut self, percent: usize) -> bool {
        self.below(100) >= 100 - percent
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }
}

/// A chart, its inputs and its semantics.
#[derive(Clone)]
pub struct Case {
    /// The chart.
    pub chart: Statechart,
    /// Its inputs.
    pub script: Script,
    /// Its semantics.
    pub semantics: Semantics,
    /// The derivation of the semantics.
    pub(crate) variant: Variant,
    /// The resolution of open choices.
    pub policy: ChoicePolicy,
}

impl Case {
    /// The case with this number; always the same.
    pub fn numbered(number: u64) -> Case {
        let mut state = number.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03;
        let length = 300 + (next(&mut state) % 2500) as usize;
        let bytes: Vec<u8> = (0..length).map(|_| (next(&mut state) >> 33) as u8).collect();
        Case::from_choices(&mut Choices::new(&bytes))
    }

    fn from_choices(choices: &mut Choices<'_>) -> Case {
        let (semantics, variant) = variation_points::semantics(choices);
        let policy = policy(choices);
        let script = script(choices, &semantics);
        let mut maker =
            Maker { chart: Statechart::new("c"), choices, semantics, names: 0, timers: 0, short: vec![] };
        maker.composite(Statechart::ROOT, 0);
        maker.transitions();
        maker.weights();
        Case { chart: maker.chart, script, semantics, variant, policy }
    }
}

/// SplitMix64.
fn next(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (*state ^ (*state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

fn policy(choices: &mut Choices<'_>) -> ChoicePolicy {
    match choices.below(4) {
        0 => ChoicePolicy::Declared,
        1 => ChoicePolicy::Seeded(choices.below(256) as u64),
        _ => ChoicePolicy::Scripted((0..12).map(|_| choices.below(3) as u32).collect()),
    }
}

fn script(choices: &mut Choices<'_>, semantics: &Semantics) -> Script {
    let events: &[&str] = match semantics.matching {
        EventMatching::TokenPrefix => &["e", "f", "g", "h", "e.x", "e.x.y", "f.x", "ee"],
        _ => &["e", "f", "g", "h"],
    };
    let mut inputs: Vec<(u64, Input)> = (0..8 + choices.below(24))
        .map(|_| {
            let time = 5 * choices.below(30) as u64;
            let input = match choices.below(4) {
                0 => Input::Message(TopicId(choices.below(3) as u32), choices.below(4) as i64),
                _ => Input::Event(choices.pick(events).to_owned()),
            };
            (time, input)
        })
        .collect();
    inputs.sort_by_key(|(time, _)| *time);
    Script { inputs, until: 200 }
}

/// A chart under construction.
struct Maker<'a, 'b> {
    chart: Statechart,
    choices: &'a mut Choices<'b>,
    semantics: Semantics,
    names: usize,
    timers: usize,
    /// Regions that complete early.
    short: Vec<NodeId>,
}

impl Maker<'_, '_> {
    fn name(&mut self, prefix: &str) -> String {
        self.names += 1;
        format!("{prefix}{}", self.names)
    }

    /// Whether the forms that only UML allows may be made.
    fn makes_uml(&self) -> bool {
        self.semantics.structure == StructureRules::Uml
    }

    /// Charts that fire in phases have no CHOICE.
    fn has_choices(&self) -> bool {
        self.semantics.firing != Firing::Phases
    }

    /// Charts in which completion transitions do not wait need more triggers to become stable.
    fn is_hasty(&self) -> bool {
        matches!(self.semantics.eventless, CompletionTrigger::Always | CompletionTrigger::Quiescent)
    }

    fn parent(&self, node: NodeId) -> NodeId {
        self.chart.node(node).parent.unwrap_or(Statechart::ROOT)
    }

    fn is_inside(&self, node: NodeId, outer: NodeId) -> bool {
        self.chart.ancestors(node).any(|above| above == outer)
    }
}
