//! Difference-bound matrices in canonical (tightest) form.

/// An upper bound, possibly strict.
#[derive(Clone, Copy, PartialEq, Debug)]
struct NumericBound {
    limit: f64,
    strict: bool,
}

const NONE: NumericBound = NumericBound { limit: f64::INFINITY, strict: true };
const SAME: NumericBound = NumericBound { limit: 0.0, strict: false };

/// Sums of limits that differ by less than this may be equal up to rounding.
const ROUNDING: f64 = 1e-9;

impl NumericBound {
    fn plus(self, other: NumericBound) -> NumericBound {
        NumericBound { limit: self.limit + other.limit, strict: self.strict || other.strict }
    }

    fn is_tighter(self, other: NumericBound) -> bool {
        self.limit < other.limit || self.limit == other.limit && self.strict && !other.strict
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

/// A matrix of difference bounds; the first variable is zero.
#[derive(Clone, Debug)]
pub(crate) struct DifferenceBounds {
    names: Vec<String>,
    /// `at[i][j]` bounds variable i minus variable j.
    at: Vec<Vec<NumericBound>>,
}

impl DifferenceBounds {
    pub(crate) fn new() -> DifferenceBounds {
        DifferenceBounds { names: vec![String::new()], at: vec![vec![SAME]] }
    }

    fn index(&mut self, name: Option<&str>) -> usize {
        let Some(name) = name else { return 0 };
        if let Some(index) = self.names.iter().skip(1).position(|it| it == name) {
            return index + 1;
        }
        self.names.push(name.to_owned());
        self.at.iter_mut().for_each(|row| row.push(NONE));
        let mut row = vec![NONE; self.names.len()];
        if let Some(own) = row.last_mut() {
            *own = SAME;
        }
        self.at.push(row);
        self.names.len() - 1
    }

    /// Adds an upper bound on the difference of two variables.
    pub(crate) fn add(
        &mut self,
        more: Option<&str>,
        less: Option<&str>,
        limit: f64,
        strict: bool,
    ) -> BoundsConsistency {
        let (i, j) = (self.index(more), self.index(less));
        let bound = NumericBound { limit, strict };
        let around = bound.plus(self.at[j][i]);
        if around.limit < 0.0 || around.limit == 0.0 && around.strict {
            let exact = around.limit == 0.0 || around.limit < -ROUNDING * (1.0 + limit.abs());
            return if exact { BoundsConsistency::Contradiction } else { BoundsConsistency::TooClose };
        }
        if around.limit != 0.0 && around.limit < ROUNDING * (1.0 + limit.abs()) {
            return BoundsConsistency::TooClose;
        }
        if bound.is_tighter(self.at[i][j]) {
            self.tighten(i, j, bound);
        }
        BoundsConsistency::Consistent
    }

    fn tighten(&mut self, i: usize, j: usize, bound: NumericBound) {
        for from in 0..self.at.len() {
            for to in 0..self.at.len() {
                let way = self.at[from][i].plus(bound).plus(self.at[j][to]);
                if way.is_tighter(self.at[from][to]) {
                    self.at[from][to] = way;
                }
            }
        }
    }

    /// Values within the bounds, ordered by name.
    pub(crate) fn example(mut self) -> Vec<(String, f64)> {
        let mut values = Vec::new();
        for index in 1..self.names.len() {
            let (upper, lower) = (self.at[index][0], self.at[0][index]);
            let value = between((-lower.limit, lower.strict), (upper.limit, upper.strict));
            let name = self.names[index].clone();
            self.add(Some(&name), None, value, false);
            self.add(None, Some(&name), -value, false);
            values.push((name, value));
        }
        values
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
        let mut bounds = DifferenceBounds::new();
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
    fn results_that_depend_on_rounding_are_undecided() {
        let mut bounds = DifferenceBounds::new();
        bounds.add(Some("x"), Some("y"), 0.1, false);
        bounds.add(Some("y"), Some("z"), 0.2, false);
        assert_eq!(bounds.add(Some("z"), Some("x"), -0.3, false), BoundsConsistency::TooClose);
        assert_eq!(bounds.add(Some("z"), Some("x"), -0.4, false), BoundsConsistency::Contradiction);
    }
}
