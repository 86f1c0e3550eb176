//! A thousand random changes of agents while others run, in real time, compared with a run without
//! changes: how many cycles do the others miss?
//!
//! `cargo run -p monas --example changes -- 5 10` makes five pairs of runs of ten seconds each, the
//! two of a pair one after the other, and prints a line for each run. Other load of the computer
//! affects both.

#[path = "../tests/monas/changes.rs"]
mod changes;

use std::process::ExitCode;
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use monas::{Agent, AgentStatistics, Blackboard, Error, Hz, Progress, Registry, Talws};
use narukom::Random;
use yase::{Source, Statechart};

use changes::{MODELS, any_change};

const CHANGES: u64 = 1000;
/// Agents that are not changed, with their frequencies in Hz.
const UNCHANGED_AGENTS: [(&str, f64); 3] = [("calm", 100.0), ("quick", 1000.0), ("steady", 50.0)];

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|word| word.parse::<u64>());
    let (rounds, seconds) = match (arguments.next(), arguments.next()) {
        (None, None) => (3, 10),
        (Some(Ok(rounds)), Some(Ok(seconds))) => (rounds, seconds),
        _ => {
            eprintln!("say how many pairs of runs, and of how many seconds: `changes 3 10`");
            return ExitCode::from(2);
        }
    };
    println!("{:>5}  {:>7}  {:>5}  {:>7}  {}", "round", "changes", "made", "seconds", heading());
    for round in 1..=rounds {
        for count in [0, CHANGES] {
            match run(count, Duration::from_secs(seconds), round) {
                Ok(row) => println!("{round:>5}  {row}"),
                Err(error) => {
                    eprintln!("{error}");
                    return ExitCode::FAILURE;
                }
            }
        }
    }
    ExitCode::SUCCESS
}

fn heading() -> String {
    UNCHANGED_AGENTS.map(|(name, hertz)| format!("{:>22}", format!("{name} ({hertz} Hz): missed"))).join("  ")
}

fn chart(text: &str) -> Statechart {
    aseme_models::statechart_of(&Source::new("m.srm", text)).0
}

/// Repeated work of a fraction of a millisecond, in a chart.
fn works(blackboard: &mut Blackboard) -> Progress {
    let sum: f64 = (0..5_000).map(|_| blackboard.random().uniform()).sum();
    std::hint::black_box(sum);
    Progress::after(Duration::from_millis(5))
}

fn rests(_: &mut Blackboard) -> Progress {
    Progress::after(Duration::from_millis(5))
}

/// Agents that are not changed, and agents that are.
fn agents() -> Result<Talws, Error> {
    let registry = Registry::empty().with("W", || works).with("V", || rests);
    let mut talws = Talws::new().registry(registry.clone());
    for (name, hertz) in UNCHANGED_AGENTS {
        let agent = match name {
            "steady" => Agent::statechart(name, chart("m = V")).every(Hz(hertz)),
            _ => Agent::new(name, Hz(hertz)).named_activity("W", registry.activity("W")?),
        };
        talws = talws.agent(agent);
    }
    for number in 0..4 {
        let agent = Agent::new(format!("x{number}"), Hz(30 * (number + 1)));
        let agent = agent.named_activity("W", registry.activity("W")?);
        talws = talws.agent(agent.named_activity("V", registry.activity("V")?));
    }
    Ok(talws.agent(Agent::statechart("y", chart(MODELS[0]))))
}

/// Runs for a duration with a number of changes, and prints the cycles missed by the others.
#[expect(clippy::disallowed_methods, reason = "this is about real time")]
fn run(count: u64, length: Duration, seed: u64) -> Result<String, Error> {
    let running = agents()?.start()?;
    let (overview, begun) = (running.run_handle(), Instant::now());
    let mut random = Random::from_seed([u8::try_from(seed).unwrap_or(u8::MAX); 32]);
    let mut made = 0_u64;
    for number in 1..=count {
        let due = length.mul_f64(number as f64 / count as f64);
        wait(due.saturating_sub(begun.elapsed()));
        // Rejected changes are answered too.
        made += u64::from(
            overview.change("local", any_change(number, &mut random)).is_ok_and(|changed| changed.done),
        );
    }
    wait(length.saturating_sub(begun.elapsed()));
    let took = begun.elapsed();
    let agents = running.stop().agents;
    let missed = UNCHANGED_AGENTS.map(|(name, hertz)| {
        let agent = agents.iter().find(|agent| agent.agent == name);
        format!("{:>22}", agent.map_or_else(String::new, |agent| missed_cycles(agent, hertz, took)))
    });
    Ok(format!("{count:>7}  {made:>5}  {:>7.1}  {}", took.as_secs_f64(), missed.join("  ")))
}

fn wait(length: Duration) {
    let (_open, never) = channel::<()>();
    // The sender never sends: this only waits.
    let _ = never.recv_timeout(length);
}

/// The number of missing cycles; for a chart, of periods without a wake-up.
fn missed_cycles(agent: &AgentStatistics, hertz: f64, took: Duration) -> String {
    let due = (took.as_secs_f64() * hertz) as u64;
    let missed = due.saturating_sub(agent.cycles).max(agent.missed);
    format!("{missed} of {due}")
}
