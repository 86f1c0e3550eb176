//! A running match.

use std::time::Duration;

use monas::records::{Change, Changed};
use monas::{
    ActivityStatistics, AgentStatistics, ChartCoverage, RealTimeRun, RunHandle, RunHash, Simulation,
    Statistics, Timestamp,
};
use monas_sim::{GameState, SharedField, SimulatedWorld, TeamColour};
use monas_tape::Tape;

use crate::error::Error;
use crate::league::{League, LeagueCounts};
use crate::match_events;
use crate::summary::{AgentSummary, MatchEvent, MatchSummary, Scoreboard, TeamScore, TeamSummary};

/// Real time that the end of a match waits for the activities to stop.
const STOP_LIMIT: Duration = Duration::from_secs(3);

/// A running match, in simulated or in real time.
pub struct RunningMatch {
    run: MatchRun,
    pitch: SharedField,
    hash: RunHash,
    tape: Option<Tape>,
    length: Duration,
    events: Vec<MatchEvent>,
    seen_events: usize,
    league: Option<League>,
}

/// The agents and bodies of a match.
pub(crate) enum MatchRun {
    /// All on one thread, in a defined order.
    Simulated(Box<Simulation>),
    /// On threads of their own.
    RealTime(RealTimeRun),
}

impl RunningMatch {
    pub(crate) fn new(
        run: MatchRun,
        pitch: SharedField,
        hash: RunHash,
        tape: Option<Tape>,
        length: Duration,
        league: Option<League>,
    ) -> RunningMatch {
        RunningMatch { run, pitch, hash, tape, length, events: Vec::new(), seen_events: 0, league }
    }

    /// Advances the match to the given time since its start; in real time, waits for it.
    ///
    /// # Errors
    /// The field or a body failed. Failures of activities are handled by the policy of their agent.
    pub fn advance(&mut self, to: Duration) -> Result<(), Error> {
        match &mut self.run {
            MatchRun::Simulated(simulation) => simulation.run_until(timestamp(to)).map_err(Error::agents)?,
            MatchRun::RealTime(run) => _ = run.wait_until(timestamp(to)),
        }
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
        let run = match self.run {
            MatchRun::Simulated(simulation) => {
                let advanced = simulation.run_until_cancelled(timestamp(to), is_cancelled, STOP_LIMIT);
                MatchRun::Simulated(Box::new(advanced.map_err(Error::agents)?))
            }
            MatchRun::RealTime(run) => {
                run.wait_until(timestamp(to));
                MatchRun::RealTime(run)
            }
        };
        let mut running = RunningMatch { run, ..self };
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

    /// From now on measures the agents, see [`Simulation::measure`]. In real time they are measured
    /// from the start.
    pub fn measure(&mut self) {
        if let MatchRun::Simulated(simulation) = &mut self.run {
            simulation.measure();
        }
    }

    /// Applies a change to the agents of a robot now, between two of their cycles.
    ///
    /// # Errors
    /// There is no such robot. The refusal of a change is part of the reply.
    pub fn change(&mut self, host: &str, change: Change) -> Result<Changed, Error> {
        match &mut self.run {
            MatchRun::Simulated(simulation) => simulation.change(host, change).map_err(Error::agents),
            MatchRun::RealTime(run) => run.run_handle().change(host, change).map_err(Error::refused),
        }
    }

    /// The time since the start.
    pub fn now(&self) -> Duration {
        let now = match &self.run {
            MatchRun::Simulated(simulation) => simulation.now(),
            MatchRun::RealTime(run) => run.now(),
        };
        Duration::from_nanos(now.as_nanos())
    }

    /// Whether both halves have been played, or the match has ended early: in real time it ends
    /// when the field fails, or when every agent has ended.
    pub fn is_over(&self) -> bool {
        let has_ended = |world: &SimulatedWorld| {
            (world.referee().state(), world.referee().half()) == (GameState::Finished, 2)
        };
        let has_stopped = matches!(&self.run, MatchRun::RealTime(run) if run.has_ended());
        has_stopped
            || self.now() >= self.length
            || (self.league.is_some() && self.pitch.with_world(has_ended))
    }

    /// Counts of packets exchanged with a GameController, or as one; none if it has neither.
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

    /// The simulation of the agents; none in real time.
    pub fn simulation(&self) -> Option<&Simulation> {
        match &self.run {
            MatchRun::Simulated(simulation) => Some(simulation),
            MatchRun::RealTime(_) => None,
        }
    }

    /// A handle for inspecting the match and publishing from outside.
    pub fn run_handle(&self) -> RunHandle {
        match &self.run {
            MatchRun::Simulated(simulation) => simulation.run_handle(),
            MatchRun::RealTime(run) => run.run_handle(),
        }
    }

    /// Ends the match. The caller finishes its tape. It waits three seconds of real time for the
    /// activities to stop; [`MatchSummary::unstopped`] names one that has not.
    ///
    /// # Errors
    /// The tape is finished already.
    pub fn finish(self) -> Result<MatchSummary, Error> {
        let simulated = self.now();
        let league = self.league();
        let RunningMatch { run, pitch, hash, tape, events, .. } = self;
        if let Some(tape) = &tape {
            monas_recording::ended(tape, timestamp(simulated)).map_err(Error::recording)?;
        }
        let is_simulated = matches!(run, MatchRun::Simulated(_));
        let RunEnd { statistics, coverage, unstopped } = run.end();
        let (hash, messages) = hash.finish();
        let touch = pitch.with_world(|world| world.statistics().time_to_first_touch());
        Ok(MatchSummary {
            hash: is_simulated.then_some(hash),
            messages,
            simulated,
            teams: pitch.with_world(teams),
            agents: statistics.agents.iter().map(agent).collect(),
            bodies: statistics.bodies,
            failure: statistics.failure,
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

/// The results of the agents at their end.
struct RunEnd {
    statistics: Statistics,
    coverage: Vec<ChartCoverage>,
    /// Names the activity that has not returned.
    unstopped: Option<String>,
}

impl MatchRun {
    fn end(self) -> RunEnd {
        let simulation = match self {
            MatchRun::Simulated(simulation) => simulation,
            MatchRun::RealTime(run) => {
                return RunEnd { statistics: run.stop(), coverage: Vec::new(), unstopped: None };
            }
        };
        let (statistics, coverage) = (simulation.statistics(), simulation.coverage());
        match simulation.stop_within(STOP_LIMIT) {
            Ok(stopped) => {
                RunEnd { statistics: stopped.statistics(), coverage: stopped.coverage(), unstopped: None }
            }
            Err(error) => RunEnd { statistics, coverage, unstopped: Some(error.to_string()) },
        }
    }
}

/// The CPU time of an activity, from the calls in which it was measured.
fn cpu(activity: &ActivityStatistics) -> Option<Duration> {
    let calls = u32::try_from(activity.calls).unwrap_or(u32::MAX);
    Some(activity.call_cpu?.mean().saturating_mul(calls))
}

fn agent(agent: &AgentStatistics) -> AgentSummary {
    AgentSummary {
        host: agent.host.clone(),
        agent: agent.agent.clone(),
        cycles: agent.cycles,
        overruns: agent.overruns,
        micro_steps: agent.micro_steps,
        activity_calls: agent.activities.iter().map(|activity| activity.calls).sum(),
        cycle: agent.cycle_percentiles,
        cpu: agent.activities.iter().filter_map(cpu).reduce(|one, other| one + other),
        stopped: agent.stopped.clone(),
    }
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
