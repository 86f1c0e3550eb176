//! Times of a player's last pass and shot.

use std::time::Duration;

use narukom::Timestamp;

/// Time from the request of a kick until the foot hits the ball.
const STRIKE_TIME: Duration = Duration::from_millis(800);

/// The kicks of a player.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Kicks {
    /// The time of the newest request and whether it is a pass; none after the foot has hit the
    /// ball.
    under_way: Option<(Timestamp, bool)>,
    newest: u64,
    passed_at: Option<Timestamp>,
    shot_at: Option<Timestamp>,
}

impl Kicks {
    /// Records the newest request of a kick, by its number, and whether that kick is a pass.
    pub fn observe_request(&mut self, now: Timestamp, number: u64, is_pass: bool) {
        if number > self.newest {
            self.newest = number;
            self.under_way = Some((now, is_pass));
        }
        if let Some((since, is_pass)) = self.under_way
            && now.since(since) >= STRIKE_TIME
        {
            self.under_way = None;
            *(if is_pass { &mut self.passed_at } else { &mut self.shot_at }) = Some(now);
        }
    }

    /// Records that the motion of a request was refused, or that the robot fell in it. If the foot
    /// has not hit the ball by then, there was no kick.
    pub fn observe_failure(&mut self, number: u64) {
        if number == self.newest {
            self.under_way = None;
        }
    }

    /// Seconds since the last pass, if there was one.
    pub fn since_pass(&self, now: Timestamp) -> Option<f64> {
        self.passed_at.map(|at| now.since(at).as_secs_f64())
    }

    /// Seconds since the last kick that was not a pass, if there was one.
    pub fn since_shot(&self, now: Timestamp) -> Option<f64> {
        self.shot_at.map(|at| now.since(at).as_secs_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kick_is_over_once_the_foot_has_met_the_ball() {
        let (mut kicks, at) = (Kicks::default(), |millis: u64| Timestamp::from_nanos(millis * 1_000_000));
        kicks.observe_request(at(0), 0, false);
        assert_eq!(
            (kicks.since_pass(at(900)), kicks.since_shot(at(900))),
            (None, None),
            "nothing was wished"
        );
        kicks.observe_request(at(1000), 1, true);
        kicks.observe_request(at(1700), 1, false);
        assert_eq!(kicks.since_pass(at(1700)), None, "not yet");
        kicks.observe_request(at(1800), 1, false);
        assert_eq!((kicks.since_pass(at(2300)), kicks.since_shot(at(2300))), (Some(0.5), None));
        kicks.observe_request(at(3000), 2, false);
        kicks.observe_request(at(4000), 2, true);
        assert_eq!((kicks.since_pass(at(4000)), kicks.since_shot(at(4000))), (Some(2.2), Some(0.0)));
        kicks.observe_request(at(5000), 3, true);
        kicks.observe_failure(3);
        kicks.observe_request(at(6000), 3, true);
        assert_eq!(kicks.since_pass(at(6000)), Some(4.2), "the robot fell before it kicked");
    }
}
