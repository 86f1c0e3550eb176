//! A match that was read and checked but not started.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use monas::config::{self, Element, Grammar, Layers};
use monas::{
    Agent, ChartListener, ConfigurationBundle, HostConfig, LinkConfig, Module, Registry, RunHash, Talws,
};
use monas_gamecontroller::{ControlReceiver, ControlSender, RuleBook};
use monas_robot::{BodyEnvironment, BodySettings, ObjectSet, Robot};
use monas_sim::{FieldGeometry, MatchRules, Physics, Radio, Setup, SharedField, SimulatedWorld, TeamSetup};
use monas_tape::Tape;
use yase::{Diagnostic, Source};

use crate::error::Error;
use crate::file::{self, MatchFile};
use crate::league::League;
use crate::league_player::LeaguePlayers;
use crate::league_referee::LeagueReferee;
use crate::match_world::MatchWorld;
use crate::running_match::{MatchRun, RunningMatch};
use crate::settings::MatchSettings;

/// Loads matches.
#[derive(Debug)]
pub struct MatchSource;

impl MatchSource {
    /// Reads a match file and all files it refers to, and binds every chart, without starting
    /// anything.
    ///
    /// # Errors
    /// All diagnostics of all files, without duplicates.
    pub fn load(path: impl AsRef<Path>, registry: &Registry) -> Result<MatchPlan, Vec<Diagnostic>> {
        MatchSource::load_with(path, registry, &Layers::new())
    }

    /// Like [`load`](MatchSource::load), with layers that override the files.
    ///
    /// # Errors
    /// All diagnostics of all files, without duplicates.
    pub fn load_with(
        path: impl AsRef<Path>,
        registry: &Registry,
        layers: &Layers,
    ) -> Result<MatchPlan, Vec<Diagnostic>> {
        let mut diagnostics = Vec::new();
        let file = file::read(path.as_ref(), layers, &mut diagnostics);
        let robots =
            file.as_ref().map(|file| robots(file, registry, layers, &mut diagnostics)).unwrap_or_default();
        config::sort_diagnostics(&mut diagnostics);
        let once = each_once(diagnostics);
        match file.filter(|_| !once.iter().any(Diagnostic::is_error)) {
            Some(file) => match MatchPlan::new(file, robots, registry.clone()) {
                Some(plan) => {
                    let settings = layers.settings().collect::<Vec<_>>().join("\n");
                    Ok(MatchPlan { warnings: once, files: ConfigurationBundle::of(path), settings, ..plan })
                }
                None => Err(once),
            },
            None => Err(once),
        }
    }

    /// The elements of a match file and all files it refers to, with overriding layers applied, and
    /// their diagnostics. Names of activities and models are not resolved. The elements are those
    /// of [`grammar`](crate::grammar).
    pub fn elements(path: impl AsRef<Path>, layers: &Layers) -> (Vec<Element>, Vec<Diagnostic>) {
        let mut diagnostics = Vec::new();
        let elements = file::elements(path.as_ref(), layers, &mut diagnostics);
        config::sort_diagnostics(&mut diagnostics);
        (elements, each_once(diagnostics))
    }
}

/// The robots of a match file with their agents.
fn robots(
    file: &MatchFile,
    registry: &Registry,
    layers: &Layers,
    diagnostics: &mut Vec<Diagnostic>,
) -> Vec<RobotPlan> {
    let mut robots = Vec::new();
    let (mut settings, mut registry) = (MatchSettings::new(layers), registry.clone());
    for team in &file.teams {
        for robot in &team.robots {
            let resolved = config::resolve(&robot.role, &Grammar::agents(), &settings.over(&robot.overrides));
            diagnostics.extend(resolved.diagnostics);
            diagnostics.extend(settings.unmatched(&robot.overrides, resolved.unmatched));
            let setup = config::assemble(
                &resolved.elements,
                &robot.role,
                &registry,
                BodyEnvironment::Match,
                diagnostics,
            );
            let config::HostSetup { agents, links, modules, body, source } = setup;
            // Modules loaded for one robot are available to the next.
            registry = modules
                .iter()
                .fold(registry, |registry, module| registry.with_module(module.clone()).unwrap_or(registry));
            let host = format!("{}-{}", file::host_name(&team.setup.name), robot.number);
            robots.push(RobotPlan {
                team: team.setup.number,
                number: robot.number,
                host,
                has_process: robot.has_process,
                agents,
                links,
                modules,
                body: body.unwrap_or_default(),
                source,
            });
        }
    }
    diagnostics.extend(settings.unused_settings());
    robots
}

/// Removes duplicates: robots with the same role give the same diagnostics.
fn each_once(diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    diagnostics.into_iter().fold(Vec::new(), |mut once, diagnostic| {
        if !once.contains(&diagnostic) {
            once.push(diagnostic);
        }
        once
    })
}

/// A match that was read and checked.
pub struct MatchPlan {
    geometry: FieldGeometry,
    physics: Physics,
    rules: MatchRules,
    radio: Radio,
    objects: ObjectSet,
    teams: [TeamSetup; 2],
    robots: Vec<RobotPlan>,
    registry: Registry,
    listeners: Vec<Box<dyn ChartListener>>,
    warnings: Vec<Diagnostic>,
    league: Option<LeagueSetup>,
    files: ConfigurationBundle,
    settings: String,
    replace_bodies: BodyReplacement,
    /// The addresses of bodies of robots with processes of their own, given the host.
    addresses: Option<Addresses>,
}

/// Replaces the body of a robot, given its team and number.
type BodyReplacement = Box<dyn Fn(u8, u8, Box<dyn Robot>) -> Box<dyn Robot> + Send>;

type Addresses = Box<dyn Fn(&str) -> String + Send>;

impl std::fmt::Debug for MatchPlan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MatchPlan")
            .field("teams", &self.teams)
            .field("robots", &self.robots)
            .finish_non_exhaustive()
    }
}

/// The end of the league's protocol that a match has.
enum LeagueSetup {
    /// A GameController elsewhere decides.
    Players(ControlReceiver),
    /// The referee of the match announces its decisions to robots elsewhere.
    Referee(ControlSender, RuleBook, Duration),
}

/// The longest match that a GameController elsewhere decides.
const MAX_EXTERNAL_MATCH: Duration = Duration::from_secs(24 * 3600);

/// A robot of a match and its agents.
#[derive(Debug)]
struct RobotPlan {
    team: u8,
    number: u8,
    host: String,
    /// Its agents run in a process of their own, in real time.
    has_process: bool,
    agents: Vec<Agent>,
    links: Vec<LinkConfig>,
    modules: Vec<Module>,
    body: BodySettings,
    /// The text of its role.
    source: Option<Arc<Source>>,
}

/// The source of the time of a match.
#[derive(Clone, Copy)]
enum MatchTime {
    Simulated,
    Real,
}

/// A match that is set up.
struct MatchParts {
    talws: Talws,
    pitch: SharedField,
    league: Option<League>,
}

/// Options of a match.
#[derive(Clone, Debug, Default)]
pub struct MatchOptions {
    /// The seed of all random numbers.
    pub seed: u64,
    /// The tape on which all messages are recorded. The caller finishes it after the match.
    pub record: Option<Tape>,
}

impl MatchPlan {
    fn new(file: MatchFile, mut robots: Vec<RobotPlan>, registry: Registry) -> Option<MatchPlan> {
        // Sorts the teams, so that a match does not depend on their order in the file.
        let mut teams: Vec<TeamSetup> = file.teams.into_iter().map(|team| team.setup).collect();
        teams.sort_by_key(|team| team.number);
        robots.sort_by_key(|robot| (robot.team, robot.number));
        let teams = teams.try_into().ok()?;
        Some(MatchPlan {
            geometry: file.geometry,
            physics: file.physics,
            rules: file.rules,
            radio: file.radio,
            objects: file.objects,
            teams,
            robots,
            registry,
            listeners: Vec::new(),
            warnings: Vec::new(),
            league: None,
            files: ConfigurationBundle::default(),
            settings: String::new(),
            replace_bodies: Box::new(|_, _, body| body),
            addresses: None,
        })
    }

    /// Warnings about the files.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// Adds a listener that is called for every micro-step of every chart.
    pub fn listen(mut self, listener: Box<dyn ChartListener>) -> MatchPlan {
        self.listeners.push(listener);
        self
    }

    /// Whether robots have links to other processes, which do not wait for simulated time: the
    /// match [starts in real time](MatchPlan::start_in_real_time) only.
    pub fn has_links(&self) -> bool {
        self.robots.iter().any(|robot| !robot.links.is_empty())
    }

    /// Lets a GameController decide instead of the match's own referee: states, penalties and goals
    /// are those of the packets that arrive, which the robots receive as announcements, and each
    /// robot reports its pose and the ball. The match ends with the second half, or after a day.
    /// The caller of [`advance`](RunningMatch::advance) sets the pace.
    pub fn follow_gamecontroller(mut self, receiver: ControlReceiver) -> MatchPlan {
        self.league = Some(LeagueSetup::Players(receiver));
        self
    }

    /// Sends the decisions of the match's referee to robots elsewhere, twice a second, in packets
    /// of a rule book. The beginning of play and goals are hidden for `whistle_delay`. The caller
    /// of [`advance`](RunningMatch::advance) sets the pace.
    pub fn referee_others(
        mut self,
        sender: ControlSender,
        rules: RuleBook,
        whistle_delay: Duration,
    ) -> MatchPlan {
        self.league = Some(LeagueSetup::Referee(sender, rules, whistle_delay));
        self
    }

    /// The match file and all files it refers to, as they were read.
    pub fn files(&self) -> &ConfigurationBundle {
        &self.files
    }

    /// Replaces bodies on the field, given team, number and body: programs that command a body
    /// themselves take it over. Each replacement receives the body of the
    /// one before.
    pub fn replace_bodies(
        mut self,
        replace_bodies: impl Fn(u8, u8, Box<dyn Robot>) -> Box<dyn Robot> + Send + 'static,
    ) -> MatchPlan {
        let before = self.replace_bodies;
        self.replace_bodies =
            Box::new(move |team, number, body| replace_bodies(team, number, before(team, number, body)));
        self
    }

    /// The hosts of the robots whose agents run in processes of their own in real time.
    pub fn processes(&self) -> Vec<String> {
        self.robots.iter().filter(|robot| robot.has_process).map(|robot| robot.host.clone()).collect()
    }

    /// Leaves the agents of these robots to other processes when the match
    /// [starts in real time](MatchPlan::start_in_real_time): it serves their bodies at an address
    /// for each host. In simulated time, and without this, all agents run here.
    pub fn serve_bodies(mut self, address: impl Fn(&str) -> String + Send + 'static) -> MatchPlan {
        self.addresses = Some(Box::new(address));
        self
    }

    /// The agents of one robot with the body at an address, to be started in real time: the match
    /// itself runs in another process, which serves the body there.
    ///
    /// # Errors
    /// There is no such robot, or the body does not answer.
    pub fn robot(self, host: &str, address: &str) -> Result<Talws, Error> {
        let hosts: Vec<&str> = self.robots.iter().map(|robot| robot.host.as_str()).collect();
        let unknown = format!("the match has no robot `{host}`; there are {}", hosts.join(", "));
        let Some(robot) = self.robots.into_iter().find(|robot| robot.host == host) else {
            return Err(Error::refused(unknown));
        };
        let RobotPlan { team, number, host, agents, links, modules, body, source, .. } = robot;
        let body = BodySettings { address: Some(address.to_owned()), ..body };
        let body = body.open(None, u64::from(number)).map_err(|error| Error::body(&host, error))?;
        let (team, number, configuration) = (team.into(), number.into(), source);
        let mut talws = Talws::new().registry(self.registry);
        let body = Some(body);
        talws.host(HostConfig { name: host, team, number, body, agents, links, modules, configuration });
        for listener in self.listeners {
            talws.listen(listener);
        }
        Ok(talws)
    }

    /// Removes the agents of a team, whose robots then stay where they are placed.
    pub fn without_agents(mut self, team: u8) -> MatchPlan {
        for robot in self.robots.iter_mut().filter(|robot| robot.team == team) {
            robot.agents.clear();
        }
        self
    }

    /// The robots with their agents but without bodies, for replays.
    pub fn agents(self) -> Vec<HostConfig> {
        let host = |robot: RobotPlan| HostConfig {
            name: robot.host,
            team: robot.team.into(),
            number: robot.number.into(),
            body: None,
            agents: robot.agents,
            // Links name the peers; a replay opens none.
            links: robot.links,
            modules: robot.modules,
            configuration: robot.source,
        };
        self.robots.into_iter().map(host).collect()
    }

    /// The length of the match in simulated time.
    pub fn length(&self) -> Duration {
        if matches!(self.league, Some(LeagueSetup::Players(_))) {
            return MAX_EXTERNAL_MATCH;
        }
        Duration::from_secs_f64(2.0 * self.rules.half_duration)
    }

    /// The diagnostics that [`start`](MatchPlan::start) would give for the agents, without
    /// starting.
    ///
    /// # Errors
    /// The field rejects its parameters or the line-up.
    pub fn check(self) -> Result<Vec<Diagnostic>, Error> {
        // No body is opened: a robot need not be there when its configuration is checked.
        Ok(self.set_up(0, |_, _, _| Ok((None, false)))?.talws.check())
    }

    /// Starts the match in simulated time.
    ///
    /// # Errors
    /// The recording cannot be written, a part cannot be set up, or robots have links.
    pub fn start(self, options: MatchOptions) -> Result<RunningMatch, Error> {
        self.start_in(MatchTime::Simulated, options)
    }

    /// Starts the match in real time: the field advances on a thread of its own, and each body and
    /// the agents of each robot have threads, as on a robot. The match is no longer a function of
    /// its seed. A recording is one of real time: see [`Tape::create_real_time`].
    ///
    /// # Errors
    /// The recording cannot be written, or a part cannot be set up.
    pub fn start_in_real_time(self, options: MatchOptions) -> Result<RunningMatch, Error> {
        self.start_in(MatchTime::Real, options)
    }

    fn start_in(mut self, time: MatchTime, options: MatchOptions) -> Result<RunningMatch, Error> {
        let (length, files, settings) = (self.length(), self.files.clone(), self.settings.clone());
        let addresses = self.addresses.take();
        let is_elsewhere =
            |robot: &&RobotPlan| matches!(time, MatchTime::Real) && addresses.is_some() && robot.has_process;
        let here = self.robots.iter().filter(|robot| !is_elsewhere(robot));
        let hosts: Vec<String> = here.map(|robot| robot.host.clone()).collect();
        let parts =
            self.set_up(options.seed, |robot, simulated, index| match (time, simulated, &addresses) {
                (MatchTime::Real, Some(simulated), Some(address)) if robot.has_process => {
                    robot.body.serve(simulated, address(&robot.host)).map(|body| (Some(body), true))
                }
                (_, simulated, _) => {
                    let seed = options.seed.wrapping_add(index as u64);
                    robot.body.open(simulated, seed).map(|body| (Some(body), false))
                }
            })?;
        let MatchParts { mut talws, pitch, league } = parts;
        let hash = RunHash::new();
        talws.observe(Box::new(hash.clone()));
        let tape = options.record;
        if let Some(tape) = &tape {
            let labelled = match time {
                MatchTime::Simulated => {
                    monas_recording::label_simulated(tape, &files, &settings, options.seed, &hosts)
                }
                MatchTime::Real => monas_recording::label_real_time(tape, &files, &settings, &hosts),
            };
            labelled.map_err(Error::recording)?;
            talws.observe(Box::new(tape.clone()));
        }
        let run = match time {
            MatchTime::Simulated => {
                talws.simulate(options.seed).map(|run| MatchRun::Simulated(Box::new(run)))
            }
            MatchTime::Real => talws.start().map(MatchRun::RealTime),
        };
        Ok(RunningMatch::new(run.map_err(Error::agents)?, pitch, hash, tape, length, league))
    }

    /// The robots with their bodies, which `open` opens over those on the field; it also returns
    /// whether the agents of the robot are elsewhere.
    fn set_up(
        self,
        seed: u64,
        open: impl Fn(
            &RobotPlan,
            Option<Box<dyn Robot>>,
            usize,
        ) -> Result<(Option<Box<dyn Robot>>, bool), monas_robot::Error>,
    ) -> Result<MatchParts, Error> {
        let lineup =
            self.robots.iter().map(|robot| monas_sim::RobotSetup { team: robot.team, number: robot.number });
        let setup = Setup {
            field: self.geometry,
            physics: self.physics,
            rules: self.rules,
            radio: self.radio,
            objects: self.objects,
            teams: self.teams,
            robots: lineup.collect(),
            seed,
        };
        let pitch = SharedField::new(SimulatedWorld::new(setup).map_err(Error::field)?);
        let hosts: Vec<String> = self.robots.iter().map(|robot| robot.host.clone()).collect();
        let mut talws = Talws::new().registry(self.registry);
        let league = self.league.map(|setup| match setup {
            LeagueSetup::Players(receiver) => {
                pitch.await_league();
                let players = LeaguePlayers::new(receiver, &pitch, hosts);
                talws.observe(players.beliefs());
                League::new(Box::new(players))
            }
            LeagueSetup::Referee(sender, rules, delay) => {
                League::new(Box::new(LeagueReferee::new(sender, rules, delay)))
            }
        });
        for (index, robot) in self.robots.into_iter().enumerate() {
            let simulated = pitch.body(index).map(|body| Box::new(body) as _);
            let (body, is_elsewhere) =
                open(&robot, simulated, index).map_err(|error| Error::body(&robot.host, error))?;
            let RobotPlan { team, number, host, mut agents, mut links, modules, source, .. } = robot;
            if is_elsewhere {
                (agents, links) = (Vec::new(), Vec::new());
            }
            let body = body.map(|body| (self.replace_bodies)(team, number, body));
            let (team, number) = (team.into(), number.into());
            let configuration = source;
            talws.host(HostConfig { name: host, team, number, body, agents, links, modules, configuration });
        }
        talws.world(Box::new(MatchWorld::new(pitch.clone(), league.clone())));
        for listener in self.listeners {
            talws.listen(listener);
        }
        Ok(MatchParts { talws, pitch, league })
    }
}
