//! Colour models from images with samples of known colours.

use crate::colour::{for_each_sample, quantile, relative};
use crate::{Calibration, Camera, ColourClass, ColourModel, ColourTable, Error, ErrorKind, Image, ObjectHue};

/// The largest share of a sample that may be classified as another sampled colour.
const MOST_OVERLAP: f32 = 0.1;

/// The fewest pixels with colour in a sample.
const MIN_PIXELS: usize = 12;

/// A rectangle of pixels of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleBox {
    /// Its first column.
    pub left: usize,
    /// Its first row.
    pub top: usize,
    /// Its width, pixels.
    pub width: usize,
    /// Its height, pixels.
    pub height: usize,
}

/// Makes a [`ColourModel`] from images of one light, and from boxes in them whose colour is known.
///
/// The images alone give carpet and white, as [`Calibration`] finds them; a box of these colours
/// takes its place. Boxes of objects give their hues.
#[derive(Clone, Debug, Default)]
pub struct ColourSampler {
    /// The model estimated from each image alone.
    estimates: Vec<ColourModel>,
    /// Colours below the horizon of the images.
    ground: Vec<[u8; 3]>,
    samples: Vec<ColourSample>,
}

/// The pixels of all boxes of one colour.
#[derive(Clone, Debug)]
struct ColourSample {
    class: ColourClass,
    pixels: Vec<[u8; 3]>,
}

impl ColourSampler {
    /// The classes of which there can be samples.
    pub const CLASSES: [ColourClass; 6] = [
        ColourClass::Green,
        ColourClass::White,
        ColourClass::Orange,
        ColourClass::Yellow,
        ColourClass::Blue,
        ColourClass::Red,
    ];

    /// Adds an image. Returns whether it shows enough carpet to find its colour.
    pub fn add_image(&mut self, image: &Image<'_>, camera: &Camera) -> bool {
        let mut calibration = Calibration::default();
        for_each_sample(image, camera, |pixel| self.ground.push(pixel));
        let is_carpet = calibration.observe(image, camera);
        self.estimates.extend(is_carpet.then(|| *calibration.model()));
        is_carpet
    }

    /// Adds a box of an image that shows a colour.
    ///
    /// # Errors
    /// [`Sample`](ErrorKind::Sample) if the box is empty or not within the image, or there can be
    /// no samples of the class.
    pub fn add_sample(
        &mut self,
        class: ColourClass,
        image: &Image<'_>,
        area: SampleBox,
    ) -> Result<(), Error> {
        let SampleBox { left, top, width, height } = area;
        if !ColourSampler::CLASSES.contains(&class) {
            return Err(refused(format!("`{}` is not the colour of an object", class.name())));
        }
        if width == 0 || height == 0 {
            return Err(refused(format!("a box of {width} x {height} pixels is empty")));
        }
        let fits =
            |from: usize, size: usize, all: usize| from.checked_add(size).is_some_and(|end| end <= all);
        if !fits(left, width, image.width()) || !fits(top, height, image.height()) {
            let message = format!(
                "the box {left},{top},{width},{height} is not within the image of {} x {} pixels",
                image.width(),
                image.height()
            );
            return Err(refused(message));
        }
        let rows = top..top + height;
        let pixels = rows.flat_map(|y| (left..left + width).map(move |x| image.yuv(x, y)));
        match self.samples.iter_mut().find(|sample| sample.class == class) {
            Some(sample) => sample.pixels.extend(pixels),
            None => self.samples.push(ColourSample { class, pixels: pixels.collect() }),
        }
        Ok(())
    }

    /// The model of all images and samples.
    ///
    /// # Errors
    /// [`Colours`](ErrorKind::Colours) if neither image nor sample shows the carpet, or a sampled
    /// colour cannot be distinguished from another or from the carpet;
    /// [`Sample`](ErrorKind::Sample) if a sample has too few pixels with colour, or has many
    /// colours.
    pub fn model(&self) -> Result<ColourModel, Error> {
        let mut model = self.carpet_and_white()?;
        let mut kept: Vec<ColourSample> = Vec::new();
        for sample in &self.samples {
            let Some(hue) = ObjectHue::CLASSES.iter().position(|class| *class == sample.class) else {
                kept.push(sample.clone());
                continue;
            };
            let (measured, pixels) = sample.hue(&model)?;
            model.hues[hue] = Some(measured);
            kept.push(ColourSample { class: sample.class, pixels });
        }
        self.check_overlap(&model, &kept)?;
        Ok(model)
    }

    fn carpet_and_white(&self) -> Result<ColourModel, Error> {
        let sample = |class| self.samples.iter().find(|sample| sample.class == class);
        let (green, white) = (sample(ColourClass::Green), sample(ColourClass::White));
        let mut model = mean_of(&self.estimates).unwrap_or_default();
        if let Some(green) = green {
            (model.green_luma, model.green) = (green.luma(0.5)?, green.chroma());
            model.deviation =
                (model.green_luma - green.luma(0.16)?).clamp(1.0, 0.3 * model.green_luma.max(4.0));
        } else if self.estimates.is_empty() {
            let message = "no image shows enough carpet; add a sample of `green`";
            return Err(Error::new(ErrorKind::Colours, message));
        }
        if let Some(white) = white {
            (model.white_luma, model.white) = (white.luma(0.6)?, white.chroma());
        }
        Ok(model)
    }

    /// Refuses a model in which a sampled colour is taken for another, or the carpet for one.
    fn check_overlap(&self, model: &ColourModel, samples: &[ColourSample]) -> Result<(), Error> {
        let table = ColourTable::new(*model);
        for sample in samples {
            for other in samples.iter().filter(|other| other.class != sample.class) {
                let share = share_of(&sample.pixels, |pixel| table.class(pixel) == other.class);
                check_share(share, &format!("the sample of `{}`", sample.class.name()), other.class)?;
            }
        }
        // Without the measured hues, these are carpet.
        let bare = ColourTable::new(ColourModel { hues: [None; 4], ..*model });
        let carpet: Vec<[u8; 3]> =
            self.ground.iter().copied().filter(|pixel| bare.class(*pixel) == ColourClass::Green).collect();
        for sample in samples.iter().filter(|sample| sample.class != ColourClass::Green) {
            let share = share_of(&carpet, |pixel| table.class(pixel) == sample.class);
            check_share(share, "the carpet", sample.class)?;
        }
        Ok(())
    }
}

fn check_share(share: f32, of: &str, class: ColourClass) -> Result<(), Error> {
    if share <= MOST_OVERLAP {
        return Ok(());
    }
    let percent = (100.0 * share).round();
    let message = format!("ambiguous colours: {percent} % of {of} would be `{}`", class.name());
    Err(Error::new(ErrorKind::Colours, message))
}

fn share_of(pixels: &[[u8; 3]], is_meant: impl Fn([u8; 3]) -> bool) -> f32 {
    pixels.iter().filter(|pixel| is_meant(**pixel)).count() as f32 / pixels.len().max(1) as f32
}

fn refused(message: impl Into<String>) -> Error {
    Error::new(ErrorKind::Sample, message)
}

/// The mean of the models of the images.
fn mean_of(models: &[ColourModel]) -> Option<ColourModel> {
    let mut mean = *models.first()?;
    for (index, model) in models.iter().enumerate().skip(1) {
        mean = mean.towards(model, 1.0 / (index + 1) as f32);
    }
    Some(mean)
}

impl ColourSample {
    /// The luma below which a part of the pixels is.
    fn luma(&self, part: f32) -> Result<f32, Error> {
        if self.pixels.len() < MIN_PIXELS {
            let (count, name) = (self.pixels.len(), self.class.name());
            return Err(refused(format!(
                "the sample of `{name}` has {count} pixels; at least {MIN_PIXELS} are needed"
            )));
        }
        let mut counts = [0u32; 256];
        self.pixels.iter().for_each(|pixel| counts[usize::from(pixel[0])] += 1);
        Ok(quantile(&counts, part))
    }

    /// The mean relative chroma.
    fn chroma(&self) -> [f32; 2] {
        mean_chroma(&self.pixels)
    }

    /// The hue of the sample in a light, and the pixels that have it: a box around a ball also
    /// holds some carpet.
    fn hue(&self, model: &ColourModel) -> Result<(ObjectHue, Vec<[u8; 3]>), Error> {
        /// Least saturation of a colour, and least chroma on the scale of U and V.
        const MIN_SATURATION_AND_CHROMA: (f32, f32) = (0.08, 8.0);
        /// Greatest difference of angle of one colour, rad.
        const ONE_COLOUR: f32 = 0.35;
        /// The least part of a box that has its colour.
        const MIN_COLOUR_SHARE: f32 = 0.6;
        let name = self.class.name();
        let angle = |pixel: &[u8; 3]| {
            let [u, v] = relative(pixel[0], pixel[1], pixel[2]);
            let (u, v) = (u - model.white[0], v - model.white[1]);
            let saturation = libm::sqrtf(u * u + v * v);
            let has_colour = saturation > MIN_SATURATION_AND_CHROMA.0
                && saturation * f32::from(pixel[0]) > MIN_SATURATION_AND_CHROMA.1;
            has_colour.then(|| libm::atan2f(v, u))
        };
        let coloured: Vec<([u8; 3], f32)> =
            self.pixels.iter().filter_map(|pixel| Some((*pixel, angle(pixel)?))).collect();
        if coloured.len() < MIN_PIXELS {
            let count = coloured.len();
            return Err(refused(format!(
                "the sample of `{name}` has {count} pixels with colour; at least {MIN_PIXELS} are needed"
            )));
        }
        // The angle around which most others are.
        let near = |middle: f32, other: f32| turn(other - middle).abs() < ONE_COLOUR;
        let count_near = |middle: f32| coloured.iter().filter(|(_, other)| near(middle, *other)).count();
        let middle = (-18i16..18)
            .map(|step| std::f32::consts::TAU * f32::from(step) / 36.0)
            .max_by_key(|middle| count_near(*middle))
            .unwrap_or_default();
        let pixels: Vec<[u8; 3]> =
            coloured.iter().filter(|(_, other)| near(middle, *other)).map(|(pixel, _)| *pixel).collect();
        let part = pixels.len() as f32 / self.pixels.len() as f32;
        if part < MIN_COLOUR_SHARE {
            let percent = (100.0 * part).round();
            return Err(refused(format!(
                "the sample of `{name}` is of many colours: {percent} % of its pixels are alike; \
                 choose a box within the object"
            )));
        }
        let chroma = mean_chroma(&pixels);
        let centre = libm::atan2f(chroma[1] - model.white[1], chroma[0] - model.white[0]);
        let mut away: Vec<f32> =
            pixels.iter().filter_map(angle).map(|other| turn(other - centre).abs()).collect();
        away.sort_by(f32::total_cmp);
        let p95 = away.get(away.len() * 95 / 100).copied().unwrap_or_default();
        let width = (1.2 * p95).clamp(ObjectHue::WIDTHS[0], ObjectHue::WIDTHS[1]);
        Ok((ObjectHue::of(chroma, model.white, width), pixels))
    }
}

fn mean_chroma(pixels: &[[u8; 3]]) -> [f32; 2] {
    let sum = pixels.iter().fold([0.0f32; 2], |sum, pixel| {
        let [u, v] = relative(pixel[0], pixel[1], pixel[2]);
        [sum[0] + u, sum[1] + v]
    });
    sum.map(|part| part / pixels.len().max(1) as f32)
}

/// An angle between half a turn to either side.
fn turn(angle: f32) -> f32 {
    let full = std::f32::consts::TAU;
    angle - full * libm::roundf(angle / full)
}
