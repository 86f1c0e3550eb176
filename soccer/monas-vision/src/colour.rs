//! Colour classes, the table that assigns them, and its calibration from images.
//!
//! A class is decided by *relative chroma*: chroma divided by luma, less that of white. It is the
//! same in light and in shadow, so a table holds for a whole image. [`Calibration`] estimates from
//! an image what the table depends on: the carpet is the most frequent greenish chroma below the
//! horizon, and white is what is clearly brighter than the carpet and has little chroma.

use crate::hue::{AdaptedHue, ObjectHue};
use crate::{Camera, Image};

/// The class of a colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum ColourClass {
    /// None of the others.
    #[default]
    Other = 0,
    /// The carpet.
    Green = 1,
    /// Lines, white balls, white goals, robots.
    White = 2,
    /// Dark without colour: patches of a ball, shadows beyond the carpet.
    Dark = 3,
    /// The ball of 2010.
    Orange = 4,
    /// A goal of 2010.
    Yellow = 5,
    /// The other goal of 2010, and jerseys.
    Blue = 6,
    /// Jerseys.
    Red = 7,
}

impl ColourClass {
    /// All classes, each at the index of its value.
    pub const ALL: [ColourClass; 8] = [
        ColourClass::Other,
        ColourClass::Green,
        ColourClass::White,
        ColourClass::Dark,
        ColourClass::Orange,
        ColourClass::Yellow,
        ColourClass::Blue,
        ColourClass::Red,
    ];

    /// Its name, lower case.
    pub fn name(self) -> &'static str {
        ["other", "green", "white", "dark", "orange", "yellow", "blue", "red"][self as usize]
    }
}

/// The model from which a colour table is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourModel {
    /// Luma of the carpet, from 0 to 255.
    pub green_luma: f32,
    /// Relative chroma of the carpet: (U - 128) / Y and (V - 128) / Y.
    pub green: [f32; 2],
    /// Luma of what is white, such as lines.
    pub white_luma: f32,
    /// Relative chroma of what is white.
    pub white: [f32; 2],
    /// Standard deviation of the luma of the carpet: noise, and light that is not even.
    pub deviation: f32,
    /// Hues of objects that were measured, for each of [`ObjectHue::CLASSES`]. The usual hues also
    /// hold.
    pub hues: [Option<ObjectHue>; 4],
}

impl Default for ColourModel {
    /// A green carpet in even, white light.
    fn default() -> ColourModel {
        ColourModel {
            green_luma: 95.0,
            green: [-0.25, -0.35],
            white_luma: 220.0,
            white: [0.0, 0.0],
            deviation: 5.0,
            hues: [None; 4],
        }
    }
}

/// Luma below which relative chroma is not reliable.
const MIN_LUMA: f32 = 6.0;

/// Least chroma of an object with a colour, on the scale of U and V.
const LEAST_CHROMA: f32 = 12.0;

impl ColourModel {
    /// The class of a colour.
    pub fn class(&self, luma: f32, u: f32, v: f32) -> ColourClass {
        self.class_with(&self.adapted_hues(), [luma, u, v])
    }

    /// The measured hues in the light of the model.
    fn adapted_hues(&self) -> [Option<AdaptedHue>; 4] {
        let mut classes = ObjectHue::CLASSES.into_iter();
        self.hues.map(|hue| classes.next().zip(hue).and_then(|(class, hue)| hue.adapted(class, self.white)))
    }

    fn class_with(&self, hues: &[Option<AdaptedHue>; 4], [luma, u, v]: [f32; 3]) -> ColourClass {
        let scale = luma.max(MIN_LUMA);
        let chroma = [(u - 128.0) / scale - self.white[0], (v - 128.0) / scale - self.white[1]];
        if let Some(class) = AdaptedHue::nearest(hues, chroma, scale) {
            return class;
        }
        let green = [self.green[0] - self.white[0], self.green[1] - self.white[1]];
        let size = (green[0] * green[0] + green[1] * green[1]).max(1e-4);
        // Along and across the direction of the carpet's chroma, which is at (1, 0).
        let along = (chroma[0] * green[0] + chroma[1] * green[1]) / size;
        let across = (chroma[1] * green[0] - chroma[0] * green[1]).abs() / size;
        let saturation = libm::sqrtf(chroma[0] * chroma[0] + chroma[1] * chroma[1]);
        let is_carpet = along > 0.42 && across < 0.40 + 0.25 * along;
        let is_lit = luma > 0.18 * self.green_luma && luma < 1.9 * self.green_luma;
        if is_carpet && is_lit && along < 3.0 {
            return ColourClass::Green;
        }
        if saturation * luma > LEAST_CHROMA
            && saturation > 0.22
            && let Some(class) = class_of_hue(chroma, saturation)
        {
            return class;
        }
        let white_from = self.green_luma + 0.33 * (self.white_luma - self.green_luma);
        let is_pale = saturation < 0.20 || (along < 0.42 && saturation < 0.30);
        match luma {
            _ if luma >= white_from && is_pale => ColourClass::White,
            _ if luma < 0.34 * self.white_luma && saturation * luma < 1.6 * LEAST_CHROMA => ColourClass::Dark,
            _ => ColourClass::Other,
        }
    }

    /// Whether the table of `other` would differ only slightly.
    fn is_near(&self, other: &ColourModel) -> bool {
        let close = |a: f32, b: f32, tolerance: f32| (a - b).abs() <= tolerance;
        close(self.green_luma, other.green_luma, 0.04 * self.green_luma)
            && close(self.white_luma, other.white_luma, 0.04 * self.white_luma)
            && (0..2).all(|i| close(self.green[i], other.green[i], 0.02))
            && (0..2).all(|i| close(self.white[i], other.white[i], 0.015))
    }

    /// Interpolates between this model and another.
    pub(crate) fn towards(&self, other: &ColourModel, part: f32) -> ColourModel {
        let mix = |a: f32, b: f32| a + part * (b - a);
        ColourModel {
            green_luma: mix(self.green_luma, other.green_luma),
            green: [mix(self.green[0], other.green[0]), mix(self.green[1], other.green[1])],
            white_luma: mix(self.white_luma, other.white_luma),
            white: [mix(self.white[0], other.white[0]), mix(self.white[1], other.white[1])],
            deviation: mix(self.deviation, other.deviation),
            hues: self.hues,
        }
    }
}

/// The class of the hue of a relative chroma, if an object has it.
fn class_of_hue(chroma: [f32; 2], saturation: f32) -> Option<ColourClass> {
    // Tangents of the borders between hues in the plane of U and V: red and orange at 117 degrees,
    // orange and yellow at 149, yellow and green at 188.
    let [u, v] = chroma;
    if u > 0.0 && v < 0.25 * u && u > 0.20 && v > -2.2 * u {
        return Some(ColourClass::Blue);
    }
    if v > 0.28 && u < 0.35 * v && u > -0.51 * v {
        return Some(ColourClass::Red);
    }
    if v > 0.0 && u <= -0.51 * v && v > -0.60 * u && saturation > 0.3 {
        return Some(ColourClass::Orange);
    }
    (u < -0.25 && v <= -0.60 * u && v > 0.14 * u).then_some(ColourClass::Yellow)
}

/// Cells along Y, U and V of a table.
const LUMA_BITS: usize = 5;
const CHROMA_BITS: usize = 6;

/// A table from Y, U and V to [`ColourClass`], in cells of 8 x 4 x 4 values.
#[derive(Clone, Debug)]
pub struct ColourTable {
    model: ColourModel,
    classes: Vec<ColourClass>,
}

impl ColourTable {
    /// The table of a model.
    pub fn new(model: ColourModel) -> ColourTable {
        let mut table =
            ColourTable { model, classes: vec![ColourClass::Other; 1 << (LUMA_BITS + 2 * CHROMA_BITS)] };
        table.fill(model);
        table
    }

    /// The model of which the table was made.
    pub fn model(&self) -> &ColourModel {
        &self.model
    }

    /// The class of a colour.
    #[inline]
    pub fn class(&self, yuv: [u8; 3]) -> ColourClass {
        self.classes[index(yuv[0], yuv[1], yuv[2])]
    }

    /// Makes it the table of a model; the classes remain if they would be about the same.
    pub(crate) fn update(&mut self, model: &ColourModel) {
        if !self.model.is_near(model) {
            self.fill(*model);
        }
        self.model.deviation = model.deviation;
    }

    fn fill(&mut self, model: ColourModel) {
        self.model = model;
        let hues = model.adapted_hues();
        for (cell, class) in self.classes.iter_mut().enumerate() {
            let luma = (cell >> (2 * CHROMA_BITS)) as f32 * 8.0 + 4.0;
            let u = ((cell >> CHROMA_BITS) & 63) as f32 * 4.0 + 2.0;
            let v = (cell & 63) as f32 * 4.0 + 2.0;
            *class = model.class_with(&hues, [luma, u, v]);
        }
    }
}

#[inline]
fn index(luma: u8, u: u8, v: u8) -> usize {
    (usize::from(luma >> 3) << (2 * CHROMA_BITS)) | (usize::from(u >> 2) << CHROMA_BITS) | usize::from(v >> 2)
}

/// Bins along each axis of the histogram of chroma, of 4 values each.
const BINS: usize = 64;

/// Estimates the model of a colour table from images.
#[derive(Clone, Debug)]
pub struct Calibration {
    model: ColourModel,
    /// Whether the model is that of the present light: estimated from images, or given.
    is_measured: bool,
    /// The number of images that contributed.
    images: u32,
    /// Samples in each bin of U and V, as far as they may be carpet.
    chroma: Vec<u16>,
    /// Samples of each luma: those that are carpet, and those that may be white.
    green_luma: [u32; 256],
    pale_luma: [u32; 256],
}

impl Default for Calibration {
    fn default() -> Calibration {
        Calibration {
            model: ColourModel::default(),
            is_measured: false,
            images: 0,
            chroma: vec![0; BINS * BINS],
            green_luma: [0; 256],
            pale_luma: [0; 256],
        }
    }
}

impl Calibration {
    /// A calibration that goes on from a model. The first image changes it as later ones do.
    pub fn starting_from(model: ColourModel) -> Calibration {
        Calibration { model, is_measured: true, ..Calibration::default() }
    }

    /// The model of the images so far.
    pub fn model(&self) -> &ColourModel {
        &self.model
    }

    /// The number of images that have contributed.
    pub fn images(&self) -> u32 {
        self.images
    }

    /// Takes an image into account. Returns whether it shows enough carpet to contribute; if not,
    /// the model remains.
    ///
    /// The first image decides alone; later ones change the model half of the way.
    pub fn observe(&mut self, image: &Image<'_>, camera: &Camera) -> bool {
        let Some(model) = self.estimate(image, camera) else { return false };
        self.model = if self.is_measured { self.model.towards(&model, 0.5) } else { model };
        self.is_measured = true;
        self.images = self.images.saturating_add(1);
        true
    }

    fn estimate(&mut self, image: &Image<'_>, camera: &Camera) -> Option<ColourModel> {
        let (green, samples) = self.carpet(image, camera)?;
        let green_luma = quantile(&self.green_luma, 0.5);
        // One standard deviation below the middle: above it, there may be lines.
        let deviation = (green_luma - quantile(&self.green_luma, 0.16)).clamp(1.0, 0.3 * green_luma.max(4.0));
        let min = (1.35 * green_luma).max(green_luma + 4.0 * deviation).max(40.0);
        self.pale_luma.fill(0);
        // White is brighter than the carpet and differs from it in chroma.
        let (mut sum, mut count) = ([0.0f32; 2], 0.0f32);
        let size = green[0] * green[0] + green[1] * green[1];
        for_each_sample(image, camera, |[luma, u, v]| {
            let bright = f32::from(luma);
            let chroma = relative(luma, u, v);
            let along = (chroma[0] * green[0] + chroma[1] * green[1]) / size;
            let across = (chroma[1] * green[0] - chroma[0] * green[1]).abs() / size;
            if bright > min && along < 0.55 && across < 0.5 && along > -0.6 {
                self.pale_luma[usize::from(luma)] += 1;
                (sum[0], sum[1], count) = (sum[0] + chroma[0], sum[1] + chroma[1], count + 1.0);
            }
        });
        let (white_luma, white) = match count {
            _ if count >= 0.002 * samples && count >= 6.0 => {
                let seen = quantile(&self.pale_luma, 0.6);
                (seen.max(1.45 * green_luma).min(255.0), [sum[0] / count, sum[1] / count])
            }
            // No white in the image: white keeps its ratio to the carpet.
            _ => {
                let ratio = self.model.white_luma / self.model.green_luma;
                ((ratio * green_luma).min(255.0), self.model.white)
            }
        };
        let hues = self.model.hues;
        Some(ColourModel { green_luma, green, white_luma, white, deviation, hues })
    }

    /// The relative chroma of the carpet, and the number of samples; fills `green_luma`.
    fn carpet(&mut self, image: &Image<'_>, camera: &Camera) -> Option<([f32; 2], f32)> {
        /// Least part of the samples that are carpet.
        const MIN_CARPET_SHARE: f32 = 0.08;
        self.chroma.fill(0);
        self.green_luma.fill(0);
        let mut samples = 0.0f32;
        for_each_sample(image, camera, |[luma, u, v]| {
            samples += 1.0;
            if is_greenish(luma, u, v) {
                let bin = usize::from(u >> 2) * BINS + usize::from(v >> 2);
                self.chroma[bin] = self.chroma[bin].saturating_add(1);
            }
        });
        let [u, v] = self.peak()?;
        // The mean of the samples near the peak, computed twice.
        let mut centre = [u, v];
        let mut relative_mean = [0.0f32; 2];
        for _ in 0..2 {
            let (mut sum, mut ratio, mut count) = ([0.0f32; 2], [0.0f32; 2], 0.0f32);
            self.green_luma.fill(0);
            for_each_sample(image, camera, |[luma, u, v]| {
                let away = [f32::from(u) - centre[0], f32::from(v) - centre[1]];
                if is_greenish(luma, u, v) && away[0] * away[0] + away[1] * away[1] < 16.0 * 16.0 {
                    let chroma = relative(luma, u, v);
                    (sum[0], sum[1]) = (sum[0] + f32::from(u), sum[1] + f32::from(v));
                    (ratio[0], ratio[1], count) = (ratio[0] + chroma[0], ratio[1] + chroma[1], count + 1.0);
                    self.green_luma[usize::from(luma)] += 1;
                }
            });
            if count < MIN_CARPET_SHARE * samples || count < 20.0 {
                return None;
            }
            centre = [sum[0] / count, sum[1] / count];
            relative_mean = [ratio[0] / count, ratio[1] / count];
        }
        Some((relative_mean, samples))
    }

    /// Where the histogram of chroma, smoothed over 3 x 3 bins, is highest.
    fn peak(&self) -> Option<[f32; 2]> {
        let (mut best, mut at) = (0u32, None);
        for u in 1..BINS - 1 {
            for v in 1..BINS - 1 {
                let rows = (u - 1..=u + 1).map(|row| &self.chroma[row * BINS + v - 1..=row * BINS + v + 1]);
                let sum: u32 = rows.flatten().map(|&count| u32::from(count)).sum();
                if sum > best {
                    (best, at) = (sum, Some([u as f32 * 4.0 + 2.0, v as f32 * 4.0 + 2.0]));
                }
            }
        }
        at
    }
}

/// Whether a colour may be that of a carpet in any usual light.
fn is_greenish(luma: u8, u: u8, v: u8) -> bool {
    let [u, v] = relative(luma, u, v);
    luma >= 12 && v < -0.06 && u < 0.12 && u + v < -0.14 && u > 3.0 * v - 0.1
}

pub(crate) fn relative(luma: u8, u: u8, v: u8) -> [f32; 2] {
    let scale = f32::from(luma).max(MIN_LUMA);
    [(f32::from(u) - 128.0) / scale, (f32::from(v) - 128.0) / scale]
}

/// Calls a function with about five thousand pixels below the horizon.
pub(crate) fn for_each_sample(image: &Image<'_>, camera: &Camera, mut visit: impl FnMut([u8; 3])) {
    let step = (image.width() / 80).max(2);
    for x in (step / 2..image.width()).step_by(step) {
        let from = camera.horizon(x as f64).clamp(0.0, image.height() as f64) as usize;
        for y in (from + step / 2..image.height()).step_by(step) {
            visit(image.yuv(x, y));
        }
    }
}

/// The value below which a part of the samples lies.
pub(crate) fn quantile(counts: &[u32; 256], part: f32) -> f32 {
    let total: u32 = counts.iter().sum();
    let wanted = (part * total as f32) as u32;
    let mut below = 0;
    let found = counts.iter().position(|count| {
        below += count;
        below > wanted
    });
    found.unwrap_or(255) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::yuv_of_rgb;

    fn class(model: &ColourModel, rgb: [u8; 3]) -> ColourClass {
        ColourTable::new(*model).class(yuv_of_rgb(rgb))
    }

    #[test]
    fn objects_of_the_field_have_their_classes() {
        let model = ColourModel::default();
        let expected = [
            ([40, 130, 50], ColourClass::Green),
            ([20, 65, 25], ColourClass::Green),
            ([230, 230, 230], ColourClass::White),
            ([20, 20, 22], ColourClass::Dark),
            ([240, 110, 30], ColourClass::Orange),
            ([120, 55, 15], ColourClass::Orange),
            ([240, 210, 30], ColourClass::Yellow),
            ([30, 90, 200], ColourClass::Blue),
            ([190, 30, 40], ColourClass::Red),
            ([120, 120, 120], ColourClass::Other),
        ];
        for (rgb, wanted) in expected {
            assert_eq!(class(&model, rgb), wanted, "{rgb:?}");
        }
    }

    #[test]
    fn a_calibration_finds_carpet_and_white_in_coloured_light() {
        // Two thirds carpet, one line of white, in light that lacks blue and is weak.
        let light = [0.62f32, 0.55, 0.36];
        let lit = |rgb: [u8; 3]| yuv_of_rgb([0, 1, 2].map(|i| (f32::from(rgb[i]) * light[i]) as u8));
        let (green, white) = (lit([45, 140, 60]), lit([235, 235, 235]));
        let mut pixels = Vec::new();
        for row in 0..240 {
            let colour = if (100..110).contains(&row) { white } else { green };
            (0..160).for_each(|_| pixels.extend_from_slice(&[colour[0], colour[1], colour[0], colour[2]]));
        }
        let image = Image::new(320, 240, &pixels).unwrap();
        let pose = crate::HeadPose { height: 0.5, pitch: 0.5, ..Default::default() };
        let camera = Camera::new(320, 240, 0.8343, &pose.robot_from_camera()).unwrap();
        let mut calibration = Calibration::default();
        assert!(calibration.observe(&image, &camera));
        let table = ColourTable::new(*calibration.model());
        assert_eq!(table.class(green), ColourClass::Green);
        assert_eq!(table.class(white), ColourClass::White);
        assert_eq!(table.class(lit([240, 110, 30])), ColourClass::Orange);
        assert_ne!(ColourTable::new(ColourModel::default()).class(white), ColourClass::White);
    }

    #[test]
    fn an_image_without_carpet_leaves_the_model() {
        let pixels = vec![128; 2 * 64 * 48];
        let image = Image::new(64, 48, &pixels).unwrap();
        let pose = crate::HeadPose { height: 0.5, pitch: 0.5, ..Default::default() };
        let camera = Camera::new(64, 48, 0.8343, &pose.robot_from_camera()).unwrap();
        let mut calibration = Calibration::default();
        assert!(!calibration.observe(&image, &camera));
        assert_eq!((calibration.model(), calibration.images()), (&ColourModel::default(), 0));
    }
}
