//! Images in files: PNG and JPEG, read as RGB; PNG, written.

use std::io::Cursor;
use std::path::Path;

use png::{ColorType, Transformations};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::png_image::encode_png;

/// The largest side of an image, pixels: what vision accepts.
const MAX_SIDE: usize = 4096;

/// An image with three bytes for each pixel.
pub struct RgbImage {
    /// Pixels of a row.
    pub width: usize,
    /// The number of rows.
    pub height: usize,
    /// Red, green and blue of each pixel, row by row from the top.
    pub bytes: Vec<u8>,
}

impl RgbImage {
    /// Reads a file, whose content decides on its format.
    ///
    /// # Errors
    /// The file cannot be read, or holds no PNG or JPEG of a possible size; the reason.
    pub fn read(file: &Path) -> Result<RgbImage, String> {
        let content = std::fs::read(file).map_err(|error| error.to_string())?;
        match &content[..content.len().min(8)] {
            [0x89, b'P', b'N', b'G', ..] => RgbImage::from_png(&content),
            [0xff, 0xd8, ..] => RgbImage::from_jpeg(&content),
            _ => Err("neither a PNG nor a JPEG; convert it to one of these".to_owned()),
        }
    }

    fn from_png(content: &[u8]) -> Result<RgbImage, String> {
        let text = |error: png::DecodingError| format!("not a readable PNG: {error}");
        let mut decoder = png::Decoder::new(Cursor::new(content));
        decoder.set_transformations(Transformations::normalize_to_color8());
        let mut reader = decoder.read_info().map_err(text)?;
        let (width, height) = (reader.info().width as usize, reader.info().height as usize);
        check_size(width, height)?;
        let size = reader.output_buffer_size().ok_or("an image that is too large")?;
        let mut pixels = vec![0; size];
        let frame = reader.next_frame(&mut pixels).map_err(text)?;
        let pixels = &pixels[..frame.buffer_size()];
        let bytes = match frame.color_type {
            ColorType::Rgb => pixels.to_vec(),
            ColorType::Rgba => pixels.chunks_exact(4).flat_map(|it| [it[0], it[1], it[2]]).collect(),
            ColorType::Grayscale => pixels.iter().flat_map(|&it| [it; 3]).collect(),
            ColorType::GrayscaleAlpha => pixels.chunks_exact(2).flat_map(|it| [it[0]; 3]).collect(),
            other => return Err(format!("a PNG with unexpected colours: {other:?}")),
        };
        Ok(RgbImage { width, height, bytes })
    }

    fn from_jpeg(content: &[u8]) -> Result<RgbImage, String> {
        let options = DecoderOptions::default()
            .jpeg_set_out_colorspace(ColorSpace::RGB)
            .set_max_width(MAX_SIDE)
            .set_max_height(MAX_SIDE);
        let mut decoder = JpegDecoder::new_with_options(ZCursor::new(content), options);
        let bytes = decoder
            .decode()
            .map_err(|error| format!("not a readable JPEG: {}", format!("{error:?}").trim()))?;
        let (width, height) = decoder.dimensions().ok_or("a JPEG without a size")?;
        match bytes.len() == 3 * width * height {
            true => Ok(RgbImage { width, height, bytes }),
            false => Err("a JPEG with unexpected colours".to_owned()),
        }
    }

    /// Writes a PNG.
    ///
    /// # Errors
    /// The file cannot be written; the reason.
    pub fn write(&self, file: &Path) -> Result<(), String> {
        let content = encode_png(self.width, self.height, &self.bytes)?;
        monas_files::write(file, &content).map_err(|error| error.to_string())
    }
}

fn check_size(width: usize, height: usize) -> Result<(), String> {
    match width <= MAX_SIDE && height <= MAX_SIDE {
        true => Ok(()),
        false => {
            Err(format!("an image of {width} x {height} pixels; at most {MAX_SIDE} x {MAX_SIDE} are read"))
        }
    }
}
