//! What the runtime publishes about itself: every cycle of every agent and every micro-step of every chart.
//!
//! Numbers stand for names in the records of a cycle; [`HOST`] and [`MODEL`], published before anything runs, say which. What is published on
//! [`CHANGE`] changes the agents of the host, and is answered on [`CHANGED`].

narukom::include_messages!("monas.runtime");

/// A line of the log, in the form that viewers of recordings know.
pub mod foxglove {
    narukom::include_messages!("foxglove");
}

narukom::topic! {
    /// The host and the paths of its topics.
    pub HOST: narukom::State<Host> = "monas/host";
    /// The names in each chart.
    pub MODEL: narukom::Data<Model, 16> = "monas/model";
    /// Each cycle of each agent.
    pub CYCLE: narukom::Data<Cycle, 64> = "monas/cycle";
    /// Each micro-step of each chart.
    pub CHART: narukom::Data<Chart, 64> = "monas/chart";
    /// What is asked for while agents run.
    pub CHANGE: narukom::Data<Change, 64> = "monas/change";
    /// What became of it.
    pub CHANGED: narukom::Data<Changed, 64> = "monas/changed";
    /// What the log says of the host and its agents: see [`Logger::publish`](crate::logger::Logger::publish).
    pub LOG: narukom::Data<foxglove::Log, 64> = "monas/log";
    /// What was counted and measured of each agent, in real time, as often as the agent is to say it.
    pub STATISTICS: narukom::Data<AgentEntry, 16> = "monas/statistics";
}

impl Delivery {
    /// The newest message of each topic that the last delivery brought to a blackboard.
    pub(crate) fn all(blackboard: &narukom::Blackboard, region: u32) -> impl Iterator<Item = Delivery> {
        blackboard.arrivals().enumerate().filter_map(move |(place, topic)| {
            let is_last = !blackboard.arrivals().skip(place + 1).any(|later| later == topic);
            let sample = blackboard.latest_sample(topic).filter(|_| is_last)?;
            Some(Delivery {
                topic: topic.number(),
                sequence: sample.header.sequence,
                region,
                ..Delivery::default()
            })
        })
    }
}
