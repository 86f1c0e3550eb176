//! Models as instances of metamodels: objects of classes, with texts, enumerated values and links
//! to other objects.
//!
//! SAG, SUC, AIP, SRM and FT have the same shape: a root with lists of objects. A [`Metamodel`]
//! describes their classes, a [`ModelInstance`] is one such model, and the readers and writers here
//! serve all of them: XMI ([`from_xmi`], [`to_xmi`]) and text ([`from_text`], [`to_text`]). Typed
//! models such as [`Sag`](crate::Sag) convert from and to instances.
//!
//! Of two opposite features one is stored; the other is derived when XMI is written, and compared
//! when it is read.

mod from_text;
mod from_xmi;
mod to_text;
mod to_xmi;

use yase::expression::TextPosition;

pub(crate) use from_text::from_text;
pub(crate) use from_xmi::from_xmi;
pub(crate) use to_text::to_text;
pub(crate) use to_xmi::to_xmi;

/// The metamodel of a kind of model.
pub(crate) struct Metamodel {
    /// The header that a text starts with.
    pub(crate) header: &'static str,
    /// The root element of XMI.
    pub(crate) root: &'static str,
    /// The prefix of the root element.
    pub(crate) prefix: &'static str,
    /// The namespace that is written, and others that are accepted.
    pub(crate) namespaces: &'static [&'static str],
    /// The classes of objects, in the order of the root's features.
    pub(crate) classes: &'static [Class],
}

/// A class of objects.
pub(crate) struct Class {
    /// Its header in text.
    pub(crate) header: &'static str,
    /// The feature of the root that holds its objects.
    pub(crate) feature: &'static str,
    /// The minimum number of objects.
    pub(crate) min_count: usize,
    /// The feature written in the header, which names the object.
    pub(crate) title: usize,
    /// In the order of the metamodel.
    pub(crate) features: &'static [Feature],
    /// Classes of older metamodels that correspond to a choice: name, feature, choice.
    pub(crate) subclasses: &'static [(&'static str, usize, usize)],
}

/// A feature of a class.
pub(crate) struct Feature {
    /// In XMI.
    pub(crate) name: &'static str,
    /// In XMI of older metamodels.
    pub(crate) older: Option<&'static str>,
    /// In text.
    pub(crate) key: &'static str,
    pub(crate) kind: FeatureKind,
}

/// The kind of a feature's values.
#[derive(Clone, Copy)]
pub(crate) enum FeatureKind {
    /// A text, in one line if possible.
    Text,
    /// Lines of formulas.
    Formulas,
    /// One of several words; the first is the default.
    Choice(&'static [&'static str]),
    /// Links to objects of a class.
    Links { class: usize, min: usize, max: usize },
    /// The opposite of a feature with links, which is derived: the class and the feature that link
    /// here.
    Opposite { class: usize, feature: usize },
}

/// No upper limit.
pub(crate) const UNLIMITED: usize = usize::MAX;

/// A model.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct ModelInstance {
    /// The objects of each class.
    pub(crate) objects: Vec<Vec<Object>>,
}

/// An object: a value for each feature of its class.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Object {
    pub(crate) values: Vec<FeatureValue>,
    /// Its position in the source.
    pub(crate) position: TextPosition,
    /// The position of each feature's value.
    pub(crate) value_positions: Vec<TextPosition>,
}

/// The value of a feature.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum FeatureValue {
    Text(String),
    /// The index of the choice.
    Choice(usize),
    /// The indices of the linked objects in their class.
    Links(Vec<usize>),
    /// Derived, not stored.
    Derived,
}

impl Feature {
    const fn new(name: &'static str, word: &'static str, kind: FeatureKind) -> Feature {
        Feature { name, older: None, key: word, kind }
    }

    /// A text.
    pub(crate) const fn text(name: &'static str) -> Feature {
        Feature::new(name, name, FeatureKind::Text)
    }

    /// Formulas.
    pub(crate) const fn formulas(name: &'static str) -> Feature {
        Feature::new(name, name, FeatureKind::Formulas)
    }

    /// A choice between words.
    pub(crate) const fn choice(name: &'static str, choices: &'static [&'static str]) -> Feature {
        Feature::new(name, name, FeatureKind::Choice(choices))
    }

    /// Links to objects of a class, with a minimum and maximum number.
    pub(crate) const fn links(name: &'static str, class: usize, min: usize, max: usize) -> Feature {
        Feature::new(name, name, FeatureKind::Links { class, min, max })
    }

    /// The opposite of links.
    pub(crate) const fn opposite(name: &'static str, class: usize, feature: usize) -> Feature {
        Feature::new(name, name, FeatureKind::Opposite { class, feature })
    }

    /// Sets another name in text.
    pub(crate) const fn called(self, word: &'static str) -> Feature {
        Feature { key: word, ..self }
    }

    /// Sets the name in older metamodels.
    pub(crate) const fn once(self, older: &'static str) -> Feature {
        Feature { older: Some(older), ..self }
    }
}

impl Metamodel {
    /// A model without objects.
    pub(crate) fn empty(&self) -> ModelInstance {
        ModelInstance { objects: self.classes.iter().map(|_| Vec::new()).collect() }
    }

    /// Whether objects of a class are linked to by others.
    pub(crate) fn is_linked(&self, class: &Class) -> bool {
        let links_to = |feature: &Feature| match feature.kind {
            FeatureKind::Links { class: target, .. } => self.classes[target].header == class.header,
            _ => false,
        };
        self.classes.iter().flat_map(|class| class.features).any(links_to)
    }
}

impl Class {
    /// An object without settings.
    pub(crate) fn object(&self) -> Object {
        let value = |feature: &Feature| match feature.kind {
            FeatureKind::Text | FeatureKind::Formulas => FeatureValue::Text(String::new()),
            FeatureKind::Choice(_) => FeatureValue::Choice(0),
            FeatureKind::Links { .. } => FeatureValue::Links(Vec::new()),
            FeatureKind::Opposite { .. } => FeatureValue::Derived,
        };
        let values: Vec<FeatureValue> = self.features.iter().map(value).collect();
        Object {
            value_positions: vec![TextPosition::default(); values.len()],
            values,
            position: TextPosition::default(),
        }
    }
}

impl ModelInstance {
    /// The objects of a class.
    pub(crate) fn of(&self, class: usize) -> &[Object] {
        self.objects.get(class).map_or(&[], Vec::as_slice)
    }

    /// The objects that link to an object by a feature of theirs, in order.
    pub(crate) fn linking_to(&self, class: usize, feature: usize, target: usize) -> Vec<usize> {
        let links = |object: &Object| object.links(feature).contains(&target);
        let objects = self.of(class).iter().enumerate();
        objects.filter(|(_, object)| links(object)).map(|(index, _)| index).collect()
    }
}

impl Object {
    /// An object with these values.
    pub(crate) fn new(values: Vec<FeatureValue>, position: TextPosition) -> Object {
        Object { value_positions: vec![TextPosition::default(); values.len()], values, position }
    }

    /// The text of a feature.
    pub(crate) fn text(&self, feature: usize) -> String {
        match self.values.get(feature) {
            Some(FeatureValue::Text(text)) => text.clone(),
            _ => String::new(),
        }
    }

    /// The choice of a feature.
    pub(crate) fn choice(&self, feature: usize) -> usize {
        match self.values.get(feature) {
            Some(FeatureValue::Choice(choice)) => *choice,
            _ => 0,
        }
    }

    /// The links of a feature.
    pub(crate) fn links(&self, feature: usize) -> &[usize] {
        match self.values.get(feature) {
            Some(FeatureValue::Links(links)) => links,
            _ => &[],
        }
    }

    /// The position of a feature's value, or of the object if there is none.
    pub(crate) fn value_position(&self, feature: usize) -> TextPosition {
        match self.value_positions.get(feature) {
            Some(position) if position.0 != yase::Span::default() => *position,
            _ => self.position,
        }
    }
}

/// A typed model that converts from and to instances of a metamodel.
pub(crate) trait TypedModel: Sized {
    const METAMODEL: &'static Metamodel;
    fn from_instance(instance: &ModelInstance) -> Self;
    fn to_instance(&self) -> ModelInstance;
}
