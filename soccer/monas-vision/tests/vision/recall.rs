//! Recall, false sightings and errors of distance have bounds, under all lights. The example
//! `recall` prints the figures.
#![allow(clippy::unwrap_used, reason = "a test")]

use monas_vision::FieldObjects;

use crate::examines_large_images;
use crate::measure::{CONDITIONS, Measures, Sequence, Tally, Views, mean, ninth_decile};

/// The bounds on the detections of a kind of object, over all lights.
struct Bounds {
    /// Least number shown, so that the others mean something.
    shown: u32,
    recall: f64,
    /// False sightings for each image.
    wrong: f64,
    /// Errors of distance, as parts of the distance: mean, and of nine in ten.
    distance: (f64, f64),
}

fn check(name: &str, tally: &Tally, images: u32, bounds: &Bounds) {
    let Bounds { shown, recall, wrong, distance } = bounds;
    assert!(tally.shown >= *shown, "{name}: {} shown", tally.shown);
    assert!(tally.recall() >= *recall, "{name}: {} of {} found", tally.found, tally.shown);
    let false_ones = f64::from(tally.wrong) / f64::from(images);
    assert!(false_ones <= *wrong, "{name}: {} false ones in {images} images", tally.wrong);
    let errors = (mean(&tally.distance_errors), ninth_decile(&tally.distance_errors));
    assert!(errors.0 <= distance.0 && errors.1 <= distance.1, "{name}: errors of distance {errors:?}");
}

/// Measures under each light, checks the recall of the ball and of lines under each, and returns
/// the sum.
fn measure(objects: FieldObjects, images: u32, width: usize) -> Measures {
    let mut all = Measures::default();
    for condition in &CONDITIONS {
        let measures = Sequence { views: Views::Field, objects, condition, images, width, seed: 1 }.measure();
        assert!(measures.ball.recall() >= 0.85, "{}: ball {:?}", condition.name, measures.ball);
        assert!(measures.lines.recall() >= 0.95, "{}: {}", condition.name, measures.lines.recall());
        all.add(&measures);
    }
    all
}

#[test]
fn what_was_not_measured_has_no_sign() {
    let measures = Measures::default().to_string();
    assert!(!measures.contains('-'), "{measures}");
}

fn check_all(all: &Measures, posts: f64) {
    let images = all.images;
    let ball = Bounds { shown: 60, recall: 0.97, wrong: 0.01, distance: (0.02, 0.04) };
    check("ball", &all.ball, images, &ball);
    check(
        "posts",
        &all.posts,
        images,
        &Bounds { shown: 25, recall: posts, wrong: 0.005, distance: (0.03, 0.06) },
    );
    let robots = Bounds { shown: 10, recall: 0.9, wrong: 0.005, distance: (0.05, 0.09) };
    check("robots", &all.robots, images, &robots);
    assert!(all.wrong_jerseys * 20 <= all.jerseys, "{} of {} jerseys", all.wrong_jerseys, all.jerseys);
    let lines = &all.lines;
    assert!(lines.recall() >= 0.98, "lines: {}", lines.recall());
    let false_points = f64::from(lines.wrong) / f64::from(lines.found + lines.wrong);
    assert!(false_points <= 0.02, "lines: {} of {}", lines.wrong, lines.found);
    assert!(all.border.recall() >= 0.95, "border: {}", all.border.recall());
    check_lines(all);
}

/// Published lines and border: the share of the lines that is covered, and the errors of position.
fn check_lines(all: &Measures) {
    println!("{all}");
    assert!(all.right_segments > all.images, "{} parts of lines", all.right_segments);
    assert!(all.segments.recall() >= 0.9, "parts of lines: {}", all.segments.recall());
    assert!(all.false_segments() <= 0.02, "{} false parts of lines", all.segments.wrong);
    let (offset, angle) = (&all.segment_offsets, &all.segment_angles);
    assert!(mean(offset) <= 0.02 && ninth_decile(offset) <= 0.04, "{} m off", mean(offset));
    let (angle, max) = (mean(angle).to_degrees(), ninth_decile(angle).to_degrees());
    assert!(angle <= 1.5 && max <= 3.0, "{angle} degrees off, {max} in nine of ten");
    let border = &all.border_points;
    assert!(border.found > 5 * all.images, "{} points of the border", border.found);
    assert!(mean(&border.distance_errors) <= 0.03, "border: {}", mean(&border.distance_errors));
    assert!(all.false_border_points() <= 0.05, "border: {} false points", border.wrong);
}

#[test]
fn orange_ball_and_coloured_goals_are_found_under_all_lights() {
    if examines_large_images() {
        check_all(&measure(FieldObjects::OF_2010, 30, 640), 0.95);
    }
}

#[test]
fn black_and_white_ball_and_white_goals_are_found_under_all_lights() {
    if examines_large_images() {
        check_all(&measure(FieldObjects::OF_TODAY, 30, 640), 0.92);
    }
}

#[test]
fn small_images_show_the_same_nearby() {
    let all = measure(FieldObjects::OF_2010, 30, 320);
    check(
        "ball",
        &all.ball,
        all.images,
        &Bounds { shown: 60, recall: 0.9, wrong: 0.02, distance: (0.03, 0.06) },
    );
    check(
        "posts",
        &all.posts,
        all.images,
        &Bounds { shown: 25, recall: 0.85, wrong: 0.03, distance: (0.04, 0.08) },
    );
}

#[test]
fn the_same_sequence_gives_the_same_figures() {
    let sequence = Sequence {
        views: Views::Field,
        objects: FieldObjects::OF_TODAY,
        condition: &CONDITIONS[7],
        images: 3,
        width: 320,
        seed: 5,
    };
    assert_eq!(sequence.measure().to_string(), sequence.measure().to_string());
}
