//! A robot on a server as a body.

use monas_robot::{Actuators, Anatomy, JointCommands, Percepts, Robot};
use narukom::Timestamp;

use crate::admission::Admission;
use crate::connection::Connection;
use crate::control::BoosterControl;
use crate::effector::Effectors;
use crate::error::Error;
use crate::humanoid::{CYCLE_SECONDS, Humanoid};
use crate::match_rules::{FieldPose, MatchRules};
use crate::monitor::{Command, Monitor};
use crate::options::Options;
use crate::percept::{PlayMode, Side};
use crate::server::Server;

/// The usual address of a server for agents.
pub(crate) const DEFAULT_ADDRESS: &str = "127.0.0.1:60000";
/// Displacement of the torso in one cycle beyond which the robot counts as placed, m.
const MAX_DISPLACEMENT: f64 = 0.2;
/// Time for which a robot lies before it is picked up, s.
const MAX_LYING_TIME: f64 = 5.0;
/// Distance from the place where a robot fell to where it is put on its feet, m: behind it, not on
/// the ball.
const PLACEMENT_DISTANCE: f64 = 0.7;
/// The cycles for a robot to come to a stand before the kick-off.
const SETTLING_CYCLES: u32 = 100;
/// The cycles until a command of the monitor shows its effect, at most.
const TIMEOUT_CYCLES: u32 = 250;
/// The cycles for the server to admit a monitor.
const TAKING_IN: u32 = 25;

/// A humanoid of Booster Robotics on a server.
///
/// In lockstep, which is the default, the body has its own time: each call of
/// [`sense`](Robot::sense) sends the commands of one cycle and waits for the server's answer, 20 ms
/// later in simulated time. In real time it takes what has arrived and never waits.
pub struct Booster {
    robot: &'static Humanoid,
    control: BoosterControl,
    rules: MatchRules,
    connection: Connection,
    /// The address for the monitor's commands, and the connection.
    monitors: Option<String>,
    monitor: Option<Monitor>,
    /// Commands that the monitor has not sent yet, and the cycles until it can.
    instructions: Vec<Command>,
    taking_in: u32,
    message: Effectors,
    lockstep: bool,
    pick_up: bool,
    /// Whether a received message of the server still has to be answered.
    must_reply: bool,
    measured_at: Timestamp,
    /// Cycles since the robot fell.
    lying: u32,
    before: [f64; 3],
    /// Dropped last, after the connections.
    _server: Option<Server>,
}

impl Booster {
    /// Connects to the server at an address, or starts one, and sets up the game.
    pub(crate) fn open(address: Option<&str>, options: &Options) -> Result<Booster, Error> {
        let robot = options.robot;
        let (walk, kick) = (options.walk_engine()?, options.kick_parameters()?);
        let lockstep = !options.realtime;
        let is_admitted = address.is_none() && lockstep;
        let (server, monitors, connection) = match address {
            Some(address) => (None, options.monitor.clone(), Connection::open(address)?),
            None if lockstep => {
                let Admission { server, player } = Admission::new(options)?;
                let monitors = server.monitors().to_owned();
                (Some(server), Some(monitors), player)
            }
            None => {
                let mut server = Server::start(options.server.as_deref(), lockstep)?;
                server.monitor()?;
                let (monitors, connection) =
                    (server.monitors().to_owned(), Connection::open(server.agents())?);
                (Some(server), Some(monitors), connection)
            }
        };
        let mut rules = MatchRules::new(options.team.clone(), options.number, options.field);
        rules.half = options.half;
        let mut body = Booster {
            robot,
            control: BoosterControl::new(robot, walk, kick),
            rules,
            connection,
            monitor: monitors.as_deref().map(Monitor::connect).transpose()?,
            monitors,
            instructions: Vec::new(),
            taking_in: TAKING_IN,
            message: Effectors::default(),
            lockstep,
            pick_up: options.pick_up,
            must_reply: false,
            measured_at: Timestamp::ZERO,
            lying: 0,
            before: [0.0; 3],
            _server: server,
        };
        body.join(options, is_admitted)?;
        Ok(body)
    }

    /// The robot.
    pub fn robot(&self) -> &'static Humanoid {
        self.robot
    }

    /// The true position of the torso, from the server: x, y and z on the field, m. No percept of
    /// the body contains it; trials compare with it.
    pub fn true_position(&self) -> [f64; 3] {
        self.control.percept().true_position
    }

    /// The true heading of the torso, as the server reports it, rad.
    pub fn true_heading(&self) -> f64 {
        let [w, x, y, z] = self.control.percept().true_orientation;
        libm::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    }

    /// Whether the robot lies.
    pub fn is_fallen(&self) -> bool {
        self.control.is_fallen()
    }

    /// Whether commands of a monitor can be sent: the server was started here, or the address for
    /// monitors is known.
    pub fn has_monitor(&self) -> bool {
        self.monitor.is_some()
    }

    /// Sends a command by the monitor. In lockstep this happens within the next second: the
    /// commands of each second take effect together, in a cycle that does not depend on the
    /// computer. Without a monitor the command has no effect.
    pub fn instruct(&mut self, command: Command) {
        if self.has_monitor() {
            self.instructions.push(command);
        }
    }

    /// Joins the game, goes to its place, and waits until the game has begun if it begins it.
    fn join(&mut self, options: &Options, is_admitted: bool) -> Result<(), Error> {
        self.message.clear();
        match is_admitted {
            true => self.message.synchronize(),
            false => self.message.init(self.robot, &options.team, options.number),
        }
        self.connection.send(self.message.as_bytes())?;
        // Percepts from before the body is at its position are discarded.
        self.connection.receive(|_| Ok(()))?;
        let FieldPose { x, y, heading } = options.start;
        // A robot dropped from a height may tip over.
        let is_caught = self.robot.placed_height > self.robot.straight_height && self.has_monitor();
        self.message.clear();
        self.message.beam(if is_caught { x - PLACEMENT_DISTANCE } else { x }, y, heading);
        self.answer()?;
        self.connection.receive(|_| Ok(()))?;
        self.exchange()?;
        self.rules.observe(&self.control.percept().game);
        if is_caught {
            self.put_up(options.start.for_team(self.rules.side));
        }
        for _ in 0..SETTLING_CYCLES {
            self.exchange()?;
        }
        if options.kick_off && self.has_monitor() {
            self.kick_off()?;
        }
        Ok(())
    }

    /// Gives the own team the kick-off and waits until the state of the game shows it.
    fn kick_off(&mut self) -> Result<(), Error> {
        self.instruct(Command::KickOff(self.rules.side));
        for _ in 0..TIMEOUT_CYCLES {
            if self.control.percept().game.play_mode != PlayMode::BeforeKickOff {
                return Ok(());
            }
            self.exchange()?;
        }
        Err(Error::protocol("the server gives no kick-off"))
    }

    /// Sends the commands that wait. In lockstep the server has sent percepts and, after a cycle
    /// without vision, its state to the monitor: it waits for the agent, and takes up the commands
    /// in the next cycle. That it has read them shows when it closes the connection.
    fn send_instructions(&mut self) -> Result<(), Error> {
        self.taking_in = self.taking_in.saturating_sub(1);
        let percept = self.control.percept();
        let waits = self.lockstep && (percept.has_vision || self.taking_in > 0);
        if waits || self.instructions.is_empty() {
            return Ok(());
        }
        let Some(mut monitor) = self.monitor.take() else { return Ok(()) };
        if !self.lockstep {
            self.instructions.drain(..).try_for_each(|command| monitor.send(&command))?;
            self.monitor = Some(monitor);
            return Ok(());
        }
        monitor.wait_beyond(percept.time)?;
        self.instructions.drain(..).try_for_each(|command| monitor.send(&command))?;
        monitor.finish()?;
        self.taking_in = TAKING_IN;
        self.monitor = self.monitors.as_deref().map(Monitor::connect).transpose()?;
        Ok(())
    }

    /// One cycle: sends the commands to the motors, waits for the percepts.
    fn exchange(&mut self) -> Result<(), Error> {
        self.message.clear();
        self.answer()?;
        self.receive()
    }

    /// Adds the commands to the motors to the message, and sends it.
    fn answer(&mut self) -> Result<(), Error> {
        self.control.advance(&mut self.message);
        self.must_reply = false;
        self.connection.send(self.message.as_bytes())
    }

    /// Waits for the percepts of a cycle.
    fn receive(&mut self) -> Result<(), Error> {
        let (control, rules) = (&mut self.control, &self.rules);
        self.connection.receive(|message| control.receive(message, rules))?;
        self.received()
    }

    fn received(&mut self) -> Result<(), Error> {
        self.must_reply = true;
        if let Some(monitor) = &mut self.monitor {
            monitor.drain()?;
        }
        self.notice_placement();
        self.pick_up();
        self.send_instructions()
    }

    /// A robot whose position jumps was placed by the referee; the percept holds the new pose.
    fn notice_placement(&mut self) {
        let position = self.true_position();
        let jump = libm::hypot(position[0] - self.before[0], position[1] - self.before[1]);
        self.before = position;
        if jump > MAX_DISPLACEMENT {
            self.control.placed();
            self.rules.placed(FieldPose { x: position[0], y: position[1], heading: self.true_heading() });
        }
    }

    /// Puts a robot that has lain for a while on its feet, behind where it fell.
    fn pick_up(&mut self) {
        self.lying = if self.control.is_fallen() { self.lying + 1 } else { 0 };
        if !self.pick_up || f64::from(self.lying) * CYCLE_SECONDS < MAX_LYING_TIME {
            return;
        }
        self.lying = 0;
        let (ahead, heading) = match self.rules.side {
            Side::Left => (1.0, 0.0),
            Side::Right => (-1.0, std::f64::consts::PI),
        };
        let [x, y, _] = self.true_position();
        self.put_up(FieldPose { x: x - ahead * PLACEMENT_DISTANCE, y, heading });
    }

    /// Makes the monitor put the robot on its feet, at a pose on the field. The robot notices the
    /// placement if the pose differs from its own.
    fn put_up(&mut self, FieldPose { x, y, heading }: FieldPose) {
        let at = [x, y, self.robot.straight_height];
        let (team, number) = (self.rules.team.clone(), self.rules.number);
        self.instruct(Command::PlaceRobot { team, number, at, heading });
    }

    fn cycle(&mut self, now: Timestamp) -> Result<(), Error> {
        if self.lockstep {
            // The latest percepts are as old as the call before.
            self.measured_at = now;
            return if self.must_reply { self.exchange() } else { self.receive() };
        }
        let (control, rules) = (&mut self.control, &self.rules);
        let mut arrived = false;
        self.connection.drain(|message| {
            arrived = true;
            control.receive(message, rules)
        })?;
        if arrived {
            self.measured_at = now;
            self.received()?;
        }
        self.message.clear();
        if std::mem::take(&mut self.must_reply) { self.answer() } else { Ok(()) }
    }
}

impl Robot for Booster {
    fn anatomy(&self) -> &Anatomy {
        self.control.anatomy()
    }

    fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), monas_robot::Error> {
        self.cycle(now)?;
        self.control.percepts(self.measured_at, percepts);
        percepts.announcement = self.rules.news(&self.control.percept().game);
        Ok(())
    }

    fn act(&mut self, _now: Timestamp, actuators: &Actuators) -> Result<(), monas_robot::Error> {
        self.control.act(actuators);
        Ok(())
    }

    fn command_joints(
        &mut self,
        _now: Timestamp,
        commands: &JointCommands,
    ) -> Result<(), monas_robot::Error> {
        self.control.command_joints(commands)
    }

    fn rest(&mut self, _now: Timestamp) -> Result<(), monas_robot::Error> {
        self.control.rest();
        Ok(())
    }
}
