//! Evaluates the conditions of the attack protocol.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use nalgebra::{Point2, Vector2};

use super::shot::{RobotAndField, ground, opponents_stand, others};
use crate::functionality::align::Alignment;
use crate::functionality::attack::{AttackPlayer, AttackRole, AttackSituation, AttackState, evaluate};
use crate::{Attack, AttackPart, TeamReport, topics};

/// Publishes the conditions that the guards of the attack protocol use, as far as this player can
/// evaluate them from perception and team reports. Unknown conditions are false.
#[derive(Clone, Copy, Debug, Default)]
pub struct AssessAttack {
    alignment: Alignment,
}

impl Activity for AssessAttack {
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

impl AssessAttack {
    /// None while the player's pose is unknown, or no player sees the ball.
    fn attack(&self, blackboard: &Blackboard) -> Option<Attack> {
        let ground = ground(blackboard)?;
        let team = blackboard.read(topics::TEAM)?;
        let own = team.own?;
        let BallObservation { ball, rolling, at_foot } = self.sight(blackboard, &ground, &team.mates)?;
        let mates = mates(blackboard, &ground, &team.mates, ball);
        let opponents = others(blackboard).filter(|robot| !robot.team_mate);
        let opponents: Vec<Point2<f64>> =
            opponents.map(|robot| ground.field_from_robot * robot.position()).collect();
        let own = player(&own, ball);
        let scene = AttackSituation {
            field: ground.field,
            ball,
            rolling,
            at_foot,
            own,
            mates: &mates,
            opponents: &opponents,
            opponents_stand: opponents_stand(blackboard),
        };
        let mate_sees_ball = !blackboard.read(topics::BALL).is_some_and(|ball| ball.found);
        Some(Attack { mate_sees_ball, ..message(&evaluate(&scene), own.position) })
    }

    /// The ball as seen by this player or, if it does not see it, by the team mate with the newest
    /// report.
    fn sight(
        &self,
        blackboard: &Blackboard,
        ground: &RobotAndField,
        mates: &[TeamReport],
    ) -> Option<BallObservation> {
        let ball = blackboard.read(topics::BALL).filter(|ball| ball.found);
        if let Some(ball) = ball {
            let position = ball.position();
            return Some(BallObservation {
                ball: ground.field_from_robot * position,
                rolling: ground.field_from_robot * ball.velocity(),
                at_foot: self.alignment.is_at_foot(position),
            });
        }
        let seeing = mates.iter().filter(|mate| mate.ball_found);
        let mate = seeing.min_by(|a, b| a.age.total_cmp(&b.age))?;
        Some(BallObservation {
            ball: Point2::new(mate.ball_x, mate.ball_y),
            rolling: Vector2::zeros(),
            at_foot: false,
        })
    }
}

/// The ball in the field frame, and whether it lies in front of a foot.
struct BallObservation {
    ball: Point2<f64>,
    rolling: Vector2<f64>,
    at_foot: bool,
}

/// The field players of the team. A mate seen near its reported position is taken to be where it is
/// seen; one that is seen but has not reported is taken to stand still.
fn mates(
    blackboard: &Blackboard,
    ground: &RobotAndField,
    reports: &[TeamReport],
    ball: Point2<f64>,
) -> Vec<AttackPlayer> {
    let seen = others(blackboard).filter(|robot| robot.team_mate);
    let mut seen: Vec<Point2<f64>> = seen.map(|robot| ground.field_from_robot * robot.position()).collect();
    let mut mates: Vec<AttackPlayer> = Vec::new();
    for report in reports {
        let mut mate = player(report, ball);
        let distance = |position: &Point2<f64>| (position - mate.position).norm();
        let nearest = (0..seen.len()).min_by(|a, b| distance(&seen[*a]).total_cmp(&distance(&seen[*b])));
        if let Some(index) =
            nearest.filter(|index| distance(&seen[*index]) < MATCHING_DISTANCE + MATCHING_SPEED * report.age)
        {
            mate.position = seen.swap_remove(index);
            mate.ball_distance = (mate.position - ball).norm();
        }
        mates.push(mate);
    }
    mates
}

/// Distance within which a seen mate is identified with a report, metres, and its growth with the
/// age of the report, m/s.
const MATCHING_DISTANCE: f64 = 0.5;
const MATCHING_SPEED: f64 = 0.3;

/// Handicaps of a player on its way to the ball, as metres of straight walk: lying on the ground,
/// not seeing the ball, and each second since its last report.
const FALLEN_HANDICAP: f64 = 1.0;
const UNSEEN_BALL_HANDICAP: f64 = 1.0;
const REPORT_AGE_HANDICAP: f64 = 0.05;

fn player(report: &TeamReport, ball: Point2<f64>) -> AttackPlayer {
    let position = Point2::new(report.x, report.y);
    AttackPlayer {
        position,
        heading: report.heading,
        // A player's own measurement of its distance from the ball is the most accurate.
        ball_distance: if report.ball_found { report.ball_distance } else { (position - ball).norm() },
        handicap: FALLEN_HANDICAP * f64::from(u8::from(report.is_down))
            + UNSEEN_BALL_HANDICAP * f64::from(u8::from(!report.ball_found))
            + REPORT_AGE_HANDICAP * report.age,
        since_pass: report.since_pass + report.age,
        since_shot: report.since_shot + report.age,
    }
}

fn message(standing: &AttackState, own: Point2<f64>) -> Attack {
    let part = match standing.part {
        None => AttackPart::NoPart,
        Some(AttackRole::Center) => AttackPart::Center,
        Some(AttackRole::CenterFor) => AttackPart::CenterFor,
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
        mate_lead: standing.mate_lead,
        opponent_leads: standing.opponent_leads,
        mate_sees_ball: false,
    }
}

monas::activity!(AssessAttack);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{Ball, GameState, OtherRobot, Pose, Robots, Team};

    /// The evaluation of a player in its own half that faces the opponents' goal.
    fn judged(ball: Ball, mates: &[TeamReport], opponents: &[(f64, f64)]) -> Attack {
        let mut stage = ActivityFixture::new();
        let game = GameState { field_length: 6.0, field_width: 4.0, goal_width: 1.4, ..GameState::default() };
        let robot = |&(x, y)| OtherRobot { x, y, team_mate: false, age: 0.0 };
        let own = TeamReport { x: OWN_X, ball_found: ball.found, ball_distance: ball.distance, ..far() };
        stage
            .publish(topics::GAME_STATE, game)
            .publish(topics::POSE, Pose { x: OWN_X, ..Pose::default() })
            .publish(topics::BALL, ball);
        stage.publish(
            topics::ROBOTS,
            Robots { robots: opponents.iter().map(robot).collect(), ..Robots::default() },
        );
        stage.publish(topics::TEAM, Team { own: Some(own), mates: mates.to_vec() });
        assert!(stage.run(&mut AssessAttack::default()));
        stage.latest(topics::ATTACK).unwrap()
    }

    const OWN_X: f64 = -2.0;

    fn far() -> TeamReport {
        TeamReport { since_pass: 1e6, since_shot: 1e6, ..TeamReport::default() }
    }

    fn ball(x: f64, y: f64) -> Ball {
        Ball { found: true, x, y, distance: libm::hypot(x, y), ..Ball::default() }
    }

    #[test]
    fn the_nearer_one_is_the_center() {
        let mate = TeamReport { number: 3, x: 0.5, y: 1.0, ..far() };
        let attack = judged(ball(0.9, 0.0), &[mate], &[]);
        assert_eq!(attack.part(), AttackPart::Center);
        assert!(attack.ball_is_free && attack.center_is_closest && attack.center_for_is_farthest);
        assert_eq!((attack.mate_x, attack.mate_y), (0.5, 1.0));
        let mate = TeamReport { x: -1.0, y: 0.2, ..mate };
        let attack = judged(ball(1.0, 0.0), &[mate], &[]);
        assert_eq!(attack.part(), AttackPart::NoPart, "one behind the ball gets no pass");
    }

    #[test]
    fn without_reports_a_player_has_no_part() {
        let attack = judged(ball(1.0, 0.0), &[], &[(1.2, 0.0)]);
        assert_eq!(attack.part(), AttackPart::NoPart);
        assert!(attack.opponent_has_ball && !attack.ball_is_free, "that it sees by itself");
    }

    #[test]
    fn a_ball_that_only_the_mate_sees_is_believed_to_be_there() {
        let mate = TeamReport {
            number: 3,
            ball_found: true,
            ball_x: -2.9,
            ball_y: 0.9,
            x: -2.5,
            y: 1.2,
            ball_distance: 0.5,
            ..far()
        };
        let attack = judged(Ball::default(), &[mate], &[]);
        assert_eq!((attack.part(), attack.center_is_closest), (AttackPart::CenterFor, true));
        assert_eq!(
            judged(Ball::default(), &[TeamReport { ball_found: false, ..mate }], &[]),
            Attack::default()
        );
    }

    #[test]
    fn reports_expire() {
        let state_at =
            |age| judged(ball(1.0, 0.0), &[TeamReport { number: 3, since_shot: 0.5, age, ..far() }], &[]);
        assert!(state_at(0.1).shot_at_goal && !state_at(0.6).shot_at_goal);
    }
}
