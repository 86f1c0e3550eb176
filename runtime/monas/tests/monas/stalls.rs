//! Calls of activities that do not return: they are named, and the end of a run does not wait for
//! them.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Barrier, Mutex};
use std::time::Duration;

use crate::kit::{BALL, Ball, at};
use monas::records::AgentEntry;
use monas::{
    Activity, Agent, Blackboard, BoxError, ErrorKind, Hz, Progress, Registry, RunHandle, RunHash, Talws,
};
use yase::Source;

/// Longer than any successful operation takes.
const TIMEOUT: Duration = Duration::from_secs(20);

/// The limit of the agents here.
const LIMIT: Duration = Duration::from_millis(50);

/// Does not return from `stop` until its receiver has something.
struct ClingingActivity {
    called: Sender<()>,
    released: Arc<Mutex<Receiver<()>>>,
}

impl Activity for ClingingActivity {
    fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
        let _ = self.called.send(());
        Ok(Progress::after(TIMEOUT))
    }

    fn stop(&mut self, _: &mut Blackboard) {
        let _ = self.released.lock().unwrap().recv();
    }
}

/// An agent whose activity does not return from `stop`, a receiver of its calls, and a sender that
/// lets it return.
fn clinging(is_chart: bool) -> (Talws, Receiver<()>, Sender<()>) {
    let ((called, calls), (release, released)) = (channel(), channel());
    let released = Arc::new(Mutex::new(released));
    let make = move || ClingingActivity { called: called.clone(), released: released.clone() };
    let agent = match is_chart {
        true => Agent::statechart("a", aseme_models::statechart_of(&Source::new("m.srm", "m = Clinging")).0),
        false => Agent::new("a", Hz(100)).named_activity("Clinging", Box::new(make())),
    };
    let registry = Registry::empty().with("Clinging", make);
    (Talws::new().registry(registry).agent(agent.stuck_after(LIMIT)), calls, release)
}

/// Sends its calls.
struct StopReporter(Sender<&'static str>);

impl Activity for StopReporter {
    fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
        let _ = self.0.send("execute");
        Ok(Progress::Done)
    }

    fn stop(&mut self, _: &mut Blackboard) {
        let _ = self.0.send("stop");
    }
}

#[test]
fn a_run_in_real_time_ends_though_an_activity_does_not_stop() {
    for is_chart in [false, true] {
        let (talws, calls, release) = clinging(is_chart);
        let (sender, reported) = channel();
        let running = talws.agent(Agent::new("b", Hz(100)).activity(StopReporter(sender))).start().unwrap();
        calls.recv_timeout(TIMEOUT).unwrap();
        assert_eq!(reported.recv_timeout(TIMEOUT).unwrap(), "execute");
        let statistics = running.stop();
        let reason = statistics.agents[0].stopped.clone().unwrap();
        let expected = "abandoned at the end of the run: activity `Clinging` of agent `a` on `local` has not \
                        returned from `stop` for ";
        assert!(reason.starts_with(expected), "{reason}");
        while reported.recv_timeout(TIMEOUT).unwrap() != "stop" {}
        release.send(()).unwrap();
    }
}

#[test]
fn a_simulation_ends_though_an_activity_does_not_stop() {
    for is_chart in [false, true] {
        let (talws, calls, release) = clinging(is_chart);
        let mut simulation = talws.simulate(1).unwrap();
        simulation.run_until(at(100)).unwrap();
        calls.recv_timeout(TIMEOUT).unwrap();
        let error = simulation.stop_within(LIMIT).unwrap_err();
        let expected =
            "activity `Clinging` of agent `a` on `local` has not returned from `stop` within 0.1 s";
        assert_eq!((error.kind(), error.to_string().as_str()), (ErrorKind::Stuck, expected));
        release.send(()).unwrap();
    }
}

#[test]
fn a_simulation_that_stops_in_time_is_given_back() {
    let (talws, _calls, release) = clinging(false);
    release.send(()).unwrap();
    let mut simulation = talws.simulate(1).unwrap();
    simulation.run_until(at(100)).unwrap();
    assert_eq!(simulation.stop_within(TIMEOUT).unwrap().statistics().agents[0].cycles, 10);
}

/// The first agent, when it is stuck.
fn stuck(run: &RunHandle) -> AgentEntry {
    loop {
        if let Ok(agents) = run.agents(None)
            && agents[0].state == "stuck"
        {
            return agents[0].clone();
        }
        std::thread::yield_now();
    }
}

#[test]
fn a_long_call_of_a_chart_does_not_end_the_run() {
    let (leave, left) = (Arc::new(Barrier::new(2)), channel());
    let (barrier, sender) = (leave.clone(), left.0);
    let registry = Registry::empty()
        .with("Plan", move || {
            let barrier = barrier.clone();
            move |_: &mut Blackboard| _ = barrier.wait()
        })
        .with("Go", move || StopReporter(sender.clone()));
    let chart = aseme_models::statechart_of(&Source::new("m.srm", "m = Plan . Go")).0;
    let agent = Agent::statechart("m", chart).stuck_after(LIMIT);
    let running = Talws::new().registry(registry).agent(agent).start().unwrap();
    let run = running.run_handle();
    stuck(&run);
    leave.wait();
    assert_eq!(left.1.recv_timeout(TIMEOUT).unwrap(), "execute");
    running.stop();
}

/// Two seconds of an agent whose second call waits until it is released, if that is given.
fn stalled_run(stall: Option<(Arc<Barrier>, Arc<Barrier>)>) -> (Talws, RunHash) {
    let mut calls = 0;
    let waits = move |blackboard: &mut Blackboard| {
        calls += 1;
        if let (2, Some((enter, leave))) = (calls, &stall) {
            enter.wait();
            leave.wait();
        }
        blackboard.publish(BALL, Ball { x: f64::from(calls), ..Ball::default() })
    };
    let hash = RunHash::new();
    let mut talws = Talws::new().agent(Agent::new("mind", Hz(10)).activity(waits).stuck_after(LIMIT));
    talws.observe(Box::new(hash.clone()));
    (talws, hash)
}

#[test]
fn a_call_that_stops_a_simulation_is_named_and_the_run_stays_the_same() {
    let (enter, leave) = (Arc::new(Barrier::new(2)), Arc::new(Barrier::new(2)));
    let (talws, hash) = stalled_run(Some((enter.clone(), leave.clone())));
    let mut simulation = talws.simulate(1).unwrap();
    let run = simulation.run_handle();
    std::thread::scope(|threads| {
        let advance = threads.spawn(|| simulation.run_until(at(2000)));
        enter.wait();
        let agent = stuck(&run);
        assert_eq!((agent.host.as_str(), agent.name.as_str()), ("local", "mind"));
        let expected = "activity `closure` of agent `mind` on `local` has not returned from `execute` for ";
        assert!(agent.reason.starts_with(expected), "{}", agent.reason);
        assert_eq!(agent.open_calls[0].activity, "closure");
        let refused = run.publish("local", "test/unknown", &[]).unwrap_err();
        assert!(refused.starts_with(&format!("the run stands still: {expected}")), "{refused}");
        leave.wait();
        advance.join().unwrap().unwrap();
    });
    let (talws, unstalled) = stalled_run(None);
    talws.simulate(1).unwrap().run_until(at(2000)).unwrap();
    assert_eq!(hash.finish(), unstalled.finish());
}

#[cfg(target_os = "linux")]
#[test]
fn the_processor_time_of_a_call_that_spins_is_known() {
    use std::sync::atomic::{AtomicBool, Ordering};
    for is_chart in [false, true] {
        let ends = Arc::new(AtomicBool::new(false));
        let is_over = ends.clone();
        let make = move || {
            let is_over = is_over.clone();
            move |_: &mut Blackboard| {
                while !is_over.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            }
        };
        let agent = match is_chart {
            true => Agent::statechart("a", aseme_models::statechart_of(&Source::new("m.srm", "m = Spin")).0),
            false => Agent::new("a", Hz(100)).named_activity("Spin", Box::new(make())),
        };
        let registry = Registry::empty().with("Spin", make);
        let running = Talws::new().registry(registry).agent(agent).start().unwrap();
        let run = running.run_handle();
        let open = || run.agents(None).unwrap()[0].open_calls.first().cloned();
        let first = loop {
            if let Some(call) = open() {
                break call;
            }
        };
        let used = |call: &monas::records::OpenCallEntry| call.cpu_seconds.unwrap();
        let last = loop {
            let call = open().unwrap();
            if used(&call) > used(&first) + 0.02 {
                break call;
            }
        };
        assert_eq!((last.number, last.activity.as_str()), (first.number, "Spin"));
        assert!(last.seconds > first.seconds);
        ends.store(true, Ordering::Relaxed);
        running.stop();
    }
}
