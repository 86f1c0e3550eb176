mod common;
use common::script::play_match;
use monas_sim::{Setup, World, EventKind};
#[test]
fn season() {
    for nogoalie in [false, true] {
        let mut t = [0f64; 12];
        let mut off = std::collections::BTreeMap::new();
        for seed in 0..8 {
            let mut setup = Setup::three_against_three(seed);
            if nogoalie { setup.robots.retain(|r| !(r.team == 2 && r.number == 1)); }
            let mut world = World::new(setup).unwrap();
            play_match(&mut world, &[0, 1]);
            let (a, b) = (world.statistics().team(0), world.statistics().team(1));
            for (i, v) in [a.goals, b.goals, a.shots, b.shots, a.saves, b.saves, a.falls+b.falls, a.penalties+b.penalties, a.actions+b.actions, a.actions_to_ball+b.actions_to_ball, a.returns+b.returns].into_iter().enumerate() { t[i] += v as f64 / 8.0; }
            t[11] += world.statistics().time_to_first_touch().unwrap() / 8.0;
            for e in world.events() { if let EventKind::Penalty{offence, ..} = e.kind { *off.entry(format!("{offence:?}")).or_insert(0) += 1; } if let EventKind::ThrowIn{..} = e.kind { *off.entry("throwin".into()).or_insert(0) += 1; } if let EventKind::DropBall{..} = e.kind { *off.entry("drop".into()).or_insert(0) += 1; }}
        }
        println!("{nogoalie} goals {:.1}:{:.1} shots {:.1}:{:.1} saves {:.1}:{:.1} falls {:.1} pen {:.1} act {:.1} to {:.1} ret {:.1} first {:.2} {off:?}", t[0],t[1],t[2],t[3],t[4],t[5],t[6],t[7],t[8],t[9],t[10],t[11]);
    }
}
