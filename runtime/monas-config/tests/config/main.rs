//! Files that describe bodies, robots and their motions.

mod bodies;
mod poses;
mod urdf;
