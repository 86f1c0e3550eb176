//! The replay of a recording of real time.
//!
//! There it was chance when a thread ran, so records of cycles tell what it found when it did: at which moment, which messages had been
//! published by then, which activities had come back. Each agent repeats its turns on a hub of its own, to which the messages of all
//! others come from the recording, each before the agent's own message that followed it then.

use std::sync::Arc;

use narukom::prost::Message as _;
use narukom::{Arrival, Moment, Narukom, TopicSlot};

use super::super::crew::part;
use super::super::links::Brought;
use super::super::setup::{Stage, Station};
use super::super::{HostConfig, REAL_TIME_SEED, Talws};
use super::changes::{added, concerning, is_of_module, unread};
use super::compare::{Ledger, Window};
use super::feed::{Ear, Feed, Foreign, Inlet};
use super::ordered::{Ordered, Thread};
use super::repeated::Repeated;
use super::{Company, Difference, Recorded, RecordedMessage, Tally, no_input};
use crate::agent::Profile;
use crate::chart::Lead as _;
use crate::error::{Error, ErrorKind};
use crate::records::{Action, CHANGE, CHANGED, CYCLE, Change, Changed, Cycle, HOST, STATISTICS, Turn};
use crate::registry::Registry;

/// Agents that repeat their turns.
pub(super) struct RealTime {
    /// The hosts that were recorded, and how many messages of the hub of each have come.
    hubs: Vec<(String, u64)>,
    registry: Registry,
    parts: Vec<Part>,
    inputs: Vec<Entrance>,
    ledger: Ledger,
}

/// Where the messages of one publisher on one topic go.
struct Entrance {
    /// The place of the hub that was recorded.
    hub: usize,
    /// The agents of its host, and what the messages are to them.
    routes: Vec<(usize, Route)>,
    /// Whether they are changes of agents, or tell of them.
    about: About,
    publisher: String,
}

/// What messages say of changes of agents.
#[derive(Clone, Copy, PartialEq, Eq)]
enum About {
    Nothing,
    Asked,
    Made,
}

#[derive(Clone, Copy)]
enum Route {
    /// What the agent is compared with.
    Own { topic: Option<TopicSlot>, line: usize, is_cycle: bool },
    /// What it is given, through an inlet of this number.
    Other(usize),
}

/// A thread of an agent: its list, or one of its charts.
struct Part {
    host: String,
    agent: String,
    thread: Thread,
    hub: Narukom,
    /// The topics that links bring to the host as its own: what is published there under the agent's name comes from another process.
    brought: Vec<TopicSlot>,
    repeated: Repeated,
    ordered: Ordered,
    ear: Ear,
    feed: Feed,
    window: Window,
    /// What the agent has published since the last turn.
    own: Vec<Own>,
    /// The cycle of a list that has begun.
    begun: Option<Cycle>,
    /// The numbers of the steps that have been told since the last turn.
    numbers: Vec<u64>,
    /// The recording tells of the agent's turns.
    is_told: bool,
    has_diverged: bool,
    /// The agent was removed.
    is_gone: bool,
}

/// A message that the agent published when it was recorded.
struct Own {
    position: u64,
    topic: Option<TopicSlot>,
    line: usize,
    bytes: Vec<u8>,
}

impl RealTime {
    pub(super) fn new(talws: Talws, company: &[Company]) -> Result<RealTime, Error> {
        let Talws { registry, hosts, .. } = talws;
        let mut parts = Vec::new();
        for HostConfig { name, team, number, agents, links, modules, .. } in hosts {
            for agent in agents {
                let (profile, charts) = (Profile::of(&agent), agent.charts.len());
                let has_list = !agent.activities.is_empty();
                let is_it = |one: &&Company| one.host == name && one.publisher == profile.name;
                let begins_list = company.iter().find(is_it).is_some_and(|one| one.last_part >= part(charts));
                let (threads, lists) = (agent.apart(begins_list), has_list || begins_list);
                if threads.is_empty() {
                    return Err(nothing_to_run(&profile.name));
                }
                for (place, agent) in threads {
                    let (name, links, modules) = (name.clone(), links.clone(), modules.clone());
                    let agents = vec![agent];
                    let mut alone = Talws { registry: registry.clone(), ..Talws::new() };
                    alone.company = company.to_vec();
                    let links_and_agents =
                        HostConfig { name, team, number, agents, links, modules, ..HostConfig::default() };
                    alone.host(links_and_agents);
                    parts.push(Part::new(alone, profile.clone(), Thread { place, charts, has_list, lists })?);
                }
            }
        }
        let registry = registry.unwrap_or_else(Registry::linked);
        Ok(RealTime { hubs: Vec::new(), registry, parts, inputs: Vec::new(), ledger: Ledger::default() })
    }

    /// The hosts.
    pub(super) fn hosts(&self) -> Vec<&str> {
        let mut hosts: Vec<&str> = self.parts.iter().map(|part| part.host.as_str()).collect();
        hosts.dedup();
        hosts
    }

    pub(super) fn input(&mut self, recorded: Recorded<'_>) -> Result<usize, Error> {
        let hub = self.hub(recorded.received_by.unwrap_or(recorded.host));
        let mut routes = Vec::new();
        for (place, part) in self.parts.iter().enumerate() {
            if let Some(route) = part.route(recorded, &mut self.ledger)? {
                routes.push((place, route));
            }
        }
        let about = match recorded.topic {
            _ if recorded.received_by.is_some() => About::Nothing,
            topic if topic == CHANGE.path() => About::Asked,
            topic if topic == CHANGED.path() => About::Made,
            _ => About::Nothing,
        };
        self.inputs.push(Entrance { hub, routes, about, publisher: recorded.publisher.to_owned() });
        Ok(self.inputs.len() - 1)
    }

    /// The place of a hub that was recorded.
    fn hub(&mut self, host: &str) -> usize {
        self.hubs.iter().position(|(name, _)| name == host).unwrap_or_else(|| {
            self.hubs.push((host.to_owned(), 0));
            self.hubs.len() - 1
        })
    }

    pub(super) fn feed(
        &mut self,
        input: usize,
        message: RecordedMessage<'_>,
        told: &mut dyn FnMut(Difference),
    ) -> Result<(), Error> {
        let Entrance { hub, about, .. } = self.inputs.get(input).ok_or_else(no_input)?;
        let (hub, about) = (*hub, *about);
        self.heed(input, about, &message, told)?;
        let Entrance { routes, .. } = &self.inputs[input];
        let count = &mut self.hubs[hub].1;
        *count += 1;
        let position = *count;
        let mut shared: Option<Arc<[u8]>> = None;
        for (place, route) in routes {
            let part = &mut self.parts[*place];
            match *route {
                Route::Own { topic, line, is_cycle } => {
                    let bytes = message.bytes.to_vec();
                    let own = Own { position, topic, line, bytes };
                    part.published(own, is_cycle, &mut self.ledger, told)?;
                }
                Route::Other(inlet) => {
                    let bytes = shared.get_or_insert_with(|| message.bytes.into()).clone();
                    part.feed.add(Foreign { position, inlet, arrival: arrival(&message), bytes });
                    if part.waits() {
                        part.feed.pass(position);
                    }
                }
            }
        }
        Ok(())
    }

    /// Takes note of changes of the agents that are replayed.
    fn heed(
        &mut self,
        input: usize,
        about: About,
        message: &RecordedMessage<'_>,
        told: &mut dyn FnMut(Difference),
    ) -> Result<(), Error> {
        let Entrance { hub, publisher, .. } = &self.inputs[input];
        let host = &self.hubs[*hub].0;
        let mut parts = self.parts.iter_mut().filter(|part| part.host == *host);
        match about {
            About::Nothing => Ok(()),
            About::Asked => {
                let change = Change::decode(message.bytes).map_err(unread)?;
                if is_of_module(change.action()) {
                    for part in parts {
                        let own = concerning(&change, |agent| agent == part.agent);
                        own.into_iter().for_each(|own| part.ordered.ask(publisher, message.sequence, own));
                    }
                    return Ok(());
                }
                let mut is_known = false;
                for part in parts.filter(|part| part.agent == change.agent) {
                    part.ordered.ask(publisher, message.sequence, change.clone());
                    is_known = true;
                }
                if is_known {
                    return Ok(());
                }
                let names = added(&change, &self.registry);
                for part in self.parts.iter_mut().filter(|part| part.host == *host) {
                    if names.contains(&part.agent) {
                        part.ordered.ask(publisher, message.sequence, change.clone());
                    }
                }
                Ok(())
            }
            About::Made => {
                let changed = Changed::decode(message.bytes).map_err(unread)?;
                if is_of_module(changed.action()) {
                    return parts.try_for_each(|part| part.equip(&changed, message.received));
                }
                if changed.done && changed.action() == Action::AddAgents {
                    return parts.try_for_each(|part| part.came_back(&changed, message.received));
                }
                for part in parts.filter(|part| part.agent == changed.agent) {
                    if changed.done && changed.action() == Action::RemoveAgent {
                        part.left(&mut self.ledger, told)?;
                    }
                    part.ordered.answered(&changed, &mut part.repeated, message.received)?;
                }
                Ok(())
            }
        }
    }

    pub(super) fn finish(
        mut self,
        is_whole: bool,
        told: &mut dyn FnMut(Difference),
    ) -> Result<Vec<Tally>, Error> {
        for part in &mut self.parts {
            part.finish(is_whole, &mut self.ledger, told)?;
        }
        Ok(self.ledger.tallies())
    }
}

fn arrival(message: &RecordedMessage<'_>) -> Arrival {
    Arrival {
        sequence: message.sequence.into(),
        published: message.published,
        local: message.published,
        received: message.received,
    }
}

impl Part {
    /// What one thread runs of the one agent of a host, which is made of all that its profile says, with a hub of its own.
    fn new(mut talws: Talws, profile: Profile, thread: Thread) -> Result<Part, Error> {
        let agent = profile.name.clone();
        let ear = Ear::new(&agent, thread.part());
        talws.observe(Box::new(ear.clone()));
        let Stage { mut stations, crew, .. } = Stage::new(talws, REAL_TIME_SEED)?;
        let Some(Station { hub, mut members, links, ground, .. }) = stations.pop() else {
            return Err(nothing_to_run(&agent));
        };
        let host = hub.host().to_owned();
        let brought = Brought::by(&links, &hub)?.own;
        let feed = Feed::new(ear.clone());
        let member = members.pop().ok_or_else(|| nothing_to_run(&agent))?;
        let repeated = Repeated::new(member, &feed)?.ok_or_else(|| nothing_to_run(&agent))?;
        let ordered = Ordered::new(ground, crew, profile, thread)?;
        let window = Window::new(&host, &agent);
        let (own, begun, numbers) = (Vec::new(), None, Vec::new());
        Ok(Part {
            host,
            agent,
            thread,
            hub,
            brought,
            repeated,
            ordered,
            ear,
            feed,
            window,
            own,
            begun,
            numbers,
            is_told: false,
            has_diverged: false,
            is_gone: false,
        })
    }

    /// What the messages of a publisher on a topic are to this agent.
    fn route(&self, recorded: Recorded<'_>, ledger: &mut Ledger) -> Result<Option<Route>, Error> {
        let Recorded { host, received_by, publisher, part, topic } = recorded;
        if received_by.unwrap_or(host) != self.host {
            return Ok(None);
        }
        let slot = self.hub.topic(topic);
        let is_brought = slot.is_some_and(|slot| self.brought.contains(&slot));
        let is_own = publisher == self.agent && part == self.thread.part();
        if received_by.is_none() && is_own && !is_brought {
            let (line, is_cycle) = (ledger.line(host, publisher, topic), topic == CYCLE.path());
            return Ok(Some(Route::Own { topic: slot, line, is_cycle }));
        }
        // The host has introduced itself here too.
        if slot.is_none() || (topic == HOST.path() && publisher == "monas") {
            return Ok(None);
        }
        let inlet = match received_by {
            Some(_) => self.hub.receiver(host, publisher, topic).map(Inlet::Received),
            None => {
                let inlet = self.hub.publisher_by_name(topic, publisher);
                inlet.map(|inlet| Inlet::Published(inlet.of_part(part)))
            }
        };
        Ok(Some(Route::Other(self.feed.add_inlet(inlet.map_err(Error::hub)?))))
    }

    /// The agent published this.
    fn published(
        &mut self,
        own: Own,
        is_cycle: bool,
        ledger: &mut Ledger,
        told: &mut dyn FnMut(Difference),
    ) -> Result<(), Error> {
        if !is_cycle {
            self.own.push(own);
            return Ok(());
        }
        let record = Cycle::decode(&own.bytes[..]).map_err(|error| {
            let message = format!("a record of a cycle of `{}` cannot be read: {error}", self.agent);
            Error::new(ErrorKind::Invalid, message)
        })?;
        if record.seen.iter().any(|seen| *seen >= own.position) {
            let message = format!("the recording lacks messages of `{}`", self.host);
            let hint =
                "agents are given what they were given then: only a recording of all topics can be replayed";
            return Err(Error::new(ErrorKind::Invalid, message).with_hint(hint));
        }
        if !self.is_of_thread(&record) {
            return Err(self.untold());
        }
        match (&self.repeated, record.turn()) {
            (_, Turn::Ordered) => self.follow(&record, ledger, told)?,
            (_, Turn::None | Turn::Start) if self.is_gone => return Err(came_back_untold(&self.agent)),
            (Repeated::Chart(_), Turn::None) if self.is_told => {
                self.numbers.push(record.number);
                self.own.push(own);
            }
            (Repeated::Chart(_), Turn::None) | (Repeated::Waiting(_), _) => return Err(self.untold()),
            (Repeated::List(_), Turn::None) if record.seen.is_empty() => return Err(self.untold()),
            (Repeated::List(_), Turn::None) => {
                self.run_begun(true, ledger, told)?;
                self.ordered.begin_turn()?;
                self.own.push(Own { bytes: plain(&record), ..own });
                self.begun = Some(record);
            }
            (Repeated::List(_), _) => {}
            (Repeated::Chart(chart), Turn::Start) if self.is_told && !chart.begins_anew() => {
                return Err(self.untold());
            }
            (Repeated::Chart(_), turn) => {
                self.is_told |= turn == Turn::Start;
                if turn == Turn::Round {
                    self.ordered.begin_turn()?;
                }
                self.run(turn, &record, true, ledger, told)?;
            }
        }
        Ok(())
    }

    /// Earlier versions recorded all threads of an agent alike.
    fn is_of_thread(&self, record: &Cycle) -> bool {
        match (self.thread.place, record.turn()) {
            (Some(_), Turn::None) => record.seen.is_empty(),
            (Some(place), _) => record.chart as usize == place,
            (None, _) => true,
        }
    }

    /// The agent was told to follow a change here. What it publishes by that is compared with its next turn.
    fn follow(
        &mut self,
        record: &Cycle,
        ledger: &mut Ledger,
        told: &mut dyn FnMut(Difference),
    ) -> Result<(), Error> {
        self.run_begun(true, ledger, told)?;
        self.run_unrecorded(Moment::from_nanos(record.time), ledger, told)?;
        self.feed.begin(&record.seen, std::iter::empty());
        self.feed.fetching();
        let (change, now) = (self.ordered.ordered_by(record)?, Moment::from_nanos(record.time));
        match change.action() {
            Action::AddAgents => self.come_back(&change, now)?,
            _ => self.ordered.follow(&change, &mut self.repeated, now)?,
        }
        self.feed.failure()
    }

    /// The agent was removed: its last cycle is known.
    fn left(&mut self, ledger: &mut Ledger, told: &mut dyn FnMut(Difference)) -> Result<(), Error> {
        self.run_begun(true, ledger, told)?;
        self.is_gone = true;
        self.ordered.left(&self.agent);
        Ok(())
    }

    /// Agents were added: if this one is among them, and its thread was not told, it has no list.
    fn came_back(&mut self, changed: &Changed, now: Moment) -> Result<(), Error> {
        let Some(change) = self.ordered.change_of(changed).filter(|_| self.is_gone) else { return Ok(()) };
        self.come_back(&change, now)?;
        match &self.repeated {
            Repeated::Waiting(_) => Ok(()),
            _ => Err(came_back_untold(&self.agent)),
        }
    }

    /// Whether it is a list that has not begun, and nothing is about to change that.
    fn waits(&self) -> bool {
        matches!(self.repeated, Repeated::Waiting(_)) && self.ordered.is_idle()
    }

    /// The agent, which had left, was added anew.
    fn come_back(&mut self, change: &Change, now: Moment) -> Result<(), Error> {
        let member = self.ordered.anew(change, &self.agent, &mut self.repeated, now)?;
        self.repeated = Repeated::new(member, &self.feed)?.ok_or_else(|| nothing_to_run(&self.agent))?;
        (self.is_told, self.is_gone) = (false, false);
        Ok(())
    }

    /// A module came, went or was exchanged. If the agent was told so it has followed; if not it knows the names now.
    fn equip(&mut self, changed: &Changed, at: Moment) -> Result<(), Error> {
        if changed.agent == self.agent {
            self.ordered.answered(changed, &mut self.repeated, at)?;
        }
        self.ordered.equip(changed, &mut self.repeated, at)
    }

    fn untold(&self) -> Error {
        let message = format!(
            "the recording does not tell what each turn of `{}` was given: it was made by an earlier version",
            self.agent
        );
        Error::new(ErrorKind::Invalid, message)
    }

    /// Repeats the cycle of the list that has begun, of which everything is known by now.
    fn run_begun(
        &mut self,
        is_whole: bool,
        ledger: &mut Ledger,
        told: &mut dyn FnMut(Difference),
    ) -> Result<(), Error> {
        match self.begun.take() {
            Some(record) => self.run(Turn::None, &record, is_whole, ledger, told),
            None => Ok(()),
        }
    }

    /// Repeats a turn and compares.
    fn run(
        &mut self,
        turn: Turn,
        record: &Cycle,
        is_whole: bool,
        ledger: &mut Ledger,
        told: &mut dyn FnMut(Difference),
    ) -> Result<(), Error> {
        self.run_unrecorded(Moment::from_nanos(record.time), ledger, told)?;
        self.feed.begin(&record.seen, self.own.iter().map(|own| own.position));
        let now = Moment::from_nanos(record.time);
        let numbers = std::mem::take(&mut self.numbers);
        if self.thread.counts_with_others() {
            let own = (turn == Turn::None).then_some(record.number);
            self.repeated.number_by(own.into_iter().chain(numbers));
        }
        match &mut self.repeated {
            Repeated::Waiting(_) => {}
            Repeated::List(list) => list.cycle(now),
            Repeated::Chart(chart) => chart.turn(turn, record, self.has_diverged),
        }
        self.feed.failure()?;
        self.compare(now, is_whole, ledger, told);
        Ok(())
    }

    /// What a chart that is not what it was does between its recorded turns.
    fn run_unrecorded(
        &mut self,
        until: Moment,
        ledger: &mut Ledger,
        told: &mut dyn FnMut(Difference),
    ) -> Result<(), Error> {
        let recorded = std::mem::take(&mut self.own);
        while let Repeated::Chart(chart) = &mut self.repeated
            && let Some(due) = chart.due_before(until)
        {
            self.feed.begin_unrecorded(due);
            chart.turn_by_itself(due);
            self.feed.failure()?;
            self.compare(due, true, ledger, told);
        }
        self.own = recorded;
        Ok(())
    }

    fn compare(
        &mut self,
        now: Moment,
        is_whole: bool,
        ledger: &mut Ledger,
        told: &mut dyn FnMut(Difference),
    ) {
        // What was measured then is not measured again.
        let measured = self.hub.topic(STATISTICS.path());
        for Own { topic, line, bytes, .. } in self.own.drain(..) {
            if topic.is_some() && topic == measured {
                continue;
            }
            self.window.recorded(topic, line, bytes);
        }
        for produced in self.ear.take() {
            self.window.produced(produced.topic, produced.bytes);
        }
        if !is_whole {
            self.window.forget_what_is_ahead();
        }
        let has_diverged = &mut self.has_diverged;
        self.window.compare(&self.hub, now, ledger, &mut |difference| {
            *has_diverged = true;
            told(difference);
        });
    }

    /// There are no more recorded messages.
    fn finish(
        &mut self,
        is_whole: bool,
        ledger: &mut Ledger,
        told: &mut dyn FnMut(Difference),
    ) -> Result<(), Error> {
        let last = self.begun.as_ref().map(|record| Moment::from_nanos(record.time));
        self.run_begun(is_whole, ledger, told)?;
        // Of a turn whose record was cut off nobody knows what it began with.
        if is_whole {
            self.compare(last.unwrap_or_default(), is_whole, ledger, told);
        }
        Ok(())
    }
}

fn came_back_untold(agent: &str) -> Error {
    let message = format!(
        "agent `{agent}` was removed and added anew: the recording, of an earlier version, does not tell by which change"
    );
    Error::new(ErrorKind::Invalid, message).with_hint("replay other agents, or the time before")
}

fn nothing_to_run(agent: &str) -> Error {
    let message = format!(
        "agent `{agent}` has neither charts nor activities when the run begins: there is nothing to repeat"
    );
    Error::new(ErrorKind::Invalid, message).with_hint("replay other agents")
}

/// The record as it is without what is recorded in real time only.
fn plain(record: &Cycle) -> Vec<u8> {
    let Cycle { number, time, delivered, .. } = record.clone();
    Cycle { number, time, delivered, ..Cycle::default() }.encode_to_vec()
}
