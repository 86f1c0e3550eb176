//! Checks across formulas that are each syntactically correct.

use std::collections::{BTreeMap, BTreeSet};

use yase::diagnostic::nearest;
use yase::{Diagnostic, Span};

use super::{Formula, Liveness};

/// The number of names that are compared to suggest what an unreachable formula may be for.
const MAX_COMPARISONS: usize = 1_000_000;

/// Shorter names than this resemble each other by chance.
const SHORTEST_MISSPELT: usize = 4;

/// Formulas given twice, formulas that refine themselves, names that are misspelt, formulas that
/// nothing reaches, and slips of case.
pub(crate) fn check(liveness: &Liveness) -> Vec<Diagnostic> {
    let by_name = liveness.by_name();
    let uses = uses(liveness, &by_name);
    let mut diagnostics = duplicates(liveness, &by_name);
    let mut search = CycleDetector {
        liveness,
        uses: &uses,
        states: vec![FormulaVisit::New; uses.len()],
        diagnostics: Vec::new(),
    };
    search.visit(0);
    let reached: Vec<bool> = search.states.iter().map(|state| *state != FormulaVisit::New).collect();
    let misspelt = misspelt(liveness, &by_name, &reached);
    misspelt.iter().for_each(|(formula, _)| search.visit(*formula));
    let reached: Vec<bool> = search.states.iter().map(|state| *state != FormulaVisit::New).collect();
    (0..uses.len()).for_each(|formula| search.visit(formula));
    diagnostics.append(&mut search.diagnostics);
    diagnostics.extend(misspelt.into_iter().map(|(_, diagnostic)| diagnostic));
    diagnostics.extend(unused(liveness, &by_name, &reached));
    diagnostics.extend(slips_of_case(liveness, &by_name));
    diagnostics
}

/// For each formula the formulas it names, with their spans.
fn uses(liveness: &Liveness, by_name: &BTreeMap<&str, usize>) -> Vec<Vec<(usize, Span)>> {
    let of = |formula| {
        liveness.names(formula).filter_map(|(name, span)| Some((*by_name.get(name)?, span))).collect()
    };
    liveness.formulas().iter().map(of).collect()
}

fn duplicates(liveness: &Liveness, by_name: &BTreeMap<&str, usize>) -> Vec<Diagnostic> {
    let formulas = liveness.formulas().iter().enumerate();
    let later = formulas.filter(|(index, formula)| by_name.get(formula.name.as_str()) != Some(index));
    later
        .map(|(_, formula)| {
            let message = format!("`{}` has a formula already", formula.name);
            Diagnostic::error("E0213", formula.name_span, message)
                .with_hint("give one of the two another name, or join them")
        })
        .collect()
}

#[derive(Clone, Copy, PartialEq)]
enum FormulaVisit {
    New,
    Open,
    Done,
}

/// A depth-first search for cycles, with an explicit stack.
struct CycleDetector<'a> {
    liveness: &'a Liveness,
    uses: &'a [Vec<(usize, Span)>],
    states: Vec<FormulaVisit>,
    diagnostics: Vec<Diagnostic>,
}

impl CycleDetector<'_> {
    fn visit(&mut self, start: usize) {
        if self.states.get(start) != Some(&FormulaVisit::New) {
            return;
        }
        self.states[start] = FormulaVisit::Open;
        let mut path = vec![(start, 0)];
        while let Some((formula, next)) = path.pop() {
            let Some(&(used, span)) = self.uses[formula].get(next) else {
                self.states[formula] = FormulaVisit::Done;
                continue;
            };
            path.push((formula, next + 1));
            match self.states[used] {
                FormulaVisit::New => {
                    self.states[used] = FormulaVisit::Open;
                    path.push((used, 0));
                }
                FormulaVisit::Open => self.report(&path, used, span),
                FormulaVisit::Done => {}
            }
        }
    }

    fn report(&mut self, path: &[(usize, usize)], again: usize, span: Span) {
        let names = path.iter().map(|(formula, _)| *formula).skip_while(|formula| *formula != again);
        let cycle: Vec<&str> =
            names.chain([again]).map(|formula| self.liveness.formulas()[formula].name.as_str()).collect();
        let message = format!("`{}` refines itself: {}", cycle[0], cycle.join(" -> "));
        let hint = "repetition is written `x~`, `x*` or `x+`";
        self.diagnostics.push(Diagnostic::error("E0214", span, message).with_hint(hint));
    }
}

/// The formulas that nothing reaches, of those with the same left-hand side the first.
fn unreached<'a>(
    liveness: &'a Liveness,
    by_name: &BTreeMap<&str, usize>,
    reached: &[bool],
) -> impl Iterator<Item = (usize, &'a Formula)> {
    let formulas = liveness.formulas().iter().enumerate();
    formulas.filter(|(index, formula)| !reached[*index] && by_name.get(formula.name.as_str()) == Some(index))
}

/// Names in formulas that have none and are almost that of a formula which nothing reaches, with
/// that formula: each once, where it stands first.
fn misspelt(
    liveness: &Liveness,
    by_name: &BTreeMap<&str, usize>,
    reached: &[bool],
) -> Vec<(usize, Diagnostic)> {
    let mut names: BTreeMap<&str, Span> = BTreeMap::new();
    for (_, formula) in liveness.formulas().iter().enumerate().filter(|(index, _)| reached[*index]) {
        for (name, span) in liveness.names(formula).filter(|(name, _)| !by_name.contains_key(name)) {
            names.entry(name).or_insert(span);
        }
    }
    let unreached = unreached(liveness, by_name, reached).take(MAX_COMPARISONS / names.len().max(1));
    unreached
        .filter(|(_, formula)| formula.name.len() >= SHORTEST_MISSPELT)
        .filter_map(|(index, formula)| {
            let is_other_case = |name: &&str| !name.eq_ignore_ascii_case(&formula.name);
            let name = nearest(&formula.name, names.keys().copied().filter(is_other_case))?;
            let message = format!("`{name}` has no formula, and nothing refers to `{}`", formula.name);
            let hint = format!("did you mean `{}`?", formula.name);
            Some((index, Diagnostic::error("E0217", names[name], message).with_hint(hint)))
        })
        .collect()
}

fn unused(liveness: &Liveness, by_name: &BTreeMap<&str, usize>, reached: &[bool]) -> Vec<Diagnostic> {
    let used = liveness.formulas().iter().flat_map(|formula| liveness.names(formula)).map(|(name, _)| name);
    let activities: BTreeSet<&str> = used.filter(|name| !by_name.contains_key(name)).collect();
    let compared = MAX_COMPARISONS / activities.len().max(1);
    let root = liveness.formulas().first().map_or("", |formula| formula.name.as_str());
    unreached(liveness, by_name, reached)
        .enumerate()
        .map(|(number, (_, formula))| {
            let message = format!("`{}` is not part of `{root}`", formula.name);
            let finding = Diagnostic::warning("E0215", formula.name_span, message);
            match number < compared {
                true => finding.with_nearest(&formula.name, activities.iter().copied()),
                false => finding,
            }
        })
        .collect()
}

/// Activities whose name differs from that of a formula only in case.
fn slips_of_case(liveness: &Liveness, by_name: &BTreeMap<&str, usize>) -> Vec<Diagnostic> {
    let folded: BTreeMap<String, &str> = by_name.keys().map(|name| (name.to_lowercase(), *name)).collect();
    let names = liveness.formulas().iter().flat_map(|formula| liveness.names(formula));
    let activities = names.filter(|(name, _)| !by_name.contains_key(name));
    activities
        .filter_map(|(name, span)| {
            let formula = folded.get(&name.to_lowercase())?;
            let message = format!("`{name}` is an activity, although there is a formula `{formula}`");
            Some(Diagnostic::warning("E0218", span, message).with_hint(format!("did you mean `{formula}`?")))
        })
        .collect()
}
