//! The lexer of formulas.

use yase::{Diagnostic, Span};

use crate::text::{is_forever, is_name_character};

/// Stands between operands whose operator the analyst has yet to choose.
pub const OPEN_OPERATOR: &str = "?OP?";

/// The kind of a token.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum FormulaTokenKind {
    Name,
    Dot,
    Bar,
    DoubleBar,
    Star,
    Plus,
    Forever,
    Open,
    Close,
    OpenOption,
    CloseOption,
}

/// A token and its span.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Token {
    pub(crate) kind: FormulaTokenKind,
    pub(crate) span: Span,
}

/// The tokens of a part of a text; other characters are reported.
pub(crate) fn tokens(text: &str, part: Span, diagnostics: &mut Vec<Diagnostic>) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut at = part.start;
    while let Some(character) = text[at..part.end].chars().next() {
        let rest = &text[at..part.end];
        if rest.starts_with(OPEN_OPERATOR) {
            let span = Span::new(at, at + OPEN_OPERATOR.len());
            let message = format!("`{OPEN_OPERATOR}` stands for an operator that is to be chosen");
            let hint = "`.` for one after the other, `|` for one of them, `||` for both together";
            diagnostics.push(Diagnostic::error("E0219", span, message).with_hint(hint));
            tokens.push(Token { kind: FormulaTokenKind::Dot, span });
            at = span.end;
            continue;
        }
        let (kind, length) = recognize(rest, character);
        let span = Span::new(at, at + length);
        match kind {
            Some(kind) => tokens.push(Token { kind, span }),
            None if is_ignored(rest, character) => {}
            None => report(text, span, diagnostics),
        }
        at = span.end;
    }
    tokens
}

fn recognize(rest: &str, character: char) -> (Option<FormulaTokenKind>, usize) {
    let kind = match character {
        '.' => FormulaTokenKind::Dot,
        '|' if rest.starts_with("||") => return (Some(FormulaTokenKind::DoubleBar), 2),
        '|' => FormulaTokenKind::Bar,
        '*' => FormulaTokenKind::Star,
        '+' => FormulaTokenKind::Plus,
        '(' => FormulaTokenKind::Open,
        ')' => FormulaTokenKind::Close,
        '[' => FormulaTokenKind::OpenOption,
        ']' => FormulaTokenKind::CloseOption,
        _ if is_forever(character) => FormulaTokenKind::Forever,
        _ if is_name_character(character) => {
            return (
                Some(FormulaTokenKind::Name),
                rest.find(|c| !is_name_character(c)).unwrap_or(rest.len()),
            );
        }
        _ => return (None, character.len_utf8()),
    };
    (Some(kind), character.len_utf8())
}

/// White space, and the `^` before an exponent.
fn is_ignored(rest: &str, character: char) -> bool {
    let exponent = |c: char| is_forever(c) || matches!(c, '*' | '+') || c.is_ascii_digit();
    character.is_whitespace() || character == '^' && rest[1..].trim_start().starts_with(exponent)
}

/// Reports an invalid character, or extends the report on the adjacent one.
fn report(text: &str, span: Span, diagnostics: &mut Vec<Diagnostic>) {
    let span = match diagnostics.pop_if(|last| last.code == "E0204" && last.span.end == span.start) {
        Some(last) => last.span.to(span),
        None => span,
    };
    let message = format!("`{}` has no meaning in a formula", &text[span.start..span.end]);
    let hint = "names have ASCII letters, digits and underscores; operators are . | || * + ~ ω [ ] ( )";
    diagnostics.push(Diagnostic::error("E0204", span, message).with_hint(hint));
}
