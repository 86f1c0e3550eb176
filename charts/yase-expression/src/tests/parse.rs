//! Parsing of all forms.

use std::time::Duration;

use proptest::prelude::*;

use super::test_context::said;
use crate::diagnostic::Span;
use crate::{
    Action, ActionKind, Additive, Comparison, Expression, ExpressionKind, Multiplicative, Name, Path,
    TextPosition, TimeoutForm, TransitionExpression, Trigger, parse_actions, parse_actions_at,
    parse_condition, parse_transition, parse_transition_at,
};

fn path(text: &str) -> Path {
    let name = |text: &str| Name { text: text.into(), position: TextPosition::default() };
    Path { segments: text.split('.').map(name).collect(), position: TextPosition::default() }
}

fn expression(kind: ExpressionKind) -> Expression {
    Expression { kind, position: TextPosition::default() }
}

fn variable(text: &str) -> Expression {
    expression(ExpressionKind::Variable(path(text)))
}

fn integer(value: u64) -> Expression {
    expression(ExpressionKind::Integer(value))
}

fn transition(text: &str) -> TransitionExpression {
    let (expression, diagnostics) = parse_transition(text);
    assert_eq!(diagnostics, [], "{text}");
    expression
}

fn condition(text: &str) -> Expression {
    let (condition, diagnostics) = parse_condition(text);
    assert_eq!(diagnostics, [], "{text}");
    condition.expect("a condition")
}

fn kind(text: &str) -> ExpressionKind {
    condition(text).kind
}

fn action(text: &str) -> ActionKind {
    let (mut actions, diagnostics) = parse_actions(text);
    assert_eq!(diagnostics, [], "{text}");
    assert_eq!(actions.len(), 1, "{text}");
    actions.remove(0).kind
}

fn compare(left: Expression, comparison: Comparison, right: Expression) -> Expression {
    expression(ExpressionKind::Compare(Box::new(left), comparison, Box::new(right)))
}

fn not(operand: Expression) -> Expression {
    expression(ExpressionKind::Not(Box::new(operand)))
}

#[test]
fn nothing_is_the_empty_expression() {
    for text in ["", "  \n ", "null", " null\n"] {
        assert_eq!(transition(text), TransitionExpression::default());
        assert_eq!(parse_actions(text), (vec![], vec![]));
    }
    assert!(transition("").is_empty());
    assert!(!transition("e").is_empty());
}

#[test]
fn each_part_is_valid_alone_or_with_the_others() {
    let trigger = Some(Trigger::OneOf(vec![path("e")]));
    let guard = Some(variable("g"));
    let actions = vec![Action { kind: ActionKind::PublishAll, position: TextPosition::default() }];
    for (text, parts) in [
        ("e", (true, false, false)),
        ("[g]", (false, true, false)),
        ("/publish_all", (false, false, true)),
        ("e[g]", (true, true, false)),
        ("e/publish_all", (true, false, true)),
        ("[g]/publish_all", (false, true, true)),
        (" e [ g\n] / publish_all ", (true, true, true)),
    ] {
        let expected = TransitionExpression {
            trigger: trigger.clone().filter(|_| parts.0),
            guard: guard.clone().filter(|_| parts.1),
            actions: if parts.2 { actions.clone() } else { vec![] },
        };
        assert_eq!(transition(text), expected, "{text}");
    }
}

#[test]
fn triggers() {
    let trigger = |text: &str| transition(text).trigger.expect("a trigger");
    assert_eq!(trigger("*"), Trigger::Any);
    assert_eq!(trigger("*[x]"), Trigger::Any);
    let both = Trigger::OneOf(vec![path("a"), path("b.c")]);
    for text in ["a | b.c", "a || b.c", "a or b.c", "`a`|b.c[true]"] {
        assert_eq!(trigger(text), both, "{text}");
    }
    for text in ["not a", "!a", "not(a)", "! ( a )"] {
        assert_eq!(trigger(text), Trigger::Not(path("a")), "{text}");
    }
    assert_eq!(trigger("Message.Kick"), Trigger::OneOf(vec![path("Message.Kick")]));
}

#[test]
fn operands() {
    assert_eq!(kind("true"), ExpressionKind::Bool(true));
    assert_eq!(kind("TRUE"), ExpressionKind::Bool(true));
    assert_eq!(kind("FALSE"), ExpressionKind::Bool(false));
    assert_eq!(kind("18446744073709551615"), ExpressionKind::Integer(u64::MAX));
    assert_eq!(kind("0.25"), ExpressionKind::Decimal(0.25));
    assert_eq!(kind("2e3"), ExpressionKind::Decimal(2000.0));
    assert_eq!(kind(r#""a \"b\" \\ \n\r\t é""#), ExpressionKind::Text("a \"b\" \\ \n\r\t é".into()));
    assert_eq!(kind("ball_found"), ExpressionKind::Variable(path("ball_found")));
    assert_eq!(kind("Ball.distance"), ExpressionKind::Variable(path("Ball.distance")));
    assert_eq!(kind("host.t.State.M.f"), ExpressionKind::Variable(path("host.t.State.M.f")));
    assert_eq!(kind("t.State.M.f().g()"), ExpressionKind::Variable(path("t.State.M.f.g")));
    assert_eq!(kind("TimeoutCheck(robot.period)"), ExpressionKind::TimeoutCheck(path("robot.period")));
    assert_eq!(kind("TimeoutCheck"), ExpressionKind::Variable(path("TimeoutCheck")));
}

#[test]
fn a_name_in_backquotes_is_one_segment_whatever_it_holds() {
    let ExpressionKind::Variable(path) = kind("`soccer.ball`.State.`not`") else { panic!("a variable") };
    let segments: Vec<_> = path.segments.iter().map(|name| name.text.as_str()).collect();
    assert_eq!(segments, ["soccer.ball", "State", "not"]);
    assert_eq!(path.bare(), None);
    assert_eq!(path.text(), "soccer.ball.State.not");
}

#[test]
fn calls_take_operands_and_messages() {
    let call = |text: &str| match kind(text) {
        ExpressionKind::Call(function, arguments) => (function.text, arguments),
        other => panic!("{other:?}"),
    };
    assert_eq!(call("f()"), ("f".into(), vec![]));
    assert_eq!(call("f(w.Data.W, 3)"), ("f".into(), vec![variable("w.Data.W"), integer(3)]));
    assert_eq!(call("ns::f(x)"), ("ns::f".into(), vec![variable("x")]));
    assert_eq!(call("f(g(x))"), ("f".into(), vec![condition("g(x)")]));
    assert_eq!(call("f(a && b)"), ("f".into(), vec![condition("a and b")]));
}

#[test]
fn a_state_is_everything_up_to_its_parenthesis() {
    for (text, state) in
        [("In(stand)", "stand"), ("In( play / (a|b)ω )", "play/(a|b)~"), ("In([x].|y~|2)", "[x].|y~|2")]
    {
        let ExpressionKind::In(name) = kind(text) else { panic!("{text}") };
        assert_eq!(name.text, state);
    }
    assert_eq!(kind("In((a))").clone(), kind("In( (a) )"));
}

#[test]
fn absence_is_written_either_way_round() {
    let absent = ExpressionKind::Absent(path("a.State.M"));
    for text in ["a.State.M == NULL", "NULL==a.State.M", "a.State.M eq null", "(a.State.M) == nullptr"] {
        assert_eq!(kind(text), absent, "{text}");
    }
    assert_eq!(kind("M != NULL"), ExpressionKind::Present(path("M")));
    assert_eq!(kind("NULL ne M"), ExpressionKind::Present(path("M")));
}

#[test]
fn signs_bind_tighter_than_comparison_than_and_than_or() {
    let (a, b, c) = (variable("a"), variable("b"), variable("c"));
    let and = expression(ExpressionKind::And(vec![b.clone(), c.clone()]));
    assert_eq!(condition("a || b && c"), expression(ExpressionKind::Or(vec![a.clone(), and])));
    assert_eq!(condition("!a == b"), compare(not(a.clone()), Comparison::Equal, b.clone()));
    assert_eq!(condition("not (a == b)"), not(compare(a.clone(), Comparison::Equal, b.clone())));
    let sum = expression(ExpressionKind::Sum(Box::new(a.clone()), vec![(Additive::Plus, b.clone())]));
    assert_eq!(condition("a + b < c"), compare(sum.clone(), Comparison::Less, c.clone()));
    let product = ExpressionKind::Product(Box::new(sum), vec![(Multiplicative::Times, c.clone())]);
    assert_eq!(kind("(a + b) * c"), product);
    let product = expression(ExpressionKind::Product(Box::new(b), vec![(Multiplicative::Over, c)]));
    let rest = vec![(Additive::Minus, product), (Additive::Plus, integer(1))];
    assert_eq!(kind("a - b / c + 1"), ExpressionKind::Sum(Box::new(a), rest));
    let negative = expression(ExpressionKind::Negative(Box::new(integer(1))));
    assert_eq!(kind("--1"), ExpressionKind::Negative(Box::new(negative)));
}

#[test]
fn two_spellings_are_one_tree() {
    for (one, other) in [
        ("a and b", "a && b"),
        ("a or b", "a||b"),
        ("not a", "!a"),
        ("not(a)", "! a"),
        ("a lt 1", "a < 1"),
        ("a le 1", "a <= 1"),
        ("a gt 1", "a > 1"),
        ("a ge 1", "a >= 1"),
        ("a eq 1", "a == 1"),
        ("a ne 1", "a != 1"),
        ("a\n&&\nb", "((a) && (b))"),
        ("M.f()", "M.f"),
        ("`a`", "a"),
    ] {
        assert_eq!(condition(one), condition(other));
    }
    assert_ne!(condition("(a || b) || c"), condition("a || b || c"));
}

#[test]
fn actions() {
    let assign = |target: &str, value| ActionKind::Assign { target: path(target), value };
    assert_eq!(action("M.f = 1"), assign("M.f", integer(1)));
    assert_eq!(action("M.f = a && b"), assign("M.f", condition("a && b")));
    assert_eq!(action("t.State.M.set_f(g(1))"), assign("t.State.M.f", condition("g(1)")));
    assert_eq!(action("process_messages"), ActionKind::ProcessMessages);
    assert_eq!(action("publish_all"), ActionKind::PublishAll);
    for text in ["publish.t.State.M", "publish t.State.M"] {
        assert_eq!(action(text), ActionKind::Publish(path("t.State.M")), "{text}");
    }
    assert_eq!(action("raise(a.b)"), ActionKind::Raise(path("a.b")));
}

#[test]
fn timeouts_keep_their_form() {
    let start = |timer, nanoseconds, form| ActionKind::StartTimeout {
        timer: path(timer),
        delay: Duration::from_nanos(nanoseconds),
        form,
    };
    for (text, delay) in [
        ("StartTimeout(v, 100ms)", 100_000_000),
        ("StartTimeout ( v , 100 ms )", 100_000_000),
        ("StartTimeout(v, 1.5s)", 1_500_000_000),
        ("StartTimeout(v, 2s)", 2_000_000_000),
        ("StartTimeout(v, 0.25ms)", 250_000),
    ] {
        assert_eq!(action(text), start("v", delay, TimeoutForm::StartTimeout), "{text}");
    }
    assert_eq!(action("StartTimeout(a.b, 0ms)"), start("a.b", 0, TimeoutForm::StartTimeout));
    assert_eq!(action("TimeoutAction.v.250"), start("v", 250_000_000, TimeoutForm::TimeoutAction));
    assert_eq!(action("TimeoutAction.a.b.0.5"), start("a.b", 500_000, TimeoutForm::TimeoutAction));
    let timers: Vec<_> =
        transition("e/TimeoutAction.v.1; publish_all, StartTimeout(a.b, 1s)").started_timers().collect();
    assert_eq!(timers, ["v", "a.b"]);
}

#[test]
fn actions_are_separated_by_commas_or_semicolons() {
    let (actions, diagnostics) = parse_actions("publish_all; process_messages,M.f=f(1,2);");
    assert_eq!((actions.len(), diagnostics), (3, vec![]));
}

#[test]
fn publishing_with_a_setter_is_two_actions() {
    let (one, diagnostics) = parse_actions("publish.t.State.M.set_f(1)");
    assert_eq!(diagnostics, []);
    assert_eq!(one, parse_actions("t.State.M.f = 1; publish.t.State.M").0);
}

#[test]
fn a_slash_in_the_guard_divides_and_a_bracket_in_a_text_closes_nothing() {
    let expression = transition("[a / 2 > 1 && b == \"]/\"] / publish_all");
    assert_eq!(expression.guard, Some(condition("a / 2 > 1 && b == \"]/\"")));
    assert_eq!(expression.actions.len(), 1);
}

#[test]
fn only_the_word_false_is_never() {
    assert!(transition("[false]").is_never());
    assert!(transition("e [(FALSE)]/publish_all").is_never());
    assert!(!transition("[true]").is_never());
    assert!(!transition("[!true]").is_never());
    assert!(!transition("e").is_never());
}

#[test]
fn places_are_bytes_of_the_larger_text() {
    let larger = "héading: [Ball.distance > 1] / M.f = 2";
    let offset = larger.find('[').unwrap();
    let under = |span: Span| &larger[span.start..span.end];
    let (expression, diagnostics) = parse_transition_at(&larger[offset..], offset);
    assert_eq!(diagnostics, []);
    let guard = expression.guard.unwrap();
    assert_eq!(under(guard.span()), "Ball.distance > 1");
    let ExpressionKind::Compare(left, _, right) = &guard.kind else { panic!("a comparison") };
    assert_eq!((under(left.span()), under(right.span())), ("Ball.distance", "1"));
    let ExpressionKind::Variable(path) = &left.kind else { panic!("a variable") };
    assert_eq!(under(path.segments[1].position.0), "distance");
    assert_eq!(under(expression.actions[0].position.0), "M.f = 2");

    let wrong = "entry = M.get_f(1)";
    let (_, diagnostics) = parse_actions_at(&wrong[8..], 8);
    assert_eq!(said(wrong, &diagnostics).len(), 1);
    assert_eq!(&wrong[diagnostics[0].span.start..diagnostics[0].span.end], "M.get_f");
}

#[test]
fn valid_parts_are_kept_beside_rejected_ones() {
    let (expression, diagnostics) = parse_transition("a, b [c d] / M.f = ; publish_all; x, process_messages");
    let codes: Vec<_> = diagnostics.iter().map(|diagnostic| diagnostic.code).collect();
    assert_eq!(codes, ["E0116", "E0107", "E0106", "E0118"]);
    assert_eq!((expression.trigger, expression.guard), (None, None));
    let kinds: Vec<_> = expression.actions.into_iter().map(|action| action.kind).collect();
    assert_eq!(kinds, [ActionKind::PublishAll, ActionKind::ProcessMessages]);
}

#[test]
fn obvious_slips_are_reported_and_corrected() {
    let (expression, diagnostics) = parse_transition("[a = 1 | b & c]");
    assert_eq!(diagnostics.len(), 3);
    assert_eq!(expression.guard, Some(condition("a == 1 || b && c")));
}

#[test]
fn nesting_is_limited_but_length_is_not() {
    let nested = |depth: usize| format!("{}a{}", "(".repeat(depth), ")".repeat(depth));
    assert_eq!(condition(&nested(255)), condition("a"));
    for text in
        [nested(256), nested(100_000), "!".repeat(300) + "a", "-".repeat(300) + "1", "f(".repeat(100_000)]
    {
        let codes: Vec<_> = parse_condition(&text).1.iter().map(|diagnostic| diagnostic.code).collect();
        assert_eq!(codes, ["E0112"]);
    }
    let long = vec!["a + 1 > b"; 100_000].join(" && ");
    assert!(matches!(kind(&long), ExpressionKind::And(operands) if operands.len() == 100_000));
    let long = vec!["1"; 100_000].join(" + ");
    assert!(matches!(kind(&long), ExpressionKind::Sum(_, rest) if rest.len() == 99_999));
}

/// Texts made of fragments of the language, which reach more of the parser than random characters.
fn shuffled_pieces() -> impl Strategy<Value = String> {
    let pieces = "a . ( ) [ ] / , ; ! not == = < | || && and NULL 1 0.5 100ms \"x\" \" ` `a.b` In TimeoutCheck StartTimeout \
                  TimeoutAction publish raise process_messages set_x State :: - + * true # ω \\";
    let pieces: Vec<_> = pieces.split(' ').collect();
    prop::collection::vec(prop::sample::select(pieces), 0..24)
        .prop_flat_map(|pieces| (Just(pieces), prop::sample::select(vec!["", " "])))
        .prop_map(|(pieces, separator)| pieces.join(separator))
}

fn assert_total(text: &str) {
    for diagnostics in [parse_transition(text).1, parse_condition(text).1, parse_actions(text).1] {
        for diagnostic in diagnostics {
            assert!(
                text.get(diagnostic.span.start..diagnostic.span.end).is_some(),
                "{text:?}: {diagnostic:?}"
            );
            assert!(diagnostic.hint.is_some(), "{text:?}: {diagnostic:?}");
        }
    }
}

proptest! {
    #[test]
    fn any_characters_are_read_or_refused(text in any::<String>()) {
        assert_total(&text);
    }

    #[test]
    fn any_pieces_are_read_or_refused(text in shuffled_pieces()) {
        assert_total(&text);
    }

    #[test]
    fn valid_texts_round_trip(text in shuffled_pieces()) {
        let (expression, diagnostics) = parse_transition(&text);
        if diagnostics.is_empty() {
            prop_assert_eq!(parse_transition(&expression.to_string()), (expression, vec![]));
        }
    }
}
