//! Configuration of a world.

use monas_robot::ObjectSet;

use crate::{FieldGeometry, FieldSide, MatchRules, Physics, Radio, RobotSetup, TeamColour, TeamSetup};

/// Configuration of a world: field, physics, rules, radio, objects, teams and random seed.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// The field.
    pub field: FieldGeometry,
    /// Bodies, ball and cameras.
    pub physics: Physics,
    /// The rules.
    pub rules: MatchRules,
    /// The radio.
    pub radio: Radio,
    /// The appearance of ball and goals.
    pub objects: ObjectSet,
    /// The two teams.
    pub teams: [TeamSetup; 2],
    /// The robots of both teams, in the order of their indices.
    pub robots: Vec<RobotSetup>,
    /// The seed of all random numbers.
    pub seed: u64,
}

impl Setup {
    /// The match of the thesis's league: two teams of a goalie and two attackers each, every number
    /// at its default. Robots 0 to 2 are those of the team on the left.
    pub fn three_against_three(seed: u64) -> Self {
        let team = |number, name: &str, colour, plays| TeamSetup { number, name: name.into(), colour, plays };
        let robots = [1, 2].iter().flat_map(|team| (1..=3).map(|number| RobotSetup { team: *team, number }));
        Self {
            field: FieldGeometry::default(),
            physics: Physics::default(),
            rules: MatchRules::default(),
            radio: Radio::default(),
            objects: ObjectSet::default(),
            teams: [
                team(1, "Blue", TeamColour::Blue, FieldSide::Left),
                team(2, "Red", TeamColour::Red, FieldSide::Right),
            ],
            robots: robots.collect(),
            seed,
        }
    }
}
