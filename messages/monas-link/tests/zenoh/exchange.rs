//! Messages published on one host are read on another.

use std::time::Duration;

use monas_link::example::{Ball, Command, Picture};
use monas_link::{LinkSettings, Reliability, SendRule, ZenohSettings};
use narukom::Timestamp;

use crate::{BALL, COMMAND, End, PICTURE, TRACK, await_that, everything, pair};

fn ball(distance: f64) -> Ball {
    Ball { distance, bearing: 0.0 }
}

#[test]
fn every_way_of_keeping_stays_what_it_is() {
    let (listening, connecting) = pair("tcp");
    let first = End::new("robot_1", &listening);
    first.say_ball(1.5);
    let mut coach = first.hub.publisher(COMMAND, "coach").unwrap();
    coach.publish(Command { text: "early".into() }, first.now());
    await_that("the sending", || first.sent("soccer/command").sent == 1);

    let second = End::new("robot_2", &connecting);
    await_that("the ball from before the connection", || second.ball_of("robot_1") == Some(1.5));
    await_that("the introduction", || first.knows("robot_2"));
    let mut reader = second.hub.blackboard("reader");
    let host = second.hub.host_id("robot_1").unwrap();
    reader.process_messages(second.now());
    assert_eq!(reader.from(host).signals(COMMAND).count(), 0, "earlier signals are not delivered");
    assert_eq!(reader.from(host).read(TRACK), None);

    let mut track = first.hub.publisher(TRACK, "vision").unwrap();
    (0..20).for_each(|number| track.publish(ball(f64::from(number)), first.now()));
    (0..50).for_each(|number| coach.publish(Command { text: format!("kick {number}") }, first.now()));
    let mut texts = Vec::new();
    await_that("all commands", || {
        reader.process_messages(second.now());
        texts.extend(reader.from(host).signals(COMMAND).map(|command| command.message.text.clone()));
        texts.len() >= 50
    });
    assert_eq!(texts, (0..50).map(|number| format!("kick {number}")).collect::<Vec<_>>());
    await_that("the history", || {
        reader.process_messages(second.now());
        reader.from(host).recent(TRACK, Duration::MAX).count() == 20
    });
    let view = reader.from(host);
    let sample = view.nearest(TRACK, second.now()).unwrap();
    assert_eq!(sample.distance, 19.0, "the newest is the nearest to now");
    assert!(sample.header.local <= second.now());
    let report = first.stop();
    assert_eq!(report.counters.failed, 0);
    second.stop();
}

#[test]
fn best_effort_topics_and_priorities_are_the_settings() {
    let (listening, connecting) = pair("tcp");
    let rule =
        |topics: &str, reliability, priority| SendRule { topics: topics.into(), reliability, priority };
    let settings = LinkSettings {
        send: vec![
            rule("soccer/track", Reliability::BestEffort, 7),
            rule("soccer/command", Reliability::Reliable, 1),
        ],
        ..LinkSettings::default()
    };
    let first = End::with("robot_1", settings, &listening).unwrap();
    let second = End::new("robot_2", &connecting);
    await_that("the introductions", || second.knows("robot_1") && first.knows("robot_2"));
    let mut track = first.hub.publisher(TRACK, "vision").unwrap();
    let mut coach = first.hub.publisher(COMMAND, "coach").unwrap();
    for number in 0..30 {
        track.publish(ball(f64::from(number)), first.now());
        coach.publish(Command { text: number.to_string() }, first.now());
    }
    await_that("all of it", || {
        let (track, command) =
            (second.received("robot_1", "soccer/track"), second.received("robot_1", "soccer/command"));
        track.last == 30 && track.missing == 0 && command.delivered == 30
    });
    let track = second.received("robot_1", "soccer/track");
    assert_eq!((track.delivered + track.gaps, track.held), (30, 0), "{track:?}");
    assert_eq!(first.stop().counters.sent.iter().find(|one| one.0 == "soccer/track").unwrap().1.resent, 0);
    second.stop();
}

#[test]
fn large_messages_go_through_shared_memory_where_both_sides_may() {
    let pixels: Vec<u8> = (0..1 << 20).map(|place: u32| (place % 251) as u8).collect();
    for is_shared in [true, false] {
        let (listening, connecting) = pair("tcp");
        let listening = ZenohSettings { shared_memory: is_shared, ..listening };
        let (first, second) = (End::new("robot_1", &listening), End::new("robot_2", &connecting));
        await_that("the introductions", || second.knows("robot_1") && first.knows("robot_2"));
        let mut camera = first.hub.publisher(PICTURE, "camera").unwrap();
        let mut reader = second.hub.blackboard("reader");
        let host = second.hub.host_id("robot_1").unwrap();
        // The memory is allocated when the first picture is sent; those that cannot wait for it go
        // over the line.
        let mut count = 0;
        await_that("the pictures", || {
            count += 1;
            camera.publish(Picture { pixels: pixels.clone() }, first.now());
            await_that("a picture", || second.received("robot_1", "soccer/picture").delivered == count);
            reader.process_messages(second.now());
            assert!(reader.from(host).read(PICTURE).is_some_and(|picture| picture.pixels == pixels));
            if is_shared { second.link.report().shared > 0 } else { count == 5 }
        });
        assert_eq!(second.stop().shared > 0, is_shared);
        first.stop();
    }
}

#[test]
fn oversized_messages_are_counted_and_block_nothing() {
    let (listening, connecting) = pair("tcp");
    let listening = ZenohSettings { largest: 100_000, ..listening };
    let (first, second) = (End::new("robot_1", &listening), End::new("robot_2", &connecting));
    await_that("the introductions", || second.knows("robot_1") && first.knows("robot_2"));
    let mut coach = first.hub.publisher(COMMAND, "coach").unwrap();
    for length in [10, 100_000, 20] {
        coach.publish(Command { text: "x".repeat(length) }, first.now());
    }
    await_that("the others", || second.received("robot_1", "soccer/command").delivered == 2);
    await_that("the report", || first.sent("soccer/command").sent == 2);
    let sent = first.sent("soccer/command");
    assert_eq!((sent.taken, sent.sent, sent.oversize), (3, 2, 1));
    first.stop();
    second.stop();
}

#[test]
fn a_restarted_host_is_received_again() {
    let (listening, connecting) = pair("tcp");
    let first = End::new("robot_1", &listening);
    for life in 1..4 {
        let second = End::new("robot_2", &connecting);
        second.say_ball(f64::from(life));
        await_that("the ball", || first.ball_of("robot_2") == Some(f64::from(life)));
    }
    first.stop();
}

#[test]
fn links_of_different_realms_do_not_hear_each_other() {
    let (listening, connecting) = pair("tcp");
    let first = End::new("robot_1", &listening);
    let other = End::new("robot_2", &ZenohSettings { realm: "other".into(), ..connecting.clone() });
    let same = End::new("robot_3", &connecting);
    first.say_ball(1.0);
    await_that("the ball", || same.ball_of("robot_1") == Some(1.0));
    assert!(!first.knows("robot_2") && !other.knows("robot_1"));
}

#[test]
fn clocks_of_hosts_are_compared() {
    let (listening, connecting) = pair("tcp");
    let began = Timestamp::ZERO + Duration::from_secs(1000);
    let first = End::over("robot_1", everything(), &listening, began, |zenoh| Box::new(zenoh)).unwrap();
    let second = End::new("robot_2", &connecting);
    let ahead = (began.since(Timestamp::ZERO) + second.start.duration_since(first.start)).as_nanos() as i64;
    let offset = || second.link.report().peers.iter().find_map(|peer| peer.2);
    await_that("the comparison", || offset().is_some());
    let offset = offset().unwrap();
    assert!(
        (offset.ahead - ahead).unsigned_abs() <= offset.round_trip / 2 + 1,
        "{offset:?}, and it is {ahead}"
    );
    first.say_ball(1.0);
    let published = first.now();
    await_that("the ball", || second.ball_of("robot_1") == Some(1.0));
    let mut reader = second.hub.blackboard("reader");
    reader.process_messages(second.now());
    let sample = reader.from(second.hub.host_id("robot_1").unwrap()).sample(BALL).unwrap().header;
    assert!(sample.published <= published);
    let error = Timestamp::from_nanos(sample.published.as_nanos() - ahead as u64).distance(sample.local);
    assert!(
        error <= Duration::from_nanos(offset.round_trip) + Duration::from_millis(200),
        "{error:?}, {offset:?}"
    );
}
