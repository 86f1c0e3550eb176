//! Radio reports to and from the team.

use std::collections::BTreeMap;
use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use monas_robot::Said;
use monas_robot::topics as body;
use narukom::AnyMessage;

use super::shot::ground;
use crate::functionality::kicks::Kicks;
use crate::{AttackPart, MotionKind, Team, TeamReport, topics};

/// Sends this player's pose, its estimate of the ball and the times of its kicks to the team, and
/// collects the reports of team mates. A report is valid for a second.
///
/// A kick by the center while a pass is open counts as a pass; any other as a shot.
#[derive(Clone, Copy, Debug, Default)]
pub struct TeamRadio {
    kicks: Kicks,
}

/// How long a report is valid.
const MEMORY: Duration = Duration::from_secs(1);
/// Time since a kick that never happened, seconds.
const NEVER: f64 = 1e6;

impl Activity for TeamRadio {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        self.note_kicks(blackboard);
        let (own, mates) = (self.report(blackboard), listen(blackboard));
        if let Some(report) = own {
            let mut words = Vec::new();
            report.encode_to(&mut words);
            blackboard.publish(body::SAID, Said { words })?;
        }
        blackboard.publish(topics::TEAM, Team { own, mates })?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(body::HEARD).reads(topics::GAME_STATE).reads(topics::POSE);
        let topics = topics.reads(topics::BALL).reads(topics::MOTION).reads(topics::ATTACK);
        topics.publishes(body::SAID).publishes(topics::TEAM)
    }
}

impl TeamRadio {
    fn note_kicks(&mut self, blackboard: &Blackboard) {
        let Some(motion) = blackboard.read(topics::MOTION) else { return };
        let is_kick = matches!(motion.kind(), MotionKind::KickLeft | MotionKind::KickRight);
        let attack = blackboard.read(topics::ATTACK);
        let is_pass = attack.is_some_and(|it| it.part() == AttackPart::Center && it.pass_is_open);
        self.kicks.observe_request(blackboard.now(), if is_kick { motion.number } else { 0 }, is_pass);
    }

    /// None while the player's identity or pose is unknown.
    fn report(&self, blackboard: &Blackboard) -> Option<TeamReport> {
        let number = blackboard.read(topics::GAME_STATE)?.number;
        let pose = blackboard.read(topics::POSE)?;
        let ground = ground(blackboard)?;
        let ball = blackboard.read(topics::BALL).copied().unwrap_or_default();
        let ball_in_field = ground.field_from_robot * ball.position();
        let now = blackboard.now();
        Some(TeamReport {
            number,
            x: pose.x,
            y: pose.y,
            heading: pose.heading,
            ball_found: ball.found,
            ball_distance: ball.distance,
            ball_x: ball_in_field.x,
            ball_y: ball_in_field.y,
            since_pass: self.kicks.since_pass(now).unwrap_or(NEVER),
            since_shot: self.kicks.since_shot(now).unwrap_or(NEVER),
            age: 0.0,
        })
    }
}

/// The newest valid report of each team mate. Other messages come from other senders or program
/// versions and are ignored.
fn listen(blackboard: &Blackboard) -> Vec<TeamReport> {
    let now = blackboard.now();
    let mut newest = BTreeMap::new();
    for heard in blackboard.recent(body::HEARD, MEMORY) {
        let Some(report) = understood(&heard.words) else { continue };
        let age = now.since(narukom::Timestamp::from_nanos(heard.heard_at)).as_secs_f64();
        // The sender is identified by the channel, not by the content.
        newest.insert(heard.number, TeamReport { number: heard.number, age, ..report });
    }
    newest.into_values().collect()
}

/// Decodes a report; none if it is malformed or contains values that are not finite.
fn understood(words: &[u8]) -> Option<TeamReport> {
    let mut report = TeamReport::default();
    report.decode_from(words).ok()?;
    let TeamReport { x, y, heading, ball_distance, ball_x, ball_y, since_pass, since_shot, .. } = report;
    let numbers = [x, y, heading, ball_distance, ball_x, ball_y, since_pass, since_shot];
    numbers.into_iter().all(f64::is_finite).then_some(report)
}

monas::activity!(TeamRadio);

#[cfg(test)]
mod tests {
    use monas_robot::Heard;

    use super::*;
    use crate::activities::activity_fixture::{ActivityFixture, TICK};
    use crate::{Attack, Ball, GameState, MotionRequest, Pose};

    fn player() -> (ActivityFixture, TeamRadio) {
        let mut stage = ActivityFixture::new();
        let game = GameState { number: 2, field_length: 6.0, field_width: 4.0, ..GameState::default() };
        stage.publish(topics::GAME_STATE, game);
        stage.publish(topics::POSE, Pose { x: 1.0, y: 0.5, ..Pose::default() });
        stage.publish(topics::BALL, Ball { found: true, distance: 0.5, x: 0.5, ..Ball::default() });
        (stage, TeamRadio::default())
    }

    fn last_report(stage: &mut ActivityFixture) -> TeamReport {
        let mut report = TeamReport::default();
        report.decode_from(&stage.latest(body::SAID).unwrap().words).unwrap();
        report
    }

    fn heard(stage: &mut ActivityFixture, number: u32, report: TeamReport) {
        let mut words = Vec::new();
        report.encode_to(&mut words);
        let heard_at = stage.now.as_nanos();
        stage.publish(body::HEARD, Heard { number, heard_at, words });
    }

    #[test]
    fn it_reports_where_the_player_and_the_ball_are() {
        let (mut stage, mut radio) = player();
        stage.run(&mut radio);
        let report = last_report(&mut stage);
        assert_eq!((report.number, report.x, report.y), (2, 1.0, 0.5));
        assert_eq!((report.ball_found, report.ball_x, report.ball_y), (true, 1.5, 0.5));
        assert!(stage.latest(body::SAID).unwrap().words.len() <= 128, "as much as a robot may say");
    }

    #[test]
    fn an_unlocalised_robot_sends_nothing() {
        let mut stage = ActivityFixture::new();
        stage.run(&mut TeamRadio::default());
        assert_eq!(stage.latest(body::SAID), None);
    }

    #[test]
    fn the_newest_report_of_each_mate_is_kept_for_a_second() {
        let (mut stage, mut radio) = player();
        heard(&mut stage, 3, TeamReport { x: 1.0, ..TeamReport::default() });
        heard(&mut stage, 4, TeamReport { x: 9.0, number: 77, ..TeamReport::default() });
        stage.wait(TICK);
        heard(&mut stage, 3, TeamReport { x: 2.0, ..TeamReport::default() });
        stage.wait(TICK);
        stage.run(&mut radio);
        let mates = stage.latest(topics::TEAM).unwrap().mates;
        let known: Vec<_> = mates.iter().map(|it| (it.number, it.x, (it.age * 10.0).round())).collect();
        assert_eq!(known, [(3, 2.0, 1.0), (4, 9.0, 2.0)]);
        stage.wait(Duration::from_millis(850));
        stage.run(&mut radio);
        let mates = stage.latest(topics::TEAM).unwrap().mates;
        assert_eq!(mates.iter().map(|it| it.number).collect::<Vec<_>>(), [3]);
    }

    #[test]
    fn a_kick_with_an_open_pass_is_a_pass_and_another_a_shot() {
        for (pass_is_open, expected) in [(true, (0.0, NEVER)), (false, (NEVER, 0.0))] {
            let (mut stage, mut radio) = player();
            let attack = Attack { part: AttackPart::Center.into(), pass_is_open, ..Attack::default() };
            stage.publish(topics::ATTACK, attack);
            let kick =
                MotionRequest { kind: MotionKind::KickLeft.into(), number: 1, ..MotionRequest::default() };
            stage.publish(topics::MOTION, kick);
            stage.run(&mut radio);
            assert_eq!(
                (last_report(&mut stage).since_pass, last_report(&mut stage).since_shot),
                (NEVER, NEVER)
            );
            stage.wait(8 * TICK);
            stage.run(&mut radio);
            assert_eq!((last_report(&mut stage).since_pass, last_report(&mut stage).since_shot), expected);
        }
    }

    #[test]
    fn invalid_reports_are_skipped() {
        let (mut stage, mut radio) = player();
        heard(&mut stage, 3, TeamReport { x: 1.0, ..TeamReport::default() });
        heard(&mut stage, 4, TeamReport { x: f64::NAN, ..TeamReport::default() });
        let heard_at = stage.now.as_nanos();
        stage.publish(body::HEARD, Heard { number: 5, heard_at, words: vec![0xff] });
        assert!(stage.run(&mut radio));
        let mates = stage.latest(topics::TEAM).unwrap().mates;
        assert_eq!(mates.iter().map(|it| (it.number, it.x)).collect::<Vec<_>>(), [(3, 1.0)]);
    }
}
