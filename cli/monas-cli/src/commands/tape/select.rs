//! Selection of messages on a tape.

use monas::Timestamp;
use monas_tape::{Channel, RecordedSample, TapeOverview};
use monas_terminal::CommandFailure;

use super::arguments::MessageSelection;
use crate::input::check_within;

impl MessageSelection {
    /// Whether messages of a channel are selected.
    pub(crate) fn wants(&self, channel: &Channel) -> bool {
        let fits = |pattern: &String| narukom::pattern_fits(pattern, &channel.topic);
        (self.topics.is_empty() || self.topics.iter().any(fits))
            && (self.hosts.is_empty() || self.hosts.contains(&channel.host))
    }

    /// Whether a message of a selected channel is in the time span.
    pub(crate) fn is_within(&self, message: &RecordedSample<'_>) -> bool {
        let (from, to) = self.span();
        from.is_none_or(|from| message.received >= from) && to.is_none_or(|to| message.received < to)
    }

    /// The selected time span.
    pub(crate) fn span(&self) -> (Option<Timestamp>, Option<Timestamp>) {
        let moment = |time| Timestamp::ZERO + time;
        (self.from.map(moment), self.to.map(moment))
    }

    /// Refuses an empty time span, one after the end, and topics and hosts that the tape does not
    /// have.
    pub(crate) fn check(&self, overview: &TapeOverview) -> Result<(), CommandFailure> {
        if let (Some(from), Some(to)) = (self.from, self.to)
            && from >= to
        {
            return Err(CommandFailure::Usage("--from has to be earlier than --to".into()));
        }
        if let Some(from) = self.from {
            check_within("--from", from.as_secs_f64(), overview)?;
        }
        let channels = || overview.channels.iter().map(|counted| &*counted.channel);
        for pattern in &self.topics {
            if !channels().any(|channel| narukom::pattern_fits(pattern, &channel.topic)) {
                return Err(CommandFailure::unknown_name(
                    "tape",
                    "topic",
                    pattern,
                    channels().map(|channel| channel.topic.as_str()),
                ));
            }
        }
        for host in &self.hosts {
            if !channels().any(|channel| channel.host == *host) {
                return Err(CommandFailure::unknown_name(
                    "tape",
                    "host",
                    host,
                    channels().map(|channel| channel.host.as_str()),
                ));
            }
        }
        Ok(())
    }
}
