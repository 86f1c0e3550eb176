//! The camera sensor: blur, exposure, noise, and the conversion to YUV 4:2:2.

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use super::{Light, Rgb};

/// The sensor of a camera, with its buffers.
#[derive(Clone, Debug, Default)]
pub(super) struct Sensor {
    blurred: Vec<Rgb>,
    kernel: Vec<f32>,
}

impl Sensor {
    pub(super) fn expose(
        &mut self,
        colours: &mut Vec<Rgb>,
        width: usize,
        light: &Light,
        seed: u64,
        pixels: &mut Vec<u8>,
    ) {
        if light.blur > 0.05 {
            self.make_kernel(light.blur);
            self.blur_rows(colours, width);
            self.blur_columns(colours, width);
        }
        let mut noise = PixelNoise::new(seed, light.noise);
        let gain = (255.0 * light.exposure) as f32;
        pixels.clear();
        for pair in colours.chunks_exact(2) {
            let exposed = [0, 1].map(|k| [0, 1, 2].map(|i| (pair[k][i] * light.tint[i] * gain).min(255.0)));
            let [first, second] = exposed.map(yuv);
            let mean = |at: usize| (first[at] + second[at]) / 2.0;
            // The chroma of two pixels is their mean, so its noise is less.
            let values = [
                first[0] + noise.next(),
                mean(1) + 0.6 * noise.next(),
                second[0] + noise.next(),
                mean(2) + 0.6 * noise.next(),
            ];
            pixels.extend(values.map(|value| (value + 0.5) as u8));
        }
    }

    fn make_kernel(&mut self, deviation: f64) {
        let reach = (2.5 * deviation).ceil() as i32;
        self.kernel.clear();
        self.kernel.extend((-reach..=reach).map(|at| {
            let at = f64::from(at) / deviation;
            libm::exp(-0.5 * at * at) as f32
        }));
        let sum: f32 = self.kernel.iter().sum();
        self.kernel.iter_mut().for_each(|weight| *weight /= sum);
    }

    /// Blurs along rows. What is beyond an edge looks like the edge.
    fn blur_rows(&mut self, colours: &mut Vec<Rgb>, width: usize) {
        let reach = self.kernel.len() / 2;
        self.blurred.clear();
        self.blurred.resize(colours.len(), [0.0; 3]);
        for (row, sums) in colours.chunks_exact(width).zip(self.blurred.chunks_exact_mut(width)) {
            for (k, &weight) in self.kernel.iter().enumerate() {
                // The columns whose neighbour is beyond the left or the right edge.
                let (left, right) = (reach.saturating_sub(k).min(width), k.saturating_sub(reach).min(width));
                let (before, others) = sums.split_at_mut(left);
                before.iter_mut().for_each(|sum| add(sum, weight, &row[0]));
                let (inside, after) = others.split_at_mut((width - left).saturating_sub(right));
                let near = &row[right..];
                inside.iter_mut().zip(near).for_each(|(sum, colour)| add(sum, weight, colour));
                after.iter_mut().for_each(|sum| add(sum, weight, &row[width - 1]));
            }
        }
        std::mem::swap(colours, &mut self.blurred);
    }

    /// Blurs along columns.
    fn blur_columns(&mut self, colours: &mut Vec<Rgb>, width: usize) {
        let reach = self.kernel.len() / 2;
        let last = colours.len().saturating_sub(width);
        self.blurred.clear();
        self.blurred.resize(colours.len(), [0.0; 3]);
        for (at, sums) in self.blurred.chunks_exact_mut(width).enumerate() {
            for (k, &weight) in self.kernel.iter().enumerate() {
                let near = ((at + k).saturating_sub(reach) * width).min(last);
                let row = &colours[near..near + width];
                sums.iter_mut().zip(row).for_each(|(sum, colour)| add(sum, weight, colour));
            }
        }
        std::mem::swap(colours, &mut self.blurred);
    }
}

/// Adds a weighted colour to a sum.
fn add(sum: &mut Rgb, weight: f32, colour: &Rgb) {
    (0..3).for_each(|i| sum[i] += weight * colour[i]);
}

fn yuv([red, green, blue]: [f32; 3]) -> [f32; 3] {
    let luma = 0.299 * red + 0.587 * green + 0.114 * blue;
    [luma, 128.0 + 0.564_3 * (blue - luma), 128.0 + 0.713_3 * (red - luma)]
}

/// Noise that is nearly normal: the sum of four bytes of a generator.
struct PixelNoise {
    generator: Pcg64,
    bits: u64,
    scale: f32,
    has_half: bool,
}

impl PixelNoise {
    fn new(seed: u64, deviation: f64) -> PixelNoise {
        /// Standard deviation of the sum of four bytes.
        const BYTE_SUM_DEVIATION: f64 = 147.8;
        let mut bytes = [0u8; 32];
        bytes[..8].copy_from_slice(&seed.to_le_bytes());
        let scale = (deviation / BYTE_SUM_DEVIATION) as f32;
        PixelNoise { generator: Pcg64::from_seed(bytes), bits: 0, scale, has_half: false }
    }

    fn next(&mut self) -> f32 {
        if self.scale == 0.0 {
            return 0.0;
        }
        self.bits = if self.has_half { self.bits >> 32 } else { self.generator.next_u64() };
        self.has_half = !self.has_half;
        let sum: u32 = (0..4).map(|byte| (self.bits >> (8 * byte)) as u32 & 255).sum();
        (sum as f32 - 510.0) * self.scale
    }
}
