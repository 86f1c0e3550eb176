//! Detections in images of the renderer, in many lights.
#![allow(clippy::unwrap_used)] // tests

/// Whether hundreds of images of 640 by 480 pixels are examined, as in `.ci/run`; else a note is
/// printed. Small images are always examined.
fn examines_large_images() -> bool {
    let examines = std::env::var_os("MONAS_LONG_TESTS").is_some();
    if !examines {
        println!("skipped: large images are examined with MONAS_LONG_TESTS=1");
    }
    examines
}

mod colour_table;
mod false_sightings;
mod measure;
mod recall;
