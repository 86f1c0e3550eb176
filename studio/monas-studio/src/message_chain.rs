//! The causal chain of a message, back to the readings of sensors.

use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use monas::Registry;
use monas::records::{Cycle, Delivery};
use narukom::topic_hash;
use prost::Message;
use serde::Serialize;
use yase::{NodeId, ScopeId, Statechart};

use crate::chart_history::ChartHistory;
use crate::chart_view::seconds;
use crate::read_value::ReadMoment;
use crate::run_view::CYCLE_TOPIC;
use crate::tape_run::{TapeChannel, TapeChart, TapeRun};

/// The most messages of a chain.
const MAX_LINKS: usize = 60;

/// The topics of bodies' radios: what is sent and what is received, in their field `words`.
const SAID_TOPIC: &str = "body/said";
const HEARD_TOPIC: &str = "body/heard";

/// A message that was read, the messages that its publisher had read last before, and so on.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct MessageChain {
    /// The messages: each is followed by those that were read for it, one level deeper.
    pub links: Vec<ChainLink>,
}

/// A message of a chain.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct ChainLink {
    /// The number of messages between it and the first.
    pub depth: usize,
    /// The host that published it.
    pub host: String,
    /// Its publisher.
    pub publisher: String,
    /// The activity that published it, if the publisher has a chart.
    pub activity: Option<String>,
    /// Its topic.
    pub topic: String,
    /// Its number among those of its publisher.
    pub sequence: u64,
    /// When it was published, s.
    pub published: f64,
    /// Why the chain ends here, if it does.
    pub end: Option<String>,
}

/// An activity of a chart that has published a message.
struct Publisher<'a> {
    name: &'a str,
    scope: ScopeId,
    /// The topics that it reads and does not publish.
    reads: Vec<u64>,
}

/// The chains of a tape, with what is known of its agents.
pub(crate) struct ChainFinder<'a> {
    tape: &'a TapeRun,
    registry: Registry,
    histories: BTreeMap<usize, ChartHistory>,
    /// By host and agent: the positions and contents of its cycles.
    cycles: BTreeMap<(String, String), Vec<(usize, Cycle)>>,
}

impl<'a> ChainFinder<'a> {
    pub(crate) fn new(tape: &'a TapeRun) -> ChainFinder<'a> {
        let (histories, cycles) = Default::default();
        ChainFinder { tape, registry: Registry::linked(), histories, cycles }
    }

    /// The chain of a message: each message once, the newest of all.
    pub(crate) fn chain(&mut self, message: usize) -> MessageChain {
        let mut found: Vec<(ChainLink, Vec<usize>)> = Vec::new();
        let mut seen = BTreeSet::from([message]);
        // Messages with their depths and the links that lead to them, the newest on top.
        let mut next = BinaryHeap::from([(message, 0, None)]);
        while let Some((message, depth, from)) = next.pop() {
            let Some((entry, channel)) = self.tape.entry(message) else { continue };
            let publisher = self.publisher(message);
            let (before, mut end) = self.before(message, publisher.as_ref());
            let own = found.len();
            for one in before {
                if seen.len() < MAX_LINKS && seen.insert(one) {
                    next.push((one, depth + 1, Some(own)));
                } else if !seen.contains(&one) {
                    end = Some(format!("no more than {MAX_LINKS} messages are followed"));
                }
            }
            let link = ChainLink {
                depth,
                host: channel.host.clone(),
                publisher: channel.publisher.clone(),
                activity: publisher.map(|publisher| publisher.name.to_owned()),
                topic: channel.topic.clone(),
                sequence: entry.sequence.into(),
                published: seconds(entry.time),
                end,
            };
            found.push((link, Vec::new()));
            if let Some((_, following)) = from.and_then(|from: usize| found.get_mut(from)) {
                following.push(own);
            }
        }
        let (mut links, mut stack) = (Vec::with_capacity(found.len()), vec![0]);
        while let Some((link, following)) = stack.pop().and_then(|own| found.get(own)) {
            links.push(link.clone());
            stack.extend(following.iter().rev());
        }
        MessageChain { links }
    }

    /// The messages before a message, or why there are none.
    fn before(&mut self, message: usize, publisher: Option<&Publisher<'_>>) -> (Vec<usize>, Option<String>) {
        let Some((_, channel)) = self.tape.entry(message) else { return (Vec::new(), None) };
        let ends = |reason: String| (Vec::new(), Some(reason));
        if channel.topic == HEARD_TOPIC {
            return match self.said(message) {
                Some(said) => (vec![said], None),
                None => ends("no robot of the tape has said these words over the radio before".into()),
            };
        }
        let is_cycle = |other: &TapeChannel| {
            other.topic == CYCLE_TOPIC && other.host == channel.host && other.publisher == channel.publisher
        };
        if !self.tape.channels().iter().any(is_cycle) {
            return ends(format!("`{}` is not an agent: the message comes from outside", channel.publisher));
        }
        let own: Vec<u64> = self
            .tape
            .channels()
            .iter()
            .filter(|other| other.host == channel.host && other.publisher == channel.publisher)
            .map(|other| topic_hash(&other.topic))
            .collect();
        let found = match publisher {
            Some(Publisher { scope, reads, .. }) => self.delivered(message, *scope, |delivery| {
                reads.contains(&delivery.topic)
                    && (delivery.region == scope.0 || delivery.region == ScopeId::ROOT.0)
            }),
            None => self.delivered(message, ScopeId::ROOT, |delivery| !own.contains(&delivery.topic)),
        };
        match found.is_empty() {
            true => ends(format!("`{}` had read no message before", channel.publisher)),
            false => (found, None),
        }
    }

    /// The activity that published a message: of those that publish on its topic the one whose
    /// state was entered last.
    fn publisher(&mut self, message: usize) -> Option<Publisher<'a>> {
        let tape = self.tape;
        let (_, channel) = tape.entry(message)?;
        let mut found: Option<(usize, Publisher<'a>)> = None;
        for (number, chart) in tape.charts().iter().enumerate() {
            if chart.host != channel.host || chart.agent != channel.publisher {
                continue;
            }
            let history = self.histories.entry(number).or_insert_with(|| tape.history(chart));
            let (steps, scopes) = (history.until(message), chart.statechart.scopes());
            for (node, name) in activities(&chart.statechart) {
                let Ok(activity) = self.registry.activity(name) else { continue };
                let topics = activity.topics();
                if !topics.published_paths().contains(&channel.topic.as_str()) {
                    continue;
                }
                let Some(entered) = steps.iter().rposition(|one| one.step.entries.contains(&node.0)) else {
                    continue;
                };
                if found.as_ref().is_none_or(|(known, _)| *known < entered) {
                    let own = topics.published_paths();
                    let read = topics.read_paths().iter().filter(|path| !own.contains(path));
                    let scope = scopes.get(node.0 as usize).copied().unwrap_or(ScopeId::ROOT);
                    let reads = read.map(|path| topic_hash(path)).collect();
                    found = Some((entered, Publisher { name, scope, reads }));
                }
            }
        }
        found.map(|(_, publisher)| publisher)
    }

    /// For each requested topic, the newest message that the agent of a message had before it;
    /// newest first.
    fn delivered(
        &mut self,
        message: usize,
        scope: ScopeId,
        is_wanted: impl Fn(&Delivery) -> bool,
    ) -> Vec<usize> {
        let tape = self.tape;
        let Some((entry, channel)) = tape.entry(message) else { return Vec::new() };
        let agent = TapeChart {
            host: channel.host.clone(),
            agent: channel.publisher.clone(),
            chart: 0,
            model: String::new(),
            statechart: Statechart::new(""),
        };
        let moment =
            ReadMoment { chart: &agent, scope, count: message, is_step: true, time: entry.time, steps: &[] };
        let key = (agent.host.clone(), agent.agent.clone());
        let cycles = self.cycles.entry(key).or_insert_with(|| tape.all_cycles(&agent));
        // The cycle in which it was published is recorded after it.
        let index = cycles.partition_point(|(index, _)| *index < message);
        let before = &cycles[..(index + 1).min(cycles.len())];
        let mut newest: BTreeMap<(u64, &str), usize> = BTreeMap::new();
        for (_, cycle) in before.iter().rev() {
            for delivery in cycle.delivered.iter().filter(|delivery| is_wanted(delivery)) {
                let key = (delivery.topic, delivery.host.as_str());
                if newest.contains_key(&key) {
                    continue;
                }
                let topic =
                    tape.channels().iter().find(|channel| topic_hash(&channel.topic) == delivery.topic);
                let found =
                    topic.and_then(|topic| tape.message(&agent.host, &topic.topic, delivery, &moment));
                if let Some(found) = found.filter(|found| *found < message) {
                    newest.insert(key, found);
                }
            }
        }
        let mut newest: Vec<usize> = newest.into_values().collect();
        newest.sort_unstable_by(|a, b| b.cmp(a));
        newest
    }

    /// The radio message of another robot with the content of a received one.
    fn said(&self, heard: usize) -> Option<usize> {
        let tape = self.tape;
        let (entry, channel) = tape.entry(heard)?;
        let words = tape.decoder().decode(HEARD_TOPIC, tape.bytes(entry)).get("words")?.clone();
        (0..heard).rev().find(|index| {
            tape.entry(*index).is_some_and(|(said, of)| {
                of.topic == SAID_TOPIC
                    && of.host != channel.host
                    && tape.decoder().decode(SAID_TOPIC, tape.bytes(said)).get("words") == Some(&words)
            })
        })
    }
}

impl TapeRun {
    fn all_cycles(&self, agent: &TapeChart) -> Vec<(usize, Cycle)> {
        let cycle = |index: usize| {
            let (entry, channel) = self.entry(index)?;
            let is_own = channel.topic == CYCLE_TOPIC
                && channel.host == agent.host
                && channel.publisher == agent.agent;
            let cycle = is_own.then(|| Cycle::decode(self.bytes(entry)).ok()).flatten()?;
            Some((index, cycle))
        };
        (0..self.len()).filter_map(cycle).collect()
    }
}

fn activities(chart: &Statechart) -> impl Iterator<Item = (NodeId, &str)> {
    chart.nodes().filter_map(|(node, state)| Some((node, state.activity.as_deref()?)))
}
