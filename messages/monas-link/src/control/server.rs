//! Server side of a run's control socket.

use std::fs::{self, Permissions};
use std::io::{self, Read};
use std::net::Shutdown;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use narukom::Hub;
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::host_watch::TopicWatch;
use super::messages::{
    Answer, FetchSchema, Last, ListTopics, Manage, Managed, Publish, Published, Refused, Request, Run,
    Schema, TopicEntry, Topics,
};
use super::{CLIENT_LIMIT, ControlTarget, REQUEST_LIMIT, frame};
use crate::error::{Error, ErrorKind};
use crate::socket_folder::lock_names;

/// Interval at which a thread checks whether it should stop.
const CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// Number of such intervals without a whole request after which a tool is disconnected.
const IDLE_CHECKS: usize = 100;

/// A request of so many bytes may arrive in one more part. A tool that sends its request in smaller
/// parts is disconnected, since it would hold its connection for as long as it likes.
const MAX_FINAL_PART: usize = 16 << 10;

/// Time without reading its replies after which a tool is disconnected.
const SEND_TIMEOUT: Duration = Duration::from_secs(2);

/// The control socket of a run that does not exist yet: it holds the run's name. Tools that connect
/// wait until it is served.
#[derive(Debug)]
pub struct ControlSocket {
    listener: UnixListener,
    name: String,
    path: SocketPath,
}

/// Serves the control socket of a run. Dropping it stops the server.
pub struct ControlServer {
    stops: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    path: SocketPath,
}

/// The path of a socket, which is removed when this is dropped.
#[derive(Debug)]
struct SocketPath(PathBuf);

impl Drop for SocketPath {
    fn drop(&mut self) {
        // A process that finds the socket later gets an error on connecting.
        let _ = fs::remove_file(&self.0);
    }
}

/// The state shared by all connections.
struct ServerState {
    name: String,
    run: Arc<dyn ControlTarget>,
    stops: Arc<AtomicBool>,
    /// Number of connected tools.
    clients: AtomicUsize,
}

impl ControlSocket {
    /// Creates the socket `NAME.sock` in a folder, which is created if necessary.
    ///
    /// # Errors
    /// The name is invalid, another run uses it ([`ErrorKind::NameTaken`]), the folder belongs to
    /// another user or is open to others, or the system refuses.
    pub fn bind(folder: &Path, name: &str) -> Result<ControlSocket, Error> {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        if name.is_empty() || !name.chars().all(is_plain) {
            let text = format!("`{name}` is not a name of a control socket: letters, digits, `_` and `-`");
            return Err(Error::new(ErrorKind::Settings, text));
        }
        let path = folder.join(format!("{name}.{}", super::client::EXTENSION));
        let failed =
            |error: io::Error| Error::new(ErrorKind::Connection, format!("{}: {error}", path.display()));
        let _names = lock_names(folder)?;
        remove_dead(&path)?;
        let listener = UnixListener::bind(&path).map_err(failed)?;
        fs::set_permissions(&path, Permissions::from_mode(0o600)).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        Ok(ControlSocket { listener, name: name.into(), path: SocketPath(path) })
    }

    /// The path of the socket.
    pub fn path(&self) -> &Path {
        &self.path.0
    }

    /// Serves the socket.
    ///
    /// # Errors
    /// The system cannot create a thread.
    pub fn serve(self, run: Arc<dyn ControlTarget>) -> Result<ControlServer, Error> {
        let ControlSocket { listener, name, path } = self;
        let stops = Arc::new(AtomicBool::new(false));
        let thread_name = format!("{name} control");
        let state = ServerState { name, run, stops: stops.clone(), clients: AtomicUsize::new(0) };
        let thread = thread::Builder::new()
            .name(thread_name)
            .spawn(move || accept(&listener, &Arc::new(state)))
            .map_err(|error| Error::new(ErrorKind::Thread, error.to_string()))?;
        Ok(ControlServer { stops, thread: Some(thread), path })
    }
}

impl ControlServer {
    /// Creates the socket `NAME.sock` in a folder, which is created if necessary, and serves it.
    ///
    /// # Errors
    /// As [`ControlSocket::bind`] and [`ControlSocket::serve`].
    pub fn start(folder: &Path, name: &str, run: Arc<dyn ControlTarget>) -> Result<ControlServer, Error> {
        ControlSocket::bind(folder, name)?.serve(run)
    }

    /// The path of the socket.
    pub fn path(&self) -> &Path {
        &self.path.0
    }
}

impl Drop for ControlServer {
    fn drop(&mut self) {
        self.stops.store(true, Ordering::SeqCst);
        // The thread polls the flag; a connection only makes it check sooner.
        let _ = UnixStream::connect(self.path());
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

impl std::fmt::Debug for ControlServer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "ControlServer({})", self.path().display())
    }
}

/// Removes the socket of a process that was killed; fails if the process is alive.
fn remove_dead(path: &Path) -> Result<(), Error> {
    let failed = |error: io::Error| Error::new(ErrorKind::Connection, format!("{}: {error}", path.display()));
    match UnixStream::connect(path) {
        Ok(_) => {
            let text = format!("{}: another run has this name", path.display());
            Err(Error::new(ErrorKind::NameTaken, text))
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {
            fs::remove_file(path).map_err(failed)
        }
        Err(error) => Err(failed(error)),
    }
}

fn accept(listener: &UnixListener, state: &Arc<ServerState>) {
    let look = Timespec { tv_sec: 0, tv_nsec: CHECK_INTERVAL.as_nanos() as i64 };
    let mut tools: Vec<ToolConnection> = Vec::new();
    while !state.stops.load(Ordering::SeqCst) {
        // An error of the stream shows again when accepting.
        let _ = poll(&mut [PollFd::new(listener, PollFlags::IN)], Some(&look));
        tools.retain(|tool| !tool.thread.is_finished());
        if let Ok((stream, _)) = listener.accept() {
            tools.extend(serve(stream, state.clone()));
        }
    }
    for ToolConnection { stream, thread } in tools {
        // A thread waiting for a slow tool now gets an error. A thread that panicked has already
        // reported it.
        let _ = stream.shutdown(Shutdown::Both);
        let _ = thread.join();
    }
}

/// A connected tool.
struct ToolConnection {
    stream: UnixStream,
    thread: JoinHandle<()>,
}

/// Starts to serve a tool, if it belongs to the owner and there are not too many.
fn serve(mut stream: UnixStream, state: Arc<ServerState>) -> Option<ToolConnection> {
    stream.set_nonblocking(false).ok()?;
    stream.set_read_timeout(Some(CHECK_INTERVAL)).ok()?;
    stream.set_write_timeout(Some(SEND_TIMEOUT)).ok()?;
    if !is_owner(&stream) {
        let _ = frame::write(&refused("this run belongs to another user"), &mut stream);
        return None;
    }
    let slot = ConnectionSlot::acquire(state);
    let Some(slot) = slot else {
        let _ = frame::write(&refused(format!("{CLIENT_LIMIT} tools look at this run already")), &mut stream);
        return None;
    };
    let other = stream.try_clone().ok()?;
    let thread = thread::Builder::new().name(format!("{} client", slot.0.name));
    let thread = thread.spawn(move || slot.0.serve_connection(&stream)).ok()?;
    Some(ToolConnection { stream: other, thread })
}

/// Whether the peer process belongs to the user who runs this one. The socket is accessible to its
/// owner only; where the system provides the peer's credentials, they are checked as well.
#[cfg(target_os = "linux")]
fn is_owner(stream: &UnixStream) -> bool {
    let own = rustix::process::geteuid();
    rustix::net::sockopt::socket_peercred(stream).is_ok_and(|peer| peer.uid == own || peer.uid.is_root())
}

#[cfg(not(target_os = "linux"))]
fn is_owner(_: &UnixStream) -> bool {
    true
}

/// One of the [`CLIENT_LIMIT`] connections.
struct ConnectionSlot(Arc<ServerState>);

impl ConnectionSlot {
    fn acquire(state: Arc<ServerState>) -> Option<ConnectionSlot> {
        let slot = ConnectionSlot(state);
        // The excess slot is released at once.
        (slot.0.clients.fetch_add(1, Ordering::SeqCst) < CLIENT_LIMIT).then_some(slot)
    }
}

impl Drop for ConnectionSlot {
    fn drop(&mut self) {
        self.0.clients.fetch_sub(1, Ordering::SeqCst);
    }
}

fn refused(reason: impl Into<String>) -> Answer {
    Answer { refused: Some(Refused { reason: reason.into() }), ..Answer::default() }
}

/// Reads one request while the run lasts and the peer sends it soon. Time is counted in intervals
/// without a byte and in parts of the request.
struct RequestReader<'a> {
    stream: &'a UnixStream,
    stops: &'a AtomicBool,
    waits: usize,
    bytes: usize,
}

impl Read for RequestReader<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            self.waits += 1;
            if self.waits > IDLE_CHECKS + self.bytes / MAX_FINAL_PART || self.stops.load(Ordering::SeqCst) {
                return Err(io::ErrorKind::TimedOut.into());
            }
            match self.stream.read(buffer) {
                Err(error) if is_timeout(&error) => {}
                read => {
                    self.bytes += read.as_ref().copied().unwrap_or_default();
                    return read;
                }
            }
        }
    }
}

fn is_timeout(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut)
}

impl ServerState {
    /// Serves a tool until it disconnects or is disconnected. A disconnection in the middle of a
    /// reply is not an error.
    fn serve_connection(&self, stream: &UnixStream) {
        let _ = self.handle_requests(stream);
        // Another handle to the socket would keep it open.
        let _ = stream.shutdown(Shutdown::Both);
    }

    /// Handles one request after the other.
    fn handle_requests(&self, mut stream: &UnixStream) -> io::Result<()> {
        loop {
            let mut reader = RequestReader { stream, stops: &self.stops, waits: 0, bytes: 0 };
            let request: Request = match frame::read(&mut reader, REQUEST_LIMIT) {
                Ok(request) => request,
                Err(error) if error.kind() == io::ErrorKind::InvalidData => {
                    return frame::write(&refused(error.to_string()), &mut stream);
                }
                Err(error) => return Err(error),
            };
            if let Some(watch) = request.watch {
                let hubs = self.chosen(&watch.host);
                match hubs.and_then(|hubs| TopicWatch::new(hubs, &watch)) {
                    Ok(watcher) => return watcher.run(stream, &*self.run, &self.stops),
                    Err(reason) => frame::write(&refused(reason), &mut stream)?,
                }
            } else {
                let answer = self.answer(request).unwrap_or_else(refused);
                frame::write(&answer, &mut stream)?;
            }
        }
    }

    fn answer(&self, request: Request) -> Result<Answer, String> {
        let mut answer = Answer::default();
        match request {
            Request { describe: Some(_), .. } => answer.run = Some(self.describe()),
            Request { topics: Some(request), .. } => answer.topics = Some(self.topics(&request)?),
            Request { schema: Some(request), .. } => answer.schema = Some(self.schema(&request)?),
            Request { publish: Some(Publish { host, path, payload }), .. } => {
                self.run.publish(&host, &path, &payload)?;
                answer.published = Some(Published::default());
            }
            Request { manage: Some(Manage { inquiry }), .. } => {
                answer.managed = Some(Managed { reply: self.run.manage(&inquiry)? });
            }
            _ => return Err("this run does not know the request".into()),
        }
        Ok(answer)
    }

    fn describe(&self) -> Run {
        Run {
            name: self.name.clone(),
            process: std::process::id(),
            simulated: self.run.is_simulated(),
            now: self.run.now().as_nanos(),
            hosts: self.run.hubs().iter().map(|hub| hub.host().to_owned()).collect(),
            alarms: self.run.alarms(),
        }
    }

    /// The hub of a host, or all hubs.
    fn chosen(&self, host: &str) -> Result<Vec<Hub>, String> {
        let hubs = self.run.hubs();
        let chosen: Vec<Hub> =
            hubs.iter().filter(|hub| host.is_empty() || hub.host() == host).cloned().collect();
        if chosen.is_empty() {
            let known: Vec<String> = hubs.iter().map(|hub| format!("`{}`", hub.host())).collect();
            return Err(format!("no host is named `{host}`; there are {}", known.join(", ")));
        }
        Ok(chosen)
    }

    fn topics(&self, request: &ListTopics) -> Result<Topics, String> {
        let pattern = if request.pattern.is_empty() { "**" } else { &request.pattern };
        let mut topics = Vec::new();
        for hub in self.chosen(&request.host)? {
            let slots = hub.matching(pattern).map_err(|error| error.to_string())?;
            topics.extend(slots.into_iter().filter_map(|slot| entry(&hub, slot)));
        }
        Ok(Topics { topics })
    }

    fn schema(&self, request: &FetchSchema) -> Result<Schema, String> {
        let hub = self.run.hubs().first().ok_or("the run has no host")?;
        let slots = hub.matching(&request.path).map_err(|error| error.to_string())?;
        let topic = slots.first().and_then(|slot| hub.declaration(*slot)).ok_or("there is no such topic")?;
        let descriptor = topic.descriptor();
        Ok(Schema { r#type: descriptor.full_name.into(), descriptors: descriptor.file_descriptor_set.into() })
    }
}

fn entry(hub: &Hub, slot: narukom::TopicSlot) -> Option<TopicEntry> {
    let topic = hub.declaration(slot)?;
    let last = hub.latest(slot).map(|sample| Last {
        publisher: name(hub.publisher_name(sample.header.publisher)),
        sequence: sample.header.sequence,
        published: sample.header.published.as_nanos(),
    });
    let from = hub.hosts_of(slot).into_iter().map(|host| name(hub.host_name(host)));
    Some(TopicEntry {
        host: hub.host().into(),
        path: topic.path().into(),
        kind: topic.kind().to_string(),
        depth: topic.depth() as u64,
        r#type: topic.descriptor().full_name.into(),
        last,
        from: from.collect(),
    })
}

/// The name for a number in a header; such a name is always known.
pub(super) fn name(name: Option<Arc<str>>) -> String {
    name.as_deref().unwrap_or_default().to_owned()
}
