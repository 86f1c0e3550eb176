//! Which messages of a tape are meant.

use monas::Moment;
use monas_tape::{Channel, Message, Overview};
use yase::diagnostic::nearest;

use super::arguments::Selection;
use crate::failure::Failure;

impl Selection {
    /// Whether messages of a channel are meant.
    pub(super) fn wants(&self, channel: &Channel) -> bool {
        let fits = |pattern: &String| narukom::pattern_fits(pattern, &channel.topic);
        (self.topics.is_empty() || self.topics.iter().any(fits))
            && (self.hosts.is_empty() || self.hosts.contains(&channel.host))
    }

    /// Whether a message is meant, if its channel is.
    pub(super) fn is_within(&self, message: &Message<'_>) -> bool {
        let (from, to) = self.span();
        from.is_none_or(|from| message.received >= from) && to.is_none_or(|to| message.received < to)
    }

    /// The moments of the run between which messages are meant.
    pub(super) fn span(&self) -> (Option<Moment>, Option<Moment>) {
        let moment = |time| Moment::ZERO + time;
        (self.from.map(moment), self.to.map(moment))
    }

    /// Refuses what means nothing on this tape.
    pub(super) fn check(&self, overview: &Overview) -> Result<(), Failure> {
        if let (Some(from), Some(to)) = (self.from, self.to)
            && from >= to
        {
            return Err(Failure::Usage("--from has to be earlier than --to".into()));
        }
        let channels = || overview.channels.iter().map(|counted| &*counted.channel);
        for pattern in &self.topics {
            if !channels().any(|channel| narukom::pattern_fits(pattern, &channel.topic)) {
                return Err(unknown(
                    "tape",
                    "topic",
                    pattern,
                    channels().map(|channel| channel.topic.as_str()),
                ));
            }
        }
        for host in &self.hosts {
            if !channels().any(|channel| channel.host == *host) {
                return Err(unknown("tape", "host", host, channels().map(|channel| channel.host.as_str())));
            }
        }
        Ok(())
    }
}

/// Says that there is no such thing in a tape or a configuration, and what there is.
pub(super) fn unknown<'a>(
    place: &str,
    what: &str,
    name: &str,
    known: impl Iterator<Item = &'a str>,
) -> Failure {
    let mut known: Vec<&str> = known.collect();
    known.sort_unstable();
    known.dedup();
    let hint = match nearest(name, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("it has {}", known.join(", ")),
    };
    Failure::Usage(format!("the {place} has no {what} `{name}`; {hint}"))
}
