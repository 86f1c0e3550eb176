//! Values of a checked element: given values, otherwise the grammar's defaults.

use std::str::FromStr;
use std::time::Duration;

use super::element::{Attribute, Element};
use super::grammar::{ElementRule, Grammar};

/// The attributes of an element as values. A value that is not allowed has been reported and counts
/// as absent.
#[derive(Clone, Copy, Debug)]
pub struct Values<'a> {
    element: &'a Element,
    rule: Option<&'a ElementRule>,
}

impl<'a> Values<'a> {
    /// The attributes of an element, with the defaults of the grammar.
    pub fn of(element: &'a Element, grammar: &'a Grammar) -> Values<'a> {
        Values { element, rule: grammar.element(element.name()) }
    }

    /// The attribute with that key, if present.
    pub fn given(&self, key: &str) -> Option<&'a Attribute> {
        let rule = self.rule.and_then(|rule| rule.attribute_named(key));
        let means = |given: &&Attribute| rule.map_or(given.is(key), |rule| rule.is(&given.name));
        self.element.attributes().iter().find(means)
    }

    /// Its text, or its default.
    pub fn text(&self, key: &str) -> Option<&'a str> {
        let rule = self.rule.and_then(|rule| rule.attribute_named(key));
        let given = self.given(key).map(|given| given.value.trim());
        let allowed = given.filter(|text| rule.is_none_or(|rule| rule.kind.allows(text)));
        allowed.or_else(|| rule.and_then(|rule| rule.default.as_deref()))
    }

    /// A boolean.
    pub fn flag(&self, key: &str) -> Option<bool> {
        super::grammar::flag(self.text(key)?)
    }

    /// A number of any type.
    pub fn number<T: FromStr>(&self, key: &str) -> Option<T> {
        self.text(key)?.parse().ok()
    }

    /// A duration.
    pub fn duration(&self, key: &str) -> Option<Duration> {
        crate::duration(self.text(key)?)
    }

    /// The value of a word.
    pub fn word<T: Clone>(&self, key: &str, words: &[(&str, T)]) -> Option<T> {
        let text = self.text(key)?;
        words.iter().find(|(word, _)| *word == text).map(|(_, value)| value.clone())
    }

    /// The attributes that the grammar does not name: parameters of the element's item.
    pub fn parameters(&self) -> impl Iterator<Item = &'a Attribute> + use<'a> {
        let rule = self.rule;
        let is_known =
            move |given: &Attribute| rule.is_some_and(|rule| rule.attribute_named(&given.name).is_some());
        self.element.attributes().iter().filter(move |given| !is_known(given))
    }
}
