//! Judging how an attack stands.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use nalgebra::{Point2, Vector2};

use super::shot::{Ground, ground, others};
use crate::functionality::align::Alignment;
use crate::functionality::attack::{Part, Player, Scene, Standing, judge};
use crate::{Attack, AttackPart, TeamReport, topics};

/// Says what the guards of the attack protocol ask for, as far as this player can tell from what it sees and hears. What it cannot tell is
/// false.
#[derive(Clone, Copy, Debug, Default)]
pub struct AttackWatch {
    alignment: Alignment,
}

impl Activity for AttackWatch {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let attack = self.attack(blackboard).unwrap_or_default();
        blackboard.publish(topics::ATTACK, attack)?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        topics.reads(topics::ROBOTS).reads(topics::TEAM).publishes(topics::ATTACK)
    }
}

impl AttackWatch {
    /// Nothing while the player does not know where it is, or nobody sees the ball.
    fn attack(&self, blackboard: &Blackboard) -> Option<Attack> {
        let ground = ground(blackboard)?;
        let team = blackboard.read(topics::TEAM)?;
        let own = team.own?;
        let Sight { ball, rolling, at_foot } = self.sight(blackboard, &ground, &team.mates)?;
        let mates: Vec<Player> = team.mates.iter().map(|mate| player(mate, ball)).collect();
        let opponents = others(blackboard).filter(|robot| !robot.team_mate);
        let opponents: Vec<Point2<f64>> =
            opponents.map(|robot| ground.field_from_robot * robot.position()).collect();
        let own = player(&own, ball);
        let scene =
            Scene { field: ground.field, ball, rolling, at_foot, own, mates: &mates, opponents: &opponents };
        Some(message(&judge(&scene), own.place))
    }

    /// The ball as this player sees it, or, where it does not, as the mate of whom it was heard last does.
    fn sight(&self, blackboard: &Blackboard, ground: &Ground, mates: &[TeamReport]) -> Option<Sight> {
        let ball = blackboard.read(topics::BALL).filter(|ball| ball.found);
        if let Some(ball) = ball {
            let position = ball.position();
            return Some(Sight {
                ball: ground.field_from_robot * position,
                rolling: ground.field_from_robot * ball.velocity(),
                at_foot: self.alignment.is_at_foot(position),
            });
        }
        let seeing = mates.iter().filter(|mate| mate.ball_found);
        let mate = seeing.min_by(|a, b| a.age.total_cmp(&b.age))?;
        Some(Sight { ball: Point2::new(mate.ball_x, mate.ball_y), rolling: Vector2::zeros(), at_foot: false })
    }
}

/// The ball in the field frame, and whether it lies before a foot.
struct Sight {
    ball: Point2<f64>,
    rolling: Vector2<f64>,
    at_foot: bool,
}

fn player(report: &TeamReport, ball: Point2<f64>) -> Player {
    let place = Point2::new(report.x, report.y);
    Player {
        number: report.number,
        place,
        heading: report.heading,
        // Its own eyes know best how far the ball is from it.
        ball_distance: if report.ball_found { report.ball_distance } else { (place - ball).norm() },
        since_pass: report.since_pass + report.age,
        since_shot: report.since_shot + report.age,
    }
}

fn message(standing: &Standing, own: Point2<f64>) -> Attack {
    let part = match standing.part {
        None => AttackPart::NoPart,
        Some(Part::Center) => AttackPart::Center,
        Some(Part::CenterFor) => AttackPart::CenterFor,
    };
    let mate = standing.mate.unwrap_or(own);
    Attack {
        ball_is_free: standing.ball_is_free,
        center_is_closest: standing.center_is_closest,
        center_for_is_farthest: standing.center_for_is_farthest,
        part: part.into(),
        pass_is_open: standing.pass_is_open,
        ball_is_passed: standing.ball_is_passed,
        path_is_clear: standing.path_is_clear,
        shot_at_goal: standing.shot_at_goal,
        opponent_has_ball: standing.opponent_has_ball,
        ball_is_out: standing.ball_is_out,
        mate_x: mate.x,
        mate_y: mate.y,
    }
}

monas::activity!(AttackWatch);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::stage::Stage;
    use crate::{Ball, GameState, OtherRobot, Pose, Robots, Team};

    /// A player in the middle of the field that looks at the opponents' goal, and what it judges.
    fn judged(ball: Ball, mates: &[TeamReport], opponents: &[(f64, f64)]) -> Attack {
        let mut stage = Stage::new();
        let game = GameState {
            number: 2,
            field_length: 6.0,
            field_width: 4.0,
            goal_width: 1.4,
            ..GameState::default()
        };
        let robot = |&(x, y)| OtherRobot { x, y, team_mate: false, age: 0.0 };
        let own = TeamReport { number: 2, ball_found: ball.found, ball_distance: ball.distance, ..far() };
        stage.tell(topics::GAME_STATE, game).tell(topics::POSE, Pose::default()).tell(topics::BALL, ball);
        stage.tell(topics::ROBOTS, Robots { robots: opponents.iter().map(robot).collect(), nearest: 0.0 });
        stage.tell(topics::TEAM, Team { own: Some(own), mates: mates.to_vec() });
        assert!(stage.run(&mut AttackWatch::default()));
        stage.said(topics::ATTACK).unwrap()
    }

    fn far() -> TeamReport {
        TeamReport { since_pass: 1e6, since_shot: 1e6, ..TeamReport::default() }
    }

    fn ball(x: f64, y: f64) -> Ball {
        Ball { found: true, x, y, distance: libm::hypot(x, y), ..Ball::default() }
    }

    #[test]
    fn the_nearer_one_is_the_center() {
        let mate = TeamReport { number: 3, x: -1.0, y: 1.0, ..far() };
        let attack = judged(ball(1.0, 0.0), &[mate], &[]);
        assert_eq!(attack.part(), AttackPart::Center);
        assert!(attack.ball_is_free && attack.center_is_closest && attack.center_for_is_farthest);
        assert_eq!((attack.mate_x, attack.mate_y), (-1.0, 1.0));
        let mate = TeamReport { x: 1.0, y: 0.4, ..mate };
        let attack = judged(ball(1.0, 0.0), &[mate], &[]);
        assert_eq!(attack.part(), AttackPart::CenterFor);
    }

    #[test]
    fn who_hears_nobody_has_no_part() {
        let attack = judged(ball(1.0, 0.0), &[], &[(1.2, 0.0)]);
        assert_eq!(attack.part(), AttackPart::NoPart);
        assert!(attack.opponent_has_ball && !attack.ball_is_free, "that it sees by itself");
    }

    #[test]
    fn a_ball_that_only_the_mate_sees_is_believed_to_be_there() {
        let mate =
            TeamReport { number: 3, ball_found: true, ball_x: 2.0, x: 1.5, ball_distance: 0.5, ..far() };
        let attack = judged(Ball::default(), &[mate], &[]);
        assert_eq!((attack.part(), attack.center_is_closest), (AttackPart::CenterFor, true));
        assert_eq!(
            judged(Ball::default(), &[TeamReport { ball_found: false, ..mate }], &[]),
            Attack::default()
        );
    }

    #[test]
    fn what_was_told_grows_old() {
        let told =
            |age| judged(ball(1.0, 0.0), &[TeamReport { number: 3, since_shot: 0.5, age, ..far() }], &[]);
        assert!(told(0.1).shot_at_goal && !told(0.6).shot_at_goal);
    }
}
