//! Quoting for the shell of a robot.

/// Quotes a word so that a shell takes it literally.
pub(crate) fn quoted(word: &str) -> String {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "_-./=:@%+,".contains(letter);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn words_reach_the_robot_as_they_are() {
        assert_eq!(quoted("config/agents.xml"), "config/agents.xml");
        assert_eq!(quoted("it's $HOME; `x`"), "'it'\\''s $HOME; `x`'");
        assert_eq!(quoted(""), "''");
    }
}
