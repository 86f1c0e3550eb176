//! Team play in a match: passes, kick-offs, crowding, and the time in each state.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use monas::MicroStep;
use monas_match::{MatchPlan, RunningMatch};
use monas_sim::{EventKind, SimulatedWorld};
use yase::NodeKind;

/// The state in which a robot passes.
const PASSING_STATE: &str = "passBall";

/// A kick later than this after the entry of [`PASSING_STATE`] is not its kick, s.
const KICK_WITHIN: f64 = 3.0;

/// Passes of a team.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct PassCounts {
    /// The number of entries of the state in which a robot passes.
    pub attempts: u32,
    /// Attempts after whose kick a team mate was the next to touch the ball.
    pub completed: u32,
    /// Shots of the team mate that received such a pass.
    pub shots: u32,
    /// Kicks, meant as passes or not, after which a team mate was the next to touch the ball.
    pub any: u32,
}

/// The number of times that a robot was in a state, and their total duration.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct StateTime {
    /// Number of entries.
    pub entries: u32,
    /// Total time, s.
    pub seconds: f64,
}

/// The team play of both teams of a match; blue first.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct TeamPlay {
    /// The passes of each team.
    pub passes: [PassCounts; 2],
    /// Kick-offs of both teams after which a ball was kicked.
    pub kick_offs: u32,
    /// Those after which the team with the kick-off was the first to kick the ball.
    pub kick_offs_kept: u32,
    /// Part of the playing time in which the ball moved.
    pub rolling: f64,
    /// Part of the playing time in which two robots crowded.
    pub crowded: f64,
    /// The states with activities by host and name, with the time in them.
    pub states: BTreeMap<(String, String), StateTime>,
}

/// Observes the charts of a match.
#[derive(Clone, Default)]
pub struct TeamPlayObserver {
    seen: Arc<Mutex<StateLog>>,
}

#[derive(Default)]
struct StateLog {
    hosts: Vec<HostLog>,
    /// When a host began to pass.
    passing: Vec<(String, f64)>,
}

/// The states of one host. A micro-step finds them by index: lookups by name took 3 to 5 % of the
/// time of a match.
struct HostLog {
    host: String,
    /// The states that were entered, by name.
    states: Vec<(String, StateTime)>,
    /// Index in `states` of each node that was entered, and when, if it has not been left.
    nodes: Vec<Option<(usize, Option<f64>)>>,
}

impl StateLog {
    fn note(&mut self, step: &MicroStep<'_>) {
        let now = step.record.time.as_nanos() as f64 * 1e-9;
        let statechart = step.chart.statechart();
        let basic = |node: &&yase::NodeId| statechart.node(**node).kind == NodeKind::Basic;
        let known = self.hosts.iter().position(|log| log.host == step.host);
        let index = known.unwrap_or_else(|| {
            self.hosts.push(HostLog::new(step.host));
            self.hosts.len() - 1
        });
        let log = &mut self.hosts[index];
        step.record.exits.iter().filter(basic).for_each(|node| log.leave(node.0 as usize, now));
        for node in step.record.entries.iter().filter(basic) {
            let name = &statechart.node(*node).name;
            if name == PASSING_STATE {
                self.passing.push((step.host.to_owned(), now));
            }
            log.enter(node.0 as usize, name, now);
        }
    }

    fn states(&self) -> BTreeMap<(String, String), StateTime> {
        let of = |log: &HostLog| -> Vec<_> {
            log.states.iter().map(|(name, time)| ((log.host.clone(), name.clone()), *time)).collect()
        };
        self.hosts.iter().flat_map(of).collect()
    }
}

impl HostLog {
    fn new(host: &str) -> HostLog {
        HostLog { host: host.to_owned(), states: Vec::new(), nodes: Vec::new() }
    }

    fn enter(&mut self, node: usize, name: &str, now: f64) {
        if node >= self.nodes.len() {
            self.nodes.resize(node + 1, None);
        }
        let state = match self.nodes[node] {
            Some((state, _)) => state,
            None => self.state(name),
        };
        self.states[state].1.entries += 1;
        self.nodes[node] = Some((state, Some(now)));
    }

    fn leave(&mut self, node: usize, now: f64) {
        if let Some(Some((state, since))) = self.nodes.get_mut(node)
            && let Some(since) = since.take()
        {
            self.states[*state].1.seconds += now - since;
        }
    }

    /// The index of a state, which several nodes may share.
    fn state(&mut self, name: &str) -> usize {
        self.states.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
            self.states.push((name.to_owned(), StateTime::default()));
            self.states.len() - 1
        })
    }
}

impl TeamPlayObserver {
    /// Observes a match that will be started.
    pub fn listen(&self, plan: MatchPlan) -> MatchPlan {
        let seen = self.seen.clone();
        plan.listen(Box::new(move |step: MicroStep<'_>| {
            seen.lock().unwrap_or_else(PoisonError::into_inner).note(&step);
        }))
    }

    /// The observations of a match so far.
    pub fn team_play(&self, running: &RunningMatch) -> TeamPlay {
        let seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        let mut play = running.pitch().with_world(|world| {
            let playing = world.statistics().playing_time().max(1e-9);
            let mut play = TeamPlay {
                rolling: world.statistics().rolling_time() / playing,
                crowded: world.statistics().crowded_time() / playing,
                ..TeamPlay::default()
            };
            count_kick_offs(world, &mut play);
            count_passes(world, &seen.passing, &mut play);
            play
        });
        play.states = seen.states();
        play
    }
}

fn count_kick_offs(world: &SimulatedWorld, play: &mut TeamPlay) {
    let mut kicks_off = None;
    for event in world.events() {
        match event.kind {
            EventKind::KickOff { team } => kicks_off = Some(team),
            EventKind::Kick { robot, struck: true, .. } => {
                if let Some(team) = kicks_off.take() {
                    play.kick_offs += 1;
                    play.kick_offs_kept += u32::from(world.robots()[robot].team == team);
                }
            }
            _ => {}
        }
    }
}

fn count_passes(world: &SimulatedWorld, passing: &[(String, f64)], play: &mut TeamPlay) {
    let host = |robot: usize| {
        let robot = &world.robots()[robot];
        format!("{}-{}", world.teams()[robot.team].name.to_lowercase(), robot.number)
    };
    for (who, _) in passing {
        let team = (0..world.robots().len()).find(|robot| host(*robot) == *who);
        team.into_iter().for_each(|robot| play.passes[world.robots()[robot].team].attempts += 1);
    }
    let is_meant = |robot: usize, at: f64| {
        let who = host(robot);
        passing.iter().any(|(by, since)| *by == who && (0.0..KICK_WITHIN).contains(&(at - since)))
    };
    // The last pass that was completed, and whether it was meant.
    let mut meant = false;
    for event in world.events() {
        match event.kind {
            EventKind::Pass { from, after, .. } => {
                let counts = &mut play.passes[world.robots()[from].team];
                meant = is_meant(from, event.time - after);
                counts.any += 1;
                counts.completed += u32::from(meant);
            }
            EventKind::ShotAfterPass { robot } => {
                play.passes[world.robots()[robot].team].shots += u32::from(meant);
            }
            _ => {}
        }
    }
}

impl fmt::Display for TeamPlay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (team, PassCounts { attempts, completed, shots, any }) in ["blue", "red"].iter().zip(self.passes)
        {
            writeln!(
                f,
                "{team:<5} passes attempted {attempts}, completed {completed}, shots after them {shots}; \
                 kicks that a team mate was next to touch {any}"
            )?;
        }
        writeln!(f, "kick-offs kept   {} of {}", self.kick_offs_kept, self.kick_offs)?;
        writeln!(f, "ball moves       {:.0} % of the playing time", self.rolling * 100.0)?;
        writeln!(f, "robots crowd     {:.0} % of the playing time", self.crowded * 100.0)?;
        writeln!(f, "{:<8} {:<22} {:>7} {:>9}", "host", "state", "entries", "seconds")?;
        for ((host, state), StateTime { entries, seconds }) in &self.states {
            writeln!(f, "{host:<8} {state:<22} {entries:>7} {seconds:>9.1}")?;
        }
        Ok(())
    }
}
