//! The decisions of the behaviours as agents, and how often their agents run.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use monas::{Activity, Progress, Registry};
use monas_match::{MatchOptions, MatchSource};
use monas_soccer::functionality::head::Gaze;
use monas_soccer::functionality::motion::DesiredMotion;
use monas_soccer::{GameState, HeadMode, MotionRequest, MotionState};
use narukom::{Hub, Retention, Timestamp, Topic};

use super::*;
use crate::decision_cases::{Case, GazeTarget, Requests, game, goalie_cases};
use crate::decision_tests::{DecisionFixture, decision_tests, find};

/// A behaviour, its blackboard, and one for all other agents of its robot.
struct Fixture<A> {
    behaviour: A,
    now: Timestamp,
    blackboard: Blackboard,
    others: Blackboard,
}

impl<A: Activity> Fixture<A> {
    fn publish<K: Retention>(&mut self, topic: Topic<K>, message: K::Message) {
        self.others.process_messages(self.now);
        self.others.publish(topic, message).unwrap();
        self.others.publish_all(self.now);
    }

    fn report(&mut self, phase: MotionPhase, done: u64) {
        self.publish(
            topics::MOTION_STATE,
            MotionState { phase: phase.into(), done, ..MotionState::default() },
        );
    }

    /// Calls the behaviour once; returns what it requests.
    fn run(&mut self) -> Requests {
        let before = self.newest();
        self.blackboard.process_messages(self.now);
        let progress = monas::call::execute(&mut self.behaviour, &mut self.blackboard).unwrap();
        assert_eq!(progress, Progress::Done);
        self.blackboard.publish_all(self.now);
        let after = self.newest();
        let head = self.others.read(topics::HEAD).filter(|_| after.0 != before.0);
        let look = head.map(|head| match head.mode() {
            HeadMode::Look => GazeTarget::At(Gaze { yaw: head.yaw, pitch: head.pitch }),
            HeadMode::Scan | HeadMode::Ahead => GazeTarget::Scan,
        });
        let request = self.others.read(topics::MOTION).filter(|_| after.1 != before.1);
        let motion = request.map(MotionRequest::desired);
        (look, motion)
    }

    /// The numbers of the newest requests for head and body.
    fn newest(&mut self) -> (Option<u64>, Option<u64>) {
        self.others.process_messages(self.now);
        let head = self.others.sample(topics::HEAD).map(|request| request.header.sequence);
        (head, self.others.sample(topics::MOTION).map(|request| request.header.sequence))
    }
}

impl<A: Activity + Default> DecisionFixture for Fixture<A> {
    fn new() -> Fixture<A> {
        let hub = Hub::with_linked_topics("robot").unwrap();
        let [blackboard, others] = ["behaviour", "others"].map(|name| hub.blackboard(name));
        let now = Timestamp::from_nanos(10_000_000_000);
        let mut fixture = Fixture { behaviour: A::default(), now, blackboard, others };
        fixture.publish(topics::GAME_STATE, game());
        fixture.report(MotionPhase::Standing, 0);
        fixture
    }

    fn finish_motion(&mut self) {
        let number = self.others.read(topics::MOTION).map_or(0, |request| request.number);
        self.report(MotionPhase::Standing, number);
    }

    fn wait(&mut self, millis: u64) {
        self.now += Duration::from_millis(millis);
    }

    fn decide(&mut self, case: &Case) -> Requests {
        self.publish(topics::POSE, case.pose);
        self.publish(topics::BALL, case.ball);
        self.run()
    }
}

decision_tests!(Fixture<BehaviorGoalie>, Fixture<BehaviorPlayer>);

#[test]
fn goalie_plays() {
    play::<BehaviorGoalie>();
}

#[test]
fn player_plays() {
    play::<BehaviorPlayer>();
}

/// Stands up first, decides only during play and only on new estimates of the ball.
fn play<A: Activity + Default>() {
    let mut fixture = Fixture::<A>::new();
    let search = find(goalie_cases(), "search");
    fixture.report(MotionPhase::Fallen, 0);
    assert_eq!(fixture.decide(&search), (None, Some(DesiredMotion::Stand)), "it stands up first");
    fixture.report(MotionPhase::Standing, 0);
    fixture.publish(topics::GAME_STATE, GameState { player_state: PlayerState::Ready.into(), ..game() });
    assert!(matches!(fixture.decide(&search).1, Some(DesiredMotion::Walk(_))), "it walks to its place");
    for state in [PlayerState::Set, PlayerState::Penalized] {
        fixture.publish(topics::GAME_STATE, GameState { player_state: state.into(), ..game() });
        assert_eq!(fixture.decide(&search), (None, None), "it waits for play");
    }
    fixture.publish(topics::GAME_STATE, game());
    assert_eq!(fixture.decide(&search).0, Some(GazeTarget::Scan));
    assert_eq!(fixture.run(), (None, None), "a message is used once");
    assert_eq!(fixture.decide(&search).0, Some(GazeTarget::Scan));
}

#[test]
fn agents_run_in_time() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/evaluation/agents.xml");
    let plan = MatchSource::load(file, &Registry::linked()).unwrap();
    let mut running = plan.start(MatchOptions { seed: 1, record: None }).unwrap();
    running.advance(Duration::from_secs(10)).unwrap();
    let agents = running.finish().unwrap().agents;
    for host in ["blue-1", "blue-2", "blue-3"] {
        let cycles: BTreeMap<&str, u64> = agents
            .iter()
            .filter(|agent| agent.host == host)
            .map(|agent| (agent.agent.as_str(), agent.cycles))
            .collect();
        assert_eq!(cycles.len(), 6, "{host}: {cycles:?}");
        for (name, cycles) in cycles {
            let expected: u64 = if (host, name) == ("blue-1", "Vision") { 50 } else { 100 };
            assert!(expected.abs_diff(cycles) <= 1, "{host}: {name} ran {cycles} times in 10 s");
        }
    }
}
