//! Each tree has one text, and the text parses to the tree.

use std::time::Duration;

use proptest::prelude::*;

use crate::{
    Action, ActionKind, Additive, Comparison, Expression, ExpressionKind, Multiplicative, Name, Path,
    TextPosition, TimeoutForm, TransitionExpression, Trigger, parse_transition,
};

#[track_caller]
fn check(text: &str, printed: &str) {
    let (expression, diagnostics) = parse_transition(text);
    assert_eq!(diagnostics, []);
    assert_eq!(expression.to_string(), printed);
}

#[test]
fn the_canonical_text() {
    check("", "");
    check("a or b", "a | b");
    check("!e", "not e");
    check("*", "*");
    check("e[a and not b or c gt 1]/publish_all,M.f=1", "e [a && !b || c > 1] / publish_all; M.f = 1");
    check("/process_messages", "/ process_messages");
    check("[TRUE]", "[true]");
    check("[t.State.M.f()==\"a\"]", "[t.State.M.f == \"a\"]");
    check("[NULL!=M]", "[M != NULL]");
    check("[f( a,b )]", "[f(a, b)]");
    check("[In( a / (b|c)ω )]", "[In(a/(b|c)~)]");
    check("[1.50 < 2e0]", "[1.5 < 2.0]");
}

#[test]
fn parentheses_stand_where_they_are_needed() {
    check("[((a))]", "[a]");
    check("[(a || b) && c]", "[(a || b) && c]");
    check("[a || (b && c)]", "[a || b && c]");
    check("[(a || b) || c]", "[(a || b) || c]");
    check("[!(a == b)]", "[!(a == b)]");
    check("[!(a)]", "[!a]");
    check("[a - (b - c) > (d + e) * -(f)]", "[a - (b - c) > (d + e) * -f]");
    check("[(a == b) == c]", "[(a == b) == c]");
    check("[!(M == NULL)]", "[!(M == NULL)]");
}

#[test]
fn timeouts_keep_their_form() {
    check("[v]/StartTimeout(v,1.5s)", "[v] / StartTimeout(v, 1500ms)");
    check("[TimeoutCheck(v)]/TimeoutAction.v.100", "[TimeoutCheck(v)] / TimeoutAction.v.100");
    check("/StartTimeout(v, 1.25ms)", "/ StartTimeout(v, 1.25ms)");
}

#[test]
fn backquotes_stand_where_a_name_needs_them() {
    check("[`soccer.ball`.State.`Ball`.x > 1]", "[`soccer.ball`.State.Ball.x > 1]");
    check("[`not` == `In`(`2nd`)]", "[`not` == `In`(`2nd`)]");
    check("/raise(`null`)", "/ raise(`null`)");
    check("`null`", "`null`");
    check("[soccer::near(`a::`)]", "[soccer::near(`a::`)]");
}

#[test]
fn texts_are_escaped() {
    check(r#"[a == "\"\\\n\t\r'é"]"#, r#"[a == "\"\\\n\t\r'é"]"#);
}

fn name() -> impl Strategy<Value = Name> {
    let text = prop_oneof![
        8 => "[A-Za-z_][A-Za-z0-9_]{0,6}",
        1 => "[a-z]{1,4}[./ ][a-z]{1,4}",
        1 => "[0-9]{1,3}[a-z]{0,2}",
        1 => prop::sample::select(vec!["and", "NULL", "null", "true", "In", "raise", "publish", "set_x", "State", "a::b"])
            .prop_map(String::from),
    ];
    text.prop_map(|text| Name { text, position: TextPosition::default() })
}

fn path() -> impl Strategy<Value = Path> {
    prop::collection::vec(name(), 1..5)
        .prop_map(|segments| Path { segments, position: TextPosition::default() })
}

fn state() -> impl Strategy<Value = Name> {
    let text = prop::sample::select(vec!["stand", "play/(a|b)~", "[x].y*/START", "|x~|2"]);
    text.prop_map(|text| Name { text: text.into(), position: TextPosition::default() })
}

fn comparison() -> impl Strategy<Value = Comparison> {
    prop::sample::select(Comparison::ALL.to_vec())
}

fn leaf() -> impl Strategy<Value = ExpressionKind> {
    prop_oneof![
        any::<bool>().prop_map(ExpressionKind::Bool),
        any::<u64>().prop_map(ExpressionKind::Integer),
        prop::num::f64::POSITIVE
            .prop_filter("finite", |number| number.is_finite())
            .prop_map(ExpressionKind::Decimal),
        any::<String>().prop_map(ExpressionKind::Text),
        path().prop_map(ExpressionKind::Variable),
        path().prop_map(ExpressionKind::Absent),
        path().prop_map(ExpressionKind::Present),
        path().prop_map(ExpressionKind::TimeoutCheck),
        state().prop_map(ExpressionKind::In),
    ]
}

fn expression() -> impl Strategy<Value = Expression> {
    let placed = |kind| Expression { kind, position: TextPosition::default() };
    leaf().prop_map(placed).prop_recursive(6, 40, 4, move |inner| {
        let boxed = inner.clone().prop_map(Box::new);
        let several = prop::collection::vec(inner.clone(), 2..4);
        let additive = prop::sample::select(vec![Additive::Plus, Additive::Minus]);
        let multiplicative = prop::sample::select(vec![Multiplicative::Times, Multiplicative::Over]);
        prop_oneof![
            several.clone().prop_map(ExpressionKind::Or),
            several.prop_map(ExpressionKind::And),
            boxed.clone().prop_map(ExpressionKind::Not),
            boxed.clone().prop_map(ExpressionKind::Negative),
            (boxed.clone(), comparison(), boxed.clone())
                .prop_map(|(a, op, b)| ExpressionKind::Compare(a, op, b)),
            (boxed.clone(), prop::collection::vec((additive, inner.clone()), 1..3))
                .prop_map(|(first, rest)| ExpressionKind::Sum(first, rest)),
            (boxed, prop::collection::vec((multiplicative, inner.clone()), 1..3))
                .prop_map(|(first, rest)| ExpressionKind::Product(first, rest)),
            (name(), prop::collection::vec(inner, 0..3))
                .prop_map(|(name, list)| ExpressionKind::Call(name, list)),
        ]
        .prop_map(placed)
    })
}

fn action() -> impl Strategy<Value = Action> {
    let form = prop::sample::select(vec![TimeoutForm::StartTimeout, TimeoutForm::TimeoutAction]);
    let delay = prop_oneof![
        (0..10_000_u64).prop_map(Duration::from_millis),
        any::<u64>().prop_map(Duration::from_nanos),
    ];
    let kind = prop_oneof![
        (path(), expression()).prop_map(|(target, value)| ActionKind::Assign { target, value }),
        path().prop_map(ActionKind::Publish),
        Just(ActionKind::ProcessMessages),
        Just(ActionKind::PublishAll),
        (path(), delay, form).prop_map(|(timer, delay, form)| ActionKind::StartTimeout {
            timer,
            delay,
            form
        }),
        path().prop_map(ActionKind::Raise),
    ];
    kind.prop_map(|kind| Action { kind, position: TextPosition::default() })
}

fn transition() -> impl Strategy<Value = TransitionExpression> {
    let trigger = prop_oneof![
        Just(Trigger::Any),
        prop::collection::vec(path(), 1..4).prop_map(Trigger::OneOf),
        path().prop_map(Trigger::Not),
    ];
    (prop::option::of(trigger), prop::option::of(expression()), prop::collection::vec(action(), 0..4))
        .prop_map(|(trigger, guard, actions)| TransitionExpression { trigger, guard, actions })
}

proptest! {
    #[test]
    fn printed_trees_parse_to_the_same_tree(expression in transition()) {
        let text = expression.to_string();
        let (read, diagnostics) = parse_transition(&text);
        prop_assert_eq!(diagnostics, vec![], "{}", text);
        prop_assert_eq!(&read, &expression, "{}", text);
        prop_assert_eq!(read.to_string(), text);
    }
}
