//! The field as text, for terminals.

use std::f64::consts::FRAC_PI_4;

use crate::pose::Vector;
use crate::{SimulatedWorld, TeamColour};

/// Headings in steps of 45 degrees, counter-clockwise.
const HEADING_ARROWS: [char; 8] = ['→', '↗', '↑', '↖', '←', '↙', '↓', '↘'];

/// A character of the picture with its colour, as in SGR sequences.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Cell(char, &'static str);

/// The field from above in lines of text: robots as `b2→` with team, number and heading (`_` for
/// one that lies), the ball as `o`. With colours, lines contain SGR sequences.
///
/// ```
/// # let world = monas_sim::SimulatedWorld::new(monas_sim::Setup::three_against_three(7))?;
/// let lines = monas_sim::render_text(&world, 79, 21, false);
/// assert_eq!(lines.len(), 21);
/// # Ok::<(), monas_sim::Error>(())
/// ```
pub fn render_text(world: &SimulatedWorld, columns: usize, rows: usize, is_coloured: bool) -> Vec<String> {
    let (columns, rows) = (columns.max(1), rows.max(1));
    let field = world.field();
    let half = Vector::new(field.half_length(), field.half_width());
    let far = Vector::new(half.x + field.border, half.y + field.border);
    let cell_of = |point: Vector| {
        let share = |value: f64, far: f64, count: usize| {
            let last = (count - 1) as f64;
            ((value + far) / (2.0 * far) * last).round().clamp(0.0, last) as usize
        };
        (share(point.x, far.x, columns), share(-point.y, far.y, rows))
    };
    let mut cells = vec![vec![Cell(' ', ""); columns]; rows];
    let ((left, top), (right, bottom)) =
        (cell_of(Vector::new(-half.x, half.y)), cell_of(Vector::new(half.x, -half.y)));
    let (middle, _) = cell_of(Vector::zeros());
    for line in [top, bottom] {
        cells[line][left..=right].fill(Cell('─', "2"));
    }
    let mouth = Vector::new(0.0, field.goal_width / 2.0);
    let goal = cell_of(mouth).1..=cell_of(-mouth).1;
    for (row, line) in cells.iter_mut().enumerate().take(bottom).skip(top + 1) {
        line[middle] = Cell('┊', "2");
        let post = if goal.contains(&row) { Cell('║', "33") } else { Cell('│', "2") };
        (line[left], line[right]) = (post, post);
    }
    let corners = [(top, left, '┌'), (top, right, '┐'), (bottom, left, '└'), (bottom, right, '┘')];
    corners.into_iter().for_each(|(row, column, corner)| cells[row][column] = Cell(corner, "2"));
    let colours = world.referee().colours();
    for robot in world.robots().iter().filter(|robot| robot.on_field) {
        let (column, row) = cell_of(robot.pose.position);
        let eighth = (robot.pose.heading / FRAC_PI_4).round() as i64;
        let arrow = HEADING_ARROWS[eighth.rem_euclid(8) as usize];
        let heading = if robot.phase.is_upright() { arrow } else { '_' };
        let (letter, colour) = match colours[robot.team] {
            TeamColour::Blue => ('b', "1;34"),
            TeamColour::Red => ('r', "1;31"),
        };
        let number = char::from_digit(u32::from(robot.number), 36).unwrap_or('?');
        for (offset, sign) in [letter, number, heading].into_iter().enumerate() {
            let position = (column + offset).saturating_sub(1).min(columns - 1);
            cells[row][position] = Cell(sign, colour);
        }
    }
    let (column, row) = cell_of(world.ball().position);
    cells[row][column] = Cell('o', "1;33");
    cells.iter().map(|line| text_of(line, is_coloured)).collect()
}

fn text_of(line: &[Cell], is_coloured: bool) -> String {
    if !is_coloured {
        return line.iter().map(|cell| cell.0).collect::<String>().trim_end().to_owned();
    }
    let mut text = String::new();
    for run in line.chunk_by(|one, next| one.1 == next.1) {
        let signs: String = run.iter().map(|cell| cell.0).collect();
        text += &match run[0].1 {
            "" => signs,
            colour => format!("\x1b[{colour}m{signs}\x1b[0m"),
        };
    }
    text
}

#[cfg(test)]
mod tests {
    use crate::Setup;

    use super::*;

    #[test]
    fn robots_ball_and_lines_fit_on_a_small_terminal() {
        let world = SimulatedWorld::new(Setup::three_against_three(3)).unwrap();
        let lines = render_text(&world, 79, 21, false);
        assert_eq!(lines.len(), 21);
        assert!(lines.iter().all(|line| line.chars().count() <= 79), "{lines:#?}");
        let all = lines.join("\n");
        for sign in ["b1", "b2", "b3", "r1", "r2", "r3", "o", "┌", "║"] {
            assert!(all.contains(sign), "{sign} in\n{all}");
        }
        let coloured = render_text(&world, 79, 21, true).join("\n");
        assert!(coloured.contains("\x1b[1;34mb1"), "{coloured}");
        assert_eq!(render_text(&world, 0, 0, false).len(), 1, "no size is too small");
    }
}
