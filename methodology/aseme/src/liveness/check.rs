//! Checks across formulas that are each syntactically correct.

use std::collections::BTreeMap;

use yase::{Diagnostic, Span};

use super::Liveness;

/// Reports duplicate, recursive and unreachable formulas, and names that differ from a formula only
/// in case.
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
    (0..uses.len()).for_each(|formula| search.visit(formula));
    diagnostics.append(&mut search.diagnostics);
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

fn unused(liveness: &Liveness, by_name: &BTreeMap<&str, usize>, reached: &[bool]) -> Vec<Diagnostic> {
    let formulas = liveness.formulas().iter().enumerate();
    let unused = formulas
        .filter(|(index, formula)| !reached[*index] && by_name.get(formula.name.as_str()) == Some(index));
    let root = liveness.formulas().first().map_or("", |formula| formula.name.as_str());
    unused
        .map(|(_, formula)| {
            let message = format!("`{}` is not part of `{root}`", formula.name);
            let used =
                liveness.formulas().iter().flat_map(|formula| liveness.names(formula)).map(|(name, _)| name);
            let activities = used.filter(|name| !by_name.contains_key(name));
            Diagnostic::warning("E0215", formula.name_span, message).with_nearest(&formula.name, activities)
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
