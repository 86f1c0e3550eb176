//! The section `Constants:`.

use std::f64::consts::PI;

use yase::statechart::{Constant, ConstantValue};
use yase::{Diagnostic, Span};

use super::{Reader, Section, SrmEntry};
use crate::text;

/// Units that may follow a number, and their values in metres, seconds or radians.
const UNITS: [(&str, f64); 7] =
    [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("s", 1.0), ("ms", 0.001), ("rad", 1.0), ("deg", PI / 180.0)];

impl Reader {
    /// Parses one constant per line.
    pub(crate) fn constants(&mut self, blanked: &str, body: Span) {
        for line in text::lines_of(blanked, body) {
            let span = text::trimmed(blanked, line);
            if span.start < span.end {
                self.entries.push(SrmEntry { section: Section::Constants, span });
                self.constant(&blanked[span.start..span.end], span);
            }
        }
    }

    fn constant(&mut self, line: &str, span: Span) {
        let Some((name, value)) = line.split_once('=').map(|(name, value)| (name.trim(), value.trim()))
        else {
            let hint = "write `name = value`";
            return self.report(
                Diagnostic::error("E0237", span, "a constant has a name and a value").with_hint(hint),
            );
        };
        if !text::is_name(name) || name.starts_with(|c: char| c.is_ascii_digit()) {
            let message = format!("`{name}` is not a name for a constant");
            let hint =
                "a name starts with an ASCII letter, followed by ASCII letters, digits and underscores";
            return self.report(Diagnostic::error("E0237", span, message).with_hint(hint));
        }
        if self.srm.constants.iter().any(|constant| constant.name == name) {
            let message = format!("`{name}` has a value already");
            return self.report(Diagnostic::error("E0238", span, message).with_hint("keep one of the two"));
        }
        match constant_value(value) {
            Some(value) => self.srm.constants.push(Constant { name: name.into(), value }),
            None => {
                let message = format!("`{value}` is not a value");
                let hint = "a value is a number, which a unit may follow (m cm mm s ms rad deg), true, false or \"text\"";
                self.report(Diagnostic::error("E0239", span, message).with_hint(hint));
            }
        }
    }
}

/// The value of a text, in SI units.
pub fn constant_value(text: &str) -> Option<ConstantValue> {
    match text {
        "true" => return Some(ConstantValue::Bool(true)),
        "false" => return Some(ConstantValue::Bool(false)),
        _ => {}
    }
    if let Some(quoted) = text.strip_prefix('"') {
        let inner = quoted.strip_suffix('"')?;
        return (!inner.contains('"')).then(|| ConstantValue::Text(inner.into()));
    }
    number(text).map(ConstantValue::Number)
}

fn number(text: &str) -> Option<f64> {
    let plain = |text: &str| text.bytes().any(|byte| byte.is_ascii_digit()).then(|| text.parse().ok())?;
    let with_unit =
        UNITS.iter().find_map(|(unit, factor)| Some((plain(text.strip_suffix(unit)?.trim_end())?, *factor)));
    let (value, factor): (f64, f64) = plain(text).map(|value| (value, 1.0)).or(with_unit)?;
    Some(value * factor).filter(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_in_si_units() {
        assert_eq!(constant_value("0.15"), Some(ConstantValue::Number(0.15)));
        assert_eq!(constant_value("-2e3"), Some(ConstantValue::Number(-2000.0)));
        assert_eq!(constant_value("25 cm"), Some(ConstantValue::Number(0.25)));
        assert_eq!(constant_value("250ms"), Some(ConstantValue::Number(0.25)));
        assert_eq!(constant_value("180deg"), Some(ConstantValue::Number(PI)));
        assert_eq!(constant_value("true"), Some(ConstantValue::Bool(true)));
        assert_eq!(constant_value("\"blue # one\""), Some(ConstantValue::Text("blue # one".into())));
    }

    #[test]
    fn invalid_values_are_rejected() {
        for text in ["", "inf", "NaN", "1e999", "15 degrees", "\"a", "\"a\"b\"", "near"] {
            assert_eq!(constant_value(text), None, "{text}");
        }
    }
}
