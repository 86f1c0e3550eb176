//! `monas vision` on images that the tests draw.

use std::fs;
use std::path::Path;

use monas_vision::render::{Light, Renderer, RobotFigure, Scene};
use monas_vision::{Camera, FieldObjects, HeadPose, Image, Jersey, rgb_of_yuv};
use nalgebra::Point2;
use serde_json::Value;

use crate::kit::{Answer, command};

/// The arguments that describe the camera of the images.
const CAMERA: [&str; 6] = ["--objects", "2010", "--pitch", "10", "--view", "47.8"];

const WIDTH: usize = 640;
const HEIGHT: usize = 480;

/// Light of lamps: orange is nearly red.
const LAMPS: [f32; 3] = [1.2, 1.0, 0.4];
const DAY: [f32; 3] = [1.0; 3];

fn camera() -> Camera {
    let pose = HeadPose { height: 0.5, pitch: 10f64.to_radians(), ..HeadPose::default() };
    Camera::new(WIDTH, HEIGHT, 47.8f64.to_radians(), &pose.robot_from_camera()).expect("a camera")
}

/// Draws the ball a metre ahead, a robot, and the goal three metres ahead.
fn draw(folder: &Path, name: &str, tint: [f32; 3]) {
    let robot =
        RobotFigure { position: Point2::new(2.0, 0.4), heading: 1.0, jersey: Jersey::Blue, lies: false };
    let scene = Scene {
        markings: Default::default(),
        objects: FieldObjects::OF_2010,
        ball: Some(Point2::new(1.0, -0.1)),
        robots: vec![robot],
        variant: 1,
    };
    let light = Light { tint, noise: 3.0, blur: 0.6, ..Light::default() };
    let mut pixels = Vec::new();
    let image = Renderer::default().draw(&scene, &camera(), &light, 1, &mut pixels).expect("a picture");
    write(folder, name, &image);
}

fn write(folder: &Path, name: &str, image: &Image<'_>) {
    let span = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y)));
    let rgb: Vec<u8> = span.flat_map(|(x, y)| rgb_of_yuv(image.yuv(x, y))).collect();
    let png = monas_scene::encode_png(image.width(), image.height(), &rgb).expect("a PNG");
    fs::write(folder.join(name), png).expect("the folder takes files");
}

fn vision(folder: &Path, arguments: &[&str]) -> Answer {
    let mut command = command(&["vision"]);
    command.current_dir(folder).args(arguments).output().expect("the command starts").into()
}

/// Runs the command with the camera of the images.
fn see(folder: &Path, arguments: &[&str]) -> Answer {
    let all: Vec<&str> = CAMERA.into_iter().chain(arguments.iter().copied()).collect();
    let answer = vision(folder, &all);
    assert_eq!(answer.code, Some(0), "{answer:?}");
    answer
}

/// The pixels of a PNG.
fn read(file: &Path) -> (usize, Vec<u8>) {
    let file = std::io::BufReader::new(fs::File::open(file).expect("the overlay is there"));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut pixels).expect("an image");
    (reader.info().width as usize, pixels)
}

#[test]
fn what_was_seen_is_printed_and_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    draw(folder.path(), "day.png", DAY);
    let answer = see(folder.path(), &["day.png"]);
    assert_eq!(answer.out, include_str!("vision/day.txt"));
    assert_eq!(answer.err, "written to ./day.seen.png\n");

    let (width, drawn) = read(&folder.path().join("day.seen.png"));
    let (_, original) = read(&folder.path().join("day.png"));
    assert_eq!((width, drawn.len()), (WIDTH, 3 * WIDTH * HEIGHT));
    // The ball is circled: its right edge has the colour of the circle, its centre is as it was.
    let (x, y, depth) = camera().project(&nalgebra::Point3::new(1.0, -0.1, 0.0325)).expect("in view");
    let radius = camera().focal() * 0.0325 / depth;
    let has_circle =
        (-4..=4).any(|aside| pixel(&drawn, (x + radius) as i64 + aside, y as i64) == [255, 150, 0]);
    assert!(has_circle, "the ball at {x:.0},{y:.0} is circled");
    let (ball, seen) = (pixel(&original, x as i64, y as i64), pixel(&drawn, x as i64, y as i64));
    assert!(ball.iter().zip(seen).all(|(a, b)| a.abs_diff(b) < 6), "{ball:?} {seen:?}");
    // Border, lines and their points are drawn: colours that the image does not have.
    for (what, colour) in [("border", [255, 0, 255]), ("line", [0, 230, 255]), ("line point", [255, 40, 40])]
    {
        let count = |pixels: &[u8]| pixels.chunks(3).filter(|pixel| *pixel == colour).count();
        assert!(count(&original) == 0 && count(&drawn) > 100, "{what}: {}", count(&drawn));
    }
}

fn pixel(pixels: &[u8], x: i64, y: i64) -> [u8; 3] {
    let at = 3 * (y as usize * WIDTH + x as usize);
    [pixels[at], pixels[at + 1], pixels[at + 2]]
}

fn objects(answer: &Answer) -> Value {
    serde_json::from_str(&answer.out).expect("an object")
}

fn is_ball(seen: &Value) -> bool {
    let objects = seen["objects"].as_array().expect("a list");
    objects.iter().any(|object| {
        object["what"] == "ball" && (object["distance"].as_f64().unwrap_or(9.0) - 1.0).abs() < 0.1
    })
}

#[test]
fn a_table_of_the_light_finds_the_ball() {
    let folder = tempfile::tempdir().expect("a folder");
    draw(folder.path(), "lamps.png", LAMPS);
    draw(folder.path(), "day.png", DAY);
    let json =
        |arguments: &[&str]| objects(&see(folder.path(), &[arguments, &["--format", "json"]].concat()));
    assert!(!is_ball(&json(&["lamps.png"])), "in this light the image alone does not suffice");
    fs::remove_file(folder.path().join("lamps.seen.png")).expect("it was drawn");

    let ball = sample("orange", 1.0, -0.1, 0.0325, 0.02);
    let post = sample("yellow", 3.0, -0.7, 0.4, 0.03);
    let answer =
        see(folder.path(), &["--calibrate", "lamps.xml", "--sample", &ball, "--sample", &post, "lamps.png"]);
    assert_eq!(answer.out, include_str!("vision/lamps.txt"));
    assert_eq!(answer.err, "written to lamps.xml\n");
    assert!(!folder.path().join("lamps.seen.png").exists(), "a table is made in place of overlays");

    for image in ["lamps.png", "day.png"] {
        let seen = json(&["--colours", "lamps.xml", image]);
        assert!(is_ball(&seen), "{image}: {seen}");
        assert!(seen["border_points"].as_array().is_some_and(|points| points.len() > 5), "{seen}");
    }
    let answer = see(
        folder.path(),
        &["--calibrate", "two.xml", "--sample", &format!("lamps.png:{ball}"), "day.png", "lamps.png"],
    );
    assert!(answer.out.contains("orange") && !answer.out.contains("yellow"), "{answer:?}");
}

/// A sample around a point of an object.
fn sample(colour: &str, x: f64, y: f64, z: f64, half: f64) -> String {
    let (column, row, depth) = camera().project(&nalgebra::Point3::new(x, y, z)).expect("in view");
    let reach = camera().focal() * half / depth;
    format!("{colour}={:.0},{:.0},{:.0},{:.0}", column - reach, row - reach, 2.0 * reach, 2.0 * reach)
}

#[test]
fn a_body_begins_with_the_table_that_it_names() {
    let folder = tempfile::tempdir().expect("a folder");
    draw(folder.path(), "lamps.png", LAMPS);
    let ball = sample("orange", 1.0, -0.1, 0.0325, 0.02);
    see(folder.path(), &["--calibrate", "lamps.xml", "--sample", &ball, "lamps.png"]);
    let check = |body: &str| {
        let agents = format!("<agents>{body}<provider thread_frequency=\"10\">Sensors</provider></agents>");
        fs::write(folder.path().join("robot.xml"), agents).expect("the folder takes files");
        let answer: Answer = command(&["config", "check", "robot.xml"])
            .current_dir(folder.path())
            .output()
            .expect("the command starts")
            .into();
        answer
    };
    let good = check("<body vision=\"images\" colours=\"lamps.xml\"/>");
    assert_eq!(good.code, Some(0), "{good:?}");
    let table = fs::read_to_string(folder.path().join("lamps.xml")).expect("it is there");
    fs::write(folder.path().join("broken.xml"), table.replace("width=\"", "width=\"x")).expect("a file");
    for (body, expected) in [
        ("<body vision=\"images\" colours=\"lmaps.xml\"/>", "did you mean `lamps.xml`?"),
        ("<body colours=\"lamps.xml\"/>", "lacks the attribute `vision`"),
        ("<body image_width=\"640\"/>", "lacks the attribute `vision`"),
        ("<body vision=\"images\" image_width=\"500\"/>", "`160`, `320`"),
        ("<body vision=\"images\" colours=\"broken.xml\"/>", "broken.xml:7:"),
    ] {
        let wrong = check(body);
        assert_eq!(wrong.code, Some(3), "{wrong:?}");
        assert!(wrong.err.contains(expected), "{body}: {}", wrong.err);
    }
}

#[test]
fn what_cannot_be_used_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    draw(path, "day.png", DAY);
    fs::write(path.join("notes.txt"), "no image").expect("a file");
    fs::write(path.join("cut.png"), &fs::read(path.join("day.png")).expect("it is there")[..2000])
        .expect("a file");
    fs::write(path.join("cut.jpg"), [0xff, 0xd8, 0xff, 0xe0]).expect("a file");
    fs::write(path.join("hall.xml"), "<colours><green luma=\"95\"/></colours>").expect("a file");
    let grey = vec![128; 2 * 64 * 48];
    write(path, "grey.png", &Image::new(64, 48, &grey).expect("an image"));
    let tiny = monas_scene::encode_png(8, 8, &[0; 192]).expect("a PNG");
    fs::write(path.join("tiny.png"), tiny).expect("a file");
    let calibrate = |sample: &'static str| vec!["--calibrate", "t.xml", "--sample", sample, "day.png"];
    let ball = sample("orange", 1.0, -0.1, 0.0325, 0.02);
    let twice = ball.replace("orange", "yellow");
    for (arguments, code, expected) in [
        (vec!["none.png"], 1, "none.png: No such file"),
        (vec!["notes.txt"], 1, "notes.txt: neither a PNG nor a JPEG; convert it to one of these"),
        (vec!["cut.png"], 1, "cut.png: not a readable PNG: "),
        (vec!["cut.jpg"], 1, "cut.jpg: not a readable JPEG: "),
        (
            vec!["tiny.png"],
            1,
            "tiny.png: an image of 8 x 8 pixels: the width must be even, and both from 16 to 4096",
        ),
        (vec!["--view", "200", "day.png"], 2, "an angle is from -180 to 180 degrees"),
        (vec!["--view", "180", "day.png"], 2, "an angle of view is from 6 to 171 degrees"),
        (vec!["--pitch", "nan", "day.png"], 2, "an angle is from -180 to 180 degrees"),
        (vec!["--roll", "900", "day.png"], 2, "an angle is from -180 to 180 degrees"),
        (vec!["day.png", "other/day.png"], 2, "the overlays of day.png and other/day.png are one file"),
        (vec!["day.jpg", "day.png"], 2, "the overlays of day.jpg and day.png are one file"),
        (vec!["--height", "-1", "day.png"], 2, "unexpected argument '-1'"),
        (vec!["--output", "missing/folder", "day.png"], 1, "cannot write missing/folder/day.seen.png: "),
        (vec!["--colours", "none.xml", "day.png"], 3, "no file `none.xml`"),
        (vec!["--colours", "hall.xml", "day.png"], 3, "error[E0305]: `colours` has no `white`"),
        (vec!["--sample", "orange=1,2,3,4", "day.png"], 2, "--calibrate <TABLE>"),
        (calibrate("orang=1,2,30,40"), 2, "unknown colour `orang`; did you mean `orange`?"),
        (calibrate("x=1,2,30,40"), 2, "there are `green`, `white`, `orange`, `yellow`, `blue`, `red`"),
        (calibrate("orange=1,2,30"), 2, "expected [FILE:]COLOUR=X,Y,WIDTH,HEIGHT"),
        (calibrate("orange=1,2,30,-4"), 2, "expected [FILE:]COLOUR=X,Y,WIDTH,HEIGHT"),
        (calibrate("other.png:orange=1,2,30,40"), 2, "`other.png` is not among the images"),
        (
            calibrate("orange=600,2,50,40"),
            1,
            "day.png: --sample orange=600,2,50,40: the box 600,2,50,40 is not within the image of 640 x 480 pixels",
        ),
        (calibrate("orange=1,2,0,40"), 1, "a box of 0 x 40 pixels is empty"),
        (calibrate("orange=100,440,60,30"), 1, "% of the carpet would be `orange`"),
        (
            vec!["--calibrate", "t.xml", "--sample", &ball, "--sample", &twice, "day.png"],
            1,
            "ambiguous colours: ",
        ),
        (
            vec!["--calibrate", "t.xml", "--sample", &ball, "day.png", "grey.png"],
            2,
            "name one of the 2 images",
        ),
        (
            vec!["--calibrate", "t.xml", "grey.png"],
            1,
            "no image shows enough carpet; add a sample of `green`",
        ),
        (vec!["--calibrate", "missing/t.xml", "day.png"], 1, "cannot write missing/t.xml: "),
        (vec!["--calibrate", "t.xml", "--colours", "hall.xml", "day.png"], 2, "cannot be used with"),
    ] {
        let answer = vision(path, &arguments);
        assert_eq!(answer.code, Some(code), "{arguments:?}: {answer:?}");
        assert!(answer.err.contains(expected), "{arguments:?}: {}", answer.err);
        assert!(answer.out.is_empty() && !path.join("t.xml").exists(), "{arguments:?}: {answer:?}");
    }
}
