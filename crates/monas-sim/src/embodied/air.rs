//! What the robots of a team say to each other.

use monas_robot::Heard;

use crate::RobotState;

/// The most bytes that a robot says at once, as in the rules of the league for messages between team mates.
pub(super) const LONGEST: usize = 128;

/// The air of a pitch. What is said while bodies act is heard by the others of the team when they sense next; nothing is lost.
#[derive(Clone, Debug, Default)]
pub(crate) struct Air {
    listeners: Vec<Listener>,
}

/// A robot, and what it has not listened to yet.
#[derive(Clone, Debug)]
struct Listener {
    team: usize,
    number: u8,
    waiting: Vec<Heard>,
}

impl Air {
    pub(super) fn new(robots: &[RobotState]) -> Air {
        let listener =
            |robot: &RobotState| Listener { team: robot.team, number: robot.number, waiting: Vec::new() };
        Air { listeners: robots.iter().map(listener).collect() }
    }

    /// A robot says something to all others of its team.
    pub(super) fn say(&mut self, robot: usize, words: &[u8]) {
        let Some(&Listener { team, number, .. }) = self.listeners.get(robot) else { return };
        let heard = || Heard { number: number.into(), heard_at: 0, words: words.to_vec() };
        let others =
            self.listeners.iter_mut().enumerate().filter(|(index, it)| *index != robot && it.team == team);
        others.for_each(|(_, other)| other.waiting.push(heard()));
    }

    /// What a robot hears at a moment.
    pub(super) fn listen(&mut self, robot: usize, heard_at: u64, heard: &mut Vec<Heard>) {
        let Some(listener) = self.listeners.get_mut(robot) else { return };
        heard.extend(listener.waiting.drain(..).map(|it| Heard { heard_at, ..it }));
    }
}
