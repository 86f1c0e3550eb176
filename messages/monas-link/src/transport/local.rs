//! Transport between processes of one computer: each link has a datagram socket in a folder that
//! only its owner can access.

use std::env;
use std::fs::{self, Permissions};
use std::io;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixDatagram;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use prost::Message as _;

use crate::error::{Error, ErrorKind};
use crate::inbox::PacketInbox;
use crate::link::Transport;
use crate::protocol::{Packet, wire};
use crate::socket_folder::lock_names;

/// Longest packet, in bytes, with its names. Longer ones need another transport.
const MAX_PACKET_SIZE: usize = 128 << 10;

/// The part of it for names and framing.
const FRAMING_SIZE: usize = 1 << 10;

/// File extension of link sockets.
const EXTENSION: &str = "link";

/// Interval at which the receiving thread checks whether it should stop.
const CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// Sockets in a folder, one per link; a broadcast packet is sent to each of them.
#[derive(Debug)]
pub struct LocalTransport {
    folder: PathBuf,
    path: PathBuf,
    socket: UnixDatagram,
    buffer: Vec<u8>,
    stops: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// The folder of a user's sockets: `monas` in the [`runtime_folder`]; without one `monas-UID` in
/// the system's folder for temporary files, which only this user can access.
///
/// # Errors
/// Without the variable: the folder cannot be created, belongs to another user, or is open to
/// others.
pub fn default_folder() -> Result<PathBuf, Error> {
    match runtime_folder() {
        Some(folder) => Ok(folder.join("monas")),
        None => private_folder(&env::temp_dir()),
    }
}

/// The folder that the system defines for the user's sockets, `XDG_RUNTIME_DIR`. By the
/// specification of the variable a relative path is not valid: it would differ between the folders
/// in which programs are started.
pub fn runtime_folder() -> Option<PathBuf> {
    env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from).filter(|folder| folder.is_absolute())
}

/// The folder of this user in a folder that others can write.
fn private_folder(shared: &Path) -> Result<PathBuf, Error> {
    let path = shared.join(format!("monas-{}", rustix::process::geteuid().as_raw()));
    // A symbolic link is not followed: it may lead elsewhere at any time.
    let created = match fs::symlink_metadata(&path) {
        Ok(found) if !found.is_dir() => Err(io::Error::other(format!("{} is not a folder", path.display()))),
        _ => monas_files::private_folder(&path),
    };
    match created {
        Ok(()) => Ok(path),
        Err(error) => {
            let text = format!("{error}; remove it, or set XDG_RUNTIME_DIR");
            Err(Error::new(ErrorKind::Connection, text))
        }
    }
}

impl LocalTransport {
    /// Creates the socket of the link called `name`. The folder is created if necessary.
    ///
    /// # Errors
    /// The name is invalid, another process uses it, the folder belongs to another user or is open
    /// to others, or the system refuses.
    pub fn new(folder: &Path, name: &str, inbox: Arc<PacketInbox>) -> Result<LocalTransport, Error> {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        if name.is_empty() || !name.chars().all(is_plain) {
            let text = format!("`{name}` is not a name of a socket: letters, digits, `_` and `-`");
            return Err(Error::new(ErrorKind::Settings, text));
        }
        let path = folder.join(format!("{name}.{EXTENSION}"));
        let failed =
            |error: io::Error| Error::new(ErrorKind::Connection, format!("{}: {error}", path.display()));
        let names = lock_names(folder)?;
        remove_dead(&path)?;
        let socket = UnixDatagram::bind(&path).map_err(failed)?;
        fs::set_permissions(&path, Permissions::from_mode(0o600)).map_err(failed)?;
        drop(names);
        let listener = socket.try_clone().map_err(failed)?;
        listener.set_read_timeout(Some(CHECK_INTERVAL)).map_err(failed)?;
        // Sending uses a separate socket, since blocking mode is a property of the file and not of
        // the handle.
        let socket = UnixDatagram::unbound().map_err(failed)?;
        socket.set_nonblocking(true).map_err(failed)?;
        let stops = Arc::new(AtomicBool::new(false));
        let has_ended = stops.clone();
        let thread = thread::Builder::new()
            .name(format!("{name} socket"))
            .spawn(move || listen(&listener, &inbox, &has_ended))
            .map_err(failed)?;
        let folder = folder.to_owned();
        Ok(LocalTransport { folder, path, socket, buffer: Vec::new(), stops, thread: Some(thread) })
    }

    fn send_to(&self, path: &Path) -> Result<(), Error> {
        let sent = self.socket.send_to(&self.buffer, path);
        match sent {
            Ok(_) => Ok(()),
            // A process that has exited need not receive it.
            Err(error) if is_gone(&error) => Ok(()),
            Err(error) => Err(Error::new(ErrorKind::Connection, format!("{}: {error}", path.display()))),
        }
    }

    /// The sockets of the other links.
    fn others(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let sockets = entries.map(|entry| entry.path());
        sockets
            .filter(|path| path.extension().is_some_and(|end| end == EXTENSION) && *path != self.path)
            .collect()
    }
}

impl Transport for LocalTransport {
    fn send(&mut self, packet: &Packet) -> Result<(), Error> {
        self.buffer.clear();
        let datagram = wire::Datagram {
            from: packet.from.to_string(),
            path: packet.path.as_deref().unwrap_or_default().to_owned(),
            stamp: packet.stamp.to_vec(),
            payload: packet.payload.to_vec(),
            priority: packet.priority.into(),
        };
        if datagram.encoded_len() > MAX_PACKET_SIZE {
            let text =
                format!("{} bytes do not fit into a packet of {MAX_PACKET_SIZE}", datagram.encoded_len());
            return Err(Error::new(ErrorKind::TooLarge, text));
        }
        datagram.encode_raw(&mut self.buffer);
        match &packet.to {
            Some(name) => self.send_to(&self.folder.join(format!("{name}.{EXTENSION}"))),
            None => self.others().iter().map(|path| self.send_to(path)).fold(Ok(()), Result::and),
        }
    }

    fn largest(&self) -> usize {
        MAX_PACKET_SIZE - FRAMING_SIZE
    }
}

impl Drop for LocalTransport {
    fn drop(&mut self) {
        self.stops.store(true, Ordering::SeqCst);
        let _ = self.thread.take().map(JoinHandle::join);
        // A process that finds the socket later gets an error on connecting.
        let _ = fs::remove_file(&self.path);
    }
}

/// Removes the socket of a process that was killed; fails if the process is alive.
fn remove_dead(path: &Path) -> Result<(), Error> {
    let failed = |error: io::Error| Error::new(ErrorKind::Connection, format!("{}: {error}", path.display()));
    match UnixDatagram::unbound().map_err(failed)?.connect(path) {
        Ok(()) => {
            let text = format!("{}: another process has a link of this name", path.display());
            Err(Error::new(ErrorKind::Connection, text))
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) if is_gone(&error) => fs::remove_file(path).map_err(failed),
        Err(error) => Err(failed(error)),
    }
}

fn is_gone(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::ConnectionRefused | io::ErrorKind::NotFound)
}

fn listen(socket: &UnixDatagram, inbox: &PacketInbox, stops: &AtomicBool) {
    let mut buffer = vec![0; MAX_PACKET_SIZE + 1];
    while !stops.load(Ordering::SeqCst) {
        let Ok(length) = socket.recv(&mut buffer) else { continue };
        inbox.put(read(&buffer[..length]));
    }
}

/// The packet in a datagram. An invalid one becomes a packet that cannot be parsed, and is counted
/// as such.
pub(crate) fn read(bytes: &[u8]) -> Packet {
    let datagram = wire::Datagram::decode(bytes).unwrap_or_default();
    Packet {
        from: datagram.from.into(),
        to: None,
        path: (!datagram.path.is_empty()).then(|| datagram.path.into()),
        stamp: datagram.stamp.into(),
        payload: datagram.payload.into(),
        priority: datagram.priority.clamp(1, 7) as u8,
        is_reliable: true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_among_those_of_others_is_private_or_refused() {
        let shared = tempfile::tempdir().unwrap();
        let path = private_folder(shared.path()).unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o700);
        assert_eq!(private_folder(shared.path()).unwrap(), path);
        fs::set_permissions(&path, Permissions::from_mode(0o755)).unwrap();
        let refused = private_folder(shared.path()).unwrap_err().to_string();
        assert!(
            refused.contains("open to other users (mode 755)") && refused.contains("XDG_RUNTIME_DIR"),
            "{refused}"
        );
        fs::set_permissions(&path, Permissions::from_mode(0o700)).unwrap();
        let elsewhere = shared.path().join("elsewhere");
        fs::rename(&path, &elsewhere).unwrap();
        std::os::unix::fs::symlink(&elsewhere, &path).unwrap();
        assert!(private_folder(shared.path()).unwrap_err().to_string().contains("not a folder"));
        if rustix::process::geteuid().is_root() {
            fs::remove_file(&path).unwrap();
            std::os::unix::fs::chown(&elsewhere, Some(12345), None).unwrap();
            fs::rename(&elsewhere, &path).unwrap();
            assert!(private_folder(shared.path()).unwrap_err().to_string().contains("another user"));
        }
    }
}
