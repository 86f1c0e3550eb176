//! All methodologies play soccer, and about equally well.

use std::path::Path;
use std::time::Duration;

use monas_eval::{EvaluationSettings, Methodology, Row, evaluate};

#[test]
fn every_methodology_shoots_saves_and_costs() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/evaluation");
    // The long form, as in `.ci/run`, and the short one.
    let (seeds, seconds): (u32, _) = match std::env::var_os("MONAS_LONG_TESTS") {
        Some(_) => (2, 150),
        None => (1, 100),
    };
    let settings = EvaluationSettings { folder, seeds: seeds.into(), length: Duration::from_secs(seconds) };
    let mut played = Vec::new();
    let evaluation = evaluate(&settings, &monas::Registry::linked(), &|| Duration::ZERO, &mut |line| {
        played.push(line.to_owned())
    })
    .unwrap();
    assert_eq!(played.len(), 3 * seeds as usize);
    let text = evaluation.to_string();
    for (methodology, play, cost, sources) in &evaluation.rows {
        assert!(
            play.shots >= 2 * seeds && play.shots_faced >= 2 * seeds,
            "{} plays:\n{text}",
            methodology.name()
        );
        assert!(sources.written_lines > sources.goalie_lines, "{text}");
        // Without a program that talks over Narukom only the body publishes.
        assert_eq!(cost.messages > 20.0, *methodology != Methodology::Direct, "{text}");
    }
    // The skills are the same, so no methodology shoots or is shot at much more than another.
    for shots in [|row: &Row| row.1.shots, |row: &Row| row.1.shots_faced] {
        let counts = evaluation.rows.iter().map(shots);
        let (min, max) = counts.fold((u32::MAX, 0), |(min, max), it| (min.min(it), max.max(it)));
        assert!(max <= 3 * min, "{min} and {max} shots:\n{text}");
    }
    let saves: u32 = evaluation.rows.iter().map(|row| row.1.saves).sum();
    assert!(saves > 0, "{text}");
}
