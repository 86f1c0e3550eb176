//! After a few images, vision does not allocate.
#![allow(clippy::unwrap_used, reason = "a test")]
#![allow(unsafe_code, reason = "counting allocations takes an allocator")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use monas_vision::render::{Light, Renderer, RobotFigure, Scene};
use monas_vision::{Camera, FieldObjects, HeadPose, Jersey, Vision};
use nalgebra::{Isometry3, Point2};

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: every method passes its arguments unchanged to the system's allocator, so `System`
// upholds the contract of `GlobalAlloc`.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // The counter of a thread that ends is already destroyed.
        let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the caller upholds the contract of `alloc`, which `System` shares.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, position: *mut u8, layout: Layout) {
        // SAFETY: the caller guarantees that the block came from `alloc` above, that is from
        // `System`, with the same layout.
        unsafe { System.dealloc(position, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn images_are_seen_without_allocations() {
    let robot =
        RobotFigure { position: Point2::new(1.8, 0.4), heading: 0.3, jersey: Jersey::Red, lies: false };
    for objects in [FieldObjects::OF_2010, FieldObjects::OF_TODAY] {
        let mut vision = Vision::new(objects);
        let (mut renderer, mut pixels) = (Renderer::default(), Vec::new());
        let mut found = 0;
        for round in 0..8 {
            let pose = HeadPose { height: 0.5, pitch: 0.2, ..HeadPose::default() }.robot_from_camera();
            let pose = Isometry3::translation(0.1 * f64::from(round % 4), 0.0, 0.0) * pose;
            let camera = Camera::new(640, 480, 0.8343, &pose).unwrap();
            let ball = Some(Point2::new(1.4, -0.2));
            let scene =
                Scene { markings: Default::default(), objects, ball, robots: vec![robot], variant: 3 };
            let light = Light { noise: 4.0, blur: 0.7, ..Light::default() };
            let image = renderer.draw(&scene, &camera, &light, round as u64, &mut pixels).unwrap();
            let before = ALLOCATIONS.get();
            let seen = vision.see(&image, &camera).unwrap();
            let allocated = ALLOCATIONS.get() - before;
            found += u32::from(seen.ball.is_some()) + u32::from(!seen.lines.is_empty());
            assert!(round < 4 || allocated == 0, "image {round}: {allocated} allocations");
        }
        assert_eq!(found, 16, "ball and lines are in each image");
    }
}
