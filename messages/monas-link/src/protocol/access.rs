//! Access control: a file that lists hosts, topics and rights.

use std::collections::BTreeMap;

use narukom::{is_topic_pattern, pattern_fits};
use thiserror::Error;

/// Lists which hosts may publish on which topics, and which may manage agents.
///
/// Each line is one rule: a host, a right, and its topics, a pattern with the syntax of
/// [`narukom::Hub::subscriber`]. A `#` starts a comment.
///
/// ```text
/// robot_2  publish  soccer/**      # whatever it sees
/// laptop   publish  soccer/command
/// laptop   manage                  # start and stop agents
/// *        publish  soccer/hello   # all hosts
/// ```
///
/// Everything else is forbidden. A transport that checks certificates lets only hosts publish that
/// the list names, also what `*` permits: otherwise each host could use the names of all others.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct AccessList {
    /// By host; `*` stands for every host.
    rules: BTreeMap<String, AccessRights>,
    /// Whether there is no list, and everything is allowed.
    is_open: bool,
}

#[derive(Clone, PartialEq, Eq, Default, Debug)]
struct AccessRights {
    publish: Vec<String>,
    manage: bool,
}

/// An invalid line of an access list.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
#[error("line {line}: {message}")]
pub struct AccessError {
    /// The line, from 1.
    pub line: usize,
    /// The cause.
    pub message: String,
}

impl AccessList {
    /// Allows everything to all hosts: for links that no other host can reach.
    pub fn open() -> AccessList {
        AccessList { is_open: true, ..AccessList::default() }
    }

    /// Parses a list; returns the valid rules, and an error for every invalid line.
    pub fn parse(text: &str) -> (AccessList, Vec<AccessError>) {
        let (mut list, mut errors) = (AccessList::default(), Vec::new());
        for (index, line) in text.lines().enumerate() {
            if let Err(message) = list.line(line) {
                errors.push(AccessError { line: index + 1, message });
            }
        }
        (list, errors)
    }

    fn line(&mut self, line: &str) -> Result<(), String> {
        let rule = line.split('#').next().unwrap_or_default();
        let words: Vec<&str> = rule.split_whitespace().collect();
        match words[..] {
            [] => return Ok(()),
            [host, "publish", pattern] if is_topic_pattern(pattern) => {
                self.rights(host).publish.push(pattern.to_owned());
            }
            [_, "publish", pattern] => {
                return Err(format!(
                    "`{pattern}` is not a pattern of topics, such as `soccer/ball` or `soccer/**`"
                ));
            }
            [host, "manage"] => self.rights(host).manage = true,
            [_, "publish"] => return Err("`publish` needs a topic, such as `soccer/ball` or `**`".to_owned()),
            [_, "manage", more, ..] => {
                return Err(format!("`manage` needs nothing more, and there is `{more}`"));
            }
            [_] => return Err("a host needs a right: `publish TOPIC` or `manage`".to_owned()),
            [_, right, ..] => {
                return Err(format!("`{right}` is not a right: there are `publish TOPIC` and `manage`"));
            }
        }
        Ok(())
    }

    fn rights(&mut self, host: &str) -> &mut AccessRights {
        self.rules.entry(host.to_owned()).or_default()
    }

    /// Whether `host` may publish on the topic at `path`.
    pub fn may_publish(&self, host: &str, path: &str) -> bool {
        let allows = |rights: &AccessRights| rights.publish.iter().any(|pattern| pattern_fits(pattern, path));
        self.is_open || self.rights_of(host).any(allows)
    }

    /// Whether `host` may manage agents.
    pub fn may_manage(&self, host: &str) -> bool {
        self.is_open || self.rights_of(host).any(|rights| rights.manage)
    }

    fn rights_of(&self, host: &str) -> impl Iterator<Item = &AccessRights> {
        [host, "*"].into_iter().filter_map(|name| self.rules.get(name))
    }

    /// Whether there is no list, and everything is allowed.
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// The listed hosts, with the patterns of topics that each may publish; those of `*` apply to
    /// every host, with certificates to every listed one.
    pub fn publishers(&self) -> impl Iterator<Item = (&str, &[String])> {
        self.rules.iter().map(|(host, rights)| (host.as_str(), rights.publish.as_slice()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn access_is_denied_without_a_rule() {
        let (list, errors) = AccessList::parse(
            "# the team\nrobot_2 publish soccer/** # all\nlaptop manage\n* publish soccer/hello\n",
        );
        assert_eq!(errors, []);
        assert!(list.may_publish("robot_2", "soccer/ball/seen"));
        assert!(!list.may_publish("robot_2", "body/sensors"));
        assert!(!list.may_publish("robot_3", "soccer/ball"));
        assert!(list.may_publish("robot_3", "soccer/hello"));
        assert!(list.may_manage("laptop"));
        assert!(!list.may_manage("robot_2"));
        assert!(!AccessList::default().may_publish("robot_2", "soccer/ball"));
        assert!(AccessList::open().may_publish("anybody", "anything"));
    }

    #[test]
    fn every_line_that_is_not_understood_is_named() {
        let (list, errors) =
            AccessList::parse("a publish\nb fly\nc publish A//b\nd\ne manage all\nf publish **");
        assert_eq!(errors.iter().map(|error| error.line).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
        assert_eq!(
            errors[1].to_string(),
            "line 2: `fly` is not a right: there are `publish TOPIC` and `manage`"
        );
        assert!(list.may_publish("f", "any/topic"));
    }
}
