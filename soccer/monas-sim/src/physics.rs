//! Parameters of bodies, ball and cameras: all numbers of the simulation except the geometry of the
//! field and the rules.

use crate::parameters::parameters;
use crate::{Error, ErrorKind};

parameters! {
    /// Parameters of bodies, ball and cameras.
    ///
    /// Values marked *Nao* are data of the Nao V3, the robot of 2010. Values marked *chosen* have
    /// no published source; they give matches like those of that league, somewhat faster.
    pub struct Physics {
        /// Radius of the disk that touches other robots and posts (Nao: shoulders 0.2 m apart, arms
        /// outside).
        robot_radius: "m" = 0.13 in 0.05 to 0.5;
        /// Mass of a robot (Nao).
        robot_mass: "kg" = 4.8 in 1.0 to 100.0;
        /// Height of a robot, for the cameras of others (Nao).
        robot_height: "m" = 0.58 in 0.2 to 2.0;
        /// How far the feet reach before the middle of the body (Nao: soles 0.16 m long).
        foot_front: "m" = 0.09 in 0.02 to 0.3;
        /// How far the feet reach behind the middle of the body (Nao).
        foot_back: "m" = 0.06 in 0.02 to 0.3;
        /// How far the feet reach to each side (Nao: soles 0.09 m wide, hips 0.1 m apart).
        foot_side: "m" = 0.09 in 0.02 to 0.3;
        /// Half the thickness of a lying body, as the ball meets it (chosen).
        lying_radius: "m" = 0.07 in 0.03 to 0.3;
        /// Reach of a lying body from where it stood (Nao: height less the part under the hips).
        lying_reach: "m" = 0.45 in 0.1 to 2.0;

        /// Fastest walk forwards (chosen; the best walks of 2010 reached 0.2 to 0.3 m/s).
        walk_forward: "m/s" = 0.30 in 0.05 to 3.0;
        /// Fastest walk backwards (chosen).
        walk_backward: "m/s" = 0.15 in 0.05 to 3.0;
        /// Fastest walk sideways (chosen).
        walk_sideways: "m/s" = 0.15 in 0.05 to 3.0;
        /// Fastest turn on the spot (chosen).
        walk_turn: "rad/s" = 1.2 in 0.1 to 10.0;
        /// Greatest change of the walking speed (chosen: full speed takes one stride).
        walk_acceleration: "m/s^2" = 0.6 in 0.05 to 20.0;
        /// Greatest change of the turning speed (chosen).
        turn_acceleration: "rad/s^2" = 4.0 in 0.1 to 100.0;
        /// Time of a whole stride, a step with each foot (chosen: two steps of 0.25 s).
        stride_duration: "s" = 0.5 in 0.1 to 2.0;
        /// Standard deviation of the slip of a step, as a part of its speed (chosen).
        gait_noise: "1" = 0.08 in 0.0 to 1.0;
        /// Standard deviation of the unwanted turn in a step at full speed (chosen).
        gait_turn_noise: "rad/s" = 0.06 in 0.0 to 2.0;
        /// Greatest acceleration that the grip of the feet allows, against pushes (chosen).
        foot_grip: "m/s^2" = 4.0 in 0.1 to 50.0;

        /// Greatest head yaw to either side (Nao).
        head_yaw_limit: "rad" = 2.0857 in 0.0 to 3.1;
        /// Highest view, as a head pitch; positive pitch looks down (Nao).
        head_pitch_least: "rad" = -0.672 in -1.5 to 0.0;
        /// Lowest view, as a head pitch (Nao).
        head_pitch_most: "rad" = 0.5149 in 0.0 to 1.5;
        /// Fastest motion of either joint of the head (chosen; the motors can do twice as much).
        head_speed: "rad/s" = 3.0 in 0.1 to 20.0;

        /// Change of velocity by a blow that makes a robot fall (chosen: two robots that walk into
        /// each other at full speed fall, one that walks into a standing one does not).
        fall_impact: "m/s" = 0.22 in 0.01 to 100.0;
        /// Falls in each second of walking at full speed; less with the square of the speed
        /// (chosen).
        fall_rate_walking: "1/s" = 0.004 in 0.0 to 10.0;
        /// Falls in each second of pressing against another robot (chosen).
        fall_rate_pushed: "1/s" = 0.12 in 0.0 to 10.0;
        /// Time from losing balance to lying (a free fall from this height takes about as long).
        fall_duration: "s" = 0.6 in 0.05 to 5.0;
        /// Time of sitting down (chosen; a Nao's takes about as long).
        sit_down_duration: "s" = 1.5 in 0.1 to 20.0;
        /// Time of the stand-up motion (chosen; 2010's took 3 to 6 s).
        stand_up_duration: "s" = 3.5 in 0.5 to 20.0;
        /// Probability that a stand-up motion ends upright (chosen).
        stand_up_success: "1" = 0.95 in 0.1 to 1.0;

        /// Time of a whole kick (chosen).
        kick_duration: "s" = 1.6 in 0.1 to 5.0;
        /// Moment in a kick at which the foot meets the ball (chosen).
        kick_strike: "s" = 0.8 in 0.0 to 5.0;
        /// Forward place of the ball, from the middle of the body, at which a kick meets it best
        /// (Nao's legs).
        kick_x: "m" = 0.15 in 0.0 to 1.0;
        /// Sideways place of the ball at which a kick meets it best: left for the left foot (half
        /// the hips' width).
        kick_y: "m" = 0.05 in 0.0 to 0.5;
        /// How far the ball may lie before or behind that place (chosen).
        kick_tolerance_x: "m" = 0.06 in 0.0 to 0.5;
        /// How far the ball may lie beside that place (chosen).
        kick_tolerance_y: "m" = 0.05 in 0.0 to 0.5;
        /// Mean speed of a struck ball (chosen: rolls across most of the field).
        kick_speed: "m/s" = 2.0 in 0.1 to 10.0;
        /// Standard deviation of that speed (chosen).
        kick_speed_noise: "m/s" = 0.2 in 0.0 to 5.0;
        /// Standard deviation of the direction of a struck ball (chosen: 6 degrees).
        kick_direction_noise: "rad" = 0.105 in 0.0 to 1.0;
        /// Probability that the foot misses a ball within reach (chosen).
        kick_miss: "1" = 0.03 in 0.0 to 1.0;

        /// Time a dive or a sideways fall takes to cover its reach (chosen).
        dive_duration: "s" = 0.4 in 0.05 to 5.0;
        /// How far to the side a dive covers the ground (Nao: nearly its height).
        dive_reach: "m" = 0.5 in 0.1 to 2.0;
        /// How far to the side a fall from the knees covers the ground (chosen).
        side_fall_reach: "m" = 0.3 in 0.1 to 2.0;

        /// Radius of the ball (the league's street hockey ball of 2010: diameter 65 mm).
        ball_radius: "m" = 0.0325 in 0.01 to 0.2;
        /// Mass of the ball (that ball).
        ball_mass: "kg" = 0.055 in 0.005 to 1.0;
        /// Constant deceleration of a rolling ball (chosen: a kick of 2 m/s rolls 6.7 m on short
        /// carpet).
        ball_deceleration: "m/s^2" = 0.30 in 0.0 to 5.0;
        /// Part of the speed that a bounce from feet keeps (chosen: legs give way a little).
        foot_restitution: "1" = 0.4 in 0.0 to 1.0;
        /// Part of the speed that a bounce from a lying body keeps (chosen: a swung arm bats the
        /// ball away, so that a saved ball does not come to rest before the goal).
        lying_restitution: "1" = 0.8 in 0.0 to 1.0;
        /// Part of the speed that a bounce from a post or wall keeps (chosen).
        post_restitution: "1" = 0.6 in 0.0 to 1.0;

        /// How often in a second a body senses and acts; its cycle is a whole number of steps of
        /// the world, 0.01 s each (chosen; Nao: 100 through DCM, 83 through LoLA).
        body_rate: "1/s" = 50.0 in 10.0 to 100.0;
        /// Pictures in each second (Nao: 30 at 320 by 240).
        camera_rate: "1/s" = 30.0 in 1.0 to 100.0;
        /// Height of the cameras of a standing robot (Nao: 0.5 m in a walking stance).
        camera_height: "m" = 0.50 in 0.2 to 2.0;
        /// Horizontal field of view of a camera (Nao: 47.8 degrees).
        camera_view_horizontal: "rad" = 0.8343 in 0.1 to 3.0;
        /// Vertical field of view of a camera (Nao: 36.8 degrees).
        camera_view_vertical: "rad" = 0.6423 in 0.1 to 2.0;
        /// How much lower the second camera looks (Nao: 40 degrees; here its view begins where the
        /// other ends).
        camera_tilt: "rad" = 0.6423 in 0.0 to 1.5;
        /// Standard deviation of a seen bearing, standing (chosen: 0.5 degrees).
        bearing_noise: "rad" = 0.009 in 0.0 to 0.5;
        /// Standard deviation of a seen elevation, standing; makes distances worse with distance
        /// (chosen).
        elevation_noise: "rad" = 0.007 in 0.0 to 0.5;
        /// How much larger both are while the body moves (chosen).
        moving_noise_factor: "1" = 1.6 in 1.0 to 10.0;
        /// Standard deviation of distances to posts and robots, as a part of the distance (chosen).
        distance_noise: "1" = 0.06 in 0.0 to 1.0;
        /// Distance from which the ball is never seen; from half of it on, seeing it gets less
        /// likely (chosen: it is then 5 pixels wide).
        ball_range: "m" = 5.0 in 0.5 to 100.0;
        /// The same for goal posts (chosen).
        post_range: "m" = 9.0 in 0.5 to 100.0;
        /// The same for robots (chosen).
        robot_range: "m" = 5.0 in 0.5 to 100.0;
        /// The same for corners and junctions of lines (chosen: a line of 50 mm is then 2 pixels
        /// high).
        line_range: "m" = 3.5 in 0.5 to 100.0;
        /// Probability that an object well within range and view is missed in one picture (chosen).
        sight_miss: "1" = 0.04 in 0.0 to 1.0;
        /// How many times `sight_miss` is added to itself in the worst light, which comes and goes
        /// within half a minute, for each robot at other times; of finished sightings (chosen for a
        /// hall with windows: up to a fifth of the objects is missed).
        light_change: "1" = 4.0 in 0.0 to 25.0;
        /// Time from the exposure of a picture to its delivery; time, head angles and contents are
        /// those of the exposure (Nao: 5 ms are half an exposure, 33 ms the transfer of a picture
        /// at 30 in each second, and 20 ms its interpretation).
        camera_latency: "s" = 0.06 in 0.0 to 0.5;
        /// Probability that a picture shows a ball on the ground in view where there is none; of
        /// finished sightings, as the next five (chosen: one in 17 s).
        false_ball: "1" = 0.002 in 0.0 to 1.0;
        /// The same for a goal post, of either goal (chosen).
        false_post: "1" = 0.002 in 0.0 to 1.0;
        /// The same for a robot, of either team (chosen).
        false_robot: "1" = 0.002 in 0.0 to 1.0;
        /// Probability that a post is taken for one of the other goal in a picture
        /// (chosen).
        wrong_goal: "1" = 0.01 in 0.0 to 1.0;
        /// Probability that a post is taken for the other one of its goal, if both are in the
        /// picture (chosen).
        wrong_side: "1" = 0.01 in 0.0 to 1.0;
        /// Probability that a robot is taken for one of the other team in a picture
        /// (chosen).
        wrong_team: "1" = 0.01 in 0.0 to 1.0;

        /// Standard deviation of the error of odometry in one step of the feet, as a part of the
        /// way (chosen).
        odometry_noise: "1" = 0.03 in 0.0 to 1.0;
        /// Standard deviation of a reading of the gyrometers (chosen).
        gyro_noise: "rad/s" = 0.02 in 0.0 to 1.0;
        /// Standard deviation of a reading of the torso's tilt (chosen).
        tilt_noise: "rad" = 0.01 in 0.0 to 0.5;
        /// Amplitude of the torso's sway while walking (chosen).
        walking_sway: "rad" = 0.04 in 0.0 to 0.5;
    }
}

impl Physics {
    /// Checks the ranges and that the parameters are consistent.
    ///
    /// # Errors
    /// [`OutOfRange`](crate::ErrorKind::OutOfRange) and
    /// [`Inconsistent`](crate::ErrorKind::Inconsistent).
    pub fn validate(&self) -> Result<(), Error> {
        self.check_ranges()?;
        if self.kick_strike > self.kick_duration {
            return Err(Error::new(ErrorKind::Inconsistent, "a kick strikes after it has ended"));
        }
        if self.lying_radius * 2.0 > self.lying_reach.min(self.dive_reach).min(self.side_fall_reach) {
            return Err(Error::new(
                ErrorKind::Inconsistent,
                "a lying body reaches less far than it is thick",
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_consistent_and_documented() {
        assert!(Physics::default().validate().is_ok());
        for parameter in Physics::keys() {
            assert!(parameter.allows(parameter.default), "{}", parameter.key);
            assert!(parameter.doc.contains('('), "{} names no source", parameter.key);
        }
    }

    #[test]
    fn every_key_can_be_set_to_its_limits() {
        for parameter in Physics::keys() {
            let mut physics = Physics::default();
            for value in [parameter.min, parameter.max] {
                assert!(physics.set(parameter.key, value).is_ok());
                assert_eq!(physics.get(parameter.key), Some(value));
            }
        }
    }

    #[test]
    fn contradictions_are_refused() {
        let late = Physics { kick_strike: 2.0, ..Physics::default() };
        assert_eq!(late.validate().map_err(|e| e.kind()), Err(ErrorKind::Inconsistent));
        let thick = Physics { lying_radius: 0.3, ..Physics::default() };
        assert_eq!(thick.validate().map_err(|e| e.kind()), Err(ErrorKind::Inconsistent));
    }
}
