//! Measured hues of objects, and how light changes them.

use crate::ColourClass;

/// The hue of an object's colour, as measured in images.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectHue {
    /// Relative chroma of the object in white light: (U - 128) / Y and (V - 128) / Y.
    pub chroma: [f32; 2],
    /// Greatest difference of the angle of its chroma in the plane of U and V, rad.
    pub width: f32,
}

impl ObjectHue {
    /// The classes that have a hue, in the order of [`ColourModel::hues`](crate::ColourModel).
    pub const CLASSES: [ColourClass; 4] =
        [ColourClass::Orange, ColourClass::Yellow, ColourClass::Blue, ColourClass::Red];

    /// The least and the greatest width, rad.
    pub const WIDTHS: [f32; 2] = [0.1, 0.6];

    /// The hue in white light of what has a relative chroma in a light in which white has another
    /// one: the light multiplies red, green and blue each by a factor (von Kries, 1902).
    pub(crate) fn of(chroma: [f32; 2], white: [f32; 2], width: f32) -> ObjectHue {
        let (object, light) = (rgb(chroma), rgb(white));
        ObjectHue { chroma: chroma_of([0, 1, 2].map(|i| object[i] / light[i])), width }
    }

    /// The hue in the light in which white has a relative chroma; none if it has no colour there.
    pub(crate) fn adapted(&self, class: ColourClass, white: [f32; 2]) -> Option<AdaptedHue> {
        /// Least saturation of a colour.
        const MIN_SATURATION: f32 = 0.08;
        let (object, light) = (rgb(self.chroma), rgb(white));
        let chroma = chroma_of([0, 1, 2].map(|i| object[i] * light[i]));
        let (u, v) = (chroma[0] - white[0], chroma[1] - white[1]);
        let saturation = libm::sqrtf(u * u + v * v);
        (saturation > MIN_SATURATION).then(|| AdaptedHue {
            class,
            direction: [u / saturation, v / saturation],
            saturation,
            tangent: libm::tanf(self.width.clamp(ObjectHue::WIDTHS[0], ObjectHue::WIDTHS[1])),
        })
    }
}

/// A hue in one light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AdaptedHue {
    class: ColourClass,
    /// The direction of its chroma, less that of white; its length is 1.
    direction: [f32; 2],
    saturation: f32,
    /// The tangent of its width.
    tangent: f32,
}

impl AdaptedHue {
    /// The class of the hue that is nearest to a relative chroma, less that of white, of a colour
    /// with this luma.
    pub(crate) fn nearest(
        hues: &[Option<AdaptedHue>; 4],
        chroma: [f32; 2],
        luma: f32,
    ) -> Option<ColourClass> {
        /// Least chroma on the scale of U and V: less is noise.
        const LEAST_CHROMA: f32 = 9.0;
        let difference = |hue: &AdaptedHue| {
            let along = chroma[0] * hue.direction[0] + chroma[1] * hue.direction[1];
            let across = (chroma[1] * hue.direction[0] - chroma[0] * hue.direction[1]).abs();
            let is_saturated = along > 0.5 * hue.saturation && along * luma > LEAST_CHROMA;
            let part = across / (hue.tangent * along).max(1e-6);
            (is_saturated && part <= 1.0).then_some((part, hue.class))
        };
        let near = hues.iter().flatten().filter_map(difference);
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, class)| class)
    }
}

/// Red, green and blue of a relative chroma, as parts of the luma, at least a small one.
fn rgb([u, v]: [f32; 2]) -> [f32; 3] {
    [1.0 + 1.402 * v, 1.0 - 0.344_1 * u - 0.714_1 * v, 1.0 + 1.772 * u].map(|part| part.max(0.02))
}

fn chroma_of([red, green, blue]: [f32; 3]) -> [f32; 2] {
    let luma = (0.299 * red + 0.587 * green + 0.114 * blue).max(1e-3);
    [0.564_3 * (blue - luma) / luma, 0.713_3 * (red - luma) / luma]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The relative chroma of a colour in a light, and that of white in it.
    fn lit(colour: [f32; 3], light: [f32; 3]) -> ([f32; 2], [f32; 2]) {
        (chroma_of([0, 1, 2].map(|i| colour[i] * light[i])), chroma_of(light))
    }

    #[test]
    fn a_hue_of_one_light_is_found_in_another() {
        let (warm, cold) = ([1.2, 1.0, 0.4], [0.8, 1.0, 1.2]);
        let colours = [[0.98, 0.42, 0.10], [0.93, 0.80, 0.10], [0.10, 0.32, 0.78], [0.78, 0.12, 0.14]];
        let hues = colours.map(|colour| {
            let (chroma, white) = lit(colour, warm);
            ObjectHue::of(chroma, white, 0.12)
        });
        for light in [warm, [1.0; 3], cold] {
            let (_, white) = lit([1.0; 3], light);
            let adapted = [0, 1, 2, 3].map(|i| hues[i].adapted(ObjectHue::CLASSES[i], white));
            for (colour, class) in colours.into_iter().zip(ObjectHue::CLASSES) {
                let (chroma, white) = lit(colour, light);
                let own = [chroma[0] - white[0], chroma[1] - white[1]];
                assert_eq!(AdaptedHue::nearest(&adapted, own, 100.0), Some(class), "{colour:?} in {light:?}");
            }
            let (carpet, white) = lit([0.15, 0.46, 0.19], light);
            let own = [carpet[0] - white[0], carpet[1] - white[1]];
            assert_eq!(AdaptedHue::nearest(&adapted, own, 100.0), None, "carpet in {light:?}");
        }
    }

    #[test]
    fn what_is_dark_or_pale_has_no_hue() {
        let hue = ObjectHue { chroma: [-0.46, 0.56], width: 0.12 };
        let hues = [hue.adapted(ColourClass::Orange, [0.0; 2]), None, None, None];
        assert_eq!(AdaptedHue::nearest(&hues, [-0.46, 0.56], 100.0), Some(ColourClass::Orange));
        assert_eq!(AdaptedHue::nearest(&hues, [-0.46, 0.56], 10.0), None);
        assert_eq!(AdaptedHue::nearest(&hues, [-0.1, 0.12], 100.0), None);
        assert_eq!(AdaptedHue::nearest(&hues, [0.46, -0.56], 100.0), None);
        assert!(ObjectHue { chroma: [0.0, 0.01], width: 0.1 }.adapted(ColourClass::Red, [0.0; 2]).is_none());
    }
}
