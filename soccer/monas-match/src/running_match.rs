//! A running match.

use std::time::Duration;

use monas::records::{Change, Changed};
use monas::{RunHash, Simulation, Statistics, Timestamp};
use monas_sim::{GameState, SharedField, SimulatedWorld, TeamColour};
use monas_tape::Tape;

use crate::error::Error;
use crate::league::{League, LeagueCounts};
use crate::match_events;
use crate::summary::{AgentSummary, MatchEvent, MatchSummary, Scoreboard, TeamScore, TeamSummary};

/// How long the end of a match waits for the activities to stop, in real time.
const STOP_LIMIT: Duration = Duration::from_secs(3);

/// A running match, in simulated time.
pub struct RunningMatch {
    simulation: Simulation,
    pitch: SharedField,
    hash: RunHash,
    tape: Option<Tape>,
    length: Duration,
    events: Vec<MatchEvent>,
    seen_events: usize,
    league: Option<League>,
}

impl RunningMatch {
    pub(crate) fn new(
        simulation: Simulation,
        pitch: SharedField,
        hash: RunHash,
        tape: Option<Tape>,
        length: Duration,
        league: Option<League>,
    ) -> RunningMatch {
        RunningMatch { simulation, pitch, hash, tape, length, events: Vec::new(), seen_events: 0, league }
    }

    /// Advances the match to the given time since its start.
    ///
    /// # Errors
    /// The field or a body failed. Failures of activities are handled by the policy of their agent.
    pub fn advance(&mut self, to: Duration) -> Result<(), Error> {
        self.simulation.run_until(timestamp(to)).map_err(Error::agents)?;
        self.collect_events();
        Ok(())
    }

    /// As [`advance`](Self::advance), but given up if it has not returned within three seconds of
    /// real time after `is_cancelled`.
    ///
    /// # Errors
    /// As in [`advance`](Self::advance); or an activity, which the error names, has not returned.
    pub fn advance_until_cancelled(
        self,
        to: Duration,
        is_cancelled: impl Fn() -> bool,
    ) -> Result<RunningMatch, Error> {
        let advanced = self.simulation.run_until_cancelled(timestamp(to), is_cancelled, STOP_LIMIT);
        let mut running = RunningMatch { simulation: advanced.map_err(Error::agents)?, ..self };
        running.collect_events();
        Ok(running)
    }

    fn collect_events(&mut self) {
        let RunningMatch { pitch, events, seen_events, league, .. } = self;
        events.extend(league.iter().flat_map(League::take_events));
        pitch.with_world(|world| {
            events.extend(match_events::since(world, *seen_events));
            *seen_events = world.events().len();
        });
    }

    /// From now on measures the agents, see [`Simulation::measure`].
    pub fn measure(&mut self) {
        self.simulation.measure();
    }

    /// Applies a change to the agents of a robot now, between two of their cycles.
    ///
    /// # Errors
    /// There is no such robot. The refusal of a change is part of the reply.
    pub fn change(&mut self, host: &str, change: Change) -> Result<Changed, Error> {
        self.simulation.change(host, change).map_err(Error::agents)
    }

    /// The simulated time since the start.
    pub fn now(&self) -> Duration {
        Duration::from_nanos(self.simulation.now().as_nanos())
    }

    /// Whether both halves have been played.
    pub fn is_over(&self) -> bool {
        let has_ended = |world: &SimulatedWorld| {
            (world.referee().state(), world.referee().half()) == (GameState::Finished, 2)
        };
        self.now() >= self.length || (self.league.is_some() && self.pitch.with_world(has_ended))
    }

    /// What the match has exchanged with a GameController, or as one; none if it has neither.
    pub fn league(&self) -> Option<LeagueCounts> {
        self.league.as_ref().map(League::counts)
    }

    /// The scoreboard.
    pub fn score(&self) -> Scoreboard {
        self.pitch.with_world(|world| {
            let referee = world.referee();
            let team = |index: usize| TeamScore {
                name: world.teams()[index].name.clone(),
                colour: colour(referee.colours()[index]),
                goals: referee.score()[index],
            };
            Scoreboard {
                teams: [team(0), team(1)],
                half: referee.half(),
                seconds_left: referee.seconds_remaining().max(0.0) as u32,
                phase: match_events::phase(referee.state()),
            }
        })
    }

    /// The notable events so far.
    pub fn events(&self) -> &[MatchEvent] {
        &self.events
    }

    /// A picture of the current state of the field, as SVG.
    pub fn picture(&self) -> String {
        self.pitch.with_world(monas_sim::render_svg)
    }

    /// The current state of the field as lines of text, with SGR sequences if it is coloured.
    pub fn text(&self, columns: usize, rows: usize, is_coloured: bool) -> Vec<String> {
        self.pitch.with_world(|world| monas_sim::render_text(world, columns, rows, is_coloured))
    }

    /// The field, for exercises and evaluation.
    pub fn pitch(&self) -> &SharedField {
        &self.pitch
    }

    /// The simulation of the agents.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Ends the match. The caller finishes its tape. It waits three seconds of real time for the
    /// activities to stop; [`MatchSummary::unstopped`] names one that has not.
    ///
    /// # Errors
    /// The tape is finished already.
    pub fn finish(self) -> Result<MatchSummary, Error> {
        let simulated = self.now();
        let league = self.league();
        let RunningMatch { simulation, pitch, hash, tape, events, .. } = self;
        if let Some(tape) = &tape {
            monas_recording::ended(tape, simulation.now()).map_err(Error::recording)?;
        }
        let last = (simulation.statistics(), simulation.coverage());
        let ((statistics, coverage), unstopped) = match simulation.stop_within(STOP_LIMIT) {
            Ok(stopped) => ((stopped.statistics(), stopped.coverage()), None),
            Err(error) => (last, Some(error.to_string())),
        };
        let (hash, messages) = hash.finish();
        let touch = pitch.with_world(|world| world.statistics().time_to_first_touch());
        Ok(MatchSummary {
            hash,
            messages,
            simulated,
            teams: pitch.with_world(teams),
            agents: agents(&statistics),
            time_to_first_touch: touch.map(Duration::from_secs_f64),
            coverage,
            links: statistics.links,
            events,
            league,
            unstopped,
        })
    }
}

fn timestamp(time: Duration) -> Timestamp {
    Timestamp::from_nanos(u64::try_from(time.as_nanos()).unwrap_or(u64::MAX))
}

fn agents(statistics: &Statistics) -> Vec<AgentSummary> {
    let summary = |agent: &monas::AgentStatistics| AgentSummary {
        host: agent.host.clone(),
        agent: agent.agent.clone(),
        cycles: agent.cycles,
        overruns: agent.overruns,
        micro_steps: agent.micro_steps,
        activity_calls: agent.activities.iter().map(|activity| activity.calls).sum(),
        stopped: agent.stopped.clone(),
    };
    statistics.agents.iter().map(summary).collect()
}

fn teams(world: &SimulatedWorld) -> Vec<TeamSummary> {
    let statistics = world.statistics();
    let playing = statistics.playing_time();
    let team = |(index, setup): (usize, &monas_sim::TeamSetup)| {
        let tally = statistics.team(index);
        TeamSummary {
            name: setup.name.clone(),
            colour: colour(setup.colour),
            goals: world.referee().score()[index],
            kicks: tally.strikes,
            shots: tally.shots,
            saves: tally.saves,
            falls: tally.falls,
            penalties: tally.penalties,
            possession: if playing > 0.0 { tally.possession / playing } else { 0.0 },
            actions: tally.actions,
            actions_to_ball: tally.actions_to_ball,
            returns: tally.returns,
            return_seconds: tally.return_time,
        }
    };
    world.teams().iter().enumerate().map(team).collect()
}

fn colour(colour: TeamColour) -> &'static str {
    match colour {
        TeamColour::Blue => "blue",
        TeamColour::Red => "red",
    }
}
