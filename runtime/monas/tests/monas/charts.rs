//! Statechart agents in simulated time: their wake-ups, the calls of their activities, and the
//! messages these read and publish.

mod monitors;
mod sources;

use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::kit::{BALL, Ball, GAME, Game, NEWS, Phase, Recorder, at, recorder};
use monas::{
    Activity, Agent, Blackboard, BoxError, ErrorKind, FailurePolicy, Hz, MicroStep, Progress, Registry,
    RunHash, Simulation, Talws, Topics,
};
use yase::{Source, Statechart};

/// The chart that a model's text describes.
fn chart(text: &str) -> Statechart {
    let (chart, diagnostics) = aseme_models::statechart_of(&Source::new("m.srm", text));
    assert_eq!(diagnostics, [], "{diagnostics:#?}");
    chart
}

/// Activities `A` to `D` that note their name and the time in milliseconds.
fn noting() -> (Recorder<String>, Registry) {
    let (calls, note) = recorder();
    let registry = ["A", "B", "C", "D"].into_iter().fold(Registry::linked(), |registry, name| {
        let note = note.clone();
        registry.with(name, move || {
            let note = note.clone();
            move |b: &mut Blackboard| note(format!("{name} {}", b.now().as_nanos() / 1_000_000))
        })
    });
    (calls, registry)
}

fn simulate(registry: Registry, text: &str) -> Simulation {
    Talws::new().registry(registry).agent(Agent::statechart("m", chart(text))).simulate(1).unwrap()
}

/// An agent that publishes the ball at these milliseconds.
fn balls(times: &'static [u64]) -> Agent {
    Agent::new("z", Hz(1000)).activity(move |b: &mut Blackboard| -> Result<(), BoxError> {
        if times.iter().any(|time| at(*time) == b.now()) {
            b.publish(BALL, Ball { x: b.now().as_secs_f64(), found: true, ..Ball::default() })?;
            b.publish(NEWS, Ball::default())?;
        }
        Ok(())
    })
}

#[test]
fn a_sequence_calls_each_activity_once_and_ends() {
    let (calls, registry) = noting();
    let mut simulation = simulate(registry, "m = A . B . C");
    simulation.run_until(at(1000)).unwrap();
    assert_eq!(calls.taken(), ["A 0", "B 0", "C 0"]);
    let statistics = simulation.statistics();
    assert_eq!((statistics.calls("local", "A"), statistics.agents[0].stopped.as_deref()), (1, None));
    assert!(statistics.micro_steps() >= 4, "{statistics:?}");
    assert_eq!(simulation.coverage()[0].states_missed().count(), 0);
}

#[test]
fn a_timer_wakes_the_chart() {
    let (calls, registry) = noting();
    let text = "Liveness:\nm = A~\nTransitions:\nA -> A : [t] / StartTimeout(t, 100ms)";
    simulate(registry, text).run_until(at(301)).unwrap();
    // The first activation comes from START, the second by the loop, since a timer that was never
    // set is over.
    assert_eq!(calls.taken(), ["A 0", "A 0", "A 100", "A 200", "A 300"]);
}

#[test]
fn a_message_that_a_guard_reads_wakes_the_chart() {
    let (calls, registry) = noting();
    let text = "Liveness:\nm = A . B\nTransitions:\nA -> B : [ball.x >= 0.03]";
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart(text)));
    let mut simulation = talws.agent(balls(&[10, 20, 30, 40])).simulate(1).unwrap();
    simulation.run_until(at(100)).unwrap();
    assert_eq!(calls.taken(), ["A 0", "B 30"]);
    // One step enters, one more completes A; then one for each message until the guard holds, and
    // one for B's return.
    assert_eq!(simulation.statistics().agents[0].cycles, 6);
}

#[test]
fn a_message_published_between_two_calls_of_a_run_wakes_the_chart() {
    let (calls, registry) = noting();
    let text = "Liveness:\nm = A . B . C\nTransitions:\nA -> B : [ball.x == 1]\nB -> C : news";
    let mut simulation = simulate(registry, text);
    simulation.run_until(at(25)).unwrap();
    let hub = simulation.hub("local").unwrap().clone();
    let mut blackboard = hub.blackboard("outside");
    blackboard.publish(BALL, Ball { x: 1.0, ..Ball::default() }).unwrap();
    blackboard.publish_all(at(25));
    simulation.run_until(at(10_000)).unwrap();
    hub.publisher(NEWS, "outside").unwrap().publish(Ball::default(), at(10_000));
    simulation.run_until(at(20_000)).unwrap();
    assert_eq!(calls.taken(), ["A 0", "B 25", "C 10000"]);
}

#[test]
fn each_arrival_of_a_message_is_an_event() {
    let (calls, registry) = noting();
    let text = "Liveness:\nm = A~\nTransitions:\nA -> A : news";
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart(text)));
    talws.agent(balls(&[10, 20])).simulate(1).unwrap().run_until(at(100)).unwrap();
    assert_eq!(calls.taken(), ["A 0", "A 10", "A 20"]);
}

#[test]
fn actions_assign_fields_and_publish_once_at_the_end_of_the_step() {
    let (seen, note) = recorder();
    let (_, registry) = noting();
    let text =
        "Liveness:\nm = A . B\nTransitions:\nA -> B : / ball.x = 3, ball.found = true, game.phase = PLAY";
    let reads = move |b: &mut Blackboard| {
        let ball = b.sample(BALL).map(|ball| (ball.x, ball.found, ball.header.sequence));
        note((ball, b.read(GAME).map(Game::phase)));
    };
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart(text)));
    talws.agent(Agent::new("z", Hz(10)).activity(reads)).simulate(1).unwrap().run_until(at(150)).unwrap();
    let newest = (Some((3.0, true, 1)), Some(Phase::Play));
    assert_eq!(seen.taken(), [newest, newest]);
}

#[test]
fn enumerations_and_functions_are_words_of_expressions() {
    let (calls, registry) = noting();
    let text =
        "Liveness:\nm = A . B\nTransitions:\nA -> B : [game.phase == PLAY && abs(max(ball.x, -2)) > 0.015]";
    let plays = |b: &mut Blackboard| b.publish(GAME, Game { phase: Phase::Play.into() });
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart(text)));
    let talws = talws.agent(balls(&[10, 20])).agent(Agent::new("y", Hz(1)).activity(plays));
    talws.simulate(1).unwrap().run_until(at(100)).unwrap();
    assert_eq!(calls.taken(), ["A 0", "B 20"]);
}

#[test]
fn a_declared_duration_locks_the_region_and_publishes_at_its_end() {
    let (calls, note) = recorder();
    let registry = Registry::empty()
        .with("A", || |b: &mut Blackboard| b.publish(BALL, Ball { x: 1.0, ..Ball::default() }))
        .with("B", {
            let note = note.clone();
            move || {
                let note = note.clone();
                move |b: &mut Blackboard| note(format!("B {}", b.now().as_nanos() / 1_000_000))
            }
        });
    let reads = move |b: &mut Blackboard| {
        if b.read(BALL).is_some() {
            note(format!("ball {}", b.now().as_nanos() / 1_000_000));
        }
    };
    let text = "Liveness:\nm = A . B\nStates:\nA : duration = 50ms";
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart(text)));
    talws.agent(Agent::new("z", Hz(50)).activity(reads)).simulate(1).unwrap().run_until(at(90)).unwrap();
    assert_eq!(calls.taken(), ["B 50", "ball 60", "ball 80"]);
}

#[test]
fn a_locked_region_does_not_see_what_arrives_until_it_is_free() {
    let (calls, registry) = noting();
    let text = "Liveness:\nm = (A . B) || (C . D)\nTransitions:\nA -> B : [ball.found]\nC -> D : [ball.found]\n\
                States:\nA : duration = 35ms";
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart(text)));
    talws.agent(balls(&[10])).simulate(1).unwrap().run_until(at(100)).unwrap();
    assert_eq!(calls.taken(), ["A 0", "C 0", "D 10", "B 35"]);
}

/// Continues for a number of calls, and records when it is stopped.
struct PatientActivity<N> {
    calls: u32,
    again: u32,
    delay: Duration,
    reads: bool,
    note: N,
}

impl<N: Fn(String) + Send> Activity for PatientActivity<N> {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        self.calls += 1;
        let ball = if self.reads { blackboard.read(BALL).map(|ball| ball.x) } else { None };
        (self.note)(format!("call {} {ball:?}", blackboard.now().as_nanos() / 1_000_000));
        Ok(if self.calls > self.again { Progress::Done } else { Progress::after(self.delay) })
    }
    fn topics(&self) -> Topics {
        if self.reads { Topics::undeclared() } else { Topics::declared() }
    }
    fn stop(&mut self, blackboard: &mut Blackboard) {
        (self.note)(format!("stop {}", blackboard.now().as_nanos() / 1_000_000));
    }
}

fn patient(again: u32, delay: u64, reads: bool, text: &str, until: u64) -> Vec<String> {
    let (calls, note) = recorder();
    let registry = Registry::empty()
        .with("A", {
            let note = note.clone();
            move || PatientActivity {
                calls: 0,
                again,
                delay: Duration::from_millis(delay),
                reads,
                note: note.clone(),
            }
        })
        .with("B", move || {
            let note = note.clone();
            move |b: &mut Blackboard| note(format!("B {}", b.now().as_nanos() / 1_000_000))
        });
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart(text)));
    talws.agent(balls(&[35])).simulate(1).unwrap().run_until(at(until)).unwrap();
    calls.taken()
}

#[test]
fn an_ongoing_activity_is_called_again_after_its_delay_and_completes_when_done() {
    assert_eq!(
        patient(2, 20, false, "m = A . B", 100),
        ["call 0 None", "call 20 None", "call 40 None", "B 40"]
    );
}

#[test]
fn an_ongoing_activity_is_called_early_when_a_message_arrives_on_a_topic_it_has_read() {
    let called = patient(2, 50, true, "m = A . B", 200);
    assert_eq!(called, ["call 0 None", "call 35 Some(0.035)", "call 85 Some(0.035)", "B 85"]);
}

#[test]
fn a_message_on_a_topic_it_has_not_read_leaves_it_alone() {
    assert_eq!(patient(1, 50, false, "m = A . B", 200), ["call 0 None", "call 50 None", "B 50"]);
}

#[test]
fn the_end_of_a_run_stops_streams() {
    let (calls, note) = recorder();
    let registry = Registry::empty().with("A", move || PatientActivity {
        calls: 0,
        again: 100,
        delay: Duration::from_millis(30),
        reads: false,
        note: note.clone(),
    });
    let mut simulation = simulate(registry, "m = A");
    simulation.run_until(at(50)).unwrap();
    simulation.stop();
    simulation.run_until(at(100)).unwrap();
    assert_eq!(calls.taken(), ["call 0 None", "call 30 None", "stop 30"]);
    assert_eq!(simulation.statistics().agents[0].stopped, None, "nothing was wrong");
}

#[test]
fn an_activity_is_not_called_early_by_its_own_messages() {
    let (calls, note) = recorder();
    let echo = move || {
        let note = note.clone();
        move |b: &mut Blackboard| -> Result<Progress, BoxError> {
            note(b.now().as_nanos() / 1_000_000);
            let x = b.read(BALL).map_or(0.0, |ball| ball.x);
            b.publish(BALL, Ball { x: x + 1.0, ..Ball::default() })?;
            Ok(Progress::after(Duration::from_millis(40)))
        }
    };
    let registry = Registry::empty().with("A", echo);
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart("m = A")));
    talws.simulate(1).unwrap().run_until(at(100)).unwrap();
    assert_eq!(calls.taken(), [0, 40, 80]);
}

#[test]
fn a_delay_of_nothing_lets_time_go_on() {
    let registry = Registry::empty().with("A", || |_: &mut Blackboard| Progress::after(Duration::ZERO));
    let mut simulation = simulate(registry, "m = A");
    simulation.run_until(at(10)).unwrap();
    assert_eq!(simulation.statistics().calls("local", "A"), 10);
}

#[test]
fn activities_that_wake_each_other_endlessly_stop_their_agent() {
    let echo = || {
        |b: &mut Blackboard| -> Result<Progress, BoxError> {
            let x = b.read(BALL).map_or(0.0, |ball| ball.x);
            b.publish(BALL, Ball { x, ..Ball::default() })?;
            Ok(Progress::ongoing())
        }
    };
    let registry = Registry::empty().with("A", echo).with("B", echo);
    let mut simulation = simulate(registry, "m = A || B");
    simulation.run_until(at(10)).unwrap();
    let stopped = simulation.statistics().agents[0].stopped.clone().unwrap();
    let expected =
        "`m` loops without a wait: A||B/2/B -> A||B/1/A, 10001 calls at 0.000000000 s; let an activity ";
    assert!(stopped.starts_with(expected), "{stopped}");
}

#[test]
fn an_ongoing_activity_whose_state_is_left_is_stopped() {
    let text = "Liveness:\nm = in . B\nin = A~\nTransitions:\nin -> B : [ball.found]\nA -> A : [false]";
    let called = patient(100, 30, false, text, 100);
    assert_eq!(called, ["call 0 None", "call 30 None", "stop 35", "B 35"]);
}

#[test]
fn an_ongoing_activity_publishes_after_each_call() {
    let (seen, note) = recorder();
    let mut count = 0.0;
    let publishes = move |b: &mut Blackboard| -> Result<Progress, BoxError> {
        count += 1.0;
        b.publish(BALL, Ball { x: count, ..Ball::default() })?;
        Ok(if count > 2.0 { Progress::Done } else { Progress::after(Duration::from_millis(100)) })
    };
    let registry = Registry::empty().with("A", move || publishes);
    let reads = move |b: &mut Blackboard| note(b.read(BALL).map(|ball| ball.x));
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart("m = A")));
    talws.agent(Agent::new("z", Hz(10)).activity(reads)).simulate(1).unwrap().run_until(at(350)).unwrap();
    assert_eq!(seen.taken(), [Some(1.0), Some(2.0), Some(3.0), Some(3.0)]);
}

#[test]
fn each_state_has_an_instance_of_its_own() {
    let (calls, note) = recorder();
    let registry = Registry::empty().with("A", move || {
        let note = note.clone();
        let mut count = 0;
        move |_: &mut Blackboard| {
            count += 1;
            note(count);
        }
    });
    simulate(registry, "m = A . A . A").run_until(at(10)).unwrap();
    assert_eq!(calls.taken(), [1, 1, 1]);
}

#[test]
fn activities_and_tools_raise_events() {
    let (calls, noting) = noting();
    let registry = noting.with("Raise", || |b: &mut Blackboard| b.raise("go"));
    let text = "Liveness:\nm = (Raise . D) || (A . B . C)\nTransitions:\nA -> B : go\nB -> C : now";
    let mut simulation = simulate(registry, text);
    simulation.run_until(at(10)).unwrap();
    assert_eq!(calls.taken(), ["A 0", "D 0", "B 0"]);
    assert!(!simulation.raise("local", "m", "never"));
    assert!(simulation.raise("local", "m", "now"));
    simulation.run_until(at(20)).unwrap();
    assert_eq!(calls.taken(), ["C 10"]);
}

#[test]
fn a_loop_without_a_wait_stops_its_chart_and_no_other() {
    let (calls, registry) = noting();
    let text = "m = B~";
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart(text)));
    let mut simulation = talws.agent(balls(&[10])).simulate(1).unwrap();
    simulation.run_until(at(100)).unwrap();
    let statistics = simulation.statistics();
    let reason = statistics.agents[0].stopped.clone().unwrap();
    assert!(
        reason.starts_with("`m` loops without a wait: B, 1000 calls at 0.000000000 s; let an "),
        "{reason}"
    );
    assert_eq!(statistics.agents[1].cycles, 100);
    assert!(!calls.taken().is_empty());
}

#[test]
fn a_frequency_is_one_more_waker() {
    let (_, registry) = noting();
    let agent =
        Agent::statechart("m", chart("Liveness:\nm = A . B\nTransitions:\nA -> B : [false]")).every(Hz(10));
    let mut simulation = Talws::new().registry(registry).agent(agent).simulate(1).unwrap();
    simulation.run_until(at(1000)).unwrap();
    // Entering and completing A take two steps at 0 ms, of which the first is the first tick's.
    assert_eq!(simulation.statistics().cycles(), 2 + 9);
}

#[test]
fn coverage_names_what_was_never_used() {
    let (_, registry) = noting();
    let text = "Liveness:\nm = A . (B | C) . D\nTransitions:\nCONDITION -> B : [ball.x > 5]\nCONDITION -> C : [true]\n(B|C) -> D : [false]";
    let mut simulation = simulate(registry, text);
    simulation.run_until(at(10)).unwrap();
    let coverage = &simulation.coverage()[0];
    assert_eq!(
        (coverage.host.as_str(), coverage.agent.as_str(), coverage.model.as_str()),
        ("local", "m", "m")
    );
    let missed: Vec<&str> = coverage.states_missed().collect();
    assert_eq!(missed, ["D", "(B|C)/B"]);
    assert!(coverage.transitions_missed().all(|name| !name.ends_with("-> C")), "{coverage:?}");
}

#[test]
fn the_trace_of_a_chart_is_printed_line_by_line() {
    let lines = Arc::new(Mutex::new(Vec::new()));
    let written = lines.clone();
    let (_, registry) = noting();
    let mut talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart("m = A . B")));
    talws.listen(Box::new(move |step: MicroStep<'_>| {
        written.lock().unwrap().push(format!(
            "{} {}: {}",
            step.host,
            step.agent,
            step.record.display(step.chart)
        ));
    }));
    talws.simulate(1).unwrap().run_until(at(10)).unwrap();
    let expected = [
        "local m: 0.000 s start; enter m, START",
        "local m: 0.000 s -: START -> A; exit START; enter A",
        "local m: 0.000 s -: A -> B; exit A; enter B",
        "local m: 0.000 s -: B -> END; exit B; enter END",
    ];
    assert_eq!(*lines.lock().unwrap(), expected);
}

#[test]
fn charts_are_bound_before_the_start_and_all_errors_are_reported() {
    let (calls, registry) = noting();
    let wrong = |text: &str| Agent::statechart(text.split(' ').next().unwrap(), chart(text));
    let talws = Talws::new().registry(registry).agent(wrong("m = A . Bx")).agent(wrong("n = Ax . B"));
    let error = talws.simulate(1).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Invalid);
    let findings: Vec<String> = error.diagnostics().iter().map(ToString::to_string).collect();
    let expected = [
        "error[E0318]: no activity `Bx` is registered for the state `m/Bx` (did you mean `B`?)",
        "error[E0318]: no activity `Ax` is registered for the state `n/Ax` (did you mean `A`?)",
    ];
    assert_eq!(findings, expected);
    assert!(calls.taken().is_empty());
}

#[test]
fn an_unreachable_source_is_reported_before_the_start() {
    let reads = |guard: &str| {
        let (_, registry) = noting();
        let text = format!("Liveness:\nm = A . B\nTransitions:\nA -> B : [{guard}]");
        let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart(&text)));
        let started = talws.agent(balls(&[10])).simulate(1);
        started.err().map(|error| error.diagnostics().iter().map(ToString::to_string).collect::<Vec<_>>())
    };
    let other_host = "error[E0320]: the chart `m` reads `test/ball` of the host `striker`, whose messages do not reach \
                      `local` (add a link: `<receive topics=\"test/ball\"/>`, or remove the host to read the chart's own messages)";
    assert_eq!(reads("striker.ball.State.Ball.x > 0").unwrap(), [other_host]);
    let unknown = "error[E0321]: the chart `m` reads `test/game` of `Vision`, but `local` has no publisher of that name \
                  (agents publish under their own names: `m`, `z`)";
    assert_eq!(reads("Vision.Game.phase == PLAY").unwrap(), [unknown]);
    assert_eq!(reads("z.Game.phase == PLAY"), None);
    assert_eq!(reads("ball.x > 0"), None);
}

#[test]
fn a_changed_constant_in_a_guard_changes_the_hash() {
    let run = |limit: &str| {
        let (_, registry) = noting();
        let hash = RunHash::new();
        let text = format!("Liveness:\nm = A . B\nTransitions:\nA -> B : [ball.x > {limit}]");
        let mut talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart(&text)));
        talws.observe(Box::new(hash.clone()));
        talws.agent(balls(&[10, 20])).simulate(1).unwrap().run_until(at(100)).unwrap();
        hash.finish()
    };
    assert_eq!(run("0.005"), run("0.005"));
    assert_ne!(run("0.005").0, run("0.015").0);
}

#[test]
fn an_entered_region_copies_the_outer_values_once() {
    let (seen, note) = recorder();
    let reading = |name: &'static str| {
        let note = note.clone();
        move || {
            let note = note.clone();
            move |b: &mut Blackboard| note(format!("{name} {:?}", b.read(BALL).map(|ball| ball.x)))
        }
    };
    let registry = Registry::empty().with("A", reading("A")).with("B", reading("B")).with("C", reading("C"));
    // B's loop writes; C, in another region, sees it from its next step on.
    let text = "Liveness:\nm = A . both\nboth = B~ || C~\nTransitions:\nA -> both : / ball.x = 3\n\
                B -> B : [ball.x == 3] / ball.x = 4\nC -> C : [ball.x == 4] / ball.x = 5";
    simulate(registry, text).run_until(at(10)).unwrap();
    assert_eq!(seen.taken(), ["A None", "B Some(3.0)", "C Some(3.0)", "B Some(4.0)", "C Some(5.0)"]);
}

#[test]
fn a_signal_is_seen_by_the_activity_that_its_step_starts() {
    let (seen, note) = recorder();
    let registry = Registry::empty().with("A", || |_: &mut Blackboard| {}).with("B", move || {
        let note = note.clone();
        move |b: &mut Blackboard| note((b.now(), b.signals(NEWS).count()))
    });
    let text = "Liveness:\nm = A . B~\nTransitions:\nA -> B~ : news\nB -> B : [t] / StartTimeout(t, 100ms)";
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart(text)));
    talws.agent(balls(&[10])).simulate(1).unwrap().run_until(at(100)).unwrap();
    assert_eq!(seen.taken()[0], (at(10), 1));
}

#[test]
fn the_records_name_what_happens() {
    let records = Arc::new(Mutex::new(Vec::new()));
    let written = records.clone();
    let (_, registry) = noting();
    let text = "Liveness:\nm = A . B\nTransitions:\nA -> B : news [ball.x > 0]";
    let mut talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart(text)));
    talws.observe(Box::new(move |publication: narukom::Publication<'_>| {
        if publication.publisher != "z" && publication.topic.path().starts_with("monas/") {
            written.lock().unwrap().push(format!(
                "{} {:?}",
                publication.topic.path(),
                publication.sample.message
            ));
        }
    }));
    let mut simulation = talws.agent(balls(&[10])).simulate(1).unwrap();
    simulation.run_until(at(100)).unwrap();
    let (ball, news) = (narukom::topic_hash("test/ball"), narukom::topic_hash("test/news"));
    let records = records.lock().unwrap();
    assert_eq!(records[0], "monas/host Host { name: \"local\", team: 0, number: 0 }");
    assert_eq!(
        records[1],
        "monas/model Model { chart: 0, name: \"m\", nodes: [\"m\", \"m/START\", \"m/A\", \"m/B\", \"m/END\"], \
         transitions: [\"START -> A\", \"A -> B\", \"B -> END\"], events: [\"error.guard\", \"error.action\", \
         \"error.activity\", \"?\", \"test/news\"] }"
    );
    let fired = records.iter().find(|record| record.contains("selected: [1]")).unwrap();
    assert_eq!(
        fired,
        "monas/chart Chart { chart: 0, time: 10000000, event: 5, selected: [1], preempted: [], held: [], deferred: 0, \
         exits: [2], entries: [3], taken: [] }"
    );
    let cycle =
        records.iter().find(|record| record.starts_with("monas/cycle") && record.contains("time: 10000000"));
    let delivery =
        |topic| format!("Delivery {{ topic: {topic}, sequence: 1, region: 0, host: \"\", publisher: \"\" }}");
    let expected = format!(
        "monas/cycle Cycle {{ number: 3, time: 10000000, delivered: [{}, {}], seen: [], turn: None, chart: 0, news: [], \
         returned: [], first_tick: 0, due: 0, asked: None, violations: [] }}",
        delivery(ball),
        delivery(news)
    );
    assert_eq!(cycle.unwrap(), &expected);
}

/// Fails a number of times, then succeeds.
fn failing(times: u32, policy: FailurePolicy) -> (Vec<String>, Option<String>) {
    let (calls, note) = recorder();
    let registry = Registry::empty()
        .with("A", {
            let note = note.clone();
            move || {
                let note = note.clone();
                let mut count = 0;
                move |b: &mut Blackboard| {
                    note(format!("A {}", b.now().as_nanos() / 1_000_000));
                    count += 1;
                    if count <= times { Err("broken") } else { Ok(()) }
                }
            }
        })
        .with("B", move || {
            let note = note.clone();
            move |b: &mut Blackboard| note(format!("B {}", b.now().as_nanos() / 1_000_000))
        });
    let agent = Agent::statechart("m", chart("m = A . B")).on_failure(policy);
    let mut simulation = Talws::new().registry(registry).agent(agent).simulate(1).unwrap();
    simulation.run_until(at(1000)).unwrap();
    (calls.taken(), simulation.statistics().agents[0].stopped.clone())
}

#[test]
fn an_activity_that_fails_is_restarted_after_pauses_that_double() {
    let (calls, stopped) = failing(3, FailurePolicy::Restart);
    assert_eq!(calls, ["A 0", "A 10", "A 30", "A 70", "B 70"]);
    assert_eq!(stopped, None);
}

#[test]
fn an_activity_that_fails_may_leave_its_state_incomplete_or_stop_its_agent() {
    assert_eq!(failing(1, FailurePolicy::Skip), (vec!["A 0".into()], None));
    let (calls, stopped) = failing(1, FailurePolicy::StopAgent);
    assert_eq!(calls, ["A 0"]);
    assert_eq!(stopped.as_deref(), Some("activity `A` failed in cycle 1: broken"));
}

#[test]
fn a_failure_is_an_event_of_the_chart() {
    let (calls, registry) = noting();
    let registry = registry.with("Fail", || |_: &mut Blackboard| -> () { panic!("ouch") });
    let text = "Liveness:\nm = Fail . A\nTransitions:\nFail -> A : error.activity";
    let agent = Agent::statechart("m", chart(text)).on_failure(FailurePolicy::Skip);
    let mut simulation = Talws::new().registry(registry).agent(agent).simulate(1).unwrap();
    simulation.run_until(at(100)).unwrap();
    assert_eq!(calls.taken(), ["A 0"]);
    let failures: Vec<u64> =
        simulation.statistics().agents[0].activities.iter().map(|a| a.failures).collect();
    assert_eq!(failures, [1, 0]);
}
