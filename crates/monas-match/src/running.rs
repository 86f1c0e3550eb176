//! A match that is being played.

use std::path::PathBuf;
use std::time::Duration;

use monas::{Moment, RunHash, Simulation};
use monas_sim::{Pitch, TeamColour, World};
use monas_tape::Tape;

use crate::error::Error;
use crate::incidents;
use crate::label;
use crate::summary::{AgentSummary, MatchEvent, Scoreboard, Summary, TeamScore, TeamSummary};

/// A match that is being played, in simulated time.
pub struct RunningMatch {
    simulation: Simulation,
    pitch: Pitch,
    hash: RunHash,
    tape: Option<(Tape, PathBuf)>,
    length: Duration,
    events: Vec<MatchEvent>,
    seen_events: usize,
}

impl RunningMatch {
    pub(crate) fn new(
        simulation: Simulation,
        pitch: Pitch,
        hash: RunHash,
        tape: Option<(Tape, PathBuf)>,
        length: Duration,
    ) -> RunningMatch {
        RunningMatch { simulation, pitch, hash, tape, length, events: Vec::new(), seen_events: 0 }
    }

    /// Plays on until so much time has passed since the beginning.
    ///
    /// # Errors
    /// The field or a body failed. Agents do not fail: what their activities do wrong is handled by their policy.
    pub fn advance(&mut self, to: Duration) -> Result<(), Error> {
        let end = Moment::from_nanos(u64::try_from(to.as_nanos()).unwrap_or(u64::MAX));
        self.simulation.run_until(end).map_err(Error::agents)?;
        let RunningMatch { pitch, events, seen_events, .. } = self;
        pitch.look(|world| {
            events.extend(incidents::since(world, *seen_events));
            *seen_events = world.events().len();
        });
        Ok(())
    }

    /// How much time has been played.
    pub fn now(&self) -> Duration {
        Duration::from_nanos(self.simulation.now().as_nanos())
    }

    /// Whether both halves have been played.
    pub fn is_over(&self) -> bool {
        self.now() >= self.length
    }

    /// The board beside the field.
    pub fn score(&self) -> Scoreboard {
        self.pitch.look(|world| {
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
                phase: incidents::phase(referee.state()),
            }
        })
    }

    /// Everything of note so far.
    pub fn events(&self) -> &[MatchEvent] {
        &self.events
    }

    /// A picture of the field now, as SVG.
    pub fn picture(&self) -> String {
        self.pitch.look(monas_sim::render_svg)
    }

    /// The field, for exercises and judges.
    pub fn pitch(&self) -> &Pitch {
        &self.pitch
    }

    /// The agents at work.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Ends the match, and the recording.
    ///
    /// # Errors
    /// The recording cannot be ended.
    pub fn finish(mut self) -> Result<Summary, Error> {
        if let Some((tape, path)) = &self.tape {
            label::ended(tape, self.simulation.now()).map_err(|error| Error::recording(path, error))?;
        }
        self.simulation.stop();
        let (hash, messages) = self.hash.finish();
        if let Some((tape, path)) = self.tape.take() {
            tape.finish().map_err(|error| Error::recording(&path, error))?;
        }
        let touch = self.pitch.look(|world| world.statistics().time_to_first_touch());
        Ok(Summary {
            hash,
            messages,
            simulated: self.now(),
            teams: self.pitch.look(teams),
            agents: self.agents(),
            time_to_first_touch: touch.map(Duration::from_secs_f64),
            coverage: self.simulation.coverage(),
            links: self.simulation.statistics().links,
            events: self.events,
        })
    }

    fn agents(&self) -> Vec<AgentSummary> {
        let statistics = self.simulation.statistics();
        let summary = |agent: &monas::AgentStatistics| AgentSummary {
            host: agent.host.clone(),
            agent: agent.agent.clone(),
            cycles: agent.cycles,
            overruns: agent.overruns,
            micro_steps: agent.micro_steps,
            activity_calls: agent.activities.iter().map(|activity| activity.calls).sum(),
        };
        statistics.agents.iter().map(summary).collect()
    }
}

fn teams(world: &World) -> Vec<TeamSummary> {
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
