//! RoboCup: messages, vision, motion, localisation and the activities of the roles
pub mod functionality;
