//! The names that guards and actions use: each a constant named as in the model.

/// The constants of the model.
#[allow(non_upper_case_globals, clippy::approx_constant)] // names and numbers as in the model
pub(crate) mod constants {
    /// `act_within`
    pub(crate) const act_within: f64 = 1.0;
    /// `fall_from`
    pub(crate) const fall_from: f64 = 0.2617993877991494;
    /// `dive_from`
    pub(crate) const dive_from: f64 = 0.4363323129985824;
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
    /// `decision_timeout`
    pub(crate) const decision_timeout: Timer = Timer(6);
}

/// The values of enumerations.
#[allow(non_upper_case_globals, clippy::approx_constant)] // names and numbers as in the model
pub(crate) mod values {
    /// `PlayerState.PENALIZED`
    pub(crate) const PENALIZED: i32 = 4;
    /// `PlayerState.PLAYING`
    pub(crate) const PLAYING: i32 = 3;
    /// `PlayerState.READY`
    pub(crate) const READY: i32 = 1;
}
