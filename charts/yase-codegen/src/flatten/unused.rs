//! Removal of unused conditions and actions.

use super::{FlatMachine, FlatOp, FlatPath};

impl FlatMachine {
    /// Removes conditions that are never read and actions that are never executed, for example
    /// those of unreachable states.
    pub(crate) fn without_unused(mut self) -> FlatMachine {
        let mut conditions = Renumbering::new(self.conditions.len());
        let mut actions = Renumbering::new(self.actions.len());
        for path in self.all_paths() {
            for_each_piece(path, &mut |piece| match piece {
                FlatOp::Do(action) => actions.mark_used(*action),
                FlatOp::If(condition, _) => conditions.mark_used(*condition),
            });
        }
        for path in self.all_paths() {
            for_each_piece(path, &mut |piece| match piece {
                FlatOp::Do(action) => *action = actions.number(*action),
                FlatOp::If(condition, _) => *condition = conditions.number(*condition),
            });
        }
        self.conditions = conditions.of(self.conditions);
        self.actions = actions.of(self.actions);
        self
    }

    fn all_paths(&mut self) -> impl Iterator<Item = &mut FlatPath> {
        std::iter::once(&mut self.start).chain(self.paths.iter_mut().flatten())
    }
}

fn for_each_piece(path: &mut FlatPath, visit: &mut dyn FnMut(&mut FlatOp)) {
    for piece in &mut path.pieces {
        visit(piece);
        if let FlatOp::If(_, other) = piece {
            for_each_piece(other, visit);
        }
    }
}

/// The entries of a list that are kept.
struct Renumbering(Vec<bool>);

impl Renumbering {
    fn new(count: usize) -> Renumbering {
        Renumbering(vec![false; count])
    }

    fn mark_used(&mut self, number: usize) {
        self.0[number] = true;
    }

    /// The index among those that are kept.
    fn number(&self, number: usize) -> usize {
        self.0[..number].iter().filter(|is_kept| **is_kept).count()
    }

    fn of(&self, texts: Vec<String>) -> Vec<String> {
        texts.into_iter().zip(&self.0).filter_map(|(text, is_kept)| is_kept.then_some(text)).collect()
    }
}
