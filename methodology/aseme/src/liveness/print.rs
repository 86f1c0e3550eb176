//! The writer of formulas.

use std::fmt::{self, Write};

use super::{Liveness, Term, TermId};

impl fmt::Display for Liveness {
    /// Writes one formula per line, with blanks around binary operators and `~` for forever.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for formula in &self.formulas {
            write!(f, "{} =", formula.name)?;
            if let Some(expression) = formula.expression {
                f.write_char(' ')?;
                self.write(f, expression, Style::Spaced)?;
            }
            f.write_char('\n')?;
        }
        Ok(())
    }
}

impl Liveness {
    /// The name of a term's state: the term as written, without blanks, `~` for forever.
    pub fn compact(&self, term: TermId) -> String {
        let mut text = String::new();
        // writing to a String cannot fail
        let _ = self.write(&mut text, term, Style::Compact);
        text
    }

    fn write(&self, out: &mut impl Write, term: TermId, style: Style) -> fmt::Result {
        let mut pieces = vec![Piece::Term(term)];
        let mut after_bar = false;
        while let Some(piece) = pieces.pop() {
            let is_bar = matches!(piece, Piece::Text("|"));
            // for nested copies, because two adjacent bars would be another operator
            if is_bar && after_bar {
                out.write_str(style.pick("", " "))?;
            }
            after_bar = is_bar || after_bar && matches!(piece, Piece::Term(_));
            match piece {
                Piece::Text(text) => out.write_str(text)?,
                Piece::Count(count) => write!(out, "{count}")?,
                Piece::Term(term) => match self.term(term) {
                    Term::Name(name) => out.write_str(name)?,
                    term => push_pieces(term, style, &mut pieces),
                },
            }
        }
        Ok(())
    }
}

#[derive(Clone, Copy)]
enum Style {
    Compact,
    Spaced,
}

impl Style {
    fn pick(self, compact: &'static str, spaced: &'static str) -> &'static str {
        match self {
            Style::Compact => compact,
            Style::Spaced => spaced,
        }
    }
}

enum Piece {
    Text(&'static str),
    Count(u32),
    Term(TermId),
}

/// Pushes the pieces of a term in reverse order onto the stack.
fn push_pieces(term: &Term, style: Style, pieces: &mut Vec<Piece>) {
    match term {
        Term::Name(_) => {}
        Term::Sequence(items) => push_list(items, style.pick(".", " . "), pieces),
        Term::Choice(items) => push_list(items, style.pick("|", " | "), pieces),
        Term::Parallel(items) => push_list(items, style.pick("||", " || "), pieces),
        Term::Optional(inner) => pieces.extend([Piece::Text("]"), Piece::Term(*inner), Piece::Text("[")]),
        Term::Group(inner) => pieces.extend([Piece::Text(")"), Piece::Term(*inner), Piece::Text("(")]),
        Term::ZeroOrMore(inner) => pieces.extend([Piece::Text("*"), Piece::Term(*inner)]),
        Term::OneOrMore(inner) => pieces.extend([Piece::Text("+"), Piece::Term(*inner)]),
        Term::Forever(inner) => pieces.extend([Piece::Text("~"), Piece::Term(*inner)]),
        Term::Copies { term, count } => {
            pieces.extend([Piece::Count(*count), Piece::Text("|"), Piece::Term(*term), Piece::Text("|")]);
        }
    }
}

fn push_list(items: &[TermId], separator: &'static str, pieces: &mut Vec<Piece>) {
    for (index, item) in items.iter().enumerate().rev() {
        pieces.push(Piece::Term(*item));
        if index > 0 {
            pieces.push(Piece::Text(separator));
        }
    }
}
