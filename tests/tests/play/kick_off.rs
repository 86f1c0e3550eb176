//! The team that takes the kick-off is the first to kick the ball, and robots do not crowd.

use std::time::Duration;

use monas_tests::{MATCH, play};

#[test]
fn who_takes_the_kick_off_kicks_first_and_robots_do_not_crowd() -> Result<(), String> {
    let (mut kick_offs, mut kept, mut crowded) = (0, 0, 0.0);
    let seeds = if crate::is_long() { 4 } else { 1 };
    for seed in 1..=seeds {
        let row = play(&MATCH, seed, Duration::from_secs(120))?;
        kick_offs += row.team_play.kick_offs;
        kept += row.team_play.kick_offs_kept;
        crowded += row.team_play.crowded / seeds as f64;
    }
    assert!(u64::from(kick_offs) >= seeds, "{kick_offs}");
    assert!(kept * 10 >= kick_offs * 9, "{kept} of {kick_offs} kick-offs were kept");
    assert!(crowded < 0.44, "two robots crowd in {:.0} % of the time", crowded * 100.0);
    Ok(())
}
