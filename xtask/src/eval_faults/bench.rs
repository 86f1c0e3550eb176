//! The stages that a fault passes until one finds it, in a copy of the workspace.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use super::behaviour_patch::{BehaviourPatch, Methodology};
use crate::faults::copy::WorkspaceCopy;

/// A check that can find a fault.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Finder {
    /// An error or a warning of the compiler.
    Compiler,
    /// A finding of `monas model check` in a role, or of `monas config check` in a configuration.
    Check,
    /// A failed test of decisions: unit tests, and scenarios of a role.
    Tests,
    /// A match that fails, or counts that differ from those of the unchanged methodology.
    Matches,
    /// Nothing.
    NotFound,
}

impl Finder {
    pub(crate) const ALL: [Finder; 5] =
        [Finder::Compiler, Finder::Check, Finder::Tests, Finder::Matches, Finder::NotFound];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Finder::Compiler => "compiler",
            Finder::Check => "check",
            Finder::Tests => "tests",
            Finder::Matches => "matches",
            Finder::NotFound => "not found",
        }
    }

    /// The name of its sum.
    pub(crate) fn sum(self) -> &'static str {
        match self {
            Finder::Compiler => "found by the compiler",
            Finder::Check => "found by checks of model or configuration",
            Finder::Tests => "found by tests of decisions",
            Finder::Matches => "found by matches",
            Finder::NotFound => "not found",
        }
    }
}

/// The check that has found a fault, and its message.
pub(crate) struct Finding {
    pub(crate) finder: Finder,
    pub(crate) evidence: String,
}

/// The sums of the matches of a methodology.
type Counts = BTreeMap<String, f64>;

/// Seeds of the matches in halves, which are played at the same time.
const SEEDS: [(u32, u32); 2] = [(1, 5), (6, 10)];
/// Seeds of the unchanged methodology in matches that have to be like those of `SEEDS`.
const OTHER_SEEDS: [(u32, u32); 2] = [(11, 15), (16, 20)];
/// The simulated time of a match, seconds.
const SECONDS: &str = "600";
/// A count differs if it is more than this number of standard deviations away, where both counts
/// have the variance of a Poisson distribution.
const DEVIATIONS: f64 = 3.0;

/// The match in which blue is built as roles from the changed models, and red from unchanged ones.
const ASEME_MATCH: &str = "config/evaluation/aseme.xml";
/// The folder of the roles of red, relative to the workspace.
const OPPONENT: &str = "config/evaluation/opponent";

/// A copy of the workspace, the command `monas`, and what the unchanged methodologies do.
pub(crate) struct Bench {
    copy: WorkspaceCopy,
    monas: PathBuf,
    /// The findings of the checks of the unchanged sources, by arguments of the command.
    sound: BTreeMap<Vec<String>, String>,
    counts: BTreeMap<Methodology, Counts>,
}

impl Bench {
    /// Builds the programs, and requires that no stage finds a fault without a change.
    pub(crate) fn build(root: &Path) -> Result<Bench, Box<dyn Error>> {
        let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
        // with the features of the tests, so that nothing is built twice
        let mut build = cargo(root);
        build.args(["build", "--quiet", "--locked", "--workspace", "--bin", "monas"]);
        if !build.stderr(Stdio::inherit()).status()?.success() {
            return Err("the command `monas` does not build".into());
        }
        let monas = root.join(target).join("debug").join(format!("monas{}", std::env::consts::EXE_SUFFIX));
        let copy = WorkspaceCopy::make(root, "eval-faults")?;
        prepare_roles(&copy)?;
        let mut bench = Bench { copy, monas, sound: BTreeMap::new(), counts: BTreeMap::new() };
        for player in ["goalie", "attacker"] {
            for arguments in model_checks(player) {
                bench.learn(arguments)?;
            }
        }
        bench.learn(configuration_check())?;
        for methodology in Methodology::ALL {
            bench.learn_counts(methodology)?;
        }
        Ok(bench)
    }

    /// Notes what a check reports of the unchanged sources.
    fn learn(&mut self, arguments: Vec<String>) -> Result<(), Box<dyn Error>> {
        let output = self.monas(&arguments)?;
        if !output.status.success() {
            return Err(format!("monas {}: {}", arguments.join(" "), text(&output)).into());
        }
        self.sound.insert(arguments, text(&output));
        Ok(())
    }

    /// Plays the unchanged methodology, which has to pass all stages, with other seeds too.
    fn learn_counts(&mut self, methodology: Methodology) -> Result<(), Box<dyn Error>> {
        for player in ["goalie", "attacker"] {
            let first = [
                self.compile(methodology)?,
                self.check(methodology, player)?,
                self.test(methodology, player)?,
            ];
            if let Some(evidence) = first.into_iter().flatten().next() {
                return Err(format!("{} without a fault: {evidence}", methodology.name()).into());
            }
        }
        let counts =
            self.play(methodology, SEEDS)?.map_err(|error| format!("{}: {error}", methodology.name()))?;
        let others = self
            .play(methodology, OTHER_SEEDS)?
            .map_err(|error| format!("{}: {error}", methodology.name()))?;
        println!("{:<24} {:<8} {}", "without a fault", methodology.name(), sums(&counts));
        println!("{:<24} {:<8} {}", "with other seeds", methodology.name(), sums(&others));
        if let Some(evidence) = difference(&counts, &others) {
            return Err(format!("{}: other seeds are found: {evidence}", methodology.name()).into());
        }
        self.counts.insert(methodology, counts);
        Ok(())
    }

    /// Makes a fault in a methodology and runs the stages until one finds it.
    pub(crate) fn find(
        &self,
        methodology: Methodology,
        fault: &BehaviourPatch,
    ) -> Result<Finding, Box<dyn Error>> {
        let changed = fault.apply(methodology, |file| self.copy.read(file))?;
        self.copy.with(&changed, || self.first_finding(methodology, &fault.player))?
    }

    /// Makes a change request in a methodology, which no stage before the matches may find; returns
    /// the time from the edit until the program runs.
    #[expect(clippy::disallowed_methods, reason = "it measures a build")]
    pub(crate) fn adopt(
        &self,
        methodology: Methodology,
        change: &BehaviourPatch,
    ) -> Result<Duration, Box<dyn Error>> {
        let changed = change.apply(methodology, |file| Ok(self.copy.read(file).unwrap_or_default()))?;
        self.copy.with(&changed, || {
            let began = Instant::now();
            let compiled = self.compile(methodology)?;
            let built = began.elapsed();
            let found =
                [compiled, self.check(methodology, &change.player)?, self.test(methodology, &change.player)?];
            match found.into_iter().flatten().next() {
                Some(evidence) => Err(format!("{} ({}): {evidence}", change.name, methodology.name()).into()),
                None => Ok(built),
            }
        })?
    }

    fn first_finding(&self, methodology: Methodology, player: &str) -> Result<Finding, Box<dyn Error>> {
        let finding = |finder, evidence| Ok(Finding { finder, evidence });
        if let Some(evidence) = self.compile(methodology)? {
            return finding(Finder::Compiler, evidence);
        }
        if let Some(evidence) = self.check(methodology, player)? {
            return finding(Finder::Check, evidence);
        }
        if let Some(evidence) = self.test(methodology, player)? {
            return finding(Finder::Tests, evidence);
        }
        let counts = match self.play(methodology, SEEDS)? {
            Ok(counts) => counts,
            Err(evidence) => return finding(Finder::Matches, evidence),
        };
        let unchanged = self.counts.get(&methodology).ok_or("the unchanged methodology was not played")?;
        match difference(unchanged, &counts) {
            Some(evidence) => finding(Finder::Matches, evidence),
            None => finding(Finder::NotFound, sums(&counts)),
        }
    }

    /// The first error or warning of the compiler. A role is not compiled.
    fn compile(&self, methodology: Methodology) -> Result<Option<String>, Box<dyn Error>> {
        let output = match methodology {
            Methodology::Direct | Methodology::Agents => self.cargo(&["build", "--example", "play"])?,
            Methodology::Aseme => return Ok(None),
        };
        let said = String::from_utf8_lossy(&output.stderr);
        let first = said.lines().find(|line| is_finding(line));
        match (first, output.status.success()) {
            (Some(line), _) => Ok(Some(line.to_owned())),
            (None, true) => Ok(None),
            (None, false) => Err(said.into()),
        }
    }

    /// The first line of a check that is not in that of the unchanged sources.
    fn check(&self, methodology: Methodology, player: &str) -> Result<Option<String>, Box<dyn Error>> {
        let checks = match methodology {
            Methodology::Direct => return Ok(None),
            Methodology::Agents => vec![configuration_check()],
            Methodology::Aseme => model_checks(player).into(),
        };
        for arguments in checks {
            let output = self.monas(&arguments)?;
            let (said, sound) = (text(&output), self.sound.get(&arguments).map_or("", String::as_str));
            let is_new = |line: &&str| !sound.contains(*line);
            if let Some(line) = said.lines().filter(is_new).find(|line| is_finding(line)) {
                return Ok(Some(line.to_owned()));
            }
            if !output.status.success() {
                return Ok(Some(said.lines().find(is_new).unwrap_or("it fails").to_owned()));
            }
        }
        Ok(None)
    }

    /// The first failed test of decisions.
    fn test(&self, methodology: Methodology, player: &str) -> Result<Option<String>, Box<dyn Error>> {
        if methodology == Methodology::Aseme {
            return self.run_scenarios(player);
        }
        let filter = format!("{}::", methodology.name());
        let output = self.cargo(&["test", "--lib", "--", &filter])?;
        let said = text(&output);
        let failed = said.lines().find_map(|line| line.strip_suffix(" --- FAILED"));
        match (failed, output.status.success()) {
            (Some(line), _) => Ok(Some(line.to_owned())),
            (None, true) => Ok(None),
            (None, false) => Err(format!("{said}{}", String::from_utf8_lossy(&output.stderr)).into()),
        }
    }

    /// Plays the scenarios of a role; the first that fails.
    fn run_scenarios(&self, player: &str) -> Result<Option<String>, Box<dyn Error>> {
        let folder = format!("tests/scenarios/{player}");
        let mut files: Vec<PathBuf> = fs::read_dir(self.copy.sources.join(&folder))?
            .map(|entry| Ok(entry?.path()))
            .collect::<Result<_, Box<dyn Error>>>()?;
        files.sort();
        for file in files {
            let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let model = format!("models/{player}.srm");
            let output =
                self.monas(&["model", "run", &model, &format!("{folder}/{name}")].map(str::to_owned))?;
            if !output.status.success() {
                return Ok(Some(name));
            }
        }
        Ok(None)
    }

    /// The sums of the matches of a methodology, or why one cannot be played.
    fn play(
        &self,
        methodology: Methodology,
        seeds: [(u32, u32); 2],
    ) -> Result<Result<Counts, String>, Box<dyn Error>> {
        let (file, direct) = match methodology {
            Methodology::Direct => ("config/evaluation/direct.xml", Some("direct")),
            Methodology::Agents => ("config/evaluation/agents.xml", None),
            Methodology::Aseme => (ASEME_MATCH, None),
        };
        if methodology == Methodology::Aseme {
            copy_roles(&self.copy, "config/evaluation/blue")?;
        }
        let program = self.copy.target.join("release/examples/play");
        let children: Vec<_> = seeds
            .iter()
            .map(|(first, last)| {
                let mut command = Command::new(&program);
                command.current_dir(&self.copy.sources).arg(file);
                command.args([&first.to_string(), &last.to_string(), SECONDS]).args(direct);
                command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()
            })
            .collect::<Result<_, _>>()?;
        let outputs: Vec<Output> =
            children.into_iter().map(|child| child.wait_with_output()).collect::<Result<_, _>>()?;
        let mut counts = Counts::new();
        for output in outputs {
            if !output.status.success() {
                let said = String::from_utf8_lossy(&output.stderr);
                return Ok(Err(said.lines().next().unwrap_or("it fails").to_owned()));
            }
            for line in text(&output).lines() {
                let (name, count) = line.rsplit_once(' ').ok_or("`play` prints names and counts")?;
                *counts.entry(name.to_owned()).or_default() += count.parse::<f64>()?;
            }
        }
        Ok(Ok(counts))
    }

    fn monas(&self, arguments: &[String]) -> Result<Output, Box<dyn Error>> {
        Ok(Command::new(&self.monas).current_dir(&self.copy.sources).args(arguments).output()?)
    }

    fn cargo(&self, arguments: &[&str]) -> Result<Output, Box<dyn Error>> {
        let mut command = cargo(&self.copy.sources);
        let (task, rest) = arguments.split_first().ok_or("no arguments")?;
        command.args([task, "--locked", "--quiet", "--release", "--package", "monas-eval"]).args(rest);
        Ok(command.env("CARGO_TARGET_DIR", &self.copy.target).output()?)
    }
}

fn cargo(folder: &Path) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(folder);
    command
}

/// The checks of a role, as arguments of the command.
fn model_checks(player: &str) -> [Vec<String>; 2] {
    let (model, properties) = (format!("models/{player}.srm"), format!("models/{player}.properties"));
    let check = ["model", "check", &model].map(str::to_owned).to_vec();
    let with_properties = [check.clone(), vec!["--properties".to_owned(), properties]].concat();
    [check, with_properties]
}

fn configuration_check() -> Vec<String> {
    ["config", "check", "config/evaluation/agents.xml"].map(str::to_owned).to_vec()
}

/// Whether a line of the compiler or of a check starts an error or a warning.
fn is_finding(line: &str) -> bool {
    ["error: ", "error[", "warning: ", "warning["].iter().any(|severity| line.starts_with(severity))
}

/// Writes the match of roles, with unchanged roles for red.
fn prepare_roles(copy: &WorkspaceCopy) -> Result<(), Box<dyn Error>> {
    copy_roles(copy, OPPONENT)?;
    let file = copy.read("config/match.xml")?;
    let (blue, red) = file.split_once("<team number=\"2\"").ok_or("config/match.xml has no second team")?;
    let replaced =
        |team: &str, folder: &str| team.replace("role=\"config/roles/", &format!("role=\"{folder}/"));
    let text =
        format!("{}<team number=\"2\"{}", replaced(blue, "config/evaluation/blue"), replaced(red, OPPONENT));
    copy.write(ASEME_MATCH, &text)
}

/// Copies roles and their models into a folder, in which the roles find these models first.
fn copy_roles(copy: &WorkspaceCopy, folder: &str) -> Result<(), Box<dyn Error>> {
    for player in ["goalie", "attacker"] {
        let model = format!("models/{player}.srm");
        copy.write(&format!("{folder}/{player}.xml"), &copy.read(&format!("config/roles/{player}.xml"))?)?;
        copy.write(&format!("{folder}/{model}"), &copy.read(&model)?)?;
    }
    Ok(())
}

fn text(output: &Output) -> String {
    let [out, err] =
        [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    out + &err
}

/// The first count that differs.
fn difference(unchanged: &Counts, counts: &Counts) -> Option<String> {
    unchanged.iter().find_map(|(name, before)| {
        let after = counts.get(name).copied().unwrap_or_default();
        let is_off = (after - before).abs() > DEVIATIONS * (after + before).sqrt();
        is_off.then(|| format!("{name}: {after} for {before}"))
    })
}

fn sums(counts: &Counts) -> String {
    counts.iter().map(|(name, count)| format!("{name} {count}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_count_differs_beyond_three_standard_deviations() {
        let counts = |shots| Counts::from([("shots".to_owned(), shots)]);
        assert_eq!(difference(&counts(200.0), &counts(145.0)), None);
        assert_eq!(difference(&counts(200.0), &counts(140.0)), Some("shots: 140 for 200".into()));
        assert!(difference(&counts(20.0), &Counts::new()).is_some(), "a count that is missing is zero");
    }

    #[test]
    fn errors_and_warnings_are_findings() {
        assert!(is_finding("warning[M12]: the guard is never true"));
        assert!(!is_finding("models/a.srm: 30 states, no errors"));
    }
}
