//! The messages of a topic, by time.

use std::collections::vec_deque;

use crate::moment::Moment;
use crate::reading::Reading;
use crate::sample::AnySample;
use crate::writing::Writing;

/// The messages that a blackboard has of a topic: first the delivered ones, sorted by time of publication, then its own
/// that have not come back yet.
pub(crate) struct History<'a> {
    delivered: vec_deque::Iter<'a, AnySample>,
    own: Option<&'a Writing>,
}

impl<'a> History<'a> {
    /// The last `depth` messages.
    pub(crate) fn new(reading: &'a Reading, writing: Option<&'a Writing>, depth: usize) -> History<'a> {
        let samples = reading.samples();
        let own = writing.map_or(0, |writing| writing.visible().count());
        let surplus = (samples.len() + own).saturating_sub(depth).min(samples.len());
        History { delivered: samples.range(surplus..), own: writing }
    }

    fn own(&self) -> impl DoubleEndedIterator<Item = &'a AnySample> + use<'a> {
        self.own.into_iter().flat_map(|writing| writing.visible())
    }

    /// All, oldest first.
    pub(crate) fn iter(self) -> impl DoubleEndedIterator<Item = &'a AnySample> + use<'a> {
        let own = self.own();
        self.delivered.chain(own)
    }

    /// The last one published at `moment` or before.
    pub(crate) fn not_newer(&self, moment: Moment) -> Option<&'a AnySample> {
        let own = self.own().rfind(|sample| sample.header.published <= moment);
        let count = self.later_than(|published| published <= moment);
        let delivered = count.checked_sub(1).and_then(|last| self.delivered.clone().nth(last));
        [delivered, own].into_iter().flatten().max_by_key(|sample| sample.header.published)
    }

    /// The first one published at `moment` or after.
    pub(crate) fn not_older(&self, moment: Moment) -> Option<&'a AnySample> {
        let own = self.own().find(|sample| sample.header.published >= moment);
        let count = self.later_than(|published| published < moment);
        let delivered = self.delivered.clone().nth(count);
        [delivered, own].into_iter().flatten().min_by_key(|sample| sample.header.published)
    }

    /// How many of the delivered ones come before the first of which `before` does not hold.
    fn later_than(&self, before: impl Fn(Moment) -> bool) -> usize {
        let (mut low, mut high) = (0, self.delivered.len());
        while low < high {
            let middle = low + (high - low) / 2;
            match self.delivered.clone().nth(middle) {
                Some(sample) if before(sample.header.published) => low = middle + 1,
                _ => high = middle,
            }
        }
        low
    }
}

/// The one of two that was published nearer to `moment`; the first if both are equally near.
pub(crate) fn nearer<'a>(
    first: Option<&'a AnySample>,
    second: Option<&'a AnySample>,
    moment: Moment,
) -> Option<&'a AnySample> {
    let distance = |sample: &&AnySample| sample.header.published.distance(moment);
    [first, second].into_iter().flatten().min_by_key(distance)
}
