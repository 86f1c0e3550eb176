//! Changes in real time. The tests wait for events, never for time to pass.

use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Barrier};
use std::time::Duration;

use monas::records::{Action, CHANGE, Change};
use monas::{
    Agent, Blackboard, Certificates, FailurePolicy, HostConfig, Hz, LinkConfig, LinkTransport, Progress,
    Registry, RunHandle, Talws, ZenohEndpoints,
};
use monas_link::{AccessList, LinkSettings, PublishAs, ReceiveRule};
use yase::Source;

use crate::management::{change, made, refused, reporting, settings};

const TIMEOUT: Duration = Duration::from_secs(20);

fn ask(run: &RunHandle, change: Change) -> monas::records::Changed {
    run.change("local", change).unwrap()
}

/// Waits for the next note that is one of these words.
fn until(notes: &Receiver<String>, word: &str) {
    while notes.recv_timeout(TIMEOUT).unwrap() != word {}
}

#[test]
fn lists_are_changed_while_they_run() {
    let (sender, notes) = channel();
    let registry = reporting(&["A", "B"], move |word| _ = sender.send(word));
    let text = "<agent frequency='1000'><name>a</name><activity>A</activity></agent>";
    let (setup, _) = monas::config::read(&Source::new("a.xml", text), "a.xml".as_ref(), &registry);
    let running = Talws::new().registry(registry).setup(setup).start().unwrap();
    let run = running.run_handle();
    until(&notes, "A");
    made(&ask(&run, Change { activity: "B".into(), place: 1, ..change(Action::AddActivity, "a") }));
    until(&notes, "B");
    made(&ask(&run, Change { activity: "B".into(), ..change(Action::RemoveActivity, "a") }));
    until(&notes, "B stop");
    made(&ask(
        &run,
        Change { settings: settings(&[("frequency", "500"), ("A.speed", "2")]), ..change(Action::Set, "a") },
    ));
    until(&notes, "A 2");
    made(&ask(&run, change(Action::PauseAgent, "a")));
    let paused = run.agents(None).unwrap();
    assert_eq!((paused[0].state.as_str(), paused[0].frequency), ("pauses", 500.0));
    let cycles = paused[0].cycles;
    let stepped = ask(&run, change(Action::StepAgent, "a"));
    assert_eq!((stepped.done, stepped.cycle), (true, cycles + 1));
    made(&ask(&run, change(Action::ResumeAgent, "a")));
    until(&notes, "A");
    made(&ask(&run, change(Action::StopAgent, "a")));
    until(&notes, "A stop");
    made(&ask(&run, change(Action::StartAgent, "a")));
    until(&notes, "A start");
    made(&ask(&run, Change { activity: "A".into(), ..change(Action::RemoveActivity, "a") }));
    until(&notes, "A stop");
    made(&ask(&run, Change { activity: "B".into(), ..change(Action::AddActivity, "a") }));
    until(&notes, "B");
    made(&ask(&run, Change { activity: "A".into(), ..change(Action::AddActivity, "a") }));
    until(&notes, "A");
    made(&ask(&run, Change { activity: "B".into(), ..change(Action::RemoveActivity, "a") }));
    until(&notes, "B stop");
    let text = "<agent frequency='1000'><name>b</name><activity>B</activity></agent>";
    made(&ask(&run, Change { text: text.into(), ..change(Action::AddAgents, "") }));
    until(&notes, "B");
    made(&ask(&run, change(Action::RemoveAgent, "b")));
    until(&notes, "B stop");
    assert_eq!(refused(&ask(&run, change(Action::StopAgent, "b"))).0, "E0351");
    assert_eq!(run.agents(None).unwrap().len(), 1);
    let statistics = running.stop();
    assert!(statistics.calls("local", "B") > 0, "what a removed agent has done is not forgotten");
    assert_eq!(run.change("local", change(Action::StopAgent, "a")).unwrap_err(), "the run has ended");
}

#[test]
fn charts_stop_start_and_take_another_model_while_they_run() {
    let (sender, notes) = channel();
    let note = move |word: String| _ = sender.send(word);
    let registry = reporting(&["A"], note.clone()).with("B", move || {
        let note = note.clone();
        move |_: &mut Blackboard| {
            note("B".into());
            Progress::after(Duration::from_millis(1))
        }
    });
    let chart = aseme_models::statechart_of(&Source::new("m.srm", "m = A . B")).0;
    let running = Talws::new().registry(registry).agent(Agent::statechart("m", chart)).start().unwrap();
    let run = running.run_handle();
    until(&notes, "B");
    let text = "m = A . (B | A)".to_owned();
    made(&ask(&run, Change { file: "new.srm".into(), text, ..change(Action::SwapModel, "m") }));
    until(&notes, "B");
    assert_eq!(run.agents(None).unwrap()[0].charts[0].model, "new.srm");
    made(&ask(&run, change(Action::StopAgent, "m")));
    made(&ask(&run, change(Action::StartAgent, "m")));
    until(&notes, "A start");
    until(&notes, "B");
    let wrong = Change { file: "new.srm".into(), text: "m = A".into(), ..change(Action::SwapModel, "m") };
    let refusal = ask(&run, wrong);
    assert_eq!((refusal.done, refusal.findings[0].code.as_str()), (false, "E0356"));
    until(&notes, "B");
    assert_eq!(running.stop().agents[0].stopped, None);
}

#[test]
fn a_stuck_agent_blocks_no_other_and_keeps_its_list() {
    let (hangs, others) = (Arc::new(Barrier::new(2)), Arc::new(Barrier::new(2)));
    let (enter, leave) = (hangs.clone(), others.clone());
    let mut calls = 0;
    let stuck = move |_: &mut Blackboard| {
        calls += 1;
        if calls == 1 {
            enter.wait();
            leave.wait();
        }
    };
    let registry = Registry::empty().with("A", || |_: &mut Blackboard| {});
    let talws = Talws::new().registry(registry).agent(Agent::new("a", Hz(1000)).activity(stuck));
    let running = talws.agent(Agent::new("b", Hz(1000)).activity(|_: &mut Blackboard| {})).start().unwrap();
    hangs.wait();
    let run = running.run_handle();
    let changed = ask(&run, Change { activity: "A".into(), ..change(Action::AddActivity, "a") });
    let reason = "`a` is in a cycle that does not end".to_owned();
    assert_eq!(refused(&changed), ("E0356".into(), reason));
    made(&ask(&run, change(Action::PauseAgent, "b")));
    others.wait();
    made(&ask(&run, Change { activity: "A".into(), ..change(Action::AddActivity, "a") }));
    let entry = &run.agents(None).unwrap()[0];
    let names: Vec<&str> = entry.activities.iter().map(|activity| activity.name.as_str()).collect();
    assert_eq!(names, ["closure", "A"], "the first change was not made late");
    running.stop();
}

#[test]
fn a_run_ends_when_its_last_agent_has_stopped_by_itself() {
    let fails = |_: &mut Blackboard| -> Result<(), std::num::ParseIntError> { "x".parse::<u8>().map(drop) };
    let a = Agent::new("a", Hz(1000)).activity(fails).on_failure(FailurePolicy::StopAgent);
    let chart = aseme_models::statechart_of(&Source::new("m.srm", "m = A")).0;
    let registry = Registry::empty().with("A", || |_: &mut Blackboard| {});
    let b = Agent::statechart("b", chart);
    let statistics = Talws::new().registry(registry).agent(a).agent(b).run().unwrap();
    let stopped = statistics.agents[0].stopped.as_deref().unwrap();
    assert!(stopped.starts_with("activity `closure` failed in cycle 1: invalid digit"), "{stopped}");
    assert_eq!(statistics.calls("local", "A"), 1);
}

#[test]
fn a_link_that_permits_changes_is_rejected() {
    let named = |name: &str, transport: LinkTransport, access: &str, topics: &str| {
        let access = if access.is_empty() { AccessList::open() } else { AccessList::parse(access).0 };
        let rule = ReceiveRule { topics: topics.into(), publish_as: PublishAs::Own };
        let settings =
            LinkSettings { access, receive: vec![rule], name: name.into(), ..LinkSettings::default() };
        let link = LinkConfig { settings, transport, clock: None };
        let mut talws = Talws::new();
        talws.host(HostConfig { name: "local".into(), links: vec![link], ..HostConfig::default() });
        talws.check().first().map(|one| one.message.clone())
    };
    let over = |transport: LinkTransport, access: &str, topics: &str| named("", transport, access, topics);
    let warning = |access: &str, topics: &str| over(LinkTransport::default(), access, topics);
    assert_eq!(warning("", "monas/*").unwrap(), "a link of `local` lets any peer change its agents");
    let unnamed_host = warning("laptop publish **", CHANGE.path()).unwrap();
    assert!(
        unnamed_host.contains("lets `laptop` publish changes of its agents without the right to manage them"),
        "{unnamed_host}"
    );
    assert_eq!(warning("laptop publish **\nlaptop manage", CHANGE.path()), None);
    assert_eq!(warning("", "test/ball"), None);
    // The entry of the host itself admits no peer: the host accepts nothing under its own name.
    assert_eq!(warning("local publish **\nlaptop publish **\nlaptop manage", CHANGE.path()), None);
    let other = warning("local publish **\nlaptop publish **", CHANGE.path()).unwrap();
    assert!(other.contains("lets `laptop` publish changes"), "{other}");
    let all_hosts = warning("local publish **\n* publish monas/*", CHANGE.path()).unwrap();
    assert!(all_hosts.contains("lets `*` publish changes"), "{all_hosts}");
    // A link with another name than its host takes what comes under the host's.
    let vision =
        named("vision", LinkTransport::default(), "local publish **\nvision publish **", CHANGE.path());
    assert!(vision.is_some_and(|warning| warning.contains("lets `local` publish changes")));
    // Over a network any peer may use a name that is not authenticated by a certificate.
    let manager = "laptop publish **\nlaptop manage";
    let file = || "a.pem".into();
    let shown = Certificates { authority: file(), certificate: file(), key: file() };
    let zenoh =
        |certificates| LinkTransport::Zenoh(ZenohEndpoints { certificates, ..ZenohEndpoints::default() });
    let nameless = over(zenoh(None), manager, CHANGE.path()).unwrap();
    assert!(nameless.contains("lets any peer change its agents under the name"), "{nameless}");
    assert_eq!(over(zenoh(Some(shown)), manager, CHANGE.path()), None);
}

#[test]
fn a_model_is_exchanged_at_any_time_of_a_call() {
    let (sender, notes) = channel();
    let registry = Registry::empty().with("A", move || {
        let sender = sender.clone();
        move |_: &mut Blackboard| _ = sender.send("A".to_owned())
    });
    let chart = aseme_models::statechart_of(&Source::new("m.srm", "m = A . A~")).0;
    let running = Talws::new().registry(registry).agent(Agent::statechart("m", chart)).start().unwrap();
    let run = running.run_handle();
    until(&notes, "A");
    until(&notes, "A");
    for text in ["m = A . A . A~", "m = A . A~"].into_iter().cycle().take(200) {
        let swap = Change {
            file: "new.srm".into(),
            text: text.into(),
            accept_losses: true,
            ..change(Action::SwapModel, "m")
        };
        made(&ask(&run, swap));
        while notes.try_recv().is_ok() {}
        until(&notes, "A");
    }
    assert_eq!(running.stop().agents[0].stopped, None);
}
