//! The world of the server as a child process: its physics without its sockets.

use std::error::Error;
use std::io::{Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use monas_rcsssmj::walk::{Motion, Motors};
use monas_rcsssmj::{Humanoid, InclinationFilter, JOINTS};

const PROGRAM: &str = include_str!("physics.py");
/// The numbers of a state after those of the joints.
const BASE_STATE_SIZE: usize = 6 + 5 + 2;
/// The period of the server, s.
pub(crate) const CYCLE: f64 = 0.02;

/// Robot and ball after a cycle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    /// The measurements of the robot.
    pub(crate) motion: Motion,
    /// The position of the torso, m.
    pub(crate) position: [f64; 3],
    /// Its heading, rad.
    pub(crate) heading: f64,
    /// The cosine of its inclination.
    pub(crate) upright: f64,
    /// The position of the ball, m.
    pub(crate) ball: [f64; 2],
}

/// A robot and a ball.
pub(crate) struct World {
    robot: &'static Humanoid,
    process: Child,
    commands: ChildStdin,
    states: ChildStdout,
    inclination: InclinationFilter,
    /// Commands computed from the last state: the server moves the motors a cycle later.
    motors: Motors,
}

impl World {
    /// Starts a world with a robot.
    pub(crate) fn new(robot: &'static Humanoid) -> Result<World, Box<dyn Error>> {
        let mut command = Command::new("python3");
        command
            .args(["-c", PROGRAM, robot.name(), &robot.straight_height().to_string()])
            .current_dir(std::env::temp_dir())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        let mut process = command.spawn().map_err(|error| format!("python3 cannot be started: {error}"))?;
        let (Some(commands), Some(states)) = (process.stdin.take(), process.stdout.take()) else {
            return Err("python3 has no standard input or output".into());
        };
        Ok(World {
            robot,
            process,
            commands,
            states,
            inclination: InclinationFilter::default(),
            motors: Motors::default(),
        })
    }

    /// Puts the robot upright at the origin, and the ball to a place.
    pub(crate) fn reset(&mut self, ball: [f64; 2]) -> Result<State, Box<dyn Error>> {
        (self.inclination, self.motors) = (InclinationFilter::default(), Motors::default());
        self.send(&[0.0, ball[0], ball[1]])?;
        self.receive()
    }

    /// Makes a cycle; the commands have effect in the next one.
    pub(crate) fn cycle(&mut self, motors: &Motors) -> Result<State, Box<dyn Error>> {
        let before = std::mem::replace(&mut self.motors, *motors);
        let joints = self.robot.joint_count();
        let mut numbers = [1.0; 1 + 3 * JOINTS];
        for (joint, motor) in before.iter().enumerate().take(joints) {
            numbers[1 + joint] = motor.angle;
            numbers[1 + joints + joint] = motor.stiffness;
            numbers[1 + 2 * joints + joint] = motor.damping;
        }
        self.send(&numbers[..1 + 3 * joints])?;
        self.receive()
    }

    fn send(&mut self, numbers: &[f64]) -> Result<(), Box<dyn Error>> {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        self.commands.write_all(&bytes).and_then(|()| self.commands.flush()).map_err(ended)
    }

    fn receive(&mut self) -> Result<State, Box<dyn Error>> {
        let joints = self.robot.joint_count();
        let mut bytes = [0; 8 * (2 * JOINTS + BASE_STATE_SIZE)];
        let bytes = &mut bytes[..8 * (2 * joints + BASE_STATE_SIZE)];
        self.states.read_exact(bytes).map_err(ended)?;
        let numbers: Vec<f64> =
            bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        let three = |first: usize| [numbers[first], numbers[first + 1], numbers[first + 2]];
        let all = |first: usize| {
            std::array::from_fn(|joint| if joint < joints { numbers[first + joint] } else { 0.0 })
        };
        let (gyro, acceleration) = (three(2 * joints), three(2 * joints + 3));
        self.inclination.advance(gyro, acceleration, CYCLE);
        let rest = 2 * joints + 6;
        Ok(State {
            motion: Motion {
                positions: all(0),
                velocities: all(joints),
                gyro,
                down: self.inclination.down(),
            },
            position: three(rest),
            heading: numbers[rest + 3],
            upright: numbers[rest + 4],
            ball: [numbers[rest + 5], numbers[rest + 6]],
        })
    }
}

impl Drop for World {
    fn drop(&mut self) {
        // A process that has ended already is not an error.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn ended(error: std::io::Error) -> Box<dyn Error> {
    format!("the world has ended: {error}; is rcsssmj installed (`pip install rcsssmj==0.2.1`)?").into()
}
