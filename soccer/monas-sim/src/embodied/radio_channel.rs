//! Radio messages between the robots of a team.

use monas_robot::Heard;

use crate::rng::RandomStream;
use crate::{Radio, RobotState};

/// The radio channel of all teams. A message that a robot sends while bodies act is received by its
/// team mates when they sense next, unless the radio delays or loses it.
#[derive(Clone, Debug)]
pub(crate) struct RadioChannel {
    radio: Radio,
    random: RandomStream,
    listeners: Vec<Listener>,
    /// The messages that each team has sent.
    sent: [u32; 2],
}

/// A robot and the messages that it has not received yet.
#[derive(Clone, Debug)]
struct Listener {
    team: usize,
    number: u8,
    waiting: Vec<WaitingMessage>,
}

/// A message in the air.
#[derive(Clone, Debug)]
struct WaitingMessage {
    arrives_at: u64,
    heard: Heard,
}

impl RadioChannel {
    pub(super) fn new(robots: &[RobotState], radio: Radio, seed: u64) -> RadioChannel {
        let listener =
            |robot: &RobotState| Listener { team: robot.team, number: robot.number, waiting: Vec::new() };
        RadioChannel {
            radio,
            random: RandomStream::new(seed, "radio"),
            listeners: robots.iter().map(listener).collect(),
            sent: [0; 2],
        }
    }

    /// The longest message, bytes.
    pub(super) fn longest(&self) -> usize {
        self.radio.longest_message as usize
    }

    /// The messages that each team has sent.
    pub(super) fn sent(&self) -> [u32; 2] {
        self.sent
    }

    /// Sends a message to all team mates of a robot, if its team may still send one.
    pub(super) fn broadcast(&mut self, robot: usize, now: u64, words: &[u8]) {
        let Some(&Listener { team, number, .. }) = self.listeners.get(robot) else { return };
        if f64::from(self.sent[team]) >= self.radio.message_budget {
            return;
        }
        self.sent[team] += 1;
        let heard = || Heard { number: number.into(), heard_at: 0, words: words.to_vec() };
        for (index, other) in self.listeners.iter_mut().enumerate() {
            if index == robot || other.team != team {
                continue;
            }
            // The same number of draws for each receiver, whatever is drawn.
            let is_lost = self.random.chance(self.radio.loss);
            let is_double = self.random.chance(self.radio.duplication);
            let [first, second] = [self.random.uniform(), self.random.uniform()].map(|part| {
                let delay = self.radio.delay + self.radio.delay_spread * part;
                now + (delay * 1e9) as u64
            });
            if !is_lost {
                other.waiting.push(WaitingMessage { arrives_at: first, heard: heard() });
            }
            if !is_lost && is_double {
                other.waiting.push(WaitingMessage { arrives_at: second, heard: heard() });
            }
        }
    }

    /// Moves the messages that have arrived at a robot to `heard`, in the order of arrival, stamped
    /// with the time of reception.
    pub(super) fn receive(&mut self, robot: usize, now: u64, heard: &mut Vec<Heard>) {
        let Some(listener) = self.listeners.get_mut(robot) else { return };
        listener.waiting.sort_by_key(|message| message.arrives_at);
        let arrived = listener.waiting.iter().take_while(|message| message.arrives_at <= now).count();
        let arrived = listener.waiting.drain(..arrived);
        heard.extend(arrived.map(|message| Heard { heard_at: now, ..message.heard }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BodyPhase, Pose, Vector};

    const TENTH_OF_SECOND: u64 = 100_000_000;

    fn channel(radio: Radio) -> RadioChannel {
        let robot = |number| RobotState {
            team: 0,
            number,
            pose: Pose::default(),
            velocity: Vector::zeros(),
            intent: Vector::zeros(),
            phase: BodyPhase::Standing,
            head_yaw: 0.0,
            head_pitch: 0.0,
            on_field: true,
        };
        RadioChannel::new(&[robot(2), robot(3)], radio, 7)
    }

    /// Messages that robot 1 receives of a thousand from robot 0, which sends one each tenth of a
    /// second.
    fn received(radio: Radio) -> Vec<(u64, u16)> {
        let (mut channel, mut received) = (channel(radio), Vec::new());
        for moment in 0..1100u16 {
            let now = u64::from(moment) * TENTH_OF_SECOND;
            if moment < 1000 {
                channel.broadcast(0, now, &moment.to_le_bytes());
            }
            let mut heard = Vec::new();
            channel.receive(1, now, &mut heard);
            let number = |words: &[u8]| u16::from_le_bytes([words[0], words[1]]);
            received
                .extend(heard.iter().map(|heard| (heard.heard_at / TENTH_OF_SECOND, number(&heard.words))));
        }
        received
    }

    #[test]
    fn an_ideal_radio_carries_all_at_once() {
        let received = received(Radio::default());
        assert_eq!(received.len(), 1000);
        assert!(received.iter().all(|(at, number)| *at == u64::from(*number)));
    }

    #[test]
    fn messages_are_lost_doubled_late_and_in_another_order() {
        let lost = received(Radio { loss: 0.2, ..Radio::default() });
        assert!((750..850).contains(&lost.len()), "{}", lost.len());
        let double = received(Radio { duplication: 0.5, ..Radio::default() });
        assert!((1430..1570).contains(&double.len()), "{}", double.len());
        let late = received(Radio { delay: 0.5, ..Radio::default() });
        assert!(late.len() == 1000 && late.iter().all(|(at, number)| *at == u64::from(*number) + 5));
        let spread = received(Radio { delay_spread: 0.5, ..Radio::default() });
        assert!(spread.len() == 1000 && !spread.is_sorted_by_key(|(_, number)| *number));
        assert!(spread.is_sorted_by_key(|(at, _)| *at));
    }

    #[test]
    fn the_same_seed_loses_the_same() {
        let radio = || Radio { loss: 0.5, delay_spread: 0.3, duplication: 0.1, ..Radio::default() };
        assert_eq!(received(radio()), received(radio()));
    }

    #[test]
    fn a_team_sends_no_more_than_its_budget() {
        assert_eq!(received(Radio { message_budget: 12.0, ..Radio::default() }).len(), 12);
    }
}
