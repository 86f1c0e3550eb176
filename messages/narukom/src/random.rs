//! The only source of randomness of an activity.

use std::convert::Infallible;
use std::fmt;

use rand_core::{Rng, SeedableRng, TryRng};
use rand_pcg::Pcg64;

/// A random number generator that depends on its seed and on nothing else.
///
/// The generator is PCG XSL RR 128/64 (O'Neill 2014). It implements [`rand_core::TryRng`], so
/// distributions of other crates can use it.
///
/// ```
/// use narukom::Random;
///
/// let mut one = Random::from_seed([7; 32]);
/// let mut other = one.clone();
/// assert_eq!(one.uniform(), other.uniform());
/// assert!((0.0..1.0).contains(&one.uniform()));
/// ```
#[derive(Clone, PartialEq, Eq)]
pub struct Random(Pcg64);

impl Random {
    /// Creates the generator with that seed.
    pub fn from_seed(seed: [u8; 32]) -> Random {
        Random(Pcg64::from_seed(seed))
    }

    /// A number in [0, 1), every multiple of 2⁻⁵³ equally likely.
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// An integer in [0, `limit`), each equally likely; 0 if `limit` is 0.
    pub fn below(&mut self, limit: u64) -> u64 {
        // The high half of a 128-bit product; draws that would favour small numbers are rejected
        // (Lemire 2019).
        let unfair = limit.wrapping_neg().checked_rem(limit).unwrap_or(0);
        loop {
            let product = u128::from(self.0.next_u64()) * u128::from(limit);
            if limit == 0 || product as u64 >= unfair {
                return (product >> 64) as u64;
            }
        }
    }

    /// True with the given probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.uniform() < probability
    }
}

impl TryRng for Random {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        self.0.try_next_u32()
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        self.0.try_next_u64()
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        self.0.try_fill_bytes(bytes)
    }
}

/// The state is long and not informative.
impl fmt::Debug for Random {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Random")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_equally_likely() {
        let mut random = Random::from_seed([1; 32]);
        let mut counts = [0_u32; 6];
        (0..60_000).for_each(|_| counts[random.below(6) as usize] += 1);
        assert!(counts.iter().all(|count| count.abs_diff(10_000) < 400), "{counts:?}");
    }

    #[test]
    fn limits_at_the_edges_are_met() {
        let mut random = Random::from_seed([2; 32]);
        assert_eq!(random.below(0), 0);
        assert_eq!(random.below(1), 0);
        assert!(random.below(u64::MAX) < u64::MAX);
        assert!(!random.chance(0.0));
        assert!(random.chance(1.0));
    }

    #[test]
    fn seeds_give_streams_of_their_own() {
        let mut streams = [0_u8, 1, 2].map(|seed| Random::from_seed([seed; 32]));
        let first = streams.each_mut().map(|stream| stream.uniform().to_bits());
        assert!(first[0] != first[1] && first[1] != first[2] && first[0] != first[2]);
    }
}
