//! Many cases, one after the other.

use std::ops::Range;

use crate::oracle::compare::{Verdict, describe, judge};
use crate::oracle::histogram::Histogram;
use crate::oracle::random::Case;
use crate::oracle::shrink::shrink;

/// What came of them.
#[derive(Default)]
pub(crate) struct Found {
    pub histogram: Histogram,
    /// The first difference, made small.
    pub difference: Option<String>,
    /// Charts that the compiler did not accept, and why.
    pub refused: Vec<String>,
}

impl Found {
    pub(crate) fn join(&mut self, other: Found) {
        self.histogram.join(&other.histogram);
        self.refused.extend(other.refused);
        self.difference = self.difference.take().or(other.difference);
    }
}

/// Plays the cases of these numbers, until the first that differs.
pub(crate) fn compare(numbers: Range<u64>) -> Found {
    let mut found = Found::default();
    for number in numbers {
        let case = Case::numbered(number);
        match judge(&case) {
            Verdict::Same(lines) => found.histogram.count(&case, &lines),
            Verdict::Refused(why) => found.refused.push(format!("case {number}: {why}")),
            Verdict::Different(_) => {
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
        Verdict::Different(difference) => describe(&small, &difference),
        _ => "it differs no more".to_owned(),
    }
}
