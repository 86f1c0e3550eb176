//! Writer of model instances in XMI.

use yase::Diagnostic;

use super::{Class, FeatureKind, FeatureValue, Metamodel, ModelInstance, Object};
use crate::xmi::{XmiWriter, fits_xml};

/// A model as the Eclipse tools write it.
///
/// # Errors
/// Texts with characters that XML does not have (E0810).
pub(crate) fn to_xmi(metamodel: &Metamodel, instance: &ModelInstance) -> Result<String, Vec<Diagnostic>> {
    let refused = unwritable(metamodel, instance);
    if !refused.is_empty() {
        return Err(refused);
    }
    let mut writer = XmiWriter::new();
    writer.root(metamodel.prefix, metamodel.root, metamodel.namespaces.first().copied().unwrap_or_default());
    for (class, objects) in metamodel.classes.iter().zip(&instance.objects) {
        for (index, object) in objects.iter().enumerate() {
            writer.open(class.feature);
            features(metamodel, instance, class, (index, object), &mut writer);
            writer.close();
        }
    }
    Ok(writer.into_text())
}

fn features(
    metamodel: &Metamodel,
    instance: &ModelInstance,
    class: &Class,
    (index, object): (usize, &Object),
    writer: &mut XmiWriter,
) {
    let paths = |class: usize, links: &[usize]| {
        let feature = metamodel.classes[class].feature;
        links.iter().map(|link| format!("//@{feature}.{link}")).collect::<Vec<_>>().join(" ")
    };
    for (feature, value) in class.features.iter().zip(&object.values) {
        match (feature.kind, value) {
            (FeatureKind::Links { class, .. }, FeatureValue::Links(links)) => {
                writer.attribute_if_any(feature.name, &paths(class, links));
            }
            (FeatureKind::Opposite { class, feature: there }, _) => {
                writer
                    .attribute_if_any(feature.name, &paths(class, &instance.linking_to(class, there, index)));
            }
            (FeatureKind::Choice(choices), FeatureValue::Choice(choice)) if *choice > 0 => {
                writer.attribute_if_any(feature.name, choices.get(*choice).copied().unwrap_or_default());
            }
            (_, FeatureValue::Text(text)) => writer.attribute_if_any(feature.name, text),
            _ => {}
        }
    }
}

fn unwritable(metamodel: &Metamodel, instance: &ModelInstance) -> Vec<Diagnostic> {
    let mut refused = Vec::new();
    for (class, objects) in metamodel.classes.iter().zip(&instance.objects) {
        for object in objects {
            for (feature, value) in class.features.iter().zip(&object.values) {
                if matches!(value, FeatureValue::Text(text) if !fits_xml(text)) {
                    let message = format!(
                        "the `{}` of a {} has a character that XML does not have",
                        feature.key, class.header
                    );
                    refused.push(
                        Diagnostic::error("E0810", object.position.0, message)
                            .with_hint("remove the character"),
                    );
                }
            }
        }
    }
    refused
}
