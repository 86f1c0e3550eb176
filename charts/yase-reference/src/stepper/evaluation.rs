//! Evaluation: R4, R5 and expressions.

use yase::expression::{Comparison, Expression, ExpressionKind, TransitionExpression, Trigger};
use yase::statechart::TransitionId;
use yase::{EventMatching, ScopeId};

use super::{Occurrence, StaticPath, Stepper, topic};
use crate::test_host::TestHost;

impl Stepper<'_> {
    pub(crate) fn expression(&self, id: TransitionId) -> &TransitionExpression {
        &self.chart.transition(id).expression
    }

    /// R4
    pub(crate) fn is_triggered(&self, id: TransitionId, occurrence: Option<&Occurrence>) -> bool {
        match (&self.expression(id).trigger, occurrence) {
            (None, None) => true,
            (Some(Trigger::OneOf(names)), Some(occurrence)) => {
                names.iter().any(|name| self.matches(&name.text(), &occurrence.event))
            }
            (Some(_), Some(occurrence)) if occurrence.expiry.is_some() => false,
            (Some(Trigger::Any), Some(_)) => true,
            (Some(Trigger::Not(name)), Some(occurrence)) => !self.matches(&name.text(), &occurrence.event),
            _ => false,
        }
    }

    /// Whether a name denotes an event.
    pub(crate) fn matches(&self, name: &str, event: &str) -> bool {
        let tokens = self.semantics.matching == EventMatching::TokenPrefix;
        name == event || tokens && event.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'))
    }

    /// R5: on the blackboard of the scope.
    pub(crate) fn guards_hold(
        &mut self,
        path: &StaticPath,
        so_far: Option<usize>,
        host: &mut TestHost,
    ) -> bool {
        let region = self.region(self.scope(path));
        self.all_hold(path, so_far, region, host)
    }

    pub(crate) fn all_hold(
        &mut self,
        path: &StaticPath,
        so_far: Option<usize>,
        region: ScopeId,
        host: &mut TestHost,
    ) -> bool {
        let segments = &path.segments[..so_far.unwrap_or(path.segments.len())];
        segments.iter().all(|&id| self.holds(id, region, host))
    }

    fn holds(&mut self, id: TransitionId, region: ScopeId, host: &mut TestHost) -> bool {
        let Some(guard) = self.expression(id).guard.clone() else { return true };
        if self.expression(id).is_never() {
            return false; // nothing is read
        }
        match self.truth(&guard, region, host) {
            Ok(value) => {
                self.erred.remove(&(id, region));
                self.line.reads.push((id, Some(value == Some(true))));
                value == Some(true)
            }
            Err(error) => {
                self.line.reads.push((id, None));
                let is_new = self.erred.insert((id, region));
                if is_new {
                    self.stale.remove(&(id, region));
                }
                if (is_new || self.raises_every_error()) && self.reported.insert(id) {
                    self.raise(self.error_event("error.guard"));
                    host.say(format!("  guard failed: {error}"));
                }
                false
            }
        }
    }

    /// Value of a condition; none if it is unknown.
    pub(crate) fn truth(
        &self,
        expression: &Expression,
        region: ScopeId,
        host: &TestHost,
    ) -> Result<Option<bool>, String> {
        Ok(match &expression.kind {
            ExpressionKind::Bool(value) => Some(*value),
            ExpressionKind::And(parts) => {
                let mut unknown = false;
                for part in parts {
                    match self.truth(part, region, host)? {
                        Some(false) => return Ok(Some(false)),
                        Some(true) => {}
                        None => unknown = true,
                    }
                }
                if unknown { None } else { Some(true) }
            }
            ExpressionKind::Or(parts) => {
                let mut unknown = false;
                for part in parts {
                    match self.truth(part, region, host)? {
                        Some(true) => return Ok(Some(true)),
                        Some(false) => {}
                        None => unknown = true,
                    }
                }
                if unknown { None } else { Some(false) }
            }
            ExpressionKind::Not(part) => self.truth(part, region, host)?.map(|value| !value),
            ExpressionKind::Compare(left, comparison, right) => {
                let (left, right) = (self.number(left, region, host)?, self.number(right, region, host)?);
                match (left, right) {
                    (Some(left), Some(right)) => Some(match comparison {
                        Comparison::Equal => left == right,
                        Comparison::NotEqual => left != right,
                        Comparison::Less => left < right,
                        Comparison::LessOrEqual => left <= right,
                        Comparison::Greater => left > right,
                        Comparison::GreaterOrEqual => left >= right,
                    }),
                    _ => None,
                }
            }
            ExpressionKind::Absent(path) => Some(self.message(&path.text(), region, host).is_none()),
            ExpressionKind::Present(path) => Some(self.message(&path.text(), region, host).is_some()),
            ExpressionKind::Variable(path) => Some(self.is_over(&path.text(), region).unwrap_or(true)),
            ExpressionKind::TimeoutCheck(path) => Some(self.is_over(&path.text(), region).unwrap_or(false)),
            ExpressionKind::In(name) => Some(self.active.contains(&self.chart.find(&name.text).unwrap())),
            other => panic!("the generator makes no {other:?}"),
        })
    }

    pub(crate) fn number(
        &self,
        expression: &Expression,
        region: ScopeId,
        host: &TestHost,
    ) -> Result<Option<i64>, String> {
        Ok(match &expression.kind {
            ExpressionKind::Integer(value) => Some(*value as i64),
            ExpressionKind::Variable(path) => self.message(&path.segments[0].text, region, host),
            ExpressionKind::Sum(first, rest) => {
                let mut sum = self.number(first, region, host)?;
                for (_, part) in rest {
                    sum = sum.zip(self.number(part, region, host)?).map(|(a, b)| a + b);
                }
                sum
            }
            ExpressionKind::Call(name, arguments) if name.text == "fail" && arguments.is_empty() => {
                return Err("the function failed: it always fails".to_owned());
            }
            other => panic!("the generator makes no {other:?}"),
        })
    }

    pub(crate) fn message(&self, name: &str, region: ScopeId, host: &TestHost) -> Option<i64> {
        host.number(region, topic(name).unwrap())
    }

    pub(crate) fn is_over(&self, timer: &str, region: ScopeId) -> Option<bool> {
        self.timers.get(&(region, timer.to_owned())).map(|deadline| deadline.moment <= self.now)
    }
}
