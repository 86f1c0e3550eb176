//! Parser of properties, by recursive descent.
//!
//! A property with a syntax error is reported once and left out; parsing resumes at the next.

use std::time::Duration;

use yase::expression::{Expression, ExpressionKind, Name, TextPosition, parse_transition_at};
use yase::{Diagnostic, Span};

use super::lexer::{PropertyTokenKind, Token, is_keyword, keywords, tokens};
use super::syntax::{Property, PropertyFormula, PropertyFormulaKind};

/// Limit of nesting.
const MAX_DEPTH: usize = 64;

/// The longest bound, in milliseconds: a day.
const MAX_BOUND: u64 = 86_400_000;

/// Parses a file of properties; the findings are E0840 to E0844, E0847 and those of
/// [conditions](yase::expression).
pub fn parse(text: &str) -> (Vec<Property>, Vec<Diagnostic>) {
    let mut parser = Parser { text, tokens: tokens(text), next: 0, depth: 0, found: Vec::new() };
    let mut properties: Vec<Property> = Vec::new();
    while parser.kind() != PropertyTokenKind::End {
        match parser.property() {
            Ok(property) => parser.keep(property, &mut properties),
            Err(ErrorReported) => parser.skip(),
        }
    }
    if properties.is_empty() && parser.found.is_empty() {
        let wrong = Diagnostic::error("E0840", Span::default(), "the file has no property");
        parser.found.push(wrong.with_hint("a property is `property \"its name\": formula`"));
    }
    (properties, parser.found)
}

/// A syntax error that has been reported.
struct ErrorReported;

type Parsed<T> = Result<T, ErrorReported>;

struct Parser<'a> {
    text: &'a str,
    tokens: Vec<Token>,
    next: usize,
    depth: usize,
    found: Vec<Diagnostic>,
}

impl Parser<'_> {
    fn keep(&mut self, property: Property, properties: &mut Vec<Property>) {
        if properties.iter().any(|other| other.name == property.name) {
            let message = format!("another property is called `{}`", property.name);
            let wrong = Diagnostic::error("E0843", property.position.0, message);
            self.found.push(wrong.with_hint("each property of a file has a name of its own"));
        } else {
            properties.push(property);
        }
    }

    /// Skips to the next property.
    fn skip(&mut self) {
        let begins =
            |token: &Token| token.kind == PropertyTokenKind::Word && self.text_of(token.span) == "property";
        let rest = self.tokens.iter().skip(self.next).position(begins);
        self.next = rest.map_or(self.tokens.len() - 1, |index| self.next + index);
    }

    fn property(&mut self) -> Parsed<Property> {
        let begin = self.span();
        if !self.accept("property") {
            let message = format!("{} found, expected a property", self.this());
            return self.refuse("E0840", begin, message, "a property is `property \"its name\": formula`");
        }
        let named = self.token();
        if named.kind != PropertyTokenKind::Text || named.span.end - named.span.start < 3 {
            let message = format!("{} found, expected the name of the property", self.this());
            return self.refuse(
                "E0840",
                named.span,
                message,
                "its name is a text: `property \"its name\": formula`",
            );
        }
        self.next += 1;
        if self.kind() != PropertyTokenKind::Colon {
            let message = format!("{} found, expected `:`", self.this());
            return self.refuse(
                "E0840",
                self.span(),
                message,
                "a property is `property \"its name\": formula`",
            );
        }
        self.next += 1;
        let formula = self.formula()?;
        if !(self.kind() == PropertyTokenKind::End || self.is("property")) {
            return self.unexpected();
        }
        let name = self.text_of(Span::new(named.span.start + 1, named.span.end - 1)).to_owned();
        Ok(Property { name, formula, position: TextPosition(begin.to(named.span)) })
    }

    /// Reports the token after a complete formula.
    fn unexpected<T>(&mut self) -> Parsed<T> {
        let (message, hint) = match self.this_word() {
            "within" => (
                "`within` without `eventually` or `until`".to_owned(),
                "`within` belongs to `eventually` or `until`",
            ),
            "until" => ("`until` follows another".to_owned(), "use parentheses"),
            _ if self.kind() == PropertyTokenKind::Close => {
                (String::from("`)` closes nothing"), "remove it, or add the opening parenthesis")
            }
            _ => (
                format!("{} follows a complete formula", self.this()),
                "join formulas by `and`, `or`, `implies` or `until`",
            ),
        };
        self.refuse("E0841", self.span(), message, hint)
    }

    fn formula(&mut self) -> Parsed<PropertyFormula> {
        self.deeper(|parser| {
            let left = parser.until()?;
            if !parser.accept("implies") {
                return Ok(left);
            }
            let right = parser.formula()?;
            Ok(spanning(left, right, PropertyFormulaKind::Implies))
        })
    }

    fn until(&mut self) -> Parsed<PropertyFormula> {
        let left = self.list("or", Parser::both, PropertyFormulaKind::Or)?;
        if !self.accept("until") {
            return Ok(left);
        }
        let right = self.list("or", Parser::both, PropertyFormulaKind::Or)?;
        let bound = self.within()?;
        Ok(spanning(left, right, |left, right| PropertyFormulaKind::Until(left, right, bound)))
    }

    fn both(&mut self) -> Parsed<PropertyFormula> {
        self.list("and", Parser::single, PropertyFormulaKind::And)
    }

    fn list(
        &mut self,
        word: &str,
        part: fn(&mut Self) -> Parsed<PropertyFormula>,
        kind: fn(Vec<PropertyFormula>) -> PropertyFormulaKind,
    ) -> Parsed<PropertyFormula> {
        let first = part(self)?;
        if !self.is(word) {
            return Ok(first);
        }
        let mut parts = vec![first];
        while self.accept(word) {
            parts.push(part(self)?);
        }
        let ends = parts.first().zip(parts.last());
        let position = ends
            .map_or_else(TextPosition::default, |(first, last)| TextPosition(first.span().to(last.span())));
        Ok(PropertyFormula { kind: kind(parts), position })
    }

    fn single(&mut self) -> Parsed<PropertyFormula> {
        let begin = self.token();
        let kind = match begin.kind {
            PropertyTokenKind::Open => return self.parenthesised(begin.span),
            PropertyTokenKind::Condition => {
                self.next += 1;
                PropertyFormulaKind::Condition(self.condition(begin.span)?)
            }
            PropertyTokenKind::Word => self.worded(begin.span)?,
            PropertyTokenKind::Unclosed => return self.unclosed(),
            _ => return self.missing(),
        };
        let end = self.tokens[self.next - 1].span;
        Ok(PropertyFormula { kind, position: TextPosition(begin.span.to(end)) })
    }

    fn parenthesised(&mut self, open: Span) -> Parsed<PropertyFormula> {
        self.next += 1;
        let inner = self.formula()?;
        if self.kind() != PropertyTokenKind::Close {
            if self.kind() == PropertyTokenKind::End || self.is("property") {
                return self.refuse(
                    "E0842",
                    open,
                    "the parenthesis is not closed".into(),
                    "close it with `)`",
                );
            }
            return self.unexpected();
        }
        self.next += 1;
        Ok(inner)
    }

    fn worded(&mut self, begin: Span) -> Parsed<PropertyFormulaKind> {
        let word = self.text_of(begin).to_owned();
        let is_known = is_keyword(&word);
        match word.as_str() {
            "true" | "false" => {
                self.next += 1;
                Ok(PropertyFormulaKind::Constant(word == "true"))
            }
            "not" => {
                self.next += 1;
                let inner = self.deeper(Parser::single)?;
                Ok(PropertyFormulaKind::Not(Box::new(inner)))
            }
            "always" => {
                self.next += 1;
                Ok(PropertyFormulaKind::Always(Box::new(self.formula()?)))
            }
            "eventually" => {
                self.next += 1;
                let inner = self.formula()?;
                let bound = self.within()?;
                Ok(PropertyFormulaKind::Eventually(Box::new(inner), bound))
            }
            "in" => self.named(PropertyFormulaKind::In, "a state"),
            "entering" => self.named(PropertyFormulaKind::Entering, "a state"),
            "leaving" => self.named(PropertyFormulaKind::Leaving, "a state"),
            "event" => self.named(PropertyFormulaKind::Event, "an event"),
            _ if is_known => self.missing(),
            _ => {
                let message = format!("`{word}` is not a formula");
                let wrong = Diagnostic::error("E0841", begin, message);
                let near = yase::diagnostic::nearest(&word, keywords());
                self.found.push(wrong.with_hint(match near {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => format!("for a state, write `in {word}` or `entering {word}`; for an event, `event {word}`; for a message, `[{word}]`"),
                }));
                Err(ErrorReported)
            }
        }
    }

    fn named(&mut self, kind: fn(Name) -> PropertyFormulaKind, what: &str) -> Parsed<PropertyFormulaKind> {
        self.next += 1;
        let Token { kind: is, span } = self.token();
        let inside = match is {
            PropertyTokenKind::Word if !is_keyword(self.text_of(span)) => span,
            PropertyTokenKind::Quoted if span.end - span.start > 2 => Span::new(span.start + 1, span.end - 1),
            PropertyTokenKind::Unclosed => return self.unclosed(),
            _ => {
                let message = format!("{} found, expected the name of {what}", self.this());
                let hint = "put keywords and names with other characters in backquotes";
                return self.refuse("E0841", span, message, hint);
            }
        };
        self.next += 1;
        let text = self.text_of(inside).to_owned();
        Ok(kind(Name { text, position: TextPosition(span) }))
    }

    fn condition(&mut self, span: Span) -> Parsed<Expression> {
        let (transition, found) = parse_transition_at(self.text_of(span), span.start);
        let is_wrong = !found.is_empty();
        self.found.extend(found);
        match transition.guard {
            Some(condition) if !is_wrong => {
                self.only_messages(&condition)?;
                Ok(condition)
            }
            Some(_) => Err(ErrorReported),
            None if is_wrong => Err(ErrorReported),
            None => self.refuse("E0841", span, "the brackets are empty".into(), "write `[Ball.found]`"),
        }
    }

    /// Rejects the parts of a condition that do not depend on messages, since propositions express
    /// them.
    fn only_messages(&mut self, condition: &Expression) -> Parsed<()> {
        let Some((span, what)) = foreign(condition) else { return Ok(()) };
        let hint = match what {
            "In" => "write `in STATE` outside the brackets",
            "TimeoutCheck" => "use `within` after `eventually` or `until`",
            _ => "use fields of messages",
        };
        self.refuse("E0841", span, format!("`{what}` cannot occur in the condition of a property"), hint)
    }

    fn within(&mut self) -> Parsed<Option<Duration>> {
        let begin = self.span();
        if !self.accept("within") {
            return Ok(None);
        }
        let given = self.span();
        let word =
            if self.kind() == PropertyTokenKind::Word { self.this_word().to_owned() } else { String::new() };
        let digits = word.trim_end_matches(|character: char| character.is_ascii_alphabetic());
        let mut unit = word[digits.len()..].to_owned();
        if !digits.is_empty() {
            self.next += 1;
            if unit.is_empty() && (self.is("s") || self.is("ms")) {
                unit = self.this_word().to_owned();
                self.next += 1;
            }
        }
        match milliseconds(digits, &unit) {
            Some(bound) => Ok(Some(Duration::from_millis(bound))),
            None => {
                let span = if digits.is_empty() { begin } else { given };
                let message = "a bound is a whole number of milliseconds, from 1 ms to a day".into();
                self.refuse("E0847", span, message, "write `within 2 s` or `within 500 ms`")
            }
        }
    }

    fn missing<T>(&mut self) -> Parsed<T> {
        let message = format!("{} found, expected a formula", self.this());
        let hint = match self.text_of(self.span()) {
            "!" => "write `not`",
            "&" => "write `and`",
            "|" => "write `or`",
            "-" | "=" => "write `implies`",
            _ => {
                "a formula starts with `always`, `eventually`, `not`, `in`, `entering`, `leaving`, `event`, `[` or `(`"
            }
        };
        self.refuse("E0841", self.span(), message, hint)
    }

    fn unclosed<T>(&mut self) -> Parsed<T> {
        let span = self.span();
        let (message, hint) = match self.text_of(span).chars().next() {
            Some('[') => ("the condition is not closed", "close it with `]`"),
            _ => ("the quotes are not closed", "close them in the same line"),
        };
        self.refuse("E0842", Span::new(span.start, span.start + 1), message.into(), hint)
    }

    fn deeper<T>(&mut self, parse: impl FnOnce(&mut Self) -> Parsed<T>) -> Parsed<T> {
        if self.depth == MAX_DEPTH {
            let message = format!("formulas nest at most {MAX_DEPTH} levels deep");
            return self.refuse("E0844", self.span(), message, "split it into several properties");
        }
        self.depth += 1;
        let parsed = parse(self);
        self.depth -= 1;
        parsed
    }

    fn refuse<T>(&mut self, code: &'static str, span: Span, message: String, hint: &str) -> Parsed<T> {
        // an unclosed quote or bracket is the cause of the error, whatever was expected
        if self.kind() == PropertyTokenKind::Unclosed && code != "E0842" {
            return self.unclosed();
        }
        self.found.push(Diagnostic::error(code, span, message).with_hint(hint));
        Err(ErrorReported)
    }

    fn token(&self) -> Token {
        self.tokens[self.next.min(self.tokens.len() - 1)]
    }

    fn kind(&self) -> PropertyTokenKind {
        self.token().kind
    }

    fn span(&self) -> Span {
        self.token().span
    }

    fn text_of(&self, span: Span) -> &str {
        self.text.get(span.start..span.end).unwrap_or_default()
    }

    fn this_word(&self) -> &str {
        self.text_of(self.span())
    }

    /// The current token in diagnostics.
    fn this(&self) -> String {
        match self.kind() {
            PropertyTokenKind::End => "the end of the file".into(),
            PropertyTokenKind::Condition => "a condition".into(),
            _ => format!("`{}`", self.this_word()),
        }
    }

    fn is(&self, word: &str) -> bool {
        self.kind() == PropertyTokenKind::Word && self.this_word() == word
    }

    fn accept(&mut self, word: &str) -> bool {
        let is_there = self.is(word);
        self.next += usize::from(is_there);
        is_there
    }
}

fn spanning(
    left: PropertyFormula,
    right: PropertyFormula,
    kind: impl FnOnce(Box<PropertyFormula>, Box<PropertyFormula>) -> PropertyFormulaKind,
) -> PropertyFormula {
    let position = TextPosition(left.span().to(right.span()));
    PropertyFormula { kind: kind(Box::new(left), Box::new(right)), position }
}

/// Converts `2` or `0.5` with the unit `s`, or `500` with `ms`.
fn milliseconds(digits: &str, unit: &str) -> Option<u64> {
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, "0"));
    let is_number = |text: &str| !text.is_empty() && text.chars().all(|character| character.is_ascii_digit());
    if !is_number(whole) || !is_number(fraction) || fraction.len() > 9 {
        return None;
    }
    let factor = match unit {
        "ms" => 1,
        "s" => 1_000,
        _ => return None,
    };
    let scale = 10_u64.pow(fraction.len() as u32);
    let parts = fraction.parse::<u64>().ok()?.checked_mul(factor)?;
    let bound = whole.parse::<u64>().ok()?.checked_mul(factor)?.checked_add(parts / scale)?;
    (parts % scale == 0 && (1..=MAX_BOUND).contains(&bound)).then_some(bound)
}

/// The first part of a condition that does not depend on messages.
fn foreign(expression: &Expression) -> Option<(Span, &'static str)> {
    expression.find_map(&mut |part| {
        let what = match &part.kind {
            ExpressionKind::In(_) => "In",
            ExpressionKind::TimeoutCheck(_) => "TimeoutCheck",
            ExpressionKind::Script(_) => "script",
            _ => return None,
        };
        Some((part.span(), what))
    })
}
