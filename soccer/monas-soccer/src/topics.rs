//! The topics between the activities of a player.

use narukom::{Data, State};

use crate::{
    Attack, Ball, Calibration, FieldLines, GameState, HeadRequest, LedRequest, MotionRequest, MotionState,
    Pose, Robots, SensorEntry, Team,
};

narukom::topic! {
    /// State of the game, published by RobotController.
    pub GAME_STATE: State<GameState> = "soccer/game_state";
    /// The ball, found or not, published by Vision after every update.
    pub BALL: State<Ball> = "soccer/ball";
    /// Pose of the robot, published by Vision once it is known.
    pub POSE: State<Pose> = "soccer/pose";
    /// Other robots, published by Vision.
    pub ROBOTS: State<Robots> = "soccer/robots";
    /// Field lines and border, published by Vision for each set of images; not from finished
    /// sightings.
    pub FIELD_LINES: State<FieldLines> = "soccer/field_lines";
    /// History of sensor readings over slightly more than a second, published by Sensors.
    pub SENSORS: Data<SensorEntry, 128> = "soccer/sensors";
    /// Requests of behaviours for motions of the body.
    pub MOTION: State<MotionRequest> = "soccer/motion";
    /// Progress of motion requests, published by MotionController.
    pub MOTION_STATE: State<MotionState> = "soccer/motion_state";
    /// Requests of behaviours for the head.
    pub HEAD: State<HeadRequest> = "soccer/head";
    /// Colours of the LEDs, published by LedHandler.
    pub LEDS: State<LedRequest> = "soccer/leds";
    /// Reports of team mates, published by TeamRadio.
    pub TEAM: State<Team> = "soccer/team";
    /// State of the attack protocol, published by AssessAttack.
    pub ATTACK: State<Attack> = "soccer/attack";
    /// Reset of Vision, requested by SendCalibration.
    pub CALIBRATION: State<Calibration> = "soccer/calibration";
}
