//! Mutants: constants in guards, one step larger and one step smaller.

use std::collections::BTreeSet;

use yase::Span;
use yase::expression::{Expression, ExpressionKind};
use yase::statechart::ConstantValue;

use super::{MutantCollector, MutantDescription, MutationKind};
use aseme::srm::{Section, SrmFile};

/// The step relative to a number: a tenth.
const RELATIVE_STEP: f64 = 0.1;
/// The significant digits of a step.
const DIGITS: usize = 12;

/// A number a tenth larger and a tenth smaller; for zero, plus and minus one.
pub(crate) fn around(value: f64) -> [f64; 2] {
    let step = if value == 0.0 { 1.0 } else { value.abs() * RELATIVE_STEP };
    [value + step, value - step].map(rounded)
}

/// Rounds off the noise digits of floating-point sums.
fn rounded(value: f64) -> f64 {
    format!("{value:.DIGITS$e}").parse().unwrap_or(value)
}

/// All mutants of constants that guards use.
pub(crate) fn all(making: &mut MutantCollector<'_>) {
    let mut named = BTreeSet::new();
    for (_, transition) in making.chart.transitions() {
        transition.expression.guard.iter().for_each(|guard| names(guard, &mut named));
    }
    let spans = constant_spans(making);
    for (index, constant) in making.chart.constants.iter().enumerate() {
        let ConstantValue::Number(value) = constant.value else { continue };
        if !named.contains(&constant.name) {
            continue;
        }
        let span = spans.iter().find(|(name, _)| *name == constant.name).map(|(_, span)| *span);
        for other in around(value) {
            let mut chart = making.chart.clone();
            chart.constants[index].value = ConstantValue::Number(other);
            let mutation = MutantDescription {
                kind: MutationKind::Number,
                change: format!("the constant is {other} instead of {value}"),
                wanted: format!("a case in which `{}` and {other} make a difference", constant.name),
            };
            let what = format!("constant {index} {other}");
            let names = (constant.name.clone(), constant.name.clone());
            making.add(&what, names, span.unwrap_or_default(), mutation, chart);
        }
    }
}

/// The unqualified names that a condition reads.
fn names(condition: &Expression, found: &mut BTreeSet<String>) {
    if let ExpressionKind::Variable(path) = &condition.kind {
        found.extend(path.bare().map(str::to_owned));
    }
    condition.parts().into_iter().for_each(|part| names(part, found));
}

/// The span of each constant of a role; none for charts in files of their own.
fn constant_spans(making: &MutantCollector<'_>) -> Vec<(String, Span)> {
    let (file, _) = SrmFile::parse(making.source.text.as_str());
    let of_constants = file.entries().iter().filter(|entry| entry.section == Section::Constants);
    let named = of_constants.filter_map(|entry| {
        let text = file.text().get(entry.span.start..entry.span.end)?;
        Some((text.split('=').next()?.trim().to_owned(), entry.span))
    });
    named.collect()
}
