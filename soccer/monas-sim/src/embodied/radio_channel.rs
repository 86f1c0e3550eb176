//! Radio messages between the robots of a team.

use monas_robot::Heard;

use crate::RobotState;

/// Largest radio message in bytes, as in the rules of the league.
pub(super) const LONGEST: usize = 128;

/// A lossless radio channel. Messages sent while bodies act are received by team mates when they
/// sense next.
#[derive(Clone, Debug, Default)]
pub(crate) struct RadioChannel {
    listeners: Vec<Listener>,
}

/// A robot and the messages that it has not received yet.
#[derive(Clone, Debug)]
struct Listener {
    team: usize,
    number: u8,
    waiting: Vec<Heard>,
}

impl RadioChannel {
    pub(super) fn new(robots: &[RobotState]) -> RadioChannel {
        let listener =
            |robot: &RobotState| Listener { team: robot.team, number: robot.number, waiting: Vec::new() };
        RadioChannel { listeners: robots.iter().map(listener).collect() }
    }

    /// Sends a message to all team mates of a robot.
    pub(super) fn broadcast(&mut self, robot: usize, words: &[u8]) {
        let Some(&Listener { team, number, .. }) = self.listeners.get(robot) else { return };
        let heard = || Heard { number: number.into(), heard_at: 0, words: words.to_vec() };
        let others =
            self.listeners.iter_mut().enumerate().filter(|(index, it)| *index != robot && it.team == team);
        others.for_each(|(_, other)| other.waiting.push(heard()));
    }

    /// Moves the pending messages of a robot to `heard`, stamped with the time of reception.
    pub(super) fn receive(&mut self, robot: usize, heard_at: u64, heard: &mut Vec<Heard>) {
        let Some(listener) = self.listeners.get_mut(robot) else { return };
        heard.extend(listener.waiting.drain(..).map(|it| Heard { heard_at, ..it }));
    }
}
