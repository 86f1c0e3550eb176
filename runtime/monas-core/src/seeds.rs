//! Seeds: an independent stream of random numbers for each component, determined by the seed of the
//! run and the path of the component.

/// The seed of a component, identified by its path: `red-1/cognition`.
pub fn component_seed(seed: u64, path: &str) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&seed.to_le_bytes());
    hasher.update(path.as_bytes());
    *hasher.finalize().as_bytes()
}

#[cfg(test)]
mod tests {
    use super::component_seed;

    #[test]
    fn seeds_differ_by_run_and_by_path() {
        assert_eq!(component_seed(7, "a/b"), component_seed(7, "a/b"));
        assert_ne!(component_seed(7, "a/b"), component_seed(8, "a/b"));
        assert_ne!(component_seed(7, "a/b"), component_seed(7, "a/c"));
    }
}
