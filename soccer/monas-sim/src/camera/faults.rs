//! Errors of image interpretation: objects that are not there, wrong labels, bad light.
//!
//! Their random numbers come from a stream of their own, so that a match without them is the same
//! as if they did not exist.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::{CameraView, Percept, Sighting};
use crate::pose::normalize_angle;
use crate::rng::RandomStream;
use crate::{GoalColour, Side, TeamColour};

/// The periods of the light, s. It is worst when the waves of both have their crests or both their
/// troughs, and good while they differ (chosen: clouds before a window).
const LIGHT_PERIODS: [f64; 2] = [37.0, 61.0];

/// The errors of one robot's cameras.
pub(crate) struct CameraFaults {
    stream: RandomStream,
    /// The phases of the light at the beginning, rad.
    phases: [f64; 2],
}

impl CameraFaults {
    /// The errors of the robot at `path`.
    pub(crate) fn new(seed: u64, path: &str) -> Self {
        let mut stream = RandomStream::new(seed, &format!("{path}/camera_faults"));
        let phases = [(); 2].map(|()| TAU * stream.uniform());
        Self { stream, phases }
    }

    /// The badness of the light at a time, s: 0 for good light, at most 1.
    pub(crate) fn darkness(&self, time: f64) -> f64 {
        let wave = |index: usize| libm::sin(TAU * time / LIGHT_PERIODS[index] + self.phases[index]);
        (wave(0) * wave(1)).max(0.0)
    }

    /// Confuses labels in a picture and adds objects that are not there.
    pub(crate) fn spoil(&mut self, view: &CameraView, sightings: &mut Vec<Sighting>) {
        if !view.me().phase.is_upright() {
            return;
        }
        sightings.iter_mut().for_each(|sighting| self.confuse(view, sighting));
        self.add_ball(view, sightings);
        self.add_post(view, sightings);
        self.add_robot(view, sightings);
    }

    fn confuse(&mut self, view: &CameraView, sighting: &mut Sighting) {
        let physics = view.physics();
        match sighting {
            Sighting::Ball(_) | Sighting::Line { .. } => {}
            Sighting::Post { goal, side, .. } => {
                if self.stream.chance(physics.wrong_goal) {
                    *goal = goal.opposite();
                }
                if self.stream.chance(physics.wrong_side) {
                    *side = side.map(Side::opposite);
                }
            }
            Sighting::Robot { colour, .. } => {
                if self.stream.chance(physics.wrong_team) {
                    *colour = colour.opposite();
                }
            }
        }
    }

    fn add_ball(&mut self, view: &CameraView, sightings: &mut Vec<Sighting>) {
        let physics = view.physics();
        if self.stream.chance(physics.false_ball)
            && let Some(percept) = self.random_percept(view, physics.ball_radius, physics.ball_range)
        {
            sightings.push(Sighting::Ball(percept));
        }
    }

    fn add_post(&mut self, view: &CameraView, sightings: &mut Vec<Sighting>) {
        let physics = view.physics();
        if self.stream.chance(physics.false_post)
            && let Some(percept) = self.random_percept(view, 0.0, physics.post_range)
        {
            let goal = if self.stream.chance(0.5) { GoalColour::Blue } else { GoalColour::Yellow };
            sightings.push(Sighting::Post { goal, side: None, percept });
        }
    }

    fn add_robot(&mut self, view: &CameraView, sightings: &mut Vec<Sighting>) {
        let physics = view.physics();
        if self.stream.chance(physics.false_robot)
            && let Some(percept) = self.random_percept(view, 0.0, physics.robot_range)
        {
            let colour = if self.stream.chance(0.5) { TeamColour::Blue } else { TeamColour::Red };
            sightings.push(Sighting::Robot { colour, percept });
        }
    }

    /// A place in view, equally distributed in the pictures: of a point at a height above the
    /// ground, not beyond a range. None if the cameras show no such place.
    fn random_percept(&mut self, view: &CameraView, height: f64, range: f64) -> Option<Percept> {
        /// Greatest angle below the horizon, rad; the feet are there.
        const MOST_ANGLE: f64 = FRAC_PI_2 - 0.1;
        let (physics, me) = (view.physics(), view.me());
        let half = physics.camera_view_vertical / 2.0;
        let min = view.angle_below_horizon(height, range);
        let shown = [0.0, physics.camera_tilt].map(|tilt| {
            let axis = me.head_pitch + tilt;
            ((axis - half).max(min), (axis + half).min(MOST_ANGLE))
        });
        let sizes = shown.map(|(from, to)| (to - from).max(0.0));
        let [aside, along] = [(); 2].map(|()| self.stream.uniform());
        let along = along * (sizes[0] + sizes[1]);
        let angle = if along < sizes[0] { shown[0].0 + along } else { shown[1].0 + along - sizes[0] };
        (sizes[0] + sizes[1] > 0.0).then(|| Percept {
            bearing: normalize_angle(me.head_yaw + (aside - 0.5) * physics.camera_view_horizontal),
            elevation: -angle,
            distance: ((physics.camera_height - height) / libm::tan(angle)).min(range),
        })
    }
}
