//! Comparison of many cases.

use std::ops::Range;

use crate::compare::{CaseResult, describe, judge};
use crate::histogram::Histogram;
use crate::random::Case;
use crate::shrink::shrink;

/// The results.
#[derive(Default)]
pub struct Found {
    /// The histogram of the charts.
    pub histogram: Histogram,
    /// The first difference, shrunk.
    pub difference: Option<String>,
    /// Charts that the compiler rejected, with the reasons.
    pub refused: Vec<String>,
}

impl Found {
    /// Adds the results of other charts.
    pub fn join(&mut self, other: Found) {
        self.histogram.join(&other.histogram);
        self.refused.extend(other.refused);
        self.difference = self.difference.take().or(other.difference);
    }
}

/// Plays the cases with these numbers, up to the first difference.
pub fn compare(numbers: Range<u64>) -> Found {
    let mut found = Found::default();
    for number in numbers {
        let case = Case::numbered(number);
        match judge(&case) {
            CaseResult::Same(lines) => found.histogram.count(&case, &lines),
            CaseResult::Refused(why) => found.refused.push(format!("case {number}: {why}")),
            CaseResult::Different(_) => {
                found.difference = Some(format!("case {number}\n{}", smallest(&case)));
                return found;
            }
        }
    }
    found
}

fn smallest(case: &Case) -> String {
    let small = shrink(case);
    match judge(&small) {
        CaseResult::Different(difference) => describe(&small, &difference),
        _ => "it differs no more".to_owned(),
    }
}
