//! Streams of random numbers, one for each component.
//!
//! A component's stream is seeded by a hash of the world's seed and the component's path, so adding
//! a component or drawing more often in one does not change what another draws.

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// The random numbers of one component.
#[derive(Debug, Clone)]
pub(crate) struct RandomStream(Pcg64);

impl RandomStream {
    /// The stream of the component at `path`, such as `robot/1/2/gait`.
    pub(crate) fn new(seed: u64, path: &str) -> Self {
        let hash = blake3::Hasher::new().update(&seed.to_le_bytes()).update(path.as_bytes()).finalize();
        Self(Pcg64::from_seed(*hash.as_bytes()))
    }

    /// Uniformly distributed in `[0, 1)`.
    pub(crate) fn uniform(&mut self) -> f64 {
        const SCALE: f64 = 1.0 / (1u64 << 53) as f64;
        (self.0.next_u64() >> 11) as f64 * SCALE
    }

    /// True with the given probability; always draws one number.
    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.uniform() < probability
    }

    /// Normally distributed around zero (Box-Muller; the second number of the pair is not kept, so
    /// that a stream's state is its generator alone).
    pub(crate) fn normal(&mut self, deviation: f64) -> f64 {
        let radius = (-2.0 * libm::log(1.0 - self.uniform())).sqrt();
        deviation * radius * libm::cos(std::f64::consts::TAU * self.uniform())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_differ_by_seed_and_path_and_repeat() {
        let first = |seed, path| RandomStream::new(seed, path).uniform();
        assert_eq!(first(1, "a"), first(1, "a"));
        assert_ne!(first(1, "a"), first(1, "b"));
        assert_ne!(first(1, "a"), first(2, "a"));
    }

    #[test]
    fn normal_numbers_have_their_deviation() {
        let mut stream = RandomStream::new(3, "normal");
        let draws: Vec<f64> = (0..20_000).map(|_| stream.normal(2.0)).collect();
        let mean = draws.iter().sum::<f64>() / draws.len() as f64;
        let variance = draws.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / draws.len() as f64;
        assert!(mean.abs() < 0.06, "{mean}");
        assert!((variance.sqrt() - 2.0).abs() < 0.06, "{variance}");
    }

    #[test]
    fn uniform_numbers_fill_the_unit_interval() {
        let mut stream = RandomStream::new(4, "uniform");
        let draws: Vec<f64> = (0..10_000).map(|_| stream.uniform()).collect();
        assert!(draws.iter().all(|x| (0.0..1.0).contains(x)));
        let below = draws.iter().filter(|x| **x < 0.25).count();
        assert!((2350..2650).contains(&below), "{below}");
    }
}
