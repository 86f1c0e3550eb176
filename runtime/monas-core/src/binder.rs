//! Binds a statechart to the program: expressions to topics and functions, states to activities.

use std::collections::BTreeMap;
use std::sync::Arc;

use narukom::TOPICS;
use yase::vocabulary::FunctionEntry;
use yase::{
    ActivityEntry, CompiledChart, Diagnostic, NodeId, Semantics, Source, Span, Statechart, TypeEnvironment,
};

use crate::activity::Activity;
use crate::agent::ChartSettings;
use crate::call;
use crate::error::{Error, ErrorKind};
use crate::function::FunctionDeclaration;
use crate::generated::GeneratedChart;
use crate::monitors::{Monitors, PropertySet, needs_one_chart};
use crate::registry::Registry;
use crate::vocabulary::vocabulary;

/// The type environment of the program, and its activities.
pub struct Binder<'a> {
    registry: &'a Registry,
    functions: Arc<[FunctionDeclaration]>,
    vocabulary: TypeEnvironment,
}

/// A chart ready to run: compiled, with an activity instance for each state that has one.
pub struct BoundChart {
    /// The compiled chart.
    pub chart: Arc<CompiledChart>,
    pub(crate) functions: Arc<[FunctionDeclaration]>,
    /// In the order of the compiled chart's activities.
    pub activities: Vec<Box<dyn Activity>>,
}

/// A compiled statechart without activities. It is compiled when a configuration is loaded and
/// reused whenever the chart is started.
#[derive(Clone, Debug)]
pub struct CompiledModel {
    /// The compiled chart.
    pub chart: Arc<CompiledChart>,
    /// The functions that its expressions may call, by index.
    functions: Arc<[FunctionEntry]>,
}

impl CompiledModel {
    /// Whether it is the compiled form of the statechart under these semantics. The functions may
    /// have changed after a module was loaded.
    fn is_valid(&self, semantics: Semantics, vocabulary: &TypeEnvironment) -> bool {
        let same = |(a, b): (&FunctionEntry, &FunctionEntry)| {
            a.name == b.name && a.parameters == b.parameters && a.result == b.result
        };
        self.chart.semantics() == semantics
            && self.functions.len() == vocabulary.functions.len()
            && self.functions.iter().zip(&vocabulary.functions).all(same)
    }
}

impl BoundChart {
    /// Configures its activities with the parameters of the chart's settings.
    pub fn configured(mut self, own: &ChartSettings) -> BoundChart {
        for (entry, activity) in self.chart.activities().zip(&mut self.activities) {
            if let Some(known) = own.of_activity(entry.name) {
                call::configure_again(entry.name, &mut **activity, &known.parameters.without_accesses());
            }
        }
        self
    }
}

impl<'a> Binder<'a> {
    /// Collects the topics of the program and the functions of a registry.
    ///
    /// # Errors
    /// Two functions have the same name.
    pub fn new(registry: &'a Registry) -> Result<Binder<'a>, Error> {
        let functions = registry.functions()?;
        let vocabulary = vocabulary(TOPICS, &functions);
        Ok(Binder { registry, functions: functions.into(), vocabulary })
    }

    /// Compiles a chart and checks that its activities are registered. Spans refer to `source`.
    ///
    /// # Errors
    /// Diagnostics of everything that prevents it from running.
    pub fn compile(
        &self,
        chart: &Statechart,
        source: &Arc<Source>,
    ) -> Result<CompiledModel, Vec<Diagnostic>> {
        Ok(self.model(&self.bind(chart, None, Semantics::yase(), Some(source))?))
    }

    /// The compiled form of a bound chart.
    pub fn model(&self, bound: &BoundChart) -> CompiledModel {
        CompiledModel { chart: bound.chart.clone(), functions: self.vocabulary.functions.clone().into() }
    }

    /// Binds a chart. It is compiled unless `model` is its compiled form.
    ///
    /// # Errors
    /// Everything that prevents it from running.
    pub fn bind(
        &self,
        chart: &Statechart,
        model: Option<&CompiledModel>,
        semantics: Semantics,
        source: Option<&Arc<Source>>,
    ) -> Result<BoundChart, Vec<Diagnostic>> {
        let mut diagnostics = Vec::new();
        let activities = self.activities(chart, source, &mut diagnostics);
        let compiled = match model.filter(|model| model.is_valid(semantics, &self.vocabulary)) {
            Some(model) => Ok(model.chart.clone()),
            None => chart.compile_with(&self.vocabulary, semantics).map(Arc::new),
        };
        let compiled = compiled.map_err(|wrong| diagnostics.extend(wrong)).ok();
        match compiled.filter(|_| diagnostics.is_empty()) {
            Some(chart) => {
                let activities = in_order(&chart, activities);
                Ok(BoundChart { chart, functions: self.functions.clone(), activities })
            }
            None => Err(match source {
                Some(source) => {
                    diagnostics.into_iter().map(|diagnostic| diagnostic.in_source(source)).collect()
                }
                None => diagnostics,
            }),
        }
    }

    /// Binds a generated chart with the activities it contains.
    ///
    /// # Errors
    /// Everything that prevents it from running: it was generated for other messages, or from
    /// another model than its activities.
    pub fn bind_generated(
        &self,
        generated: GeneratedChart,
        semantics: Semantics,
    ) -> Result<BoundChart, Vec<Diagnostic>> {
        let GeneratedChart { chart, instances } = generated;
        let chart = Arc::new(chart.compile(&self.vocabulary, semantics)?);
        let mut activities: BTreeMap<NodeId, Box<dyn Activity>> =
            instances.into_iter().map(|instance| (instance.node, instance.activity)).collect();
        let lacking = |entry: &ActivityEntry<'_>| {
            let message = format!(
                "no activity `{}` was generated for the state `{}`",
                entry.name,
                chart.names().name(entry.node)
            );
            Diagnostic::error("E0318", Span::default(), message).with_hint("generate the chart again")
        };
        let taken =
            chart.activities().map(|entry| activities.remove(&entry.node).ok_or_else(|| lacking(&entry)));
        let taken = taken.collect::<Result<_, _>>().map_err(|diagnostic| vec![diagnostic])?;
        Ok(BoundChart { chart, functions: self.functions.clone(), activities: taken })
    }

    /// Monitors for the properties of the agent and of this chart; none if there are no properties.
    ///
    /// # Errors
    /// Names unknown to the chart or the program; agent properties that cannot be assigned because
    /// the agent has several charts.
    pub fn monitors(
        &self,
        of_agent: Option<(&[PropertySet], &str, usize)>,
        own: &[PropertySet],
        chart: &CompiledChart,
    ) -> Result<Option<Monitors>, Vec<Diagnostic>> {
        let (rules, agent, charts) = of_agent.unwrap_or_default();
        if let Some(wrong) = needs_one_chart(agent, charts).filter(|_| !rules.is_empty()) {
            return Err(vec![wrong]);
        }
        let all: Vec<PropertySet> = rules.iter().chain(own).cloned().collect();
        match all.is_empty() {
            true => Ok(None),
            false => Monitors::new(&all, chart, &self.vocabulary).map(Some),
        }
    }

    /// Compiles a chart without its activities; diagnostics have no source text.
    pub fn compiled(
        &self,
        chart: &Statechart,
        generated: Option<&GeneratedChart>,
    ) -> Result<CompiledChart, Vec<Diagnostic>> {
        match generated {
            Some(generated) => generated.chart.compile(&self.vocabulary, Semantics::yase()),
            None => chart.compile_with(&self.vocabulary, Semantics::yase()),
        }
    }

    /// An instance for each state with an activity. A name unknown in several states is reported
    /// once.
    fn activities(
        &self,
        chart: &Statechart,
        source: Option<&Arc<Source>>,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Vec<(NodeId, Box<dyn Activity>)> {
        let mut instances = Vec::new();
        let mut said: Vec<&str> = Vec::new();
        for (id, node) in chart.nodes() {
            let Some(name) = node.activity.as_deref() else { continue };
            match self.registry.activity(name) {
                Ok(activity) => instances.push((id, activity)),
                Err(_) if said.contains(&name) => {}
                Err(error) => {
                    said.push(name);
                    let span = source.map_or(Span::default(), |source| first_occurrence(name, &source.text));
                    diagnostics.push(unbound(&chart.path(id), name, span, &error));
                }
            }
        }
        instances
    }
}

fn in_order(
    chart: &CompiledChart,
    mut instances: Vec<(NodeId, Box<dyn Activity>)>,
) -> Vec<Box<dyn Activity>> {
    let index = |node| chart.activities().position(|entry| entry.node == node);
    instances.sort_by_key(|(node, _)| index(*node));
    instances.into_iter().map(|(_, activity)| activity).collect()
}

fn unbound(path: &str, name: &str, span: Span, error: &Error) -> Diagnostic {
    let message = match error.kind() {
        ErrorKind::UnknownActivity => format!("no activity `{name}` is registered for the state `{path}`"),
        _ => format!("{error}; the state `{path}` has no activity"),
    };
    let diagnostic = Diagnostic::error("E0318", span, message);
    match error.hint() {
        Some(hint) => diagnostic.with_hint(hint),
        None => diagnostic,
    }
}

/// The first occurrence of a name as a whole word in a model's text; the start of the text if there
/// is none. Charts do not keep the spans of their states.
fn first_occurrence(name: &str, text: &str) -> Span {
    let part_of_word = |c: char| c.is_alphanumeric() || c == '_';
    let found = text.match_indices(name).find(|(at, _)| {
        let (before, after) = (&text[..*at], &text[at + name.len()..]);
        let line = &before[before.rfind('\n').map_or(0, |newline| newline + 1)..];
        // `ω` is a letter, but means "forever" after a name.
        !line.contains('#')
            && !before.ends_with(part_of_word)
            && !after.starts_with(|c| part_of_word(c) && !matches!(c, 'ω' | 'Ω'))
    });
    found.map_or(Span::default(), |(at, _)| Span::new(at, at + name.len()))
}

#[cfg(test)]
mod tests {
    use super::first_occurrence;

    fn found(name: &str, text: &str) -> (usize, String) {
        let span = first_occurrence(name, text);
        (span.start, text[span.start..span.end].to_owned())
    }

    #[test]
    fn a_name_is_found_where_it_stands_alone() {
        let text = "# Vision first\nm = Sensors\u{3c9} || VisionLoop || XVision || Vision\u{3c9}";
        let (start, word) = found("Vision", text);
        assert_eq!((word.as_str(), &text[start - 3..start]), ("Vision", "|| "));
        assert_eq!(found("Sensors", text).0, text.find("Sensors").unwrap());
    }

    #[test]
    fn a_name_that_does_not_stand_there_is_at_the_beginning() {
        assert_eq!(found("Gone", "m = a"), (0, String::new()));
    }
}
