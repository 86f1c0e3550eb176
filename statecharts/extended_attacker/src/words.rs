//! The names that guards and actions use: each a constant named as in the model.

/// The constants of the model.
#[allow(non_upper_case_globals, clippy::approx_constant)] // names and numbers as in the model
pub(crate) mod constants {
    /// `near`
    pub(crate) const near: f64 = 0.25;
    /// `kick_x`
    pub(crate) const kick_x: f64 = 0.15;
    /// `kick_y`
    pub(crate) const kick_y: f64 = 0.05;
    /// `tolerance`
    pub(crate) const tolerance: f64 = 0.025;
    /// `nearer`
    pub(crate) const nearer: f64 = 0.1;
    /// `look`
    pub(crate) const look: f64 = 2.5;
    /// `wander`
    pub(crate) const wander: f64 = 13.0;
    /// `central`
    pub(crate) const central: f64 = 0.5;
    /// `certain`
    pub(crate) const certain: f64 = 0.85;
    /// `quiet`
    pub(crate) const quiet: f64 = 0.7;
    /// `still`
    pub(crate) const still: f64 = 0.3;
    /// `seen`
    pub(crate) const seen: f64 = 0.6;
}

/// The functions that expressions call.
#[allow(non_upper_case_globals, clippy::approx_constant)] // names and numbers as in the model
pub(crate) mod functions {
    use ::monas::generated::Function;

    /// `abs`
    pub(crate) const abs: Function = Function(0);
}

/// The messages that are read and written.
#[allow(non_upper_case_globals, clippy::approx_constant)] // names and numbers as in the model
pub(crate) mod messages {
    use ::monas::generated::Source;

    /// `soccer/game_state`
    pub(crate) const GAME_STATE: Source<::monas_soccer::GameState> = Source::new(0);
    /// `soccer/ball`
    pub(crate) const BALL: Source<::monas_soccer::Ball> = Source::new(1);
    /// `soccer/attack`
    pub(crate) const ATTACK: Source<::monas_soccer::Attack> = Source::new(2);
    /// `soccer/pose`
    pub(crate) const POSE: Source<::monas_soccer::Pose> = Source::new(3);
}

/// The timers.
#[allow(non_upper_case_globals, clippy::approx_constant)] // names and numbers as in the model
pub(crate) mod timers {
    use ::monas::generated::Timer;

    /// `robot_timeout`
    pub(crate) const robot_timeout: Timer = Timer(0);
    /// `led_timeout`
    pub(crate) const led_timeout: Timer = Timer(1);
    /// `motion_timeout`
    pub(crate) const motion_timeout: Timer = Timer(2);
    /// `sensors_timeout`
    pub(crate) const sensors_timeout: Timer = Timer(3);
    /// `vision_timeout`
    pub(crate) const vision_timeout: Timer = Timer(4);
    /// `place_timeout`
    pub(crate) const place_timeout: Timer = Timer(5);
    /// `glance_timeout`
    pub(crate) const glance_timeout: Timer = Timer(6);
    /// `decision_timeout`
    pub(crate) const decision_timeout: Timer = Timer(7);
}

/// The values of enumerations.
#[allow(non_upper_case_globals, clippy::approx_constant)] // names and numbers as in the model
pub(crate) mod values {
    /// `AttackPart.CENTER`
    pub(crate) const CENTER: i32 = 1;
    /// `AttackPart.CENTER_FOR`
    pub(crate) const CENTER_FOR: i32 = 2;
    /// `PlayerState.PENALIZED`
    pub(crate) const PENALIZED: i32 = 4;
    /// `PlayerState.PLAYING`
    pub(crate) const PLAYING: i32 = 3;
    /// `PlayerState.READY`
    pub(crate) const READY: i32 = 1;
}
