//! The robots of a match know where they are, and find themselves after they were carried away.

#![allow(clippy::unwrap_used)] // tests may panic

use std::time::Duration;

use monas_tests::{MATCH, kidnap, pose_errors, quantile};

#[test]
fn poses_are_near_the_truth_through_kick_offs_and_half_time() {
    // The second half begins after 300 s.
    let errors = pose_errors(&MATCH, 1, Duration::from_secs(340)).unwrap();
    assert!(errors.distances.len() > 5_000, "{} poses", errors.distances.len());
    let [distance, turn] = [&errors.distances, &errors.turns].map(|errors| quantile(errors, 0.5).unwrap());
    assert!(distance < 0.1 && turn < 0.1, "median error {distance} m, {turn} rad");
    let [distance, turn] = [&errors.distances, &errors.turns].map(|errors| quantile(errors, 0.95).unwrap());
    assert!(distance < 0.25 && turn < 0.25, "95 % of the errors are below {distance} m, {turn} rad");
}

#[test]
fn nine_of_ten_robots_find_themselves_within_ten_seconds_after_they_were_carried_away() {
    let (mut recoveries, mut lost) = (Vec::new(), 0);
    let seeds = if crate::is_long() { 2 } else { 1 };
    for seed in 1..=seeds {
        let result = kidnap(&MATCH, seed, Duration::from_secs(240)).unwrap();
        recoveries.extend(result.recoveries);
        lost += result.lost;
    }
    assert!(2 * recoveries.len() >= 25 * seeds as usize, "{} kidnappings", recoveries.len());
    // Robots that stay lost count as those that need longest.
    recoveries.extend(vec![30.0; lost]);
    let [median, p90] = [0.5, 0.9].map(|part| quantile(&recoveries, part).unwrap());
    assert!(median < 5.0 && p90 < 10.0, "median {median} s, 90 % within {p90} s, {lost} lost");
}
