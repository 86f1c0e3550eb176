//! The observers of a run.

use std::sync::{Arc, Mutex, PoisonError};

use narukom::{Observer, Publication};

/// The observers of all hubs, called one at a time.
#[derive(Clone)]
pub(crate) struct SharedObservers(Arc<Mutex<Vec<Box<dyn Observer>>>>);

impl SharedObservers {
    pub(crate) fn new(observers: Vec<Box<dyn Observer>>) -> SharedObservers {
        SharedObservers(Arc::new(Mutex::new(observers)))
    }

    fn each(&self, act: impl FnMut(&mut Box<dyn Observer>)) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).iter_mut().for_each(act);
    }
}

impl Observer for SharedObservers {
    fn observe(&mut self, publication: Publication<'_>) {
        self.each(|observer| observer.observe(publication));
    }

    fn observe_received(&mut self, publication: Publication<'_>) {
        self.each(|observer| observer.observe_received(publication));
    }
}
