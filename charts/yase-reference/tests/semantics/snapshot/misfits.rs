//! Snapshots that do not fit are refused, with everything that is wrong with them.

use yase::snapshot::{EventName, RestoreIssueKind, Snapshot, TimerName};
use yase::{Status, Timestamp};

use crate::snapshot::fixture::Stage;

const CHART: &str = "
    START
    & both
      one
        START
        A | run=work | for=20ms
        B
        both/one/START -> both/one/A
        both/one/A -> both/one/B {interrupts} : e
      two
        START
        C | defer=g
        D
        both/two/START -> both/two/C
        both/two/C -> both/two/D : v
        both/two/C -> both/two/D : w
    off
    START -> both : / StartTimeout(v, 1s), StartTimeout(w, 2s)
    both -> off : f
    off -> both : g
";

/// The issues of the running chart's snapshot after a change, one a line.
#[track_caller]
fn found(change: impl FnOnce(&mut Snapshot)) -> String {
    let stage = Stage::new(CHART, &["f", "g"]);
    let mut snapshot = stage.machine.snapshot();
    assert!(stage.restore(&snapshot).is_ok());
    change(&mut snapshot);
    let error = stage.restore(&snapshot).map(|_| ()).unwrap_err();
    error.issues().iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

#[test]
fn an_unknown_version() {
    assert_eq!(found(|snapshot| snapshot.version = 99), "version: the format is 99; 1 is understood");
}

#[test]
fn another_chart() {
    assert_eq!(found(|snapshot| snapshot.chart = "d".into()), "chart: it is of the chart `d`, this is `c`");
}

#[test]
fn another_semantics_but_for_the_bound() {
    let other = yase::TimerScope::State;
    let wrong = found(|snapshot| snapshot.semantics.timers = other);
    assert_eq!(wrong, "semantics: the chart has other semantics");
    let stage = Stage::new(CHART, &[]);
    let mut snapshot = stage.machine.snapshot();
    snapshot.semantics.limit = std::num::NonZeroU32::MIN;
    assert_eq!(stage.restore(&snapshot).unwrap().semantics(), stage.machine.semantics());
}

#[test]
fn nodes_that_the_chart_does_not_have_or_has_once() {
    assert_eq!(
        found(|snapshot| {
            snapshot.configuration.push("c/nowhere".into());
            snapshot.configuration.push("c/both".into());
        }),
        "configuration[6]: the chart has no node `c/nowhere`\nconfiguration[7]: `c/both` is there twice"
    );
}

#[test]
fn a_configuration_with_holes() {
    assert_eq!(
        found(|snapshot| snapshot.configuration.retain(|path| path != "c/both/two")),
        "configuration: `c/both/two/C` is active, but `c/both/two` around it is not\n\
         configuration: `c/both` is active, but its region `c/both/two` is not"
    );
    assert_eq!(
        found(|snapshot| snapshot.configuration.retain(|path| path != "c/both/two/C")),
        "configuration: `c/both/two` is active, but nothing in it"
    );
    assert_eq!(
        found(|snapshot| {
            snapshot.configuration.clear();
            snapshot.activities.clear();
            snapshot.held.clear();
        }),
        "configuration: the root is not active"
    );
}

#[test]
fn two_children_at_once() {
    assert_eq!(
        found(|snapshot| snapshot.configuration.push("c/both/two/D".into())),
        "configuration: in `c/both/two` one child is active, not `c/both/two/C`, `c/both/two/D`"
    );
}

#[test]
fn a_machine_that_was_not_started_has_nothing() {
    let found = found(|snapshot| snapshot.status = Status::Idle);
    let expected = [
        "configuration: a machine that has not been started has no active nodes",
        "deferred: the machine does not run, so there is nothing",
        "held: the machine does not run, so there is nothing",
        "activities: the machine does not run, so there is nothing",
    ];
    assert_eq!(found, expected.join("\n"));
}

#[test]
fn activities_of_others() {
    assert_eq!(
        found(|snapshot| snapshot.activities[0].activity = "rest".into()),
        "activities[0].activity: the activity of `c/both/one/A` is `work`, not `rest`"
    );
    assert_eq!(
        found(|snapshot| {
            snapshot.activities[0].state = "c/both/one/B".into();
            snapshot.held.clear();
        }),
        "activities[0].state: `c/both/one/B` has no activity\n\
         activities[0].state: `c/both/one/B` is not active\n\
         activities: `c/both/one/A` is active, and nothing is said of its activity"
    );
    assert_eq!(
        found(|snapshot| snapshot.activities[0].number = 7),
        "activities[0].number: 7 is not from 1 to 1"
    );
}

#[test]
fn timers_of_no_name_or_with_expiries_that_cannot_be() {
    assert_eq!(
        found(|snapshot| snapshot.timers[0].timer.name = "x".into()),
        "timers[0].timer: the chart has no timer `x` of `c`"
    );
    assert_eq!(
        found(|snapshot| snapshot.timers[1] = snapshot.timers[0].clone()),
        "timers[1].timer: `v` of `c` is there twice"
    );
    assert_eq!(
        found(|snapshot| {
            let mut expiry = snapshot.deferred.remove(0);
            expiry.event = EventName::Name("v".into());
            expiry.expiry = Some(TimerName { region: "c".into(), name: "v".into() });
            snapshot.arrived.push(expiry);
        }),
        "timers: an expiry of `v` waits, but that timer is not set, has not expired or is no such event"
    );
}

#[test]
fn events_of_no_name_out_of_order_or_twice() {
    assert_eq!(
        found(|snapshot| snapshot.deferred[0].event = EventName::Name("x".into())),
        "deferred[0].event: the chart has no event `x`"
    );
    assert_eq!(
        found(|snapshot| snapshot.deferred[0].event = EventName::Message("a".into())),
        "deferred[0].event: the chart has no message event `a`"
    );
    assert_eq!(
        found(|snapshot| snapshot.deferred[0].number = 9),
        "deferred: the number 9 is not from 1 to 2"
    );
    assert_eq!(
        found(|snapshot| {
            let mut one = snapshot.deferred[0].clone();
            one.raised = true;
            snapshot.arrived = vec![one];
        }),
        "deferred: the number 2 is that of another event\narrived: `raised` is false for all of these events"
    );
    assert_eq!(
        found(|snapshot| {
            let (mut one, mut other) = (snapshot.deferred[0].clone(), snapshot.deferred[0].clone());
            (one.number, other.number, snapshot.occurrences) = (9, 8, 9);
            snapshot.arrived = vec![one, other];
        }),
        "arrived: older events, of lesser number, come first"
    );
}

#[test]
fn transitions_of_no_name_and_events_that_wait_for_nothing() {
    assert_eq!(
        found(|snapshot| snapshot.held[0].ways[0] = vec!["c/both -> c/nowhere".into()]),
        "held[0].ways[0]: the chart has no compound transition `c/both -> c/nowhere`\n\
         held[0]: nothing that it waits for runs, and it is not offered"
    );
    assert_eq!(
        found(|snapshot| snapshot.activities[0].phase = yase::snapshot::ActivityPhase::Done),
        "held[0]: nothing that it waits for runs, and it is not offered"
    );
}

#[test]
fn pending_transitions_that_do_not_interrupt() {
    let pending = |way: &str| {
        let way = vec![way.to_owned()];
        move |snapshot: &mut Snapshot| {
            let text = serde_json::json!({ "way": way, "event": null });
            snapshot.pending.push(serde_json::from_value(text).unwrap());
        }
    };
    assert_eq!(found(pending("c/both -> c/off")), "pending[0]: the transition does not interrupt");
    assert_eq!(
        found(|snapshot| {
            snapshot.held.clear();
            snapshot.activities.clear();
            snapshot.configuration = vec!["c".into(), "c/off".into()];
            pending("c/both/one/A -> c/both/one/B")(snapshot);
        }),
        "pending[0]: its source `c/both/one/A` is not active"
    );
}

#[test]
fn notes_on_what_is_not_there() {
    assert_eq!(
        found(|snapshot| snapshot.waiting_starts.push("c/both/one/START".into())),
        "waiting_starts: `c/both/one/START` is not an active START"
    );
    assert_eq!(
        found(|snapshot| snapshot.written.push("c/both/one/A".into())),
        "written[0]: the chart has no region `c/both/one/A`"
    );
    assert_eq!(
        found(|snapshot| snapshot.bound.recent.push(vec![])),
        "bound.recent[3]: the chart has no compound transition ``"
    );
    assert_eq!(
        found(|snapshot| {
            let text = serde_json::json!({ "segment": "c/both -> c/off", "region": "c", "stale": false });
            snapshot.erred_guards.push(serde_json::from_value(text).unwrap());
        }),
        "erred_guards[0]: `c/both -> c/off` has no guard on `c`"
    );
}

#[test]
fn regions_to_be_entered_that_are_none_or_active() {
    assert_eq!(
        found(|snapshot| {
            snapshot.to_enter = vec!["c/both/one".into(), "c/off".into()];
            snapshot.to_inherit = vec!["c/both/two".into(), "c/both/two".into()];
        }),
        "to_inherit[1]: `c/both/two` is there twice\n\
         to_enter: `c/both/one` is active already\n\
         to_enter: `c/off` is not a region"
    );
}

#[test]
fn kinds_and_fields_say_what_is_wrong() {
    let stage = Stage::new(CHART, &[]);
    let mut snapshot = stage.machine.snapshot();
    snapshot.version = 2;
    snapshot.now = Timestamp::from_millis(5);
    snapshot.configuration.push("c/x".into());
    let error = stage.restore(&snapshot).map(|_| ()).unwrap_err();
    let kinds: Vec<_> = error.issues().iter().map(|misfit| (misfit.kind(), misfit.field())).collect();
    assert_eq!(
        kinds,
        [(RestoreIssueKind::Version, "version"), (RestoreIssueKind::Unknown, "configuration[6]")]
    );
    assert!(error.to_string().starts_with("the snapshot does not fit\n  version: "));
}

#[test]
fn text_with_a_field_that_is_not_known_or_without_one_is_no_snapshot() {
    let text = serde_json::to_string(&Stage::new(CHART, &[]).machine.snapshot()).unwrap();
    assert!(serde_json::from_str::<Snapshot>(&text).is_ok());
    let more = text.replacen('{', "{\"more\":1,", 1);
    assert!(
        serde_json::from_str::<Snapshot>(&more).unwrap_err().to_string().contains("unknown field `more`")
    );
    let less = text.replacen("\"due\":false,", "", 1);
    assert!(serde_json::from_str::<Snapshot>(&less).unwrap_err().to_string().contains("missing field `due`"));
}
