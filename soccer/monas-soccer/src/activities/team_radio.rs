//! Radio reports to and from the team.

use std::collections::BTreeMap;
use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Topics};
use monas_robot::Said;
use monas_robot::topics as body;
use narukom::{AnyMessage, Timestamp};

use super::shot::ground;
use crate::functionality::kicks::Kicks;
use crate::functionality::report_budget::ReportBudget;
use crate::{MotionKind, MotionPhase, MotionResult, PlayerState, Team, TeamReport, topics};

/// Sends this player's pose, its estimate of the ball and the times of its kicks to the team, and
/// collects the reports of team mates. A report is valid for four seconds.
///
/// A team may send a limited number of messages in a match. A report is sent if it is sufficiently
/// new compared with the last one; the threshold rises as fewer messages are left.
///
/// Parameter `rate` (1/s): the number of reports that this player may send on average.
#[derive(Clone, Copy, Debug, Default)]
pub struct TeamRadio {
    kicks: Kicks,
    budget: ReportBudget,
    last_report: Option<(Timestamp, TeamReport)>,
    sequence: u32,
}

/// Time for which a report is valid.
const MAX_REPORT_AGE: Duration = Duration::from_secs(4);
/// Time since a kick that never happened, seconds.
const NO_KICK: f64 = 1e6;

impl Activity for TeamRadio {
    fn configure(&mut self, parameters: &Parameters) {
        self.budget.rate = parameters.number("rate").unwrap_or(self.budget.rate);
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        self.note_kicks(blackboard);
        let (own, mates) = (self.report(blackboard), listen(blackboard));
        if let Some(report) = own {
            self.say(blackboard, report)?;
        }
        blackboard.publish(topics::TEAM, Team { own, mates })?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(body::HEARD).reads(topics::GAME_STATE).reads(topics::POSE);
        let topics = topics.reads(topics::BALL).reads(topics::MOTION).reads(topics::MOTION_STATE);
        topics.publishes(body::SAID).publishes(topics::TEAM)
    }
}

impl TeamRadio {
    fn note_kicks(&mut self, blackboard: &Blackboard) {
        let Some(motion) = blackboard.read(topics::MOTION) else { return };
        let is_kick = matches!(motion.kind(), MotionKind::KickLeft | MotionKind::KickRight);
        let number = if is_kick { motion.number } else { 0 };
        if let Some(state) = blackboard.read(topics::MOTION_STATE) {
            let failed = match state.result() {
                // The end of a motion in which the robot fell is reported when it stands again.
                _ if state.phase() == MotionPhase::Fallen => motion.number,
                MotionResult::Refused | MotionResult::Interrupted => state.done,
                MotionResult::NoResult | MotionResult::Performed => 0,
            };
            self.kicks.observe_failure(failed);
        }
        self.kicks.observe_request(blackboard.now(), number, motion.is_pass);
    }

    /// Sends a report, if its value justifies one of the remaining messages.
    fn say(&mut self, blackboard: &mut Blackboard, report: TeamReport) -> Result<(), BoxError> {
        let now = blackboard.now();
        let worth = match &self.last_report {
            Some((at, last)) => news(last, &report, now.since(*at)),
            None => f64::INFINITY,
        };
        if !self.budget.spend(now, worth) {
            return Ok(());
        }
        self.sequence = self.sequence.wrapping_add(1);
        let report = TeamReport { sequence: self.sequence, ..report };
        self.last_report = Some((now, report));
        let mut words = Vec::new();
        report.encode_to(&mut words);
        Ok(blackboard.publish(body::SAID, Said { words })?)
    }

    /// None while the player does not play or does not know its pose.
    fn report(&self, blackboard: &Blackboard) -> Option<TeamReport> {
        let plays = blackboard.read(topics::GAME_STATE)?.player_state() == PlayerState::Playing;
        let pose = blackboard.read(topics::POSE).filter(|_| plays)?;
        let ground = ground(blackboard)?;
        let ball = blackboard.read(topics::BALL).copied().unwrap_or_default();
        let ball_in_field = ground.field_from_robot * ball.position();
        let phase = blackboard.read(topics::MOTION_STATE).map(|state| state.phase());
        let now = blackboard.now();
        Some(TeamReport {
            number: 0,
            x: pose.x,
            y: pose.y,
            heading: pose.heading,
            ball_found: ball.found,
            ball_distance: ball.distance,
            ball_x: ball_in_field.x,
            ball_y: ball_in_field.y,
            since_pass: self.kicks.since_pass(now).unwrap_or(NO_KICK),
            since_shot: self.kicks.since_shot(now).unwrap_or(NO_KICK),
            age: 0.0,
            is_down: phase == Some(MotionPhase::Fallen),
            sequence: 0,
        })
    }
}

/// The newest valid report of each team mate. Other messages come from other senders or program
/// versions and are ignored.
fn listen(blackboard: &Blackboard) -> Vec<TeamReport> {
    let now = blackboard.now();
    let mut newest: BTreeMap<u32, TeamReport> = BTreeMap::new();
    for heard in blackboard.recent(body::HEARD, MAX_REPORT_AGE) {
        let Some(report) = understood(&heard.words) else { continue };
        // A message may arrive twice, or after one that was sent later.
        let is_old = |known: &TeamReport| report.sequence.wrapping_sub(known.sequence) as i32 <= 0;
        if newest.get(&heard.number).is_some_and(is_old) {
            continue;
        }
        let age = now.since(Timestamp::from_nanos(heard.heard_at)).as_secs_f64();
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

/// The value of a report compared with the last one, sent `age` ago; a displacement of half a metre
/// counts 1.
fn news(last: &TeamReport, report: &TeamReport, age: Duration) -> f64 {
    let age = age.as_secs_f64();
    let moved = libm::hypot(report.x - last.x, report.y - last.y) / 0.5;
    let turned = (report.heading - last.heading).abs().min(1.0) * 0.3;
    let rolled = match (last.ball_found, report.ball_found) {
        (true, true) => libm::hypot(report.ball_x - last.ball_x, report.ball_y - last.ball_y) / 0.5,
        (false, false) => 0.0,
        _ => 1.0,
    };
    let kicked = |before: f64, now: f64| if now < before { 3.0 } else { 0.0 };
    let kicks = kicked(last.since_pass, report.since_pass) + kicked(last.since_shot, report.since_shot);
    let fell = if last.is_down == report.is_down { 0.0 } else { 1.5 };
    moved + turned + rolled + kicks + fell + age / 2.0
}

monas::activity!(TeamRadio);

#[cfg(test)]
mod tests {
    use monas_robot::Heard;

    use super::*;
    use crate::activities::activity_fixture::{ActivityFixture, TICK};
    use crate::{Ball, GameState, MotionRequest, MotionState, Pose};

    fn player() -> (ActivityFixture, TeamRadio) {
        let mut stage = ActivityFixture::new();
        let game = GameState {
            player_state: PlayerState::Playing.into(),
            field_length: 6.0,
            field_width: 4.0,
            ..GameState::default()
        };
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
        assert_eq!((report.sequence, report.x, report.y), (1, 1.0, 0.5));
        assert_eq!((report.ball_found, report.ball_x, report.ball_y), (true, 1.5, 0.5));
        assert!(stage.latest(body::SAID).unwrap().words.len() <= 128, "a robot may say 512 bytes");
    }

    #[test]
    fn an_unlocalised_robot_sends_nothing() {
        let mut stage = ActivityFixture::new();
        stage.run(&mut TeamRadio::default());
        assert_eq!(stage.latest(body::SAID), None);
    }

    #[test]
    fn the_newest_report_of_each_mate_is_kept_for_a_while() {
        let (mut stage, mut radio) = player();
        heard(&mut stage, 3, TeamReport { x: 1.0, sequence: 1, ..TeamReport::default() });
        heard(&mut stage, 4, TeamReport { x: 9.0, number: 77, sequence: 7, ..TeamReport::default() });
        stage.wait(TICK);
        heard(&mut stage, 3, TeamReport { x: 2.0, sequence: 2, ..TeamReport::default() });
        stage.wait(TICK);
        stage.run(&mut radio);
        let mates = stage.latest(topics::TEAM).unwrap().mates;
        let known: Vec<_> = mates.iter().map(|it| (it.number, it.x, (it.age * 10.0).round())).collect();
        assert_eq!(known, [(3, 2.0, 1.0), (4, 9.0, 2.0)]);
        stage.wait(Duration::from_millis(3850));
        stage.run(&mut radio);
        let mates = stage.latest(topics::TEAM).unwrap().mates;
        assert_eq!(mates.iter().map(|it| it.number).collect::<Vec<_>>(), [3]);
    }

    #[test]
    fn a_report_that_arrives_twice_or_late_is_not_believed() {
        let (mut stage, mut radio) = player();
        for (sequence, x) in [(1, 1.0), (3, 3.0), (2, 2.0), (3, 4.0)] {
            heard(&mut stage, 3, TeamReport { x, sequence, ..TeamReport::default() });
            stage.wait(TICK);
        }
        stage.run(&mut radio);
        assert_eq!(stage.latest(topics::TEAM).unwrap().mates[0].x, 3.0);
    }

    #[test]
    fn a_kick_that_is_meant_for_a_mate_is_a_pass_and_another_a_shot() {
        for (is_pass, expected) in [(true, (0.0, NO_KICK)), (false, (NO_KICK, 0.0))] {
            let (mut stage, mut radio) = player();
            let kind = MotionKind::KickLeft.into();
            stage.publish(
                topics::MOTION,
                MotionRequest { kind, number: 1, is_pass, ..MotionRequest::default() },
            );
            stage.run(&mut radio);
            let since = |report: TeamReport| (report.since_pass, report.since_shot);
            assert_eq!(since(last_report(&mut stage)), (NO_KICK, NO_KICK));
            stage.wait(8 * TICK);
            stage.run(&mut radio);
            assert_eq!(since(last_report(&mut stage)), expected, "and it is said at once");
        }
    }

    #[test]
    fn a_kick_that_is_refused_or_in_which_the_robot_falls_is_no_pass() {
        let state = |phase: MotionPhase, result: MotionResult, done| MotionState {
            phase: phase.into(),
            result: result.into(),
            done,
        };
        for (ends, is_said) in [
            (state(MotionPhase::Standing, MotionResult::Refused, 1), false),
            (state(MotionPhase::Fallen, MotionResult::NoResult, 0), false),
            (state(MotionPhase::Standing, MotionResult::Performed, 1), true),
        ] {
            let (mut stage, mut radio) = player();
            let kick = MotionRequest { number: 1, is_pass: true, ..MotionRequest::default() };
            stage.publish(topics::MOTION, MotionRequest { kind: MotionKind::KickLeft.into(), ..kick });
            stage.run(&mut radio);
            stage.publish(topics::MOTION_STATE, ends).wait(2 * TICK).run(&mut radio);
            stage.wait(7 * TICK).run(&mut radio);
            let report = stage.latest(topics::TEAM).unwrap().own.unwrap();
            assert_eq!(report.since_pass < NO_KICK, is_said, "{ends:?}");
        }
    }

    #[test]
    fn a_player_that_does_not_play_says_nothing() {
        let (mut stage, mut radio) = player();
        let game = GameState { field_length: 6.0, ..GameState::default() };
        stage.publish(topics::GAME_STATE, game).run(&mut radio);
        assert_eq!(stage.latest(body::SAID), None);
    }

    #[test]
    fn a_kick_is_news_and_standing_still_is_not() {
        let report =
            TeamReport { ball_found: true, since_pass: 1e6, since_shot: 1e6, ..TeamReport::default() };
        let second = Duration::from_millis(100);
        assert!(news(&report, &report, second) < 0.1);
        assert!(news(&report, &TeamReport { since_pass: 0.0, ..report }, second) > 2.5);
        assert!(news(&report, &TeamReport { x: 0.5, ..report }, second) > 0.9);
        assert!(news(&report, &TeamReport { ball_found: false, ..report }, second) > 0.9);
    }

    #[test]
    fn invalid_reports_are_skipped() {
        let (mut stage, mut radio) = player();
        heard(&mut stage, 3, TeamReport { x: 1.0, sequence: 1, ..TeamReport::default() });
        heard(&mut stage, 4, TeamReport { x: f64::NAN, ..TeamReport::default() });
        let heard_at = stage.now.as_nanos();
        stage.publish(body::HEARD, Heard { number: 5, heard_at, words: vec![0xff] });
        assert!(stage.run(&mut radio));
        let mates = stage.latest(topics::TEAM).unwrap().mates;
        assert_eq!(mates.iter().map(|it| (it.number, it.x)).collect::<Vec<_>>(), [(3, 1.0)]);
    }
}
