//! The canonical text of a property: it reads back as the same.

use std::fmt;
use std::time::Duration;

use super::scanner::{is_bare, is_keyword};
use super::syntax::{Formula, FormulaKind, Property};

impl fmt::Display for Property {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "property \"{}\":\n    {}\n", self.name, self.formula)
    }
}

impl fmt::Display for Formula {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            FormulaKind::Constant(value) => write!(f, "{value}"),
            FormulaKind::In(name) => write!(f, "in {}", Word(&name.text)),
            FormulaKind::Entering(name) => write!(f, "entering {}", Word(&name.text)),
            FormulaKind::Leaving(name) => write!(f, "leaving {}", Word(&name.text)),
            FormulaKind::Event(name) => write!(f, "event {}", Word(&name.text)),
            FormulaKind::Condition(condition) => write!(f, "[{condition}]"),
            FormulaKind::Not(inner) => write!(f, "not {}", Part(inner)),
            FormulaKind::And(parts) => list(f, parts, " and "),
            FormulaKind::Or(parts) => list(f, parts, " or "),
            FormulaKind::Implies(one, other) => write!(f, "{} implies {}", Part(one), Part(other)),
            FormulaKind::Always(inner) => write!(f, "always {}", Part(inner)),
            FormulaKind::Eventually(inner, bound) => {
                write!(f, "eventually {}{}", Part(inner), Within(*bound))
            }
            FormulaKind::Until(one, other, bound) => {
                write!(f, "{} until {}{}", Part(one), Part(other), Within(*bound))
            }
        }
    }
}

fn list(f: &mut fmt::Formatter<'_>, parts: &[Formula], between: &str) -> fmt::Result {
    for (index, part) in parts.iter().enumerate() {
        write!(f, "{}{}", if index == 0 { "" } else { between }, Part(part))?;
    }
    Ok(())
}

/// A part, in parentheses if it has parts itself.
struct Part<'a>(&'a Formula);

impl fmt::Display for Part<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_single = match self.0.kind {
            FormulaKind::Constant(_)
            | FormulaKind::In(_)
            | FormulaKind::Entering(_)
            | FormulaKind::Leaving(_)
            | FormulaKind::Event(_)
            | FormulaKind::Condition(_)
            | FormulaKind::Not(_) => true,
            FormulaKind::And(_)
            | FormulaKind::Or(_)
            | FormulaKind::Implies(..)
            | FormulaKind::Always(_)
            | FormulaKind::Eventually(..)
            | FormulaKind::Until(..) => false,
        };
        if is_single { self.0.fmt(f) } else { write!(f, "({})", self.0) }
    }
}

/// A name, in backquotes if it would be read as something else.
struct Word<'a>(&'a str);

impl fmt::Display for Word<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_plain = !self.0.is_empty() && self.0.chars().all(is_bare) && !is_keyword(self.0);
        if is_plain { f.write_str(self.0) } else { write!(f, "`{}`", self.0) }
    }
}

/// A bound.
struct Within(Option<Duration>);

impl fmt::Display for Within {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            None => Ok(()),
            Some(bound) if bound.subsec_nanos() == 0 => write!(f, " within {} s", bound.as_secs()),
            Some(bound) => write!(f, " within {} ms", bound.as_millis()),
        }
    }
}
