//! A field, a ball and bodies in simulated time
