//! Hostile peers: a robot neither crashes nor exhausts its memory, and still receives from its
//! team.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use monas_link::LinkSettings;
use monas_link::example::Ball;
use zenoh::Wait;
use zenoh::qos::CongestionControl;

use crate::{End, await_that, everything, pair, program};

/// Pseudo-random bytes, always the same.
fn noise(length: usize, seed: u64) -> Vec<u8> {
    let mut state = seed;
    std::iter::repeat_with(|| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u8
    })
    .take(length)
    .collect()
}

#[test]
fn noise_on_the_port_has_no_effect() {
    let (listening, connecting) = pair("tcp");
    let first = End::new("robot_1", &listening);
    let second = End::new("robot_2", &connecting);
    let address = listening.listen[0].strip_prefix("tcp/").unwrap();
    for seed in 0..40 {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
        let mut bytes = noise(200 + 500 * seed as usize, seed);
        if seed % 2 == 0 {
            // Prefixed with a length, as in zenoh; the longest there is.
            bytes[..2].copy_from_slice(&[0xff, 0xff]);
        }
        // It may or may not still be listening.
        let _ = stream.write_all(&bytes);
        let _ = stream.read(&mut [0; 64]);
    }
    first.say_ball(1.0);
    await_that("the ball", || second.ball_of("robot_1") == Some(1.0));
    first.stop();
}

#[test]
fn keys_stamps_and_lengths_that_cannot_be_are_counted_and_do_no_harm() {
    let (listening, connecting) = pair("tcp");
    let settings = LinkSettings { accepts_unlinked: true, ..everything() };
    let first = End::with("robot_1", settings, &listening).unwrap();
    let intruder = program(&connecting).unwrap();
    let put = |key: &str, payload: Vec<u8>, stamp: Vec<u8>| {
        let put = intruder.put(key, payload).attachment(stamp);
        put.congestion_control(CongestionControl::Block).wait().unwrap();
    };
    let long = "x".repeat(4000);
    for seed in 0..50 {
        put("monas/evil/c", noise(1000, seed), Vec::new());
        put("monas/evil/m/soccer/ball", noise(50, seed), noise(40, seed + 1));
        put("monas/evil/r/robot_1/soccer/ball", noise(50, seed), noise(40, seed + 1));
        put(&format!("monas/evil_{seed}/m/soccer/ball"), vec![0xff; 40], Vec::new());
        put(&format!("monas/{long}/c"), noise(10, seed), Vec::new());
        // A bytes field with a claimed length of four gigabytes.
        put("monas/evil/c", vec![0x1a, 0xff, 0xff, 0xff, 0xff, 0x0f], Vec::new());
        put("monas/evil/m/soccer/picture", vec![0x0a, 0xff, 0xff, 0xff, 0xff, 0x0f], Vec::new());
        intruder.delete("monas/evil/m/soccer/ball").wait().unwrap();
    }
    // Longer than the limit: the end is never read.
    put("monas/evil/m/soccer/picture", vec![0; (4 << 20) + 100_000], Vec::new());
    let honest = program(&connecting).unwrap();
    let ball = prost::Message::encode_to_vec(&Ball { distance: 4.0, bearing: 0.0 });
    honest.put("monas/honest/m/soccer/ball", ball).wait().unwrap();
    await_that("what an honest guest says", || first.ball_of("honest") == Some(4.0));
    let report = first.stop();
    assert!(report.counters.malformed >= 150, "{:?}", report.counters);
    let pictures =
        report.counters.received.iter().find(|one| one.0 == "evil" && one.1 == "soccer/picture").unwrap().2;
    assert_eq!((pictures.arrived, pictures.refused), (50, 50));
    assert!(report.peers.is_empty());
}

/// Ends the flood, also when the test fails.
struct Stops<'a>(&'a AtomicBool);

impl Drop for Stops<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::SeqCst);
    }
}

#[test]
fn a_flood_is_dropped_and_counted_and_the_link_continues() {
    let (listening, connecting) = pair("tcp");
    let first = End::new("robot_1", &listening);
    let second = End::new("robot_2", &connecting);
    await_that("the introduction", || first.knows("robot_2"));
    let intruder = program(&connecting).unwrap();
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let stops = Stops(&stop);
        scope.spawn(|| {
            while !stop.load(Ordering::SeqCst) {
                let put =
                    intruder.put("monas/evil/m/soccer/ball", vec![0_u8; 20_000]).attachment(vec![1_u8; 20]);
                put.wait().unwrap();
            }
        });
        for number in 1..=20 {
            second.say_ball(f64::from(number));
            await_that("the ball", || first.ball_of("robot_2") == Some(f64::from(number)));
        }
        drop(stops);
    });
    let report = first.stop();
    assert!(report.counters.malformed > 100, "{:?}", report.counters);
}
