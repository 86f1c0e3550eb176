//! Lines with latency and interruptions; transports that duplicate, reorder and lose packets;
//! processes that are killed.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, mpsc};
use std::thread;
use std::time::{Duration, Instant};

use monas_link::example::Command;
use monas_link::{Error, Packet, Transport, Zenoh, ZenohSettings};
use narukom::{Random, Timestamp};

use crate::{COMMAND, End, await_that, everything, pair, port};

/// A proxy between two ports with latency, which can be interrupted.
struct Proxy {
    port: u16,
    is_cut: Arc<AtomicBool>,
    lines: Arc<Mutex<Vec<TcpStream>>>,
}

impl Proxy {
    fn new(target: u16, delay: Duration) -> Proxy {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let (is_cut, lines) = (Arc::new(AtomicBool::new(false)), Arc::new(Mutex::new(Vec::new())));
        let (cut, all) = (is_cut.clone(), lines.clone());
        thread::spawn(move || {
            for near in listener.incoming().map_while(Result::ok).filter(|_| !cut.load(Ordering::SeqCst)) {
                let Ok(far) = TcpStream::connect(("127.0.0.1", target)) else { continue };
                for (from, to) in [(&near, &far), (&far, &near)] {
                    pass(from.try_clone().unwrap(), to.try_clone().unwrap(), delay);
                }
                all.lock().unwrap().extend([near, far]);
            }
        });
        Proxy { port, is_cut, lines }
    }

    fn settings(&self) -> ZenohSettings {
        ZenohSettings { connect: vec![format!("tcp/127.0.0.1:{}", self.port)], ..ZenohSettings::default() }
    }

    fn cut(&self) {
        self.is_cut.store(true, Ordering::SeqCst);
        for line in self.lines.lock().unwrap().drain(..) {
            let _ = line.shutdown(Shutdown::Both);
        }
    }

    fn mend(&self) {
        self.is_cut.store(false, Ordering::SeqCst);
    }
}

/// Forwards bytes after a delay.
fn pass(mut from: TcpStream, mut to: TcpStream, delay: Duration) {
    let (sender, pieces) = mpsc::channel::<(Instant, Vec<u8>)>();
    thread::spawn(move || -> io::Result<()> {
        let mut buffer = vec![0; 64 << 10];
        loop {
            let length = from.read(&mut buffer)?;
            let sent = sender.send((Instant::now() + delay, buffer[..length].to_vec()));
            if length == 0 || sent.is_err() {
                return Ok(());
            }
        }
    });
    thread::spawn(move || -> io::Result<()> {
        for (due, piece) in pieces {
            while Instant::now() < due {
                thread::park_timeout(due.saturating_duration_since(Instant::now()));
            }
            if piece.is_empty() {
                break;
            }
            to.write_all(&piece)?;
        }
        to.shutdown(Shutdown::Both)
    });
}

#[test]
fn messages_during_an_outage_arrive_later_or_are_counted_as_a_gap() {
    let target = port();
    let listening =
        ZenohSettings { listen: vec![format!("tcp/127.0.0.1:{target}")], ..ZenohSettings::default() };
    let first = End::new("robot_1", &listening);
    let proxy = Proxy::new(target, Duration::from_millis(5));
    let second = End::new("robot_2", &proxy.settings());
    first.say_ball(1.0);
    await_that("the ball", || second.ball_of("robot_1") == Some(1.0));
    proxy.cut();
    let mut coach = first.hub.publisher(COMMAND, "coach").unwrap();
    for portion in 1..=2 {
        (0..50).for_each(|number| coach.publish(Command { text: number.to_string() }, first.now()));
        await_that("the sending", || first.sent("soccer/command").sent == 50 * portion);
    }
    first.say_ball(2.0);
    proxy.mend();
    await_that("the last state", || second.ball_of("robot_1") == Some(2.0));
    let got = || second.received("robot_1", "soccer/command");
    await_that("the end of the repairs", || got().last == 100 && got().missing == 0);
    let got = got();
    assert_eq!((got.delivered + got.gaps, got.held), (100, 0));
    assert!(got.delivered >= 64, "as many as the hub keeps: {got:?}");
    first.stop();
    second.stop();
}

/// The actions of a faulty transport.
#[derive(Default)]
struct Done {
    doubled: AtomicU64,
    lost: AtomicU64,
    overtaken: AtomicU64,
}

/// Loses one packet in ten, duplicates one in ten, and lets one in five be overtaken by the next
/// ones.
struct Rough {
    zenoh: Zenoh,
    random: Random,
    held: VecDeque<Packet>,
    done: Arc<Done>,
}

impl Transport for Rough {
    fn send(&mut self, packet: &Packet) -> Result<(), Error> {
        if self.random.chance(0.1) {
            self.done.lost.fetch_add(1, Ordering::SeqCst);
        } else if self.random.chance(0.2) && packet.path.is_some() {
            self.done.overtaken.fetch_add(1, Ordering::SeqCst);
            self.held.push_back(packet.clone());
        } else {
            self.zenoh.send(packet)?;
        }
        if self.random.chance(0.1) {
            self.done.doubled.fetch_add(1, Ordering::SeqCst);
            self.zenoh.send(packet)?;
        }
        while self.held.len() > 3 || (!self.held.is_empty() && self.random.chance(0.3)) {
            let held = self.held.pop_front();
            held.iter().try_for_each(|packet| self.zenoh.send(packet))?;
        }
        Ok(())
    }

    fn largest(&self) -> usize {
        self.zenoh.largest()
    }
}

#[test]
fn each_message_arrives_once_and_in_order_over_a_lossy_line() {
    let (listening, connecting) = pair("tcp");
    let done = Arc::new(Done::default());
    let rough = |seed: u8, done: Arc<Done>| {
        move |zenoh| -> Box<dyn Transport> {
            Box::new(Rough { zenoh, random: Random::from_seed([seed; 32]), held: VecDeque::new(), done })
        }
    };
    let first =
        End::over("robot_1", everything(), &listening, Timestamp::ZERO, rough(1, done.clone())).unwrap();
    let second =
        End::over("robot_2", everything(), &connecting, Timestamp::ZERO, rough(2, Arc::default())).unwrap();
    await_that("the introductions", || first.knows("robot_2") && second.knows("robot_1"));
    let mut coach = first.hub.publisher(COMMAND, "coach").unwrap();
    let mut reader = second.hub.blackboard("reader");
    let host = second.hub.host_id("robot_1").unwrap();
    reader.process_messages(second.now());
    assert_eq!(reader.from(host).signals(COMMAND).count(), 0);
    let mut texts = Vec::new();
    // In portions, so that the hub retains what is requested again.
    for portion in 0..10 {
        let first_number = portion * 30;
        (first_number..first_number + 30)
            .for_each(|number| coach.publish(Command { text: number.to_string() }, first.now()));
        await_that("the portion", || {
            reader.process_messages(second.now());
            texts.extend(reader.from(host).signals(COMMAND).map(|command| command.message.text.clone()));
            texts.len() >= first_number + 30
        });
    }
    assert_eq!(texts, (0..300).map(|number| number.to_string()).collect::<Vec<_>>());
    await_that("the report", || second.received("robot_1", "soccer/command").delivered == 300);
    let of = |counter: &AtomicU64| counter.load(Ordering::SeqCst);
    assert!(of(&done.lost) > 0 && of(&done.doubled) > 0 && of(&done.overtaken) > 0);
    let (sent, got) = (first.sent("soccer/command"), second.received("robot_1", "soccer/command"));
    assert_eq!((got.delivered, got.gaps, got.missing), (300, 0, 0), "{got:?}");
    assert!(got.duplicates > 0 && sent.resent > 0, "{got:?} {sent:?}");
    first.stop();
    second.stop();
}
