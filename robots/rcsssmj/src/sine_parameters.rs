//! The parameters of the project's own walk.

use std::f64::consts::TAU;

use crate::parameters::parameters;

parameters! {
    /// The parameters of a walk, as its file names them.
    SineParameters, walk;
    frequency: 0.5, 5.0, "pairs of steps in a second";
    height: 0.3, 0.55, "of the hips above the soles in a walk, m";
    foot: -0.15, 0.15, "where the soles are ahead of the hips, m";
    lean: -0.4, 0.4, "pitch of the torso over the feet, forwards, rad";
    lift: 0.0, 0.15, "of a swinging foot, m";
    support: -0.5, 0.8, "part of a step in which both feet stand";
    linear: 0.0, 1.0, "how far a standing foot keeps one speed, 0 to 1";
    phase: -1.6, 1.6, "of the strides after the lift, rad";
    sway: -0.1, 0.1, "of the feet to the left, amplitude, m";
    sway_phase: -TAU, TAU, "of that after the lift, rad";
    ankle_sway: -0.2, 0.2, "amplitude of the ankles' roll, rad";
    spread: -0.03, 0.1, "of the feet outwards, m";
    stride: 0.0, 3.0, "length of the strides ahead, in parts of what the speed needs";
    drift: -0.3, 0.3, "speed ahead of steps without a stride, m/s";
    side_stride: 0.0, 3.0, "length of the strides to a side, in the same parts";
    turn_stride: 0.0, 4.0, "angle of the strides in a turn, in the same parts";
    ankle_pitch: -1.0, 2.0, "ankle pitch for each rad of the torso's pitch";
    ankle_pitch_rate: -0.3, 0.3, "ankle pitch for each rad/s of it, s";
    hip_pitch: -1.0, 2.0, "hip pitch for each rad of the torso's pitch";
    hip_pitch_rate: -0.3, 0.3, "hip pitch for each rad/s of it, s";
    ankle_roll: -1.0, 2.0, "ankle roll for each rad of the torso's roll";
    ankle_roll_rate: -0.3, 0.3, "ankle roll for each rad/s of it, s";
    hip_roll: -1.0, 2.0, "hip roll for each rad of the torso's roll";
    hip_roll_rate: -0.3, 0.3, "hip roll for each rad/s of it, s";
    step_pitch: -3.0, 6.0, "speed of the strides ahead for each rad of the torso's pitch, m/s";
    step_pitch_rate: -1.0, 1.0, "the same for each rad/s of it, m";
    step_roll: -3.0, 6.0, "speed of the strides to the right for each rad of its roll, m/s";
    step_roll_rate: -1.0, 1.0, "the same for each rad/s of it, m";
    acceleration: 0.05, 3.0, "greatest change of the speed, m/s2";
    turn_acceleration: 0.05, 6.0, "greatest change of the rate of turning, rad/s2";
    starting: 0.1, 3.0, "time in which the steps grow, s";
    forwards: 0.01, 3.0, "greatest speed ahead, m/s";
    backwards: 0.0, 3.0, "greatest speed backwards, m/s";
    sideways: 0.0, 3.0, "greatest speed to a side, m/s";
    turning: 0.01, 4.0, "greatest rate of turning, rad/s";
    leg_stiffness: 0.0, 1000.0, "torque per angle of the legs, Nm/rad";
    leg_damping: 0.0, 50.0, "torque per angular velocity of the legs, Nm s/rad";
    other_stiffness: 0.0, 1000.0, "the same of the other joints";
    other_damping: 0.0, 50.0, "the same of the other joints";
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::T1;

    #[test]
    fn a_file_without_a_parameter_or_with_an_unknown_one_is_refused() {
        let own = T1.walk;
        let error = |text: String| SineParameters::parse(&text).unwrap_err();
        assert_eq!(error(own.replace("lean =", "# lean =")), "`lean` is missing");
        assert_eq!(error(format!("{own}\nhop = 1")), "there is no parameter `hop`");
        assert_eq!(error(own.replace("lift = ", "lift = 7 #")), "`lift` is 7, expected 0 to 0.15");
        assert_eq!(error(own.replace("lift = ", "lift = \"x\" #")), "`lift` is not a number but a string");
    }

    #[test]
    fn what_is_written_is_read_again() {
        let mut walk = SineParameters::own(&T1).unwrap();
        assert!(walk.set("lift", 9.0) && !walk.set("hop", 1.0));
        assert_eq!(walk.lift, 0.15, "clamped to its range");
        assert_eq!(SineParameters::parse(&walk.to_toml()).unwrap(), walk);
    }
}
