//! The simulated world, advanced step by step.

use monas_robot::ObjectSet;

use crate::arena::{Arena, BallObstacle};
use crate::body::{BodyEvent, SimulatedBody};
use crate::camera::{CameraFaults, CameraView};
use crate::passes::PassTracker;
use crate::pose::{Vector, rotate, shortened};
use crate::referee::Referee;
use crate::referee::RefereeCall;
use crate::return_tracker::ReturnTracker;
use crate::rng::RandomStream;
use crate::shots::ShotTracker;
use crate::snapshot::Snapshot;
use crate::state::GOALIE_NUMBER;
use crate::{
    Announcement, BallState, Buttons, Command, Error, ErrorKind, EventKind, FieldGeometry, GameOrder,
    GameState, MatchRules, Physics, Pose, Radio, RobotSetup, RobotState, STEP, Senses, Setup, Side,
    SimulationEvent, Statistics, TeamSetup, lineup, restart,
};

/// A field with robots, a ball and a referee, in simulated time.
///
/// The same setup and the same commands between the same steps give the same bits.
pub struct SimulatedWorld {
    rules: MatchRules,
    radio: Radio,
    objects: ObjectSet,
    seed: u64,
    teams: [TeamSetup; 2],
    now: Snapshot,
    arena: Arena,
    bodies: Vec<SimulatedBody>,
    sensors: Vec<SensorState>,
    referee: Referee,
    shots: ShotTracker,
    passes: PassTracker,
    returns: ReturnTracker,
    statistics: Statistics,
    events: Vec<SimulationEvent>,
    /// Decisions of the current step; kept to reuse its allocation.
    decisions: Vec<EventKind>,
    kicks: RandomStream,
    steps: u64,
}

/// State of a robot's sensors between readings.
struct SensorState {
    noise: RandomStream,
    vision: RandomStream,
    faults: CameraFaults,
    pictures: u64,
    turn: f64,
    /// The step until which a person holds the robot in the air.
    lifted_until: u64,
}

/// Time for which a person holds a robot in the air before it stands at its new position, s.
const CARRY_TIME: f64 = 0.5;

impl SimulatedWorld {
    /// Builds a world. Robots stand at their kick-off positions, the ball lies at the centre.
    ///
    /// # Errors
    /// [`OutOfRange`](ErrorKind::OutOfRange) and [`Inconsistent`](ErrorKind::Inconsistent) for
    /// parameters, [`Lineup`](ErrorKind::Lineup) for teams and robots.
    pub fn new(setup: Setup) -> Result<Self, Error> {
        let Setup { field, physics, rules, radio, objects, teams, robots, seed } = setup;
        field.validate()?;
        physics.validate()?;
        rules.validate()?;
        radio.validate()?;
        let team_of = lineup::check(&teams, &robots)?;
        let path = |robot: &RobotSetup| format!("robot/{}/{}", robot.team, robot.number);
        let count = robots.len();
        let mut world = Self {
            referee: Referee::new(rules.clone(), &teams, &robots, &team_of, seed),
            arena: Arena::new(&field, &physics, count),
            bodies: robots.iter().map(|robot| SimulatedBody::new(seed, &path(robot))).collect(),
            sensors: robots.iter().map(|robot| SensorState::new(seed, &path(robot))).collect(),
            now: Snapshot::new(field, physics, &robots, &team_of),
            shots: ShotTracker::default(),
            passes: PassTracker::default(),
            returns: ReturnTracker::new(count),
            statistics: Statistics::new(&team_of),
            events: Vec::with_capacity(1024),
            decisions: Vec::with_capacity(32),
            kicks: RandomStream::new(seed, "kicks"),
            steps: 0,
            rules,
            radio,
            objects,
            seed,
            teams,
        };
        world.place_for_kick_off(|_, _| true);
        Ok(world)
    }

    /// Advances the world by [`STEP`].
    pub fn step(&mut self) {
        self.steps += 1;
        for robot in 0..self.bodies.len() {
            self.move_body(robot);
        }
        self.roll_ball();
        self.arena.step();
        self.look_around();
        for robot in 0..self.bodies.len() {
            self.keep_balance(robot);
        }
        self.run_referee();
        self.carry_out_decisions();
    }

    /// Time since the world began, s.
    pub fn time(&self) -> f64 {
        self.steps as f64 * STEP
    }

    /// The number of steps since the world began.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Sets the command of a robot from the next step on.
    ///
    /// # Errors
    /// [`UnknownRobot`](ErrorKind::UnknownRobot), or [`OutOfRange`](ErrorKind::OutOfRange) for a
    /// number that is not finite.
    pub fn command(&mut self, robot: usize, command: Command) -> Result<(), Error> {
        self.check_robot(robot)?;
        command.check()?;
        self.bodies[robot].command = command;
        Ok(())
    }

    /// Presses or releases the button on a robot's chest.
    ///
    /// # Errors
    /// [`UnknownRobot`](ErrorKind::UnknownRobot).
    pub fn press_chest_button(&mut self, robot: usize, pressed: bool) -> Result<(), Error> {
        self.check_robot(robot)?;
        self.bodies[robot].chest_button = pressed;
        Ok(())
    }

    /// Reads a robot's sensors and cameras into `senses`.
    ///
    /// # Errors
    /// [`UnknownRobot`](ErrorKind::UnknownRobot).
    pub fn sense(&mut self, robot: usize, senses: &mut Senses) -> Result<(), Error> {
        self.check_robot(robot)?;
        self.feel(robot, senses);
        self.see(robot, senses);
        Ok(())
    }

    /// The announcement of the referee to a robot.
    ///
    /// # Errors
    /// [`UnknownRobot`](ErrorKind::UnknownRobot).
    pub fn announcement(&self, robot: usize) -> Result<Announcement, Error> {
        self.check_robot(robot)?;
        Ok(self.referee.announcement(robot))
    }

    /// From the next step on the referee carries out this order, and decides nothing by itself.
    ///
    /// # Errors
    /// [`UnknownRobot`](ErrorKind::UnknownRobot) if the order is for more or fewer robots, or
    /// [`OutOfRange`](ErrorKind::OutOfRange) for a team that does not play.
    pub fn follow(&mut self, order: GameOrder) -> Result<(), Error> {
        if order.penalties.len() != self.bodies.len() {
            return Err(Error::unknown_robot(order.penalties.len(), self.bodies.len()));
        }
        if order.kick_off >= self.teams.len() || order.defends[0] == order.defends[1] {
            return Err(Error::new(ErrorKind::OutOfRange, "each of the two teams defends one end"));
        }
        self.referee.follow(order);
        Ok(())
    }

    /// Makes a decision of a person that of the referee; it is carried out in the next step.
    ///
    /// # Errors
    /// [`IllegalCall`](ErrorKind::IllegalCall): it is not possible in the present state of the
    /// game, or a GameController decides.
    pub fn call(&mut self, call: RefereeCall) -> Result<(), Error> {
        self.referee.call(call, &self.now.scene())
    }

    /// The measures of the field.
    pub fn field(&self) -> &FieldGeometry {
        &self.now.field
    }

    /// The numbers of bodies, ball and cameras.
    pub fn physics(&self) -> &Physics {
        &self.now.physics
    }

    /// The rules of this match.
    pub fn rules(&self) -> &MatchRules {
        &self.rules
    }

    /// The numbers of the radio.
    pub fn radio(&self) -> &Radio {
        &self.radio
    }

    /// The appearance of ball and goals.
    pub fn objects(&self) -> ObjectSet {
        self.objects
    }

    /// The seed of all random numbers.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The teams, in the order of their indices.
    pub fn teams(&self) -> &[TeamSetup; 2] {
        &self.teams
    }

    /// The true state of the robots, in the order of their indices.
    pub fn robots(&self) -> &[RobotState] {
        &self.now.robots
    }

    /// The true state of the ball.
    pub fn ball(&self) -> BallState {
        self.now.ball
    }

    /// The referee.
    pub fn referee(&self) -> &Referee {
        &self.referee
    }

    /// The counts of the match so far.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// Everything that happened so far, in order.
    pub fn events(&self) -> &[SimulationEvent] {
        &self.events
    }

    /// Places the ball with a velocity, both in the field frame; for tests and exercises.
    ///
    /// # Errors
    /// [`OutOfRange`](ErrorKind::OutOfRange) for a number that is not finite or a position off the
    /// field.
    pub fn place_ball(&mut self, position: Vector, velocity: Vector) -> Result<(), Error> {
        let fine = velocity.norm().is_finite() && self.now.field.contains(position);
        if !fine {
            return Err(Error::new(ErrorKind::OutOfRange, "the ball can only be placed on the field"));
        }
        self.set_ball(position, velocity);
        Ok(())
    }

    /// Places a robot upright at a pose; for tests and exercises.
    ///
    /// # Errors
    /// [`UnknownRobot`](ErrorKind::UnknownRobot), or [`OutOfRange`](ErrorKind::OutOfRange) for a
    /// position off the carpet or a heading that is not finite.
    pub fn place_robot(&mut self, robot: usize, pose: Pose) -> Result<(), Error> {
        self.check_robot(robot)?;
        let field = &self.now.field;
        let on_carpet = pose.position.x.abs() <= field.half_length() + field.border
            && pose.position.y.abs() <= field.half_width() + field.border;
        if !(on_carpet && pose.heading.is_finite()) {
            return Err(Error::new(ErrorKind::OutOfRange, "a robot can only be placed on the carpet"));
        }
        self.set_robot(robot, pose);
        Ok(())
    }

    fn check_robot(&self, robot: usize) -> Result<(), Error> {
        if robot < self.bodies.len() { Ok(()) } else { Err(Error::unknown_robot(robot, self.bodies.len())) }
    }

    /// Lets a body act and drives its disk with the velocity that its feet produce.
    fn move_body(&mut self, robot: usize) {
        let on_field = self.now.robots[robot].on_field;
        let held = self.referee.holds_robots() || !on_field;
        let event = self.bodies[robot].advance(&self.now.physics, held);
        match event {
            Some(BodyEvent::Strike(foot)) => self.kick_ball(robot, foot),
            Some(BodyEvent::Act { side, dive }) => self.note_act(robot, side, dive),
            Some(BodyEvent::Rebase(base)) => self.arena.set_base(robot, base),
            None => {}
        }
        let produced = self.bodies[robot].velocity(&self.now.physics);
        let heading = self.now.robots[robot].pose.heading;
        let before = self.arena.robot_velocity(robot);
        let change = rotate(produced.linear(), heading) - before;
        let velocity = before + shortened(change, self.now.physics.foot_grip * STEP);
        let velocity = self.now.stopped_at_edge(robot, velocity);
        self.arena.drive_robot(robot, velocity, produced.turn);
        self.now.driven[robot] = velocity;
        self.sensors[robot].turn = produced.turn;
    }

    /// Swings a foot and strikes the ball if it is in reach.
    fn kick_ball(&mut self, robot: usize, foot: Side) {
        let physics = &self.now.physics;
        let pose = self.now.robots[robot].pose;
        let ball = pose.to_own(self.now.ball.position);
        let in_reach = (ball.x - physics.kick_x).abs() <= physics.kick_tolerance_x
            && (ball.y - foot.sign() * physics.kick_y).abs() <= physics.kick_tolerance_y;
        let struck = in_reach && !self.kicks.chance(physics.kick_miss);
        self.decisions.push(EventKind::Kick { robot, foot, struck });
        if !struck {
            return;
        }
        let hardest = physics.kick_speed + self.kicks.normal(physics.kick_speed_noise);
        let wanted = self.bodies[robot].ball_speed;
        let strength = if wanted > 0.0 { (wanted / physics.kick_speed).min(1.0) } else { 1.0 };
        let speed = (strength * hardest).max(0.0);
        let direction = pose.heading + self.kicks.normal(physics.kick_direction_noise);
        let velocity = rotate(Vector::new(speed, 0.0), direction);
        self.arena.set_ball_velocity(velocity);
        self.now.ball.velocity = velocity;
        self.referee.note_kick(robot);
        let team = self.now.robots[robot].team;
        let attacks = self.referee.defends()[1 - team];
        let is_shot = self.shots.strike(robot, attacks, &self.now.scene(), &mut self.decisions);
        if self.passes.strike(robot, &self.now.scene()) && is_shot {
            self.decisions.push(EventKind::ShotAfterPass { robot });
        }
    }

    fn note_act(&mut self, robot: usize, side: Side, dive: bool) {
        let pose = self.now.robots[robot].pose;
        let ball = pose.to_own(self.now.ball.position);
        let velocity = rotate(self.now.ball.velocity, -pose.heading);
        let to_ball = passing_side(ball, velocity) == side;
        self.decisions.push(EventKind::Act { robot, side, dive, to_ball });
        if self.now.robots[robot].is_goalie() {
            self.returns.act(robot);
        }
    }

    fn roll_ball(&mut self) {
        let (_, velocity) = self.arena.ball();
        let speed = velocity.norm();
        if speed > 0.0 {
            let left = (speed - self.now.physics.ball_deceleration * STEP).max(0.0);
            self.arena.set_ball_velocity(velocity * (left / speed));
        }
    }

    /// Copies the ground truth from the arena.
    fn look_around(&mut self) {
        let (position, velocity) = self.arena.ball();
        self.now.ball = BallState { position, velocity };
        for robot in 0..self.bodies.len() {
            self.now.touching_ball[robot] = self.now.robots[robot].on_field && self.arena.touches_ball(robot);
            self.update_state(robot);
        }
        self.now.find_contacts(&self.arena);
    }

    fn update_state(&mut self, robot: usize) {
        let body = &self.bodies[robot];
        let pose = self.arena.robot_pose(robot);
        let state = &mut self.now.robots[robot];
        state.pose = pose;
        state.velocity = self.arena.robot_velocity(robot);
        state.intent = rotate(body.gait.intended().linear(), pose.heading);
        state.phase = body.phase;
        state.head_yaw = body.head_yaw;
        state.head_pitch = body.head_pitch;
    }

    fn keep_balance(&mut self, robot: usize) {
        if self.referee.holds_robots() || !self.now.robots[robot].on_field {
            return;
        }
        let blow = self.now.blow(robot);
        let pressed = self.now.is_pressed(robot);
        let body = &mut self.bodies[robot];
        if body.keep_balance(blow, pressed, &self.now.physics) {
            self.now.robots[robot].phase = body.phase;
            self.decisions.push(EventKind::Fall { robot });
        }
    }

    fn run_referee(&mut self) {
        let scene = self.now.scene();
        let before = self.decisions.len();
        self.referee.update(&scene, self.shots.shooter(), &mut self.decisions);
        self.shots.follow(&scene, &mut self.decisions);
        self.passes.follow(&scene, &mut self.decisions);
        self.returns.follow(self.referee.defends(), &scene, &mut self.decisions);
        if self.referee.state() == GameState::Playing {
            self.statistics.observe(&scene);
        }
        let decided = &self.decisions[before..];
        let is_goal = decided.iter().any(|event| matches!(event, EventKind::Goal { .. }));
        let ends = is_goal || decided.iter().any(ends_play);
        if is_goal {
            self.shots.goal();
        } else if ends {
            self.shots.resolve(&mut self.decisions);
        }
        if ends {
            self.passes.forget();
        }
    }

    /// Carries out the decisions of this step and records them as events.
    fn carry_out_decisions(&mut self) {
        let mut decisions = std::mem::take(&mut self.decisions);
        for kind in decisions.drain(..) {
            self.carry_out(&kind);
            self.statistics.record(&kind);
            self.events.push(SimulationEvent { time: self.time(), kind });
        }
        self.decisions = decisions;
    }

    /// Roll and pitch of the torso of a robot, rad, without noise.
    pub(crate) fn torso_tilt(&self, robot: usize) -> (f64, f64) {
        self.bodies.get(robot).map_or((0.0, 0.0), |body| body.tilt)
    }

    fn carry_out(&mut self, event: &EventKind) {
        match *event {
            EventKind::StateChanged { to: GameState::Initial, .. } => self.place_for_kick_off(|_, _| true),
            EventKind::StateChanged { to: GameState::Ready, .. } => {
                self.set_ball(Vector::zeros(), Vector::zeros());
            }
            EventKind::StateChanged { to: GameState::Set, .. } => self.place_for_kick_off(is_misplaced),
            EventKind::ThrowIn { position, .. } | EventKind::DropBall { position } => {
                self.set_ball(position, Vector::zeros());
            }
            EventKind::Penalty { robot, .. } => self.take_off(robot),
            EventKind::Return { robot } => self.bring_back(robot),
            _ => {}
        }
    }

    /// Places the ball at the centre, and the robots that have to be placed.
    fn place_for_kick_off(&mut self, must_be_placed: impl Fn(&Self, usize) -> bool) {
        self.set_ball(Vector::zeros(), Vector::zeros());
        let mut ranks = [0; 2];
        for robot in 0..self.bodies.len() {
            let RobotState { team, number, on_field, .. } = self.now.robots[robot];
            let defends = self.referee.defends()[team];
            let kicks_off = self.referee.kick_off_team() == team;
            let rank = ranks[team];
            ranks[team] += usize::from(number != GOALIE_NUMBER);
            if on_field && must_be_placed(self, robot) {
                let (field, physics) = (&self.now.field, &self.now.physics);
                let wanted = restart::kick_off_pose(field, physics, defends, kicks_off, number, rank);
                let pose = restart::free_for_robot(&self.now.scene(), robot, wanted);
                self.put_down(robot, pose);
            }
        }
    }

    fn take_off(&mut self, robot: usize) {
        let state = self.now.robots[robot];
        let pose = restart::waiting_pose(&self.now.field, self.referee.defends()[state.team], &state);
        self.now.robots[robot].on_field = false;
        self.arena.set_present(robot, false);
        self.set_robot(robot, pose);
    }

    fn bring_back(&mut self, robot: usize) {
        let pose = restart::return_pose(&self.now.scene(), robot);
        self.now.robots[robot].on_field = true;
        self.arena.set_present(robot, true);
        self.put_down(robot, pose);
    }

    /// A person places a robot, whose feet detect that it is lifted.
    fn put_down(&mut self, robot: usize, pose: Pose) {
        self.set_robot(robot, pose);
        self.sensors[robot].lifted_until = self.steps + (CARRY_TIME / STEP) as u64;
    }

    fn set_ball(&mut self, position: Vector, velocity: Vector) {
        self.arena.place_ball(position, velocity);
        self.now.ball = BallState { position, velocity };
    }

    fn set_robot(&mut self, robot: usize, pose: Pose) {
        self.arena.place_robot(robot, pose);
        self.arena.set_base(robot, BallObstacle::Feet);
        self.bodies[robot].set_upright();
        self.returns.forget(robot);
        self.update_state(robot);
    }

    fn feel(&mut self, robot: usize, senses: &mut Senses) {
        let physics = &self.now.physics;
        let body = &mut self.bodies[robot];
        let sensors = &mut self.sensors[robot];
        let progress = body.progress(physics);
        let (roll, pitch) = body.tilt;
        let [roll_rate, pitch_rate] = body.tilt_rate;
        senses.time = self.steps as f64 * STEP;
        senses.odometry = body.take_odometry();
        senses.head_yaw = body.head_yaw;
        senses.head_pitch = body.head_pitch;
        senses.torso_roll = roll + sensors.noise.normal(physics.tilt_noise);
        senses.torso_pitch = pitch + sensors.noise.normal(physics.tilt_noise);
        senses.gyro =
            [roll_rate, pitch_rate, sensors.turn].map(|rate| rate + sensors.noise.normal(physics.gyro_noise));
        senses.is_lifted = !self.now.robots[robot].on_field || self.steps < sensors.lifted_until;
        senses.phase = body.phase;
        senses.progress = progress;
        senses.support = body.gait.support();
        senses.buttons = Buttons { chest: body.chest_button, ..self.now.bumpers(robot) };
    }

    fn see(&mut self, robot: usize, senses: &mut Senses) {
        senses.sightings.clear();
        let time = self.time();
        let taken = (time * self.now.physics.camera_rate + 1e-6) as u64;
        let sensors = &mut self.sensors[robot];
        senses.new_picture = taken > sensors.pictures;
        sensors.pictures = taken;
        if senses.new_picture {
            let darkness = sensors.faults.darkness(time);
            let scene = self.now.scene();
            let camera = CameraView { robot, scene, colours: self.referee.colours(), darkness };
            camera.observe(&mut sensors.vision, &mut senses.sightings);
            sensors.faults.spoil(&camera, &mut senses.sightings);
        }
    }
}

impl SensorState {
    fn new(seed: u64, path: &str) -> Self {
        Self {
            noise: RandomStream::new(seed, &format!("{path}/sensors")),
            vision: RandomStream::new(seed, &format!("{path}/vision")),
            faults: CameraFaults::new(seed, path),
            pictures: 0,
            turn: 0.0,
            lifted_until: 0,
        }
    }
}

/// Whether a robot stands in an illegal position for a kick-off, or does not stand.
fn is_misplaced(world: &SimulatedWorld, robot: usize) -> bool {
    let RobotState { team, .. } = world.now.robots[robot];
    let defends = world.referee.defends()[team];
    let kicks_off = world.referee.kick_off_team() == team;
    !restart::is_legal_at_kick_off(&world.now.scene(), robot, defends, kicks_off)
}

/// The side of a body on which a ball passes: where its line crosses the body's lateral axis, or,
/// if it does not approach, where it lies. Both in the frame of the body.
fn passing_side(ball: Vector, velocity: Vector) -> Side {
    /// A ball slower than this does not approach, m/s.
    const MIN_APPROACH_SPEED: f64 = 0.05;
    let comes = velocity.x < -MIN_APPROACH_SPEED && ball.x > 0.0;
    Side::of(if comes { ball.y - velocity.y / velocity.x * ball.x } else { ball.y })
}

/// Whether an event takes the ball out of play.
fn ends_play(event: &EventKind) -> bool {
    matches!(event, EventKind::ThrowIn { .. } | EventKind::DropBall { .. } | EventKind::StateChanged { .. })
}
