//! Recall, false sightings and errors of distance on rendered sequences with known truth, as a
//! table: `cargo run --release -p monas-vision --example recall [IMAGES [WIDTH]]`.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "an example that cannot go on ends")]

use monas_vision::FieldObjects;

#[path = "../tests/vision/measure/mod.rs"]
mod measure;

use measure::{CONDITIONS, Measures, Sequence, Views};

/// The columns of a line of [`Measures`].
const HEADER: &str = "\
of each kind: number shown, recall %, false ones, error of distance % (mean, of 9 in 10), of direction in degrees
line points: found %, false %; border: right columns %; line parts: covered %, false %, offset cm, angle degrees; border points: error of distance %, false %
               ball                              | posts                             | robots                            | line points | border | line parts            | border points";

fn main() {
    let number = |at: usize, default: u32| {
        std::env::args().nth(at).map_or(default, |text| text.parse().expect("a number"))
    };
    let (images, width) = (number(1, 100), number(2, 640) as usize);
    println!("{HEADER}");
    for (views, title) in [(Views::Field, "the field"), (Views::NearRobots, "robots at 0.4 to 1.5 m")] {
        println!("{title}");
        for (name, objects) in [("2010", FieldObjects::OF_2010), ("today", FieldObjects::OF_TODAY)] {
            let mut all = Measures::default();
            for condition in &CONDITIONS {
                let measures = Sequence { views, objects, condition, images, width, seed: 1 }.measure();
                println!("{name:<6}{:<9}{measures}", condition.name);
                all.add(&measures);
            }
            println!("{name:<6}{:<9}{all}", "all");
            println!("{name:<6}jerseys: {} of {} wrong", all.wrong_jerseys, all.jerseys);
        }
    }
}
