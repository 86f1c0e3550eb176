//! Images of a field, drawn from the pose of a camera: for simulations and tests.
//!
//! Every pixel is a ray: it ends at the carpet with its lines, at a ball, a post, a robot, or in
//! the room around the field. Light, blur, exposure and noise of the camera follow. The same
//! scene, camera and seed give the same bytes.

mod scene;
mod sensor;
mod shapes;

use nalgebra::{Point3, Vector2, Vector3};

use crate::{Camera, Error, Image};

pub use scene::{FieldMarkings, Light, RobotFigure, Scene};

use sensor::Sensor;
use shapes::Solid;

/// A colour as parts of full red, green and blue.
type Rgb = [f32; 3];

/// Draws scenes; it keeps its buffers.
#[derive(Clone, Debug, Default)]
pub struct Renderer {
    /// The colour of each pixel.
    colours: Vec<Rgb>,
    /// The distance of what each pixel shows, in multiples of its ray.
    depths: Vec<f32>,
    solids: Vec<Solid>,
    sensor: Sensor,
}

impl Renderer {
    /// Draws what a camera sees, in YUV 4:2:2. The pose of the camera is in the frame of the field.
    /// The seed determines the noise.
    ///
    /// # Errors
    /// As in [`Image::new`].
    pub fn draw<'a>(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        light: &Light,
        seed: u64,
        pixels: &'a mut Vec<u8>,
    ) -> Result<Image<'a>, Error> {
        let shading = Shading::new(light);
        self.draw_ground(scene, camera, &shading);
        self.solids.clear();
        scene.add_solids(&mut self.solids);
        for index in 0..self.solids.len() {
            let solid = self.solids[index];
            self.draw_solid(&solid, camera, &shading);
        }
        self.sensor.expose(&mut self.colours, camera.width(), light, seed, pixels);
        Image::new(camera.width(), camera.height(), pixels)
    }

    fn draw_ground(&mut self, scene: &Scene, camera: &Camera, shading: &Shading) {
        /// The positions of the samples in a pixel, so that thin lines do not break.
        const SAMPLES: [f64; 2] = [0.25, 0.75];
        self.colours.clear();
        self.depths.clear();
        for row in 0..camera.height() {
            for column in 0..camera.width() {
                let mut colour = [0.0f32; 3];
                let mut depth = f32::MAX;
                for part in SAMPLES {
                    let ray = camera.ray(column as f64 + 0.5, row as f64 + part);
                    let (seen, length) = scene.behind_everything(&camera.position(), &ray, shading);
                    (0..3).for_each(|i| colour[i] += seen[i] / SAMPLES.len() as f32);
                    depth = depth.min(length as f32);
                }
                self.colours.push(colour);
                self.depths.push(depth);
            }
        }
    }

    fn draw_solid(&mut self, solid: &Solid, camera: &Camera, shading: &Shading) {
        let Some([left, top, right, bottom]) = extent(solid, camera) else { return };
        let origin = camera.position();
        for row in top..bottom {
            for column in left..right {
                let ray = camera.ray(column as f64 + 0.5, row as f64 + 0.5);
                let Some(hit) = solid.hit(&origin, &ray) else { continue };
                let index = row * camera.width() + column;
                if hit.length as f32 > self.depths[index] {
                    continue;
                }
                self.depths[index] = hit.length as f32;
                let point = origin + ray * hit.length;
                self.colours[index] = shading.on_surface(hit.colour, &point, &hit.normal);
            }
        }
    }
}

/// The columns and rows that may show a solid: left, top, right, bottom; none if it is not in view.
fn extent(solid: &Solid, camera: &Camera) -> Option<[usize; 4]> {
    let (low, high) = solid.bounds();
    let (width, height) = (camera.width() as f64, camera.height() as f64);
    let mut area = [f64::MAX, f64::MAX, f64::MIN, f64::MIN];
    let (mut behind, mut corners) = (0, 0);
    for x in [low.x, high.x] {
        for y in [low.y, high.y] {
            for z in [low.z, high.z] {
                corners += 1;
                match camera.project(&Point3::new(x, y, z)) {
                    Some((column, row, _)) => {
                        area[0] = area[0].min(column);
                        area[1] = area[1].min(row);
                        area[2] = area[2].max(column);
                        area[3] = area[3].max(row);
                    }
                    None => behind += 1,
                }
            }
        }
    }
    if behind == corners {
        return None;
    }
    if behind > 0 {
        area = [0.0, 0.0, width, height];
    }
    let bound = |value: f64, max: f64| value.clamp(0.0, max) as usize;
    let area = [
        bound(area[0] - 1.0, width),
        bound(area[1] - 1.0, height),
        bound(area[2] + 2.0, width),
        bound(area[3] + 2.0, height),
    ];
    (area[0] < area[2] && area[1] < area[3]).then_some(area)
}

/// The brightness of surfaces in a light from above and from one side.
struct Shading {
    /// Towards the brighter side of the field.
    direction: Vector2<f64>,
    /// Change of brightness in that direction, 1/m.
    slope: f64,
}

impl Shading {
    fn new(light: &Light) -> Shading {
        let (sin, cos) = libm::sincos(light.direction);
        Shading { direction: Vector2::new(cos, sin), slope: light.slope }
    }

    fn on_surface(&self, colour: Rgb, point: &Point3<f64>, normal: &Vector3<f64>) -> Rgb {
        let shade = 0.62 + 0.25 * normal.z + 0.13 * normal.x;
        self.at(colour, point, shade as f32)
    }

    fn at(&self, colour: Rgb, point: &Point3<f64>, shade: f32) -> Rgb {
        let slope = 1.0 + self.slope * (point.x * self.direction.x + point.y * self.direction.y);
        let bright = shade * slope.clamp(0.2, 2.5) as f32;
        [0, 1, 2].map(|i| colour[i] * bright)
    }
}
