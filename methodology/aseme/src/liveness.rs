//! Liveness formulas: the behaviour of a role as an expression over activities.
//!
//! [`parse`] reads a text into a [`Liveness`]: formulas in the order of the text, the first for the
//! role, and their terms in one flat arena. Terms refer to each other by [`TermId`], so nesting
//! needs no stack: a hundred thousand parentheses parse, print and drop.
//!
//! | text | meaning |
//! |---|---|
//! | `x . y` | y after x |
//! | `x \| y` | x or y |
//! | `x \|\| y` | x and y together |
//! | `x*`, `x+` | x any number of times, or at least once |
//! | `xω`, `x~`, `x^ω` | x forever |
//! | `[x]` | x or nothing |
//! | `\|xω\|n`, `\|xω\|^n` | n copies of `xω` together |
//! | `(x)` | a group |
//!
//! Blanks are ignored (but `| |x~|2~|3`, copies of copies, needs one between its bars), `#` begins
//! a comment, and a line without `=` continues the formula above it. Different operators may be
//! mixed without parentheses, `.` binding tighter than `|` and `|` tighter than `||`, with a
//! warning: the original notation requires parentheses.
//!
//! ```
//! let (liveness, findings) = aseme::liveness::parse("decision = Wait . ( Search | act )\nact = Kick+");
//! assert!(findings.is_empty());
//! assert_eq!(liveness.to_string(), "decision = Wait . (Search | act)\nact = Kick+\n");
//! ```

mod check;
mod lexer;
mod parser;
mod print;

pub use lexer::OPEN_OPERATOR;

use std::collections::BTreeMap;
use std::ops::Range;

use yase::{Diagnostic, Span};

use crate::text;

/// The deepest accepted nesting of states.
pub const MAX_LEVELS: usize = 256;

/// A term, as an index into the arena of its [`Liveness`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct TermId(u32);

/// One term of a formula.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Term {
    /// An activity, or a reference to the formula of that name.
    Name(String),
    /// `x . y`: in sequence.
    Sequence(Vec<TermId>),
    /// `x | y`: exactly one of them.
    Choice(Vec<TermId>),
    /// `x || y`: all in parallel.
    Parallel(Vec<TermId>),
    /// `[x]`: zero or one time.
    Optional(TermId),
    /// `x*`: zero or more times.
    ZeroOrMore(TermId),
    /// `x+`: one or more times.
    OneOrMore(TermId),
    /// `x~`: repeated without end.
    Forever(TermId),
    /// `|x~|n`: parallel copies of an endless term.
    Copies {
        /// The term that is copied; of kind [`Forever`](Term::Forever).
        term: TermId,
        /// The number of copies, at least one.
        count: u32,
    },
    /// `(x)`: a term in parentheses, kept because names of states are made from the text.
    Group(TermId),
}

/// `name = expression`.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Formula {
    /// The left-hand side.
    pub name: String,
    /// The span of the left-hand side.
    pub name_span: Span,
    /// The right-hand side; `None` if it could not be parsed at all.
    pub expression: Option<TermId>,
    /// From the left-hand side to the end of the last line.
    pub span: Span,
    terms: Range<usize>,
}

/// The formulas of one role. The first says what the role does; the others refine names that occur
/// in it.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Liveness {
    formulas: Vec<Formula>,
    terms: Vec<Term>,
    spans: Vec<Span>,
}

/// Parses formulas. Invalid parts are skipped and reported; codes are E0201 to E0219.
pub fn parse(text: &str) -> (Liveness, Vec<Diagnostic>) {
    parse_section(&text::without_comments(text), Span::new(0, text.len()))
}

/// Parses the formulas in a section of a text whose comments are blanked; spans are relative to the
/// whole text.
pub fn parse_section(blanked: &str, section: Span) -> (Liveness, Vec<Diagnostic>) {
    let mut liveness = Liveness::default();
    let mut diagnostics = Vec::new();
    for lines in split(blanked, section, &mut diagnostics) {
        let terms = liveness.terms.len();
        let expression = parser::parse_expression(blanked, lines.body, &mut liveness, &mut diagnostics);
        let (name, name_span, span) = (lines.name(blanked), lines.name, lines.name.to(lines.body));
        let span = text::trimmed(blanked, span);
        let terms = terms..liveness.terms.len();
        liveness.formulas.push(Formula { name, name_span, expression, span, terms });
    }
    if liveness.formulas.is_empty() && diagnostics.is_empty() {
        diagnostics.push(
            Diagnostic::error("E0216", section, "there is no formula")
                .with_hint("write `role = activity1 . activity2`"),
        );
    }
    diagnostics.extend(check::check(&liveness));
    (liveness, diagnostics)
}

impl Liveness {
    /// The formulas, in the order of the text; the first is the role's.
    pub fn formulas(&self) -> &[Formula] {
        &self.formulas
    }

    /// A term.
    pub fn term(&self, id: TermId) -> &Term {
        &self.terms[id.0 as usize]
    }

    /// The span of a term.
    pub fn span(&self, id: TermId) -> Span {
        self.spans[id.0 as usize]
    }

    /// The names in a formula with their spans, in the order of the text.
    pub fn names(&self, formula: &Formula) -> impl Iterator<Item = (&str, Span)> {
        formula.terms.clone().filter_map(|index| match &self.terms[index] {
            Term::Name(name) => Some((name.as_str(), self.spans[index])),
            _ => None,
        })
    }

    /// The indices of the formulas by left-hand side; of duplicates, the first.
    pub fn by_name(&self) -> BTreeMap<&str, usize> {
        let mut by_name = BTreeMap::new();
        for (index, formula) in self.formulas.iter().enumerate() {
            by_name.entry(formula.name.as_str()).or_insert(index);
        }
        by_name
    }

    fn push(&mut self, term: Term, span: Span) -> TermId {
        self.terms.push(term);
        self.spans.push(span);
        TermId(self.terms.len() as u32 - 1)
    }
}

/// The lines of one formula: its left-hand side, and the text after `=` up to the next formula.
struct FormulaLines {
    name: Span,
    body: Span,
}

impl FormulaLines {
    fn name(&self, text: &str) -> String {
        text[self.name.start..self.name.end].into()
    }
}

fn split(text: &str, section: Span, diagnostics: &mut Vec<Diagnostic>) -> Vec<FormulaLines> {
    let mut formulas: Vec<FormulaLines> = Vec::new();
    for line in text::lines_of(text, section) {
        let content = text::trimmed(text, line);
        if content.start == content.end {
            continue;
        }
        match (text[line.start..line.end].find('='), formulas.last_mut()) {
            (Some(equals), _) => formulas.push(begin(text, line, line.start + equals, diagnostics)),
            (None, Some(formula)) => formula.body.end = line.end,
            (None, None) => diagnostics.push(
                Diagnostic::error("E0201", content, "this line belongs to no formula")
                    .with_hint("a formula starts with `name =`"),
            ),
        }
    }
    formulas
}

fn begin(text: &str, line: Span, equals: usize, diagnostics: &mut Vec<Diagnostic>) -> FormulaLines {
    let name = text::trimmed(text, Span::new(line.start, equals));
    if !text::is_name(&text[name.start..name.end]) {
        let span = if name.start == name.end { Span::new(equals, equals + 1) } else { name };
        let message = format!("`{}` is not a name to the left of `=`", &text[name.start..name.end]);
        let hint = "a name has ASCII letters, digits and underscores";
        diagnostics.push(Diagnostic::error("E0202", span, message).with_hint(hint));
    }
    let mut body = Span::new(equals + 1, line.end);
    if let Some(second) = text[body.start..body.end].find('=') {
        let span = Span::new(body.start + second, body.end);
        let hint = "each formula starts on its own line";
        diagnostics.push(Diagnostic::error("E0203", span, "a second `=` in one formula").with_hint(hint));
        body.end = span.start;
    }
    FormulaLines { name, body }
}
