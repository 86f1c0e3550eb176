//! Configurations: listings of the thesis, XML, TOML, layers, schemas, and editing of files.

mod agents;
mod files;
mod layers;
mod links;
mod toml;
mod xml;
