//! Layout settings as text: `at = 40 120`, `size = 160 60`, `via = 40 80, 120 80`.

use yase::statechart::{Frame, Point};

/// Keys of a state's layout.
pub const FRAME_KEYS: [&str; 2] = ["at", "size"];
/// Key of a transition's layout.
pub const BENDS_KEY: &str = "via";
/// The form of a position, for hints.
pub const POSITION_FORM: &str = "a position is two numbers of pixels, right and down, such as `40 120`";
/// The form of a size, for hints.
pub const SIZE_FORM: &str = "a size is two numbers of pixels, width and height, such as `160 60`";
/// The form of corners, for hints.
pub const CORNERS_FORM: &str = "corners are positions separated by commas, such as `40 80, 120 80`";

/// The largest coordinate, in pixels.
const MAX_COORDINATE: f64 = 100_000.0;

/// `40 120`.
pub fn parse_position(text: &str) -> Option<Point> {
    let mut numbers = text.split_whitespace().map(|word| word.parse::<f64>().ok());
    let (right, down) = (numbers.next()??, numbers.next()??);
    let is_on_page = |number: f64| (0.0..=MAX_COORDINATE).contains(&number);
    (numbers.next().is_none() && is_on_page(right) && is_on_page(down)).then_some((right, down))
}

/// A size: `160 60`, both positive.
pub fn size(text: &str) -> Option<Point> {
    parse_position(text).filter(|(width, height)| *width > 0.0 && *height > 0.0)
}

/// `40 80, 120 80`.
pub fn bends(text: &str) -> Option<Vec<Point>> {
    text.split(',').map(parse_position).collect()
}

/// The layout settings of a state, each with its key.
pub fn frame_settings(frame: &Frame) -> Vec<(&'static str, String)> {
    let said = [("at", frame.at), ("size", frame.size)];
    said.into_iter().filter_map(|(key, value)| Some((key, point_text(value?)))).collect()
}

/// The value of a transition's corners.
pub fn bends_text(bends: &[Point]) -> String {
    bends.iter().copied().map(point_text).collect::<Vec<_>>().join(", ")
}

fn point_text((right, down): Point) -> String {
    format!("{right} {down}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_two_numbers_on_a_page() {
        assert_eq!(parse_position(" 40  120.5 "), Some((40.0, 120.5)));
        for wrong in ["", "40", "40 1 2", "-1 0", "inf 0", "NaN 0", "100001 0", "40,120", "a b"] {
            assert_eq!(parse_position(wrong), None, "{wrong}");
        }
        assert_eq!(size("0 60"), None);
        assert_eq!(bends("1 2, 3 4"), Some(vec![(1.0, 2.0), (3.0, 4.0)]));
        assert_eq!(bends("1 2,"), None);
    }

    #[test]
    fn written_files_are_read_back() {
        let frame = Frame { at: Some((0.1, 3.0)), size: None };
        assert_eq!(frame_settings(&frame), [("at", "0.1 3".to_owned())]);
        let corners = [(1.0, 2.5), (3.0, 4.0)];
        assert_eq!(bends(&bends_text(&corners)).as_deref(), Some(&corners[..]));
    }
}
