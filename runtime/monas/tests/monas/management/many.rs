//! A thousand random changes in simulated time do not affect agents that are not changed.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use monas::records::{CHANGED, Changed};
use monas::{Agent, Blackboard, Hz, Registry, Simulation, Talws};
use narukom::{Observer, Publication, Random};
use yase::{Source, Statechart};

use crate::changes::{MODELS, any_change};
use crate::kit::{BALL, Ball, GAME, Game, at};

/// The number of changes, and the time of all of them in milliseconds.
const CHANGES: u64 = 1000;
const MILLIS: u64 = 20_000;

/// By publisher: how many messages there were, and a hash of all of them with their moments. And
/// all answers.
#[derive(Clone, Default)]
struct SeenChanges(Arc<Mutex<(Publishers, Vec<Changed>)>>);

type Publishers = BTreeMap<String, (u64, blake3::Hasher)>;

impl Observer for SeenChanges {
    fn observe(&mut self, publication: Publication<'_>) {
        let mut seen = self.0.lock().unwrap();
        if publication.topic.path() == CHANGED.path() {
            seen.1.push(publication.sample.downcast::<Changed>().unwrap().message.clone());
        }
        let (count, hasher) = seen.0.entry(publication.publisher.to_owned()).or_default();
        *count += 1;
        hasher.update(publication.topic.path().as_bytes());
        hasher.update(&publication.sample.header.published.as_nanos().to_le_bytes());
        hasher.update(publication.bytes());
    }
}

fn chart(text: &str) -> Statechart {
    aseme_models::statechart_of(&Source::new("m.srm", text)).0
}

/// Two agents that are not changed, and some that are.
fn simulation(seen: &SeenChanges) -> Simulation {
    let works = |blackboard: &mut Blackboard| {
        let x = blackboard.random().uniform();
        blackboard.publish(BALL, Ball { x, ..Ball::default() })
    };
    let registry = Registry::empty().with("W", move || works).with("V", move || |_: &mut Blackboard| {});
    let calm = |blackboard: &mut Blackboard| {
        let phase = (blackboard.random().uniform() * 2.0) as i32;
        blackboard.publish(GAME, Game { phase })
    };
    let mut talws = Talws::new().registry(registry.clone());
    talws.observe(Box::new(seen.clone()));
    talws = talws.agent(Agent::new("calm", Hz(100)).activity(calm));
    talws = talws.agent(Agent::statechart("steady", chart("m = (V . V)~")).every(Hz(50)));
    for number in 0..4 {
        let agent = Agent::new(format!("x{number}"), Hz(30 * (number + 1)));
        let agent = agent.named_activity("W", registry.activity("W").unwrap());
        talws = talws.agent(agent.named_activity("V", registry.activity("V").unwrap()));
    }
    talws.agent(Agent::statechart("y", chart(MODELS[0]))).simulate(7).unwrap()
}

/// Observations of a run with a number of changes.
fn run(changes: u64) -> SeenChanges {
    let seen = SeenChanges::default();
    let mut simulation = simulation(&seen);
    let mut random = Random::from_seed([3; 32]);
    for number in 1..=changes {
        let moment = at((random.uniform() * MILLIS as f64) as u64);
        simulation.change_at(moment, "local", any_change(number, &mut random)).unwrap();
    }
    simulation.run_until(at(MILLIS)).unwrap();
    let statistics = simulation.statistics();
    let calm = statistics.agents.iter().find(|agent| agent.agent == "calm").unwrap();
    assert_eq!((calm.cycles, calm.overruns), (MILLIS / 10, 0), "not one cycle is missed");
    seen
}

#[test]
fn a_thousand_changes_are_answered_without_effect_on_others() {
    let (changed, alone) = (run(CHANGES), run(0));
    let (changed, alone) = (changed.0.lock().unwrap(), alone.0.lock().unwrap());
    let mut numbers: Vec<u64> = changed.1.iter().map(|answer| answer.number).collect();
    numbers.sort_unstable();
    assert_eq!(numbers, (1..=CHANGES).collect::<Vec<u64>>(), "each is answered once");
    let made = changed.1.iter().filter(|answer| answer.done);
    let mut by_action: BTreeMap<String, u64> = BTreeMap::new();
    made.for_each(|answer| *by_action.entry(answer.action().as_str_name().into()).or_default() += 1);
    assert_eq!(by_action.len(), 13, "each kind was made at least once: {by_action:?}");
    assert!(by_action.values().sum::<u64>() > CHANGES / 4, "{by_action:?}");
    assert!(changed.1.iter().all(|answer| answer.done != answer.findings.iter().any(|one| one.is_error)));
    for agent in ["calm", "steady"] {
        let of = |seen: &Publishers| seen.get(agent).map(|(count, hasher)| (*count, hasher.finalize()));
        assert!(of(&alone.0).is_some());
        assert_eq!(of(&changed.0), of(&alone.0), "{agent} does what it does without changes");
    }
}

#[test]
fn the_same_thousand_changes_give_the_same_bytes() {
    let hashes = |seen: &SeenChanges| -> Vec<_> {
        let seen = seen.0.lock().unwrap();
        seen.0.iter().map(|(name, (count, hasher))| (name.clone(), *count, hasher.finalize())).collect()
    };
    assert_eq!(hashes(&run(CHANGES)), hashes(&run(CHANGES)));
}
