//! Records of the runtime about itself: all cycles of all agents and all micro-steps of all charts.
//!
//! Records refer to names by number: [`MODEL`], published before anything runs, lists those of
//! charts, and topics are identified by the [`topic_hash`](narukom::topic_hash) of their path.
//! Records do not depend on other parts of the program. A message on [`CHANGE`] changes the agents
//! of the host; the reply is published on [`CHANGED`].

narukom::include_messages!("monas.runtime");

/// A log line, in the form used by viewers of recordings.
pub mod foxglove {
    narukom::include_messages!("foxglove");
}

narukom::topic! {
    /// The host.
    pub HOST: narukom::State<Host> = "monas/host";
    /// The names in each chart.
    pub MODEL: narukom::Data<Model, 16> = "monas/model";
    /// Each cycle of each agent.
    pub CYCLE: narukom::Data<Cycle, 64> = "monas/cycle";
    /// Each micro-step of each chart.
    pub CHART: narukom::Data<Chart, 64> = "monas/chart";
    /// Changes requested while agents run.
    pub CHANGE: narukom::Data<Change, 64> = "monas/change";
    /// Their outcomes.
    pub CHANGED: narukom::Data<Changed, 64> = "monas/changed";
    /// Log lines of the host and its agents, which a logger publishes.
    pub LOG: narukom::Data<foxglove::Log, 64> = "monas/log";
    /// Statistics of each agent in real time, published at the agent's `stats_cycle`.
    pub STATISTICS: narukom::Data<AgentEntry, 16> = "monas/statistics";
}

/// The identifier of a hub's topic in records; 0 for a topic that the hub does not have.
pub fn topic_in_records(hub: &narukom::Hub, topic: narukom::TopicSlot) -> u64 {
    hub.declaration(topic).map_or(0, narukom::TopicDeclaration::hash)
}

impl Delivery {
    /// The newest message of each topic that the last delivery transferred to a blackboard.
    pub fn all(blackboard: &narukom::Blackboard, region: u32) -> impl Iterator<Item = Delivery> {
        blackboard.arrivals().enumerate().filter_map(move |(index, topic)| {
            let is_last = !blackboard.arrivals().skip(index + 1).any(|later| later == topic);
            let sample = blackboard.latest_sample(topic).filter(|_| is_last)?;
            Some(Delivery {
                topic: topic_in_records(blackboard.hub(), topic),
                sequence: sample.header.sequence,
                region,
                ..Delivery::default()
            })
        })
    }
}
