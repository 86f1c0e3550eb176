//! The replay of a recording of real time.
//!
//! The interleaving of threads varies in real time, so records of cycles contain the inputs of each
//! turn: its time, the number of publications by then, and the activities that had returned. Each
//! agent repeats its turns on a separate hub, which receives the messages of all others from the
//! recording, each before the agent's own message that followed it.

use std::sync::Arc;

use narukom::prost::Message as _;
use narukom::{Hub, RemoteHeader, Timestamp, TopicSlot};

use super::super::agent_factory::part;
use super::super::links::LinkedTopics;
use super::super::run_config::{HostConfig, RunConfig};
use super::super::setup::{PreparedHost, PreparedRun};
use super::comparison::{ComparisonReport, MomentComparison};
use super::recorded_changes::{RecordedChanges, ThreadPosition};
use super::recorded_inputs::{ExternalMessage, InputEndpoint, OwnOutputTap, RecordedInputs};
use super::replayed_agents::{added, concerning, is_of_module, unread};
use super::replayed_thread::ReplayedThread;
use super::{
    ComparisonCounts, RecordedMessage, RecordedPublisher, RecordedStream, ReplayDifference, no_input,
};
use crate::run_config::REAL_TIME_SEED;
use monas_core::agent::AgentProfile;
use monas_core::chart_runner::ReplayGuide as _;
use monas_core::error::{Error, ErrorKind};
use monas_core::records::{Action, CHANGE, CHANGED, CYCLE, Change, Changed, Cycle, HOST, STATISTICS, Turn};
use monas_core::registry::Registry;

/// Agents that repeat their turns.
pub(crate) struct RealTimeReplay {
    /// The recorded hosts, each with the number of messages of its hub so far.
    hubs: Vec<(String, u64)>,
    registry: Registry,
    parts: Vec<ThreadReplay>,
    inputs: Vec<InputRoute>,
    report: ComparisonReport,
}

/// The destinations of the messages of one publisher on one topic.
struct InputRoute {
    /// Index of the recorded hub.
    hub: usize,
    /// The agents of its host, each with the route of the messages.
    routes: Vec<(usize, RealTimeRoute)>,
    /// Whether they request changes of agents, or are replies.
    change_role: ChangeRole,
    publisher: String,
}

/// The role of messages in changes of agents.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ChangeRole {
    Unrelated,
    Request,
    Reply,
}

#[derive(Clone, Copy)]
enum RealTimeRoute {
    /// Compared with the agent's publications.
    Own { topic: Option<TopicSlot>, line: usize, is_cycle: bool },
    /// Delivered to the agent, through the endpoint of this number.
    Other(usize),
}

/// A thread of an agent: its list, or one of its charts.
struct ThreadReplay {
    host: String,
    agent: String,
    thread: ThreadPosition,
    hub: Hub,
    /// The topics that links bring to the host as its own: messages there under the agent's name
    /// come from another process.
    linked_topics: Vec<TopicSlot>,
    thread_replay: ReplayedThread,
    changes: RecordedChanges,
    own_outputs: OwnOutputTap,
    recorded_inputs: RecordedInputs,
    comparison: MomentComparison,
    /// The agent's recorded messages since the last turn.
    own: Vec<OwnMessage>,
    /// The record of a list's cycle that has begun.
    pending_cycle: Option<Cycle>,
    /// The numbers of the steps recorded since the last turn.
    numbers: Vec<u64>,
    /// Whether the recording has records of the agent's turns.
    has_turn_records: bool,
    has_diverged: bool,
    /// Whether the agent was removed.
    is_removed: bool,
}

/// A recorded message of the agent.
struct OwnMessage {
    position: u64,
    topic: Option<TopicSlot>,
    line: usize,
    bytes: Vec<u8>,
}

impl RealTimeReplay {
    pub(crate) fn new(config: RunConfig, publishers: &[RecordedPublisher]) -> Result<RealTimeReplay, Error> {
        let RunConfig { registry, hosts, .. } = config;
        let mut parts = Vec::new();
        for HostConfig { name, team, number, agents, links, modules, .. } in hosts {
            for agent in agents {
                let (profile, charts) = (AgentProfile::of(&agent), agent.charts.len());
                let has_list = !agent.activities.is_empty();
                let is_it = |one: &&RecordedPublisher| one.host == name && one.publisher == profile.name;
                let begins_list =
                    publishers.iter().find(is_it).is_some_and(|one| one.last_part >= part(charts));
                let (threads, lists) = (agent.split_by_thread(begins_list), has_list || begins_list);
                if threads.is_empty() {
                    return Err(nothing_to_run(&profile.name));
                }
                for (index, agent) in threads {
                    let (name, links, modules) = (name.clone(), links.clone(), modules.clone());
                    let agents = vec![agent];
                    let host =
                        HostConfig { name, team, number, agents, links, modules, ..HostConfig::default() };
                    let alone = RunConfig {
                        registry: registry.clone(),
                        hosts: vec![host],
                        publishers: publishers.to_vec(),
                        ..RunConfig::default()
                    };
                    parts.push(ThreadReplay::new(
                        alone,
                        profile.clone(),
                        ThreadPosition { chart: index, charts, has_list, lists },
                    )?);
                }
            }
        }
        let registry = registry.unwrap_or_else(Registry::linked);
        Ok(RealTimeReplay {
            hubs: Vec::new(),
            registry,
            parts,
            inputs: Vec::new(),
            report: ComparisonReport::default(),
        })
    }

    /// The names of the hosts.
    pub(crate) fn hosts(&self) -> Vec<&str> {
        let mut hosts: Vec<&str> = self.parts.iter().map(|part| part.host.as_str()).collect();
        hosts.dedup();
        hosts
    }

    pub(crate) fn input(&mut self, recorded: RecordedStream<'_>) -> Result<usize, Error> {
        let hub = self.hub(recorded.received_by.unwrap_or(recorded.host));
        let mut routes = Vec::new();
        for (index, part) in self.parts.iter().enumerate() {
            if let Some(route) = part.route(recorded, &mut self.report)? {
                routes.push((index, route));
            }
        }
        let about = match recorded.topic {
            _ if recorded.received_by.is_some() => ChangeRole::Unrelated,
            topic if topic == CHANGE.path() => ChangeRole::Request,
            topic if topic == CHANGED.path() => ChangeRole::Reply,
            _ => ChangeRole::Unrelated,
        };
        self.inputs.push(InputRoute {
            hub,
            routes,
            change_role: about,
            publisher: recorded.publisher.to_owned(),
        });
        Ok(self.inputs.len() - 1)
    }

    /// Index of a recorded hub.
    fn hub(&mut self, host: &str) -> usize {
        self.hubs.iter().position(|(name, _)| name == host).unwrap_or_else(|| {
            self.hubs.push((host.to_owned(), 0));
            self.hubs.len() - 1
        })
    }

    pub(crate) fn feed(
        &mut self,
        input: usize,
        message: RecordedMessage<'_>,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> Result<(), Error> {
        let InputRoute { hub, change_role: about, .. } = self.inputs.get(input).ok_or_else(no_input)?;
        let (hub, about) = (*hub, *about);
        self.handle_change_message(input, about, &message, on_difference)?;
        let InputRoute { routes, .. } = &self.inputs[input];
        let count = &mut self.hubs[hub].1;
        *count += 1;
        let position = *count;
        let mut shared: Option<Arc<[u8]>> = None;
        for (index, route) in routes {
            let part = &mut self.parts[*index];
            match *route {
                RealTimeRoute::Own { topic, line, is_cycle } => {
                    let bytes = message.bytes.to_vec();
                    let own = OwnMessage { position, topic, line, bytes };
                    part.published(own, is_cycle, &mut self.report, on_difference)?;
                }
                RealTimeRoute::Other(endpoint) => {
                    let bytes = shared.get_or_insert_with(|| message.bytes.into()).clone();
                    part.recorded_inputs.add(ExternalMessage {
                        position,
                        endpoint,
                        arrival: arrival(&message),
                        bytes,
                    });
                    if part.waits() {
                        part.recorded_inputs.publish_until(position);
                    }
                }
            }
        }
        Ok(())
    }

    /// Processes changes of the replayed agents.
    fn handle_change_message(
        &mut self,
        input: usize,
        about: ChangeRole,
        message: &RecordedMessage<'_>,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> Result<(), Error> {
        let InputRoute { hub, publisher, .. } = &self.inputs[input];
        let host = &self.hubs[*hub].0;
        let mut parts = self.parts.iter_mut().filter(|part| part.host == *host);
        match about {
            ChangeRole::Unrelated => Ok(()),
            ChangeRole::Request => {
                let change = Change::decode(message.bytes).map_err(unread)?;
                if is_of_module(change.action()) {
                    for part in parts {
                        let own = concerning(&change, |agent| agent == part.agent);
                        own.into_iter()
                            .for_each(|own| part.changes.add_request(publisher, message.sequence, own));
                    }
                    return Ok(());
                }
                let mut is_known = false;
                for part in parts.filter(|part| part.agent == change.agent) {
                    part.changes.add_request(publisher, message.sequence, change.clone());
                    is_known = true;
                }
                if is_known {
                    return Ok(());
                }
                let names = added(&change, &self.registry);
                for part in self.parts.iter_mut().filter(|part| part.host == *host) {
                    if names.contains(&part.agent) {
                        part.changes.add_request(publisher, message.sequence, change.clone());
                    }
                }
                Ok(())
            }
            ChangeRole::Reply => {
                let changed = Changed::decode(message.bytes).map_err(unread)?;
                if is_of_module(changed.action()) {
                    return parts.try_for_each(|part| part.update_modules(&changed, message.received));
                }
                if changed.done && changed.action() == Action::AddAgents {
                    return parts.try_for_each(|part| part.handle_restart(&changed, message.received));
                }
                for part in parts.filter(|part| part.agent == changed.agent) {
                    if changed.done && changed.action() == Action::RemoveAgent {
                        part.handle_removal(&mut self.report, on_difference)?;
                    }
                    part.changes.answered(&changed, &mut part.thread_replay, message.received)?;
                }
                Ok(())
            }
        }
    }

    pub(crate) fn finish(
        mut self,
        is_whole: bool,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> Result<Vec<ComparisonCounts>, Error> {
        for part in &mut self.parts {
            part.finish(is_whole, &mut self.report, on_difference)?;
        }
        Ok(self.report.tallies())
    }
}

fn arrival(message: &RecordedMessage<'_>) -> RemoteHeader {
    RemoteHeader {
        sequence: message.sequence.into(),
        published: message.published,
        local: message.published,
        received: message.received,
    }
}

impl ThreadReplay {
    /// The replay of one thread of a host's only agent, built from its profile, with a separate
    /// hub.
    fn new(
        mut config: RunConfig,
        profile: AgentProfile,
        thread: ThreadPosition,
    ) -> Result<ThreadReplay, Error> {
        let agent = profile.name.clone();
        let outputs = OwnOutputTap::new(&agent, thread.part());
        config.observers.push(Box::new(outputs.clone()));
        let PreparedRun { hosts: mut prepared_hosts, factory, .. } =
            PreparedRun::new(config, REAL_TIME_SEED)?;
        let Some(PreparedHost { hub, agents: mut members, links, context: ground, .. }) =
            prepared_hosts.pop()
        else {
            return Err(nothing_to_run(&agent));
        };
        let host = hub.host().to_owned();
        let brought = LinkedTopics::by(&links, &hub)?.own;
        let feed = RecordedInputs::new(outputs.clone());
        let member = members.pop().ok_or_else(|| nothing_to_run(&agent))?;
        let repeated = ReplayedThread::new(member, &feed)?.ok_or_else(|| nothing_to_run(&agent))?;
        let ordered = RecordedChanges::new(ground, factory, profile, thread)?;
        let window = MomentComparison::new(&host, &agent);
        let (own, begun, numbers) = (Vec::new(), None, Vec::new());
        Ok(ThreadReplay {
            host,
            agent,
            thread,
            hub,
            linked_topics: brought,
            thread_replay: repeated,
            changes: ordered,
            own_outputs: outputs,
            recorded_inputs: feed,
            comparison: window,
            own,
            pending_cycle: begun,
            numbers,
            has_turn_records: false,
            has_diverged: false,
            is_removed: false,
        })
    }

    /// The route of a publisher's messages on a topic to this agent.
    fn route(
        &self,
        recorded: RecordedStream<'_>,
        report: &mut ComparisonReport,
    ) -> Result<Option<RealTimeRoute>, Error> {
        let RecordedStream { host, received_by, publisher, part, topic } = recorded;
        if received_by.unwrap_or(host) != self.host {
            return Ok(None);
        }
        let slot = self.hub.topic(topic);
        let is_brought = slot.is_some_and(|slot| self.linked_topics.contains(&slot));
        let is_own = publisher == self.agent && part == self.thread.part();
        if received_by.is_none() && is_own && !is_brought {
            let (line, is_cycle) = (report.line(host, publisher, topic), topic == CYCLE.path());
            return Ok(Some(RealTimeRoute::Own { topic: slot, line, is_cycle }));
        }
        // The host publishes its own record here too.
        if slot.is_none() || (topic == HOST.path() && publisher == "monas") {
            return Ok(None);
        }
        let endpoint = match received_by {
            Some(_) => self.hub.receiver(host, publisher, topic).map(InputEndpoint::Received),
            None => {
                let endpoint = self.hub.publisher_by_name(topic, publisher);
                endpoint.map(|endpoint| InputEndpoint::Published(endpoint.of_part(part)))
            }
        };
        Ok(Some(RealTimeRoute::Other(self.recorded_inputs.add_endpoint(endpoint.map_err(Error::hub)?))))
    }

    /// Processes a recorded message of the agent.
    fn published(
        &mut self,
        own: OwnMessage,
        is_cycle: bool,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
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
            let hint = "agents receive their recorded inputs: only a recording of all topics can be replayed";
            return Err(Error::new(ErrorKind::Invalid, message).with_hint(hint));
        }
        if !self.is_of_thread(&record) {
            return Err(self.missing_record_error());
        }
        match (&self.thread_replay, record.turn()) {
            (_, Turn::Ordered) => self.follow(&record, report, on_difference)?,
            (_, Turn::None | Turn::Start) if self.is_removed => {
                return Err(returned_without_a_record(&self.agent));
            }
            (ReplayedThread::Chart(_), Turn::None) if self.has_turn_records => {
                self.numbers.push(record.number);
                self.own.push(own);
            }
            (ReplayedThread::Chart(_), Turn::None) | (ReplayedThread::Waiting(_), _) => {
                return Err(self.missing_record_error());
            }
            (ReplayedThread::List(_), Turn::None) if record.seen.is_empty() => {
                return Err(self.missing_record_error());
            }
            (ReplayedThread::List(_), Turn::None) => {
                self.run_begun(true, report, on_difference)?;
                self.changes.begin_turn()?;
                self.own.push(OwnMessage { bytes: plain(&record), ..own });
                self.pending_cycle = Some(record);
            }
            (ReplayedThread::List(_), _) => {}
            (ReplayedThread::Chart(chart), Turn::Start) if self.has_turn_records && !chart.restarts() => {
                return Err(self.missing_record_error());
            }
            (ReplayedThread::Chart(_), turn) => {
                self.has_turn_records |= turn == Turn::Start;
                if turn == Turn::Round {
                    self.changes.begin_turn()?;
                }
                self.run(turn, &record, true, report, on_difference)?;
            }
        }
        Ok(())
    }

    /// Earlier versions recorded all threads of an agent alike.
    fn is_of_thread(&self, record: &Cycle) -> bool {
        match (self.thread.chart, record.turn()) {
            (Some(_), Turn::None) => record.seen.is_empty(),
            (Some(index), _) => record.chart as usize == index,
            (None, _) => true,
        }
    }

    /// Applies a change at the recorded position. Publications that result from it are compared
    /// with the next turn.
    fn follow(
        &mut self,
        record: &Cycle,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> Result<(), Error> {
        self.run_begun(true, report, on_difference)?;
        self.run_unrecorded(Timestamp::from_nanos(record.time), report, on_difference)?;
        self.recorded_inputs.begin(&record.seen, std::iter::empty());
        self.recorded_inputs.fetching();
        let (change, now) = (self.changes.recorded_change(record)?, Timestamp::from_nanos(record.time));
        match change.action() {
            Action::AddAgents => self.restart(&change, now)?,
            _ => self.changes.apply_change(&change, &mut self.thread_replay, now)?,
        }
        self.recorded_inputs.failure()
    }

    /// Processes the removal of the agent: its last cycle is known.
    fn handle_removal(
        &mut self,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> Result<(), Error> {
        self.run_begun(true, report, on_difference)?;
        self.is_removed = true;
        self.changes.discard_requests(&self.agent);
        Ok(())
    }

    /// Processes the addition of agents: if this one is among them, and its thread has no record of
    /// it, the agent has no list.
    fn handle_restart(&mut self, changed: &Changed, now: Timestamp) -> Result<(), Error> {
        let Some(change) = self.changes.change_of(changed).filter(|_| self.is_removed) else { return Ok(()) };
        self.restart(&change, now)?;
        match &self.thread_replay {
            ReplayedThread::Waiting(_) => Ok(()),
            _ => Err(returned_without_a_record(&self.agent)),
        }
    }

    /// Whether it is a list that has not begun, and no pending change is about to begin it.
    fn waits(&self) -> bool {
        matches!(self.thread_replay, ReplayedThread::Waiting(_)) && self.changes.is_idle()
    }

    /// Adds the removed agent again.
    fn restart(&mut self, change: &Change, now: Timestamp) -> Result<(), Error> {
        let member = self.changes.prepare_restart(change, &self.agent, &mut self.thread_replay, now)?;
        self.thread_replay =
            ReplayedThread::new(member, &self.recorded_inputs)?.ok_or_else(|| nothing_to_run(&self.agent))?;
        (self.has_turn_records, self.is_removed) = (false, false);
        Ok(())
    }

    /// Processes a change of a module. An agent with a record of it has already applied it; any
    /// other takes over the names.
    fn update_modules(&mut self, changed: &Changed, at: Timestamp) -> Result<(), Error> {
        if changed.agent == self.agent {
            self.changes.answered(changed, &mut self.thread_replay, at)?;
        }
        self.changes.update_modules(changed, &mut self.thread_replay, at)
    }

    fn missing_record_error(&self) -> Error {
        let message = format!(
            "the recording lacks the inputs of the turns of `{}`: it was made by an earlier version",
            self.agent
        );
        Error::new(ErrorKind::Invalid, message)
    }

    /// Repeats the cycle of the list that has begun, whose inputs are complete by now.
    fn run_begun(
        &mut self,
        is_whole: bool,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> Result<(), Error> {
        match self.pending_cycle.take() {
            Some(record) => self.run(Turn::None, &record, is_whole, report, on_difference),
            None => Ok(()),
        }
    }

    /// Repeats a turn and compares.
    fn run(
        &mut self,
        turn: Turn,
        record: &Cycle,
        is_whole: bool,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> Result<(), Error> {
        self.run_unrecorded(Timestamp::from_nanos(record.time), report, on_difference)?;
        self.recorded_inputs.begin(&record.seen, self.own.iter().map(|own| own.position));
        let now = Timestamp::from_nanos(record.time);
        let numbers = std::mem::take(&mut self.numbers);
        if self.thread.counts_with_others() {
            let own = (turn == Turn::None).then_some(record.number);
            self.thread_replay.set_cycle_numbers(own.into_iter().chain(numbers));
        }
        match &mut self.thread_replay {
            ReplayedThread::Waiting(_) => {}
            ReplayedThread::List(list) => list.cycle(now),
            ReplayedThread::Chart(chart) => chart.turn(turn, record, self.has_diverged),
        }
        self.recorded_inputs.failure()?;
        self.compare(now, is_whole, report, on_difference);
        Ok(())
    }

    /// Executes what a chart that differs from the recorded one does between its recorded turns.
    fn run_unrecorded(
        &mut self,
        until: Timestamp,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> Result<(), Error> {
        let recorded = std::mem::take(&mut self.own);
        while let ReplayedThread::Chart(chart) = &mut self.thread_replay
            && let Some(due) = chart.due_before(until)
        {
            self.recorded_inputs.begin_unrecorded(due);
            chart.run_unrecorded_turn(due);
            self.recorded_inputs.failure()?;
            self.compare(due, true, report, on_difference);
        }
        self.own = recorded;
        Ok(())
    }

    fn compare(
        &mut self,
        now: Timestamp,
        is_whole: bool,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) {
        // Measurements are not repeated.
        let measured = self.hub.topic(STATISTICS.path());
        for OwnMessage { topic, line, bytes, .. } in self.own.drain(..) {
            if topic.is_some() && topic == measured {
                continue;
            }
            self.comparison.recorded(topic, line, bytes);
        }
        for produced in self.own_outputs.take() {
            self.comparison.produced(produced.topic, produced.bytes);
        }
        if !is_whole {
            self.comparison.discard_pending();
        }
        let has_diverged = &mut self.has_diverged;
        self.comparison.compare(&self.hub, now, report, &mut |difference| {
            *has_diverged = true;
            on_difference(difference);
        });
    }

    /// Processes the end of the recording.
    fn finish(
        &mut self,
        is_whole: bool,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> Result<(), Error> {
        let last = self.pending_cycle.as_ref().map(|record| Timestamp::from_nanos(record.time));
        self.run_begun(is_whole, report, on_difference)?;
        // The inputs of a turn whose record was cut off are unknown.
        if is_whole {
            self.compare(last.unwrap_or_default(), is_whole, report, on_difference);
        }
        Ok(())
    }
}

fn returned_without_a_record(agent: &str) -> Error {
    let message = format!(
        "agent `{agent}` was removed and added again: the recording, of an earlier version, lacks the change"
    );
    Error::new(ErrorKind::Invalid, message).with_hint("replay other agents, or the time before")
}

fn nothing_to_run(agent: &str) -> Error {
    let message = format!(
        "agent `{agent}` has neither charts nor activities when the run begins: there is nothing to repeat"
    );
    Error::new(ErrorKind::Invalid, message).with_hint("replay other agents")
}

/// The record without the fields of real time.
fn plain(record: &Cycle) -> Vec<u8> {
    let Cycle { number, time, delivered, .. } = record.clone();
    Cycle { number, time, delivered, ..Cycle::default() }.encode_to_vec()
}
