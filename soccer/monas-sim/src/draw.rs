//! A picture of the world, as SVG.
//!
//! A metre is 100 units of the picture. In the picture y points down, so y is negated.

use crate::pose::Vector;
use crate::{
    BodyPhase, FieldGeometry, FieldSide, GameState, GoalColour, RobotState, SimulatedWorld, TeamColour,
};
use std::fmt::{self, Write};

/// Units of the picture in a metre.
const UNITS_PER_METRE: f64 = 100.0;

/// Height of the scoreboard above the field, in units of the picture.
const SCOREBOARD_HEIGHT: f64 = 64.0;

/// Draws the world: carpet, lines, goals, robots with their numbers and headings, the ball and a
/// scoreboard.
///
/// ```
/// # let world = monas_sim::SimulatedWorld::new(monas_sim::Setup::three_against_three(7))?;
/// let picture = monas_sim::render_svg(&world);
/// assert!(picture.starts_with("<svg") && picture.ends_with("</svg>\n"));
/// # Ok::<(), monas_sim::Error>(())
/// ```
pub fn render_svg(world: &SimulatedWorld) -> String {
    let mut picture = SvgDrawing::new(world.field());
    // Writing into a string cannot fail, so the result can be ignored.
    let _ = picture.draw(world);
    picture.text
}

/// The field as SVG: what does not move.
pub(crate) struct SvgDrawing {
    pub(crate) text: String,
    /// Half the size of the carpet, m.
    far: Vector,
}

impl SvgDrawing {
    pub(crate) fn new(field: &FieldGeometry) -> Self {
        let far = Vector::new(field.half_length() + field.border, field.half_width() + field.border);
        Self { text: String::with_capacity(16 * 1024), far }
    }

    fn draw(&mut self, world: &SimulatedWorld) -> fmt::Result {
        let width = self.begin(world.field())?;
        let colours = world.referee().colours();
        for robot in world.robots() {
            self.robot(world, robot, shirt(colours[robot.team]))?;
        }
        self.ball(world)?;
        self.scoreboard(world, width)?;
        self.end()
    }

    /// Draws carpet, lines and goals. Returns the width of the picture.
    pub(crate) fn begin(&mut self, field: &FieldGeometry) -> Result<f64, fmt::Error> {
        let size = self.far * (2.0 * UNITS_PER_METRE);
        let height = size.y + SCOREBOARD_HEIGHT;
        let width = size.x;
        writeln!(
            self.text,
            r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0} {height:.0}" width="{width:.0}" height="{height:.0}" font-family="Helvetica, Arial, sans-serif">"#
        )?;
        self.carpet(size)?;
        self.lines(field)?;
        for side in [FieldSide::Left, FieldSide::Right] {
            self.goal(field, side)?;
        }
        Ok(width)
    }

    pub(crate) fn end(&mut self) -> fmt::Result {
        writeln!(self.text, "</svg>")
    }

    /// Draws the length of a metre below the field.
    pub(crate) fn scale(&mut self, field: &FieldGeometry) -> fmt::Result {
        let (x, y) =
            self.to_picture(Vector::new(-field.half_length(), -field.half_width() - field.border * 0.6));
        writeln!(
            self.text,
            r##"<path d="M{x:.0} {y:.0}m0 -5v10m0 -5h{UNITS_PER_METRE}m0 -5v10" stroke="#f4f7f5" stroke-width="2" fill="none"/>"##
        )?;
        let (x, y) = (x + UNITS_PER_METRE + 8.0, y + 4.0);
        writeln!(self.text, r##"<text x="{x:.0}" y="{y:.0}" font-size="13" fill="#f4f7f5">1 m</text>"##)
    }

    /// Converts a point of the field to picture coordinates.
    pub(crate) fn to_picture(&self, point: Vector) -> (f64, f64) {
        (
            (point.x + self.far.x) * UNITS_PER_METRE,
            (self.far.y - point.y) * UNITS_PER_METRE + SCOREBOARD_HEIGHT,
        )
    }

    fn carpet(&mut self, size: Vector) -> fmt::Result {
        let (width, height) = (size.x, size.y);
        writeln!(
            self.text,
            r##"<rect width="{width:.0}" height="{:.0}" fill="#1d2733"/>"##,
            height + SCOREBOARD_HEIGHT
        )?;
        writeln!(
            self.text,
            r##"<rect y="{SCOREBOARD_HEIGHT}" width="{width:.0}" height="{height:.0}" fill="#2f8f4e"/>"##
        )?;
        const STRIPES: u32 = 10;
        let stripe = width / f64::from(STRIPES);
        for number in (0..STRIPES).step_by(2) {
            let x = f64::from(number) * stripe;
            writeln!(
                self.text,
                r##"<rect x="{x:.1}" y="{SCOREBOARD_HEIGHT}" width="{stripe:.1}" height="{height:.0}" fill="#2a8347"/>"##
            )?;
        }
        Ok(())
    }

    fn lines(&mut self, field: &FieldGeometry) -> fmt::Result {
        let width = field.line_width * UNITS_PER_METRE;
        writeln!(
            self.text,
            r##"<g fill="none" stroke="#f4f7f5" stroke-width="{width:.1}" stroke-linejoin="round">"##
        )?;
        let corner = Vector::new(field.half_length(), field.half_width());
        self.rectangle(-corner, corner)?;
        for sign in [-1.0, 1.0] {
            let line = Vector::new(sign * field.half_length(), field.goal_area_width / 2.0);
            let inner = Vector::new(sign * (field.half_length() - field.goal_area_depth), -line.y);
            self.rectangle(line, inner)?;
            self.cross(Vector::new(sign * field.mark_distance, 0.0))?;
        }
        let (x, top) = self.to_picture(Vector::new(0.0, field.half_width()));
        let (_, bottom) = self.to_picture(Vector::new(0.0, -field.half_width()));
        writeln!(self.text, r#"<path d="M{x:.1} {top:.1}V{bottom:.1}"/>"#)?;
        let (x, y) = self.to_picture(Vector::zeros());
        let radius = field.centre_circle_radius * UNITS_PER_METRE;
        writeln!(self.text, r#"<circle cx="{x:.1}" cy="{y:.1}" r="{radius:.1}"/>"#)?;
        writeln!(self.text, "</g>")
    }

    fn rectangle(&mut self, one: Vector, other: Vector) -> fmt::Result {
        let (x, y) = self.to_picture(Vector::new(one.x.min(other.x), one.y.max(other.y)));
        let size = (one - other).abs() * UNITS_PER_METRE;
        writeln!(self.text, r#"<rect x="{x:.1}" y="{y:.1}" width="{:.1}" height="{:.1}"/>"#, size.x, size.y)
    }

    fn cross(&mut self, at: Vector) -> fmt::Result {
        let (x, y) = self.to_picture(at);
        writeln!(
            self.text,
            r#"<path d="M{:.1} {y:.1}h12M{x:.1} {:.1}v12" stroke-width="4"/>"#,
            x - 6.0,
            y - 6.0
        )
    }

    fn goal(&mut self, field: &FieldGeometry, side: FieldSide) -> fmt::Result {
        let fill = match side.goal_colour() {
            GoalColour::Blue => "#3d7be0",
            GoalColour::Yellow => "#f2c21b",
        };
        let posts = field.posts(side);
        let back = Vector::new(side.sign() * field.goal_depth, 0.0);
        writeln!(self.text, r#"<g fill="{fill}" stroke="{fill}" stroke-width="4">"#)?;
        writeln!(self.text, r#"<g fill-opacity="0.28" stroke-opacity="0.7">"#)?;
        self.rectangle(posts[0], posts[1] + back)?;
        writeln!(self.text, "</g>")?;
        for post in posts {
            let (x, y) = self.to_picture(post);
            let radius = field.post_radius * UNITS_PER_METRE + 1.0;
            writeln!(self.text, r#"<circle cx="{x:.1}" cy="{y:.1}" r="{radius:.1}" stroke="none"/>"#)?;
        }
        writeln!(self.text, "</g>")
    }

    fn robot(&mut self, world: &SimulatedWorld, robot: &RobotState, shirt: &str) -> fmt::Result {
        let (x, y) = self.to_picture(robot.pose.position);
        let degrees = -robot.pose.heading.to_degrees();
        let opacity = if robot.on_field { 1.0 } else { 0.45 };
        writeln!(self.text, r#"<g transform="translate({x:.1} {y:.1})" opacity="{opacity}">"#)?;
        writeln!(self.text, r#"<g transform="rotate({degrees:.1})">"#)?;
        let lies = robot.phase.is_fallen()
            || matches!(
                robot.phase,
                BodyPhase::SideFalling(_) | BodyPhase::Diving(_) | BodyPhase::Falling(_)
            );
        if !lies {
            self.upright(world, robot, shirt)?;
        } else {
            self.lying(world, robot, shirt)?;
        }
        writeln!(self.text, "</g>")?;
        let number = robot.number;
        writeln!(
            self.text,
            r##"<text y="4.6" font-size="13" font-weight="700" fill="#fff" text-anchor="middle">{number}</text></g>"##
        )
    }

    /// A robot from above: view, feet, shoulders and head.
    fn upright(&mut self, world: &SimulatedWorld, robot: &RobotState, shirt: &str) -> fmt::Result {
        let physics = world.physics();
        let radius = physics.robot_radius * UNITS_PER_METRE;
        let gaze = -robot.head_yaw.to_degrees();
        let half_view = physics.camera_view_horizontal / 2.0;
        let (sin, cos) = libm::sincos(half_view);
        let (reach_x, reach_y) = (70.0 * cos, 70.0 * sin);
        writeln!(
            self.text,
            r##"<path transform="rotate({gaze:.1})" d="M0 0L{reach_x:.1} {:.1}A70 70 0 0 1 {reach_x:.1} {reach_y:.1}Z" fill="#fff" fill-opacity="0.13"/>"##,
            -reach_y
        )?;
        let feet = (-physics.foot_back * UNITS_PER_METRE, -physics.foot_side * UNITS_PER_METRE);
        let long = (physics.foot_front + physics.foot_back) * UNITS_PER_METRE;
        let wide = physics.foot_side * UNITS_PER_METRE * 0.85;
        for y in [feet.1, -feet.1 - wide] {
            writeln!(
                self.text,
                r##"<rect x="{:.1}" y="{y:.1}" width="{long:.1}" height="{wide:.1}" rx="4" fill="#e8ecef"/>"##,
                feet.0
            )?;
        }
        writeln!(
            self.text,
            r##"<ellipse rx="{:.1}" ry="{radius:.1}" fill="{shirt}" stroke="#101820" stroke-width="1.2"/>"##,
            radius * 0.55
        )?;
        writeln!(
            self.text,
            r##"<path d="M{:.1} -4L{radius:.1} 0L{:.1} 4Z" fill="#fff"/>"##,
            radius * 0.6,
            radius * 0.6
        )
    }

    /// A robot that is lying or falling.
    fn lying(&mut self, world: &SimulatedWorld, robot: &RobotState, shirt: &str) -> fmt::Result {
        let physics = world.physics();
        let (direction, reach) = match robot.phase {
            BodyPhase::Diving(side) => (side.into(), physics.dive_reach),
            BodyPhase::SideFalling(side) => (side.into(), physics.side_fall_reach),
            BodyPhase::Falling(direction) | BodyPhase::Fallen(direction) => (direction, physics.lying_reach),
            _ => return Ok(()),
        };
        let end = direction.vector() * ((reach - physics.lying_radius) * UNITS_PER_METRE);
        let thick = 2.0 * physics.lying_radius * UNITS_PER_METRE;
        writeln!(
            self.text,
            r##"<path d="M0 0L{:.1} {:.1}" stroke="{shirt}" stroke-width="{thick:.1}" stroke-linecap="round"/>"##,
            end.x, -end.y
        )?;
        writeln!(self.text, r##"<circle cx="{:.1}" cy="{:.1}" r="6" fill="#e8ecef"/>"##, end.x, -end.y)
    }

    fn ball(&mut self, world: &SimulatedWorld) -> fmt::Result {
        let (x, y) = self.to_picture(world.ball().position);
        let radius = world.physics().ball_radius * UNITS_PER_METRE + 1.5;
        writeln!(
            self.text,
            r##"<ellipse cx="{:.1}" cy="{:.1}" rx="{radius}" ry="{radius}" opacity="0.35"/>"##,
            x + 1.5,
            y + 2.0
        )?;
        writeln!(
            self.text,
            r##"<circle cx="{x:.1}" cy="{y:.1}" r="{radius}" fill="#ff7a1a" stroke="#8a3a00" stroke-width="0.8"/>"##
        )?;
        writeln!(self.text, r##"<circle cx="{:.1}" cy="{:.1}" r="1.3" fill="#ffd9b8"/>"##, x - 1.4, y - 1.5)
    }

    /// Names, score, clock and state; the team that defends the left goal is on the left.
    fn scoreboard(&mut self, world: &SimulatedWorld, width: f64) -> fmt::Result {
        let referee = world.referee();
        let left = usize::from(referee.defends()[1] == FieldSide::Left);
        let score = referee.score();
        let middle = width / 2.0;
        for (team, x, anchor) in [(left, 20.0, "start"), (1 - left, width - 20.0, "end")] {
            let chip = if anchor == "start" { x } else { x - 14.0 };
            let text = if anchor == "start" { x + 24.0 } else { x - 24.0 };
            let fill = shirt(referee.colours()[team]);
            writeln!(
                self.text,
                r#"<rect x="{chip:.1}" y="25" width="14" height="14" rx="3" fill="{fill}"/>"#
            )?;
            let name = escape(&world.teams()[team].name);
            writeln!(
                self.text,
                r##"<text x="{text:.1}" y="38" font-size="18" fill="#fff" text-anchor="{anchor}">{name}</text>"##
            )?;
        }
        let clock = referee.seconds_remaining().ceil() as u64;
        let state = state_word(referee.state());
        let (home, guest) = (score[left], score[1 - left]);
        writeln!(
            self.text,
            r##"<text x="{middle:.1}" y="34" font-size="26" font-weight="700" fill="#fff" text-anchor="middle">{home} : {guest}</text>"##
        )?;
        writeln!(
            self.text,
            r##"<text x="{middle:.1}" y="54" font-size="12" fill="#b9c4cf" text-anchor="middle">half {} · {}:{:02} left · {state}</text>"##,
            referee.half(),
            clock / 60,
            clock % 60
        )
    }
}

pub(crate) fn shirt(colour: TeamColour) -> &'static str {
    match colour {
        TeamColour::Blue => "#1f4fb5",
        TeamColour::Red => "#c22f3d",
    }
}

fn state_word(state: GameState) -> &'static str {
    match state {
        GameState::Initial => "initial",
        GameState::Ready => "ready",
        GameState::Set => "set",
        GameState::Playing => "playing",
        GameState::Finished => "finished",
    }
}

/// Escapes text for XML; characters that XML does not allow are left out.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars().filter(|character| !character.is_control()) {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            _ => escaped.push(character),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Motion, Setup, Side};

    fn world() -> SimulatedWorld {
        let mut setup = Setup::three_against_three(3);
        setup.teams[0].name = "Kou<retes> & co".into();
        SimulatedWorld::new(setup).unwrap()
    }

    #[test]
    fn it_shows_everyone_and_escapes_names() {
        let picture = render_svg(&world());
        assert!(picture.contains("Kou&lt;retes&gt; &amp; co"));
        assert_eq!(picture.matches("font-size=\"13\"").count(), 6);
        assert_eq!(picture.matches("<g").count(), picture.matches("</g>").count());
        assert!(picture.contains("0 : 0"));
    }

    #[test]
    fn a_diving_robot_is_drawn_lying() {
        let mut world = world();
        (0..700).for_each(|_| world.step());
        let before = render_svg(&world).matches("stroke-linecap").count();
        world.command(0, Command::new(Motion::Dive(Side::Left))).unwrap();
        (0..30).for_each(|_| world.step());
        assert_eq!(render_svg(&world).matches("stroke-linecap").count(), before + 1);
    }
}
