//! Detects objects in images.

mod ball;
mod border;
mod lines;
mod posts;
mod robots;

use crate::class_map::ClassMap;
use crate::colour::{Calibration, ColourModel, ColourTable};
use crate::{Camera, Detections, Error, ErrorKind, FieldObjects, Image};

use ball::BallSearch;
use border::BorderScan;
use lines::LineScan;
use posts::PostScan;
use robots::RobotScan;

/// Finds ball, goals, lines, border and robots in images.
///
/// It keeps a colour table, which it calibrates from each image, and its memory: after a few images
/// it no longer allocates. It has no other state, so it may see the images of several cameras of
/// one robot in turn.
#[derive(Clone, Debug)]
pub struct Vision {
    objects: FieldObjects,
    calibration: Calibration,
    /// Whether images change the colour table.
    calibrates: bool,
    table: ColourTable,
    map: ClassMap,
    border: BorderScan,
    ball: BallSearch,
    lines: LineScan,
    posts: PostScan,
    robots: RobotScan,
    seen: Detections,
}

/// The present image, with the data that all searches need.
pub(crate) struct ImageContext<'a> {
    pub(crate) image: &'a Image<'a>,
    pub(crate) camera: &'a Camera,
    pub(crate) table: &'a ColourTable,
    pub(crate) map: &'a ClassMap,
    pub(crate) objects: &'a FieldObjects,
}

impl Vision {
    /// Vision for the objects of a field. Each image calibrates its colours.
    pub fn new(objects: FieldObjects) -> Vision {
        Vision {
            objects,
            calibration: Calibration::default(),
            calibrates: true,
            table: ColourTable::new(ColourModel::default()),
            map: ClassMap::default(),
            border: BorderScan::default(),
            ball: BallSearch::default(),
            lines: LineScan::default(),
            posts: PostScan::default(),
            robots: RobotScan::default(),
            seen: Detections::default(),
        }
    }

    /// Vision that begins with known colours, such as those of a colour table. Images change them.
    pub fn starting_from(objects: FieldObjects, model: ColourModel) -> Vision {
        let (calibration, table) = (Calibration::starting_from(model), ColourTable::new(model));
        Vision { calibration, table, ..Vision::new(objects) }
    }

    /// Vision with fixed colours, which images do not change.
    pub fn with_colours(objects: FieldObjects, model: ColourModel) -> Vision {
        Vision { calibrates: false, table: ColourTable::new(model), ..Vision::new(objects) }
    }

    /// The colour table.
    pub fn table(&self) -> &ColourTable {
        &self.table
    }

    /// Detects the objects in an image taken by a camera. Positions are in the ground frame in
    /// which the pose of the camera is given.
    ///
    /// # Errors
    /// [`Size`](ErrorKind::Size) if the camera takes images of another size.
    pub fn see(&mut self, image: &Image<'_>, camera: &Camera) -> Result<&Detections, Error> {
        if (image.width(), image.height()) != (camera.width(), camera.height()) {
            let message = format!(
                "an image of {} x {} pixels of a camera with {} x {}",
                image.width(),
                image.height(),
                camera.width(),
                camera.height()
            );
            return Err(Error::new(ErrorKind::Size, message));
        }
        if self.calibrates && self.calibration.observe(image, camera) {
            self.table.update(self.calibration.model());
        }
        self.map.fill(image, &self.table, camera);
        let context =
            ImageContext { image, camera, table: &self.table, map: &self.map, objects: &self.objects };
        let seen = &mut self.seen;
        seen.clear();
        self.border.scan(&context, seen);
        if !seen.border.is_empty() {
            seen.ball = self.ball.search(&context, &self.border);
            self.posts.scan(&context, &self.border, &mut seen.posts);
            self.robots.scan(&context, &self.border, seen);
            self.lines.scan(&context, &self.border, self.robots.cut_bodies(), seen);
        }
        Ok(seen)
    }
}
