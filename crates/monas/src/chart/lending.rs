//! The blackboards of a chart's regions: which are here, which are lent to activities, and what those show meanwhile.
//!
//! An activity owns its region's blackboard while it is called, so nothing moves on it and nobody waits for it. Guards are read
//! all the same, to see whether an event is one to be held: they see what the blackboard showed when it was lent. Messages are shared,
//! so that is a reference for each topic that guards read.
//!
//! A chart that does not wait for activities (statechart dialects in which leaving a state interrupts its activity) goes on with a
//! region whose blackboard is still away. It gets another one then; the old one, and whatever the activity wrote on it, is dropped
//! when it comes back.

use narukom::{AnySample, Blackboard, Cancellation, Moment, Narukom, TopicSlot};
use yase::expression::MessageSource;
use yase::{Activation, Chart, RegionId};

use super::Home;
use super::fetching::Fetching;
use super::following::Following;
use crate::error::Error;
use crate::records::Delivery;
use crate::talws::component_seed;

/// The blackboards of a chart.
pub(super) struct Lending {
    hub: Narukom,
    agent: String,
    /// As which part of its agent the chart publishes.
    part: u16,
    seed: u64,
    /// The topics that guards read, in order.
    read: Box<[TopicSlot]>,
    regions: Vec<Region>,
    pub(super) fetching: Fetching,
    /// Whether the chart has taken the place of another.
    was_swapped: bool,
}

struct Region {
    /// Where it is, for its random numbers.
    path: String,
    /// How many blackboards it has had.
    made: u32,
    /// None while an activity has it.
    here: Option<Box<Blackboard>>,
    loan: Option<Loan>,
    /// While it is lent: the newest message of each topic that guards read.
    shown: Box<[Option<AnySample>]>,
    following: Following,
}

/// To whom a blackboard is lent.
struct Loan {
    activation: Activation,
    cancellation: Cancellation,
}

impl Lending {
    /// # Errors
    /// The chart reads more hosts than a hub tells apart.
    pub(super) fn new(chart: &Chart, home: Home<'_>) -> Result<Lending, Error> {
        let read: Box<[TopicSlot]> = chart.reads().iter().map(|topic| TopicSlot::new(topic.0)).collect();
        let regions = chart.regions().map(|region| {
            let node = chart.region_node(region);
            let node = node.map(|node| chart.statechart().path(node)).unwrap_or_default();
            let path = format!("{}/{node}", home.path());
            let following = Following::new(chart, home.hub)?;
            let shown = vec![None; read.len()].into();
            Ok(Region { path, made: 0, here: None, loan: None, shown, following })
        });
        let regions = regions.collect::<Result<_, Error>>()?;
        let mut lending = Lending {
            hub: home.hub.clone(),
            agent: home.agent.into(),
            part: home.part(),
            seed: home.seed,
            read,
            regions,
            fetching: Fetching::default(),
            was_swapped: false,
        };
        (0..lending.regions.len()).for_each(|place| lending.furnish(place));
        Ok(lending)
    }

    /// Takes over from a chart that this one replaces: what its regions had, by `regions` from old to new; `known` says what became of an
    /// activation.
    pub(super) fn take_over(
        &mut self,
        old: Lending,
        regions: &[(RegionId, RegionId)],
        known: impl Fn(Activation) -> Option<Activation>,
    ) {
        self.was_swapped = true;
        self.fetching = old.fetching;
        let mut left: Vec<Option<Region>> = old.regions.into_iter().map(Some).collect();
        for (from, to) in regions {
            let before = left.get_mut(from.0 as usize).and_then(Option::take);
            let (Some(before), Some(region)) = (before, self.regions.get_mut(to.0 as usize)) else {
                continue;
            };
            region.path = before.path;
            region.made = before.made;
            region.following.take_over(before.following);
            let sample = |topic| before.shown[old.read.binary_search(topic).ok()?].clone();
            region.shown = self.read.iter().map(sample).collect();
            region.loan = before
                .loan
                .and_then(|loan| known(loan.activation).map(|activation| Loan { activation, ..loan }));
            // One that is away comes back, unless nobody waits for it.
            if before.here.is_some() || region.loan.is_some() {
                region.here = before.here;
            }
            if let Some(here) = &mut region.here {
                self.read.iter().for_each(|topic| here.interest(*topic));
            }
        }
    }

    pub(super) fn part(&self) -> u16 {
        self.part
    }

    /// Has all blackboards show these topics too.
    pub(super) fn read_too(&mut self, topics: &[TopicSlot]) {
        let mut read: Vec<TopicSlot> = self.read.iter().chain(topics).copied().collect();
        read.sort_unstable();
        read.dedup();
        for region in &mut self.regions {
            let shown = |topic| region.shown[self.read.binary_search(topic).ok()?].clone();
            region.shown = read.iter().map(shown).collect();
            if let Some(here) = &region.here {
                topics.iter().for_each(|topic| here.interest(*topic));
            }
        }
        self.read = read.into();
    }

    /// Gives a region a new blackboard.
    fn furnish(&mut self, place: usize) {
        let region = &mut self.regions[place];
        let mut blackboard = self.hub.blackboard(&self.agent).of_part(self.part);
        let seed = match region.made {
            0 => component_seed(self.seed, &region.path),
            more => component_seed(self.seed, &format!("{}#{more}", region.path)),
        };
        blackboard.set_random(seed);
        // What guards read is delivered, and recorded, from the first step on.
        self.read.iter().for_each(|topic| blackboard.interest(*topic));
        region.made += 1;
        region.here = Some(Box::new(blackboard));
    }

    /// A region's blackboard, if it is here.
    pub(super) fn here(&self, region: RegionId) -> Option<&Blackboard> {
        self.regions.get(region.0 as usize)?.here.as_deref()
    }

    /// A region's blackboard, for one who may change it: no activity that has it matters any more.
    pub(super) fn free_mut(&mut self, region: RegionId, now: Moment) -> Option<&mut Blackboard> {
        let place = region.0 as usize;
        if self.regions.get(place)?.here.is_none() {
            self.replace(place, now);
        }
        self.regions[place].here.as_deref_mut()
    }

    /// The new blackboard knows the states and histories that were published by now.
    fn replace(&mut self, place: usize, now: Moment) {
        if let Some(loan) = self.regions[place].loan.take() {
            loan.cancellation.request();
        }
        self.regions[place].shown.fill(None);
        // It is no reader of the signals from before its time, so that counts as a fetch too.
        self.fetching.begin();
        self.furnish(place);
        self.regions[place].here.iter().for_each(|blackboard| self.fetching.end(blackboard.position()));
        self.fetch(place, now);
    }

    /// Delivers what arrived to a blackboard that is here.
    fn fetch(&mut self, place: usize, now: Moment) {
        if let Some(blackboard) = &mut self.regions[place].here {
            self.fetching.begin();
            blackboard.process_messages(now);
            self.fetching.end(blackboard.position());
        }
    }

    /// A region takes over the values of another.
    pub(super) fn inherit(&mut self, region: RegionId, from: RegionId, now: Moment) {
        self.free_mut(region, now);
        self.free_mut(from, now);
        let places = [region.0 as usize, from.0 as usize];
        let Ok([inner, outer]) = self.regions.get_disjoint_mut(places) else { return };
        inner.following.adopt(&outer.following);
        if let (Some(inner), Some(outer)) = (&mut inner.here, &outer.here) {
            inner.adopt(outer);
        }
    }

    /// What arrived is delivered to a region's blackboard, which is given.
    pub(super) fn deliver(&mut self, region: RegionId, now: Moment) -> Option<&Blackboard> {
        self.free_mut(region, now)?;
        let place = region.0 as usize;
        self.regions[place].following.deliver(&self.hub, &mut self.fetching);
        self.fetch(place, now);
        self.regions[place].here.as_deref()
    }

    /// What arrived is delivered to a region's blackboard, for an activity that is called again.
    pub(super) fn refresh(&mut self, region: RegionId, now: Moment) -> Option<()> {
        self.free_mut(region, now)?.cancellation().withdraw();
        self.fetch(region.0 as usize, now);
        Some(())
    }

    /// Publishes what was written on a region's blackboard.
    pub(super) fn publish_all(&mut self, region: RegionId, now: Moment) {
        if self.free_mut(region, now).is_none_or(|blackboard| !blackboard.has_unpublished()) {
            return;
        }
        self.fetching.publishing();
        self.regions[region.0 as usize].here.iter_mut().for_each(|blackboard| blackboard.publish_all(now));
    }

    /// What the last delivery brought to a region of certain hosts and publishers.
    pub(super) fn followed(&self, region: RegionId) -> impl Iterator<Item = Delivery> {
        let following = self.regions.get(region.0 as usize).map(|region| &region.following);
        following.into_iter().flat_map(move |following| following.fresh(region.0))
    }

    /// The newest message of a source that guards read.
    pub(super) fn newest_of(
        &self,
        region: RegionId,
        source: &MessageSource,
        now: Moment,
    ) -> Option<&AnySample> {
        let shown = self.newest(region, TopicSlot::new(source.topic.0));
        let following = &self.regions.get(region.0 as usize)?.following;
        following.newest(source, shown, now, &self.hub).unwrap_or(shown)
    }

    /// The newest message of a topic that guards read: of the blackboard if it is here, else of when it was lent.
    fn newest(&self, region: RegionId, topic: TopicSlot) -> Option<&AnySample> {
        let region = self.regions.get(region.0 as usize)?;
        match &region.here {
            Some(blackboard) => blackboard.latest_sample(topic),
            None => region.shown[self.read.binary_search(&topic).ok()?].as_ref(),
        }
    }

    /// Hands the blackboard of its region to an activity.
    pub(super) fn lend(&mut self, activation: Activation, now: Moment) -> Option<Box<Blackboard>> {
        self.free_mut(activation.region, now)?;
        let region = &mut self.regions[activation.region.0 as usize];
        let blackboard = region.here.take()?;
        for (shown, topic) in region.shown.iter_mut().zip(&self.read) {
            *shown = blackboard.shown(*topic).cloned();
        }
        region.loan = Some(Loan { activation, cancellation: blackboard.cancellation().clone() });
        Some(blackboard)
    }

    /// Takes a blackboard back from an activity, and says where it is now; none if the region has another by now, or if it is of no more
    /// use, being full of what nobody is to know.
    pub(super) fn take_back(
        &mut self,
        activation: Activation,
        blackboard: Box<Blackboard>,
        of_use: bool,
    ) -> Option<&mut Blackboard> {
        let region = self.regions.get_mut(activation.region.0 as usize)?;
        region.loan.take_if(|loan| loan.activation == activation)?;
        region.shown.fill(None);
        region.here = of_use.then_some(blackboard);
        if let Some(here) = region.here.as_deref().filter(|_| self.was_swapped) {
            // It may not know yet what the guards of another chart read.
            self.read.iter().for_each(|topic| here.interest(*topic));
        }
        region.here.as_deref_mut()
    }

    /// Asks whoever has a region's blackboard, or is to get it next, to return soon.
    pub(super) fn cancel(&self, region: RegionId) {
        let Some(region) = self.regions.get(region.0 as usize) else { return };
        match (&region.loan, &region.here) {
            (Some(loan), _) => loan.cancellation.request(),
            (None, Some(blackboard)) => blackboard.cancellation().request(),
            (None, None) => {}
        }
    }

    /// Asks all who have a blackboard to return soon.
    pub(super) fn cancel_all(&self) {
        let loans = self.regions.iter().filter_map(|region| region.loan.as_ref());
        loans.for_each(|loan| loan.cancellation.request());
    }

    pub(super) fn seed(&self) -> u64 {
        self.seed
    }

    /// The hub that all blackboards are of.
    #[cfg(test)]
    fn hub(&self) -> &Narukom {
        &self.hub
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::binder::Binder;
    use crate::listener::Listeners;
    use crate::records::{self, HOST};
    use crate::registry::Registry;
    use yase::{Semantics, Source};

    const NOW: Moment = Moment::ZERO;

    /// The blackboards of a chart with one region, whose guard reads the name of the host.
    fn lending() -> (Lending, Activation, TopicSlot) {
        let registry = Registry::empty().with("A", || |_: &mut Blackboard| {});
        let text = "Liveness:\nm = A . A\nTransitions:\nA -> A : [host.team == 3]";
        let (chart, diagnostics) = aseme::statechart_of(&Source::new("m.srm", text));
        assert_eq!(diagnostics, []);
        let chart = Binder::new(&registry).unwrap().bind(&chart, Semantics::yase(), None).unwrap().chart;
        let hub = Narukom::with_linked_topics("local").unwrap();
        let listeners = Listeners::default();
        let home = Home { hub: &hub, agent: "m", number: 0, seed: 1, listeners: &listeners, now: NOW };
        let lending = Lending::new(&chart, home).unwrap();
        let entry = chart.activities().next().unwrap();
        let activation = Activation { node: entry.node, region: entry.region, number: 1 };
        (lending, activation, hub.topic("monas/host").unwrap())
    }

    fn publish(lending: &Lending, team: u32) {
        let publisher = lending.hub().publisher(HOST, "test");
        publisher.unwrap().publish(records::Host { team, ..records::Host::default() }, NOW);
    }

    fn team(sample: Option<&AnySample>) -> Option<u32> {
        Some(sample?.downcast::<records::Host>()?.team)
    }

    #[test]
    fn a_lent_blackboard_shows_what_it_showed() {
        let (mut lending, activation, topic) = lending();
        publish(&lending, 1);
        lending.free_mut(activation.region, NOW).unwrap().process_messages(NOW);
        let mut lent = lending.lend(activation, NOW).unwrap();
        assert!(lending.here(activation.region).is_none());
        publish(&lending, 2);
        lent.process_messages(NOW);
        assert_eq!(team(lending.newest(activation.region, topic)), Some(1));
        assert!(lending.take_back(activation, lent, true).is_some());
        assert_eq!(team(lending.newest(activation.region, topic)), Some(2));
    }

    #[test]
    fn a_region_that_goes_on_without_its_blackboard_gets_another_and_the_old_one_is_dropped() {
        let (mut lending, activation, topic) = lending();
        let late = lending.lend(activation, NOW).unwrap();
        publish(&lending, 3);
        assert!(lending.free_mut(activation.region, NOW).is_some());
        assert!(late.is_cancelled(), "whoever has the old one may as well return");
        assert_eq!(team(lending.newest(activation.region, topic)), Some(3), "what was published is known");
        let next = Activation { number: 2, ..activation };
        let lent = lending.lend(next, NOW).unwrap();
        assert!(lending.take_back(activation, late, true).is_none(), "it is not the one that was lent last");
        assert!(!lent.is_cancelled());
        assert!(lending.take_back(next, lent, true).is_some());
    }

    #[test]
    fn a_blackboard_that_is_of_no_use_any_more_does_not_come_back() {
        let (mut lending, activation, _) = lending();
        let mut late = lending.lend(activation, NOW).unwrap();
        late.publish(HOST, records::Host { team: 7, ..records::Host::default() }).unwrap();
        assert!(lending.take_back(activation, late, false).is_none());
        lending.free_mut(activation.region, NOW).unwrap().publish_all(NOW);
        let topic = lending.hub().topic("monas/host").unwrap();
        assert_eq!(team(lending.newest(activation.region, topic)), None, "what was written there is gone");
    }

    #[test]
    fn whoever_has_the_blackboard_or_gets_it_next_is_asked_to_return() {
        let (mut lending, activation, _) = lending();
        lending.cancel(activation.region);
        let lent = lending.lend(activation, NOW).unwrap();
        assert!(lent.is_cancelled());
        lent.cancellation().withdraw();
        lending.cancel(activation.region);
        assert!(lent.is_cancelled());
    }
}
