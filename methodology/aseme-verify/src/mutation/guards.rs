//! Mutants: guards removed, negated, or slightly changed.

use yase::expression::{Comparison, Expression, ExpressionKind, TransitionExpression};
use yase::{NodeId, NodeKind, Statechart, Transition, TransitionId};

use super::constants::around;
use super::{MutantCollector, MutantDescription, MutationKind, bracketed};

/// A guard with one part changed.
struct GuardVariant {
    kind: MutationKind,
    guard: Expression,
    wanted: String,
}

/// All mutants of the guard of a transition.
pub(crate) fn of_transition(making: &mut MutantCollector<'_>, id: TransitionId) {
    let transition = making.chart.transition(id);
    let Some(guard) = transition.expression.guard.clone() else { return };
    let is_never = transition.expression.is_never();
    change(
        making,
        id,
        GuardVariant {
            kind: MutationKind::GuardNegated,
            guard: negated(&guard),
            wanted: format!("a case in which the guard must be {}", bracketed(Some(&guard))),
        },
    );
    let source = transition.source;
    if !is_never || completes(making.chart, source) {
        remove(making, id, &guard);
    }
    if !is_never {
        variants(&guard).into_iter().for_each(|variant| change(making, id, variant));
    }
}

fn change(making: &mut MutantCollector<'_>, id: TransitionId, variant: GuardVariant) {
    let GuardVariant { kind, guard, wanted } = variant;
    let before = bracketed(making.chart.transition(id).expression.guard.as_ref());
    let change = format!("the guard {before} becomes {}", bracketed(Some(&guard)));
    making.transition(id, MutantDescription { kind, change, wanted }, |it| it.expression.guard = Some(guard));
}

fn remove(making: &mut MutantCollector<'_>, id: TransitionId, guard: &Expression) {
    let before = bracketed(Some(guard));
    let mutation = MutantDescription {
        kind: MutationKind::GuardRemoved,
        change: format!("the guard {before} is removed"),
        wanted: format!("a case in which only the guard {before} prevents the transition"),
    };
    making.transition(id, mutation, |it| it.expression.guard = None);
}

/// Whether a state can complete, judged by its structure. Removing the guard of an exit that waits
/// for completion has no effect if it cannot.
fn completes(chart: &Statechart, node: NodeId) -> bool {
    let children = chart.children(node);
    match chart.node(node).kind {
        NodeKind::Or => chart.transitions().any(|(_, it)| {
            let ends = chart.node(it.target).kind == NodeKind::End && children.contains(&it.target);
            ends && !it.expression.is_never() && leaves(chart, it)
        }),
        NodeKind::And => children.iter().all(|&child| completes(chart, child)),
        _ => true,
    }
}

/// Whether a transition to a sibling END can be taken: not if it waits for its source to complete
/// and that never does.
fn leaves(chart: &Statechart, transition: &Transition) -> bool {
    let TransitionExpression { trigger, guard, .. } = &transition.expression;
    trigger.is_some() || guard.is_some() || completes(chart, transition.source)
}

/// The negation of a condition in simplified form.
fn negated(condition: &Expression) -> Expression {
    let kind = match &condition.kind {
        ExpressionKind::Not(inner) => return (**inner).clone(),
        ExpressionKind::Bool(value) => ExpressionKind::Bool(!value),
        ExpressionKind::Absent(message) => ExpressionKind::Present(message.clone()),
        ExpressionKind::Present(message) => ExpressionKind::Absent(message.clone()),
        ExpressionKind::Compare(left, comparison, right) => {
            ExpressionKind::Compare(left.clone(), comparison.negated(), right.clone())
        }
        _ => ExpressionKind::Not(Box::new(condition.clone())),
    };
    Expression { kind, position: condition.position }
}

const fn neighbour(comparison: Comparison) -> Comparison {
    match comparison {
        Comparison::Equal => Comparison::NotEqual,
        Comparison::NotEqual => Comparison::Equal,
        Comparison::Less => Comparison::LessOrEqual,
        Comparison::LessOrEqual => Comparison::Less,
        Comparison::Greater => Comparison::GreaterOrEqual,
        Comparison::GreaterOrEqual => Comparison::Greater,
    }
}

/// All variants of a condition with one part changed.
fn variants(condition: &Expression) -> Vec<GuardVariant> {
    let mut found = own(condition);
    for (index, part) in condition.parts().into_iter().enumerate() {
        for variant in variants(part) {
            let guard = with_part(condition, index, variant.guard);
            let wanted = match (variant.kind, &condition.kind) {
                (MutationKind::Number, ExpressionKind::Compare(..)) => {
                    format!("a case in which `{condition}` and `{guard}` differ")
                }
                _ => variant.wanted,
            };
            found.push(GuardVariant { kind: variant.kind, guard, wanted });
        }
    }
    found
}

/// The variants of a condition with its operands unchanged.
fn own(condition: &Expression) -> Vec<GuardVariant> {
    match &condition.kind {
        ExpressionKind::Compare(left, comparison, right) => {
            vec![compared(condition, left, *comparison, right)]
        }
        ExpressionKind::And(operands) | ExpressionKind::Or(operands) => joined(condition, operands),
        ExpressionKind::Integer(_) | ExpressionKind::Decimal(_) => steps(condition),
        _ => Vec::new(),
    }
}

fn compared(
    condition: &Expression,
    left: &Expression,
    comparison: Comparison,
    right: &Expression,
) -> GuardVariant {
    let kind =
        ExpressionKind::Compare(Box::new(left.clone()), neighbour(comparison), Box::new(right.clone()));
    let wanted = match comparison {
        Comparison::Equal | Comparison::NotEqual => {
            format!("a case in which the value of `{condition}` makes a difference")
        }
        _ => format!("a case in which `{left}` equals `{right}`"),
    };
    GuardVariant {
        kind: MutationKind::Comparison,
        guard: Expression { kind, position: condition.position },
        wanted,
    }
}

/// The variants of `a && b` and `a || b`.
fn joined(condition: &Expression, operands: &[Expression]) -> Vec<GuardVariant> {
    let is_and = matches!(condition.kind, ExpressionKind::And(_));
    let join = |operands: Vec<Expression>, all: bool| {
        let kind = if all { ExpressionKind::And(operands) } else { ExpressionKind::Or(operands) };
        Expression { kind, position: condition.position }
    };
    let dropped = operands.iter().enumerate().map(|(index, operand)| {
        let mut rest = operands.to_vec();
        rest.remove(index);
        let guard = match rest.as_slice() {
            [one] => one.clone(),
            _ => join(rest, is_and),
        };
        let wanted = match is_and {
            true => format!("a case in which all operands but `{operand}` hold"),
            false => format!("a case in which only `{operand}` holds"),
        };
        GuardVariant { kind: MutationKind::PartDropped, guard, wanted }
    });
    let turned = GuardVariant {
        kind: MutationKind::AndOr,
        guard: join(operands.to_vec(), !is_and),
        wanted: format!("a case in which only some operands of `{condition}` hold"),
    };
    dropped.chain([turned]).collect()
}

/// The variants of a number: one step larger and one step smaller.
fn steps(number: &Expression) -> Vec<GuardVariant> {
    let stepped: Vec<Expression> = match number.kind {
        ExpressionKind::Integer(value) => {
            let larger = value.checked_add(1).map(|value| plain(ExpressionKind::Integer(value), number));
            let smaller = match value.checked_sub(1) {
                Some(smaller) => plain(ExpressionKind::Integer(smaller), number),
                None => negative(plain(ExpressionKind::Integer(1), number)),
            };
            larger.into_iter().chain([smaller]).collect()
        }
        ExpressionKind::Decimal(value) => {
            around(value).into_iter().map(|value| decimal(value, number)).collect()
        }
        _ => Vec::new(),
    };
    let mutation = |guard: Expression| {
        let wanted = format!("a case in which `{number}` and `{guard}` make a difference");
        GuardVariant { kind: MutationKind::Number, guard, wanted }
    };
    stepped.into_iter().map(mutation).collect()
}

fn decimal(value: f64, like: &Expression) -> Expression {
    let size = plain(ExpressionKind::Decimal(value.abs()), like);
    if value < 0.0 { negative(size) } else { size }
}

fn plain(kind: ExpressionKind, like: &Expression) -> Expression {
    Expression { kind, position: like.position }
}

fn negative(number: Expression) -> Expression {
    Expression { position: number.position, kind: ExpressionKind::Negative(Box::new(number)) }
}

/// A condition with one of its [parts](Expression::parts) replaced.
fn with_part(condition: &Expression, index: usize, part: Expression) -> Expression {
    let mut changed = condition.clone();
    let found = match &mut changed.kind {
        ExpressionKind::Or(operands) | ExpressionKind::And(operands) | ExpressionKind::Call(_, operands) => {
            operands.get_mut(index)
        }
        ExpressionKind::Not(inner) | ExpressionKind::Negative(inner) => Some(&mut **inner),
        ExpressionKind::Compare(left, _, right) => Some(if index == 0 { &mut **left } else { &mut **right }),
        ExpressionKind::Sum(first, rest) => match index.checked_sub(1) {
            None => Some(&mut **first),
            Some(position) => rest.get_mut(position).map(|(_, part)| part),
        },
        ExpressionKind::Product(first, rest) => match index.checked_sub(1) {
            None => Some(&mut **first),
            Some(position) => rest.get_mut(position).map(|(_, part)| part),
        },
        _ => None,
    };
    if let Some(found) = found {
        *found = part;
    }
    changed
}
