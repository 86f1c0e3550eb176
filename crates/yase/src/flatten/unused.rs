//! Conditions and actions that never come up are left out.

use super::{Flat, Piece, Way};

impl Flat {
    /// Without the conditions that are never asked and the actions that are never done: of states that are never reached, for example.
    pub(super) fn without_unused(mut self) -> Flat {
        let mut conditions = Kept::new(self.conditions.len());
        let mut actions = Kept::new(self.actions.len());
        for way in self.every_way() {
            for_each_piece(way, &mut |piece| match piece {
                Piece::Do(action) => actions.keep(*action),
                Piece::If(condition, _) => conditions.keep(*condition),
            });
        }
        for way in self.every_way() {
            for_each_piece(way, &mut |piece| match piece {
                Piece::Do(action) => *action = actions.number(*action),
                Piece::If(condition, _) => *condition = conditions.number(*condition),
            });
        }
        self.conditions = conditions.of(self.conditions);
        self.actions = actions.of(self.actions);
        self
    }

    fn every_way(&mut self) -> impl Iterator<Item = &mut Way> {
        std::iter::once(&mut self.start).chain(self.ways.iter_mut().flatten())
    }
}

fn for_each_piece(way: &mut Way, told: &mut dyn FnMut(&mut Piece)) {
    for piece in &mut way.pieces {
        told(piece);
        if let Piece::If(_, other) = piece {
            for_each_piece(other, told);
        }
    }
}

/// Which of a list are kept.
struct Kept(Vec<bool>);

impl Kept {
    fn new(count: usize) -> Kept {
        Kept(vec![false; count])
    }

    fn keep(&mut self, number: usize) {
        self.0[number] = true;
    }

    /// The number among those that are kept.
    fn number(&self, number: usize) -> usize {
        self.0[..number].iter().filter(|is_kept| **is_kept).count()
    }

    fn of(&self, texts: Vec<String>) -> Vec<String> {
        texts.into_iter().zip(&self.0).filter_map(|(text, is_kept)| is_kept.then_some(text)).collect()
    }
}
