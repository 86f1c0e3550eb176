//! Updates a configuration: the present description of its agents is merged into the text they were
//! read from. Unchanged parts keep their bytes; additions follow the formatting of their
//! surroundings.

mod charts;

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use yase::Source;

use super::element::{Element, camel_case};
use super::grammar::Grammar;
use super::modules;
use super::values::Values;
use super::xml_editor::{XmlEditor, attribute_text, element_text};
use monas_core::agent::{ActivityProfile, AgentProfile, FailurePolicy};
use monas_core::module::Module;

type Splice = (Range<usize>, String);

/// The text of a configuration with its agents as they are now. Disabled agents are kept.
pub fn updated<'a>(
    source: &Arc<Source>,
    profiles: &[AgentProfile],
    loaded: impl Iterator<Item = &'a Module>,
) -> String {
    let mut document = XmlEditor::new(source.clone());
    let update = AgentWriteBack { document: &document, grammar: Grammar::agents() };
    let mut splices = update.splices(profiles);
    splices.extend(update.modules(loaded));
    document.splice(splices);
    document.source().text.clone()
}

/// The agents as a new text.
pub fn rewritten<'a>(profiles: &[AgentProfile], loaded: impl Iterator<Item = &'a Module>) -> String {
    let modules: String = loaded.map(|module| format!("\n  {}", module_element(module))).collect();
    let agents: String = profiles.iter().map(|profile| agent(profile, "\n  ")).collect();
    format!("<?xml version=\"1.0\" ?>\n<agents>{modules}{agents}\n</agents>\n")
}

struct AgentWriteBack<'a> {
    document: &'a XmlEditor,
    grammar: Grammar,
}

impl AgentWriteBack<'_> {
    fn splices(&self, profiles: &[AgentProfile]) -> Vec<Splice> {
        let mut agents = Vec::new();
        collect(self.document.roots(), &mut agents);
        agents.retain(|element| self.is_enabled(element));
        let mut splices = Vec::new();
        for element in &agents {
            match profiles.iter().find(|profile| profile.name == name_of(element)) {
                Some(profile) => self.update(element, profile, &mut splices),
                None => splices.push((self.line_of(element), String::new())),
            }
        }
        let is_new = |profile: &&AgentProfile| !agents.iter().any(|element| name_of(element) == profile.name);
        let new: Vec<&AgentProfile> = profiles.iter().filter(is_new).collect();
        if !new.is_empty() {
            splices.push(self.added(&new));
        }
        splices
    }

    /// Removes modules that are not loaded any more; inserts newly loaded ones before everything
    /// else.
    fn modules<'b>(&self, loaded: impl Iterator<Item = &'b Module>) -> Vec<Splice> {
        let path = Path::new(&self.document.source().name);
        let written = modules::files(self.document.roots(), path, &self.grammar);
        let loaded: Vec<&Module> = loaded.collect();
        let is = |file: &Option<PathBuf>, module: &Module| {
            file.as_deref().is_some_and(|file| modules::is_of(file, module))
        };
        let gone = written.iter().filter(|(_, file)| !loaded.iter().any(|module| is(file, module)));
        let mut splices: Vec<Splice> =
            gone.map(|(element, _)| (self.line_of(element), String::new())).collect();
        let new = loaded.iter().filter(|module| !written.iter().any(|(_, file)| is(file, module)));
        let (first, indentation) = match self.document.roots() {
            [root] if root.is("agents") => (root.children().first(), "\n  "),
            roots => (roots.first(), "\n"),
        };
        if let Some(first) = first {
            let text: String = new.map(|module| module_element(module) + indentation).collect();
            splices.push((first.span().start..first.span().start, text));
        }
        splices
    }

    fn is_enabled(&self, element: &Element) -> bool {
        Values::of(element, &self.grammar).flag("enable").unwrap_or(true)
    }

    fn update(&self, element: &Element, profile: &AgentProfile, splices: &mut Vec<Splice>) {
        let is_its_own = match &profile.activities[..] {
            [one] => one.name == profile.name && one.parameters.is_empty() && one.policy.is_none(),
            _ => false,
        };
        if element.is("provider") && !(is_its_own && profile.charts.is_empty()) {
            // An element with a single activity cannot express it.
            let span = element.span();
            return splices
                .push((span.start..span.end, agent(profile, self.blanks_before(element)).trim().into()));
        }
        splices.extend(self.document.attribute_splices(element, &self.changed_attributes(element, profile)));
        if element.is("agent") {
            self.update_activities(element, profile, splices);
            let charts = element.children_named("statechart").filter(|chart| self.is_enabled(chart));
            for (chart, now) in charts.zip(&profile.charts) {
                self.update_chart(chart, now, splices);
            }
        }
    }

    /// Changed attributes, in the element's spelling of their names.
    fn changed_attributes(&self, element: &Element, profile: &AgentProfile) -> Vec<(String, String)> {
        self.changed(element, attributes(profile).into_iter())
    }

    fn changed(
        &self,
        element: &Element,
        now: impl Iterator<Item = (&'static str, String)>,
    ) -> Vec<(String, String)> {
        let values = Values::of(element, &self.grammar);
        let as_in_thesis =
            element.attributes().iter().any(|given| given.name.starts_with(char::is_uppercase));
        let changed = now.filter(|(key, value)| {
            let before = values.text(key);
            let is_same = |before: &str| {
                before == value
                    || matches!((before.parse::<f64>(), value.parse::<f64>()), (Ok(a), Ok(b)) if a == b)
                    || *key == "is_real_time" && values.flag(key) == Some(value == "1")
            };
            !before.map_or(value.is_empty(), is_same)
        });
        let named = changed.map(|(key, value)| match values.given(key) {
            Some(given) => (given.name.clone(), value),
            None if as_in_thesis => (camel_case(key), value),
            None => (key.to_owned(), value),
        });
        named.collect()
    }

    /// Activities that stay in order keep their positions; others are removed and written after
    /// their new predecessor.
    fn update_activities(&self, element: &Element, profile: &AgentProfile, splices: &mut Vec<Splice>) {
        let before: Vec<&Element> =
            element.children_named("activity").filter(|activity| self.is_enabled(activity)).collect();
        let origins = self.origins(&before, profile);
        let stay = longest_rise(&origins);
        for (index, activity) in before.iter().enumerate() {
            if !stay.contains(&index) {
                splices.push((self.line_of(activity), String::new()));
            }
        }
        let name = element.children_named("name").next();
        let mut behind = name.map_or(element.name_span().end, |name| self.end_of(name));
        let mut coming = String::new();
        let indentation = element.children().first().map_or("\n  ", |first| self.blanks_before(first));
        for (now, origin) in profile.activities.iter().zip(origins) {
            let origin_element = origin.map(|position| before[position]);
            match origin_element.filter(|_| origin.is_some_and(|position| stay.contains(&position))) {
                Some(stays) => {
                    if !coming.is_empty() {
                        splices.push((behind..behind, std::mem::take(&mut coming)));
                    }
                    behind = self.end_of(stays);
                    splices
                        .extend(self.document.attribute_splices(stays, &self.changed_parameters(stays, now)));
                }
                None => {
                    coming += indentation;
                    coming += &origin_element.map_or_else(|| activity(now), |moved| self.moved(moved, now));
                }
            }
        }
        if !coming.is_empty() {
            splices.push((behind..behind, coming));
        }
    }

    /// The element from which each activity was read, by index.
    fn origins(&self, before: &[&Element], profile: &AgentProfile) -> Vec<Option<usize>> {
        let mut free: Vec<bool> = before.iter().map(|_| true).collect();
        let mut take = |fits: &dyn Fn(&Element) -> bool| {
            let index = (0..before.len()).find(|position| free[*position] && fits(before[*position]))?;
            free[index] = false;
            Some(index)
        };
        let origin = |now: &ActivityProfile| {
            let same = take(&|element| {
                element.text() == now.name && self.changed_parameters(element, now).is_empty()
            });
            same.or_else(|| take(&|element| element.text() == now.name && self.has_no_others(element, now)))
        };
        profile.activities.iter().map(origin).collect()
    }

    fn changed_parameters(&self, element: &Element, now: &ActivityProfile) -> Vec<(String, String)> {
        let given = |key: &str| element.attributes().iter().find(|given| given.name == key);
        let given_now = activity_attributes(now);
        let changed =
            given_now.into_iter().filter(|(key, value)| given(key).is_none_or(|given| given.value != *value));
        changed.map(|(key, value)| (key.to_owned(), value.to_owned())).collect()
    }

    /// Whether all parameters of an element still exist.
    fn has_no_others(&self, element: &Element, now: &ActivityProfile) -> bool {
        let mut written = Values::of(element, &self.grammar).parameters();
        written.all(|given| now.parameters.iter().any(|(key, _)| key == given.name))
    }

    /// An element at its new position, with its original attributes.
    fn moved(&self, element: &Element, now: &ActivityProfile) -> String {
        match self.changed_parameters(element, now).is_empty() {
            true => {
                let span = element.span();
                self.document.source().text[span.start..span.end].to_owned()
            }
            false => activity(now),
        }
    }

    /// The position for new agents: after the last one, or inside the group.
    fn added(&self, new: &[&AgentProfile]) -> Splice {
        let text = &self.document.source().text;
        let write = |indentation: &str| -> String { new.iter().map(|one| agent(one, indentation)).collect() };
        match self.document.roots() {
            [root] if root.is("agents") => match root.children().last() {
                Some(last) => (last.span().end..last.span().end, write(self.blanks_before(last))),
                None => {
                    let end = text[..root.span().end].rfind("</").unwrap_or(root.span().end);
                    (end..end, format!("{}\n", write("\n  ")))
                }
            },
            [.., last] => (last.span().end..last.span().end, write("\n")),
            [] => (text.len()..text.len(), format!("{}\n", write("\n"))),
        }
    }

    /// The whitespace before an element, from the end of the previous line.
    fn blanks_before(&self, element: &Element) -> &str {
        let before = &self.document.source().text[..element.span().start];
        let blanks = &before[before.trim_end().len()..];
        blanks.rfind('\n').map_or("\n", |line| &blanks[line..])
    }

    /// The end of an element, including a comment after it on its line.
    fn end_of(&self, element: &Element) -> usize {
        let (text, end) = (&self.document.source().text, element.span().end);
        let line = text[end..].lines().next().unwrap_or_default();
        let comment = line.trim();
        let is_comment =
            comment.starts_with("<!--") && comment.find("-->") == Some(comment.len().saturating_sub(3));
        if is_comment { end + line.trim_end().len() } else { end }
    }

    /// An element with the whitespace before it, if it is alone on its line.
    fn line_of(&self, element: &Element) -> Range<usize> {
        let (text, span) = (&self.document.source().text, element.span());
        let start = text[..span.start].trim_end_matches([' ', '\t']).len();
        let ends_line = text[span.end..].trim_start_matches([' ', '\t', '\r']).starts_with('\n');
        match text[..start].ends_with('\n') && ends_line {
            true => start - 1..span.end,
            false => span.start..span.end,
        }
    }
}

fn collect<'a>(elements: &'a [Element], agents: &mut Vec<&'a Element>) {
    for element in elements {
        if element.is("agents") {
            collect(element.children(), agents);
        } else if element.is("agent") || element.is("provider") {
            agents.push(element);
        }
    }
}

fn name_of(element: &Element) -> &str {
    match element.is("provider") {
        true => element.text(),
        false => element.children_named("name").next().map_or("", Element::text),
    }
}

fn module_element(module: &Module) -> String {
    format!("<module>{}</module>", element_text(&module.file().display().to_string()))
}

/// The attributes of an agent; empty for defaults.
fn attributes(profile: &AgentProfile) -> [(&'static str, String); 7] {
    [
        (
            "thread_frequency",
            profile.frequency.map(|frequency| frequency.hertz().to_string()).unwrap_or_default(),
        ),
        ("priority", profile.priority.to_string()),
        ("is_real_time", u8::from(profile.real_time).to_string()),
        ("stats_cycle", profile.statistics_every.unwrap_or_default().to_string()),
        ("workers", profile.workers.map(|workers| workers.to_string()).unwrap_or_default()),
        ("cores", profile.cores.iter().map(usize::to_string).collect::<Vec<_>>().join(" ")),
        ("on_failure", word(profile.policy).to_owned()),
    ]
}

/// The name of a policy.
fn word(policy: FailurePolicy) -> &'static str {
    FailurePolicy::NAMES.into_iter().find(|(_, known)| *known == policy).map_or("", |(name, _)| name)
}

/// An agent as new text: defaults are omitted.
fn agent(profile: &AgentProfile, indentation: &str) -> String {
    let source = Source::new("", "");
    let nothing = Element::new("agent", &source);
    let grammar = Grammar::agents();
    let defaults = Values::of(&nothing, &grammar);
    let said = attributes(profile)
        .into_iter()
        .filter(|(key, value)| defaults.text(key).unwrap_or_default() != value);
    let said: String = said.map(|(key, value)| format!(" {key}=\"{}\"", attribute_text(&value))).collect();
    let mut text =
        format!("{indentation}<agent{said}>{indentation}  <name>{}</name>", element_text(&profile.name));
    for one in &profile.activities {
        text += &format!("{indentation}  {}", activity(one));
    }
    for one in &profile.charts {
        text += &format!("{indentation}  {}", charts::chart(one, &profile.elsewhere));
    }
    text += &charts::monitors(&profile.property_sets, &format!("{indentation}  "));
    text + &format!("{indentation}</agent>")
}

fn activity(now: &ActivityProfile) -> String {
    let given: String = activity_attributes(now)
        .into_iter()
        .map(|(key, value)| format!(" {key}=\"{}\"", attribute_text(value)))
        .collect();
    format!("<activity{given}>{}</activity>", element_text(&now.name))
}

/// The attributes of an activity: its parameters, and its failure policy if it has one.
fn activity_attributes(now: &ActivityProfile) -> Vec<(&str, &str)> {
    let policy =
        now.policy.and_then(|policy| FailurePolicy::NAMES.into_iter().find(|(_, known)| *known == policy));
    now.parameters.iter().chain(policy.map(|(name, _)| ("on_failure", name))).collect()
}

/// The members of a longest increasing subsequence.
fn longest_rise(sequence: &[Option<usize>]) -> Vec<usize> {
    let known: Vec<usize> = sequence.iter().copied().flatten().collect();
    let mut best: Vec<Vec<usize>> = Vec::new();
    for (index, value) in known.iter().enumerate() {
        let before =
            (0..index).filter(|earlier| known[*earlier] < *value).max_by_key(|earlier| best[*earlier].len());
        let mut rise = before.map(|earlier| best[earlier].clone()).unwrap_or_default();
        rise.push(*value);
        best.push(rise);
    }
    // Among several the first: later elements are more likely to have been moved.
    best.into_iter().rev().max_by_key(Vec::len).unwrap_or_default()
}
