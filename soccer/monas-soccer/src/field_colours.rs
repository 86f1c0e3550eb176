//! Conversions between the colours of messages and the model of vision.

use monas_robot::{Colour, FieldColours, ObjectColour};
use monas_vision::{ColourClass, ColourModel, ObjectHue};

/// The message of a colour model.
pub fn field_colours(model: &ColourModel) -> FieldColours {
    let hues = ObjectHue::CLASSES.into_iter().zip(model.hues);
    let objects = hues.filter_map(|(class, hue)| {
        let ObjectHue { chroma, width } = hue?;
        let colour = colour_of(class)?.into();
        Some(ObjectColour { colour, u: chroma[0].into(), v: chroma[1].into(), width: width.into() })
    });
    FieldColours {
        green_luma: model.green_luma.into(),
        green_u: model.green[0].into(),
        green_v: model.green[1].into(),
        green_deviation: model.deviation.into(),
        white_luma: model.white_luma.into(),
        white_u: model.white[0].into(),
        white_v: model.white[1].into(),
        objects: objects.collect(),
    }
}

/// The colour model of a message; colours without a hue are left out.
pub fn colour_model(colours: &FieldColours) -> ColourModel {
    let hues = ObjectHue::CLASSES.map(|class| {
        let object = colours.objects.iter().find(|object| colour_of(class) == Some(object.colour()))?;
        Some(ObjectHue { chroma: [object.u as f32, object.v as f32], width: object.width as f32 })
    });
    ColourModel {
        green_luma: colours.green_luma as f32,
        green: [colours.green_u as f32, colours.green_v as f32],
        white_luma: colours.white_luma as f32,
        white: [colours.white_u as f32, colours.white_v as f32],
        deviation: colours.green_deviation as f32,
        hues,
    }
}

fn colour_of(class: ColourClass) -> Option<Colour> {
    match class {
        ColourClass::Orange => Some(Colour::Orange),
        ColourClass::Yellow => Some(Colour::Yellow),
        ColourClass::Blue => Some(Colour::Blue),
        ColourClass::Red => Some(Colour::Red),
        ColourClass::Other | ColourClass::Green | ColourClass::White | ColourClass::Dark => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_survives_the_message() {
        let mut model = ColourModel { green_luma: 80.0, white: [0.1, -0.2], ..ColourModel::default() };
        model.hues[1] = Some(ObjectHue { chroma: [-0.5, 0.25], width: 0.2 });
        assert_eq!(colour_model(&field_colours(&model)), model);
    }
}
