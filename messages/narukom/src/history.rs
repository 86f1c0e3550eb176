//! The messages of a topic, ordered by time.

use std::collections::{VecDeque, vec_deque};

use crate::inbox::Inbox;
use crate::outbox::Outbox;
use crate::sample::{AnySample, Sample};
use crate::timestamp::Timestamp;

/// The messages of a topic on a blackboard: first the delivered ones, sorted by time of
/// publication, then its own that the hub has not delivered yet.
pub(crate) struct History<'a> {
    samples: &'a VecDeque<AnySample>,
    /// The index of the first delivered message within the depth.
    first: usize,
    own_messages: Option<&'a Outbox>,
    /// The number of own messages beyond the depth.
    surplus: usize,
    /// Older messages are ignored.
    oldest: Timestamp,
}

/// The two messages of a history around a time, for interpolation.
#[derive(Clone, Copy, Debug)]
pub struct SurroundingSamples<'a, M: ?Sized> {
    /// The last one published at or before that time.
    pub before: Sample<'a, M>,
    /// The first one published at or after that time; the same as `before` if that was published
    /// exactly then.
    pub after: Sample<'a, M>,
    /// Position of that time between the two: 0 at `before`, approaching 1 towards `after`.
    pub share: f64,
}

impl<'a> History<'a> {
    /// The history readable at `now`.
    #[inline]
    pub(crate) fn new(reading: &'a Inbox, writing: Option<&'a Outbox>, now: Timestamp) -> History<'a> {
        let (samples, oldest) = (reading.samples(), reading.oldest(now));
        let own = writing.map_or(0, Outbox::visible_count);
        let surplus = (samples.len() + own).saturating_sub(reading.limit());
        let (first, surplus) = (surplus.min(samples.len()), surplus.saturating_sub(samples.len()));
        let expired = if oldest == Timestamp::ZERO { 0 } else { before(samples, oldest) };
        History {
            samples,
            first: first.max(expired),
            own_messages: writing.filter(|_| own > 0),
            surplus,
            oldest,
        }
    }

    #[inline]
    fn own(&self) -> impl DoubleEndedIterator<Item = &'a AnySample> + use<'a> {
        let (oldest, surplus) = (self.oldest, self.surplus);
        let own = self.own_messages.into_iter().flat_map(move |writing| writing.visible_from(surplus));
        own.filter(move |sample| sample.header.local >= oldest)
    }

    fn delivered(&self) -> vec_deque::Iter<'a, AnySample> {
        self.samples.range(self.first..)
    }

    /// All, oldest first.
    pub(crate) fn iter(self) -> impl DoubleEndedIterator<Item = &'a AnySample> + use<'a> {
        let own = self.own();
        self.delivered().chain(own)
    }

    /// The last one published at or before `moment`.
    pub(crate) fn not_newer(&self, moment: Timestamp) -> Option<&'a AnySample> {
        self.last_before(until(self.samples, moment), moment)
    }

    /// The first one published at or after `moment`.
    pub(crate) fn not_older(&self, moment: Timestamp) -> Option<&'a AnySample> {
        self.first_from(before(self.samples, moment), moment)
    }

    /// The one published nearest to `moment`; the earlier one if two are equally near.
    #[inline]
    pub(crate) fn nearest(&self, moment: Timestamp) -> Option<&'a AnySample> {
        // A message published exactly at `moment` is before `later`, so the search can start there.
        let later = until(self.samples, moment);
        let (before, after) = (self.last_before(later, moment), self.first_from(later, moment));
        let (Some(one), Some(other)) = (before, after) else { return before.or(after) };
        let distance = |sample: &AnySample| sample.header.local.distance(moment);
        if distance(other) < distance(one) { after } else { before }
    }

    /// The last message published at or before `moment` among the delivered ones before
    /// `index` and the own ones.
    #[inline]
    fn last_before(&self, index: usize, moment: Timestamp) -> Option<&'a AnySample> {
        let delivered = if index > self.first { self.samples.get(index - 1) } else { None };
        if self.own_messages.is_none() {
            return delivered;
        }
        let own = self.own().rfind(|sample| sample.header.local <= moment);
        [delivered, own].into_iter().flatten().max_by_key(|sample| sample.header.local)
    }

    /// The first message published at or after `moment` among the delivered ones from `index`
    /// on and the own ones.
    #[inline]
    fn first_from(&self, index: usize, moment: Timestamp) -> Option<&'a AnySample> {
        let delivered = self.samples.get(index.max(self.first));
        if self.own_messages.is_none() {
            return delivered;
        }
        let own = self.own().find(|sample| sample.header.local >= moment);
        [delivered, own].into_iter().flatten().min_by_key(|sample| sample.header.local)
    }

    /// The two between which `moment` lies; `None` if it lies outside of the history.
    pub(crate) fn around<M: 'static>(&self, moment: Timestamp) -> Option<SurroundingSamples<'a, M>> {
        let before = self.not_newer(moment)?;
        let after = if before.header.local == moment { before } else { self.not_older(moment)? };
        let whole = after.header.local.since(before.header.local).as_nanos();
        let part = moment.since(before.header.local).as_nanos();
        let share = if whole == 0 { 0.0 } else { part as f64 / whole as f64 };
        Some(SurroundingSamples { before: before.downcast()?, after: after.downcast()?, share })
    }
}

/// The number of samples, sorted by time, that were published before `moment`.
fn before(samples: &VecDeque<AnySample>, moment: Timestamp) -> usize {
    match moment.as_nanos().checked_sub(1) {
        Some(nanos) => until(samples, Timestamp::from_nanos(nanos)),
        None => 0,
    }
}

/// The number of samples, sorted by time, that were published at or before `moment`.
///
/// Most histories are of sensors with equal intervals, so an interpolation search with
/// exponentially growing steps is used. In the worst case it takes twice the steps of a binary
/// search.
fn until(samples: &VecDeque<AnySample>, moment: Timestamp) -> usize {
    let is_early = |index: usize| samples[index].header.local <= moment;
    let guess = guess(samples, moment);
    // Invariant at the end: samples before `low` are not after `moment`, samples from `high` on
    // are.
    let (mut low, mut high, mut step) = (guess, guess, 1);
    while high < samples.len() && is_early(high) {
        (low, high, step) = (high + 1, high + step, step * 2);
    }
    (high, step) = (high.min(samples.len()), 1);
    while low > 0 && !is_early(low - 1) {
        (high, low, step) = (low - 1, low.saturating_sub(step), step * 2);
    }
    while low < high {
        let middle = low + (high - low) / 2;
        if is_early(middle) { low = middle + 1 } else { high = middle }
    }
    low
}

/// Index of `moment` if the samples are equally spaced.
fn guess(samples: &VecDeque<AnySample>, moment: Timestamp) -> usize {
    let (Some(first), Some(last)) = (samples.front(), samples.back()) else { return 0 };
    let (first, last) = (first.header.local.as_nanos(), last.header.local.as_nanos());
    let (part, whole) = (moment.as_nanos().saturating_sub(first), last - first);
    if part >= whole {
        return samples.len() - 1;
    }
    (part as f64 / whole as f64 * (samples.len() - 1) as f64) as usize
}
