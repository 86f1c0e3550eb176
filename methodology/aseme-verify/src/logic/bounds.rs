//! Difference-bound matrices in canonical (tightest) form.

use std::rc::Rc;

/// An upper bound, possibly strict.
#[derive(Clone, Copy, PartialEq, Debug)]
struct NumericBound {
    limit: f64,
    strict: bool,
}

const UNBOUNDED: NumericBound = NumericBound { limit: f64::INFINITY, strict: true };
const EQUAL: NumericBound = NumericBound { limit: 0.0, strict: false };

/// Sums of limits that differ by less than this may be equal up to rounding.
const ROUNDING_TOLERANCE: f64 = 1e-9;

impl NumericBound {
    fn plus(self, other: NumericBound) -> NumericBound {
        NumericBound { limit: self.limit + other.limit, strict: self.strict || other.strict }
    }

    fn is_tighter(self, other: NumericBound) -> bool {
        self.limit < other.limit || self.limit == other.limit && self.strict && !other.strict
    }

    /// Whether values exist between this bound on a difference and the opposite one.
    fn is_consistent_with(self, opposite: NumericBound) -> BoundsConsistency {
        let around = self.plus(opposite);
        let rounding = ROUNDING_TOLERANCE * (1.0 + self.limit.abs());
        if around.limit < 0.0 || around.limit == 0.0 && around.strict {
            let exact = around.limit == 0.0 || around.limit < -rounding;
            return if exact { BoundsConsistency::Contradiction } else { BoundsConsistency::TooClose };
        }
        if around.limit != 0.0 && around.limit < rounding {
            return BoundsConsistency::TooClose;
        }
        BoundsConsistency::Consistent
    }
}

/// Whether bounds are consistent.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum BoundsConsistency {
    Consistent,
    Contradiction,
    /// The result depends on rounding.
    TooClose,
}

/// Bounds on the differences of variables, and on variables: their differences from zero.
///
/// Variables that no bound relates to each other are in groups of their own, so that a thousand
/// fields that are each compared with constants do not have a million differences. Clones share
/// groups until they change.
#[derive(Clone, Debug, Default)]
pub(crate) struct DifferenceBounds {
    names: Vec<Rc<str>>,
    /// The group of each name, and its index in the matrix.
    positions: Vec<Position>,
    groups: Vec<Rc<BoundMatrix>>,
}

#[derive(Clone, Copy, Debug)]
struct Position {
    group: usize,
    index: usize,
}

impl DifferenceBounds {
    fn position(&mut self, name: &str) -> Position {
        if let Some(known) = self.names.iter().position(|it| **it == *name) {
            return self.positions[known];
        }
        let position = Position { group: self.groups.len(), index: 1 };
        self.names.push(name.into());
        self.positions.push(position);
        self.groups.push(Rc::new(BoundMatrix::new(2)));
        position
    }

    /// Adds an upper bound on the difference of two variables.
    pub(crate) fn add(
        &mut self,
        more: Option<&str>,
        less: Option<&str>,
        limit: f64,
        strict: bool,
    ) -> BoundsConsistency {
        let bound = NumericBound { limit, strict };
        let [more, less] = [more, less].map(|name| name.map(|name| self.position(name)));
        let (group, i, j) = match (more, less) {
            (None, None) => return bound.is_consistent_with(EQUAL),
            (Some(more), None) => (more.group, more.index, 0),
            (None, Some(less)) => (less.group, 0, less.index),
            (Some(more), Some(less)) if more.group == less.group => (more.group, more.index, less.index),
            (Some(more), Some(less)) => {
                let offset = self.merge(more.group, less.group);
                (more.group, more.index, less.index + offset)
            }
        };
        let consistency = bound.is_consistent_with(self.groups[group].at(j, i));
        if consistency == BoundsConsistency::Consistent && bound.is_tighter(self.groups[group].at(i, j)) {
            Rc::make_mut(&mut self.groups[group]).tighten(i, j, bound);
        }
        consistency
    }

    /// Moves the variables of a group to another one. Returns what is added to their indices.
    fn merge(&mut self, group: usize, moved: usize) -> usize {
        let from = std::mem::replace(&mut self.groups[moved], Rc::new(BoundMatrix::new(1)));
        let offset = self.groups[group].size - 1;
        self.groups[group] = Rc::new(self.groups[group].beside(&from));
        for position in self.positions.iter_mut().filter(|position| position.group == moved) {
            *position = Position { group, index: position.index + offset };
        }
        offset
    }

    /// Values within the bounds.
    pub(crate) fn example(mut self) -> Vec<(String, f64)> {
        let mut values = Vec::new();
        for (name, position) in self.names.iter().zip(&self.positions) {
            let matrix = Rc::make_mut(&mut self.groups[position.group]);
            let index = position.index;
            let (upper, lower) = (matrix.at(index, 0), matrix.at(0, index));
            let value = between((-lower.limit, lower.strict), (upper.limit, upper.strict));
            matrix.fix(index, value);
            values.push((name.to_string(), value));
        }
        values
    }
}

/// A matrix of difference bounds in canonical form; the first variable is zero.
#[derive(Clone, Debug)]
struct BoundMatrix {
    size: usize,
    /// The bound of variable i minus variable j is at i times the size, plus j.
    bounds: Vec<NumericBound>,
}

impl BoundMatrix {
    /// A matrix of variables without bounds.
    fn new(size: usize) -> BoundMatrix {
        let bound = |index: usize| if index.is_multiple_of(size + 1) { EQUAL } else { UNBOUNDED };
        BoundMatrix { size, bounds: (0..size * size).map(bound).collect() }
    }

    fn at(&self, i: usize, j: usize) -> NumericBound {
        self.bounds[i * self.size + j]
    }

    /// The variables of both, which are related by zero only: those of the other one follow.
    fn beside(&self, other: &BoundMatrix) -> BoundMatrix {
        let size = self.size + other.size - 1;
        let bound = |i: usize, j: usize| {
            let own = |index: usize| index < self.size;
            let others = |index: usize| if index == 0 { 0 } else { index + 1 - self.size };
            match (own(i), own(j)) {
                (true, true) => self.at(i, j),
                (true, false) => self.at(i, 0).plus(other.at(0, others(j))),
                (false, true) => other.at(others(i), 0).plus(self.at(0, j)),
                (false, false) => other.at(others(i), others(j)),
            }
        };
        let bounds = (0..size * size).map(|index| bound(index / size, index % size)).collect();
        BoundMatrix { size, bounds }
    }

    fn tighten(&mut self, i: usize, j: usize, bound: NumericBound) {
        let onwards: Vec<(usize, NumericBound)> = (0..self.size)
            .map(|to| (to, self.at(j, to)))
            .filter(|(_, bound)| bound.limit < f64::INFINITY)
            .collect();
        for from in 0..self.size {
            let before = self.at(from, i).plus(bound);
            if before.limit == f64::INFINITY {
                continue;
            }
            let row = &mut self.bounds[from * self.size..][..self.size];
            for (to, after) in &onwards {
                let sum = before.plus(*after);
                if sum.is_tighter(row[*to]) {
                    row[*to] = sum;
                }
            }
        }
    }

    /// Gives a variable a value within its bounds.
    fn fix(&mut self, index: usize, value: f64) {
        for (i, j, limit) in [(index, 0, value), (0, index, -value)] {
            let bound = NumericBound { limit, strict: false };
            let is_consistent = bound.is_consistent_with(self.at(j, i)) == BoundsConsistency::Consistent;
            if is_consistent && bound.is_tighter(self.at(i, j)) {
                self.tighten(i, j, bound);
            }
        }
    }
}

/// A value between two bounds: a whole number if there is one nearby.
fn between((lower, above): (f64, bool), (upper, below): (f64, bool)) -> f64 {
    let fits = |value: f64| {
        (value > lower || value == lower && !above) && (value < upper || value == upper && !below)
    };
    let middle = match (lower.is_finite(), upper.is_finite()) {
        (true, true) => lower + (upper - lower) / 2.0,
        (true, false) => lower + 1.0,
        (false, true) => upper - 1.0,
        (false, false) => 0.0,
    };
    [lower, upper, middle.floor(), middle.ceil()]
        .into_iter()
        .find(|&value| value.is_finite() && fits(value))
        .unwrap_or(middle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_follow_from_each_other() {
        let mut bounds = DifferenceBounds::default();
        assert_eq!(bounds.add(Some("x"), Some("y"), -1.0, false), BoundsConsistency::Consistent);
        assert_eq!(bounds.add(Some("y"), Some("z"), -1.0, true), BoundsConsistency::Consistent);
        assert_eq!(bounds.clone().add(Some("z"), Some("x"), 2.0, false), BoundsConsistency::Contradiction);
        assert_eq!(bounds.add(Some("z"), Some("x"), 2.5, false), BoundsConsistency::Consistent);
        let values = bounds.example();
        let value = |name: &str| values.iter().find(|(it, _)| it == name).unwrap().1;
        assert!(
            value("x") - value("y") <= -1.0
                && value("y") - value("z") < -1.0
                && value("z") - value("x") <= 2.5
        );
    }

    #[test]
    fn variables_that_only_constants_bound_stay_apart_until_a_bound_relates_them() {
        let mut bounds = DifferenceBounds::default();
        let name = |number: usize| format!("x{number}");
        for number in 0..2_000 {
            bounds.add(Some(&name(number)), None, number as f64 + 1.0, true);
            bounds.add(None, Some(&name(number)), -(number as f64), false);
        }
        let sizes = |bounds: &DifferenceBounds| bounds.groups.iter().map(|group| group.size).max();
        assert_eq!(sizes(&bounds), Some(2));
        // x7 is below 8, x9 at least 9.
        let (less, more) = (name(7), name(9));
        let mut impossible = bounds.clone();
        assert_eq!(impossible.add(Some(&more), Some(&less), 1.0, false), BoundsConsistency::Contradiction);
        assert_eq!(bounds.add(Some(&more), Some(&less), 1.5, false), BoundsConsistency::Consistent);
        assert_eq!(sizes(&bounds), Some(3));
        let values = bounds.example();
        let value = |name: &str| values.iter().find(|(it, _)| it == name).unwrap().1;
        assert!(value("x9") >= 9.0 && value("x9") - value("x7") <= 1.5 && value("x7") < 8.0);
        assert_eq!((values.len(), value("x1999")), (2_000, 1999.0));
    }

    #[test]
    fn a_variable_below_all_numbers_has_no_lower_bound() {
        let mut bounds = DifferenceBounds::default();
        assert_eq!(bounds.add(Some("x"), None, f64::NEG_INFINITY, false), BoundsConsistency::Consistent);
        assert_eq!(bounds.add(None, Some("x"), 5.0, false), BoundsConsistency::Contradiction);
    }

    #[test]
    fn results_that_depend_on_rounding_are_undecided() {
        let mut bounds = DifferenceBounds::default();
        bounds.add(Some("x"), Some("y"), 0.1, false);
        bounds.add(Some("y"), Some("z"), 0.2, false);
        assert_eq!(bounds.add(Some("z"), Some("x"), -0.3, false), BoundsConsistency::TooClose);
        assert_eq!(bounds.add(Some("z"), Some("x"), -0.4, false), BoundsConsistency::Contradiction);
    }
}
