//! Paths of topics and patterns of subscriptions: each is found, or an error says why not.
#![no_main]

use libfuzzer_sys::fuzz_target;
use monas_robot as _;
use narukom::Narukom;

fuzz_target!(|text: &str| {
    let Ok(hub) = Narukom::with_linked_topics("host") else { panic!("the topics contradict each other") };
    let path = hub.topic(text).and_then(|slot| hub.declaration(slot)).map(|topic| topic.path());
    assert!(path.is_none_or(|path| path == text), "`{text}` is taken for `{path:?}`");
    assert_eq!(hub.blackboard("reader").slot(text), hub.topic(text));
    match hub.subscriber(text) {
        Ok(subscriber) => assert!(subscriber.topics().count() > 0),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
