//! Which players are online.

use std::collections::BTreeMap;
use std::time::Duration;

use narukom::Timestamp;

/// The age of a report up to which the connection is good.
const MAX_AGE_GOOD: Duration = Duration::from_secs(2);
/// The age of a report up to which the connection is bad; then the player is offline.
const MAX_AGE_BAD: Duration = Duration::from_secs(4);

/// The connection of a player.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Connection {
    /// It has not reported for more than four seconds, or never.
    Offline,
    /// Its last report is more than two seconds old.
    Bad,
    /// It has reported within two seconds.
    Good,
}

/// When the players of two teams have reported.
#[derive(Clone, Debug, Default)]
pub struct OnlinePlayers {
    teams: Option<[u8; 2]>,
    reported: BTreeMap<(u8, u8), Timestamp>,
}

impl OnlinePlayers {
    /// The teams that play; reports of others do not count.
    pub fn expect(&mut self, teams: [u8; 2]) {
        self.teams = Some(teams);
    }

    /// Notes a valid report of a player.
    pub fn note(&mut self, team: u8, player: u8, now: Timestamp) {
        if self.teams.is_none_or(|teams| teams.contains(&team)) {
            self.reported.insert((team, player), now);
        }
    }

    /// The connection of a player.
    pub fn connection(&self, team: u8, player: u8, now: Timestamp) -> Connection {
        match self.reported.get(&(team, player)).map(|reported| now.since(*reported)) {
            Some(age) if age <= MAX_AGE_GOOD => Connection::Good,
            Some(age) if age <= MAX_AGE_BAD => Connection::Bad,
            _ => Connection::Offline,
        }
    }

    /// The players that have ever reported, by team and number, with their connections.
    pub fn players(&self, now: Timestamp) -> impl Iterator<Item = ((u8, u8), Connection)> + '_ {
        self.reported.keys().map(move |&(team, player)| ((team, player), self.connection(team, player, now)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_connection_is_good_then_bad_then_lost() {
        let at = |seconds: f64| Timestamp::ZERO + Duration::from_secs_f64(seconds);
        let mut online = OnlinePlayers::default();
        online.expect([5, 24]);
        assert_eq!(online.connection(5, 2, at(1.0)), Connection::Offline);
        online.note(5, 2, at(1.0));
        online.note(6, 2, at(1.0));
        for (time, connection) in [
            (3.0, Connection::Good),
            (3.1, Connection::Bad),
            (5.0, Connection::Bad),
            (5.1, Connection::Offline),
        ] {
            assert_eq!(online.connection(5, 2, at(time)), connection, "{time} s");
        }
        assert_eq!(online.players(at(2.0)).collect::<Vec<_>>(), [((5, 2), Connection::Good)]);
    }
}
