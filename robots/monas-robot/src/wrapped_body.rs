//! A body with noise, delay and loss around it.

use std::collections::VecDeque;
use std::time::Duration;

use narukom::Timestamp;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use crate::{Actuators, Anatomy, Error, FieldColours, JointCommands, Leds, Limits, Percepts, Robot};

/// Disturbances between a body and its robot's software. The default has none.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Disturbances {
    /// The delay of commands in the plane.
    pub delay: Duration,
    /// Standard deviation of the noise added to measured angles and bearings, rad.
    pub noise: f64,
    /// The probability with which a set of sightings or images or a radio message is lost.
    pub loss: f64,
}

/// A wrapper around a body that limits and delays commands, adds noise to percepts and drops some.
///
/// The same seed gives the same disturbances. Commands in the plane beyond the limits of the
/// anatomy are clamped here.
pub struct WrappedBody {
    body: Box<dyn Robot>,
    disturbances: Disturbances,
    random: Pcg64,
    /// Commands that take effect at a later time.
    delayed: VecDeque<(Timestamp, Actuators)>,
    rests: bool,
    colours: Option<FieldColours>,
}

impl WrappedBody {
    /// Wraps a body.
    pub fn new(body: Box<dyn Robot>, disturbances: Disturbances, seed: u64) -> WrappedBody {
        let random = Pcg64::seed_from_u64(seed);
        let delayed = VecDeque::new();
        WrappedBody { body, disturbances, random, delayed, rests: false, colours: None }
    }

    /// The body with these colours in its images, for the calibration to begin with.
    #[must_use]
    pub fn with_colours(self, colours: Option<FieldColours>) -> WrappedBody {
        WrappedBody { colours, ..self }
    }

    fn limited(&self, actuators: &Actuators) -> Actuators {
        let anatomy = self.body.anatomy();
        let mut limited = *actuators;
        let Actuators { walk_x, walk_y, walk_turn, head_yaw, head_pitch, .. } = &mut limited;
        let values = [
            (walk_x, anatomy.walk_x),
            (walk_y, anatomy.walk_y),
            (walk_turn, anatomy.walk_turn),
            (head_yaw, anatomy.head_yaw),
            (head_pitch, anatomy.head_pitch),
        ];
        for (value, limits) in values {
            *value = limits.clamp(*value);
        }
        limited
    }

    /// Passes on the commands that are due.
    fn deliver(&mut self, now: Timestamp) -> Result<(), Error> {
        while let Some((at, actuators)) = self.delayed.front().copied()
            && at <= now
        {
            self.delayed.pop_front();
            self.body.act(now, &actuators)?;
        }
        Ok(())
    }

    fn uniform(&mut self) -> f64 {
        const SCALE: f64 = 1.0 / (1u64 << 53) as f64;
        (self.random.next_u64() >> 11) as f64 * SCALE
    }

    /// A normally distributed number around zero, by the method of Box and Muller.
    fn normal(&mut self) -> f64 {
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.uniform()));
        self.disturbances.noise * radius * libm::cos(std::f64::consts::TAU * self.uniform())
    }

    fn disturb(&mut self, percepts: &mut Percepts) {
        if self.disturbances.loss > 0.0 {
            let loss = self.disturbances.loss;
            percepts.sightings = percepts.sightings.take().filter(|_| self.uniform() >= loss);
            percepts.images = percepts.images.take().filter(|_| self.uniform() >= loss);
            percepts.heard.retain(|_| self.uniform() >= loss);
        }
        if self.disturbances.noise > 0.0 {
            self.blur(percepts);
        }
    }

    fn blur(&mut self, percepts: &mut Percepts) {
        let (yaw, pitch) = (self.body.anatomy().head_yaw, self.body.anatomy().head_pitch);
        let sensors = &mut percepts.sensors;
        sensors.head_yaw = yaw.clamp(sensors.head_yaw + self.normal());
        sensors.head_pitch = pitch.clamp(sensors.head_pitch + self.normal());
        sensors.torso_roll += self.normal();
        sensors.torso_pitch += self.normal();
        if let Some(joints) = &mut percepts.joints {
            for (joint, position) in joints.positions.iter_mut().enumerate() {
                let limits =
                    self.body.anatomy().joints.get(joint).map_or(Limits::symmetric(0.0), |it| it.limits);
                *position = limits.clamp(*position + self.normal());
            }
        }
        if let Some(inertial) = &mut percepts.inertial {
            inertial.roll += self.normal();
            inertial.pitch += self.normal();
        }
        for sighting in percepts.sightings.iter_mut().flat_map(|sightings| &mut sightings.objects) {
            sighting.bearing += self.normal();
        }
    }
}

impl Robot for WrappedBody {
    fn anatomy(&self) -> &Anatomy {
        self.body.anatomy()
    }

    fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), Error> {
        self.deliver(now)?;
        self.body.sense(now, percepts)?;
        self.disturb(percepts);
        if let (Some(images), Some(colours)) = (&mut percepts.images, &self.colours) {
            images.colours = Some(colours.clone());
        }
        Ok(())
    }

    fn act(&mut self, now: Timestamp, actuators: &Actuators) -> Result<(), Error> {
        let limited = self.limited(actuators);
        if !self.rests {
            self.delayed.push_back((now + self.disturbances.delay, limited));
        }
        self.deliver(now)
    }

    fn command_joints(&mut self, now: Timestamp, commands: &JointCommands) -> Result<(), Error> {
        self.body.command_joints(now, commands)
    }

    fn light(&mut self, now: Timestamp, leds: &Leds) -> Result<(), Error> {
        self.body.light(now, leds)
    }

    fn deliver_images(&mut self, width: Option<u32>) -> Result<(), Error> {
        self.body.deliver_images(width)
    }

    /// Takes effect at once, and permanently.
    fn rest(&mut self, now: Timestamp) -> Result<(), Error> {
        self.rests = true;
        self.delayed.clear();
        self.body.rest(now)
    }

    fn say(&mut self, now: Timestamp, words: &[u8]) -> Result<(), Error> {
        self.body.say(now, words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ErrorKind, Sighting, Sightings, conformance};

    /// A head that sees one object, ahead.
    struct Head {
        anatomy: Anatomy,
        yaw: f64,
    }

    impl Robot for Head {
        fn anatomy(&self) -> &Anatomy {
            &self.anatomy
        }
        fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), Error> {
            percepts.sensors.measured_at = now.as_nanos();
            percepts.sensors.head_yaw = self.yaw;
            let objects = vec![Sighting { distance: 1.0, ..Sighting::default() }];
            percepts.sightings = Some(Sightings { objects, ..Sightings::default() });
            Ok(())
        }
        fn act(&mut self, _: Timestamp, actuators: &Actuators) -> Result<(), Error> {
            self.yaw = self.anatomy.head_yaw.clamp(actuators.head_yaw);
            Ok(())
        }
    }

    fn wrapped(disturbances: Disturbances, seed: u64) -> WrappedBody {
        let anatomy = Anatomy::new("head", Duration::from_millis(10));
        WrappedBody::new(Box::new(Head { anatomy, yaw: 0.0 }), disturbances, seed)
    }

    #[test]
    fn a_body_without_images_says_so() {
        let error = wrapped(Disturbances::default(), 7).deliver_images(None).unwrap_err();
        assert_eq!(
            (error.kind(), error.to_string()),
            (ErrorKind::Configuration, "the head delivers no images".into())
        );
    }

    /// The yaw that is felt and the bearings that are seen in each of 500 cycles after a command.
    fn run(body: &mut WrappedBody, yaw: f64) -> Vec<(f64, Option<f64>)> {
        let turn = Actuators { head_yaw: yaw, ..Actuators::default() };
        body.act(Timestamp::ZERO, &turn).unwrap();
        let cycle = |cycle: u64| {
            let mut percepts = Percepts::default();
            body.sense(Timestamp::from_nanos(cycle * 10_000_000), &mut percepts).unwrap();
            let seen = percepts.sightings.map(|sightings| sightings.objects[0].bearing);
            (percepts.sensors.head_yaw, seen)
        };
        (0..500).map(cycle).collect()
    }

    #[test]
    fn a_wrapped_body_is_a_body_like_any_other() {
        let disturbances = Disturbances { delay: Duration::from_millis(35), noise: 0.01, loss: 0.3 };
        conformance::check(&mut wrapped(disturbances, 7));
        conformance::check(&mut wrapped(Disturbances::default(), 7));
    }

    #[test]
    fn commands_take_effect_after_the_delay() {
        let delay = Duration::from_millis(35);
        let felt = run(&mut wrapped(Disturbances { delay, ..Disturbances::default() }, 7), 0.5);
        assert_eq!(felt.iter().position(|(yaw, _)| *yaw == 0.5), Some(4));
    }

    #[test]
    fn noise_and_loss_have_their_size_and_repeat_with_the_seed() {
        let disturbances = Disturbances { noise: 0.1, loss: 0.25, ..Disturbances::default() };
        let felt = run(&mut wrapped(disturbances, 7), 0.0);
        assert_eq!(felt, run(&mut wrapped(disturbances, 7), 0.0));
        assert_ne!(felt, run(&mut wrapped(disturbances, 8), 0.0));
        let seen: Vec<f64> = felt.iter().filter_map(|(_, bearing)| *bearing).collect();
        assert!((330..420).contains(&seen.len()), "{}", seen.len());
        let deviation = (seen.iter().map(|x| x * x).sum::<f64>() / seen.len() as f64).sqrt();
        assert!((deviation - 0.1).abs() < 0.015, "{deviation}");
    }

    #[test]
    fn commands_beyond_the_limits_are_clamped() {
        let mut body = wrapped(Disturbances::default(), 7);
        assert_eq!(run(&mut body, 9.0)[0].0, 2.0857);
        assert_eq!(run(&mut body, f64::NAN)[0].0, 0.0);
        assert_eq!(run(&mut body, 0.1)[0].0, 0.1);
    }
}
