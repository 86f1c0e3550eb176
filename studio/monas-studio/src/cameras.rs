//! The images and sightings of robots' cameras.

use std::time::Duration;

use serde_json::{Value, json};

use crate::base64::base64;
use crate::chart_view::seconds;
use crate::scene::Scene;

/// The images of a robot's cameras, which a program reads: the studio knows no body.
pub trait Cameras: Send + Sync {
    /// The topic with the images, on the host of each robot that delivers them.
    fn topic(&self) -> &'static str;

    /// The names of the cameras, in the order of their images.
    fn names(&self) -> &[&'static str];

    /// The images of a message from its protobuf encoding, as PNG, one for each camera; none if
    /// they cannot be read.
    fn images(&self, bytes: &[u8]) -> Option<Vec<Vec<u8>>>;
}

/// The interval between two images that a viewer gets.
const INTERVAL: Duration = Duration::from_millis(200);

/// The robot whose images a viewer sees.
#[derive(Debug)]
pub(crate) struct ChosenCamera {
    pub(crate) host: String,
    /// The time since the viewer got images.
    waited: Duration,
}

impl ChosenCamera {
    pub(crate) fn new(host: String) -> ChosenCamera {
        ChosenCamera { host, waited: INTERVAL }
    }

    /// Whether images are due; `elapsed` is the time since the last call.
    pub(crate) fn is_due(&mut self, elapsed: Duration) -> bool {
        self.waited = self.waited.saturating_add(elapsed);
        self.waited >= INTERVAL
    }

    /// The images of a message for the page, as addresses with their data.
    pub(crate) fn object(&mut self, cameras: &dyn Cameras, time: u64, bytes: &[u8]) -> Value {
        self.waited = Duration::ZERO;
        let images = cameras.images(bytes).unwrap_or_default();
        let named = cameras.names().iter().zip(&images);
        let images: Vec<Value> = named
            .map(|(name, png)| json!({"name": name, "url": format!("data:image/png;base64,{}", base64(png))}))
            .collect();
        json!({"host": self.host, "t": seconds(time), "images": images})
    }
}

/// The cameras of a program.
pub(crate) fn of(scene: Option<&dyn Scene>) -> Option<&dyn Cameras> {
    scene?.cameras()
}
