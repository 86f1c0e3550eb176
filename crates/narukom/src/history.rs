//! The messages of a topic, by time.

use std::collections::{VecDeque, vec_deque};

use crate::moment::Moment;
use crate::reading::Reading;
use crate::sample::{AnySample, Sample};
use crate::writing::Writing;

/// The messages that a blackboard has of a topic: first the delivered ones, sorted by time of publication, then its own
/// that have not come back yet.
pub(crate) struct History<'a> {
    samples: &'a VecDeque<AnySample>,
    /// The first of the delivered ones that still counts.
    first: usize,
    own: Option<&'a Writing>,
    /// What is older does not count.
    oldest: Moment,
}

/// The two messages of a history between which a moment lies, for whoever interpolates.
#[derive(Clone, Copy, Debug)]
pub struct Neighbours<'a, M: ?Sized> {
    /// The last one published at the moment or before.
    pub before: Sample<'a, M>,
    /// The first one published at the moment or after; the same as `before` if that was published at the moment.
    pub after: Sample<'a, M>,
    /// How far the moment is on the way from the one to the other: 0 at `before`, approaching 1 towards `after`.
    pub share: f64,
}

impl<'a> History<'a> {
    /// What is to be read at `now`.
    #[inline]
    pub(crate) fn new(reading: &'a Reading, writing: Option<&'a Writing>, now: Moment) -> History<'a> {
        let (samples, oldest) = (reading.samples(), reading.oldest(now));
        let own = writing.map_or(0, |writing| writing.visible().count());
        let surplus = (samples.len() + own).saturating_sub(reading.limit()).min(samples.len());
        let expired = if oldest == Moment::ZERO { 0 } else { before(samples, oldest) };
        History { samples, first: surplus.max(expired), own: writing.filter(|_| own > 0), oldest }
    }

    #[inline]
    fn own(&self) -> impl DoubleEndedIterator<Item = &'a AnySample> + use<'a> {
        let oldest = self.oldest;
        let own = self.own.into_iter().flat_map(|writing| writing.visible());
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

    /// The last one published at `moment` or before.
    pub(crate) fn not_newer(&self, moment: Moment) -> Option<&'a AnySample> {
        self.last_before(until(self.samples, moment), moment)
    }

    /// The first one published at `moment` or after.
    pub(crate) fn not_older(&self, moment: Moment) -> Option<&'a AnySample> {
        self.first_from(before(self.samples, moment), moment)
    }

    /// The one published nearest to `moment`; of two equally near the earlier.
    #[inline]
    pub(crate) fn nearest(&self, moment: Moment) -> Option<&'a AnySample> {
        // What was published at the moment itself comes before `later`, so the first from there on is late enough.
        let later = until(self.samples, moment);
        let (before, after) = (self.last_before(later, moment), self.first_from(later, moment));
        let (Some(one), Some(other)) = (before, after) else { return before.or(after) };
        let distance = |sample: &AnySample| sample.header.local.distance(moment);
        if distance(other) < distance(one) { after } else { before }
    }

    /// Of the delivered ones in front of `place` and the own ones, the last one published at `moment` or before.
    #[inline]
    fn last_before(&self, place: usize, moment: Moment) -> Option<&'a AnySample> {
        let delivered = if place > self.first { self.samples.get(place - 1) } else { None };
        if self.own.is_none() {
            return delivered;
        }
        let own = self.own().rfind(|sample| sample.header.local <= moment);
        [delivered, own].into_iter().flatten().max_by_key(|sample| sample.header.local)
    }

    /// Of the delivered ones from `place` on and the own ones, the first one published at `moment` or after.
    #[inline]
    fn first_from(&self, place: usize, moment: Moment) -> Option<&'a AnySample> {
        let delivered = self.samples.get(place.max(self.first));
        if self.own.is_none() {
            return delivered;
        }
        let own = self.own().find(|sample| sample.header.local >= moment);
        [delivered, own].into_iter().flatten().min_by_key(|sample| sample.header.local)
    }

    /// The two between which `moment` lies; none if it lies outside of the history.
    pub(crate) fn around<M: 'static>(&self, moment: Moment) -> Option<Neighbours<'a, M>> {
        let before = self.not_newer(moment)?;
        let after = if before.header.local == moment { before } else { self.not_older(moment)? };
        let whole = after.header.local.since(before.header.local).as_nanos();
        let part = moment.since(before.header.local).as_nanos();
        let share = if whole == 0 { 0.0 } else { part as f64 / whole as f64 };
        Some(Neighbours { before: before.downcast()?, after: after.downcast()?, share })
    }
}

/// How many of the samples, which are sorted by time, were published before `moment`.
fn before(samples: &VecDeque<AnySample>, moment: Moment) -> usize {
    match moment.as_nanos().checked_sub(1) {
        Some(nanos) => until(samples, Moment::from_nanos(nanos)),
        None => 0,
    }
}

/// How many of the samples, which are sorted by time, were published at `moment` or before.
///
/// Most histories are of sensors, with equal times between messages: so the search begins where the moment would then be, and goes
/// from there in growing steps. At worst that takes twice the steps of a binary search.
fn until(samples: &VecDeque<AnySample>, moment: Moment) -> usize {
    let is_early = |place: usize| samples[place].header.local <= moment;
    let guess = guess(samples, moment);
    // In the end what comes before `low` is early, and what comes from `high` on is not.
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

/// Where `moment` is if the samples are equally far apart.
fn guess(samples: &VecDeque<AnySample>, moment: Moment) -> usize {
    let (Some(first), Some(last)) = (samples.front(), samples.back()) else { return 0 };
    let (first, last) = (first.header.local.as_nanos(), last.header.local.as_nanos());
    let (part, whole) = (moment.as_nanos().saturating_sub(first), last - first);
    if part >= whole {
        return samples.len() - 1;
    }
    (part as f64 / whole as f64 * (samples.len() - 1) as f64) as usize
}
