//! What is found in images that the renderer draws, in many lights.
#![allow(clippy::unwrap_used)] // tests

mod colour_table;
mod false_sightings;
mod measure;
mod recall;
