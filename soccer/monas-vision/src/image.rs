//! Images in YUV 4:2:2, the format of the cameras of the Nao.

use crate::{Error, ErrorKind};

/// The largest width and height of an image, pixels.
const MAX_SIDE: usize = 4096;

/// The smallest width and height of an image, pixels.
const MIN_SIDE: usize = 16;

/// An image in YUV 4:2:2 over borrowed bytes: two neighbouring pixels are `Y0 U Y1 V`.
///
/// Luma and chroma have the full range of 8 bits, as in JFIF; 128 is zero chroma.
#[derive(Clone, Copy, Debug)]
pub struct Image<'a> {
    width: usize,
    height: usize,
    pixels: &'a [u8],
}

impl<'a> Image<'a> {
    /// An image of `width` by `height` pixels, row by row from the top.
    ///
    /// # Errors
    /// [`Size`](ErrorKind::Size) if the width is odd or a side is not within 16 to 4096 pixels,
    /// [`Length`](ErrorKind::Length) if there are not two bytes for each pixel.
    pub fn new(width: usize, height: usize, pixels: &'a [u8]) -> Result<Image<'a>, Error> {
        check_size(width, height)?;
        if pixels.len() != 2 * width * height {
            let message = format!(
                "an image of {width} x {height} pixels has {} bytes, not {}",
                2 * width * height,
                pixels.len()
            );
            return Err(Error::new(ErrorKind::Length, message));
        }
        Ok(Image { width, height, pixels })
    }

    /// The width, pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The height, pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Luma and chroma of a pixel: Y, U, V. Coordinates beyond the image are those of its edge.
    pub fn yuv(&self, x: usize, y: usize) -> [u8; 3] {
        let (x, y) = (x.min(self.width - 1), y.min(self.height - 1));
        let pair = 2 * (y * self.width + (x & !1));
        [self.pixels[pair + 2 * (x & 1)], self.pixels[pair + 1], self.pixels[pair + 3]]
    }

    /// The luma of a pixel. Coordinates beyond the image are those of its edge.
    pub fn luma(&self, x: usize, y: usize) -> u8 {
        let (x, y) = (x.min(self.width - 1), y.min(self.height - 1));
        self.pixels[2 * (y * self.width + x)]
    }

    /// The bytes of a row.
    pub(crate) fn row(&self, y: usize) -> &'a [u8] {
        &self.pixels[2 * y * self.width..2 * (y + 1) * self.width]
    }
}

/// Checks that an image can have this size.
pub(crate) fn check_size(width: usize, height: usize) -> Result<(), Error> {
    let is_side = |side: usize| (MIN_SIDE..=MAX_SIDE).contains(&side);
    if width.is_multiple_of(2) && is_side(width) && is_side(height) {
        return Ok(());
    }
    let message = format!(
        "an image of {width} x {height} pixels: the width must be even, and both from {MIN_SIDE} to {MAX_SIDE}"
    );
    Err(Error::new(ErrorKind::Size, message))
}

/// Converts a colour to Y, U, V as JFIF does, from ITU-R BT.601.
pub fn yuv_of_rgb(rgb: [u8; 3]) -> [u8; 3] {
    let [red, green, blue] = rgb.map(f32::from);
    let luma = 0.299 * red + 0.587 * green + 0.114 * blue;
    let u = 128.0 + 0.564_3 * (blue - luma);
    let v = 128.0 + 0.713_3 * (red - luma);
    [luma, u, v].map(|value| (value + 0.5) as u8)
}

/// Converts Y, U, V to a colour, the inverse of [`yuv_of_rgb`].
pub fn rgb_of_yuv(yuv: [u8; 3]) -> [u8; 3] {
    let [luma, u, v] = yuv.map(f32::from);
    let (u, v) = (u - 128.0, v - 128.0);
    [luma + 1.402 * v, luma - 0.344_1 * u - 0.714_1 * v, luma + 1.772 * u].map(|value| (value + 0.5) as u8)
}

/// Converts an image in RGB, three bytes for each pixel, to YUV 4:2:2. A last column that has no
/// neighbour is left out, so that the width is even. Returns the width.
pub fn yuv422_of_rgb(width: usize, rgb: &[u8], pixels: &mut Vec<u8>) -> usize {
    pixels.clear();
    for row in rgb.chunks_exact(3 * width.max(1)) {
        for pair in row.chunks_exact(6) {
            let first = yuv_of_rgb([pair[0], pair[1], pair[2]]);
            let second = yuv_of_rgb([pair[3], pair[4], pair[5]]);
            let mean = |at: usize| u8::midpoint(first[at], second[at]);
            pixels.extend_from_slice(&[first[0], mean(1), second[0], mean(2)]);
        }
    }
    width & !1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_survive_the_conversion() {
        for rgb in [[0, 0, 0], [255, 255, 255], [255, 110, 20], [40, 130, 50], [20, 80, 190]] {
            let back = rgb_of_yuv(yuv_of_rgb(rgb));
            let error = rgb.iter().zip(back).map(|(a, b)| a.abs_diff(b)).max().unwrap();
            assert!(error <= 3, "{rgb:?} {back:?}");
        }
        assert_eq!(yuv_of_rgb([255, 0, 0]), [76, 85, 255]);
    }

    #[test]
    fn two_pixels_share_their_chroma() {
        let rgb = [255, 0, 0, 0, 0, 255, 9, 9, 9];
        let mut pixels = Vec::new();
        assert_eq!(yuv422_of_rgb(3, &rgb, &mut pixels), 2);
        let (red, blue) = (yuv_of_rgb([255, 0, 0]), yuv_of_rgb([0, 0, 255]));
        assert_eq!((pixels[0], pixels[2]), (red[0], blue[0]));
        assert_eq!(pixels[1], u8::midpoint(red[1], blue[1]));
        assert_eq!(pixels.len(), 4);
    }

    #[test]
    fn sizes_and_lengths_are_checked() {
        let kind = |width, height, bytes: usize| {
            Image::new(width, height, &vec![0; bytes]).map(|_| ()).map_err(|error| error.kind())
        };
        assert_eq!(kind(32, 16, 1024), Ok(()));
        assert_eq!(kind(32, 16, 1023), Err(ErrorKind::Length));
        assert_eq!(kind(31, 16, 992), Err(ErrorKind::Size));
        assert_eq!(kind(0, 0, 0), Err(ErrorKind::Size));
        assert_eq!(kind(usize::MAX - 1, 16, 0), Err(ErrorKind::Size));
    }
}
