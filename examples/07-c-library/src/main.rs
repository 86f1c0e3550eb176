//! An activity that calls a library written in C.
//!
//! Run it with `cargo run -p example-c-library --features c`: `build.rs` compiles `c/median.c` with
//! the crate `cc` for the target of the program, so that `monas deploy` works as usual. `median.rs`
//! wraps its one function. The activity filters a noisy distance with outliers; it owns the
//! filter's state.

mod median;

use median::Median;
use monas::{Activity, Agent, Blackboard, BoxError, Hz, Progress, Talws};

/// Filters a distance measurement.
#[derive(Default)]
struct Filter {
    median: Median,
}

/// A sensor that fails at every seventh reading.
fn measured(cycle: u64) -> f64 {
    if cycle % 7 == 3 { 99.0 } else { 1.0 + cycle as f64 / 100.0 }
}

impl Activity for Filter {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let measured = measured(blackboard.now().as_nanos() / 100_000_000);
        println!("measured {measured:5.2} m, filtered {:.2} m", self.median.next(measured));
        Ok(Progress::Done)
    }
}

fn main() -> Result<(), monas::Error> {
    let agent = Agent::new("distance", Hz(10)).activity(Filter::default());
    Talws::new().agent(agent).simulate(1)?.run_until(monas::Timestamp::from_nanos(1_400_000_000))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absurd_values_are_filtered() {
        let mut median = Median::default();
        let filtered: Vec<f64> = (0..14).map(|cycle| median.next(measured(cycle))).collect();
        assert!(filtered.iter().all(|distance| *distance < 1.2), "{filtered:?}");
        assert!(filtered.is_sorted(), "{filtered:?}");
    }
}
