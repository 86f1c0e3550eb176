//! Frames of the cameras of a Nao, in which a person has marked what there is to see; the test is
//! skipped if their folder is absent.
#![allow(clippy::unwrap_used)] // tests may panic

use std::path::{Path, PathBuf};

use monas_scene::RgbImage;
use monas_vision::{Camera, Detections, FieldObjects, HeadPose, Image, PixelBox, Vision};

/// Columns and rows of the pixels that show something: left, top, right, bottom.
type MarkedBox = [f64; 4];

/// A frame, the possible pitches of its camera in degrees, and what it shows. No frame shows a post
/// or a robot.
struct MarkedFrame {
    file: &'static str,
    pitches: &'static [f64],
    ball: Option<MarkedBox>,
    /// People and things as high as a robot, which may be taken for one.
    others: &'static [MarkedBox],
}

const BALL: Option<MarkedBox> = Some([356.0, 266.0, 382.0, 292.0]);

const fn top(file: &'static str, ball: Option<MarkedBox>, others: &'static [MarkedBox]) -> MarkedFrame {
    MarkedFrame { file, pitches: &[8.0], ball, others }
}

/// The lower camera of a Nao looks 39.7 degrees lower than the upper one.
const FRAMES: [MarkedFrame; 9] = [
    top("nao_top_000.jpg", BALL, &[[0.0, 0.0, 128.0, 312.0]]),
    top("nao_top_020.jpg", BALL, &[[40.0, 0.0, 152.0, 312.0]]),
    top("nao_top_030.jpg", None, &[[0.0, 0.0, 108.0, 480.0], [286.0, 20.0, 640.0, 450.0]]),
    top("nao_top_150.jpg", BALL, &[]),
    top("nao_top_156.jpg", BALL, &[]),
    top("nao_top_162.jpg", BALL, &[]),
    top("nao_top_168.jpg", BALL, &[]),
    top("nao_top_174.jpg", BALL, &[]),
    MarkedFrame {
        file: "nao_bottom_040.jpg",
        pitches: &[36.0, 40.0, 44.0, 48.0, 52.0],
        ball: None,
        others: &[],
    },
];

fn folder() -> PathBuf {
    let shared = std::env::var_os("MONAS_SHARED").map(PathBuf::from);
    let shared = shared.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"));
    shared.join("robots/images")
}

fn see(file: &Path, pitch: f64) -> Detections {
    let rgb = RgbImage::read(file).unwrap();
    let mut pixels = Vec::new();
    let width = monas_vision::yuv422_of_rgb(rgb.width, &rgb.bytes, &mut pixels);
    let image = Image::new(width, rgb.height, &pixels).unwrap();
    let pose = HeadPose { height: 0.5, pitch: pitch.to_radians(), ..HeadPose::default() };
    let view = 60.9_f64.to_radians();
    let camera = Camera::new(width, rgb.height, view, &pose.robot_from_camera()).unwrap();
    Vision::new(FieldObjects::OF_TODAY).see(&image, &camera).unwrap().clone()
}

/// The area of what two boxes share, relative to that of both together.
fn overlap(seen: &PixelBox, marked: &MarkedBox) -> f64 {
    let [left, top, right, bottom] = *marked;
    let width = (seen.right.min(right) - seen.left.max(left)).max(0.0);
    let height = (seen.bottom.min(bottom) - seen.top.max(top)).max(0.0);
    let area = (seen.right - seen.left) * (seen.bottom - seen.top) + (right - left) * (bottom - top);
    width * height / (area - width * height)
}

fn is_inside(seen: &PixelBox, marked: &MarkedBox) -> bool {
    let (x, y) = ((seen.left + seen.right) / 2.0, (seen.top + seen.bottom) / 2.0);
    (marked[0]..marked[2]).contains(&x) && (marked[1]..marked[3]).contains(&y)
}

#[test]
fn real_frames_show_the_ball_and_no_robots_or_posts() {
    let folder = folder();
    if !folder.is_dir() {
        return println!("skipped: there are no frames in {}", folder.display());
    }
    let (mut shown, mut found, mut people) = (0, 0, 0);
    for MarkedFrame { file, pitches, ball, others } in &FRAMES {
        for pitch in *pitches {
            let seen = see(&folder.join(file), *pitch);
            println!("{file}, {pitch} degrees: ball {:?}, robots {:?}", seen.ball, seen.robots);
            shown += usize::from(ball.is_some());
            let is_right = |seen: &PixelBox| ball.is_some_and(|ball| overlap(seen, &ball) > 0.7);
            found += usize::from(seen.ball.is_some_and(|ball| is_right(&ball.area)));
            let wrong = seen.ball.filter(|ball| !is_right(&ball.area));
            assert!(wrong.is_none(), "{file}, {pitch} degrees: a false ball: {wrong:?}");
            assert!(seen.posts.is_empty(), "{file}, {pitch} degrees: false posts: {:?}", seen.posts);
            for robot in &seen.robots {
                let is_other = others.iter().any(|other| is_inside(&robot.sight.area, other));
                assert!(is_other, "{file}, {pitch} degrees: a false robot: {robot:?}");
                people += 1;
            }
        }
    }
    println!("{found} of {shown} balls; {people} people and things taken for robots");
    assert_eq!((shown, found), (7, 7));
    assert!(people <= 4, "{people} people and things taken for robots");
}
