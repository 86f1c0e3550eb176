//! The freedoms that rules leave: R22.

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// Who decides them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Freedom {
    /// Always the first option.
    Declared,
    /// A generator with that seed.
    Seeded(u64),
    /// These choices, then the first options.
    Scripted(Vec<u32>),
}

/// Decides, and remembers what it was asked.
#[derive(Clone, Debug)]
pub(crate) struct Chance {
    freedom: Freedom,
    generator: Pcg64,
    /// What was chosen, out of how many.
    pub log: Vec<(u32, u32)>,
}

impl Chance {
    pub(crate) fn new(freedom: Freedom) -> Chance {
        let seed = if let Freedom::Seeded(seed) = freedom { seed } else { 0 };
        Chance { freedom, generator: Pcg64::seed_from_u64(seed), log: vec![] }
    }

    /// One of so many options; a single one is not asked for.
    pub(crate) fn pick(&mut self, options: usize) -> usize {
        self.weighted(&vec![1.0; options])
    }

    /// Whether weights matter.
    pub(crate) fn draws(&self) -> bool {
        !matches!(self.freedom, Freedom::Declared)
    }

    /// One of several options, in proportion to their weights.
    pub(crate) fn weighted(&mut self, weights: &[f64]) -> usize {
        if weights.len() < 2 {
            return 0;
        }
        let chosen = match &self.freedom {
            Freedom::Declared => 0,
            Freedom::Seeded(_) => self.generated(weights),
            Freedom::Scripted(choices) => {
                let next = choices.get(self.log.len()).copied().unwrap_or(0) as usize;
                next.min(weights.len() - 1)
            }
        };
        self.log.push((chosen as u32, weights.len() as u32));
        chosen
    }

    /// Options that are alike share the generator's numbers evenly; others in proportion to their weights, one after the other.
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

    /// What a script was asked, which is all that the machine's chooser tells.
    pub(crate) fn told(&self) -> &[(u32, u32)] {
        match self.freedom {
            Freedom::Scripted(_) => &self.log,
            _ => &[],
        }
    }
}
