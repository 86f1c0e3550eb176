//! Packets of a link: arbitrary bytes, and the packets of two valid links with bytes changed,
//! duplicated or dropped.

use std::sync::LazyLock;
use std::time::Duration;

use monas_link::example::Ball;
use monas_link::{HubBridge, LinkSettings, Packet};
use narukom::{Hub, Signal, State, Timestamp, topic};

topic! {
    BALL: State<Ball> = "link/ball";
    TOUCH: Signal<Ball> = "link/touch";
}

static SAID: LazyLock<Vec<Packet>> = LazyLock::new(conversation);

/// Checks the documented guarantees for one input.
pub fn frames(data: &[u8]) {
    let hub = Hub::with_linked_topics("robot_2").expect("the topics fit");
    let mut end = end(&hub, 2);
    let mut now = Timestamp::ZERO;
    for edit in data.chunks(8) {
        now += Duration::from_millis(u64::from(edit[0]));
        end.handle(&packet(edit), now);
        while end.poll(now).is_some() {}
    }
    for (host, path, got) in &end.node().counters().received {
        let seen = got.delivered + got.duplicates + got.late + got.refused + got.held;
        assert_eq!(got.arrived, seen, "{path} of {host}: {got:?}");
        let said = got.delivered + got.gaps + got.held + got.missing;
        assert_eq!(got.last - got.start, said, "{path} of {host}: {got:?}");
    }
    for (path, sent) in &end.node().counters().sent {
        assert_eq!(sent.taken, sent.sent + sent.dropped + sent.oversize + sent.waiting, "{path}: {sent:?}");
    }
}

fn end(hub: &Hub, incarnation: u64) -> HubBridge {
    let settings = LinkSettings { accepts_unlinked: true, ..LinkSettings::default() };
    HubBridge::new(hub, settings.sending("link/*").receiving("link/*"), incarnation)
        .expect("the settings fit")
}

/// A modified packet of the conversation: the second byte selects it, the others are edits; or raw
/// bytes.
fn packet(edit: &[u8]) -> Packet {
    let said = &SAID[usize::from(edit.get(1).copied().unwrap_or(0)) % SAID.len()];
    let mut packet = said.clone();
    match edit {
        [_, _, 255, rest @ ..] => packet.payload = rest.to_vec().into(),
        [_, _, 254, rest @ ..] => packet.stamp = rest.into(),
        [_, _, rest @ ..] => {
            for pair in rest.chunks_exact(2) {
                let mut parts = [packet.stamp.to_vec(), packet.payload.to_vec()];
                if let Some(byte) = parts[usize::from(pair[0] & 1)].get_mut(usize::from(pair[0] / 2)) {
                    *byte = pair[1];
                }
                let [stamp, payload] = parts;
                (packet.stamp, packet.payload) = (stamp.into(), payload.into());
            }
        }
        _ => {}
    }
    packet
}

/// The packets that a link sends to another that loses one packet in three.
fn conversation() -> Vec<Packet> {
    let hubs = ["robot_1", "robot_2"].map(|name| Hub::with_linked_topics(name).expect("the topics fit"));
    let (mut here, mut there) = (end(&hubs[0], 1), end(&hubs[1], 2));
    let mut touch = hubs[0].publisher(TOUCH, "body").expect("it is declared");
    let mut ball = hubs[0].publisher(BALL, "vision").expect("it is declared");
    let mut said = Vec::new();
    for step in 0..60_u64 {
        let now = Timestamp::from_nanos(step * 20_000_000);
        touch.publish(Ball { distance: step as f64, bearing: 0.5 }, now);
        ball.publish(Ball { distance: step as f64, bearing: 0.5 }, now);
        while let Some(packet) = here.poll(now) {
            if said.len() % 3 != 2 {
                there.handle(&packet, now);
            }
            said.push(packet);
        }
        while let Some(packet) = there.poll(now) {
            here.handle(&packet, now);
        }
    }
    said.truncate(255);
    said
}
