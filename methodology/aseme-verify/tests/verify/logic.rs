//! The logic of guards, compared with an exhaustive search of small domains.

use aseme_verify::logic::{Claim, GuardSolver, Satisfiability};
use proptest::prelude::*;
use yase::expression::{Expression, parse_condition};
use yase::statechart::{Constant, ConstantValue};

fn condition(text: &str) -> Expression {
    let (condition, wrong) = parse_condition(text);
    assert!(wrong.is_empty(), "{text}: {wrong:?}");
    condition.unwrap()
}

/// A condition over two numbers, an enumeration and a flag, on a message that has arrived.
#[derive(Clone, Debug)]
enum Guard {
    Number(&'static str, &'static str, i8),
    Difference(&'static str, i8),
    Phase(bool, &'static str),
    Found,
    Not(Box<Guard>),
    And(Vec<Guard>),
    Or(Vec<Guard>),
}

const COMPARISONS: [&str; 6] = ["==", "!=", "<", "<=", ">", ">="];
const PHASES: [&str; 4] = ["READY", "SET", "PLAYING", "FINISHED"];

#[derive(Clone, Copy, Debug)]
struct Valuation {
    x: f64,
    y: f64,
    phase: &'static str,
    found: bool,
}

impl Guard {
    fn text(&self) -> String {
        let join = |parts: &[Guard], word: &str| {
            format!("({})", parts.iter().map(Guard::text).collect::<Vec<_>>().join(word))
        };
        match self {
            Guard::Number(name, comparison, value) => format!("Ball.{name} {comparison} {value}"),
            Guard::Difference(comparison, value) => format!("Ball.x - Ball.y {comparison} {value}"),
            Guard::Phase(true, phase) => format!("Game.phase == {phase}"),
            Guard::Phase(false, phase) => format!("Game.phase != {phase}"),
            Guard::Found => "Ball.found".into(),
            Guard::Not(inner) => format!("!({})", inner.text()),
            Guard::And(parts) => join(parts, " && "),
            Guard::Or(parts) => join(parts, " || "),
        }
    }

    fn holds(&self, valuation: Valuation) -> bool {
        match self {
            Guard::Number("x", comparison, value) => compare(valuation.x, comparison, f64::from(*value)),
            Guard::Number(_, comparison, value) => compare(valuation.y, comparison, f64::from(*value)),
            Guard::Difference(comparison, value) => {
                compare(valuation.x - valuation.y, comparison, f64::from(*value))
            }
            Guard::Phase(same, phase) => (valuation.phase == *phase) == *same,
            Guard::Found => valuation.found,
            Guard::Not(inner) => !inner.holds(valuation),
            Guard::And(parts) => parts.iter().all(|part| part.holds(valuation)),
            Guard::Or(parts) => parts.iter().any(|part| part.holds(valuation)),
        }
    }
}

fn compare(left: f64, comparison: &str, right: f64) -> bool {
    match comparison {
        "==" => left == right,
        "!=" => left != right,
        "<" => left < right,
        "<=" => left <= right,
        ">" => left > right,
        _ => left >= right,
    }
}

fn valuations() -> impl Iterator<Item = Valuation> {
    // quarters are enough for every order of two numbers and their difference relative to integer
    // limits
    let numbers = || (-20..=20).map(|number| f64::from(number) / 4.0);
    numbers().flat_map(move |x| {
        numbers().flat_map(move |y| {
            let phases = PHASES.into_iter();
            phases.flat_map(move |phase| [true, false].map(|found| Valuation { x, y, phase, found }))
        })
    })
}

fn guard() -> impl Strategy<Value = Guard> {
    let comparison = || prop::sample::select(COMPARISONS.to_vec());
    let leaf = prop_oneof![
        (prop::sample::select(vec!["x", "y"]), comparison(), -2_i8..=2)
            .prop_map(|(n, c, v)| Guard::Number(n, c, v)),
        (comparison(), -2_i8..=2).prop_map(|(comparison, value)| Guard::Difference(comparison, value)),
        // the fourth value is in no guard: it represents all other values
        (any::<bool>(), prop::sample::select(PHASES[..3].to_vec()))
            .prop_map(|(same, p)| Guard::Phase(same, p)),
        Just(Guard::Found),
    ];
    leaf.prop_recursive(3, 12, 3, |inner| {
        prop_oneof![
            inner.clone().prop_map(|guard| Guard::Not(Box::new(guard))),
            prop::collection::vec(inner.clone(), 2..4).prop_map(Guard::And),
            prop::collection::vec(inner, 2..4).prop_map(Guard::Or),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, ..ProptestConfig::default() })]

    #[test]
    fn satisfiable_conditions_hold_for_some_values(one in guard(), other in guard()) {
        let (first, second) = (condition(&one.text()), condition(&other.text()));
        let logic = GuardSolver::default();
        let both = valuations().any(|valuation| one.holds(valuation) && other.holds(valuation));
        prop_assert_eq!(logic.together(&[Claim::Holds(&first), Claim::Holds(&second)]).is_yes(), both);
        prop_assert_eq!(logic.together(&[Claim::Holds(&first), Claim::Holds(&second)]).is_no(), !both);
        let follows = valuations().all(|valuation| !one.holds(valuation) || other.holds(valuation));
        prop_assert_eq!(logic.together(&[Claim::Holds(&first), Claim::IsFalse(&second)]).is_no(), follows);
    }
}

fn holds(texts: &[&str]) -> Satisfiability {
    let constants = [Constant { name: "near".into(), value: ConstantValue::Number(0.25) }];
    let conditions: Vec<Expression> = texts.iter().map(|text| condition(text)).collect();
    let claims: Vec<Claim<'_>> = conditions.iter().map(Claim::Holds).collect();
    GuardSolver::new(&constants).together(&claims)
}

#[test]
fn opaque_terms_are_unknown_unless_equal_texts_decide() {
    assert_eq!(holds(&["seen(Ball.x)"]), Satisfiability::Unknown);
    assert_eq!(holds(&["seen(Ball.x) && !seen(Ball.x)"]), Satisfiability::No);
    assert_eq!(holds(&["abs(Ball.x) > 2", "abs(Ball.x) <= 2"]), Satisfiability::No);
    assert_eq!(holds(&["Ball.x * Ball.y > 2", "Ball.x * Ball.y < 1"]), Satisfiability::No);
    assert_eq!(holds(&["Ball.x + Ball.y > 2", "2 * Ball.x + 2 * Ball.y < 4"]), Satisfiability::No);
    assert_eq!(holds(&["In(walk)"]), Satisfiability::Unknown);
}

#[test]
fn abs_min_and_max_are_one_of_their_operands() {
    assert_eq!(holds(&["abs(Ball.x) < 0 - 1"]), Satisfiability::No);
    let Satisfiability::Yes(gap) = holds(&["!(abs(Ball.x) > 1)", "!(abs(Ball.x) < 1)"]) else { panic!() };
    assert!(["`Ball.x` is 1", "`Ball.x` is -1"].contains(&gap.to_string().as_str()), "{gap}");
    assert_eq!(holds(&["abs(Ball.x - 3) < 1", "Ball.x > 4"]), Satisfiability::No);
    assert!(holds(&["abs(abs(Ball.y) - 2) <= 1", "Ball.y < 0"]).is_yes());
    assert_eq!(holds(&["abs(abs(Ball.y) - 2) <= 1", "Ball.y > 3"]), Satisfiability::No);
    assert_eq!(holds(&["min(Ball.x, Ball.y) > 2", "Ball.y <= 2"]), Satisfiability::No);
    assert!(holds(&["max(Ball.x, Ball.y) > 2", "Ball.y <= 2"]).is_yes());
    assert_eq!(holds(&["max(Ball.x, 1) < 1"]), Satisfiability::No);
    let (far, near) = (condition("abs(Ball.x) > 1"), condition("abs(Ball.x) <= 1"));
    let logic = GuardSolver::default();
    let neither = [Claim::DoesNotHold(&far), Claim::DoesNotHold(&near)];
    assert!(logic.together(&neither).is_yes(), "the ball may be missing");
    assert_eq!(logic.together(&[Claim::IsFalse(&far), Claim::IsFalse(&near)]), Satisfiability::No);
}

#[test]
fn constants_arithmetic_and_spellings_are_understood() {
    assert_eq!(holds(&["Ball.distance < near", "Ball.distance >= 0.25"]), Satisfiability::No);
    assert_eq!(holds(&["2 * Ball.x - 1 > 3", "Ball.x < 2"]), Satisfiability::No);
    assert_eq!(holds(&["Ball.x - near > Ball.y", "Ball.x < Ball.y"]), Satisfiability::No);
    assert_eq!(holds(&["Ball.found == true", "not Ball.found"]), Satisfiability::No);
    assert_eq!(holds(&["Team.colour == \"red\"", "Team.colour == \"blue\""]), Satisfiability::No);
    assert!(holds(&["Ball.x / 2 < 1", "Ball.x > 1"]).is_yes());
}

#[test]
fn a_message_that_is_missing_has_no_fields() {
    assert_eq!(holds(&["Ball == NULL", "Ball.found"]), Satisfiability::No);
    assert_eq!(holds(&["Ball == NULL || Ball.x > 2", "Ball.x < 1"]), Satisfiability::No);
    assert!(holds(&["Ball != NULL", "Ball.found"]).is_yes());
    let (one, other) = (condition("Ball.found"), condition("Ball.found || Game.over"));
    let logic = GuardSolver::default();
    assert!(logic.implies(&one, &other));
    assert!(!logic.implies(&other, &one));
    let (either, neither) = (condition("Ball.found || !Ball.found"), condition("Game.over"));
    assert!(!logic.implies(&neither, &either), "the ball may be missing");
}

#[test]
fn a_timer_that_is_over_is_over_in_both_forms() {
    assert_eq!(holds(&["TimeoutCheck(look)", "!look"]), Satisfiability::No);
    assert!(holds(&["look", "!TimeoutCheck(look)"]).is_yes(), "it was never started");
}

#[test]
fn too_many_alternatives_are_not_judged() {
    let alternatives: Vec<String> =
        (0..40).map(|number| format!("(Ball.a{number} == 1 || Ball.a{number} == 2)")).collect();
    let conflict = format!(
        "{} && Ball.z < 1 && Ball.y > 1 && (Ball.z > Ball.y || Ball.z == Ball.y)",
        alternatives.join(" && ")
    );
    assert!(!holds(&[&conflict]).is_yes());
    let deep =
        (0..3_000).map(|number| format!("(a.b{number} || a.c{number})")).collect::<Vec<_>>().join(" && ");
    assert_eq!(holds(&[&deep]), Satisfiability::Unknown);
}
