//! Transports of packets.

#[cfg(all(unix, feature = "local"))]
pub(crate) mod local;
#[cfg(feature = "zenoh")]
mod zenoh;

#[cfg(feature = "zenoh")]
pub use self::zenoh::{Tls, Zenoh, ZenohSettings};
#[cfg(all(unix, feature = "local"))]
pub use local::{LocalTransport, default_folder, runtime_folder};
