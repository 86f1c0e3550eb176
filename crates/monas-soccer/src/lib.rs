//! RoboCup: messages, vision, motion, localisation and the activities of the roles

pub mod activities;
mod convert;
pub mod functionality;
pub mod topics;

narukom::include_messages!("monas.soccer");
