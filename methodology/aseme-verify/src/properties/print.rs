//! The canonical text of a property, which parses to the same property.

use std::fmt;
use std::time::Duration;

use super::lexer::{is_bare, is_keyword};
use super::syntax::{Property, PropertyFormula, PropertyFormulaKind};

impl fmt::Display for Property {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "property \"{}\":\n    {}\n", self.name, self.formula)
    }
}

impl fmt::Display for PropertyFormula {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            PropertyFormulaKind::Constant(value) => write!(f, "{value}"),
            PropertyFormulaKind::In(name) => write!(f, "in {}", QuotedName(&name.text)),
            PropertyFormulaKind::Entering(name) => write!(f, "entering {}", QuotedName(&name.text)),
            PropertyFormulaKind::Leaving(name) => write!(f, "leaving {}", QuotedName(&name.text)),
            PropertyFormulaKind::Event(name) => write!(f, "event {}", QuotedName(&name.text)),
            PropertyFormulaKind::Condition(condition) => write!(f, "[{condition}]"),
            PropertyFormulaKind::Not(inner) => write!(f, "not {}", OperandText(inner)),
            PropertyFormulaKind::And(parts) => list(f, parts, " and "),
            PropertyFormulaKind::Or(parts) => list(f, parts, " or "),
            PropertyFormulaKind::Implies(one, other) => {
                write!(f, "{} implies {}", OperandText(one), OperandText(other))
            }
            PropertyFormulaKind::Always(inner) => write!(f, "always {}", OperandText(inner)),
            PropertyFormulaKind::Eventually(inner, bound) => {
                write!(f, "eventually {}{}", OperandText(inner), TimeBoundText(*bound))
            }
            PropertyFormulaKind::Until(one, other, bound) => {
                write!(f, "{} until {}{}", OperandText(one), OperandText(other), TimeBoundText(*bound))
            }
        }
    }
}

fn list(f: &mut fmt::Formatter<'_>, parts: &[PropertyFormula], between: &str) -> fmt::Result {
    for (index, part) in parts.iter().enumerate() {
        write!(f, "{}{}", if index == 0 { "" } else { between }, OperandText(part))?;
    }
    Ok(())
}

/// An operand, in parentheses if it has operands itself.
struct OperandText<'a>(&'a PropertyFormula);

impl fmt::Display for OperandText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_single = match self.0.kind {
            PropertyFormulaKind::Constant(_)
            | PropertyFormulaKind::In(_)
            | PropertyFormulaKind::Entering(_)
            | PropertyFormulaKind::Leaving(_)
            | PropertyFormulaKind::Event(_)
            | PropertyFormulaKind::Condition(_)
            | PropertyFormulaKind::Not(_) => true,
            PropertyFormulaKind::And(_)
            | PropertyFormulaKind::Or(_)
            | PropertyFormulaKind::Implies(..)
            | PropertyFormulaKind::Always(_)
            | PropertyFormulaKind::Eventually(..)
            | PropertyFormulaKind::Until(..) => false,
        };
        if is_single { self.0.fmt(f) } else { write!(f, "({})", self.0) }
    }
}

/// A name, in backquotes if it would be parsed differently without them.
struct QuotedName<'a>(&'a str);

impl fmt::Display for QuotedName<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_plain = !self.0.is_empty() && self.0.chars().all(is_bare) && !is_keyword(self.0);
        if is_plain { f.write_str(self.0) } else { write!(f, "`{}`", self.0) }
    }
}

/// A time bound.
struct TimeBoundText(Option<Duration>);

impl fmt::Display for TimeBoundText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            None => Ok(()),
            Some(bound) if bound.subsec_nanos() == 0 => write!(f, " within {} s", bound.as_secs()),
            Some(bound) => write!(f, " within {} ms", bound.as_millis()),
        }
    }
}
