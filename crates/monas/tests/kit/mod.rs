//! What the tests of this folder share.
#![allow(dead_code, unused_imports)] // not every test needs all of it

use std::sync::{Arc, Mutex};

use monas::Moment;

mod messages {
    #![allow(unreachable_pub)]
    narukom::include_messages!("monas.test");
}
pub(crate) use messages::{Ball, Game, Phase};

narukom::topic! {
    /// Where the ball is.
    pub(crate) BALL: narukom::State<Ball> = "test/ball";
    /// What the game is at.
    pub(crate) GAME: narukom::State<Game> = "test/game";
    /// Something has happened.
    pub(crate) NEWS: narukom::Signal<Ball> = "test/news";
}

/// The moment so many milliseconds after the start.
pub(crate) fn at(millis: u64) -> Moment {
    Moment::from_nanos(millis * 1_000_000)
}

/// What was noted since it was last asked.
pub(crate) struct Recorder<T>(Arc<Mutex<Vec<T>>>);

impl<T> Recorder<T> {
    pub(crate) fn taken(&self) -> Vec<T> {
        std::mem::take(&mut *self.0.lock().unwrap())
    }
}

/// A recorder and the function that notes.
pub(crate) fn recorder<T: Send + 'static>() -> (Recorder<T>, impl Fn(T) + Clone + Send + 'static) {
    let list = Arc::new(Mutex::new(Vec::new()));
    let noted = list.clone();
    (Recorder(list), move |value| noted.lock().unwrap().push(value))
}
