//! What is found in images that the renderer draws, in many lights.

mod colour_table;
mod false_sightings;
mod measure;
mod recall;
