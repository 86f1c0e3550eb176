//! The blackboards of a chart's regions: resident ones, those on loan to activities, and the values
//! shown during a loan.
//!
//! An activity owns its region's blackboard while it is called, so its values do not change and no
//! lock is needed. Guards are evaluated during a loan too, to decide whether an event is held: they
//! see the values from the time of the loan. Messages are shared, so this costs one reference per
//! topic that guards read.
//!
//! A chart that does not wait for activities (statechart dialects in which exiting a state
//! interrupts its activity) continues with a region whose blackboard is still on loan. The region
//! then gets a new one; the old one, with everything that the activity wrote on it, is dropped on
//! its return.

use narukom::{AnySample, Blackboard, Cancellation, Hub, Timestamp, TopicSlot};
use yase::expression::MessageSource;
use yase::{Activation, CompiledChart, ScopeId};

use super::ChartContext;
use super::delivery_log::DeliveryLog;
use super::source_subscriptions::SourceSubscriptions;
use crate::error::Error;
use crate::records::Delivery;
use crate::seeds::component_seed;

/// The blackboards of a chart.
pub(crate) struct RegionBlackboards {
    hub: Hub,
    agent: String,
    /// The part of its agent under which the chart publishes.
    part: u16,
    seed: u64,
    /// The topics that guards read, sorted.
    read: Box<[TopicSlot]>,
    regions: Vec<RegionEntry>,
    pub(crate) delivery_log: DeliveryLog,
    /// Whether the chart has replaced another.
    was_swapped: bool,
}

struct RegionEntry {
    /// The path of the chart, from which the seeds of its random numbers are derived.
    path: String,
    /// Number of blackboards created so far.
    created: u32,
    /// `None` while it is on loan to an activity.
    resident: Option<Box<Blackboard>>,
    loan: Option<BlackboardLoan>,
    /// During a loan: the newest message of each topic that guards read.
    shown: Box<[Option<AnySample>]>,
    subscriptions: SourceSubscriptions,
}

/// The activation that holds a blackboard.
struct BlackboardLoan {
    activation: Activation,
    cancellation: Cancellation,
}

impl RegionBlackboards {
    /// # Errors
    /// The chart reads more hosts than a hub can number.
    pub(crate) fn new(chart: &CompiledChart, home: ChartContext<'_>) -> Result<RegionBlackboards, Error> {
        let read: Box<[TopicSlot]> = chart.reads().iter().map(|topic| TopicSlot::new(topic.0)).collect();
        let regions = chart.regions().map(|region| {
            let node = chart.region_node(region);
            let node = node.map(|node| chart.statechart().path(node)).unwrap_or_default();
            let path = format!("{}/{node}", home.path());
            let following = SourceSubscriptions::new(chart, home.hub)?;
            let shown = vec![None; read.len()].into();
            Ok(RegionEntry { path, created: 0, resident: None, loan: None, shown, subscriptions: following })
        });
        let regions = regions.collect::<Result<_, Error>>()?;
        let mut lending = RegionBlackboards {
            hub: home.hub.clone(),
            agent: home.agent.into(),
            part: home.part(),
            seed: home.seed,
            read,
            regions,
            delivery_log: DeliveryLog::default(),
            was_swapped: false,
        };
        (0..lending.regions.len()).for_each(|index| lending.create_blackboard(index));
        Ok(lending)
    }

    /// Takes over the blackboards of a chart that this one replaces; `regions` maps old regions to
    /// new ones, and `known` maps activations.
    pub(crate) fn take_over(
        &mut self,
        old: RegionBlackboards,
        regions: &[(ScopeId, ScopeId)],
        known: impl Fn(Activation) -> Option<Activation>,
    ) {
        self.was_swapped = true;
        self.delivery_log = old.delivery_log;
        let mut left: Vec<Option<RegionEntry>> = old.regions.into_iter().map(Some).collect();
        for (from, to) in regions {
            let before = left.get_mut(from.0 as usize).and_then(Option::take);
            let (Some(before), Some(region)) = (before, self.regions.get_mut(to.0 as usize)) else {
                continue;
            };
            region.path = before.path;
            region.created = before.created;
            region.subscriptions.take_over(before.subscriptions);
            let sample = |topic| before.shown[old.read.binary_search(topic).ok()?].clone();
            region.shown = self.read.iter().map(sample).collect();
            region.loan = before.loan.and_then(|loan| {
                known(loan.activation).map(|activation| BlackboardLoan { activation, ..loan })
            });
            // A blackboard on loan returns later, unless its activation no longer exists.
            if before.resident.is_some() || region.loan.is_some() {
                region.resident = before.resident;
            }
            if let Some(here) = &mut region.resident {
                self.read.iter().for_each(|topic| here.interest(*topic));
            }
        }
    }

    pub(crate) fn part(&self) -> u16 {
        self.part
    }

    /// The lowest position of a resident blackboard.
    pub(crate) fn position(&self) -> u64 {
        let resident = self.regions.iter().filter_map(|region| region.resident.as_ref());
        resident.map(|blackboard| blackboard.position()).min().unwrap_or_default()
    }

    /// Makes all blackboards show these topics too.
    pub(crate) fn add_read_topics(&mut self, topics: &[TopicSlot]) {
        let mut read: Vec<TopicSlot> = self.read.iter().chain(topics).copied().collect();
        read.sort_unstable();
        read.dedup();
        for region in &mut self.regions {
            let shown = |topic| region.shown[self.read.binary_search(topic).ok()?].clone();
            region.shown = read.iter().map(shown).collect();
            if let Some(here) = &region.resident {
                topics.iter().for_each(|topic| here.interest(*topic));
            }
        }
        self.read = read.into();
    }

    /// Gives a region a new blackboard.
    fn create_blackboard(&mut self, index: usize) {
        let region = &mut self.regions[index];
        let mut blackboard = self.hub.blackboard(&self.agent).of_part(self.part);
        let seed = match region.created {
            0 => component_seed(self.seed, &region.path),
            more => component_seed(self.seed, &format!("{}#{more}", region.path)),
        };
        blackboard.set_random(seed);
        // Topics that guards read are delivered and recorded from the first step on.
        self.read.iter().for_each(|topic| blackboard.interest(*topic));
        region.created += 1;
        region.resident = Some(Box::new(blackboard));
    }

    /// A region's blackboard, unless it is on loan.
    pub(crate) fn resident(&self, region: ScopeId) -> Option<&Blackboard> {
        self.regions.get(region.0 as usize)?.resident.as_deref()
    }

    /// A region's blackboard for changes. A loan to an activity is void from now on.
    pub(crate) fn reclaim_mut(&mut self, region: ScopeId, now: Timestamp) -> Option<&mut Blackboard> {
        let index = region.0 as usize;
        if self.regions.get(index)?.resident.is_none() {
            self.replace(index, now);
        }
        self.regions[index].resident.as_deref_mut()
    }

    /// Replaces a blackboard on loan. The new one starts with the states and histories published by
    /// now.
    fn replace(&mut self, index: usize, now: Timestamp) {
        if let Some(loan) = self.regions[index].loan.take() {
            loan.cancellation.request();
        }
        self.regions[index].shown.fill(None);
        // It does not receive signals from before its creation, so its creation counts as a fetch.
        self.delivery_log.begin();
        self.create_blackboard(index);
        self.regions[index]
            .resident
            .iter()
            .for_each(|blackboard| self.delivery_log.end(blackboard.position()));
        self.fetch(index, now);
    }

    /// Delivers what has arrived to a resident blackboard.
    fn fetch(&mut self, index: usize, now: Timestamp) {
        if let Some(blackboard) = &mut self.regions[index].resident {
            self.delivery_log.begin();
            blackboard.process_messages(now);
            self.delivery_log.end(blackboard.position());
        }
    }

    /// Copies the values of one region to another.
    pub(crate) fn inherit(&mut self, region: ScopeId, from: ScopeId, now: Timestamp) {
        self.reclaim_mut(region, now);
        self.reclaim_mut(from, now);
        let indices = [region.0 as usize, from.0 as usize];
        let Ok([inner, outer]) = self.regions.get_disjoint_mut(indices) else { return };
        inner.subscriptions.adopt(&outer.subscriptions);
        if let (Some(inner), Some(outer)) = (&mut inner.resident, &outer.resident) {
            inner.adopt(outer);
        }
    }

    /// Delivers what has arrived to a region's blackboard and returns it.
    pub(crate) fn deliver(&mut self, region: ScopeId, now: Timestamp) -> Option<&Blackboard> {
        self.reclaim_mut(region, now)?;
        let index = region.0 as usize;
        self.regions[index].subscriptions.deliver(&self.hub, &mut self.delivery_log);
        self.fetch(index, now);
        self.regions[index].resident.as_deref()
    }

    /// Delivers what has arrived to a region's blackboard, for an activity that is called again.
    pub(crate) fn refresh(&mut self, region: ScopeId, now: Timestamp) -> Option<()> {
        self.reclaim_mut(region, now)?.cancellation().withdraw();
        self.fetch(region.0 as usize, now);
        Some(())
    }

    /// Publishes what was written on a region's blackboard.
    pub(crate) fn publish_all(&mut self, region: ScopeId, now: Timestamp) {
        if self.reclaim_mut(region, now).is_none_or(|blackboard| !blackboard.has_unpublished()) {
            return;
        }
        self.delivery_log.publishing();
        self.regions[region.0 as usize]
            .resident
            .iter_mut()
            .for_each(|blackboard| blackboard.publish_all(now));
    }

    /// The last deliveries to a region from named hosts and publishers.
    pub(crate) fn source_deliveries(&self, region: ScopeId) -> impl Iterator<Item = Delivery> {
        let following = self.regions.get(region.0 as usize).map(|region| &region.subscriptions);
        following.into_iter().flat_map(move |following| following.fresh_deliveries(region.0))
    }

    /// The newest message of a source that guards read.
    pub(crate) fn newest_of(
        &self,
        region: ScopeId,
        source: &MessageSource,
        now: Timestamp,
    ) -> Option<&AnySample> {
        let shown = self.newest(region, TopicSlot::new(source.topic.0));
        let following = &self.regions.get(region.0 as usize)?.subscriptions;
        following.newest(source, shown, now, &self.hub).unwrap_or(shown)
    }

    /// The newest message of a topic that guards read: on the resident blackboard, or as of the
    /// loan.
    fn newest(&self, region: ScopeId, topic: TopicSlot) -> Option<&AnySample> {
        let region = self.regions.get(region.0 as usize)?;
        match &region.resident {
            Some(blackboard) => blackboard.latest_sample(topic),
            None => region.shown[self.read.binary_search(&topic).ok()?].as_ref(),
        }
    }

    /// The messages that a region's blackboard shows, for inspection: of all topics that it has
    /// subscribed to, or as of the loan of those that guards read; then those of named sources.
    pub(crate) fn visible(&self, region: ScopeId) -> Vec<&AnySample> {
        let Some(region) = self.regions.get(region.0 as usize) else { return Vec::new() };
        let mut samples: Vec<&AnySample> = match &region.resident {
            Some(blackboard) => {
                blackboard.topics_read().into_iter().filter_map(|topic| blackboard.shown(topic)).collect()
            }
            None => region.shown.iter().flatten().collect(),
        };
        samples.extend(region.subscriptions.newest_of_all());
        samples
    }

    /// Whether the blackboard of a region is on loan to an activity.
    pub(crate) fn is_lent(&self, region: ScopeId) -> bool {
        self.regions.get(region.0 as usize).is_some_and(|region| region.resident.is_none())
    }

    /// Lends the blackboard of its region to an activity.
    pub(crate) fn lend_blackboard(
        &mut self,
        activation: Activation,
        now: Timestamp,
    ) -> Option<Box<Blackboard>> {
        self.reclaim_mut(activation.region, now)?;
        let region = &mut self.regions[activation.region.0 as usize];
        let blackboard = region.resident.take()?;
        for (shown, topic) in region.shown.iter_mut().zip(&self.read) {
            *shown = blackboard.shown(*topic).cloned();
        }
        region.loan = Some(BlackboardLoan { activation, cancellation: blackboard.cancellation().clone() });
        Some(blackboard)
    }

    /// Takes a blackboard back from an activity and returns its present location; `None` if the
    /// region has another one by now, or if its content must be dropped.
    pub(crate) fn take_back(
        &mut self,
        activation: Activation,
        blackboard: Box<Blackboard>,
        of_use: bool,
    ) -> Option<&mut Blackboard> {
        let region = self.regions.get_mut(activation.region.0 as usize)?;
        region.loan.take_if(|loan| loan.activation == activation)?;
        region.shown.fill(None);
        region.resident = of_use.then_some(blackboard);
        if let Some(here) = region.resident.as_deref().filter(|_| self.was_swapped) {
            // It may lack topics that the guards of the new chart read.
            self.read.iter().for_each(|topic| here.interest(*topic));
        }
        region.resident.as_deref_mut()
    }

    /// Requests that the present or next holder of a region's blackboard return soon.
    pub(crate) fn cancel(&self, region: ScopeId) {
        let Some(region) = self.regions.get(region.0 as usize) else { return };
        match (&region.loan, &region.resident) {
            (Some(loan), _) => loan.cancellation.request(),
            (None, Some(blackboard)) => blackboard.cancellation().request(),
            (None, None) => {}
        }
    }

    /// Requests that all holders of blackboards return soon.
    pub(crate) fn cancel_all(&self) {
        let loans = self.regions.iter().filter_map(|region| region.loan.as_ref());
        loans.for_each(|loan| loan.cancellation.request());
    }

    pub(crate) fn seed(&self) -> u64 {
        self.seed
    }

    /// The hub of all blackboards.
    #[cfg(test)]
    fn hub(&self) -> &Hub {
        &self.hub
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::binder::Binder;
    use crate::listener::ListenerSet;
    use crate::records::{self, HOST};
    use crate::registry::Registry;
    use yase::{Semantics, Source};

    const NOW: Timestamp = Timestamp::ZERO;

    /// The blackboards of a chart with one region, whose guard reads the name of the host.
    fn lending() -> (RegionBlackboards, Activation, TopicSlot) {
        let registry = Registry::empty().with("A", || |_: &mut Blackboard| {});
        let text = "Liveness:\nm = A . A\nTransitions:\nA -> A : [host.team == 3]";
        let (chart, diagnostics) = aseme_models::statechart_of(&Source::new("m.srm", text));
        assert_eq!(diagnostics, []);
        let chart =
            Binder::new(&registry).unwrap().bind(&chart, None, Semantics::yase(), None).unwrap().chart;
        let hub = Hub::with_linked_topics("local").unwrap();
        let listeners = ListenerSet::default();
        let home =
            ChartContext { hub: &hub, agent: "m", number: 0, seed: 1, listeners: &listeners, now: NOW };
        let lending = RegionBlackboards::new(&chart, home).unwrap();
        let entry = chart.activities().next().unwrap();
        let activation = Activation { node: entry.node, region: entry.region, number: 1 };
        (lending, activation, hub.topic("monas/host").unwrap())
    }

    fn publish(lending: &RegionBlackboards, team: u32) {
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
        lending.reclaim_mut(activation.region, NOW).unwrap().process_messages(NOW);
        let mut lent = lending.lend_blackboard(activation, NOW).unwrap();
        assert!(lending.resident(activation.region).is_none());
        publish(&lending, 2);
        lent.process_messages(NOW);
        assert_eq!(team(lending.newest(activation.region, topic)), Some(1));
        assert!(lending.take_back(activation, lent, true).is_some());
        assert_eq!(team(lending.newest(activation.region, topic)), Some(2));
    }

    #[test]
    fn a_region_whose_blackboard_is_lent_gets_another_one() {
        let (mut lending, activation, topic) = lending();
        let late = lending.lend_blackboard(activation, NOW).unwrap();
        publish(&lending, 3);
        assert!(lending.reclaim_mut(activation.region, NOW).is_some());
        assert!(late.is_cancelled(), "the holder of the old one may return");
        assert_eq!(team(lending.newest(activation.region, topic)), Some(3), "what was published is known");
        let next = Activation { number: 2, ..activation };
        let lent = lending.lend_blackboard(next, NOW).unwrap();
        assert!(lending.take_back(activation, late, true).is_none(), "it is not the one that was lent last");
        assert!(!lent.is_cancelled());
        assert!(lending.take_back(next, lent, true).is_some());
    }

    #[test]
    fn a_blackboard_that_is_of_no_use_any_more_does_not_come_back() {
        let (mut lending, activation, _) = lending();
        let mut late = lending.lend_blackboard(activation, NOW).unwrap();
        late.publish(HOST, records::Host { team: 7, ..records::Host::default() }).unwrap();
        assert!(lending.take_back(activation, late, false).is_none());
        lending.reclaim_mut(activation.region, NOW).unwrap().publish_all(NOW);
        let topic = lending.hub().topic("monas/host").unwrap();
        assert_eq!(team(lending.newest(activation.region, topic)), None, "what was written there is gone");
    }

    #[test]
    fn the_borrower_of_a_blackboard_is_cancelled() {
        let (mut lending, activation, _) = lending();
        lending.cancel(activation.region);
        let lent = lending.lend_blackboard(activation, NOW).unwrap();
        assert!(lent.is_cancelled());
        lent.cancellation().withdraw();
        lending.cancel(activation.region);
        assert!(lent.is_cancelled());
    }
}
