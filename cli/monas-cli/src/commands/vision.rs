//! `monas vision`: what images of files show.

mod calibrate;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum, ValueHint};
use monas::config::colours;
use monas_scene::RgbImage;
use monas_soccer::field_colours::colour_model;
use monas_vision::{
    Camera, ColourModel, Detections, FieldObjects, GoalPaint, GroundObject, HeadPose, Image, Jersey,
    PostSide, Vision,
};
use serde_json::json;

use calibrate::SampleArgument;
use monas_terminal::table::of_numbers;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument};

/// Arguments of `monas vision`.
#[derive(Args, Debug)]
pub(crate) struct VisionArguments {
    /// Images, in PNG or JPEG.
    #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
    files: Vec<PathBuf>,
    /// Ball and goals to look for.
    #[arg(long, value_enum, default_value = "today")]
    objects: ObjectSet,
    /// Pitch of the camera, degrees, positive downwards.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, value_parser = angle, allow_negative_numbers = true)]
    pitch: f64,
    /// Roll of the camera, degrees, positive to the right.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, value_parser = angle, allow_negative_numbers = true)]
    roll: f64,
    /// Height of the camera above the ground, metres.
    #[arg(long, value_name = "METRES", default_value_t = 0.5)]
    height: f64,
    /// Angle of view from left to right, degrees: 47.8 for a Nao V3, 60.9 for V4 and V5, 54.7 for
    /// V6.
    #[arg(long, value_name = "DEGREES", default_value_t = 54.7, value_parser = angle_of_view)]
    view: f64,
    /// The folder for the overlays.
    #[arg(short, long, value_name = "FOLDER", default_value = ".", value_hint = ValueHint::DirPath)]
    output: PathBuf,
    /// Start from the colours of this table instead of those of the image alone.
    #[arg(long, value_name = "TABLE", value_hint = ValueHint::FilePath)]
    colours: Option<PathBuf>,
    /// Make a colour table from the images instead of overlays: for `--colours`, and for the
    /// attribute `colours` of a body.
    #[arg(long, value_name = "TABLE", value_hint = ValueHint::FilePath, conflicts_with = "colours")]
    calibrate: Option<PathBuf>,
    /// A box of an image with a known colour: green (carpet), white (lines), orange, yellow, blue
    /// or red. With several images, FILE names the image.
    #[arg(
        long = "sample",
        value_name = "[FILE:]COLOUR=X,Y,WIDTH,HEIGHT",
        value_parser = SampleArgument::parse,
        requires = "calibrate"
    )]
    samples: Vec<SampleArgument>,
    #[command(flatten)]
    format: FormatArgument,
}

/// Ball and goals of a time.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum ObjectSet {
    /// An orange ball, a yellow and a blue goal.
    #[value(name = "2010")]
    Of2010,
    /// A black and white ball, white goals.
    #[value(name = "today")]
    OfToday,
}

pub(crate) fn execute(
    arguments: &VisionArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    if let Some(table) = &arguments.calibrate {
        return calibrate::calibrate(arguments, table, console);
    }
    let colours = known_colours(arguments)?;
    check_overlays(arguments)?;
    for file in &arguments.files {
        let failed =
            |message: String| CommandFailure::Failed(format, format!("{}: {message}", file.display()));
        let rgb = RgbImage::read(file).map_err(failed)?;
        let mut pixels = Vec::new();
        let width = monas_vision::yuv422_of_rgb(rgb.width, &rgb.bytes, &mut pixels);
        let image = Image::new(width, rgb.height, &pixels).map_err(|error| failed(error.to_string()))?;
        let camera = camera(arguments, &image).map_err(|error| failed(error.to_string()))?;
        let objects = objects(arguments.objects);
        let mut vision =
            colours.map_or_else(|| Vision::new(objects), |it| Vision::starting_from(objects, it));
        let seen = vision.see(&image, &camera).map_err(|error| failed(error.to_string()))?;
        let drawn = overlay_path(file, &arguments.output);
        let bytes = monas_vision::overlay(&image, seen);
        let overlay = RgbImage { width, height: rgb.height, bytes };
        overlay.write(&drawn).map_err(|error| {
            CommandFailure::Failed(format, format!("cannot write {}: {error}", drawn.display()))
        })?;
        report(file, &drawn, seen, format, console)?;
    }
    Ok(Exit::Success)
}

/// The colours of the table that the arguments name.
fn known_colours(arguments: &VisionArguments) -> Result<Option<ColourModel>, CommandFailure> {
    let Some(table) = &arguments.colours else { return Ok(None) };
    match colours::load(table) {
        (Some(known), _) => Ok(Some(colour_model(&known))),
        (None, diagnostics) => Err(CommandFailure::Invalid(arguments.format.value, diagnostics)),
    }
}

fn objects(set: ObjectSet) -> FieldObjects {
    match set {
        ObjectSet::Of2010 => FieldObjects::OF_2010,
        ObjectSet::OfToday => FieldObjects::OF_TODAY,
    }
}

fn camera(arguments: &VisionArguments, image: &Image<'_>) -> Result<Camera, monas_vision::Error> {
    let pose = HeadPose {
        height: arguments.height,
        torso_roll: arguments.roll.to_radians(),
        pitch: arguments.pitch.to_radians(),
        ..HeadPose::default()
    };
    Camera::new(image.width(), image.height(), arguments.view.to_radians(), &pose.robot_from_camera())
}

/// An angle of the camera, degrees.
fn angle(text: &str) -> Result<f64, String> {
    let degrees: f64 = text.parse().map_err(|_| "expected a number of degrees".to_owned())?;
    match (-180.0..=180.0).contains(&degrees) {
        true => Ok(degrees),
        false => Err("an angle is from -180 to 180 degrees".into()),
    }
}

/// The angle of view of the camera, degrees.
fn angle_of_view(text: &str) -> Result<f64, String> {
    let degrees = angle(text)?;
    match (6.0..=171.0).contains(&degrees) {
        true => Ok(degrees),
        false => Err("an angle of view is from 6 to 171 degrees".into()),
    }
}

/// Refuses images with one name, since the overlay of one would replace that of the other.
fn check_overlays(arguments: &VisionArguments) -> Result<(), CommandFailure> {
    let mut drawn: BTreeMap<PathBuf, &Path> = BTreeMap::new();
    for file in &arguments.files {
        let overlay = overlay_path(file, &arguments.output);
        if let Some(other) = drawn.insert(overlay.clone(), file).filter(|other| other != file) {
            return Err(CommandFailure::Usage(format!(
                "the overlays of {} and {} are one file, {}: rename an image, or use another --output for it",
                other.display(),
                file.display(),
                overlay.display()
            )));
        }
    }
    Ok(())
}

fn overlay_path(file: &Path, folder: &Path) -> PathBuf {
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    folder.join(format!("{name}.seen.png"))
}

/// A row of the table: object, kind and position.
struct SeenObject<'a> {
    object: &'static str,
    kind: &'static str,
    sight: &'a GroundObject,
}

fn objects_of(seen: &Detections) -> Vec<SeenObject<'_>> {
    let ball = seen.ball.iter().map(|sight| SeenObject { object: "ball", kind: "", sight });
    let posts = seen.posts.iter().map(|post| SeenObject {
        object: match post.side {
            PostSide::Left => "left post",
            PostSide::Right => "right post",
            PostSide::Unknown => "post",
        },
        kind: match post.paint {
            GoalPaint::Yellow => "yellow",
            GoalPaint::Blue => "blue",
            GoalPaint::White => "white",
        },
        sight: &post.sight,
    });
    let robots = seen.robots.iter().map(|robot| SeenObject {
        object: "robot",
        kind: match robot.jersey {
            Jersey::Blue => "blue",
            Jersey::Red => "red",
            Jersey::Unknown => "",
        },
        sight: &robot.sight,
    });
    ball.chain(posts).chain(robots).collect()
}

fn report(
    file: &Path,
    drawn: &Path,
    seen: &Detections,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<(), CommandFailure> {
    let objects = objects_of(seen);
    if format == Format::Json {
        let objects = objects.iter().map(|SeenObject { object: what, kind, sight }| {
            let area = &sight.area;
            json!({
                "what": what, "kind": kind, "distance": sight.distance, "bearing": sight.bearing,
                "box": [area.left, area.top, area.right, area.bottom],
            })
        });
        let lines = seen.lines.iter().map(|line| line.ends.map(|end| [end.position.x, end.position.y]));
        let found = json!({
            "file": file.display().to_string(),
            "overlay": drawn.display().to_string(),
            "objects": objects.collect::<Vec<_>>(),
            "lines": lines.collect::<Vec<_>>(),
            "line_points": seen.line_points.len(),
            "border": seen.border,
            "border_points": seen.border_points.iter().map(|it| [it.position.x, it.position.y]).collect::<Vec<_>>(),
        });
        return Ok(writeln!(console.out, "{found}")?);
    }
    let (points, lines) = (seen.line_points.len(), seen.lines.len());
    let border = if seen.border.is_empty() { "no field border" } else { "a field border" };
    writeln!(console.out, "{}: {border}, {lines} lines of {points} points", file.display())?;
    if !objects.is_empty() {
        let rows = objects.iter().map(|SeenObject { object: what, kind, sight }| {
            let area = &sight.area;
            [
                (*what).to_owned(),
                (*kind).to_owned(),
                format!("{:.2}", sight.distance),
                format!("{:.1}", sight.bearing.to_degrees()),
                format!("{:.0},{:.0} {:.0},{:.0}", area.left, area.top, area.right, area.bottom),
            ]
        });
        writeln!(console.out, "{}", of_numbers(["what", "kind", "metres", "degrees", "pixels"], 2, rows))?;
    }
    writeln!(console.remarks(), "written to {}", drawn.display())?;
    Ok(())
}
