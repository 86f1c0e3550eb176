//! Scenarios of a small chart that reads and writes the records that hosts publish of themselves.

use aseme_verify::scenario::ScenarioText;
use yase::Source;

use super::*;

const ROLE: &str = "Role: r
Liveness:
r = seek || keep
seek = (Look . (Near | Far)) ~
keep = Stand ~
Constants:
close = 3
Transitions:
CONDITION -> Near : [host.team <= close]
CONDITION -> Far : [host.team > close] / host.team = 7
(Look.(Near|Far)) -> (Look.(Near|Far)) : [again] / StartTimeout(again, 100ms)
Stand -> Stand interrupts : alarm
*~ -> END : [false]
*||* -> END : [false]
";

fn differences(scenario: &str) -> Vec<String> {
    differences_in(ROLE, scenario)
}

fn differences_in(role: &str, scenario: &str) -> Vec<String> {
    let player = ScenarioRunner::new(&Registry::linked()).unwrap();
    let (chart, found) = aseme_models::statechart_of(&Source::new("r.srm", role));
    assert_eq!(found, []);
    let chart = player.compile(&chart).unwrap();
    let (script, found) = ScenarioText::parse(&Source::new("a.scenario", format!("model r.srm\n{scenario}")));
    assert_eq!(found, []);
    let steps = script.bind(&chart, player.vocabulary()).unwrap();
    let all = player.play(&chart, &steps, |_| {}).unwrap();
    assert_eq!(player.first_difference(&chart, &steps).unwrap().as_ref(), all.first());
    all.iter().map(|it| format!("{}: {it}", it.passage.line())).collect()
}

#[test]
fn a_chart_does_what_is_expected() {
    let scenario = "start
  starts Look, Stand
  host.team = close
return Look
  in Near, Stand
  not in Far
  starts Near
  publishes nothing
return Near
  starts Look
  timer again: 100ms
wait 30ms
  timer again: 70ms
return Look
  host.team = close + 1
  starts Far
  publishes host
  [host.team == 7]
return Far
  starts nothing
timer again
  starts Look
";
    assert_eq!(differences(scenario), Vec::<String>::new());
}

#[test]
fn differences_are_reported_line_by_line() {
    let scenario = "start
  starts Look
  in Near
return Look
  host.team = 9
  publishes nothing
  [host.team == 9]
  timer again: over
";
    assert_eq!(
        differences(scenario),
        [
            "3: expected `starts Look`, but started are: Look, Stand",
            "4: expected `in Near`, but active are: Look, Stand",
            "7: expected `publishes nothing`, but published are: monas/host",
            "8: expected `[host.team == 9]`, but it does not hold for the newest messages",
            "9: expected `timer again: over`, but it is not set",
        ]
    );
}

#[test]
fn an_impossible_step_ends_the_scenario() {
    let missing = differences("start\nreturn Near\n  in Far\nwait 1s\n  in Far\n");
    assert_eq!(missing.len(), 1, "{missing:?}");
    assert!(
        missing[0].starts_with("3: expected the activity to run, but it does not; active are: "),
        "{missing:?}"
    );
    assert_eq!(differences("start\ntimer again\n"), ["3: expected the timer to run, but it is not set"]);
    let unknown = differences("start\n  host.team = host.number + 1\n");
    assert_eq!(
        unknown,
        ["3: expected a message to arrive, but the value depends on a message that has not arrived"]
    );
}

#[test]
fn an_ongoing_activity_is_called_again_and_a_failed_one_is_incomplete() {
    let scenario = "start
ongoing Look
  in Look
  starts nothing
wait 1s
  in Look
  starts nothing
return Look
  host.team = 1
  starts Near
fail Near
  in Near
  starts nothing
event alarm
  starts nothing
return Stand
  starts Stand
";
    assert_eq!(differences(scenario), Vec::<String>::new());
}

#[test]
fn a_livelock_is_a_difference() {
    let player = ScenarioRunner::new(&Registry::linked()).unwrap();
    let (mut chart, _) = aseme_models::statechart_of(&Source::new("r.srm", "Liveness:\nr = A ~\n"));
    let state = chart.find("A").unwrap();
    chart.node_mut(state).activity = None;
    let chart = player.compile(&chart).unwrap();
    let (script, _) = ScenarioText::parse(&Source::new("a.scenario", "model r.srm\nstart\n"));
    let steps = script.bind(&chart, player.vocabulary()).unwrap();
    let found = player.first_difference(&chart, &steps).unwrap().expect("it is in a livelock");
    assert_eq!(found.expected, "the chart to become stable");
}

const WAITING: &str = "Role: r
Liveness:
r = (Wait . Listen . Act) ~
Transitions:
Wait -> Listen : host.State.Host
Listen -> Act : mate.host.State.Host
";

#[test]
fn a_message_is_an_event_with_the_spelling_of_triggers() {
    let scenario = "start
return Wait
  in Wait
event host.State.Host
  host.team = 4
  in Listen
  [host.team == 4]
return Listen
event host.State.Host
  in Listen
event mate.host.State.Host
  in Act
";
    assert_eq!(differences_in(WAITING, scenario), [""; 0]);
}

#[test]
fn a_misspelt_message_is_corrected_with_the_spelling_of_triggers() {
    let player = ScenarioRunner::new(&Registry::linked()).unwrap();
    let chart = aseme_models::statechart_of(&Source::new("r.srm", WAITING)).0;
    let chart = player.compile(&chart).unwrap();
    let text = "model r.srm\nstart\nevent host.State.Hots\nevent mat.host.State.Host\n";
    let (script, _) = ScenarioText::parse(&Source::new("a.scenario", text));
    let wrong = script.bind(&chart, player.vocabulary()).unwrap_err();
    let wrong: Vec<String> = wrong.iter().map(ToString::to_string).collect();
    assert_eq!(
        wrong,
        [
            "a.scenario:3:7: error[E0846]: the chart `r` has no event `host.State.Hots` (did you mean `host.State.Host`?)",
            "a.scenario:4:7: error[E0846]: the chart `r` has no event `mat.host.State.Host` (did you mean `mate.host.State.Host`?)",
        ]
    );
}
