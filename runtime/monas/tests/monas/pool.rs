//! The pool of statechart agents in real time. The tests wait for events, never for time to pass.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Barrier, Mutex};
use std::time::Duration;

use crate::kit::{BALL, Ball, NEWS};
use monas::{
    Agent, Blackboard, BoxError, FailurePolicy, Hz, MicroStep, Progress, RealTimeRun, Registry, Talws,
};
use yase::{MicroStepCause, Source, Statechart};

/// Longer than any successful operation takes.
const TIMEOUT: Duration = Duration::from_secs(20);

fn chart(text: &str) -> Statechart {
    let (chart, diagnostics) = aseme_models::statechart_of(&Source::new("m.srm", text));
    assert_eq!(diagnostics, [], "{diagnostics:#?}");
    chart
}

/// A chart whose events are recorded as words, with activities that wait at gates and messages sent
/// by the test.
struct PoolFixture {
    registry: Registry,
    words: Receiver<String>,
    report: Sender<String>,
    /// Opens the gate.
    open: Sender<()>,
    gate: Arc<Mutex<Receiver<()>>>,
    /// Whether the news is published.
    news: Arc<AtomicBool>,
}

impl PoolFixture {
    /// `A` to `D` record their calls; `Work` records its start, waits at the gate, and
    /// records its end.
    fn new() -> PoolFixture {
        let (report, words) = channel();
        let (open, gate) = channel();
        let gate = Arc::new(Mutex::new(gate));
        let fixture =
            PoolFixture { registry: Registry::linked(), words, report, open, gate, news: Arc::default() };
        let fixture = ["A", "B", "C", "D"].into_iter().fold(fixture, PoolFixture::with_speaker);
        let (report, gate) = (fixture.report.clone(), fixture.gate.clone());
        fixture.with("Work", move |_| {
            report.send("Work begins".into())?;
            gate.lock().unwrap().recv_timeout(TIMEOUT)?;
            report.send("Work ends".into())?;
            Ok(Progress::Done)
        })
    }

    fn with(
        mut self,
        name: &str,
        call: impl Fn(&mut Blackboard) -> Result<Progress, BoxError> + Clone + Send + Sync + 'static,
    ) -> PoolFixture {
        self.registry = self.registry.with(name, move || call.clone());
        self
    }

    fn with_speaker(self, name: &'static str) -> PoolFixture {
        let report = self.report.clone();
        self.with(name, move |_| {
            report.send(name.into())?;
            Ok(Progress::Done)
        })
    }

    /// Starts the chart, beside an agent that publishes a ball at once, and one news and another
    /// ball on request.
    fn start(&self, agent: impl Fn(Agent) -> Agent, text: &str) -> RealTimeRun {
        let news = self.news.clone();
        let mut published = 0;
        let reporter = move |b: &mut Blackboard| -> Result<(), BoxError> {
            if published == 0 || published == 1 && news.load(Ordering::SeqCst) {
                published += 1;
                b.publish(BALL, Ball { found: true, x: f64::from(published), ..Ball::default() })?;
                if published == 2 {
                    b.publish(NEWS, Ball::default())?;
                }
            }
            Ok(())
        };
        let agent = agent(Agent::statechart("m", chart(text)));
        let mut talws = Talws::new().registry(self.registry.clone()).agent(agent);
        let report = self.report.clone();
        talws.listen(Box::new(move |step: MicroStep<'_>| {
            if let MicroStepCause::Event(event) = step.record.cause {
                let (name, held) = (step.chart.events().name(event), !step.record.held.is_empty());
                let _ = report.send(format!("{name}{}", if held { " held" } else { "" }));
            }
        }));
        talws.agent(Agent::new("z", Hz(1000)).activity(reporter)).start().unwrap()
    }

    /// The next recorded words.
    fn next(&self, count: usize) -> Vec<String> {
        (0..count).map(|_| self.words.recv_timeout(TIMEOUT).unwrap()).collect()
    }

    fn report_news(&self) {
        self.news.store(true, Ordering::SeqCst);
    }

    fn open_the_gate(&self) {
        self.open.send(()).unwrap();
    }
}

fn same(agent: Agent) -> Agent {
    agent
}

#[test]
fn activities_of_three_regions_run_at_the_same_time_and_never_two_of_one() {
    const ROUNDS: usize = 100;
    let (sender, done) = channel();
    let barrier = Arc::new(Barrier::new(3));
    let violations = Arc::new(AtomicU64::new(0));
    let registry = ["A", "B", "C"].into_iter().fold(Registry::empty(), |registry, name| {
        let (sender, barrier, violations) = (sender.clone(), barrier.clone(), violations.clone());
        let inside = Arc::new(AtomicBool::new(false));
        // Both states of a region share what counts.
        let round = Arc::new(AtomicU64::new(0));
        registry.with(name, move || {
            let (sender, barrier, violations) = (sender.clone(), barrier.clone(), violations.clone());
            let (inside, round) = (inside.clone(), round.clone());
            move |_: &mut Blackboard| -> Result<Progress, BoxError> {
                violations.fetch_add(u64::from(inside.swap(true, Ordering::SeqCst)), Ordering::SeqCst);
                let past = round.fetch_add(1, Ordering::SeqCst) as usize >= ROUNDS;
                if !past {
                    // Requires all activities to run in parallel.
                    barrier.wait();
                }
                inside.store(false, Ordering::SeqCst);
                match past {
                    true => sender.send(name).map(|()| Progress::after(TIMEOUT)).map_err(BoxError::from),
                    false => Ok(Progress::Done),
                }
            }
        })
    });
    let text = "Liveness:\nm = (A . A)~ || (B . B)~ || (C . C)~";
    let running = Talws::new().registry(registry).agent(Agent::statechart("m", chart(text))).start().unwrap();
    let mut all: Vec<&str> = (0..3).map(|_| done.recv_timeout(TIMEOUT).unwrap()).collect();
    all.sort_unstable();
    assert_eq!(all, ["A", "B", "C"]);
    let statistics = running.stop();
    assert_eq!(violations.load(Ordering::SeqCst), 0);
    assert!(statistics.calls("local", "A") > ROUNDS as u64);
}

#[test]
fn an_interrupting_transition_asks_the_activity_to_return_and_fires_when_it_has() {
    let fixture = PoolFixture::new();
    let report = fixture.report.clone();
    let fixture = fixture.with("Watch", move |b| {
        report.send("Watch begins".into())?;
        while !b.is_cancelled() {
            std::thread::yield_now();
        }
        report.send("Watch ends".into())?;
        Ok(Progress::Done)
    });
    let running = fixture.start(same, "Liveness:\nm = Watch . B\nTransitions:\nWatch -> B interrupts : news");
    assert_eq!(fixture.next(1), ["Watch begins"]);
    fixture.report_news();
    // The activity may have received it before the thread of the chart has reported it.
    let mut notes = fixture.next(2);
    notes.sort_unstable();
    assert_eq!(notes, ["Watch ends", "test/news held"]);
    assert_eq!(fixture.next(2), ["test/news", "B"]);
    running.stop();
}

#[test]
fn an_event_is_held_until_the_activity_of_the_state_it_leaves_has_returned() {
    let fixture = PoolFixture::new();
    let running = fixture.start(same, "Liveness:\nm = Work . B\nTransitions:\nWork -> B : news");
    assert_eq!(fixture.next(1), ["Work begins"]);
    fixture.report_news();
    assert_eq!(fixture.next(1), ["test/news held"]);
    fixture.open_the_gate();
    assert_eq!(fixture.next(3), ["Work ends", "test/news", "B"]);
    running.stop();
}

#[test]
fn a_guard_sees_what_the_blackboard_showed_when_the_running_activity_began() {
    let fixture = PoolFixture::new();
    // While `Work` runs, its blackboard shows the first ball; the second has arrived with the news,
    // but is not delivered to it.
    let text =
        "Liveness:\nm = A . Work . B\nTransitions:\nA -> Work : [ball.found]\nWork -> B : news [ball.x == 1]";
    let running = fixture.start(same, text);
    assert_eq!(fixture.next(2), ["A", "Work begins"]);
    fixture.report_news();
    assert_eq!(fixture.next(1), ["test/news held"], "the guard reads the first ball");
    fixture.open_the_gate();
    // Offered again it meets the second ball, so no transition takes it.
    assert_eq!(fixture.next(2), ["Work ends", "test/news"]);
    let statistics = running.stop();
    assert_eq!(statistics.calls("local", "B"), 0);
}

#[test]
fn a_composite_is_not_left_while_an_activity_of_a_nested_and_runs() {
    let fixture = PoolFixture::new();
    let text = "Liveness:\nm = in . D\nin = A || deep\ndeep = B . pair\npair = C || Work\n\
                Transitions:\nin -> D : news";
    let running = fixture.start(same, text);
    let mut begun = fixture.next(4);
    begun.sort_unstable();
    assert_eq!(begun, ["A", "B", "C", "Work begins"]);
    fixture.report_news();
    assert_eq!(fixture.next(1), ["test/news held"]);
    fixture.open_the_gate();
    assert_eq!(fixture.next(3), ["Work ends", "test/news", "D"]);
    running.stop();
}

#[test]
fn two_states_with_one_activity_have_an_instance_and_a_running_flag_each() {
    let fixture = PoolFixture::new();
    let (report, gate) = (fixture.report.clone(), fixture.gate.clone());
    let made = Arc::new(AtomicU64::new(0));
    let registry = fixture.registry.clone().with("Same", move || {
        let (report, gate) = (report.clone(), gate.clone());
        let number = made.fetch_add(1, Ordering::SeqCst);
        move |_: &mut Blackboard| -> Result<(), BoxError> {
            if number == 1 {
                gate.lock().unwrap().recv_timeout(TIMEOUT)?;
            }
            Ok(report.send(format!("Same {number}"))?)
        }
    });
    let fixture = PoolFixture { registry, ..fixture };
    let running = fixture.start(same, "m = (Same . A) || (Same . B)");
    assert_eq!(fixture.next(2), ["Same 0", "A"], "the other still runs");
    fixture.open_the_gate();
    assert_eq!(fixture.next(2), ["Same 1", "B"]);
    running.stop();
}

#[test]
fn a_message_wakes_a_chart_in_which_everybody_waits() {
    let fixture = PoolFixture::new();
    let report = fixture.report.clone();
    let fixture = fixture.with("Wait", move |b| {
        let ball = b.read(BALL).map_or(0.0, |ball| ball.x);
        report.send(format!("ball {ball}"))?;
        Ok(if ball < 2.0 { Progress::after(Duration::from_secs(3600)) } else { Progress::Done })
    });
    let running = fixture.start(same, "m = Wait . A");
    while fixture.next(1) != ["ball 1"] {}
    fixture.report_news();
    // A message that came while it was called wakes it once more, be it the one that it has already
    // seen.
    let mut notes = fixture.next(1);
    while notes == ["ball 1"] {
        notes = fixture.next(1);
    }
    assert_eq!(notes, ["ball 2"]);
    assert_eq!(fixture.next(1), ["A"]);
    running.stop();
}

#[test]
fn the_most_urgent_activity_goes_first_by_its_state_or_by_the_transition_into_it() {
    let fixture = PoolFixture::new();
    let text = "Liveness:\nm = Work || A || B || C\nTransitions:\nSTART -> B !5\nA -> END : news [false]\n\
                States:\nWork : priority = 100\nC : priority = 9";
    let one = NonZeroUsize::MIN;
    let running = fixture.start(|agent| agent.workers(one), text);
    assert_eq!(fixture.next(1), ["Work begins"]);
    fixture.report_news();
    // The chart takes the news after it has handed out all that it started.
    assert_eq!(fixture.next(1), ["test/news"]);
    fixture.open_the_gate();
    assert_eq!(fixture.next(4), ["Work ends", "C", "B", "A"]);
    running.stop();
}

/// Panics again when it is dropped.
struct Bomb;

impl Drop for Bomb {
    fn drop(&mut self) {
        panic!("again");
    }
}

#[test]
fn an_activity_that_panics_on_the_pool_frees_its_region_and_is_an_event() {
    let fixture = PoolFixture::new();
    let fixture = fixture.with("Fail", |_| std::panic::panic_any(Bomb));
    let running = fixture.start(
        |agent| agent.on_failure(FailurePolicy::Skip),
        "Liveness:\nm = (Fail . A) || (Work . B)\nTransitions:\nFail -> A : error.activity",
    );
    let mut words = fixture.next(3);
    words.sort_unstable();
    assert_eq!(words, ["A", "Work begins", "error.activity"]);
    fixture.open_the_gate();
    assert_eq!(fixture.next(2), ["Work ends", "B"], "the other region goes on");
    let statistics = running.stop();
    let failed = statistics.agents[0].activities.iter().map(|a| a.failures).sum::<u64>();
    assert_eq!((failed, statistics.agents[0].stopped.as_deref()), (1, None));
}

#[test]
fn the_end_of_a_run_asks_running_activities_to_return() {
    let fixture = PoolFixture::new();
    let report = fixture.report.clone();
    let fixture = fixture.with("Watch", move |b| {
        report.send("Watch begins".into())?;
        while !b.is_cancelled() {
            std::thread::yield_now();
        }
        Ok(Progress::Done)
    });
    let running = fixture.start(same, "m = Watch");
    assert_eq!(fixture.next(1), ["Watch begins"]);
    assert_eq!(running.stop().calls("local", "Watch"), 1);
}

#[test]
fn a_chart_reports_durations_of_steps_and_calls() {
    let fixture = PoolFixture::new();
    let running = fixture.start(same, "m = A . B");
    assert_eq!(fixture.next(2), ["A", "B"]);
    let statistics = running.stop();
    let agent = &statistics.agents[0];
    assert_eq!(agent.cycle_time.map(|time| time.count()), Some(agent.cycles));
    assert_eq!(agent.activities[0].call_time.map(|time| time.count()), Some(1));
}
