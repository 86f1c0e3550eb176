//! Images as PNG.

/// An image as PNG, from three bytes for each pixel: red, green, blue.
///
/// # Errors
/// The number of bytes is not that of the pixels, or the image has none; the reason.
pub fn encode_png(width: usize, height: usize, rgb: &[u8]) -> Result<Vec<u8>, String> {
    let size = |side: usize| u32::try_from(side).map_err(|_| format!("a side of {side} pixels"));
    let mut content = Vec::new();
    let mut encoder = png::Encoder::new(&mut content, size(width)?, size(height)?);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(rgb)?;
        writer.finish()
    });
    written.map_err(|error| error.to_string())?;
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_without_all_of_its_pixels_is_refused() {
        assert!(encode_png(2, 2, &[0; 12]).is_ok());
        for (width, height, bytes) in [(2, 2, 11), (2, 2, 13), (0, 2, 0), (usize::MAX, 1, 3)] {
            assert!(encode_png(width, height, &vec![0; bytes]).is_err(), "{width} {height} {bytes}");
        }
    }
}
