//! Images of one camera, as its driver delivers them and as messages carry them.

use std::time::Duration;

/// Pixels of a row, and rows.
pub(crate) const WIDTH: usize = 640;
pub(crate) const HEIGHT: usize = 480;
/// Bytes of a row without padding: two neighbouring pixels are Y U Y V.
const ROW: usize = 2 * WIDTH;

/// An image of a camera.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Frame {
    /// When it was taken, on the monotonic clock of the system.
    pub(crate) taken_at: Duration,
    /// Y U Y V, row by row from the top, without padding.
    pub(crate) pixels: Vec<u8>,
}

/// The pixels of an image from a driver whose rows have `bytes_per_line`; turned by 180 degrees if
/// the camera is upside down. None if bytes are missing.
pub(crate) fn upright(bytes: &[u8], bytes_per_line: usize, is_turned: bool) -> Option<Vec<u8>> {
    let row = |row: usize| bytes.get(row * bytes_per_line..)?.get(..ROW);
    let mut pixels = Vec::with_capacity(ROW * HEIGHT);
    for index in 0..HEIGHT {
        if is_turned {
            let (pairs, _) = row(HEIGHT - 1 - index)?.as_chunks::<4>();
            // The two pixels change places; both have the same colour.
            pixels.extend(pairs.iter().rev().flat_map(|&[left, u, right, v]| [right, u, left, v]));
        } else {
            pixels.extend_from_slice(row(index)?);
        }
    }
    Some(pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An image with rows of `bytes_per_line`, whose bytes of pixels depend on their place.
    fn image(bytes_per_line: usize) -> Vec<u8> {
        let mut bytes = vec![255; HEIGHT * bytes_per_line];
        for (row, line) in bytes.chunks_mut(bytes_per_line).enumerate() {
            (0..ROW).for_each(|at| line[at] = ((7 * row + at) % 251) as u8);
        }
        bytes
    }

    /// Y, U and V of a pixel.
    fn pixel(pixels: &[u8], x: usize, y: usize) -> [u8; 3] {
        let pair = &pixels[y * ROW + x / 2 * 4..][..4];
        [pair[x % 2 * 2], pair[1], pair[3]]
    }

    #[test]
    fn padding_of_rows_is_left_out() {
        let pixels = upright(&image(ROW + 96), ROW + 96, false).unwrap();
        assert_eq!(pixels, image(ROW));
    }

    #[test]
    fn the_image_of_a_camera_upside_down_is_turned_pixel_by_pixel() {
        for bytes_per_line in [ROW, ROW + 96] {
            let (raw, turned) = (image(ROW), upright(&image(bytes_per_line), bytes_per_line, true).unwrap());
            assert_eq!(turned.len(), raw.len());
            for (x, y) in [(0, 0), (1, 0), (638, 0), (639, 479), (17, 300), (400, 2)] {
                assert_eq!(pixel(&turned, x, y), pixel(&raw, WIDTH - 1 - x, HEIGHT - 1 - y), "{x} {y}");
            }
        }
    }

    #[test]
    fn an_incomplete_image_is_none() {
        let bytes = image(ROW);
        assert_eq!(upright(&bytes[..bytes.len() - 1], ROW, false), None);
        assert_eq!(upright(&bytes[..bytes.len() - 1], ROW, true), None);
        assert_eq!(upright(&bytes, ROW + 2, false), None);
        assert_eq!(upright(&[], ROW, false), None);
    }
}
