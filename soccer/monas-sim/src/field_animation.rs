//! Pictures of recorded moments of a match, as SVG: a still, or an animation.

use std::fmt::{self, Write};
use std::time::Duration;

use crate::draw::{SvgDrawing, escape, shirt};
use crate::pose::Vector;
use crate::{FieldGeometry, Pose, TeamColour};

/// The field, as far as a recording shows it, at one time.
#[derive(Clone, PartialEq, Debug)]
pub struct FieldMoment {
    /// Time since the begin of the run.
    pub time: Duration,
    /// The ball, in the field frame.
    pub ball: Vector,
    /// The robots. One that is missing at a time is not visible then.
    pub robots: Vec<PicturedRobot>,
    /// The goals of each team, by index.
    pub goals: [u32; 2],
    /// The shirts of each team, by index.
    pub colours: [TeamColour; 2],
    /// The half and the state of the game, in words.
    pub phase: String,
}

/// A robot at one time.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PicturedRobot {
    /// The index of its team.
    pub team: usize,
    /// Its number.
    pub number: u8,
    /// Its pose in the field frame.
    pub pose: Pose,
    /// Whether it takes part in the game.
    pub on_field: bool,
    /// Whether it stands or walks.
    pub upright: bool,
    /// The believed position of the ball, in the field frame, if there is one.
    pub believed_ball: Option<Vector>,
}

/// Draws moments of a match from above: robots with team, number and heading, the ball, what each
/// robot believes of it as faint circles, score, time and a scale. Several moments, which are
/// equally far apart, are an animation (SMIL) that repeats.
///
/// ```
/// # use std::time::Duration;
/// # use monas_sim::{FieldGeometry, FieldMoment, TeamColour, Vector, animate_svg};
/// let at = |x, seconds| FieldMoment {
///     time: Duration::from_secs(seconds),
///     ball: Vector::new(x, 0.0),
///     robots: Vec::new(),
///     goals: [0, 0],
///     colours: [TeamColour::Blue, TeamColour::Red],
///     phase: "half 1, playing".into(),
/// };
/// let still = animate_svg(&FieldGeometry::default(), ["Blue", "Red"], &[at(0.0, 0)]);
/// assert!(still.contains("<circle") && !still.contains("<animate"));
/// let animated = animate_svg(&FieldGeometry::default(), ["Blue", "Red"], &[at(0.0, 0), at(1.0, 1)]);
/// assert!(animated.contains("<animateTransform"));
/// ```
pub fn animate_svg(field: &FieldGeometry, teams: [&str; 2], moments: &[FieldMoment]) -> String {
    let mut animation = FieldAnimation { drawing: SvgDrawing::new(field), moments };
    // Writing into a string cannot fail, so the result can be ignored.
    let _ = animation.draw(field, teams);
    animation.drawing.text
}

struct FieldAnimation<'a> {
    drawing: SvgDrawing,
    moments: &'a [FieldMoment],
}

/// The heights of texts on the board and on the carpet.
const NAME: &str = r##"y="38" font-size="18" fill="#fff""##;

impl FieldAnimation<'_> {
    fn draw(&mut self, field: &FieldGeometry, teams: [&str; 2]) -> fmt::Result {
        let width = self.drawing.begin(field)?;
        if self.moments.is_empty() {
            return self.drawing.end();
        }
        let tracks = RobotTrack::of(self.moments);
        for track in &tracks {
            self.belief(track)?;
        }
        for track in &tracks {
            self.robot(track)?;
        }
        let position = self.moving(self.moments.iter().map(|moment| moment.ball));
        write!(self.drawing.text, r#"<g transform="translate({})">"#, position.first)?;
        let ball = r##"<circle r="5" fill="#ff7a1a" stroke="#8a3a00" stroke-width="0.8"/><circle cx="-1.4" cy="-1.5" r="1.3" fill="#ffd9b8"/>"##;
        writeln!(self.drawing.text, "{}{ball}</g>", position.animation)?;
        self.board(width, teams)?;
        self.legend(field)?;
        self.drawing.end()
    }

    fn robot(&mut self, track: &RobotTrack) -> fmt::Result {
        let position = self.moving(track.robots.iter().map(|robot| robot.pose.position));
        let opacity = self.stepping("opacity", track.presences.iter().map(|presence| (*presence).into()));
        let heading = self.turning(track);
        let fill = self.stepping("fill", self.colours(track.team, shirt));
        let shown = |upright| track.robots.iter().map(move |it| u8::from(it.upright == upright).to_string());
        let (standing, lying) =
            (self.stepping("opacity", shown(true)), self.stepping("opacity", shown(false)));
        let text = &mut self.drawing.text;
        write!(
            text,
            r#"<g transform="translate({})" opacity="{}">{}{}"#,
            position.first, opacity.first, position.animation, opacity.animation
        )?;
        write!(text, r#"<g transform="rotate({})" fill="{}">"#, heading.first, fill.first)?;
        write!(text, "{}{}", heading.animation, fill.animation)?;
        write!(text, r##"<g opacity="{}">{}"##, standing.first, standing.animation)?;
        text.push_str(r##"<path d="M-6 -9h15v8h-15zM-6 1h15v8h-15z" fill="#e8ecef"/><ellipse rx="7.2" ry="13" stroke="#101820" stroke-width="1.2"/><path d="M7.8 -4L14 0L7.8 4Z" fill="#fff"/></g>"##);
        write!(text, r##"<g opacity="{}">{}"##, lying.first, lying.animation)?;
        text.push_str(r##"<rect x="-22" y="-7" width="44" height="14" rx="7" stroke="#101820" stroke-width="1.2"/><circle cx="18" r="5" fill="#e8ecef"/></g></g>"##);
        writeln!(
            text,
            r##"<text y="4.6" font-size="13" font-weight="700" fill="#fff" text-anchor="middle">{}</text></g>"##,
            track.number
        )
    }

    /// A faint circle where a robot believes the ball to be.
    fn belief(&mut self, track: &RobotTrack) -> fmt::Result {
        let robots = &track.robots;
        if robots.iter().all(|robot| robot.believed_ball.is_none()) {
            return Ok(());
        }
        let position =
            self.moving(robots.iter().map(|robot| robot.believed_ball.unwrap_or(robot.pose.position)));
        let shown = |robot: &PicturedRobot| if robot.believed_ball.is_some() { "0.6" } else { "0" };
        let opacity = self.stepping("opacity", robots.iter().map(|robot| shown(robot).into()));
        let stroke = self.stepping("stroke", self.colours(track.team, faint));
        let text = &mut self.drawing.text;
        write!(
            text,
            r#"<circle r="7" fill="none" stroke-width="2" stroke="{}" opacity="{}" transform="translate({})">"#,
            stroke.first, opacity.first, position.first
        )?;
        writeln!(text, "{}{}{}</circle>", stroke.animation, opacity.animation, position.animation)
    }

    /// Names, score, time and state of the game.
    fn board(&mut self, width: f64, teams: [&str; 2]) -> fmt::Result {
        for (index, x, chip, anchor) in [(0, 44.0, 20.0, "start"), (1, width - 44.0, width - 34.0, "end")] {
            let fill = self.stepping("fill", self.colours(index, shirt));
            let text = &mut self.drawing.text;
            write!(
                text,
                r#"<rect x="{chip:.0}" y="25" width="14" height="14" rx="3" fill="{}">"#,
                fill.first
            )?;
            writeln!(text, "{}</rect>", fill.animation)?;
            let name = escape(teams[index]);
            writeln!(text, r#"<text x="{x:.0}" {NAME} text-anchor="{anchor}">{name}</text>"#)?;
        }
        let middle = width / 2.0;
        let score = |moment: &FieldMoment| format!("{} : {}", moment.goals[0], moment.goals[1]);
        self.changing_text(
            &format!(r#"x="{middle:.0}" y="34" font-size="26" font-weight="700""#),
            "#fff",
            score,
        )?;
        let under = |moment: &FieldMoment| format!("{} s · {}", moment.time.as_secs(), moment.phase);
        self.changing_text(&format!(r#"x="{middle:.0}" y="54" font-size="12""#), "#b9c4cf", under)
    }

    /// The scale, and what the circles are.
    fn legend(&mut self, field: &FieldGeometry) -> fmt::Result {
        self.drawing.scale(field)?;
        let below = Vector::new(0.0, -field.half_width() - field.border * 0.6);
        let (x, y) = self.drawing.to_picture(below);
        let (blue, red) = (faint(TeamColour::Blue), faint(TeamColour::Red));
        let text = &mut self.drawing.text;
        for (x, stroke) in [(x, blue), (x + 18.0, red)] {
            writeln!(
                text,
                r#"<circle cx="{x:.0}" cy="{y:.0}" r="7" fill="none" stroke-width="2" stroke="{stroke}"/>"#
            )?;
        }
        let (x, y) = (x + 32.0, y + 4.0);
        writeln!(
            text,
            r##"<text x="{x:.0}" y="{y:.0}" font-size="13" fill="#f4f7f5">the ball as a robot believes it</text>"##
        )
    }

    /// A text that changes: one element for each, of which one is visible.
    fn changing_text(
        &mut self,
        position: &str,
        fill: &str,
        content: impl Fn(&FieldMoment) -> String,
    ) -> fmt::Result {
        let mut all: Vec<String> = self.moments.iter().map(&content).collect();
        all.dedup();
        all.sort();
        all.dedup();
        for one in all {
            let is_shown = |moment| u8::from(content(moment) == one).to_string();
            let shown = self.stepping("opacity", self.moments.iter().map(is_shown));
            let text = &mut self.drawing.text;
            write!(
                text,
                r#"<text {position} fill="{fill}" text-anchor="middle" opacity="{}">"#,
                shown.first
            )?;
            writeln!(text, "{}{}</text>", escape(&one), shown.animation)?;
        }
        Ok(())
    }

    /// The colour of a team at each moment.
    fn colours(&self, team: usize, of: impl Fn(TeamColour) -> &'static str) -> impl Iterator<Item = String> {
        self.moments.iter().map(move |moment| of(moment.colours[team]).into())
    }

    /// A position that changes from moment to moment.
    fn moving(&self, positions: impl Iterator<Item = Vector>) -> AnimatedValue {
        let text = |position| {
            let (x, y) = self.drawing.to_picture(position);
            format!("{x:.0} {y:.0}")
        };
        self.transformed("translate", positions.map(text).collect())
    }

    /// The heading of a robot, in degrees, on the shorter way from moment to moment.
    fn turning(&self, track: &RobotTrack) -> AnimatedValue {
        let mut before = 0.0;
        let turned = track.robots.iter().map(|robot| {
            let degrees = -robot.pose.heading.to_degrees();
            let turns: f64 = (degrees - before) / 360.0;
            before = degrees - 360.0 * turns.round();
            format!("{before:.0}")
        });
        self.transformed("rotate", turned.collect())
    }

    fn transformed(&self, kind: &str, values: Vec<String>) -> AnimatedValue {
        let first = values.first().cloned().unwrap_or_default();
        if values.iter().all(|value| *value == first) {
            return AnimatedValue { first, animation: String::new() };
        }
        let (values, length) = (values.join(";"), self.seconds());
        let animation = format!(
            r#"<animateTransform attributeName="transform" type="{kind}" values="{values}" dur="{length}s" repeatCount="indefinite"/>"#
        );
        AnimatedValue { first, animation }
    }

    /// A value that changes at once.
    fn stepping(&self, attribute: &str, values: impl Iterator<Item = String>) -> AnimatedValue {
        let values: Vec<String> = values.collect();
        let first = values.first().cloned().unwrap_or_default();
        let mut changes: Vec<(f64, &String)> = Vec::new();
        for (index, value) in values.iter().enumerate() {
            if changes.last().is_none_or(|(_, before)| *before != value) {
                changes.push((index as f64 / values.len() as f64, value));
            }
        }
        if changes.len() < 2 {
            return AnimatedValue { first, animation: String::new() };
        }
        let times: Vec<String> = changes.iter().map(|(time, _)| format!("{time:.3}")).collect();
        let values: Vec<&str> = changes.iter().map(|(_, value)| value.as_str()).collect();
        let (times, values, length) = (times.join(";"), values.join(";"), self.seconds());
        let animation = format!(
            r#"<animate attributeName="{attribute}" calcMode="discrete" values="{values}" keyTimes="{times}" dur="{length}s" repeatCount="indefinite"/>"#
        );
        AnimatedValue { first, animation }
    }

    /// The length of the animation.
    fn seconds(&self) -> f64 {
        let ends = self.moments.first().zip(self.moments.last());
        ends.map_or(0.0, |(first, last)| last.time.saturating_sub(first.time).as_secs_f64())
    }
}

/// A robot at all moments.
struct RobotTrack {
    team: usize,
    number: u8,
    /// At a moment that does not have the robot it is where it was before, or where it will be
    /// first.
    robots: Vec<PicturedRobot>,
    /// The opacity at each moment.
    presences: Vec<&'static str>,
}

impl RobotTrack {
    /// All robots of these moments. The moments may come from several fields, or from a person.
    fn of(moments: &[FieldMoment]) -> Vec<RobotTrack> {
        let mut tracks: Vec<RobotTrack> = Vec::new();
        for robot in moments.iter().flat_map(|moment| &moment.robots) {
            if !tracks.iter().any(|track| track.is_of(robot)) {
                tracks.push(RobotTrack::follow(*robot, moments));
            }
        }
        tracks
    }

    fn follow(first: PicturedRobot, moments: &[FieldMoment]) -> RobotTrack {
        let PicturedRobot { team, number, .. } = first;
        let (robots, presences) = (Vec::new(), Vec::new());
        let mut track = RobotTrack { team, number, robots, presences };
        let mut last = first;
        for moment in moments {
            let found = moment.robots.iter().find(|robot| track.is_of(robot));
            last = found.copied().unwrap_or(PicturedRobot { believed_ball: None, ..last });
            track.robots.push(last);
            track.presences.push(match found {
                Some(robot) if robot.on_field => "1",
                Some(_) => "0.45",
                None => "0",
            });
        }
        track
    }

    fn is_of(&self, robot: &PicturedRobot) -> bool {
        (self.team, self.number) == (robot.team, robot.number)
    }
}

/// The colour of what a team believes.
const fn faint(colour: TeamColour) -> &'static str {
    match colour {
        TeamColour::Blue => "#a9c8ff",
        TeamColour::Red => "#ffb3ba",
    }
}

/// An attribute: its value at the begin, and the element that changes it, if it changes.
struct AnimatedValue {
    first: String,
    animation: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(seconds: u64, heading: f64, believed: Option<Vector>) -> FieldMoment {
        let robot = PicturedRobot {
            team: 0,
            number: 2,
            pose: Pose { position: Vector::new(1.0, 0.5), heading },
            on_field: true,
            upright: seconds == 0,
            believed_ball: believed,
        };
        FieldMoment {
            time: Duration::from_secs(seconds),
            ball: Vector::new(0.5, -1.0),
            robots: vec![robot],
            goals: [u32::from(seconds > 0), 0],
            colours: [TeamColour::Blue, TeamColour::Red],
            phase: "half 1, playing".into(),
        }
    }

    fn drawn(moments: &[FieldMoment]) -> String {
        animate_svg(&FieldGeometry::default(), ["B<", "R"], moments)
    }

    #[test]
    fn a_still_shows_robots_ball_beliefs_and_score() {
        let still = drawn(&[moment(0, 0.0, Some(Vector::new(0.0, 0.0)))]);
        assert!(still.contains(">2</text>") && still.contains("0 : 0") && still.contains("B&lt;"), "{still}");
        assert!(still.contains(r#"translate(470 284)"#), "the robot at 1 m, 0.5 m: {still}");
        assert!(
            still.contains(r##"stroke="#a9c8ff" opacity="0.6" transform="translate(370 334)""##),
            "{still}"
        );
        assert!(still.contains("1 m</text>") && !still.contains("<animate"), "{still}");
        assert!(!drawn(&[moment(0, 0.0, None)]).contains("opacity=\"0.6\""));
        assert_eq!(still.matches("<g").count(), still.matches("</g>").count());
    }

    #[test]
    fn robots_are_followed_by_team_and_number() {
        let mut moments = [0, 1, 2].map(|seconds| moment(seconds, 0.0, None));
        let first = moments[0].robots[0];
        let other = PicturedRobot { number: 5, pose: Pose::new(0.0, 0.0, 0.0), ..first };
        moments[1].robots = vec![other, first];
        moments[2].robots.clear();
        let animated = drawn(&moments);
        assert!(animated.contains(">2</text>") && animated.contains(">5</text>"), "{animated}");
        assert!(!animated.contains("type=\"translate\""), "no robot has moved: {animated}");
        let visible =
            |values: &str| format!(r#"attributeName="opacity" calcMode="discrete" values="{values}""#);
        assert!(animated.contains(&visible("1;0")) && animated.contains(&visible("0;1;0")), "{animated}");
    }

    #[test]
    fn what_changes_is_animated_and_turns_on_the_shorter_way() {
        let animated = drawn(&[moment(0, 3.1, None), moment(1, -3.1, None)]);
        assert!(animated.contains(r#"type="rotate" values="-178;-182" dur="1s""#), "{animated}");
        assert!(!animated.contains("type=\"translate\""), "nothing has moved: {animated}");
        let score = r#"opacity="0"><animate attributeName="opacity" calcMode="discrete" values="0;1""#;
        assert!(animated.contains("1 : 0") && animated.contains(&score[12..]), "{animated}");
    }
}
