//! Choices that the rules leave open: R22.

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// Policy for choices that the rules leave open.
#[derive(Clone, Debug, PartialEq)]
pub enum ChoicePolicy {
    /// Always the first option.
    Declared,
    /// By a generator with this seed.
    Seeded(u64),
    /// These options in turn, then always the first.
    Scripted(Vec<u32>),
}

/// Resolves choices and records them.
#[derive(Clone, Debug)]
pub(crate) struct ReferenceChooser {
    policy: ChoicePolicy,
    generator: Pcg64,
    /// The chosen options and the numbers of options.
    pub log: Vec<(u32, u32)>,
}

impl ReferenceChooser {
    pub(crate) fn new(policy: ChoicePolicy) -> ReferenceChooser {
        let seed = if let ChoicePolicy::Seeded(seed) = policy { seed } else { 0 };
        ReferenceChooser { policy, generator: Pcg64::seed_from_u64(seed), log: vec![] }
    }

    /// Chooses one of the options; a single option is not recorded.
    pub(crate) fn pick(&mut self, options: usize) -> usize {
        self.weighted(&vec![1.0; options])
    }

    /// Whether weights matter.
    pub(crate) fn uses_weights(&self) -> bool {
        !matches!(self.policy, ChoicePolicy::Declared)
    }

    /// Chooses one of several options, in proportion to their weights.
    pub(crate) fn weighted(&mut self, weights: &[f64]) -> usize {
        if weights.len() < 2 {
            return 0;
        }
        let chosen = match &self.policy {
            ChoicePolicy::Declared => 0,
            ChoicePolicy::Seeded(_) => self.generated(weights),
            ChoicePolicy::Scripted(choices) => {
                let next = choices.get(self.log.len()).copied().unwrap_or(0) as usize;
                next.min(weights.len() - 1)
            }
        };
        self.log.push((chosen as u32, weights.len() as u32));
        chosen
    }

    /// Maps a number of the generator to an option: equal options share the range evenly, others in
    /// proportion to their weights, in order.
    fn generated(&mut self, weights: &[f64]) -> usize {
        let draw = self.generator.next_u64();
        if weights.iter().all(|weight| *weight == 1.0) {
            return ((u128::from(draw) * weights.len() as u128) >> 64) as usize;
        }
        let mut left = (draw >> 11) as f64 / (1_u64 << 53) as f64 * weights.iter().sum::<f64>();
        let reached = weights.iter().position(|weight| {
            left -= weight;
            left < 0.0
        });
        reached.unwrap_or(weights.len() - 1)
    }

    /// The choices made by a script; the machine's chooser records only those.
    pub(crate) fn reported(&self) -> &[(u32, u32)] {
        match self.policy {
            ChoicePolicy::Scripted(_) => &self.log,
            _ => &[],
        }
    }
}
