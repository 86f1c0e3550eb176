//! Code shared by the tests of this folder.
#![allow(dead_code, unused_imports)] // not every test needs all of it

use std::sync::{Arc, Mutex};

use monas::Timestamp;

mod messages {
    #![allow(unreachable_pub)]
    narukom::include_messages!("monas.test");
}
pub(crate) use messages::{Ball, Game, Phase};

narukom::topic! {
    /// The position of the ball.
    pub(crate) BALL: narukom::State<Ball> = "test/ball";
    /// The state of the game.
    pub(crate) GAME: narukom::State<Game> = "test/game";
    /// An event occurred.
    pub(crate) NEWS: narukom::Signal<Ball> = "test/news";
}

/// A time in milliseconds after the start.
pub(crate) fn at(millis: u64) -> Timestamp {
    Timestamp::from_nanos(millis * 1_000_000)
}

/// Values recorded since the last call.
pub(crate) struct Recorder<T>(Arc<Mutex<Vec<T>>>);

impl<T> Recorder<T> {
    pub(crate) fn taken(&self) -> Vec<T> {
        std::mem::take(&mut *self.0.lock().unwrap())
    }
}

/// A recorder and the function that records.
pub(crate) fn recorder<T: Send + 'static>() -> (Recorder<T>, impl Fn(T) + Clone + Send + 'static) {
    let list = Arc::new(Mutex::new(Vec::new()));
    let noted = list.clone();
    (Recorder(list), move |value| noted.lock().unwrap().push(value))
}
