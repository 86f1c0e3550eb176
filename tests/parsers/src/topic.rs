//! Topic paths, subscription patterns and access lists: each is accepted or rejected with an error,
//! and a list allows what its valid lines allow.

use monas_link::AccessList;
use monas_robot as _;
use narukom::Hub;

use crate::text_of;

/// Checks the documented guarantees for one input.
pub fn topic(data: &[u8]) {
    let text = text_of(data);
    let Ok(hub) = Hub::with_linked_topics("host") else { panic!("the topics contradict each other") };
    let path = hub.topic(text).and_then(|slot| hub.declaration(slot)).map(|topic| topic.path());
    assert!(path.is_none_or(|path| path == text), "`{text}` is taken for `{path:?}`");
    assert_eq!(hub.blackboard("reader").slot(text), hub.topic(text));
    match hub.subscriber(text) {
        Ok(subscriber) => assert!(subscriber.topics().count() > 0),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    access(text);
}

fn access(text: &str) {
    let (list, errors) = AccessList::parse(text);
    assert!(!list.is_open() && errors.len() <= text.lines().count());
    for error in errors {
        assert!((1..=text.lines().count()).contains(&error.line) && !error.message.is_empty());
    }
    for line in text.lines() {
        let (one, errors) = AccessList::parse(line);
        let words: Vec<&str> = line.split_whitespace().collect();
        if let ([host, "publish", path], [], false) = (&words[..], &errors[..], line.contains(['#', '*'])) {
            assert!(one.may_publish(host, path) && list.may_publish(host, path), "{line}");
        }
    }
}
