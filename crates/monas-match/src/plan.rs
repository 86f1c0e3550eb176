//! A match that was read and found to be right, not yet begun.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use monas::config::{self, Element, Grammar, Layers};
use monas::{Agent, ChartListener, HostConfig, LinkConfig, Module, Provenance, Registry, RunHash, Talws};
use monas_sim::{FieldGeometry, Physics, Pitch, Rules, Setup, TeamSetup, World};
use yase::{Diagnostic, Source};

use crate::error::Error;
use crate::file::{self, MatchFile};
use crate::label;
use crate::running::RunningMatch;
use crate::settings::Settings;
use crate::stage::Stage;

/// Where matches come from.
#[derive(Debug)]
pub struct Match;

impl Match {
    /// Reads a match file and everything it names, and binds every chart; nothing runs.
    ///
    /// # Errors
    /// Every diagnostic of every file, each once.
    pub fn load(path: impl AsRef<Path>, registry: &Registry) -> Result<MatchPlan, Vec<Diagnostic>> {
        Match::load_with(path, registry, &Layers::new())
    }

    /// As [`load`](Match::load), with layers over the files.
    ///
    /// # Errors
    /// Every diagnostic of every file, each once.
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
                    Ok(MatchPlan { warnings: once, files: Provenance::of(path), settings, ..plan })
                }
                None => Err(once),
            },
            None => Err(once),
        }
    }

    /// What a match file and all it names come to, with layers over them, and what is wrong with them; names of activities and models
    /// are not looked up. The elements are those of [`grammar`](crate::grammar).
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
    let (mut settings, mut registry) = (Settings::new(layers), registry.clone());
    for team in &file.teams {
        for robot in &team.robots {
            let resolved = config::resolve(&robot.role, &Grammar::agents(), &settings.over(&robot.own));
            diagnostics.extend(resolved.diagnostics);
            diagnostics.extend(settings.unmatched(&robot.own, resolved.unmatched));
            let setup = config::assemble(&resolved.elements, &robot.role, &registry, diagnostics);
            let config::Setup { agents, links, modules, source } = setup;
            // What one has loaded the next need not load again.
            registry = modules
                .iter()
                .fold(registry, |registry, module| registry.with_module(module.clone()).unwrap_or(registry));
            let host = format!("{}-{}", file::host_name(&team.setup.name), robot.number);
            robots.push(RobotPlan {
                team: team.setup.number,
                number: robot.number,
                host,
                agents,
                links,
                modules,
                source,
            });
        }
    }
    diagnostics.extend(settings.of_nobody());
    robots
}

/// Robots of one role have the same things wrong with them.
fn each_once(diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    diagnostics.into_iter().fold(Vec::new(), |mut once, diagnostic| {
        if !once.contains(&diagnostic) {
            once.push(diagnostic);
        }
        once
    })
}

/// A match that was read and found to be right.
pub struct MatchPlan {
    geometry: FieldGeometry,
    physics: Physics,
    rules: Rules,
    teams: [TeamSetup; 2],
    robots: Vec<RobotPlan>,
    registry: Registry,
    listeners: Vec<Box<dyn ChartListener>>,
    warnings: Vec<Diagnostic>,
    is_linked: bool,
    files: Provenance,
    settings: String,
}

impl std::fmt::Debug for MatchPlan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MatchPlan")
            .field("teams", &self.teams)
            .field("robots", &self.robots)
            .finish_non_exhaustive()
    }
}

/// A robot of a match and what runs on it.
#[derive(Debug)]
struct RobotPlan {
    team: u8,
    number: u8,
    host: String,
    agents: Vec<Agent>,
    links: Vec<LinkConfig>,
    modules: Vec<Module>,
    /// The text of its role.
    source: Option<Arc<Source>>,
}

/// How a match is to be played.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Options {
    /// Where every random number comes from.
    pub seed: u64,
    /// The file into which every message is recorded.
    pub record: Option<PathBuf>,
}

impl MatchPlan {
    fn new(file: MatchFile, mut robots: Vec<RobotPlan>, registry: Registry) -> Option<MatchPlan> {
        // The order in the file means nothing, so that a match does not depend on it.
        let mut teams: Vec<TeamSetup> = file.teams.into_iter().map(|team| team.setup).collect();
        teams.sort_by_key(|team| team.number);
        robots.sort_by_key(|robot| (robot.team, robot.number));
        let teams = teams.try_into().ok()?;
        Some(MatchPlan {
            geometry: file.geometry,
            physics: file.physics,
            rules: file.rules,
            teams,
            robots,
            registry,
            listeners: Vec::new(),
            warnings: Vec::new(),
            is_linked: false,
            files: Provenance::default(),
            settings: String::new(),
        })
    }

    /// What is odd about the files, though they can be used.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// Lets a listener see every micro-step of every chart.
    pub fn listen(mut self, listener: Box<dyn ChartListener>) -> MatchPlan {
        self.listeners.push(listener);
        self
    }

    /// Whether robots have links to other processes.
    pub fn has_links(&self) -> bool {
        self.robots.iter().any(|robot| !robot.links.is_empty())
    }

    /// Opens the links of the robots when the match begins. Then whoever [advances](RunningMatch::advance) it paces it, and it is a
    /// function of its seed no longer. Without this a match with links is refused.
    pub fn linked(mut self) -> MatchPlan {
        self.is_linked = true;
        self
    }

    /// The match file and all that it names, as they were read.
    pub fn files(&self) -> &Provenance {
        &self.files
    }

    /// The robots with their agents and without their bodies: for replays.
    pub fn agents(self) -> Vec<HostConfig> {
        let host = |robot: RobotPlan| HostConfig {
            name: robot.host,
            team: robot.team.into(),
            number: robot.number.into(),
            body: None,
            agents: robot.agents,
            // Who is heard of is known by them; a replay opens none.
            links: robot.links,
            modules: robot.modules,
            configuration: robot.source,
        };
        self.robots.into_iter().map(host).collect()
    }

    /// How long the match takes, in simulated time.
    pub fn length(&self) -> Duration {
        Duration::from_secs_f64(2.0 * self.rules.half_duration)
    }

    /// What [`start`](MatchPlan::start) would say of the agents, without a start.
    ///
    /// # Errors
    /// The field refuses its parameters or the line-up.
    pub fn check(self) -> Result<Vec<Diagnostic>, Error> {
        Ok(self.set_up(0)?.0.check())
    }

    /// Begins the match.
    ///
    /// # Errors
    /// The recording cannot be written, or a part refuses to be set up.
    pub fn start(self, options: Options) -> Result<RunningMatch, Error> {
        let (length, is_linked, files) = (self.length(), self.is_linked, self.files.clone());
        let settings = self.settings.clone();
        let hosts: Vec<String> = self.robots.iter().map(|robot| robot.host.clone()).collect();
        let (mut talws, pitch) = self.set_up(options.seed)?;
        let hash = RunHash::new();
        talws.observe(Box::new(hash.clone()));
        let tape = options.record.map(|path| {
            let tape = label::simulated(&path, &files, &settings, options.seed, &hosts);
            Ok((tape.map_err(|error| Error::recording(&path, error))?, path))
        });
        let tape = tape.transpose()?;
        if let Some((tape, _)) = &tape {
            talws.observe(Box::new(tape.clone()));
        }
        let simulation = match is_linked {
            true => talws.simulate_linked(options.seed),
            false => talws.simulate(options.seed),
        };
        let simulation = simulation.map_err(Error::agents)?;
        Ok(RunningMatch::new(simulation, pitch, hash, tape, length))
    }

    /// The robots with their bodies on the field.
    fn set_up(self, seed: u64) -> Result<(Talws, Pitch), Error> {
        let lineup =
            self.robots.iter().map(|robot| monas_sim::RobotSetup { team: robot.team, number: robot.number });
        let setup = Setup {
            field: self.geometry,
            physics: self.physics,
            rules: self.rules,
            teams: self.teams,
            robots: lineup.collect(),
            seed,
        };
        let pitch = Pitch::new(World::new(setup).map_err(Error::field)?);
        let mut talws = Talws::new().registry(self.registry);
        for (index, robot) in self.robots.into_iter().enumerate() {
            let RobotPlan { team, number, host, agents, links, modules, source } = robot;
            let body = pitch.body(index).map(|body| Box::new(body) as _);
            let (team, number) = (team.into(), number.into());
            let configuration = source;
            talws.host(HostConfig { name: host, team, number, body, agents, links, modules, configuration });
        }
        talws.world(Box::new(Stage::new(pitch.clone())));
        for listener in self.listeners {
            talws.listen(listener);
        }
        Ok((talws, pitch))
    }
}
