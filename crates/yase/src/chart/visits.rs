//! In which order states are looked at, where JOINs ask for another than that of the places.
//!
//! A JOIN that takes its sources together is one of the ways of its first source, but it may only be taken if nothing inside any of its
//! sources can step: so what lies in the others is looked at before the first. The others stand behind the first, and so does
//! whatever must be looked at before what is in them: the order has no circles.

use crate::chart::{Join, Layout, Place};
use crate::semantics::{Eventless, Joining, Semantics};

/// The order; none if it is that of the places.
pub(super) fn order(layout: &Layout, joins: &[Join], semantics: &Semantics) -> Option<Box<[Place]>> {
    let is_together = semantics.join == Joining::Together && semantics.eventless != Eventless::Once;
    let mut before: Vec<(Place, Place)> =
        joins.iter().filter(|_| is_together).flat_map(|join| hurried(layout, join)).collect();
    if before.is_empty() {
        return None;
    }
    before.sort_by_key(|&(first, _)| first); // those of one place stay in their order
    Some(Order { layout, before: &before, visited: vec![false; layout.len()] }.all())
}

/// The first source of a JOIN, with each of the others that has something inside.
fn hurried<'a>(layout: &'a Layout, join: &'a Join) -> impl Iterator<Item = (Place, Place)> + 'a {
    let first = join.sources.iter().copied().min();
    let others = join.sources.iter().copied().filter(move |&source| Some(source) != first);
    others.filter(|&source| layout.first(source) < source).filter_map(move |source| Some((first?, source)))
}

struct Order<'a> {
    layout: &'a Layout,
    /// What is looked at before a place: what lies in another.
    before: &'a [(Place, Place)],
    visited: Vec<bool>,
}

/// A row of places of which the next is to be looked at, and at which it ends.
type Row = (u32, u32);

impl Order<'_> {
    /// Places stand behind what is inside them, so that only JOINs make one wait. Those that wait are on a stack of their own.
    fn all(mut self) -> Box<[Place]> {
        let mut order = Vec::with_capacity(self.layout.len());
        let mut open: Vec<Row> = vec![(0, self.layout.len() as u32)];
        while let Some((next, end)) = open.pop() {
            if next == end {
                continue;
            }
            let place = Place(next);
            let waits = if self.visited[place.index()] { &[] } else { self.waits_for(place) };
            let unseen = |&&(_, other): &&(Place, Place)| !self.visited[other.index() - 1];
            if let Some(&(_, other)) = waits.iter().find(unseen) {
                open.push((next, end));
                open.push((self.layout.first(other).0, other.0));
                continue;
            }
            open.push((next + 1, end));
            if !std::mem::replace(&mut self.visited[place.index()], true) {
                order.push(place);
            }
        }
        order.into()
    }

    fn waits_for(&self, place: Place) -> &[(Place, Place)] {
        let start = self.before.partition_point(|&(first, _)| first < place);
        let end = self.before.partition_point(|&(first, _)| first <= place);
        &self.before[start..end]
    }
}
