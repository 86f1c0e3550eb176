//! Names as encoded by the model files of the thesis's tools.
//!
//! A chart keeps the names of its states as written in the formula (`decision~`). Model files
//! encode them into letters (`decision_forever_`) and use the label for a node without a name. Both
//! are computed when a chart is written.

use yase::{Node, Statechart, Transition};

/// The spelling of each operator in an encoded name, in the order of replacement.
const ENCODING: [(&str, &str); 10] = [
    ("||", "_parallel_"),
    ("~", "_forever_"),
    (".", "_sequence_"),
    ("|", "_or_"),
    ("*", "_zero_or_more_times_"),
    ("+", "_one_or_more_times_"),
    ("(", "_open_group_"),
    (")", "_close_group_"),
    ("[", "_open_option_"),
    ("]", "_close_option_"),
];

/// The encoded text of a term: `(a.b)+` is
/// `_open_group_a_sequence_b_close_group__one_or_more_times_`.
pub fn encode(term: &str) -> String {
    let mut rest = term;
    let mut encoded = String::with_capacity(term.len());
    while let Some(character) = rest.chars().next() {
        let operator = ENCODING.iter().find(|(operator, _)| rest.starts_with(operator));
        match operator {
            Some((operator, word)) => {
                encoded.push_str(word);
                rest = &rest[operator.len()..];
            }
            None => {
                encoded.push(character);
                rest = &rest[character.len_utf8()..];
            }
        }
    }
    encoded
}

/// The term of an encoded name. `None` if the name contains no operators or is not an output of
/// [`encode`].
pub fn decode(name: &str) -> Option<String> {
    let mut rest = name;
    let mut term = String::with_capacity(name.len());
    while let Some(character) = rest.chars().next() {
        let operator = ENCODING.iter().find(|(_, word)| rest.starts_with(word));
        match operator {
            Some((operator, word)) => {
                term.push_str(operator);
                rest = &rest[word.len()..];
            }
            None => {
                term.push(character);
                rest = &rest[character.len_utf8()..];
            }
        }
    }
    let (formula, findings) = crate::liveness::parse(&format!("x = {term}"));
    let whole = formula.formulas().first().and_then(|formula| formula.expression);
    let is_same = findings.iter().all(|finding| !finding.is_error())
        && whole.map(|whole| formula.compact(whole)).as_deref() == Some(&term);
    (is_same && term != name && encode(&term) == name).then_some(term)
}

/// The encoded name of each node, by its id; a node without a name has its label.
pub fn names(chart: &Statechart) -> Vec<String> {
    let name = |(node, label): (&Node, String)| if node.name.is_empty() { label } else { encode(&node.name) };
    chart.nodes().map(|(_, node)| node).zip(chart.labels()).map(name).collect()
}

/// `source TO target` without blanks, of encoded names.
pub fn transition_name(transition: &Transition, names: &[String]) -> String {
    format!("{}TO{}", names[transition.source.0 as usize], names[transition.target.0 as usize])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operators_are_spelled_out() {
        assert_eq!(
            encode("([I]|R)+"),
            "_open_group__open_option_I_close_option__or_R_close_group__one_or_more_times_"
        );
        assert_eq!(encode("a||b*"), "a_parallel_b_zero_or_more_times_");
        assert_eq!(encode("|a~|3"), "_or_a_forever__or_3");
        assert_eq!(encode("kickBall"), "kickBall");
    }

    #[test]
    fn encoding_and_decoding_round_trips() {
        for term in ["([I]|R)+", "a||b*", "|a~|3", "(a.b)~", "[Stare+]"] {
            assert_eq!(decode(&encode(term)).as_deref(), Some(term));
        }
        for name in ["kickBall", "_or_", "a_open_group_b", "0.1", ""] {
            assert_eq!(decode(name), None, "{name}");
        }
    }
}
