//! Writer of an [`ItemDocument`], always in the same layout.

use std::fmt;

use super::{Comments, Item, ItemDocument};

impl fmt::Display for ItemDocument {
    /// Separates items by empty lines and keeps indentation and comments.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, item) in self.items.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            item.fmt(f)?;
        }
        if !self.tail.is_empty() && !self.items.is_empty() {
            writeln!(f)?;
        }
        self.tail.iter().try_for_each(|comment| writeln!(f, "{comment}"))
    }
}

impl fmt::Display for Item {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let blank = if self.name.text.is_empty() { "" } else { " " };
        line(f, 0, &format!("{}:{blank}{}", self.word.text, self.name.text), &self.comments)?;
        self.lines.iter().try_for_each(|below| line(f, below.indent, &below.content.text, &below.comments))
    }
}

fn line(f: &mut fmt::Formatter<'_>, indent: usize, content: &str, comments: &Comments) -> fmt::Result {
    for comment in &comments.above {
        writeln!(f, "{:indent$}{comment}", "")?;
    }
    match comments.trailing.as_str() {
        "" => writeln!(f, "{:indent$}{content}", ""),
        beside => writeln!(f, "{:indent$}{content}  {beside}", ""),
    }
}
