//! Activities of a list that fail or panic are called again, skipped, or stop their agent, without
//! effect on others.

use crate::kit::{BALL, Ball, GAME, at, recorder};
use monas::{
    Activity, Agent, AgentStatistics, Blackboard, BoxError, FailurePolicy, Hz, Progress, Talws, Topics,
};

/// Fails in these cycles of its agent, and records its calls.
struct FailingActivity<N> {
    at: &'static [u64],
    starts: bool,
    note: N,
}

impl<N: Fn(String) + Send> FailingActivity<N> {
    fn fail(&self, blackboard: &Blackboard, what: &str) -> Result<(), BoxError> {
        let cycle = blackboard.now().as_nanos() / 1_000_000 + 1;
        (self.note)(format!("{what} {cycle}"));
        if self.at.contains(&cycle) { Err("broken".into()) } else { Ok(()) }
    }
}

impl<N: Fn(String) + Send> Activity for FailingActivity<N> {
    fn start(&mut self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        if self.starts { self.fail(blackboard, "start") } else { Ok(()) }
    }
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        self.fail(blackboard, "call")?;
        Ok(Progress::Done)
    }
    fn stop(&mut self, _: &mut Blackboard) {
        (self.note)("stop".into());
    }
}

/// The calls of an activity that fails in these cycles.
fn calls(
    at_cycles: &'static [u64],
    starts: bool,
    policy: FailurePolicy,
    cycles: u64,
) -> (Vec<String>, AgentStatistics) {
    let (calls, note) = recorder();
    let fails = FailingActivity { at: at_cycles, starts, note };
    let agent = Agent::new("a", Hz(1000)).activity(fails).on_failure(policy);
    let mut simulation = Talws::new().agent(agent).simulate(1).unwrap();
    simulation.run_until(at(cycles)).unwrap();
    (calls.taken(), simulation.statistics().agents.remove(0))
}

#[test]
fn a_restarted_activity_starts_again_and_pauses_longer_each_time() {
    let (calls, statistics) = calls(&[2, 3, 5, 9], true, FailurePolicy::Restart, 19);
    // The first failure skips no call, the second one, the third three.
    let expected = [
        "start 1", "call 1", "call 2", "start 3", "start 5", "start 9", "start 17", "call 17", "call 18",
        "call 19",
    ];
    assert_eq!(calls, expected);
    assert_eq!(
        (statistics.cycles, statistics.activities[0].calls, statistics.activities[0].failures),
        (19, 5, 4)
    );
}

#[test]
fn pauses_restart_after_a_success() {
    let (calls, _) = calls(&[1, 2, 4, 6], false, FailurePolicy::Restart, 7);
    assert_eq!(calls, ["call 1", "call 2", "call 4", "call 8"][..3].to_vec());
    let (calls, _) = self::calls(&[1, 3, 5], false, FailurePolicy::Restart, 6);
    assert_eq!(calls, ["call 1", "call 2", "call 3", "call 4", "call 5", "call 6"]);
}

#[test]
fn pauses_have_an_end() {
    static ALL: [u64; 1000] = {
        let mut all = [0; 1000];
        let mut cycle = 0;
        while cycle < 1000 {
            all[cycle] = cycle as u64 + 1;
            cycle += 1;
        }
        all
    };
    let (calls, _) = calls(&ALL, false, FailurePolicy::Restart, 1000);
    assert_eq!(calls[calls.len() - 2..], ["call 896".to_string(), "call 960".to_string()]);
}

#[test]
fn a_skipped_failure_has_no_effect() {
    let (calls, statistics) = calls(&[2], true, FailurePolicy::Skip, 3);
    assert_eq!(calls, ["start 1", "call 1", "call 2", "call 3"]);
    assert_eq!(statistics.activities[0].failures, 1);
}

#[test]
fn stopping_the_agent_stops_its_activities() {
    let (calls, statistics) = calls(&[2], false, FailurePolicy::StopAgent, 5);
    assert_eq!(calls, ["call 1", "call 2", "stop"]);
    assert_eq!(statistics.stopped.as_deref(), Some("activity `FailingActivity` failed in cycle 2: broken"));
    assert_eq!(statistics.cycles, 2);
}

#[test]
fn a_panic_harms_neither_the_next_activity_nor_another_agent() {
    let (calls, note) = recorder();
    let other = note.clone();
    let panics = |_: &mut Blackboard| -> () { panic!("ouch") };
    let agent = Agent::new("a", Hz(10)).activity(panics).activity(move |_: &mut Blackboard| note("next"));
    let talws = Talws::new().agent(agent);
    let talws = talws.agent(Agent::new("b", Hz(10)).activity(move |_: &mut Blackboard| other("other")));
    let mut simulation = talws.simulate(1).unwrap();
    simulation.run_until(at(200)).unwrap();
    assert_eq!(calls.taken(), ["next", "other", "next", "other"]);
    assert_eq!(simulation.statistics().agents[0].activities[0].failures, 2);
}

#[test]
fn writes_before_a_failure_are_published() {
    let (seen, note) = recorder();
    let writes = |b: &mut Blackboard| -> Result<(), BoxError> {
        b.publish(BALL, Ball::default())?;
        Err("broken".into())
    };
    let agent = Agent::new("a", Hz(10)).activity(writes).on_failure(FailurePolicy::StopAgent);
    let reads = Agent::new("b", Hz(10)).activity(move |b: &mut Blackboard| note(b.read(BALL).is_some()));
    Talws::new().agent(agent).agent(reads).simulate(1).unwrap().run_until(at(1)).unwrap();
    assert_eq!(seen.taken(), [true]);
}

/// Reads the ball, and the game from its second call on; declares one of them or nothing.
struct Declaring(Topics, u32);

impl Activity for Declaring {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        self.1 += 1;
        blackboard.read(BALL);
        if self.1 > 1 {
            blackboard.read(GAME);
        }
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        self.0.clone()
    }
}

#[test]
fn a_listed_activity_fails_when_it_reads_a_topic_that_it_does_not_declare() {
    let stopped = |topics: Topics| {
        let activity = Declaring(topics, 0);
        let agent = Agent::new("a", Hz(10)).activity(activity).on_failure(FailurePolicy::StopAgent);
        let mut simulation = Talws::new().agent(agent).simulate(1).unwrap();
        simulation.run_until(at(500)).unwrap();
        simulation.statistics().agents[0].stopped.clone()
    };
    let reason = "activity `Declaring` failed in cycle 2: it reads `test/game`, which it does not declare: \
                  add the topic to its `topics`";
    assert_eq!(stopped(Topics::declared().reads(BALL)).as_deref(), Some(reason));
    assert_eq!(stopped(Topics::declared().reads(BALL).ends_on(GAME)), None);
    assert_eq!(stopped(Topics::undeclared()), None, "checks do not apply to it");
}

#[test]
fn what_is_not_declared_is_reported_once_and_the_activity_goes_on() {
    let agent = Agent::new("a", Hz(10)).activity(Declaring(Topics::declared().reads(BALL), 0));
    let mut simulation = Talws::new().agent(agent).simulate(1).unwrap();
    simulation.run_until(at(900)).unwrap();
    let statistics = simulation.statistics();
    assert_eq!((statistics.agents[0].cycles, statistics.agents[0].activities[0].failures), (9, 1));
}
