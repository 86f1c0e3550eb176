//! From images to sightings.

use monas_robot::{Colour, Image, Images, ObjectKind, Sensors, Sighting, Sightings};
use monas_vision::{Camera, FieldObjects, GoalPaint, GoalPost, HeadPose, Jersey, PostSide, Sight, Vision};

/// Interprets the images of a robot's cameras: what a body with finished sightings delivers,
/// derived from pixels.
///
/// The pose of a camera follows from the head joints and the inclination of the torso at the time
/// of the image.
#[derive(Clone, Debug)]
pub struct ImageInterpreter {
    vision: Vision,
}

impl Default for ImageInterpreter {
    /// Looks for the ball and the goals of 2010.
    fn default() -> ImageInterpreter {
        ImageInterpreter { vision: Vision::new(FieldObjects::OF_2010) }
    }
}

/// Directions of two posts below which they are one, rad.
const SAME_POST: f64 = 0.12;

impl ImageInterpreter {
    /// What images show, with the sensors as they were when the images were taken.
    ///
    /// # Errors
    /// An image has no possible size or camera, or its bytes are not those of its size.
    pub fn interpret(
        &mut self,
        images: &Images,
        sensors: &Sensors,
    ) -> Result<Sightings, monas_vision::Error> {
        let mut sightings = Sightings {
            taken_at: images.taken_at,
            head_yaw: sensors.head_yaw,
            head_pitch: sensors.head_pitch,
            objects: Vec::new(),
        };
        // The lower camera first: it shows the feet of what both show.
        let mut order: Vec<&Image> = images.images.iter().collect();
        order.sort_by(|a, b| b.camera_tilt.total_cmp(&a.camera_tilt));
        for image in order {
            self.add(image, sensors, &mut sightings.objects)?;
        }
        Ok(sightings)
    }

    fn add(
        &mut self,
        message: &Image,
        sensors: &Sensors,
        objects: &mut Vec<Sighting>,
    ) -> Result<(), monas_vision::Error> {
        let (width, height) = (message.width as usize, message.height as usize);
        let image = monas_vision::Image::new(width, height, &message.pixels)?;
        let head = HeadPose {
            height: message.camera_height,
            torso_roll: sensors.torso_roll,
            torso_pitch: sensors.torso_pitch,
            yaw: sensors.head_yaw,
            pitch: sensors.head_pitch + message.camera_tilt,
        };
        let camera = Camera::new(width, height, message.angle_of_view, &head.robot_from_camera())?;
        let seen = self.vision.see(&image, &camera)?;
        let is_known =
            |objects: &[Sighting], found: &Sighting| objects.iter().any(|known| is_same(known, found));
        let ball = seen.ball.iter().map(|ball| sighting(ObjectKind::Ball, Colour::Orange, ball));
        let posts = seen.posts.iter().map(post);
        let robots = seen.robots.iter().map(|robot| {
            let colour = match robot.jersey {
                Jersey::Blue => Colour::Blue,
                Jersey::Red => Colour::Red,
                Jersey::Unknown => Colour::NoColour,
            };
            sighting(ObjectKind::Robot, colour, &robot.sight)
        });
        for found in ball.chain(posts).chain(robots) {
            if !is_known(objects, &found) {
                objects.push(found);
            }
        }
        Ok(())
    }
}

/// Whether two sightings from different cameras are of one object.
fn is_same(known: &Sighting, found: &Sighting) -> bool {
    let is_post = |kind| matches!(kind, ObjectKind::LeftPost | ObjectKind::RightPost | ObjectKind::SomePost);
    let beside = (known.bearing - found.bearing).abs();
    match (known.kind(), found.kind()) {
        (ObjectKind::Ball, ObjectKind::Ball) => true,
        (a, b) if is_post(a) && is_post(b) => known.colour == found.colour && beside < SAME_POST,
        (ObjectKind::Robot, ObjectKind::Robot) => beside * known.distance < 0.3,
        _ => false,
    }
}

fn post(post: &GoalPost) -> Sighting {
    let kind = match post.side {
        PostSide::Left => ObjectKind::LeftPost,
        PostSide::Right => ObjectKind::RightPost,
        PostSide::Unknown => ObjectKind::SomePost,
    };
    let colour = match post.paint {
        GoalPaint::Yellow => Colour::Yellow,
        GoalPaint::Blue => Colour::Blue,
        GoalPaint::White => Colour::White,
    };
    sighting(kind, colour, &post.sight)
}

fn sighting(kind: ObjectKind, colour: Colour, sight: &Sight) -> Sighting {
    Sighting { kind: kind.into(), bearing: sight.bearing, distance: sight.distance, colour: colour.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broken_image_is_an_error() {
        let image =
            Image { width: 64, height: 48, angle_of_view: 0.8, camera_height: 0.5, ..Image::default() };
        let images = Images { taken_at: 1, images: vec![image] };
        let error = ImageInterpreter::default().interpret(&images, &Sensors::default()).unwrap_err();
        assert_eq!(error.kind(), monas_vision::ErrorKind::Length);
    }

    #[test]
    fn a_post_in_both_images_counts_once() {
        let sight = |kind, bearing, colour: Colour| Sighting {
            kind: i32::from(kind),
            bearing,
            distance: 2.0,
            colour: colour.into(),
        };
        let known = sight(ObjectKind::SomePost, 0.2, Colour::Blue);
        assert!(is_same(&known, &sight(ObjectKind::LeftPost, 0.25, Colour::Blue)));
        assert!(!is_same(&known, &sight(ObjectKind::LeftPost, 0.25, Colour::Yellow)));
        assert!(!is_same(&known, &sight(ObjectKind::LeftPost, 0.6, Colour::Blue)));
    }
}
