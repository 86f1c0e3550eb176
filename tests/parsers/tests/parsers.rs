//! Every target on its seeds, and on mutations of them.
#![allow(clippy::expect_used)] // test code

use std::fs;
use std::path::{Path, PathBuf};

use parser_tests::TARGETS;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// The mutations of each seed.
const MUTATIONS: usize = 400;
/// The targets that build their own inputs and change them as the bytes say.
const WITHOUT_SEEDS: [&str; 3] = ["control", "frames", "tape"];
/// The random inputs of each target.
const RANDOM: usize = 400;

fn fuzz() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz")
}

/// Calls a target with its seeds, mutations of them, and random bytes.
fn check(name: &str) {
    let (_, target) = TARGETS.iter().find(|target| target.0 == name).expect("the target exists");
    let seeds = seeds(name);
    assert_eq!(seeds.is_empty(), WITHOUT_SEEDS.contains(&name), "seeds of `{name}`");
    let mut random = Pcg64::seed_from_u64(seeds.len() as u64);
    for seed in &seeds {
        target(seed);
        for _ in 0..MUTATIONS {
            let other = &seeds[random.next_u32() as usize % seeds.len()];
            target(&mutation(seed, other, &mut random));
        }
    }
    for _ in 0..RANDOM {
        let mut bytes = vec![0; random.next_u32() as usize % 200];
        random.fill_bytes(&mut bytes);
        target(&bytes);
    }
}

/// The contents of the seeds of a target, in the order of their names.
fn seeds(name: &str) -> Vec<Vec<u8>> {
    let folder = fuzz().join("seeds").join(name);
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("a folder is readable").path()).collect();
    files.sort();
    files.iter().map(|file| fs::read(file).expect("a seed is readable")).collect()
}

/// An input after one to four changes: a byte replaced, a part removed or repeated, a part of
/// another input inserted.
fn mutation(seed: &[u8], other: &[u8], random: &mut Pcg64) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=random.next_u32() % 4 {
        let mut below = |count: usize| random.next_u32() as usize % count.max(1);
        let start = below(bytes.len());
        let end = (start + below(40)).min(bytes.len());
        match below(5) {
            0 => bytes.truncate(start),
            1 => drop(bytes.drain(start..end)),
            2 => drop(bytes.splice(start..start, bytes[start..end].to_vec())),
            3 => {
                let from = below(other.len());
                let part = other[from..(from + below(40)).min(other.len())].to_vec();
                drop(bytes.splice(start..start, part));
            }
            _ => bytes.iter_mut().skip(start).take(1).for_each(|byte| *byte = below(256) as u8),
        }
    }
    bytes
}

macro_rules! tests {
    ($($test:ident $name:literal,)*) => {
        $(#[test]
        fn $test() {
            check($name);
        })*

        /// A target without a test would not be executed.
        #[test]
        fn every_target_has_a_test() {
            assert_eq!(TARGETS.map(|target| target.0), [$($name),*]);
        }
    };
}

tests! {
    bytes "bytes",
    configuration "configuration",
    control "control",
    frames "frames",
    gamecontroller "gamecontroller",
    liveness "liveness",
    lola "lola",
    match_file "match",
    model "model",
    module "module",
    path "path",
    poses "poses",
    property "property",
    rcsssmj "rcsssmj",
    role "role",
    scenario "scenario",
    scxml "scxml",
    tape "tape",
    topic "topic",
    transition "transition",
    urdf "urdf",
}

/// The fuzz targets are a workspace of their own that is not compiled with this one.
#[test]
fn every_target_is_a_fuzz_target() {
    let manifest = fs::read_to_string(fuzz().join("Cargo.toml")).expect("the manifest is readable");
    let run = fs::read_to_string(fuzz().join("run")).expect("the script is readable");
    for (name, _) in TARGETS {
        let file =
            fs::read_to_string(fuzz().join("targets").join(format!("{name}.rs"))).expect("there is one");
        let function = if name == "match" { "match_file" } else { name };
        assert!(file.contains(&format!("|data: &[u8]| parser_tests::{function}(data)")), "{file}");
        assert!(manifest.contains(&format!("name = \"{name}\"\npath = \"targets/{name}.rs\"")), "{name}");
        assert!(run.split([' ', '-', '}', '"']).any(|word| word == name), "{name}");
    }
    let files = fs::read_dir(fuzz().join("targets")).expect("the folder is readable");
    assert_eq!(files.count(), TARGETS.len());
}
