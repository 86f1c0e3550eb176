//! The measures of the objects on a field.

/// The appearance of a ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BallPattern {
    /// Orange all over, as in 2010.
    Orange,
    /// White with black patches, as today.
    BlackAndWhite,
}

/// The objects on a field, as far as vision has to know them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldObjects {
    /// The appearance of the ball.
    pub ball: BallPattern,
    /// Radius of the ball, m.
    pub ball_radius: f64,
    /// Whether the goals are yellow and blue, as in 2010; white otherwise.
    pub has_coloured_goals: bool,
    /// Radius of a post, m.
    pub post_radius: f64,
    /// Width of a line, m.
    pub line_width: f64,
}

impl FieldObjects {
    /// The Standard Platform League of 2010: a street hockey ball, a yellow and a blue goal (rules
    /// of 2010).
    pub const OF_2010: FieldObjects = FieldObjects {
        ball: BallPattern::Orange,
        ball_radius: 0.0325,
        has_coloured_goals: true,
        post_radius: 0.05,
        line_width: 0.05,
    };

    /// The league of today: a foam ball with black patches of 100 mm, white goals (rules since
    /// 2016).
    pub const OF_TODAY: FieldObjects = FieldObjects {
        ball: BallPattern::BlackAndWhite,
        ball_radius: 0.05,
        has_coloured_goals: false,
        post_radius: 0.05,
        line_width: 0.05,
    };
}
