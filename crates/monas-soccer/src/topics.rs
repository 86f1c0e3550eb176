//! The topics between the activities of a player.

use narukom::{Data, State};

use crate::{
    Attack, Ball, Calibration, GameState, HeadRequest, LedRequest, MotionRequest, MotionState, Pose, Robots,
    SensorEntry, Team,
};

narukom::topic! {
    /// What the player knows of the game; RobotController says it.
    pub GAME_STATE: State<GameState> = "soccer/game_state";
    /// The ball; Vision says it after every look, found or not.
    pub BALL: State<Ball> = "soccer/ball";
    /// Where the robot stands; Vision says it once it has an idea.
    pub POSE: State<Pose> = "soccer/pose";
    /// The other robots; Vision says it.
    pub ROBOTS: State<Robots> = "soccer/robots";
    /// What the body has felt, a bit more than a second of it; Sensors keeps it.
    pub SENSORS: Data<SensorEntry, 128> = "soccer/sensors";
    /// What the behaviours want the body to do.
    pub MOTION: State<MotionRequest> = "soccer/motion";
    /// How far the body is with it; MotionController says it.
    pub MOTION_STATE: State<MotionState> = "soccer/motion_state";
    /// Where the behaviours want the head.
    pub HEAD: State<HeadRequest> = "soccer/head";
    /// The colours of the lights; LedHandler says it.
    pub LEDS: State<LedRequest> = "soccer/leds";
    /// What team mates have told; TeamRadio says it.
    pub TEAM: State<Team> = "soccer/team";
    /// How an attack stands; AttackWatch says it.
    pub ATTACK: State<Attack> = "soccer/attack";
    /// Asks Vision to begin afresh; SendCalibration says it.
    pub CALIBRATION: State<Calibration> = "soccer/calibration";
}
