//! Activities that leak are reported, others are not, with the counting allocator.
#![allow(clippy::unwrap_used, clippy::panic)] // a test may fail

#[path = "monas/kit.rs"]
mod kit;

use std::time::{Duration, Instant};

use monas::records::{ActivityEntry, AgentEntry};
use monas::{Agent, Blackboard, BoxError, Hz, Progress, Registry, Talws};
use narukom::{Data, topic};

use kit::{BALL, Ball};

#[global_allocator]
static ALLOCATOR: monas::memory::CountingAllocator = monas::memory::CountingAllocator;

topic! {
    /// Messages with memory of their own.
    pub(crate) MODELS: Data<monas::records::Model, 8> = "test/models";
}

/// Retains 64 more bytes with each call.
fn leaking() -> impl FnMut(&mut Blackboard) + Send + 'static {
    let mut kept: Vec<Box<[u8; 64]>> = Vec::new();
    move |_| kept.push(Box::new([1; 64]))
}

/// Allocates much, and frees it.
fn swelling(blackboard: &mut Blackboard) {
    let much = vec![1_u8; 10_000];
    let x = f64::from(much[(blackboard.now().as_nanos() % 10_000) as usize]);
    let _ = blackboard.publish(BALL, Ball { x, ..Ball::default() });
}

/// Publishes messages with texts of their own, which others give back when newer ones come.
fn publishing(blackboard: &mut Blackboard) -> Result<(), BoxError> {
    let nodes = vec!["state".repeat(50); 3];
    Ok(blackboard.publish(MODELS, monas::records::Model { nodes, ..Default::default() })?)
}

fn reading(blackboard: &mut Blackboard) {
    assert!(blackboard.read(MODELS).is_none_or(|model| model.nodes.len() == 3));
}

/// The statistics of an activity; none before its agent has published any.
fn find<'a>(agents: &'a [AgentEntry], name: &str) -> Option<&'a ActivityEntry> {
    agents.iter().flat_map(|agent| &agent.activities).find(|activity| activity.name == name)
}

fn activity<'a>(agents: &'a [AgentEntry], name: &str) -> &'a ActivityEntry {
    find(agents, name).unwrap()
}

#[test]
#[expect(clippy::disallowed_methods, reason = "a run in real time is looked at until it shows something")]
fn an_activity_that_leaks_is_named_in_a_list_and_in_a_chart_and_others_are_not() {
    let registry = Registry::empty().with("Keeps", || {
        let mut leak = leaking();
        move |blackboard: &mut Blackboard| {
            leak(blackboard);
            Progress::after(Duration::from_millis(1))
        }
    });
    let (chart, _) = aseme_models::statechart_of(&yase::Source::new("m.srm", "m = Keeps"));
    let list = Agent::new("list", Hz(2000))
        .named_activity("Leaks", Box::new(leaking()))
        .named_activity("Swells", Box::new(swelling))
        .named_activity("Publishes", Box::new(publishing));
    let reader = Agent::new("reader", Hz(1000)).named_activity("Reads", Box::new(reading));
    let talws =
        Talws::new().registry(registry).agent(list).agent(reader).agent(Agent::statechart("chart", chart));
    let running = talws.start().unwrap();
    let begun = Instant::now();
    let agents = loop {
        let agents = running.run_handle().agents(None).unwrap();
        let is_named = |name| find(&agents, name).is_some_and(|it| it.grows);
        // All leaks had time to be reported.
        let has_run = |name: &&str| find(&agents, name).is_some_and(|it| it.calls > 1000);
        let all = ["Swells", "Publishes", "Reads"].iter().all(has_run);
        if is_named("Leaks") && is_named("Keeps") && all {
            break agents;
        }
        assert!(begun.elapsed() < Duration::from_secs(60), "none is named: {agents:?}");
        std::thread::yield_now();
    };
    for name in ["Swells", "Publishes", "Reads"] {
        assert!(!activity(&agents, name).grows, "{name}: {agents:?}");
    }
    let leaks = activity(&agents, "Leaks");
    assert!(leaks.held.unwrap() >= 64 * leaks.calls.saturating_sub(10), "{leaks:?}");
    assert!(activity(&agents, "Publishes").held.unwrap() < 20_000, "{agents:?}");
    running.stop();
}

#[test]
fn a_measured_simulation_accounts_memory() {
    let agent = Agent::new("list", Hz(1000)).named_activity("Leaks", Box::new(leaking()));
    let mut simulation = Talws::new().agent(agent).simulate(1).unwrap();
    simulation.measure();
    simulation.run_until(kit::at(1000)).unwrap();
    let leaks = &simulation.statistics().agents[0].activities[0];
    assert!(leaks.grows && leaks.held.unwrap() >= 64 * 900, "{leaks:?}");
}
