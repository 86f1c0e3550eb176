//! The line-up: teams, robots, sides and colours.

/// An end of the field, and the goal there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FieldSide {
    /// The end at negative x, with the blue goal.
    Left,
    /// The end at positive x, with the yellow goal.
    Right,
}

impl FieldSide {
    /// The other end.
    pub fn opposite(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// The sign of x at this end.
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => -1.0,
            Self::Right => 1.0,
        }
    }

    /// The colour of the goal at this end; goals keep their colours throughout a match.
    pub fn goal_colour(self) -> GoalColour {
        match self {
            Self::Left => GoalColour::Blue,
            Self::Right => GoalColour::Yellow,
        }
    }
}

/// The colour of a goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum GoalColour {
    /// The left goal.
    Blue,
    /// The right goal.
    Yellow,
}

impl GoalColour {
    /// The colour of the other goal.
    pub fn opposite(self) -> Self {
        match self {
            Self::Blue => Self::Yellow,
            Self::Yellow => Self::Blue,
        }
    }
}

/// The colour a team wears.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TeamColour {
    /// Blue waistbands.
    Blue,
    /// Red waistbands.
    Red,
}

impl TeamColour {
    /// The other colour.
    pub fn opposite(self) -> Self {
        match self {
            Self::Blue => Self::Red,
            Self::Red => Self::Blue,
        }
    }
}

/// The left or right side of a body: of a foot or a dive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Side {
    /// Left of the body, positive y in its frame.
    Left,
    /// Right of the body.
    Right,
}

impl Side {
    /// The sign of y in the frame of the body.
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    /// The side on which a point with this y lies.
    pub fn of(y: f64) -> Self {
        if y >= 0.0 { Self::Left } else { Self::Right }
    }

    /// The other side.
    pub fn opposite(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

/// A team at the start of the first half.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TeamSetup {
    /// The team's number, used by robots and announcements.
    pub number: u8,
    /// The team's name, for people.
    pub name: String,
    /// Its colour in the first half.
    pub colour: TeamColour,
    /// The end that it defends in the first half.
    pub plays: FieldSide,
}

/// A robot of a team.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RobotSetup {
    /// The number of its team.
    pub team: u8,
    /// Its own number, from 1 to 11; number 1 is the goalie.
    pub number: u8,
}

/// The most robots that a team may have.
pub(crate) const TEAM_SIZE: usize = 11;

/// A fault of teams and robots, with its position.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct LineupError {
    /// The team or robot at fault.
    pub part: LineupPart,
    message: String,
}

/// The part of a line-up that is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineupPart {
    /// The teams as a whole.
    Match,
    /// A value of a team, by its index: `number`, `colour` or `side`.
    Team(usize, &'static str),
    /// A robot, by its index.
    Robot(usize),
}

/// Checks teams and robots, and returns the index of the team of each robot.
///
/// # Errors
/// The first fault.
pub fn check(teams: &[TeamSetup], robots: &[RobotSetup]) -> Result<Vec<usize>, LineupError> {
    let wrong = |part, message: String| Err(LineupError { part, message });
    let [first, second] = teams else {
        return wrong(LineupPart::Match, format!("a match needs two teams, not {}", teams.len()));
    };
    if first.number == second.number {
        let part = LineupPart::Team(1, "number");
        return wrong(part, format!("both teams have the number {}", first.number));
    }
    if first.plays == second.plays {
        return wrong(LineupPart::Team(1, "side"), "both teams play on the same side".into());
    }
    if first.colour == second.colour {
        return wrong(LineupPart::Team(1, "colour"), "both teams wear the same colour".into());
    }
    let team = |(index, robot)| {
        let of_robot = |message| LineupError { part: LineupPart::Robot(index), message };
        team_of(teams, &robots[..index], robot).map_err(of_robot)
    };
    robots.iter().enumerate().map(team).collect()
}

fn team_of(teams: &[TeamSetup], before: &[RobotSetup], robot: &RobotSetup) -> Result<usize, String> {
    if !(1..=TEAM_SIZE).contains(&usize::from(robot.number)) {
        return Err(format!("a robot has the number {}, not 1 to {TEAM_SIZE}", robot.number));
    }
    if before.contains(robot) {
        return Err(format!("team {} has two robots {}", robot.team, robot.number));
    }
    let unknown = || format!("robot {} is of team {}, which does not play", robot.number, robot.team);
    teams.iter().position(|team| team.number == robot.team).ok_or_else(unknown)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn team(number: u8, colour: TeamColour, plays: FieldSide) -> TeamSetup {
        TeamSetup { number, name: format!("team {number}"), colour, plays }
    }

    fn teams() -> Vec<TeamSetup> {
        vec![team(4, TeamColour::Blue, FieldSide::Left), team(9, TeamColour::Red, FieldSide::Right)]
    }

    #[test]
    fn robots_find_their_teams() {
        let robots = [RobotSetup { team: 9, number: 1 }, RobotSetup { team: 4, number: 1 }];
        assert_eq!(check(&teams(), &robots), Ok(vec![1, 0]));
    }

    #[test]
    fn wrong_lineups_are_refused() {
        let robot = |team, number| RobotSetup { team, number };
        for robots in
            [vec![robot(5, 1)], vec![robot(4, 0)], vec![robot(4, 12)], vec![robot(4, 2), robot(4, 2)]]
        {
            assert!(check(&teams(), &robots).is_err(), "{robots:?}");
        }
        let mut same_side = teams();
        same_side[1].plays = FieldSide::Left;
        assert!(check(&same_side, &[]).is_err());
        assert!(check(&teams()[..1], &[]).is_err());
    }
}
