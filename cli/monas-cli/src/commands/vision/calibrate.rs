//! `monas vision --calibrate`: a colour table from images.

use std::path::Path;

use monas::config::colours;
use monas_scene::RgbImage;
use monas_soccer::field_colours::field_colours;
use monas_terminal::table::of_numbers;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format};
use monas_vision::{ColourClass, ColourModel, ColourSampler, Image, ObjectHue, SampleBox};
use serde_json::json;
use yase::diagnostic::nearest;

use super::{VisionArguments, camera};

/// A box of an image whose colour is known: `[FILE:]COLOUR=X,Y,WIDTH,HEIGHT`.
#[derive(Clone, Debug)]
pub(super) struct SampleArgument {
    text: String,
    /// The image; needed if there are several.
    file: Option<String>,
    class: ColourClass,
    area: SampleBox,
}

impl SampleArgument {
    /// Parses an argument of the command line.
    pub(super) fn parse(text: &str) -> Result<SampleArgument, String> {
        let form =
            || "expected [FILE:]COLOUR=X,Y,WIDTH,HEIGHT, in pixels from the upper left corner".to_owned();
        let (name, numbers) = text.rsplit_once('=').ok_or_else(form)?;
        let numbers: Option<Vec<usize>> =
            numbers.split(',').map(|number| number.trim().parse().ok()).collect();
        let Some(&[left, top, width, height]) = numbers.as_deref() else { return Err(form()) };
        let (file, colour) =
            name.rsplit_once(':').map_or((None, name), |(file, colour)| (Some(file), colour));
        let class = ColourSampler::CLASSES.into_iter().find(|class| class.name() == colour);
        let class = class.ok_or_else(|| unknown_colour(colour))?;
        let (text, file) = (text.to_owned(), file.map(str::to_owned));
        Ok(SampleArgument { text, file, class, area: SampleBox { left, top, width, height } })
    }

    /// The index of its image.
    fn image(&self, arguments: &VisionArguments) -> Result<usize, CommandFailure> {
        let usage = |message: String| CommandFailure::Usage(format!("--sample {}: {message}", self.text));
        match (&self.file, &arguments.files[..]) {
            (None, [_]) => Ok(0),
            (None, files) => {
                Err(usage(format!("name one of the {} images: FILE:COLOUR=X,Y,WIDTH,HEIGHT", files.len())))
            }
            (Some(name), files) => {
                let is_it = |file: &Path| {
                    file == Path::new(name) || file.file_name().is_some_and(|it| it == name.as_str())
                };
                let found = files.iter().position(|file| is_it(file));
                found.ok_or_else(|| usage(format!("`{name}` is not among the images")))
            }
        }
    }
}

fn unknown_colour(colour: &str) -> String {
    let names = ColourSampler::CLASSES.map(ColourClass::name);
    match nearest(colour, names) {
        Some(near) => format!("unknown colour `{colour}`; did you mean `{near}`?"),
        None => format!(
            "unknown colour `{colour}`; there are {}",
            names.map(|name| format!("`{name}`")).join(", ")
        ),
    }
}

/// Makes the table, writes it, and prints its colours.
pub(super) fn calibrate(
    arguments: &VisionArguments,
    table: &Path,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let mut sampler = ColourSampler::default();
    let indices = arguments
        .samples
        .iter()
        .map(|sample| Ok((sample.image(arguments)?, sample)))
        .collect::<Result<Vec<_>, CommandFailure>>()?;
    for (index, file) in arguments.files.iter().enumerate() {
        let failed =
            |message: String| CommandFailure::Failed(format, format!("{}: {message}", file.display()));
        let mut pixels = Vec::new();
        let rgb = RgbImage::read(file).map_err(failed)?;
        let width = monas_vision::yuv422_of_rgb(rgb.width, &rgb.bytes, &mut pixels);
        let image = Image::new(width, rgb.height, &pixels).map_err(|error| failed(error.to_string()))?;
        let camera = camera(arguments, &image).map_err(|error| failed(error.to_string()))?;
        if !sampler.add_image(&image, &camera) {
            writeln!(console.remarks(), "{}: not enough carpet to find its colour", file.display())?;
        }
        for (_, sample) in indices.iter().filter(|(position, _)| *position == index) {
            let added = sampler.add_sample(sample.class, &image, sample.area);
            added.map_err(|error| failed(format!("--sample {}: {error}", sample.text)))?;
        }
    }
    let model = sampler.model().map_err(|error| CommandFailure::failed(format, error))?;
    let names: Vec<String> = arguments.files.iter().map(|file| file.display().to_string()).collect();
    let comment = format!("Made by monas vision --calibrate from {}.", names.join(", "));
    let text = colours::file(&field_colours(&model), &comment);
    monas_files::write(table, text.as_bytes()).map_err(|error| {
        CommandFailure::Failed(format, format!("cannot write {}: {error}", table.display()))
    })?;
    report(&model, table, arguments, console)?;
    Ok(Exit::Success)
}

fn report(
    model: &ColourModel,
    table: &Path,
    arguments: &VisionArguments,
    console: &mut CommandOutput<'_>,
) -> Result<(), CommandFailure> {
    let hues = ObjectHue::CLASSES.into_iter().zip(model.hues);
    let hues = hues.filter_map(|(class, hue)| Some((class.name(), hue?)));
    if arguments.format.value == Format::Json {
        let made = json!({
            "table": table.display().to_string(),
            "images": arguments.files.len(),
            "colours": hues.map(|(name, _)| name).collect::<Vec<_>>(),
        });
        return Ok(writeln!(console.out, "{made}")?);
    }
    let number = |value: f32| format!("{value:.2}");
    let ground = [
        [
            "green".to_owned(),
            format!("{:.0}", model.green_luma),
            number(model.green[0]),
            number(model.green[1]),
            String::new(),
        ],
        [
            "white".to_owned(),
            format!("{:.0}", model.white_luma),
            number(model.white[0]),
            number(model.white[1]),
            String::new(),
        ],
    ];
    let objects = hues.map(|(name, hue)| {
        let degrees = format!("{:.0}", hue.width.to_degrees());
        [name.to_owned(), String::new(), number(hue.chroma[0]), number(hue.chroma[1]), degrees]
    });
    let rows = ground.into_iter().chain(objects);
    writeln!(console.out, "{}", of_numbers(["colour", "luma", "u", "v", "degrees"], 1, rows))?;
    writeln!(console.remarks(), "written to {}", table.display())?;
    Ok(())
}
