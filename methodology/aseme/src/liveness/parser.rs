//! The parser of expressions, with an explicit stack instead of recursion.

use yase::{Diagnostic, Span};

use super::lexer::{self, FormulaTokenKind, Token};
use super::{Liveness, Term, TermId};
use crate::text::is_name_character;

/// Parses one expression; its terms are added to the arena, operands before their operator.
pub(crate) fn parse_expression(
    text: &str,
    body: Span,
    liveness: &mut Liveness,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<TermId> {
    let tokens = lexer::tokens(text, body, diagnostics);
    let top = Level::new(Bracket::None, Span::new(body.start.saturating_sub(1), body.start));
    let mut parser = Parser { text, liveness, diagnostics, top, outer: Vec::new(), open: [0; 4] };
    let mut tokens = tokens.into_iter().peekable();
    while let Some(token) = tokens.next() {
        if parser.ends_copies(token) {
            let count = tokens.next_if(|next| next.kind == FormulaTokenKind::Name);
            parser.close_copies(token, count);
        } else {
            parser.accept(token);
        }
    }
    parser.finish()
}

/// The bracket that opened a nesting level.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Bracket {
    None,
    Group,
    Option,
    Copies,
}

impl Bracket {
    fn opening(self) -> &'static str {
        match self {
            Bracket::None => "=",
            Bracket::Group => "(",
            Bracket::Option => "[",
            Bracket::Copies => "|",
        }
    }

    fn closing(self) -> &'static str {
        match self {
            Bracket::None => "",
            Bracket::Group => ")",
            Bracket::Option => "]",
            Bracket::Copies => "|n",
        }
    }
}

/// An open nesting level: the operands of the three binary operators, ordered by increasing
/// precedence.
struct Level {
    bracket: Bracket,
    opened: Span,
    parallel: Vec<TermId>,
    choice: Vec<TermId>,
    sequence: Vec<TermId>,
    /// The binary operator that waits for its right operand.
    pending: Option<Span>,
    /// Whether an operand is expected next.
    expects: bool,
}

impl Level {
    fn new(bracket: Bracket, opened: Span) -> Level {
        let (parallel, choice, sequence) = (Vec::new(), Vec::new(), Vec::new());
        Level { bracket, opened, parallel, choice, sequence, pending: None, expects: true }
    }
}

struct Parser<'a> {
    text: &'a str,
    liveness: &'a mut Liveness,
    diagnostics: &'a mut Vec<Diagnostic>,
    top: Level,
    outer: Vec<Level>,
    /// The number of open levels by kind of bracket.
    open: [usize; 4],
}

impl Parser<'_> {
    fn accept(&mut self, token: Token) {
        match token.kind {
            FormulaTokenKind::Name => self.name(token),
            FormulaTokenKind::Open => self.open(Bracket::Group, token),
            FormulaTokenKind::OpenOption => self.open(Bracket::Option, token),
            FormulaTokenKind::Bar if self.top.expects && self.begins_term(token.span.end) => {
                self.open(Bracket::Copies, token)
            }
            FormulaTokenKind::Close => self.close(Bracket::Group, token),
            FormulaTokenKind::CloseOption => self.close(Bracket::Option, token),
            FormulaTokenKind::Star | FormulaTokenKind::Plus | FormulaTokenKind::Forever => {
                self.postfix(token)
            }
            FormulaTokenKind::Dot | FormulaTokenKind::Bar | FormulaTokenKind::DoubleBar => self.binary(token),
        }
    }

    fn name(&mut self, token: Token) {
        self.before_operand(token);
        let name = Term::Name(self.spelled(token.span).into());
        let id = self.liveness.push(name, token.span);
        self.operand(Some(id));
    }

    fn open(&mut self, bracket: Bracket, token: Token) {
        self.before_operand(token);
        let outer = std::mem::replace(&mut self.top, Level::new(bracket, token.span));
        self.outer.push(outer);
        self.open[bracket as usize] += 1;
    }

    /// Removes the innermost level, unless it is the outermost.
    fn leave(&mut self) -> Option<Level> {
        let outer = self.outer.pop()?;
        let level = std::mem::replace(&mut self.top, outer);
        self.open[level.bracket as usize] -= 1;
        Some(level)
    }

    fn close(&mut self, bracket: Bracket, token: Token) {
        if self.open[bracket as usize] == 0 {
            let message = format!("`{}` closes no bracket", bracket.closing());
            return self.error(
                "E0206",
                token.span,
                message,
                &format!("add a `{}` or remove this", bracket.opening()),
            );
        }
        while self.top.bracket != bracket {
            self.close_missing(token.span.start);
        }
        self.end_level(token.span);
    }

    fn postfix(&mut self, token: Token) {
        if self.top.expects {
            let message = format!("`{}` has no operand", self.spelled(token.span));
            return self.error("E0209", token.span, message, "write the activity or group first, as in `x~`");
        }
        let Some(operand) = self.top.sequence.pop() else { return };
        let term = match token.kind {
            FormulaTokenKind::Star => Term::ZeroOrMore(operand),
            FormulaTokenKind::Plus => Term::OneOrMore(operand),
            _ => Term::Forever(operand),
        };
        let span = self.liveness.span(operand).to(token.span);
        let id = self.liveness.push(term, span);
        self.operand(Some(id));
    }

    fn binary(&mut self, token: Token) {
        if self.top.expects {
            let message = format!("there is nothing to the left of `{}`", self.spelled(token.span));
            return self.error("E0205", token.span, message, "an operator connects two terms");
        }
        self.leave_copies();
        match token.kind {
            FormulaTokenKind::Bar => self.end_sequence(),
            FormulaTokenKind::DoubleBar => self.end_choice(),
            _ => {}
        }
        (self.top.pending, self.top.expects) = (Some(token.span), true);
    }

    fn finish(mut self) -> Option<TermId> {
        let end = self.liveness.spans.last().map_or(0, |span| span.end);
        while !self.outer.is_empty() {
            self.close_missing(end);
        }
        let top = std::mem::replace(&mut self.top, Level::new(Bracket::None, Span::default()));
        self.end_expression(top)
    }
}

/// Operands and nesting levels.
impl Parser<'_> {
    /// Starts an operand; reports one directly before it.
    fn before_operand(&mut self, token: Token) {
        if !self.top.expects {
            self.leave_copies();
            let message = format!("there is no operator before `{}`", self.spelled(token.span));
            let hint = "write `.` for a sequence, `|` for a choice, `||` for parallel";
            self.error("E0208", token.span, message, hint);
        }
    }

    /// Completes an operand; `None` if it was reported and skipped.
    fn operand(&mut self, id: Option<TermId>) {
        self.top.sequence.extend(id);
        (self.top.pending, self.top.expects) = (None, false);
    }

    /// Ends the innermost level at its closing bracket.
    fn end_level(&mut self, closing: Span) {
        let Some(level) = self.leave() else { return };
        let (bracket, span) = (level.bracket, level.opened.to(closing));
        let inner = self.end_expression(level);
        let id = inner.map(|inner| {
            let term = if bracket == Bracket::Option { Term::Optional(inner) } else { Term::Group(inner) };
            self.liveness.push(term, span)
        });
        self.operand(id);
    }

    /// Ends the innermost level whose closing bracket is missing.
    fn close_missing(&mut self, index: usize) {
        if self.top.bracket == Bracket::Copies {
            return self.leave_copies();
        }
        let Level { bracket, opened, .. } = self.top;
        let message = format!("`{}` is never closed", bracket.opening());
        self.error("E0206", opened, message, &format!("add the missing `{}`", bracket.closing()));
        self.end_level(Span::new(index, index));
    }

    fn end_sequence(&mut self) {
        let sequence = std::mem::take(&mut self.top.sequence);
        let alternative = self.n_ary(sequence, Term::Sequence);
        self.top.choice.extend(alternative);
    }

    fn end_choice(&mut self) {
        self.end_sequence();
        let choice = std::mem::take(&mut self.top.choice);
        let region = self.n_ary(choice, Term::Choice);
        self.top.parallel.extend(region);
    }

    fn end_expression(&mut self, mut level: Level) -> Option<TermId> {
        if let Some(operator) = level.pending {
            let message = format!("there is nothing to the right of `{}`", self.spelled(operator));
            self.error("E0205", operator, message, "an operator connects two terms");
        } else if level.expects {
            let message = format!("nothing follows `{}`", level.bracket.opening());
            self.error("E0207", level.opened, message, "write at least the name of an activity");
        }
        let last = self.n_ary(level.sequence, Term::Sequence);
        level.choice.extend(last);
        let last = self.n_ary(level.choice, Term::Choice);
        level.parallel.extend(last);
        self.n_ary(level.parallel, Term::Parallel)
    }

    fn n_ary(&mut self, operands: Vec<TermId>, term: fn(Vec<TermId>) -> Term) -> Option<TermId> {
        match *operands.as_slice() {
            [] => None,
            [only] => Some(only),
            [first, .., last] => {
                let span = self.liveness.span(first).to(self.liveness.span(last));
                self.warn_of_mixing(&operands, span);
                Some(self.liveness.push(term(operands), span))
            }
        }
    }

    /// Warns once per outermost expression that mixes operators.
    fn warn_of_mixing(&mut self, operands: &[TermId], span: Span) {
        let is_bare = |id: &TermId| matches!(self.liveness.term(*id), Term::Sequence(_) | Term::Choice(_));
        if operands.iter().any(is_bare) {
            self.diagnostics.pop_if(|last| last.code == "E0210" && span.start <= last.span.start);
            let message = "different operators are mixed without parentheses";
            let hint = "`.` binds tighter than `|`, `|` tighter than `||`; add parentheses";
            self.diagnostics.push(Diagnostic::warning("E0210", span, message).with_hint(hint));
        }
    }

    fn error(&mut self, code: &'static str, span: Span, message: impl Into<String>, hint: &str) {
        self.diagnostics.push(Diagnostic::error(code, span, message).with_hint(hint));
    }

    fn spelled(&self, span: Span) -> &str {
        &self.text[span.start..span.end]
    }
}

/// `|x~|n`.
impl Parser<'_> {
    /// Whether a term starts at a token: then a `|` before it, where an operand is expected, starts
    /// copies.
    fn begins_term(&self, index: usize) -> bool {
        let rest = self.text[index..].trim_start();
        rest.starts_with(|c| matches!(c, '(' | '[' | '|') || is_name_character(c))
    }

    fn ends_copies(&self, token: Token) -> bool {
        self.top.bracket == Bracket::Copies && !self.top.expects && token.kind == FormulaTokenKind::Bar
    }

    fn close_copies(&mut self, bar: Token, count: Option<Token>) {
        let Some(level) = self.leave() else { return };
        let span = level.opened.to(count.map_or(bar.span, |count| count.span));
        let Some(term) = self.end_expression(level) else { return self.operand(None) };
        if !matches!(self.liveness.term(term), Term::Forever(_)) {
            self.error(
                "E0212",
                self.liveness.span(term),
                "only an endless term can be copied",
                "write `|x~|n`",
            );
            return self.operand(Some(term));
        }
        let number = count.and_then(|count| self.spelled(count.span).parse().ok());
        let Some(count) = number.filter(|&number| number > 0) else {
            let hint = "add a whole number from 1, as in `|x~|3`";
            self.error("E0211", span, "the number of copies is missing", hint);
            return self.operand(Some(term));
        };
        let id = self.liveness.push(Term::Copies { term, count }, span);
        self.operand(Some(id));
    }

    /// Removes an open level of copies that no `|n` ended.
    fn leave_copies(&mut self) {
        while self.top.bracket == Bracket::Copies {
            let Some(level) = self.leave() else { return };
            let hint = "copies are written `|x~|n`, of several terms `|(x . y)~|n`";
            self.error("E0212", level.opened, "this `|` starts copies that no `|n` ends", hint);
            let term = self.end_expression(level);
            self.operand(term);
        }
    }
}
