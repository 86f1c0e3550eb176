//! Which reports a player sends to its team.
//!
//! A team has a number of messages for a match. Each player may send `rate` of them a second on
//! average; what it does not send now it may send later, up to [`MAX_SAVED`] messages. The value of
//! a report is what it adds to the last one: a kick, a ball that was found or lost, a displacement
//! of robot or ball, and the time passed. With all messages saved a small value suffices; with none
//! left, reports follow an even schedule.

use std::time::Duration;

use narukom::Timestamp;

/// The most messages that a player saves.
const MAX_SAVED: f64 = 12.0;
/// The value of a report that justifies a message while all are saved, and while one is left.
const MIN_VALUE: (f64, f64) = (0.6, 2.0);

/// The messages that a player may send.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ReportBudget {
    /// Messages a second on average.
    pub rate: f64,
    /// The messages that may be sent now, and when they were counted.
    saved: f64,
    counted_at: Option<Timestamp>,
}

impl Default for ReportBudget {
    /// The league's 1200 messages in a match of 600 s, shared by two players.
    fn default() -> ReportBudget {
        ReportBudget { rate: 1.0, saved: MAX_SAVED, counted_at: None }
    }
}

impl ReportBudget {
    /// Spends a message if the value of the report justifies it. Returns whether the report is to
    /// be sent.
    pub fn spend(&mut self, now: Timestamp, worth: f64) -> bool {
        let elapsed = self.counted_at.map_or(Duration::ZERO, |at| now.since(at));
        self.counted_at = Some(now);
        self.saved = (self.saved + elapsed.as_secs_f64() * self.rate).min(MAX_SAVED);
        let spent = 1.0 - (self.saved / MAX_SAVED);
        let is_sent = self.saved >= 1.0 && worth >= MIN_VALUE.0 + (MIN_VALUE.1 - MIN_VALUE.0) * spent;
        if is_sent {
            self.saved -= 1.0;
        }
        is_sent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: f64) -> Timestamp {
        Timestamp::from_secs_f64(seconds)
    }

    /// The number of reports sent in a match of 600 s, with a value that grows at this rate per
    /// second.
    fn sent(worth_a_second: f64) -> usize {
        let (mut budget, mut last) = (ReportBudget::default(), 0.0);
        let moments = (0..6000).map(|tenth| f64::from(tenth) / 10.0);
        let is_sent = |now: &f64| {
            let is_sent = budget.spend(at(*now), (now - last) * worth_a_second);
            if is_sent {
                last = *now;
            }
            is_sent
        };
        moments.filter(is_sent).count()
    }

    #[test]
    fn the_budget_holds_whatever_happens() {
        assert!(sent(1e9) <= 612, "{}", sent(1e9));
        assert!((500..=612).contains(&sent(4.0)), "{}", sent(4.0));
        assert!(sent(0.5) <= 500, "a robot that has little to say saves messages: {}", sent(0.5));
    }

    #[test]
    fn what_matters_is_sent_when_messages_are_short() {
        let mut budget = ReportBudget::default();
        while budget.spend(at(1.0), f64::INFINITY) {}
        assert!(!budget.spend(at(2.5), 1.0), "a step is not worth the last message");
        assert!(budget.spend(at(2.5), 3.0), "a kick is");
    }
}
