//! Searches the parameters of the project's own motions by CMA-ES, in the world of the server.
//!
//! ```text
//! cargo run --release -p monas-rcsssmj --features motion-search --example motion_search -- walk --seed 1 --generations 60
//! cargo run --release -p monas-rcsssmj --features motion-search --example motion_search -- walk --robot K1 --generations 60
//! ```
//!
//! The package rcsssmj of PyPI has to be installed: a child process makes the cycles of the server,
//! with its physics and without its sockets. The text of the parameters goes to standard output,
//! the progress to standard error. The same command gives the same parameters, on one computer.

mod kicking;
mod walking;
mod world;

use std::error::Error;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use cmaes::{CMAESOptions, DVector};
use monas_rcsssmj::{Humanoid, SineParameters};
use rand_core::SeedableRng;
use rand_pcg::Pcg32;
use world::World;

/// Parameter sets of a generation.
const POPULATION: usize = 20;
/// Trials of the parameters that are found.
const VALIDATION: usize = 10;

/// A parameter to search: its name, where the search begins, and its first deviation.
pub(crate) type Searched = (&'static str, f64, f64);

/// A motion whose parameters are searched.
pub(crate) trait Motion: Sync {
    /// The parameters.
    fn searched(&self) -> &[Searched];
    /// The cost of a motion with these values in a world, in trials that differ by chance.
    fn cost(&self, values: &[f64], world: &mut World, chance: &mut Pcg32) -> Result<f64, Box<dyn Error>>;
    /// The file with these values.
    fn file(&self, values: &[f64]) -> String;
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let option = |name: &str| {
        let at = arguments.iter().position(|argument| argument == name);
        at.map(|at| arguments.get(at + 1).map_or("", |text| text))
    };
    let number = |name: &str, default: u64| option(name).map_or(Ok(default), str::parse);
    let (seed, generations) = (number("--seed", 1)?, number("--generations", 60)?);
    let robot = option("--robot").unwrap_or("T1");
    let robot =
        Humanoid::named(robot).ok_or_else(|| format!("there is no robot `{robot}`, but T1 and K1"))?;
    let motion: &dyn Motion = match arguments.first().map(String::as_str) {
        Some("walk") => &walking::Walking::of(robot),
        Some("kick") => &kicking::Kicking::of(robot, SineParameters::own(robot)?),
        _ => return Err("expected `walk` or `kick`".into()),
    };
    Search { robot, motion, seed, worlds: Mutex::default(), failure: Mutex::default() }.run(generations)
}

struct Search<'a> {
    robot: &'static Humanoid,
    motion: &'a dyn Motion,
    seed: u64,
    worlds: Mutex<Vec<World>>,
    failure: Mutex<Option<String>>,
}

impl Search<'_> {
    fn run(&self, generations: u64) -> Result<(), Box<dyn Error>> {
        let searched = self.motion.searched();
        let evaluations = AtomicUsize::new(0);
        let objective = |point: &DVector<f64>| {
            // All of a generation have the same trials, those of the next one others.
            let generation = evaluations.fetch_add(1, Ordering::Relaxed) / POPULATION;
            self.cost(&values(searched, point), generation as u64).unwrap_or_else(|error| {
                if let Ok(mut failure) = self.failure.lock() {
                    failure.get_or_insert(error.to_string());
                }
                f64::NAN
            })
        };
        let mut search = CMAESOptions::new(vec![0.0; searched.len()], 1.0)
            .population_size(POPULATION)
            .seed(self.seed)
            .max_generations(generations as usize)
            .tol_fun(0.0)
            .tol_fun_hist(0.0)
            .tol_stagnation(10 * generations as usize)
            .build(objective)
            .map_err(|error| format!("{error:?}"))?;
        while search.next_parallel().is_none() {
            let best = search.current_best_individual().map_or(f64::NAN, |best| best.value);
            eprintln!("generation {} best {best:.3} sigma {:.3}", search.generation(), search.sigma());
        }
        if let Ok(Some(failure)) = self.failure.lock().map(|mut failure| failure.take()) {
            return Err(failure.into());
        }
        let best = search.overall_best_individual().map(|best| &best.point);
        let mut found: Option<(f64, Vec<f64>)> = None;
        for point in [Some(search.mean()), best].into_iter().flatten() {
            let values = values(searched, point);
            let trials = (0..VALIDATION).map(|trial| self.cost(&values, u64::MAX - trial as u64));
            let cost = trials.sum::<Result<f64, _>>()? / VALIDATION as f64;
            if found.as_ref().is_none_or(|(min, _)| cost < *min) {
                found = Some((cost, values));
            }
        }
        let Some((cost, values)) = found else { return Err("nothing was found".into()) };
        println!("# cost {cost:.3} over {VALIDATION} trials, seed {}, generations {generations}", self.seed);
        print!("{}", self.motion.file(&values));
        Ok(())
    }

    fn cost(&self, values: &[f64], trial: u64) -> Result<f64, Box<dyn Error>> {
        let idle = self.worlds.lock().ok().and_then(|mut worlds| worlds.pop());
        let mut world = idle.map_or_else(|| World::new(self.robot), Ok)?;
        let mut chance = Pcg32::seed_from_u64(self.seed ^ (trial << 20));
        let cost = self.motion.cost(values, &mut world, &mut chance)?;
        if let Ok(mut worlds) = self.worlds.lock() {
            worlds.push(world);
        }
        Ok(cost)
    }
}

/// The parameters with which the search of a robot begins: some begin elsewhere than for the T1.
pub(crate) fn begin(searched: &[Searched], elsewhere: &[(&str, f64)]) -> Vec<Searched> {
    let start = |&(name, start, step): &Searched| {
        let other = elsewhere.iter().find(|(other, _)| *other == name);
        (name, other.map_or(start, |(_, start)| *start), step)
    };
    searched.iter().map(start).collect()
}

/// The values at a point of the search space, with four digits.
fn values(searched: &[Searched], point: &DVector<f64>) -> Vec<f64> {
    let value = |((_, start, step), at): (&Searched, &f64)| ((start + step * at) * 1e4).round() / 1e4;
    searched.iter().zip(point.iter()).map(value).collect()
}
