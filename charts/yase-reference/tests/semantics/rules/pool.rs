//! R24: information of the machine about its activities for their executor.

use std::time::Duration;

use yase::TypeEnvironment;
use yase::statechart::{Node, NodeKind, Statechart, Transition};

use crate::rules::check;
use yase_reference::{chart, script};

#[test]
fn r24_activities_start_in_the_order_of_their_regions() {
    check(
        "
        START
        & both
          one
            START
            & inner
              three
                START
                C | run | for=1ms
              four
                START
                D | run | for=1ms
          two
            START
            B | run | for=1ms
        c/START -> both
        one/START -> inner : [A.n > 0]
        two/START -> B : [A.n > 0]
        three/START -> C
        four/START -> D
        ",
        "1 A=1; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        waits at both/one/START
        waits at both/two/START
        0.001 s -: both/one/START -> both/one/inner, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/inner, both/one/inner/three, both/one/inner/three/START, both/one/inner/four, both/one/inner/four/START, both/two/B
        0.001 s -: both/one/inner/three/START -> both/one/inner/three/C, both/one/inner/four/START -> both/one/inner/four/D; exit both/one/inner/three/START, both/one/inner/four/START; enter both/one/inner/three/C, both/one/inner/four/D
        start C
        start D
        start B
        C returns Done
        D returns Done
        B returns Done
        ",
    );
}

#[test]
fn r24_the_chart_knows_how_many_activities_can_be_active_at_once() {
    let count = |text: &str| script::compile(&chart(text)).max_activities();
    assert_eq!(count("START\nA\nc/START -> A"), 0);
    assert_eq!(count("START\nA | run\nB | run\nc/START -> A"), 1);
    let nested = "
        START
        & both
          one
            START
            A | run
            & inner
              three
                START
                B | run
              four
                START
                C | run
                D
          two
            START
            E | run
          five
            START
            F
        c/START -> both
        one/START -> A
        two/START -> E
        three/START -> B
        four/START -> C
        five/START -> F
        ";
    assert_eq!(count(nested), 3);
}

#[test]
fn r24_an_activity_has_the_priority_and_duration_of_its_state() {
    let mut chart = Statechart::new("c");
    let start = chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
    let work = Node {
        activity: Some("Dive".into()),
        priority: 5,
        duration: Some(Duration::from_millis(300)),
        ..Node::new(NodeKind::Basic, "RightDive")
    };
    let state = chart.add(Statechart::ROOT, work);
    chart.connect(Transition::new(start, state));
    let chart = chart.compile(&TypeEnvironment::default()).unwrap();
    let activity = chart.activity(state).unwrap();
    assert_eq!((activity.name, activity.priority, activity.node), ("Dive", 5, state));
    assert_eq!(activity.duration, Some(Duration::from_millis(300)));
    assert_eq!(activity.region, yase::ScopeId::ROOT);
    assert_eq!(chart.activities().collect::<Vec<_>>(), [activity]);
    assert_eq!(chart.activity(start), None);
}
