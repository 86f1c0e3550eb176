//! Parser of model instances in XMI.

use std::collections::BTreeMap;

use roxmltree::{Attribute, Document, Node};
use yase::expression::TextPosition;
use yase::{Diagnostic, Span};

use super::{Class, Feature, FeatureKind, FeatureValue, Metamodel, ModelInstance, Object, UNLIMITED};
use crate::xmi::{self, XSI, XmiPaths};

/// Parses a model from XMI; the findings are E0801 to E0809.
pub(crate) fn from_xmi(metamodel: &Metamodel, document: &Document<'_>) -> (ModelInstance, Vec<Diagnostic>) {
    let mut reader = Reader {
        metamodel,
        paths: XmiPaths::new(document),
        objects: BTreeMap::new(),
        instance: metamodel.empty(),
        diagnostics: Vec::new(),
    };
    reader.model(document.root_element());
    (reader.instance, reader.diagnostics)
}

struct Reader<'m> {
    metamodel: &'m Metamodel,
    paths: XmiPaths,
    /// The class of each object's element, and its index in the class.
    objects: BTreeMap<usize, (usize, usize)>,
    instance: ModelInstance,
    diagnostics: Vec<Diagnostic>,
}

impl Reader<'_> {
    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    fn model(&mut self, root: Node<'_, '_>) {
        self.namespace(root);
        for attribute in xmi::features(root) {
            self.unknown_feature(self.metamodel.root, &attribute, &[]);
        }
        let elements = self.elements(root);
        for (class, element) in &elements {
            let index = self.instance.objects[*class].len();
            self.objects.insert(element.id().get_usize(), (*class, index));
            self.instance.objects[*class].push(self.metamodel.classes[*class].object());
        }
        for (_, element) in &elements {
            self.object(*element);
        }
        self.opposites(&elements);
        self.multiplicities(root);
    }

    fn namespace(&mut self, root: Node<'_, '_>) {
        let known = root.tag_name().namespace().filter(|uri| !self.metamodel.namespaces.contains(uri));
        if let Some(uri) = known {
            let message = format!("`{uri}` is not the namespace of a {}", self.metamodel.header);
            let hint = format!("it is `{}`", self.metamodel.namespaces.first().copied().unwrap_or_default());
            self.report(Diagnostic::warning("E0802", xmi::tag(root), message).with_hint(hint));
        }
    }

    /// The elements of objects, with the class of each.
    fn elements<'a, 'input>(&mut self, root: Node<'a, 'input>) -> Vec<(usize, Node<'a, 'input>)> {
        let mut found = Vec::new();
        for element in xmi::elements(root) {
            let name = element.tag_name().name();
            match self.metamodel.classes.iter().position(|class| class.feature == name) {
                Some(class) => found.push((class, element)),
                None => self.unknown_element(element),
            }
        }
        found
    }

    fn unknown_element(&mut self, element: Node<'_, '_>) {
        let name = element.tag_name().name();
        let message = format!("a {} has no `{name}`", self.metamodel.root);
        let names = self.metamodel.classes.iter().map(|class| class.feature);
        let hint = format!("it has {}", names.clone().collect::<Vec<_>>().join(", "));
        let found = Diagnostic::error("E0803", xmi::tag(element), message).with_hint(hint);
        self.report(found.with_nearest(name, names));
    }

    fn unknown_feature(&mut self, class: &str, attribute: &Attribute<'_, '_>, names: &[&str]) {
        let name = attribute.name();
        let message = format!("a {class} has no `{name}`");
        let found = Diagnostic::error("E0804", attribute.range_qname(), message);
        self.report(found.with_nearest(name, names.iter().copied()));
    }

    fn object(&mut self, element: Node<'_, '_>) {
        let Some(&(class, index)) = self.objects.get(&element.id().get_usize()) else { return };
        let metaclass = &self.metamodel.classes[class];
        let mut object = metaclass.object();
        object.position = TextPosition(xmi::tag(element));
        self.subclass(metaclass, element, &mut object);
        for attribute in xmi::features(element) {
            match feature_named(metaclass, attribute.name()) {
                Some(feature) => self.feature(metaclass, feature, &attribute, &mut object),
                None => {
                    let names: Vec<&str> = metaclass.features.iter().map(|feature| feature.name).collect();
                    self.unknown_feature(metaclass.header, &attribute, &names);
                }
            }
        }
        for child in xmi::elements(element) {
            let message =
                format!("a {} has no elements such as `{}`", metaclass.header, child.tag_name().name());
            self.report(Diagnostic::error("E0803", xmi::tag(child), message));
        }
        self.instance.objects[class][index] = object;
    }

    /// Converts a class of an older metamodel to a choice.
    fn subclass(&mut self, class: &Class, element: Node<'_, '_>, object: &mut Object) {
        let Some(attribute) = element.attribute_node((XSI, "type")) else { return };
        let name = attribute.value().rsplit(':').next().unwrap_or_default();
        match class.subclasses.iter().find(|(subclass, ..)| *subclass == name) {
            Some((_, feature, choice)) => object.values[*feature] = FeatureValue::Choice(*choice),
            None if name == class.header => {}
            None => {
                let message = format!("`{name}` is not a kind of {}", class.header);
                let names = class.subclasses.iter().map(|(name, ..)| *name);
                let found = Diagnostic::error("E0805", xmi::value_span(&attribute), message);
                self.report(found.with_nearest(name, names));
            }
        }
    }

    fn feature(&mut self, class: &Class, index: usize, attribute: &Attribute<'_, '_>, object: &mut Object) {
        let (value, span) = (attribute.value(), xmi::value_span(attribute));
        object.value_positions[index] = TextPosition(span);
        object.values[index] = match class.features[index].kind {
            FeatureKind::Text | FeatureKind::Formulas => FeatureValue::Text(value.into()),
            FeatureKind::Choice(choices) => FeatureValue::Choice(self.choice(choices, value, span)),
            FeatureKind::Links { class, max, .. } => FeatureValue::Links(self.links(class, max, value, span)),
            FeatureKind::Opposite { .. } => FeatureValue::Derived,
        };
    }

    fn choice(&mut self, choices: &[&'static str], value: &str, span: Span) -> usize {
        choices.iter().position(|choice| *choice == value).unwrap_or_else(|| {
            let message = format!("`{value}` is none of {}", choices.join(", "));
            let found = Diagnostic::error("E0806", span, message);
            self.report(found.with_nearest(value, choices.iter().copied()));
            0
        })
    }

    fn links(&mut self, class: usize, max: usize, value: &str, span: Span) -> Vec<usize> {
        if let Some(made) = self.text_of_older(class, value, span) {
            return vec![made];
        }
        let links: Vec<usize> =
            value.split_whitespace().filter_map(|word| self.link(class, word, span)).collect();
        if links.len() > max {
            let message = format!("there can be {max} here, not {}", links.len());
            self.report(Diagnostic::error("E0809", span, message));
        }
        links.into_iter().take(if max == UNLIMITED { usize::MAX } else { max }).collect()
    }

    /// The object that a reference denotes.
    fn link(&mut self, class: usize, word: &str, span: Span) -> Option<usize> {
        let wanted = &self.metamodel.classes[class];
        let found = self.paths.find(word).map(|node| self.objects.get(&node).copied());
        let fault = match found {
            Some(Some((found, index))) if found == class => return Some(index),
            Some(Some((found, _))) => {
                format!("`{word}` is a {}, not a {}", self.metamodel.classes[found].header, wanted.header)
            }
            Some(None) => format!("`{word}` is not a {}", wanted.header),
            None => format!("there is no `{word}`"),
        };
        let count = self.instance.of(class).len();
        let hint = match count {
            0 => format!("the model has no {}", wanted.header),
            _ => format!("the {} are `//@{}.0` to `//@{0}.{}`", wanted.feature, wanted.feature, count - 1),
        };
        self.report(Diagnostic::error("E0807", span, fault).with_hint(hint));
        None
    }

    /// Converts the functionality of an activity, a text before 2015, to a functionality with that
    /// description.
    fn text_of_older(&mut self, class: usize, value: &str, span: Span) -> Option<usize> {
        let metaclass = &self.metamodel.classes[class];
        let is_text = metaclass.feature == "functionalities" && !value.starts_with(['/', '#']);
        if !is_text
            || value.trim().is_empty()
            || value.split_whitespace().any(|word| self.paths.find(word).is_some())
        {
            return None;
        }
        let called = |object: &Object| object.text(metaclass.title) == value;
        if let Some(found) = self.instance.of(class).iter().position(called) {
            return Some(found);
        }
        let mut made = metaclass.object();
        made.values[metaclass.title] = FeatureValue::Text(value.into());
        made.position = TextPosition(span);
        self.instance.objects[class].push(made);
        Some(self.instance.of(class).len() - 1)
    }

    /// Checks that opposite features agree.
    fn opposites(&mut self, elements: &[(usize, Node<'_, '_>)]) {
        for (class, element) in elements {
            for attribute in xmi::features(*element) {
                let metaclass = &self.metamodel.classes[*class];
                let Some(index) = feature_named(metaclass, attribute.name()) else { continue };
                if let FeatureKind::Opposite { class: there, feature } = metaclass.features[index].kind {
                    self.opposite(*element, &attribute, there, feature);
                }
            }
        }
        self.unanswered(elements);
    }

    fn opposite(
        &mut self,
        element: Node<'_, '_>,
        attribute: &Attribute<'_, '_>,
        there: usize,
        feature: usize,
    ) {
        let Some(&(_, here)) = self.objects.get(&element.id().get_usize()) else { return };
        let span = xmi::value_span(attribute);
        for word in attribute.value().split_whitespace() {
            let Some(linked) = self.link(there, word, span) else { continue };
            if !self.instance.objects[there][linked].links(feature).contains(&here) {
                let name = self.metamodel.classes[there].features[feature].name;
                let message =
                    format!("`{word}` is named here, but lacks the opposite reference in its `{name}`");
                self.report(
                    Diagnostic::warning("E0808", span, message)
                        .with_hint("a file contains both ends of a link; this one is used"),
                );
                self.answer(there, linked, feature, here);
            }
        }
    }

    /// Adds a link that only its opposite has, if the multiplicity allows it.
    fn answer(&mut self, class: usize, object: usize, feature: usize, target: usize) {
        let FeatureKind::Links { max, .. } = self.metamodel.classes[class].features[feature].kind else {
            return;
        };
        if let FeatureValue::Links(links) = &mut self.instance.objects[class][object].values[feature]
            && links.len() < max
        {
            links.push(target);
        }
    }

    /// Reports links that are missing in their opposite, if the file has the opposite feature at
    /// all.
    fn unanswered(&mut self, elements: &[(usize, Node<'_, '_>)]) {
        let mut found = Vec::new();
        for (class, element) in elements {
            let Some(&(_, here)) = self.objects.get(&element.id().get_usize()) else { continue };
            for (index, feature) in self.metamodel.classes[*class].features.iter().enumerate() {
                let FeatureKind::Opposite { class: there, feature: back } = feature.kind else { continue };
                let named = element
                    .attribute(self.metamodel.classes[*class].features[index].name)
                    .unwrap_or_default();
                let named: Vec<usize> =
                    named.split_whitespace().filter_map(|word| self.paths.find(word)).collect();
                let named: Vec<usize> =
                    named.iter().filter_map(|node| self.objects.get(node)).map(|(_, index)| *index).collect();
                for linking in self
                    .instance
                    .linking_to(there, back, here)
                    .into_iter()
                    .filter(|linking| !named.contains(linking))
                {
                    let there = &self.metamodel.classes[there];
                    let message = format!(
                        "`//@{}.{linking}` is linked here, but is not named in `{}`",
                        there.feature, feature.name
                    );
                    found.push(
                        Diagnostic::warning("E0808", xmi::tag(*element), message)
                            .with_hint("a file contains both ends of a link; this one is used"),
                    );
                }
            }
        }
        self.diagnostics.extend(found);
    }

    /// Checks the multiplicities of the metamodel.
    fn multiplicities(&mut self, root: Node<'_, '_>) {
        let mut found = Vec::new();
        for (class, objects) in self.metamodel.classes.iter().zip(&self.instance.objects) {
            if objects.len() < class.min_count {
                let message = format!(
                    "a {} has at least {} {}, this one {}",
                    self.metamodel.header,
                    class.min_count,
                    class.feature,
                    objects.len()
                );
                found.push(Diagnostic::warning("E0809", xmi::tag(root), message));
            }
            for (object, (index, feature)) in objects
                .iter()
                .flat_map(|object| class.features.iter().enumerate().map(move |feature| (object, feature)))
            {
                let FeatureKind::Links { min, .. } = feature.kind else { continue };
                if object.links(index).len() < min {
                    let message = format!(
                        "the {} `{}` needs {min} `{}` at least",
                        class.header,
                        object.text(class.title),
                        feature.name
                    );
                    found.push(Diagnostic::warning("E0809", object.position.0, message));
                }
            }
        }
        self.diagnostics.extend(found);
    }
}

fn feature_named(class: &Class, name: &str) -> Option<usize> {
    let fits = |feature: &Feature| feature.name == name || feature.older == Some(name);
    class.features.iter().position(fits)
}
