//! The HTTP server: the page, and a WebSocket for each viewer.

use std::io::{self, Write};
use std::net::{IpAddr, Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
#[cfg(unix)]
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use tungstenite::handshake::derive_accept_key;

use crate::access::AccessPolicy;
use crate::asset::Asset;
use crate::error::{Error, ErrorKind};
#[cfg(unix)]
use crate::foxglove;
use crate::http_request::HttpRequest;
#[cfg(unix)]
use crate::live_run::LiveRun;
use crate::model_session::ModelSession;
use crate::model_workspace::ModelWorkspace;
use crate::models_only::ModelsOnly;
use crate::pace::Pace;
use crate::scene::Scene;
use crate::source::Source;
use crate::tape_pair::TapePair;
use crate::tape_run::TapeRun;
use crate::viewer;

/// The first port to try, and the number of ports after it.
const FIRST_PORT: u16 = 4810;
const PORT_COUNT: u16 = 20;

/// The most connections at a time: pages and their files.
const CONNECTION_LIMIT: usize = 32;

/// The most viewers at a time: a run serves at most 16 tools, and each viewer may watch a topic.
const VIEWER_LIMIT: usize = 8;

/// The time limit for sending a file.
const SEND_TIMEOUT: Duration = Duration::from_secs(5);

/// Headers of every reply: nothing is stored, framed, or fetched from elsewhere.
const REPLY_HEADERS: &str = "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
     X-Frame-Options: DENY\r\nCross-Origin-Resource-Policy: same-origin\r\nCross-Origin-Opener-Policy: same-origin\r\n\
     Content-Security-Policy: default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; \
     frame-ancestors 'none'; base-uri 'none'; form-action 'none'\r\nConnection: close\r\n";

/// An address to listen at, such as `127.0.0.1:4810`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ListenAddress(SocketAddr);

impl FromStr for ListenAddress {
    type Err = String;

    fn from_str(text: &str) -> Result<ListenAddress, String> {
        let address =
            text.parse().map_err(|_| "not an address with a port, such as 127.0.0.1:4810".to_owned());
        address.map(ListenAddress)
    }
}

/// Settings of a studio.
#[derive(Clone, Default)]
pub struct StudioSettings {
    /// The address; the first free port from 4810 on of loopback if not given. For any other
    /// address than loopback the page needs a token.
    pub listen: Option<ListenAddress>,
    /// The view from above; for a tape, the one with which it was opened.
    pub scene: Option<Arc<dyn Scene>>,
    /// The pace of simulated time, if viewers may set it.
    pub pace: Option<Pace>,
    /// Origins of pages that may read a run by Foxglove's protocol, such as
    /// `https://app.foxglove.dev`; programs that are not pages need no origin.
    pub origins: Vec<String>,
    /// Whether viewers may change the run: its agents and models, messages, and events.
    pub allows_control: bool,
    /// The models that viewers may edit. Their files are written for pages on this computer, and
    /// for others only with [`allows_control`](StudioSettings::allows_control).
    pub models: Option<Arc<ModelWorkspace>>,
}

/// A running studio. Dropping it stops the server.
pub struct Studio {
    url: String,
    address: SocketAddr,
    state: Arc<ServerState>,
    thread: Option<JoinHandle<()>>,
}

struct ServerState {
    access: AccessPolicy,
    #[cfg_attr(not(unix), allow(dead_code, reason = "only runs of Unix are served to others"))]
    origins: Vec<String>,
    source: Box<dyn Source>,
    models: Option<Arc<ModelWorkspace>>,
    /// Whether files of models may be written.
    may_write: bool,
    is_over: AtomicBool,
    connections: AtomicUsize,
    viewers: AtomicUsize,
}

impl Studio {
    /// Serves the run whose control socket is at a path. The page shows when there is no run, and
    /// connects when there is one.
    ///
    /// # Errors
    /// The address is not available.
    #[cfg(unix)]
    pub fn of_run(socket: &Path, settings: StudioSettings) -> Result<Studio, Error> {
        let StudioSettings { scene, pace, allows_control, .. } = settings.clone();
        Studio::serve(settings, Box::new(LiveRun::new(socket, scene, pace, allows_control)?))
    }

    /// Serves a tape.
    ///
    /// # Errors
    /// The address is not available.
    pub fn of_tape(tape: TapeRun, settings: StudioSettings) -> Result<Studio, Error> {
        Studio::serve(settings, Box::new(tape))
    }

    /// Serves a tape with another one beside it, on the timeline of the first.
    ///
    /// # Errors
    /// The address is not available.
    pub fn of_tapes(tape: TapeRun, other: TapeRun, settings: StudioSettings) -> Result<Studio, Error> {
        Studio::serve(settings, Box::new(TapePair::new(tape, other)))
    }

    /// Serves the models of the settings, without a run.
    ///
    /// # Errors
    /// The address is not available.
    pub fn of_models(settings: StudioSettings) -> Result<Studio, Error> {
        Studio::serve(settings, Box::new(ModelsOnly))
    }

    fn serve(settings: StudioSettings, source: Box<dyn Source>) -> Result<Studio, Error> {
        let StudioSettings { listen, origins, allows_control, models, .. } = settings;
        let failed = |error: io::Error| Error::new(ErrorKind::Address, error);
        let listener = match listen {
            Some(ListenAddress(address)) => TcpListener::bind(address).map_err(|error| {
                Error::new(ErrorKind::Address, format_args!("{address} cannot be used: {error}"))
            })?,
            None => first_free()?,
        };
        let address = listener.local_addr().map_err(failed)?;
        let access = AccessPolicy::for_address(address)?;
        let url = access.url();
        let (connections, viewers) = Default::default();
        let may_write = allows_control || address.ip().is_loopback();
        let is_over = false.into();
        let state = ServerState { access, origins, source, models, may_write, is_over, connections, viewers };
        let state = Arc::new(state);
        let server = state.clone();
        let thread = thread::Builder::new().name("studio".into()).spawn(move || accept(&listener, &server));
        let thread = thread.map_err(|error| Error::new(ErrorKind::System, error))?;
        Ok(Studio { url, address, state, thread: Some(thread) })
    }

    /// The address of the page, with the token if one is needed.
    pub fn url(&self) -> &str {
        &self.url
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        self.state.is_over.store(true, Ordering::SeqCst);
        // The thread waits for a connection.
        let ip = match self.address.ip() {
            ip if ip.is_unspecified() => IpAddr::V4(Ipv4Addr::LOCALHOST),
            ip => ip,
        };
        let _ = TcpStream::connect_timeout(&SocketAddr::new(ip, self.address.port()), SEND_TIMEOUT);
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

impl std::fmt::Debug for Studio {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Studio({})", self.address)
    }
}

/// A listener on the first free port of loopback.
fn first_free() -> Result<TcpListener, Error> {
    let ports = (FIRST_PORT..FIRST_PORT + PORT_COUNT).chain([0]);
    let mut listeners = ports.map(|port| TcpListener::bind((Ipv4Addr::LOCALHOST, port)));
    listeners
        .find_map(Result::ok)
        .ok_or_else(|| Error::new(ErrorKind::Address, "no port of 127.0.0.1 can be used"))
}

fn accept(listener: &TcpListener, state: &Arc<ServerState>) {
    let mut threads: Vec<JoinHandle<()>> = Vec::new();
    for stream in listener.incoming() {
        if state.is_over.load(Ordering::SeqCst) {
            break;
        }
        threads.retain(|thread| !thread.is_finished());
        let (Ok(stream), state) = (stream, state.clone()) else { continue };
        let Some(slot) = Slot::acquire(&state, CONNECTION_LIMIT, |state| &state.connections) else {
            let _ = stream.shutdown(Shutdown::Both);
            continue;
        };
        let name = "studio viewer".to_owned();
        let served = thread::Builder::new().name(name).spawn(move || {
            // A disconnected peer needs no report.
            let _ = slot.state.handle(stream);
        });
        threads.extend(served);
    }
    for thread in threads {
        // A thread that panicked has reported it.
        let _ = thread.join();
    }
}

/// One of a limited number of connections.
struct Slot {
    state: Arc<ServerState>,
    of: fn(&ServerState) -> &AtomicUsize,
}

impl Slot {
    fn acquire(state: &Arc<ServerState>, limit: usize, of: fn(&ServerState) -> &AtomicUsize) -> Option<Slot> {
        let slot = Slot { state: state.clone(), of };
        // The excess slot is released at once.
        (of(state).fetch_add(1, Ordering::SeqCst) < limit).then_some(slot)
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        (self.of)(&self.state).fetch_sub(1, Ordering::SeqCst);
    }
}

impl ServerState {
    /// Answers the only request of a connection.
    fn handle(self: &Arc<ServerState>, mut stream: TcpStream) -> io::Result<()> {
        stream.set_write_timeout(Some(SEND_TIMEOUT))?;
        let Some(request) = HttpRequest::read(&mut stream)? else {
            return reply(&mut stream, "400 Bad Request", "text/plain", b"not an HTTP request\n", "");
        };
        #[cfg(unix)]
        let protocol = foxglove::PROTOCOLS
            .into_iter()
            .find(|protocol| request.has_word("sec-websocket-protocol", protocol));
        #[cfg(not(unix))]
        let protocol: Option<&str> = None;
        let mut origin = request.origin();
        let is_allowed = |origin: &str| self.origins.iter().any(|allowed| allowed == origin);
        if protocol.is_some() && origin.origin.is_some_and(is_allowed) {
            origin.origin = None;
        }
        if let Err(refusal) = self.access.check(&origin) {
            let text = format!("{}\n", refusal.0);
            return reply(&mut stream, "403 Forbidden", "text/plain", text.as_bytes(), "");
        }
        if request.method != "GET" {
            return reply(
                &mut stream,
                "405 Method Not Allowed",
                "text/plain",
                b"only GET\n",
                "Allow: GET\r\n",
            );
        }
        if request.path == "/socket" || protocol.is_some() {
            return self.open_socket(stream, &request, protocol);
        }
        let Some(asset) = Asset::at(&request.path) else {
            return reply(&mut stream, "404 Not Found", "text/plain", b"there is no such file\n", "");
        };
        if !request.has_word("accept-encoding", "gzip") {
            let text = b"the page is compressed: accept gzip\n";
            return reply(&mut stream, "406 Not Acceptable", "text/plain", text, "");
        }
        let cookie = self.access.cookie().filter(|_| request.origin().token.is_some()).unwrap_or_default();
        let more = format!("Content-Encoding: gzip\r\nVary: Accept-Encoding\r\n{cookie}");
        reply(&mut stream, "200 OK", asset.media_type, asset.bytes, &more)
    }

    /// Opens the WebSocket of a page, or of a viewer that speaks another protocol.
    fn open_socket(
        self: &Arc<ServerState>,
        mut stream: TcpStream,
        request: &HttpRequest,
        protocol: Option<&str>,
    ) -> io::Result<()> {
        let Some(key) = request.websocket_key() else {
            return reply(
                &mut stream,
                "426 Upgrade Required",
                "text/plain",
                b"a WebSocket is served here\n",
                "Upgrade: websocket\r\n",
            );
        };
        let slot = Slot::acquire(self, VIEWER_LIMIT, |state| &state.viewers);
        let refusal = format!("{VIEWER_LIMIT} pages are open already");
        if slot.is_none() && protocol.is_some() {
            let text = format!("{refusal}\n");
            return reply(&mut stream, "503 Service Unavailable", "text/plain", text.as_bytes(), "");
        }
        #[cfg(unix)]
        let others = self.source.live_state();
        #[cfg(unix)]
        if protocol.is_some() && others.is_none() {
            let text = b"only a run is served by this protocol\n";
            return reply(&mut stream, "404 Not Found", "text/plain", text, "");
        }
        let accept = derive_accept_key(key.as_bytes());
        let protocol = protocol.map(|name| format!("Sec-WebSocket-Protocol: {name}\r\n"));
        let head = format!(
            "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Accept: {accept}\r\n{}\r\n",
            protocol.as_deref().unwrap_or_default()
        );
        stream.write_all(head.as_bytes())?;
        let Some(_slot) = slot else {
            viewer::refuse(stream, &refusal);
            return Ok(());
        };
        #[cfg(unix)]
        if let (Some(_), Some(run)) = (protocol, others) {
            foxglove::serve(stream, &run, &self.is_over);
            return Ok(());
        }
        let models = self.models.clone().map(|models| ModelSession::new(models, self.may_write));
        let limit = viewer::request_limit(self.source.allows_control() || models.is_some());
        viewer::serve(stream, self.source.open(), models, limit, &self.is_over);
        Ok(())
    }
}

fn reply(stream: &mut TcpStream, status: &str, media_type: &str, body: &[u8], more: &str) -> io::Result<()> {
    let length = body.len();
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {media_type}\r\nContent-Length: {length}\r\n{REPLY_HEADERS}{more}\r\n"
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(body)?;
    stream.flush()
}
