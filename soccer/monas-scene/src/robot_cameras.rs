//! The images of robots as PNG.

use monas_robot::topics::IMAGES;
use monas_robot::{Image, Images};
use monas_studio::Cameras;
use prost::Message;

use crate::png_image::encode_png;

/// The two cameras of a head.
pub(super) struct RobotCameras;

impl Cameras for RobotCameras {
    fn topic(&self) -> &'static str {
        IMAGES.path()
    }

    fn names(&self) -> &[&'static str] {
        &["top", "bottom"]
    }

    fn images(&self, bytes: &[u8]) -> Option<Vec<Vec<u8>>> {
        Images::decode(bytes).ok()?.images.iter().map(png).collect()
    }
}

/// The image as PNG; none if its pixels are not what it says.
fn png(image: &Image) -> Option<Vec<u8>> {
    let (width, height) = (image.width as usize, image.height as usize);
    let pixels = monas_vision::Image::new(width, height, &image.pixels).ok()?;
    let positions = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let bytes: Vec<u8> = positions.flat_map(|(x, y)| monas_vision::rgb_of_yuv(pixels.yuv(x, y))).collect();
    encode_png(width, height, &bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_of_the_message_becomes_a_png_with_its_colours() {
        let orange = [255, 128, 0];
        let mut pixels = Vec::new();
        monas_vision::yuv422_of_rgb(16, &orange.repeat(16 * 16), &mut pixels);
        let image = Image { width: 16, height: 16, pixels, ..Image::default() };
        let images = Images { images: vec![image.clone()], ..Images::default() };
        let png = RobotCameras.images(&images.encode_to_vec()).unwrap().remove(0);
        let mut decoder = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
        let mut read = vec![0; decoder.output_buffer_size().unwrap()];
        decoder.next_frame(&mut read).unwrap();
        assert!(read.chunks(3).all(|it| it.iter().zip(orange).all(|(a, b)| a.abs_diff(b) < 6)), "{read:?}");

        let short = Image { pixels: vec![0; 3], ..image };
        let images = Images { images: vec![short], ..Images::default() };
        assert_eq!(RobotCameras.images(&images.encode_to_vec()), None);
        assert_eq!(RobotCameras.images(b"no message"), None);
    }
}
