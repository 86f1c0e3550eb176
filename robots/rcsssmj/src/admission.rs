//! Joining a server that was just started, so that each run begins with the same state.
//!
//! A server without agents runs its cycles as fast as it can. The cycle in which an agent joins
//! depends on the computer, and so do the server's time and the last digits of its physics.
//! Therefore another robot, the holder, joins first and keeps the server in lockstep until a fixed
//! cycle. Then the player joins, the holder leaves, and the ball is placed anew. When the holder
//! leaves, the server recompiles its world and discards the state of its solver; the player goes to
//! its place in the cycle after that. The states of two runs are equal from there on, bit for bit.

use std::time::Duration;

use crate::connection::{Connection, pause};
use crate::effector::Effectors;
use crate::error::Error;
use crate::humanoid::Humanoid;
use crate::monitor::{Command, Monitor};
use crate::options::Options;
use crate::percept::Percept;
use crate::server::Server;

/// The cycle whose percepts the player receives first. Monitors receive the state after a cycle
/// with an odd number.
const FIRST_CYCLE: u64 = 1001;
/// The number of attempts to start a server and to join it in time.
const MAX_ATTEMPTS: u32 = 10;
/// The time for the server to reach the point where it waits for an agent, and to admit another
/// agent meanwhile. Each further attempt adds this time, for busy computers.
const TAKING_IN: Duration = Duration::from_millis(60);
/// The time for the server to send what it has already computed.
const SEND_TIMEOUT: Duration = Duration::from_secs(2);
/// The middle of a ball on the centre spot, m.
const BALL_ON_CENTRE_SPOT: [f64; 3] = [0.0, 0.0, 0.11];

/// A server with the player, which has not answered its first percepts yet.
pub(crate) struct Admission {
    pub(crate) server: Server,
    pub(crate) player: Connection,
}

impl Admission {
    /// Starts a server and joins it.
    ///
    /// # Errors
    /// The server cannot be started, or no attempt joins it in time.
    pub(crate) fn new(options: &Options) -> Result<Admission, Error> {
        for attempt in 1..=MAX_ATTEMPTS {
            let mut server = Server::start(options.server.as_deref(), true)?;
            // Connected before the first cycle: the threads of a busy server wait for each other.
            let holder = server.agent()?;
            let monitor = server.monitor()?;
            if let Some(player) = join(&server, holder, monitor, options, TAKING_IN * attempt)? {
                return Ok(Admission { server, player });
            }
        }
        let what = format!("the server was not joined within {FIRST_CYCLE} cycles, {MAX_ATTEMPTS} times");
        Err(Error::disconnected(format!("{what}; is the computer very busy?")))
    }
}

/// Joins so that the player's first percepts are those of [`FIRST_CYCLE`]; none if it was missed.
fn join(
    server: &Server,
    mut holder: Connection,
    mut monitor: Monitor,
    options: &Options,
    taking_in: Duration,
) -> Result<Option<Connection>, Error> {
    // A player number other than the player's.
    let number = if options.number > 1 { options.number - 1 } else { 2 };
    init(&mut holder, options, number)?;
    let mut cycle = holder.receive(|message| cycle(message, options.robot))?;
    if cycle > FIRST_CYCLE - 2 {
        return Ok(None);
    }
    while cycle < FIRST_CYCLE - 2 {
        cycle = hold(&mut holder, options.robot)?;
        monitor.drain()?;
    }
    // The server finds new agents when it begins a cycle. It has begun the next one, and not the
    // one after it, once it waits for the holder's answer.
    monitor.wait_beyond(time(FIRST_CYCLE - 2))?;
    pause(taking_in);
    let mut player = Connection::open(server.agents())?;
    init(&mut player, options, options.number)?;
    pause(taking_in);
    hold(&mut holder, options.robot)?;
    hold(&mut holder, options.robot)?;
    let Some(message) = player.receive_within(SEND_TIMEOUT)? else { return Ok(None) };
    if self::cycle(message, options.robot)? != FIRST_CYCLE {
        return Ok(None);
    }
    // The server now waits for the answers, and processes what arrives in the next cycle.
    monitor.wait_beyond(time(FIRST_CYCLE))?;
    holder.finish()?;
    monitor.send(&Command::PlaceBall { at: BALL_ON_CENTRE_SPOT, velocity: [0.0; 3] })?;
    monitor.finish()?;
    Ok(Some(player))
}

fn init(agent: &mut Connection, options: &Options, number: u32) -> Result<(), Error> {
    let mut message = Effectors::default();
    message.init(options.robot, &options.team, number);
    agent.send(message.as_bytes())
}

/// Lets the server run one cycle; returns the number of the cycle.
fn hold(agent: &mut Connection, robot: &Humanoid) -> Result<u64, Error> {
    let mut message = Effectors::default();
    message.synchronize();
    agent.send(message.as_bytes())?;
    agent.receive(|message| cycle(message, robot))
}

/// The number of the cycle with these percepts.
fn cycle(message: &[u8], robot: &Humanoid) -> Result<u64, Error> {
    let mut percept = Percept::default();
    percept.decode(message, robot)?;
    // The time is truncated to two decimals.
    Ok(((percept.time + 0.005) / 0.02).round() as u64)
}

/// The time at which a cycle begins, s.
fn time(cycle: u64) -> f64 {
    cycle as f64 * 0.02
}
