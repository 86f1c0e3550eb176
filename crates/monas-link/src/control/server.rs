//! A run's side of its control socket.

use std::fs::{self, DirBuilder, Permissions};
use std::io::{self, Read};
use std::net::Shutdown;
use std::os::unix::fs::{DirBuilderExt, PermissionsExt};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use narukom::Narukom;
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::messages::{
    Answer, FetchSchema, Last, ListTopics, Manage, Managed, Publish, Published, Refused, Request, Run,
    Schema, TopicEntry, Topics,
};
use super::watch::Watcher;
use super::{CLIENT_LIMIT, Observed, REQUEST_LIMIT, frame};
use crate::error::{Error, ErrorKind};

/// How often a thread looks whether it is to end.
const LOOK: Duration = Duration::from_millis(100);

/// A tool that says nothing for so many looks is left,
const PATIENCE: u32 = 100;

/// and so is one that takes nothing for this long.
const SLOWEST: Duration = Duration::from_secs(2);

/// Serves the control socket of a run. It ends when it is dropped.
pub struct ControlServer {
    path: PathBuf,
    stops: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// What all that serve a tool share.
struct Desk {
    name: String,
    run: Arc<dyn Observed>,
    stops: Arc<AtomicBool>,
    /// How many tools there are.
    clients: AtomicUsize,
}

impl ControlServer {
    /// Makes the socket `NAME.sock` in a folder, which is made if it is not there.
    ///
    /// # Errors
    /// The name is none, another run uses it ([`ErrorKind::NameTaken`]), or the system refuses.
    pub fn start(folder: &Path, name: &str, run: Arc<dyn Observed>) -> Result<ControlServer, Error> {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        if name.is_empty() || !name.chars().all(is_plain) {
            let text = format!("`{name}` is no name of a control socket: letters, digits, `_` and `-`");
            return Err(Error::new(ErrorKind::Settings, text));
        }
        let path = folder.join(format!("{name}.{}", super::client::ENDING));
        let failed =
            |error: io::Error| Error::new(ErrorKind::Connection, format!("{}: {error}", path.display()));
        DirBuilder::new().recursive(true).mode(0o700).create(folder).map_err(failed)?;
        remove_dead(&path)?;
        let listener = UnixListener::bind(&path).map_err(failed)?;
        fs::set_permissions(&path, Permissions::from_mode(0o600)).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let stops = Arc::new(AtomicBool::new(false));
        let desk = Desk { name: name.into(), run, stops: stops.clone(), clients: AtomicUsize::new(0) };
        let thread = thread::Builder::new()
            .name(format!("{name} control"))
            .spawn(move || accept(&listener, &Arc::new(desk)))
            .map_err(failed)?;
        Ok(ControlServer { path, stops, thread: Some(thread) })
    }

    /// Where the socket is.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for ControlServer {
    fn drop(&mut self) {
        self.stops.store(true, Ordering::SeqCst);
        // Nobody need come for it to look: it does so by itself, but sooner if somebody does.
        let _ = UnixStream::connect(&self.path);
        let _ = self.thread.take().map(JoinHandle::join);
        let _ = fs::remove_file(&self.path);
    }
}

impl std::fmt::Debug for ControlServer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "ControlServer({})", self.path.display())
    }
}

/// Removes the socket of a process that was killed; that of a living one is left, and an error.
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

fn accept(listener: &UnixListener, desk: &Arc<Desk>) {
    let look = Timespec { tv_sec: 0, tv_nsec: LOOK.as_nanos() as i64 };
    let mut tools: Vec<Tool> = Vec::new();
    while !desk.stops.load(Ordering::SeqCst) {
        // Whatever it says, accepting says more.
        let _ = poll(&mut [PollFd::new(listener, PollFlags::IN)], Some(&look));
        tools.retain(|tool| !tool.thread.is_finished());
        if let Ok((stream, _)) = listener.accept() {
            tools.extend(serve(stream, desk.clone()));
        }
    }
    for Tool { stream, thread } in tools {
        // Whoever waits for a slow tool waits no longer. A thread that has panicked has said so.
        let _ = stream.shutdown(Shutdown::Both);
        let _ = thread.join();
    }
}

/// A tool that is served.
struct Tool {
    stream: UnixStream,
    thread: JoinHandle<()>,
}

/// Begins to serve a tool, if it is the owner's and there are not too many.
fn serve(mut stream: UnixStream, desk: Arc<Desk>) -> Option<Tool> {
    stream.set_nonblocking(false).ok()?;
    stream.set_read_timeout(Some(LOOK)).ok()?;
    stream.set_write_timeout(Some(SLOWEST)).ok()?;
    if !is_owner(&stream) {
        let _ = frame::write(&refused("this run belongs to another user"), &mut stream);
        return None;
    }
    let place = Place::take(desk);
    let Some(place) = place else {
        let _ = frame::write(&refused(format!("{CLIENT_LIMIT} tools look at this run already")), &mut stream);
        return None;
    };
    let other = stream.try_clone().ok()?;
    let thread = thread::Builder::new().name(format!("{} client", place.0.name));
    let thread = thread.spawn(move || place.0.attend(&stream)).ok()?;
    Some(Tool { stream: other, thread })
}

/// Whether the process at the other end belongs to who runs this one. The socket is open to its owner alone; where the system
/// tells who is there, that is asked besides.
#[cfg(target_os = "linux")]
fn is_owner(stream: &UnixStream) -> bool {
    let own = rustix::process::geteuid();
    rustix::net::sockopt::socket_peercred(stream).is_ok_and(|peer| peer.uid == own || peer.uid.is_root())
}

#[cfg(not(target_os = "linux"))]
fn is_owner(_: &UnixStream) -> bool {
    true
}

/// A tool's place among those that are served.
struct Place(Arc<Desk>);

impl Place {
    fn take(desk: Arc<Desk>) -> Option<Place> {
        let place = Place(desk);
        // One too many is given back at once.
        (place.0.clients.fetch_add(1, Ordering::SeqCst) < CLIENT_LIMIT).then_some(place)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.0.clients.fetch_sub(1, Ordering::SeqCst);
    }
}

fn refused(reason: impl Into<String>) -> Answer {
    Answer { refused: Some(Refused { reason: reason.into() }), ..Answer::default() }
}

/// Reads as long as the run lasts and the other side says something now and then.
struct Patient<'a> {
    stream: &'a UnixStream,
    stops: &'a AtomicBool,
    left: u32,
}

impl Read for Patient<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            match self.stream.read(buffer) {
                Err(error) if is_timeout(&error) => {
                    self.left = self.left.saturating_sub(1);
                    if self.left == 0 || self.stops.load(Ordering::SeqCst) {
                        return Err(error);
                    }
                }
                read => return read,
            }
        }
    }
}

fn is_timeout(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut)
}

impl Desk {
    /// Serves a tool until it leaves, or is left. One that leaves in the middle of an answer is gone, which is nobody's business.
    fn attend(&self, stream: &UnixStream) {
        let _ = self.converse(stream);
        // There is another handle to it, which would hold it open.
        let _ = stream.shutdown(Shutdown::Both);
    }

    /// Answers one request after the other.
    fn converse(&self, mut stream: &UnixStream) -> io::Result<()> {
        loop {
            let mut patient = Patient { stream, stops: &self.stops, left: PATIENCE };
            let request: Request = match frame::read(&mut patient, REQUEST_LIMIT) {
                Ok(request) => request,
                Err(error) if error.kind() == io::ErrorKind::InvalidData => {
                    return frame::write(&refused(error.to_string()), &mut stream);
                }
                Err(error) => return Err(error),
            };
            if let Some(watch) = request.watch {
                let hubs = self.chosen(&watch.host);
                match hubs.and_then(|hubs| Watcher::new(hubs, &watch)) {
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
        }
    }

    /// The hub of a host, or those of all.
    fn chosen(&self, host: &str) -> Result<Vec<Narukom>, String> {
        let hubs = self.run.hubs();
        let chosen: Vec<Narukom> =
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

fn entry(hub: &Narukom, slot: narukom::TopicSlot) -> Option<TopicEntry> {
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

/// A name that is known, since a message bears its number.
pub(super) fn name(name: Option<Arc<str>>) -> String {
    name.as_deref().unwrap_or_default().to_owned()
}
