//! Resolution of nondeterminism.

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use crate::machine::snapshot::ChooserRecord;

/// Resolves nondeterminism: which of several timers that expire at one time comes first, which
/// probabilistic branch is taken, and, under
/// [`ConflictResolution::Random`](crate::ConflictResolution::Random), which of two conflicting
/// transitions wins.
///
/// It is called only where there are at least two options. Equal choosers return equal choices for
/// equal calls.
#[derive(Clone, Debug)]
pub struct Chooser {
    policy: ChoicePolicy,
}

#[derive(Clone, Debug)]
enum ChoicePolicy {
    Declared,
    Seeded { seed: u64, drawn: u64, generator: Box<Pcg64> },
    Scripted { choices: Vec<u32>, log: Vec<(u32, u32)> },
}

impl Default for Chooser {
    fn default() -> Chooser {
        Chooser::declared()
    }
}

impl Chooser {
    /// Takes the option that the model declares first.
    pub const fn declared() -> Chooser {
        Chooser { policy: ChoicePolicy::Declared }
    }

    /// Uses a 64-bit PCG generator, with one number per choice. Among n equal options it takes
    /// number · n / 2⁶⁴; among weighted ones the first whose cumulative weight exceeds (number /
    /// 2¹¹) / 2⁵³ of the total.
    pub fn seeded(seed: u64) -> Chooser {
        let generator = Box::new(Pcg64::seed_from_u64(seed));
        Chooser { policy: ChoicePolicy::Seeded { seed, drawn: 0, generator } }
    }

    /// Takes the given options in turn (the last available one, if a number is too high), then
    /// always the first, and records each choice: for exploration.
    pub fn scripted(choices: Vec<u32>) -> Chooser {
        Chooser { policy: ChoicePolicy::Scripted { choices, log: Vec::new() } }
    }

    /// Whether it takes the option declared first, so that no choice needs to be made.
    pub fn is_declared(&self) -> bool {
        matches!(self.policy, ChoicePolicy::Declared)
    }

    /// The seed, if it was made from one.
    pub fn seed(&self) -> Option<u64> {
        match self.policy {
            ChoicePolicy::Seeded { seed, .. } => Some(seed),
            _ => None,
        }
    }

    /// The choices of a scripted chooser so far: the option, and the number of options.
    pub fn choices(&self) -> &[(u32, u32)] {
        match &self.policy {
            ChoicePolicy::Scripted { log, .. } => log,
            _ => &[],
        }
    }

    /// Chooses among equal options.
    pub(crate) fn choose(&mut self, options: usize) -> usize {
        self.decide(options, |number| ((u128::from(number) * options as u128) >> 64) as usize)
    }

    /// The state on which its later choices depend.
    pub(crate) fn record(&self) -> ChooserRecord {
        match &self.policy {
            ChoicePolicy::Declared => ChooserRecord::Declared,
            ChoicePolicy::Seeded { seed, drawn, .. } => ChooserRecord::Seeded { seed: *seed, drawn: *drawn },
            ChoicePolicy::Scripted { choices, log } => {
                ChooserRecord::Scripted { choices: choices.clone(), made: log.clone() }
            }
        }
    }

    pub(crate) fn restored(record: &ChooserRecord) -> Chooser {
        let policy = match record {
            ChooserRecord::Declared => ChoicePolicy::Declared,
            ChooserRecord::Seeded { seed, drawn } => {
                let mut generator = Box::new(Pcg64::seed_from_u64(*seed));
                generator.advance(u128::from(*drawn));
                ChoicePolicy::Seeded { seed: *seed, drawn: *drawn, generator }
            }
            ChooserRecord::Scripted { choices, made } => {
                ChoicePolicy::Scripted { choices: choices.clone(), log: made.clone() }
            }
        };
        Chooser { policy }
    }

    /// Chooses among options with the probabilities given by their weights.
    pub(crate) fn draw(&mut self, weights: &[f64]) -> usize {
        self.decide(weights.len(), |number| {
            let unit = (number >> 11) as f64 / (1_u64 << 53) as f64;
            share(weights, unit)
        })
    }

    fn decide(&mut self, options: usize, option: impl FnOnce(u64) -> usize) -> usize {
        if options < 2 {
            return 0;
        }
        match &mut self.policy {
            ChoicePolicy::Declared => 0,
            ChoicePolicy::Seeded { drawn, generator, .. } => {
                *drawn += 1;
                option(generator.next_u64())
            }
            ChoicePolicy::Scripted { choices, log } => {
                let wanted = choices.get(log.len()).copied().unwrap_or(0);
                let chosen = wanted.min(options as u32 - 1);
                log.push((chosen, options as u32));
                chosen as usize
            }
        }
    }
}

/// The option in whose share a fraction of the total weight ends.
fn share(weights: &[f64], part: f64) -> usize {
    let (drawn, mut sum) = (part * weights.iter().sum::<f64>(), 0.0);
    let taken = weights.iter().position(|weight| {
        sum += weight;
        sum > drawn
    });
    taken.unwrap_or(weights.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_of_what_the_weights_sum_to_and_end_before_the_next_begins() {
        let taken = |part| share(&[0.25, 0.125, 0.125], part);
        assert_eq!([0.0, 0.25, 0.49, 0.5, 0.74, 0.75, 0.99].map(taken), [0, 0, 0, 1, 1, 2, 2]);
        assert_eq!(taken(1.0), 2, "rounding does not lead beyond the last");
    }

    #[test]
    fn a_restored_chooser_continues() {
        let mut chooser = Chooser::seeded(7);
        assert_eq!(chooser.seed(), Some(7));
        let draw = |times: usize, chooser: &mut Chooser| -> Vec<usize> {
            (0..times).map(|_| chooser.choose(1000)).collect()
        };
        draw(5, &mut chooser);
        let mut again = Chooser::restored(&chooser.record());
        assert_eq!((again.seed(), again.is_declared()), (Some(7), false));
        assert_eq!(draw(5, &mut chooser), draw(5, &mut again));

        let mut scripted = Chooser::scripted(vec![1, 2]);
        scripted.choose(3);
        let mut again = Chooser::restored(&scripted.record());
        assert_eq!((again.choose(3), again.choices()), (2, [(1, 3), (2, 3)].as_slice()));
        assert!(Chooser::restored(&Chooser::declared().record()).is_declared());
    }

    #[test]
    fn a_scripted_chooser_replays_and_notes_what_it_chose() {
        let mut chooser = Chooser::scripted(vec![1, 7]);
        let chosen = [chooser.choose(2), chooser.choose(1), chooser.choose(3), chooser.draw(&[0.5, 0.5])];
        assert_eq!(chosen, [1, 0, 2, 0]);
        assert_eq!(chooser.choices(), [(1, 2), (2, 3), (0, 2)]);
    }

    #[test]
    fn a_seeded_chooser_draws_in_proportion_and_the_same_again() {
        let count = |seed| {
            let mut chooser = Chooser::seeded(seed);
            (0..10_000).filter(|_| chooser.draw(&[0.8, 0.2]) == 1).count()
        };
        assert_eq!(count(7), count(7));
        assert!((1800..2200).contains(&count(7)), "{}", count(7));
        let mut chooser = Chooser::seeded(1);
        let ones = (0..10_000).filter(|_| chooser.choose(4) == 3).count();
        assert!((2300..2700).contains(&ones), "{ones}");
    }

    #[test]
    fn a_declared_chooser_takes_the_first() {
        let mut chooser = Chooser::declared();
        assert_eq!([chooser.choose(5), chooser.draw(&[0.1, 0.9])], [0, 0]);
        assert!(chooser.is_declared() && chooser.seed().is_none() && chooser.choices().is_empty());
    }
}
