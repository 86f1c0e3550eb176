//! The names that guards and actions use: each a constant named as in the model.

/// The constants of the model.
#[allow(non_upper_case_globals, clippy::approx_constant)] // names and numbers as in the model
pub(crate) mod constants {
    /// `far`
    pub(crate) const far: f64 = 2.5;
    /// `word`
    pub(crate) const word: &str = "red";
}

/// The functions that expressions call.
#[allow(non_upper_case_globals, clippy::approx_constant)] // names and numbers as in the model
pub(crate) mod functions {
    use ::yase_codegen::typed::Function;

    /// `abs`
    pub(crate) const abs: Function = Function(0);
}

/// The messages that are read and written.
#[allow(non_upper_case_globals, clippy::approx_constant)] // names and numbers as in the model
pub(crate) mod messages {
    use ::yase_codegen::typed::Source;

    /// `soccer/ball`
    pub(crate) const BALL: Source<::soccer::Ball> = Source::new(0);
    /// `soccer/ball`
    pub(crate) const VISION_BALL: Source<::soccer::Ball> = Source::new(1);
    /// `soccer/game_state`
    pub(crate) const GAME_STATE: Source<::soccer::GameState> = Source::new(2);
}

/// The timers.
#[allow(non_upper_case_globals, clippy::approx_constant)] // names and numbers as in the model
pub(crate) mod timers {
    use ::yase_codegen::typed::Timer;

    /// `watch_timeout`
    pub(crate) const watch_timeout: Timer = Timer(0);
}

/// The values of enumerations.
#[allow(non_upper_case_globals, clippy::approx_constant)] // names and numbers as in the model
pub(crate) mod values {
    /// `PlayerState.PLAYING`
    pub(crate) const PLAYING: i32 = 3;
}
