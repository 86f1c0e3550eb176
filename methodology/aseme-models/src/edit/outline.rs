//! The editable parts of a model's text, with their positions.

use aseme::SrmFile;
use aseme::srm::{Section, StateEntry};
use aseme::text;
use aseme::transform::expanded;
use yase::{Span, TransitionId};

use super::chart_edit::ChartText;
use super::item_edit::{FormText, plain};
use super::role_edit::RoleText;
use super::{TextForm, form};
use crate::document::{Reference, list, reference, settings};
use crate::meta::{Class, Feature, FeatureKind, Metamodel, UNLIMITED};

/// The editable parts of a model's text.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum ModelOutline {
    /// A role: the states of its formulas, its transitions, its entries.
    Role {
        /// By number of the state.
        states: Vec<StateOutline>,
        /// By number of the transition.
        transitions: Vec<TransitionOutline>,
        /// In the order of the text.
        entries: Vec<EntryOutline>,
    },
    /// A chart.
    Chart {
        /// By number of the state.
        states: Vec<StateOutline>,
        /// By number of the transition.
        transitions: Vec<TransitionOutline>,
    },
    /// Items of classes.
    Form {
        /// The classes.
        classes: Vec<ClassOutline>,
        /// In the order of the text.
        items: Vec<ItemOutline>,
    },
    /// A text that is edited as text only.
    Text,
}

/// A state or connector.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct StateOutline {
    /// Its position: in a formula, or on its line.
    pub span: Span,
    /// Its settings.
    pub settings: Vec<(String, String)>,
}

/// A transition.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TransitionOutline {
    /// The position of its entry; of a role `None` if its formulas alone make it.
    pub span: Option<Span>,
    /// The expression as it is written.
    pub expression: String,
    /// Its modifiers.
    pub modifiers: String,
    /// Whether the entry is for other transitions too.
    pub is_shared: bool,
}

/// An entry of a role.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct EntryOutline {
    /// The word of its section.
    pub section: &'static str,
    /// Its position.
    pub span: Span,
}

/// A class of items.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ClassOutline {
    /// Its header.
    pub word: &'static str,
    /// The meaning of the name in its header.
    pub title: &'static str,
    /// Its fields besides the name.
    pub fields: Vec<FieldOutline>,
}

/// A field of a class.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FieldOutline {
    /// Its key.
    pub key: &'static str,
    /// The kind of its value.
    pub kind: FieldKind,
}

/// The kind of a field's value.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum FieldKind {
    /// A text.
    Text,
    /// Lines of formulas.
    Formulas,
    /// One of these words.
    Choice(Vec<&'static str>),
    /// References to items of the class of this header: one or many.
    Links(&'static str, bool),
}

/// An item.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ItemOutline {
    /// Its number in the text.
    pub item: usize,
    /// Its header.
    pub word: &'static str,
    /// Its name.
    pub name: String,
    /// The text by which others refer to it.
    pub reference: String,
    /// The position of its header.
    pub span: Span,
    /// Its fields with their values; of links each reference.
    pub fields: Vec<(&'static str, Vec<String>)>,
}

/// The editable parts of a text, as far as it can be parsed.
pub fn outline(source: &str) -> ModelOutline {
    match form(source) {
        TextForm::Role => role(source),
        TextForm::Chart => chart(source),
        TextForm::Items => items(&FormText::new(source)),
        TextForm::Foreign => ModelOutline::Text,
    }
}

fn role(source: &str) -> ModelOutline {
    let (file, _) = SrmFile::parse(source);
    let role = RoleText::new(&file);
    let (plain, spans, _) = expanded(&file.srm().liveness);
    let states = plain.nodes().zip(spans).map(|((id, _), span)| {
        let is_meant = |entry: &&StateEntry| !entry.path.has_wildcard() && entry.path.matches(&plain, id);
        let entry = file.srm().states.iter().find(is_meant);
        let settings = entry.map(|entry| file.state_settings(entry.span)).unwrap_or_default();
        let words = |span: Span| source[span.start..span.end].to_owned();
        let settings = settings.into_iter().map(|(key, value)| (words(key), words(value))).collect();
        StateOutline { span, settings }
    });
    let blanked = text::without_comments(source);
    let one_line = |span: Span| text::one_line(&blanked[span.start..span.end]);
    let transitions = (0..role.transition_count()).map(|number| {
        let entry = role.entry_of(TransitionId(number));
        let parts = entry.map(|(entry, _)| file.transition_parts(entry));
        let modifiers = parts.map(|parts| one_line(parts.modifiers)).unwrap_or_default();
        let modifiers: Vec<&str> = modifiers.split(' ').filter(|word| *word != "also").collect();
        TransitionOutline {
            span: entry.map(|(entry, _)| entry.span),
            expression: parts.map(|parts| one_line(parts.expression)).unwrap_or_default(),
            modifiers: modifiers.join(" "),
            is_shared: entry.is_some_and(|(_, is_own)| !is_own),
        }
    });
    let entries = file.entries().iter().filter(|entry| entry.section != Section::Layout);
    let entries = entries.map(|entry| EntryOutline { section: entry.section.word(), span: entry.span });
    ModelOutline::Role {
        states: states.collect(),
        transitions: transitions.collect(),
        entries: entries.collect(),
    }
}

fn chart(source: &str) -> ModelOutline {
    let chart = ChartText::new(source);
    let states = (0..chart.state_count())
        .map(|node| StateOutline { span: chart.state_span(node), settings: chart.state_settings(node) });
    let transitions = chart.transition_texts().map(|(span, expression, modifiers)| TransitionOutline {
        span: Some(span),
        expression,
        modifiers,
        is_shared: false,
    });
    ModelOutline::Chart { states: states.collect(), transitions: transitions.collect() }
}

fn items(form: &FormText<'_>) -> ModelOutline {
    let classes = form.metamodel.classes.iter().map(|class| ClassOutline {
        word: class.header,
        title: class.features[class.title].key,
        fields: fields(class)
            .map(|feature| FieldOutline { key: feature.key, kind: kind(form.metamodel, feature) })
            .collect(),
    });
    let items = form.document.items.iter().enumerate().filter_map(|(index, item)| {
        let class = form.class_of(item)?;
        let known = form.references(class);
        let own = known.get(&index).map(|own| reference(&own.name, own.number)).unwrap_or_default();
        let settings = settings(&item.lines);
        let values = |feature: &Feature| {
            let setting = settings.iter().flatten().find(|setting| setting.key.text == feature.key);
            let values = setting.map(|setting| match (feature.kind, setting.block) {
                (FeatureKind::Links { .. }, _) => {
                    list(&setting.value).into_iter().map(|word| written(word.text)).collect()
                }
                (_, Some(lines)) => lines.iter().map(|line| line.content.text.clone()).collect(),
                _ => vec![plain(&setting.value.text)],
            });
            (feature.key, values.unwrap_or_default())
        };
        Some(ItemOutline {
            item: index,
            word: class.header,
            name: plain(&item.name.text),
            reference: own,
            span: item.span(),
            fields: fields(class).map(values).collect(),
        })
    });
    ModelOutline::Form { classes: classes.collect(), items: items.collect() }
}

/// A reference as [`ItemOutline::reference`] has it, whether it is quoted or not.
fn written(word: String) -> String {
    Reference::parse(&word).map_or(word, |one| reference(&one.name, one.number))
}

/// The features of a class that are lines below its header.
fn fields(class: &'static Class) -> impl Iterator<Item = &'static Feature> {
    let features = class.features.iter().enumerate().filter(|(index, _)| *index != class.title);
    features.map(|(_, feature)| feature).filter(|it| !matches!(it.kind, FeatureKind::Opposite { .. }))
}

fn kind(metamodel: &Metamodel, feature: &Feature) -> FieldKind {
    match feature.kind {
        FeatureKind::Formulas => FieldKind::Formulas,
        FeatureKind::Choice(choices) => FieldKind::Choice(choices.to_vec()),
        FeatureKind::Links { class, max, .. } => {
            FieldKind::Links(metamodel.classes[class].header, max == UNLIMITED)
        }
        FeatureKind::Text | FeatureKind::Opposite { .. } => FieldKind::Text,
    }
}
